"""The simulated robot's body and what it shows: a differential drive with a battery."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any

from sim.physics.bodies import STEP, RobotBody

SLOW_DOWN = 1.2
"""m/s²."""
TURN_CHANGE = 360.0
"""Degrees/s²."""

_IDLE_DRAIN = 100 / (10 * 3600)
_DRIVE_DRAIN = 100 / (4 * 3600)
_CHARGE = 100 / (1.5 * 3600)
"""Percent a second: ten hours of standing, four of driving, an hour and a half to charge."""


@dataclass(frozen=True)
class Pace:
    """How fast it drives at most."""

    speed: float = 0.9
    """m/s."""
    turn_rate: float = 110.0
    """Degrees a second."""
    acceleration: float = 0.8
    """m/s², with which it gets faster; it slows down by SLOW_DOWN."""

    def within(
        self, speed: float | None, turn_rate: float | None, acceleration: float | None
    ) -> Pace:
        """The same, but no faster than this; None: as before."""
        return Pace(
            min(self.speed, speed or self.speed),
            min(self.turn_rate, turn_rate or self.turn_rate),
            min(self.acceleration, acceleration or self.acceleration),
        )


@dataclass(frozen=True)
class RobotState:
    """The robot at one moment. Metres, degrees, m/s, percent."""

    x: float
    y: float
    theta: float
    place: str | None
    speed: float
    battery: float
    charging: bool
    holding: list[str]
    emotion: str
    joints: dict[str, float]
    volume: int
    language: str
    screen: dict[str, Any]
    """What was last shown: text, html, url or options."""


@dataclass
class Robot:
    """The body and its state; `aim` is what behaviours steer with."""

    body: RobotBody
    theta: float
    """Degrees, 0 along x, left is +, in (-180, 180]."""
    battery: float = 100.0
    charging: bool = False
    holding: list[int] = field(default_factory=list)
    """Numbers of things."""
    emotion: str = "neutral"
    joints: dict[str, float] = field(default_factory=dict)
    volume: int = 70
    language: str = "en"
    screen: dict[str, Any] = field(default_factory=dict)
    pace: Pace = Pace()
    speed: float = 0.0
    """What the wheels do now: m/s ahead, and `turning` degrees a second."""
    turning: float = 0.0
    wanted_speed: float = 0.0
    wanted_turning: float = 0.0
    driver: object = None
    """The behaviour that has the wheel."""
    waits_for: str | None = None
    """The person who is in its way and for whom it waits."""
    way: tuple[tuple[float, float], ...] = ()
    """Where it is about to drive, the next spot first; for those who look on."""

    def copy(self, body: RobotBody) -> Robot:
        """The same state with a body of another simulation; nobody has its wheel."""
        return replace(
            self,
            body=body,
            holding=list(self.holding),
            joints=dict(self.joints),
            screen=dict(self.screen),
            wanted_speed=0.0,
            wanted_turning=0.0,
            driver=None,
            waits_for=None,
            way=(),
        )

    @property
    def position(self) -> tuple[float, float]:
        return self.body.position

    @property
    def moving(self) -> bool:
        return self.speed != 0.0 or self.turning != 0.0

    def aim(self, speed: float, turning: float) -> None:
        """What to drive from now on; the wheels get there with bounded acceleration."""
        self.wanted_speed, self.wanted_turning = speed, turning

    def rest(self) -> None:
        """Stand still this instant."""
        self.speed = self.turning = self.wanted_speed = self.wanted_turning = 0.0
        self.body.rest()

    def step(self) -> None:
        """Before the physics step: bring wheels nearer to what is wanted."""
        if self.battery <= 0.0:
            self.wanted_speed = self.wanted_turning = 0.0
        braking = abs(self.wanted_speed) < abs(self.speed)
        self.speed = _towards(
            self.speed, self.wanted_speed, (SLOW_DOWN if braking else self.pace.acceleration) * STEP
        )
        self.turning = _towards(self.turning, self.wanted_turning, TURN_CHANGE * STEP)
        if self.turning:
            self.theta = wrap(self.theta + self.turning * STEP)
        heading = math.radians(self.theta)
        self.body.drive(self.speed * math.cos(heading), self.speed * math.sin(heading))

    def use_energy(self, on_charger: bool, steps: int = 1) -> None:
        """So many steps' worth."""
        self.charging = on_charger and not self.moving
        rate = _CHARGE if self.charging else -_DRIVE_DRAIN if self.moving else -_IDLE_DRAIN
        self.battery = min(100.0, max(0.0, self.battery + rate * STEP * steps))


def wrap(degrees: float) -> float:
    """The same direction in (-180, 180]."""
    if -180.0 < degrees <= 180.0:
        return degrees
    return 180.0 - (180.0 - degrees) % 360.0


def bearing(start: tuple[float, float], end: tuple[float, float]) -> float:
    """The direction from one spot to another, in degrees."""
    return math.degrees(math.atan2(end[1] - start[1], end[0] - start[0]))


def _towards(value: float, wanted: float, most: float) -> float:
    return value + max(-most, min(most, wanted - value))
