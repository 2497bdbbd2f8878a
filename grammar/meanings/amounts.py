"""Quantities in the unit of the method table; times of day; words and values as they are."""

from __future__ import annotations

from typing import Any, Final

from grammar.chart import Node
from grammar.discourse import Discourse, as_value
from grammar.errors import NotUnderstood
from grammar.meanings.registry import meaning
from grammar.plan import Number

LAST_HOUR_MEANT_PM: Final = 6
"""Up to "six o'clock" is in the afternoon where nothing else is said."""


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
        d.assumptions.append("pm")
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
        hours, minutes = hours - 1, 60 + minutes
    half = d.get(node, "half_of_day", half)
    guessed = False
    if half == "pm" and hours < 12:
        hours += 12
    if half == "am" and hours == 12:
        hours = 0
    if half is None and not given and 1 <= hours <= LAST_HOUR_MEANT_PM:
        hours += 12  # "at three": nobody has visitors at night
        guessed = True
    if not (0 <= hours < 24 and 0 <= minutes < 60):
        raise NotUnderstood(d.language.phrase("no_such_time", time=d.words(node.start, node.end)))
    return f"{hours:02}:{minutes:02}", guessed


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
