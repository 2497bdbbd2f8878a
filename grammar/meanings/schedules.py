"""When a wish is to be done that is for set times: "every weekday at eight", "every hour from nine
to five, on Mondays". It is read without knowing what time it is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from datetime import date
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse
from grammar.errors import NotUnderstood
from grammar.meanings.amounts import time_said
from grammar.meanings.registry import meaning
from grammar.requests import When
from robot_api.methods import WEEKDAYS

A_MINUTE: Final = 60
A_LEAP_YEAR: Final = 2028
_EITHER_HALF: Final = range(6, 9)
"""What o'clock people say of mornings and of evenings alike, where nothing else tells which."""


@meaning("set_times")
def set_times(d: Discourse, node: Node) -> When | None:
    """All of it. None if it is at times that no `When` can say: every other week."""
    fixed = dict(node.production.fixed)
    if (days := _part(node, "days")) is not None:
        fixed |= days.production.fixed
    if fixed.get("other"):
        return None
    half = fixed.get("half")
    since, until = (_window(d, node, each) for each in ("since", "until"))
    pace = _part(node, "pace")
    when = When(
        weekdays=_weekdays(d, node, str(fixed.get("weekdays", ""))),
        minutes=int(fixed["minutes"]) if "minutes" in fixed else None,
        date=_date(d, node),
        repeats=_part(node, "date") is None,
        since=since,
        until=until,
    )
    if pace is not None:
        every = float(d.build(pace)) / A_MINUTE
        if every != int(every):
            return None
        when = replace(when, minutes=int(every))
    if (count := _part(node, "count")) is not None:
        when = replace(when, count=int(d.build(count)))
    times: set[str] = set()
    unclear: tuple[str, ...] = ()
    for each in _named(node, "clock"):
        time, guessed = time_said(d, each, half)
        times.add(time)
        if half is None and not fixed.get("working") and _either(d, each, time, guessed):
            first = f"{int(time[:2]) % 12:02}{time[2:]}"
            unclear = (first, f"{int(first[:2]) + 12:02}{time[2:]}")
    if not times and "at" in fixed:
        times.add(str(fixed["at"]))
    return replace(when, times=tuple(sorted(times)), unclear=unclear)


def _either(d: Discourse, node: Node, time: str, guessed: bool) -> bool:
    """Whether that may be in the morning as well as in the evening."""
    if "time" in node.production.fixed or d.get(node, "half_of_day") or "clock" in node.parts:
        return False
    if d.tokens[node.end - 1].norm in d.language.speech.get("whole_day_clock", ()):
        return False  # "um 8 Uhr": who means the evening says 20
    return int(time[:2]) % 12 in _EITHER_HALF and (guessed or int(time[:2]) < 12)


def _window(d: Discourse, node: Node, name: str) -> str | None:
    part = _part(node, name)
    return time_said(d, part)[0] if part is not None else None


def _date(d: Discourse, node: Node) -> str | None:
    """That day of the month, with the year if it is said. Raises `NotUnderstood`."""
    said = _part(node, "date")
    if said is None:
        return None
    day, year = float(d.get(said, "day")), d.get(said, "year")
    try:
        that = date(int(year) if year else A_LEAP_YEAR, int(d.get(said, "month")), int(day))
    except ValueError:
        words = d.words(said.start, said.end)
        raise NotUnderstood(d.language.phrase("no_such_time", time=words)) from None
    return f"{that}" if year else f"{that:%m-%d}"


def _weekdays(d: Discourse, node: Node, fixed: str) -> tuple[int, ...]:
    if fixed:
        return tuple(int(day) for day in fixed.split())
    said = {
        WEEKDAYS.index(d.build(leaf))
        for leaf in _leaves(node)
        if leaf.slot in ("weekday", "weekdays")
    }
    return tuple(sorted(said))


def _leaves(node: Node) -> Iterator[Leaf]:
    for part in node.parts.values():
        if isinstance(part, Leaf):
            yield part
        else:
            yield from _leaves(part)


def _named(node: Node, name: str) -> Iterator[Node]:
    """All parts of that name, however deep."""
    for called, part in node.parts.items():
        if isinstance(part, Node):
            if called == name:
                yield part
            yield from _named(part, name)


def _part(node: Node, name: str) -> Node | None:
    return next(_named(node, name), None)
