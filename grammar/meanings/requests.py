"""What is asked of the application about routines, commands that go by a name; and their steps
among others (`grammar.understand` enters what the name of one means)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from datetime import date
from typing import Any, Final

import msgspec

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps
from grammar.errors import NotUnderstood
from grammar.lexicon import Name, Routine
from grammar.meanings.amounts import after_midnight, time_meant, time_said
from grammar.meanings.registry import meaning
from grammar.plan import Call, ForEach, Plan, Remember, Try
from grammar.requests import Kind, Request, When
from grammar.tidy import nodes
from grammar.times.bare_hours import NIGHT, end_of
from robot_api.methods import WEEKDAYS

A_MINUTE: Final = 60
A_LEAP_YEAR: Final = 2028
MOST_DAYS_AHEAD: Final = 366


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
    part, sentence = node.parts["part"], node.parts["sentence"]
    if 0 < part.start < sentence.start and d.tokens[part.start - 1].kind != "mark":
        # "va chaque matin à huit heures à la réception"
        begin = d.words(0, part.start)
        asked = replace(asked, sentence=f"{begin} {asked.sentence}")
    return replace(asked, when=d.build(part))


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
    repeats = _part(node, "date") is None and not fixed.get("once")
    since, until = _window(d, node)
    pace = _part(node, "pace")
    when = When(
        weekdays=_weekdays(d, node, str(fixed.get("weekdays", ""))),
        minutes=int(fixed["minutes"]) if "minutes" in fixed else None,
        days_ahead=_ahead(d, days, fixed),
        date=_date(d, node),
        repeats=repeats,
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
    said: list[tuple[str, bool]] = []
    for each in _named(node, "clock"):
        time, bare = time_meant(d, each, half, once=not repeats)
        said.append((time, bare and not fixed.get("working")))
    if not said and "at" in fixed:
        said.append((str(fixed["at"]), False))
    when = replace(
        when,
        times=tuple(time for time, _ in said),
        bare=tuple(dict.fromkeys(time for time, bare in said if bare)),
    )
    if not said:
        when = replace(when, half=half)
    return after_midnight(when) if half == NIGHT else when


def _ahead(d: Discourse, said: Node | None, fixed: Mapping[str, Any]) -> int | None:
    """How many days from now, as words say it: "tomorrow", "in three days"."""
    if said is not None and "number" in said.parts:
        days = float(d.get(said, "number")) * float(fixed.get("unit", 1))
        if days != int(days) or not 0 <= days <= MOST_DAYS_AHEAD:
            words = d.words(said.start, said.end)
            raise NotUnderstood(d.language.phrase("no_such_time", time=words))
        return int(days)
    return int(fixed["ahead"]) if "ahead" in fixed else None


def _window(d: Discourse, node: Node) -> tuple[str | None, str | None]:
    first, last = _part(node, "since"), _part(node, "until")
    since = time_said(d, first)[0] if first is not None else None
    if last is None:
        return since, None
    return since, end_of(since, *time_meant(d, last, once=True))


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
    said = [
        WEEKDAYS.index(d.build(leaf))
        for leaf in _leaves(node)
        if leaf.slot in ("weekday", "weekdays", "weekday_am", "weekday_pm", "weekday_night")
    ]
    days = _part(node, "days")
    if days is not None and days.production.fixed.get("range"):
        first, last = said
        said = [
            (first + each) % len(WEEKDAYS) for each in range((last - first) % len(WEEKDAYS) + 1)
        ]
    return tuple(sorted(set(said)))


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
