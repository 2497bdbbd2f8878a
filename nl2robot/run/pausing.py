"""A pause halts the wheels: a movement is broken off, and what is left of it is made later.

A way to a place is simply asked for again. Of a `move`, a `turn` and a `drive` only the rest is
made, which an `Odometer` tells from the robot's poses. So it is when a program goes on after a stop
(`going_on`), from what the log has of it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from typing import Any, Final

import msgspec

from robot_api.client import Robot
from robot_api.methods import METHODS
from robot_api.values import Location

_LIMBS: Final = frozenset({"gesture", "joints"})
"""The capabilities that move the body and no wheel."""
DRIVING: Final = frozenset(
    name for name, method in METHODS.items() if method.moves and method.capability not in _LIMBS
)
"""The methods that turn the wheels. They are broken off by a pause; all others end by themselves
while the robot stands."""
MEASURED: Final = frozenset({"move", "turn", "drive"})
"""Those of which only the rest is made after a pause or a stop."""

_LOOKS: Final = 0.1
"""Seconds between two looks whether the robot stands."""
_STANDS_FOR: Final = 0.3
"""Seconds in which it has to be seen at the same spot. Two looks are not enough: over a radio that
falters, both are told the pose from before."""
_SAME_SPOT: Final = 0.008
"""Metres that the poses of a robot that stands may differ by."""
_SAME_HEADING: Final = 0.6
"""The same in degrees."""
_NOTHING_LEFT: Final = {"move": 0.03, "turn": 2.0, "drive": 0.05}
"""Metres, degrees and seconds that are not worth making."""


class Made(msgspec.Struct, frozen=True):
    """How much of a movement is made."""

    metres: float
    """Along the robot's own heading, forwards positive."""
    degrees: float
    """To the left positive."""


class Odometer:
    """Adds up what a movement has made."""

    def __init__(self, start: Mapping[str, Any] | None) -> None:
        """`start` is a pose: x, y (metres), theta (degrees)."""
        self._metres = 0.0
        self._degrees = 0.0
        self._last = start

    @property
    def made(self) -> Made | None:
        """None where nobody has told it a pose."""
        return Made(self._metres, self._degrees) if self._last is not None else None

    def at(self, pose: Mapping[str, Any]) -> None:
        """The robot is here now."""
        last, self._last = self._last, pose
        if last is None:
            return
        turned = (pose["theta"] - last["theta"] + 180.0) % 360.0 - 180.0
        heading = math.radians(last["theta"] + turned / 2)
        east, north = pose["x"] - last["x"], pose["y"] - last["y"]
        self._degrees += turned
        self._metres += east * math.cos(heading) + north * math.sin(heading)


def rest_of(method: str, arguments: dict[str, Any], made: Made | None) -> dict[str, Any] | None:
    """The arguments of the call that makes what is left; None if nothing is. All of it is left
    where nobody knows how much was made."""
    if made is None:
        return arguments
    match method:
        case "move":
            name, whole, done = "metres", arguments["metres"], made.metres
        case "turn":
            name, whole, done = "degrees", arguments["degrees"], made.degrees
        case "drive":
            name, whole, done = "seconds", arguments["seconds"], _seconds(arguments, made)
        case _:
            return arguments
    left = whole - done
    if left * whole <= 0 or abs(left) < _NOTHING_LEFT[method]:
        return None
    return {**arguments, name: round(left, 3)}


def _seconds(arguments: Mapping[str, Any], made: Made) -> float:
    """How much of a `drive` was made."""
    linear, angular = float(arguments["linear"]), float(arguments["angular"])
    if abs(linear) >= 0.02:
        return max(0.0, made.metres / linear)
    return max(0.0, made.degrees / angular) if angular else 0.0


def comes_to_rest(robot: Robot, within: float, goes_on: Callable[[], bool]) -> bool:
    """Look at the robot until it stands, at most `within` seconds; raises as `Robot.location`."""
    ends = time.monotonic() + within
    spot, since = robot.location(), time.monotonic()
    while goes_on():
        time.sleep(_LOOKS)
        now, at = robot.location(), time.monotonic()
        if not _same(spot, now):
            spot, since = now, at
        elif at - since >= _STANDS_FOR:
            return True
        if at > ends:
            return False
    return False


def pose_of(location: Location) -> dict[str, Any]:
    """As the event `pose` has it."""
    return {"x": location.x, "y": location.y, "theta": location.theta}


def _same(one: Location, other: Location) -> bool:
    turned = (one.theta - other.theta + 180.0) % 360.0 - 180.0
    apart = math.hypot(one.x - other.x, one.y - other.y)
    return apart <= _SAME_SPOT and abs(turned) <= _SAME_HEADING
