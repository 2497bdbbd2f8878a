"""Quantities in the unit of the method table; times of day, and moments of a day that is said
("tomorrow at eight", "on Monday at nine", "tonight at ten"); words and values as they are."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, as_value
from grammar.errors import NotUnderstood
from grammar.meanings.registry import meaning
from grammar.plan import Call, Number, Text, Value
from grammar.requests import When
from grammar.times.bare_hours import NIGHT, hour_at_night, is_late, usual_hour
from robot_api.methods import WEEKDAYS

MIDNIGHT: Final = "00:00"
MOST_MIDNIGHTS: Final = 7
"""That somebody counts who says "in three days at eight"."""


@meaning("quantity")
def quantity(d: Discourse, node: Node) -> float:
    number = d.get(node, "number", 1.0)
    more = d.get(node, "more", 0.0)
    result: float = float(number) * float(node.production.fixed.get("unit", 1)) + float(more)
    return result


@meaning("percentage")
def percentage(d: Discourse, node: Node) -> float:
    """So many percent; a fraction is a part of the whole: "to a half"."""
    number = float(d.get(node, "number"))
    return 100 * number if 0 < number < 1 else number


@meaning("clock_time")
def clock_time(d: Discourse, node: Node) -> str:
    """A time of day as "HH:MM"."""
    time, guessed = time_said(d, node)
    if guessed:
        d.assumptions += ("pm",)
    return time


def time_said(d: Discourse, node: Node, half: str | None = None) -> tuple[str, bool]:
    """The same, and whether the half of the day is a guess; `half` is the one that is said
    elsewhere: "every evening at eight"."""
    fixed = node.production.fixed
    if "time" in fixed:
        return str(fixed["time"]), False
    given = d.get(node, "clock")
    if given:
        hours, minutes = (int(part) for part in given.split(":"))
    else:
        said = d.get(node, "hour")
        if int(said) != said:  # "half an hour" is no time of day
            raise NotUnderstood(
                d.language.phrase("no_such_time", time=d.words(node.start, node.end))
            )
        hours = int(said)
        minutes = int(d.get(node, "minute", 0))
    minutes += int(fixed.get("add", 0))
    if fixed.get("to"):
        minutes = -minutes
    if -60 < minutes < 0:  # "twenty to three", "trois heures moins vingt"
        hours, minutes = hours - 1 or 12, 60 + minutes
    half = d.get(node, "half_of_day", half)
    guessed = False
    if half == NIGHT:
        hours = hour_at_night(hours)
    if half == "pm" and hours < 12:
        hours += 12
    if half == "am" and hours == 12:
        hours = 0
    if half is None and not given:
        guessed = usual_hour(hours) != hours  # "at three": nobody has visitors at night
        hours = usual_hour(hours)
    if not (0 <= hours < 24 and 0 <= minutes < 60):
        raise NotUnderstood(d.language.phrase("no_such_time", time=d.words(node.start, node.end)))
    return f"{hours:02}:{minutes:02}", guessed


def time_meant(
    d: Discourse, node: Node, half: str | None = None, *, once: bool
) -> tuple[str, bool]:
    """A time of day in its usual reading, and whether it may be twelve hours off."""
    time, _ = time_said(d, node, half)
    bare = _without_half(d, node, half, once=once)
    return (f"{usual_hour(int(time[:2])):02}{time[2:]}" if bare else time), bare


def _without_half(d: Discourse, node: Node, half: str | None = None, *, once: bool) -> bool:
    """Whether it may be twelve hours off: a clock's face shows it, and nothing tells of which half
    of the day it is. Of what is done `once` even "8 Uhr" may be, which else means the morning."""
    if half is not None or "time" in node.production.fixed or d.get(node, "half_of_day"):
        return False
    whole_day = d.language.speech.get("whole_day_clock", ())
    if "clock" in node.parts:  # "08:30" is as clocks show it, "8:30" where they show twelve hours
        written = d.words(node.start, node.start + 1)
        return (
            once
            and not whole_day
            and 1 <= int(written.partition(":")[0]) <= 12
            and (not written.startswith("0"))
        )
    if not once and any(d.tokens[at].norm in whole_day for at in range(node.start, node.end)):
        return False  # "um 8 Uhr": who means the evening says 20
    return 1 <= int(d.get(node, "hour", 12)) <= 12


def after_midnight(when: When) -> When:
    """The early hours of a night are those of the day that follows: "on Friday night at one"."""
    if not when.times or any(is_late(each) for each in when.times):
        return when
    ahead = when.days_ahead
    return replace(
        when,
        weekdays=tuple(sorted((day + 1) % len(WEEKDAYS) for day in when.weekdays)),
        # "Tonight at one" is the next time that it is one, whenever that is said.
        days_ahead=None if not ahead else ahead + 1,
    )


def moment_said(d: Discourse, node: Node) -> When:
    """What a `<delay>` says: a time of day, or one of a day."""
    fixed = node.production.fixed
    clock = node.parts["clock_time" if node.means == "at_time" else "clock"]
    assert isinstance(clock, Node)
    half = fixed.get("half")
    time, is_bare = time_meant(d, clock, half, once=True)
    bare = (time,) if is_bare else ()
    if node.means == "at_time":
        return When(times=(time,), bare=bare)
    weekday = d.get(node, "weekday")
    when = When(
        times=(time,),
        bare=bare,
        weekdays=(WEEKDAYS.index(str(weekday)),) if weekday else (),
        days_ahead=None if weekday else _days(d, node),
    )
    return after_midnight(when) if half == NIGHT else when


@meaning("day_time")
def day_time(d: Discourse, node: Node) -> Steps:
    """A plan knows nothing of the day on which it is carried out: tomorrow begins when midnight has
    come."""
    clock: Any = node.parts["clock"]
    when = moment_said(d, node)
    time, guessed = time_said(d, clock, node.production.fixed.get("half"))
    if guessed:
        d.assumptions += ("pm",)
    arguments: dict[str, Value] = {"time": Text(time)}
    if when.weekdays:
        arguments["weekday"] = Text(WEEKDAYS[when.weekdays[0]])
    midnight = Call("wait_until", {"time": Text(MIDNIGHT)})
    return [*[midnight] * (when.days_ahead or 0), Call("wait_until", arguments)]


def _days(d: Discourse, node: Node) -> int:
    days = float(d.get(node, "days", 0))
    if days != int(days) or not 0 <= days <= MOST_MIDNIGHTS:
        said = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("no_such_time", time=said))
    return int(days)


def number_value(value: Any) -> Number:
    result = as_value(value)
    assert isinstance(result, Number)
    return result


@meaning("words")
def words(d: Discourse, node: Node) -> str:
    """The words themselves."""
    return d.words(node.start, node.end)


@meaning("fixed")
def fixed(d: Discourse, node: Node) -> Any:
    """A value that the rule states itself."""
    return node.production.fixed["value"]
