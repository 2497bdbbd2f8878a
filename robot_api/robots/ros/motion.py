"""Driving by velocities: `drive`, `move`, `turn`.

A velocity is repeated twenty times a second, because a robot stops by itself when it no longer
hears one; so it also stops when we are gone. Odometry says when a movement is over, and one without
odometry is none.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from typing import Any

from robot_api.capabilities.driving import Motion
from robot_api.driver import StopFlag
from robot_api.errors import Blocked, LostConnection, NotPossible
from robot_api.robots.link import Link
from robot_api.robots.robot_file import Limits
from robot_api.robots.ros.connection import Line
from robot_api.robots.ros.dialect import Dialect, plain, wrapped
from robot_api.robots.ros.keep_out import Guarding, KeepOut
from robot_api.robots.ros.settings import RosSettings
from robot_api.robots.ros.wheels import Moment, Wheels, Whereabouts

_PERIOD = 0.05
_ODOMETRY = 0.5
"""Seconds for which it drives on without a word from its odometry."""
_STUCK_AFTER = 2.0
"""Seconds that its wheels may be told to turn without turning."""
_TURN_ACCELERATION = math.radians(120)
_NEAR_ENOUGH = (0.01, math.radians(1.0))
_CREEP = (0.03, math.radians(6.0))
"""Metres and radians per second at which it ends a movement."""
_ROLLS_OUT = 2.0
"""Seconds that it has to come to stand at the end."""


class Velocity:
    """The topic that sets it, on a connection."""

    def __init__(self, line: Line, topic: str, kind: str, dialect: Dialect, frame: str) -> None:
        self._line = line
        self._topic = topic
        self._header = dialect.header(frame) if plain(kind).endswith("TwistStamped") else None
        line.advertise(topic, kind)

    def set(self, ahead: float, turning: float) -> None:
        """Metres and radians per second. Raises `LostConnection`."""
        twist: Mapping[str, Any] = {
            "linear": {"x": ahead, "y": 0.0, "z": 0.0},
            "angular": {"x": 0.0, "y": 0.0, "z": turning},
        }
        if self._header is not None:
            twist = {"header": self._header, "twist": twist}
        self._line.publish(self._topic, twist, repeated=True)

    def still(self) -> None:
        self.set(0.0, 0.0)


class RosMotion(Motion):
    def __init__(
        self,
        velocity: Velocity,
        wheels: Wheels,
        where: Whereabouts | None,
        keep_out: KeepOut,
        link: Link,
        limits: Limits,
        settings: RosSettings,
    ) -> None:
        self._velocity = velocity
        self._wheels = wheels
        self._where = where
        self._keep_out = keep_out
        self._link = link
        self._top = _most(limits.speed), math.radians(_most(limits.turn_rate))
        self._usual = (
            min(settings.speed, self._top[0]),
            min(math.radians(settings.turn_rate), self._top[1]),
        )
        self._acceleration = (
            min(settings.acceleration, _most(limits.acceleration)),
            _TURN_ACCELERATION,
        )

    def drive(self, stop: StopFlag, linear: float, angular: float, seconds: float) -> None:
        end = time.monotonic() + seconds
        wanted = (_at_most(linear, self._top[0]), _at_most(math.radians(angular), self._top[1]))
        self._go(stop, lambda _: wanted if time.monotonic() < end else None)

    def move(self, stop: StopFlag, metres: float) -> None:
        start = self._odometry().pose

        def wanted(moment: Moment) -> tuple[float, float] | None:
            gone = math.hypot(moment.pose.x - start.x, moment.pose.y - start.y)
            speed = self._towards(0, abs(metres) - gone)
            return None if speed is None else (math.copysign(speed, metres), 0.0)

        self._go(stop, wanted)

    def turn(self, stop: StopFlag, degrees: float) -> None:
        heading, turned = self._odometry().pose.theta, 0.0

        def wanted(moment: Moment) -> tuple[float, float] | None:
            nonlocal heading, turned
            turned += wrapped(moment.pose.theta - heading)
            heading = moment.pose.theta
            direction = math.copysign(1.0, degrees)
            speed = self._towards(1, math.radians(abs(degrees)) - turned * direction)
            return None if speed is None else (0.0, direction * speed)

        try:
            self._go(stop, wanted)
        except Blocked as error:  # which turning on the spot is never said to be
            raise NotPossible(str(error)) from None

    # --- inside ----------------------------------------------------------------------------------

    def _odometry(self) -> Moment:
        self._link.check()
        return self._wheels.now(_ODOMETRY)

    def _towards(self, axis: int, remaining: float) -> float | None:
        """How fast to go with so much of it before it; None when it is there."""
        if remaining < _NEAR_ENOUGH[axis]:
            return None
        braking = math.sqrt(2 * self._acceleration[axis] * remaining)
        return min(self._usual[axis], max(braking, _CREEP[axis]))

    def _go(self, stop: StopFlag, wanted: Callable[[Moment], tuple[float, float] | None]) -> None:
        """Drive as `wanted` says, until that is None; then the robot stands, whatever happens."""
        guarding = Guarding(self._keep_out)
        stuck = _Stuck()
        ahead = turning = 0.0
        try:
            while (speeds := wanted(moment := self._odometry())) is not None:
                guarding.check(self._where.guess() if self._where else None)
                ahead = _nearer(ahead, speeds[0], self._acceleration[0] * _PERIOD)
                turning = _nearer(turning, speeds[1], self._acceleration[1] * _PERIOD)
                stuck.check(moment, ahead, turning)
                stop.check()
                self._velocity.set(ahead, turning)
                stop.wait(_PERIOD)
            self._roll_out(stop)
        finally:
            self._stand()

    def _roll_out(self, stop: StopFlag) -> None:
        """Until it stands, so that the next movement begins where this one ended."""
        began = time.monotonic()
        while not self._wheels.stands_since(began):
            stop.check()
            self._odometry()
            if time.monotonic() - began > _ROLLS_OUT:
                raise NotPossible("I do not come to stand. Use my own button to stop me.")
            self._velocity.still()
            stop.wait(_PERIOD)

    def _stand(self) -> None:
        try:
            self._velocity.still()
        except LostConnection:
            return  # it hears no velocity any more, and stops by itself


class _Stuck:
    """Notices that the wheels do not do what they are told."""

    def __init__(self) -> None:
        self._since = time.monotonic()
        self._last: Moment | None = None

    def check(self, moment: Moment, ahead: float, turning: float) -> None:
        last, now = self._last, time.monotonic()
        if (
            last is None
            or math.hypot(moment.pose.x - last.pose.x, moment.pose.y - last.pose.y) > 0.01
            or abs(wrapped(moment.pose.theta - last.pose.theta)) > math.radians(1)
            or (abs(ahead) < 0.01 and abs(turning) < math.radians(1))
        ):
            self._last, self._since = moment, now
        elif now - self._since > _STUCK_AFTER:
            raise Blocked(
                "I try to drive, but do not move. Look what holds me, and whether I may drive."
            )


def _most(limit: float | None) -> float:
    return math.inf if limit is None else limit


def _at_most(value: float, most: float) -> float:
    return max(-most, min(most, value))


def _nearer(value: float, wanted: float, step: float) -> float:
    return value + _at_most(wanted - value, step)
