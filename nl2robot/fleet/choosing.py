"""Which robot does it best: pure functions of what is known of them.

A robot can do it if it has all methods that the program calls, is on the map that it was approved
for, is free, and is known to be so. The nearest to the first place is the best; half a battery less
counts as much as thirty metres.
"""

from __future__ import annotations

import ast
import math
from collections.abc import Iterable, Mapping
from typing import Final, Literal

from nl2robot.fleet.roll import Member
from robot_api.methods import METHODS

Why = Literal[
    "silent", "lacks", "map", "busy", "stopped", "lost", "driven", "charging", "low", "other"
]
"""Why a robot is not asked."""
_WAITS: Final[Mapping[str, Why]] = {
    "busy": "busy",
    "stopped": "stopped",
    "lost": "lost",
    "driven": "driven",
    "charging": "charging",
}
LOW: Final = 20.0
"""Percent, below which nobody is sent anywhere."""
METRES_OF_A_PERCENT: Final = 0.6
UNKNOWN_DISTANCE: Final = 200.0
"""Metres that stand for a way nobody knows."""


def called(program: str) -> frozenset[str]:
    """The methods of the robot that the program names."""
    return frozenset(
        each.attr
        for each in ast.walk(ast.parse(program))
        if isinstance(each, ast.Attribute)
        and isinstance(each.value, ast.Name)
        and each.value.id == "robot"
        and each.attr in METHODS
    )


def first_place(program: str) -> str | None:
    """The place that it goes to first, if that stands there by name."""
    calls = [each for each in ast.walk(ast.parse(program)) if isinstance(each, ast.Call)]
    for call in sorted(calls, key=lambda call: (call.lineno, call.col_offset)):
        match call:
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id="robot"), attr="goto"),
                args=[ast.Constant(value=str(place)), *_],
            ):
                return place
    return None


def unfit(member: Member, needs: Iterable[str], floor: str, now: float) -> Why | None:
    """Why this robot cannot do it now; None if it can."""
    about, standing = member.about, member.standing
    if about is None or standing is None or not member.known(now):
        return "silent"
    if about.map != floor:
        return "map"
    if not set(needs) <= set(about.methods):
        return "lacks"
    if standing.waits is not None:
        return _WAITS.get(standing.waits, "other")
    if standing.battery is not None and standing.battery < LOW:
        return "low"
    return None


def cost(member: Member, goal: tuple[float, float] | None) -> float:
    """The less, the better; metres, as it were."""
    standing = member.standing
    assert standing is not None
    battery = standing.battery if standing.battery is not None else 50.0
    metres = 0.0
    if goal is not None:
        metres = UNKNOWN_DISTANCE
        if standing.x is not None and standing.y is not None:
            metres = math.dist((standing.x, standing.y), goal)
    return metres + METRES_OF_A_PERCENT * (100.0 - battery)


def ranked(
    members: Iterable[Member],
    needs: Iterable[str],
    floor: str,
    goal: tuple[float, float] | None,
    now: float,
) -> tuple[list[str], Mapping[str, Why]]:
    """The ids of those that can do it, the best first, and why the others cannot."""
    fit: list[Member] = []
    why: dict[str, Why] = {}
    for each in members:
        trouble = unfit(each, needs, floor, now)
        if trouble is None:
            fit.append(each)
        else:
            why[each.id] = trouble
    fit.sort(key=lambda each: (cost(each, goal), each.id))
    return [each.id for each in fit], why
