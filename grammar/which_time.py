"""Loops of which one only wants to know whether it is the first time, or the last: "three times, a
minute apart" waits every time but the first.

A program counts for that; whoever is told of it need not.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Literal

from grammar import plan as p
from grammar.traversal import nodes

Time = Literal["first", "last"]
_LOOPS = p.ForEach | p.Repeat | p.While | p.RepeatUntil | p.Forever


def which_time(compare: p.Compare, number: str, stop: p.Value) -> tuple[Time, bool] | None:
    """What a comparison of the number of this time says, if it says that, and whether it is so."""
    match compare:
        case p.Compare(left=p.Recall(name=name), operator=operator, right=right) if name == number:
            pass
        case _:
            return None
    if right == p.Number(0) and operator in ("==", "<=", "!=", ">"):
        return "first", operator in ("==", "<=")
    if right == p.Number(1) and operator in ("<", ">="):
        return "first", operator == "<"
    if right == _last(stop) and operator in ("==", ">=", "!=", "<"):
        return "last", operator in ("==", ">=")
    return None


def _last(stop: p.Value) -> p.Value:
    if isinstance(stop, p.Number):
        return p.Number(stop.value - 1)
    return p.Arithmetic(stop, "-", p.Number(1))


def asks_only_which_time(loop: p.ForEach) -> bool:
    """Whether that is all that its number is asked for."""
    if not isinstance(loop.items, p.Range) or loop.items.start != p.Number(0):
        return False
    spoken = sum(each == p.Recall(loop.variable) for each in nodes(loop.steps))
    asked = sum(
        isinstance(each, p.Compare) and which_time(each, loop.variable, loop.items.stop) is not None
        for each in _outside_of_loops(loop.steps)
    )
    return 0 < spoken == asked


def _outside_of_loops(part: Any) -> Iterator[p.Node]:
    """In a loop within, "the first time" would be that one's."""
    if isinstance(part, _LOOPS):
        return
    if isinstance(part, p.Node):
        yield part
        for name in part.__struct_fields__:
            yield from _outside_of_loops(getattr(part, name))
    elif isinstance(part, tuple):
        for each in part:
            yield from _outside_of_loops(each)
