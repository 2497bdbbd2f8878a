"""Pepper's wheels: `move`, `turn`, `drive`.

All of it is `ALMotion.moveTo`, a way that ends by itself. A velocity (`moveToward`) would be kept
by Pepper for ever, also when nobody can reach it any more to end it.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Iterator
from typing import Any, Final, Literal

from robot_api.capabilities.driving import Motion
from robot_api.driver import StopFlag
from robot_api.errors import Blocked, NotPossible, NotSupported
from robot_api.robots.pepper.body import STOP_MOVING, Body
from robot_api.robots.pepper.session import Wire
from robot_api.robots.robot_file import Limits

_SLOWEST, _FASTEST = 0.1, 0.55
"""Metres per second that Pepper can be told to drive at."""
_TURNS_SLOWEST, _TURNS_FASTEST = 12.0, 114.0
"""Degrees per second, for 0.2 and 2 radians."""
_LEAST_ACCELERATION, _MOST_ACCELERATION = 0.1, 0.55
_SPEED: Final = 0.35
"""Metres per second, if nobody says another: Pepper's own choice."""
_TURN_RATE: Final = 57.0
_PIECE: Final = 90.0
"""Degrees that are turned in one go: more than half a turn could go round the other way."""

Speeds = list[list[Any]]
"""How fast, as NAOqi takes it."""


class PepperMotion(Motion):
    def __init__(self, wire: Wire, body: Body, limits: Limits) -> None:
        """Raises `NotSupported` for limits below what Pepper can keep to."""
        super().__init__()
        self._wire = wire
        self._body = body
        self._most = _within("speed", limits.speed, _SLOWEST, _FASTEST)
        self._most_turning = _within("turn_rate", limits.turn_rate, _TURNS_SLOWEST, _TURNS_FASTEST)
        self._acceleration = (
            None
            if limits.acceleration is None
            else _within(
                "acceleration", limits.acceleration, _LEAST_ACCELERATION, _MOST_ACCELERATION
            )
        )
        self._lock = threading.Lock()
        self._newest = 0  # the joystick's last call, which takes over from those before it

    def declares(self) -> dict[str, Any]:
        limits = {"speed": self._most, "turn_rate": self._most_turning}
        if self._acceleration is not None:
            limits["acceleration"] = self._acceleration
        return {"limits": limits}

    def move(self, stop: StopFlag, metres: float) -> None:
        self._body.be_ready(stop, to_drive=True)
        if not self._go(stop, metres, 0.0, 0.0, self.speeds()):
            raise Blocked(self._body.in_the_way("front" if metres > 0 else "back"))

    def turn(self, stop: StopFlag, degrees: float) -> None:
        self._body.be_ready(stop, to_drive=True)
        for piece in _pieces(degrees):
            if not self._go(stop, 0.0, 0.0, piece, self.speeds()):
                raise NotPossible(self._body.in_the_way())

    def drive(self, stop: StopFlag, linear: float, angular: float, seconds: float) -> None:
        with self._lock:
            mine = self._newest = self._newest + 1
        self._body.be_ready(stop, to_drive=True)
        speeds = self.speeds(abs(linear) or _SPEED, abs(angular) or _TURN_RATE)
        direction: Literal["front", "back"] = "front" if linear >= 0 else "back"
        for x, y, turned in _arcs(linear, angular, seconds):
            went = self._go(stop, x, y, turned, speeds)
            if self._newest != mine:
                return
            if not went:
                raise Blocked(self._body.in_the_way(direction))

    def speeds(self, speed: float = _SPEED, turn_rate: float = _TURN_RATE) -> Speeds:
        """How fast to drive, within what this robot may."""
        speed = min(max(speed, _SLOWEST), self._most)
        turn_rate = min(max(turn_rate, _TURNS_SLOWEST), self._most_turning)
        config: Speeds = [["MaxVelXY", speed], ["MaxVelTheta", math.radians(turn_rate)]]
        if self._acceleration is not None:
            config.append(["MaxAccXY", self._acceleration])
        return config

    def _go(self, stop: StopFlag, x: float, y: float, degrees: float, speeds: Speeds) -> bool:
        """Whether it got there."""
        went = self._wire.run(
            stop,
            "ALMotion",
            "moveTo",
            x,
            y,
            math.radians(degrees),
            speeds,
            ending=(STOP_MOVING,),
        )
        return went is not False  # older software says nothing


def _within(name: str, limit: float | None, least: float, most: float) -> float:
    """The robot file's limit, as far as the robot goes."""
    if limit is None:
        return most
    if limit < least:
        raise NotSupported(
            f"The robot file limits Pepper's {name} to {limit:g}, but its least is {least:g}."
            " Allow it that much."
        )
    return min(limit, most)


def _pieces(degrees: float) -> Iterator[float]:
    """A turn in pieces that cannot be mistaken."""
    whole = int(abs(degrees) // _PIECE)
    yield from [math.copysign(_PIECE, degrees)] * whole
    rest = abs(degrees) - whole * _PIECE
    if rest > 0:
        yield math.copysign(rest, degrees)


def _arcs(linear: float, angular: float, seconds: float) -> Iterator[tuple[float, float, float]]:
    """Where each piece of such a drive ends, from where it begins: metres ahead, metres to the
    left, degrees."""
    if angular == 0:
        yield linear * seconds, 0.0, 0.0
        return
    for turned in _pieces(angular * seconds):
        angle = math.radians(turned)
        radius = linear / math.radians(angular)
        yield radius * math.sin(angle), radius * (1 - math.cos(angle)), turned
