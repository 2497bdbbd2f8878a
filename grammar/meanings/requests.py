"""What is asked of the application about routines, commands that go by a name; and their steps
among others (`grammar.understand` enters what the name of one means)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from datetime import date
from typing import Any, Final

import msgspec

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps
from grammar.errors import NotUnderstood
from grammar.lexicon import Name, Routine
from grammar.meanings.amounts import time_said
from grammar.meanings.registry import meaning
from grammar.plan import Call, ForEach, Plan, Remember, Try
from grammar.requests import Kind, Request, When
from grammar.tidy import nodes
from robot_api.methods import WEEKDAYS

A_MINUTE: Final = 60
A_LEAP_YEAR: Final = 2028
_EITHER_HALF: Final = range(6, 9)
"""What o'clock people say of mornings and of evenings alike, where nothing else tells which."""


def with_own_names(d: Discourse, plan: Plan) -> Steps:
    """The steps with names that the sentence around does not use."""
    names: dict[str, str] = {}
    own: tuple[str, ...]
    for each in nodes(plan.steps):
        match each:
            case Call(save_as=str() as name) | Remember(name=name) | Try(problem=str() as name):
                own = (name,)
            case ForEach(variable=name, value=other):
                own = (name,) if other is None else (name, other)
            case _:
                own = ()
        for name in own:
            if name not in names:
                names[name] = d.variable(name)
    return [_renamed(step, names) for step in plan.steps]


def _renamed(value: Any, names: dict[str, str]) -> Any:
    if isinstance(value, tuple):
        return tuple(_renamed(each, names) for each in value)
    if isinstance(value, dict):
        return {key: _renamed(each, names) for key, each in value.items()}
    if not isinstance(value, msgspec.Struct):
        return value
    changed = {field: _renamed(getattr(value, field), names) for field in value.__struct_fields__}
    owned = ("value", "problem") if isinstance(value, ForEach | Try) else ()
    for field in ("name", "save_as", "variable", *owned):
        if changed.get(field) in names:
            changed[field] = names[changed[field]]
    return type(value)(**changed)


# --- asked of the application


def request(d: Discourse, node: Node, kind: Kind) -> Request:
    """What is asked, with the original words of its parts."""

    def said(name: str) -> str:
        part = node.parts.get(name)
        if part is None:
            return ""
        if isinstance(part, Leaf) and isinstance(part.value, tuple):
            known: Name | Routine = part.value[0]
            return known.name
        if part.end == part.start + 1 and d.tokens[part.start].kind == "quote":
            return d.tokens[part.start].inner
        return d.words(part.start, part.end)

    return Request(kind, said("name"), said("new"), said("sentence"), said("part"))


@meaning("ask_help")
def ask_help(d: Discourse, node: Node) -> Request:
    return request(d, node, "help")


@meaning("learn_routine")
def learn_routine(d: Discourse, node: Node) -> Request:
    return request(d, node, "learn")


@meaning("list_routines")
def list_routines(d: Discourse, node: Node) -> Request:
    return request(d, node, "list")


@meaning("explain_routine")
def explain_routine(d: Discourse, node: Node) -> Request:
    return request(d, node, "explain")


@meaning("change_routine")
def change_routine(d: Discourse, node: Node) -> Request:
    return request(d, node, "change")


@meaning("forget_routine")
def forget_routine(d: Discourse, node: Node) -> Request:
    return request(d, node, "forget")


@meaning("schedule_routine")
def schedule_routine(d: Discourse, node: Node) -> Request:
    asked = request(d, node, "schedule")
    return replace(asked, when=d.build(node.parts["part"]))


@meaning("skip_appointments")
def skip_appointments(d: Discourse, node: Node) -> Request:
    """ "not tomorrow", "not on Monday"."""
    ahead = node.production.fixed.get("days_ahead")
    day = d.get(node, "weekday")
    return Request(
        "skip",
        when=When(
            days_ahead=int(ahead) if ahead is not None else None,
            weekdays=(WEEKDAYS.index(str(day)),) if day else (),
        ),
    )


@meaning("cancel_appointment")
def cancel_appointment(d: Discourse, node: Node) -> Request:
    """ "cancel the round at eight": by its words, or by its time alone."""
    clock = node.parts.get("clock")
    times = (time_said(d, clock)[0],) if isinstance(clock, Node) else ()
    asked = request(d, node, "unschedule")
    return replace(asked, when=When(times=times))


@meaning("rename_routine")
def rename_routine(d: Discourse, node: Node) -> Request:
    return request(d, node, "rename")


@meaning("ask_about_run")
def ask_about_run(d: Discourse, node: Node) -> Request:
    """ "what did she say?", "are you done?"."""
    kind: Kind = node.production.fixed["kind"]
    return request(d, node, kind)


# --- at what times: "every weekday at eight", read without knowing what time it is


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
        repeats=_part(node, "date") is None and not fixed.get("once"),
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
