"""The rest of the body: what every robot has, and joints."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from robot_api.capabilities.arms import Joints
from robot_api.capabilities.base import POLL, Hub
from robot_api.capabilities.core import Core, LogBook
from robot_api.driver import StopFlag
from robot_api.errors import NotPossible, NotSupported
from robot_api.local_time import local_now
from robot_api.robots.places import NamedPlace
from robot_api.robots.ros import dialect as ros
from robot_api.robots.ros.actions import SUCCEEDED, Action
from robot_api.robots.ros.halting import Halting

_CHARGING = 1
"""sensor_msgs/BatteryState: POWER_SUPPLY_STATUS_CHARGING."""
_BATTERY_WITHIN = 3.0
_JOINT_RATE = math.radians(45)
_JOINT_WITHIN = 3.0
"""Seconds beyond its time in which a joint has to have arrived."""
_JOINT_NEAR = math.radians(3)
_JOINT_NEWS = 0.5
"""Degrees by which a joint has to turn to be told of."""
_JOINT_AGAIN = 10.0
"""Seconds after which one that stands still is told of again."""


class Battery:
    """What the robot says of its battery."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub
        self._told: tuple[int, bool] | None = None
        self.expected = False
        """Whether there is a topic that tells."""

    def hear(self, message: Mapping[str, Any]) -> None:
        """A sensor_msgs/BatteryState. Some robots give percent, some a fraction, as they should."""
        charge = ros.number(message.get("percentage"))
        if charge is None or charge < 0:
            return
        percent = round(min(100.0, charge if charge > 1 else 100 * charge))
        told = percent, message.get("power_supply_status") == _CHARGING
        if told != self._told:
            self._told = told
            self._hub.publish("battery", percent=percent, charging=told[1])

    @property
    def percent(self) -> float | None:
        return None if self._told is None else float(self._told[0])


class RosCore(Core):
    def __init__(
        self,
        book: LogBook,
        halting: Halting,
        battery: Battery,
        places: Mapping[str, NamedPlace],
        stop_within: float,
    ) -> None:
        super().__init__(book)
        self._halting = halting
        self._battery = battery
        self._places = places
        self._stop_within = stop_within

    def wait(self, stop: StopFlag, seconds: float) -> None:
        stop.wait(seconds)
        stop.check()

    def place_kinds(self) -> Mapping[str, str]:
        return {name: place.kind for name, place in self._places.items()}

    def now(self) -> datetime:
        return local_now()

    def battery(self, stop: StopFlag) -> int:
        """Waits for the first word of it, which comes rarely."""
        end = time.monotonic() + _BATTERY_WITHIN
        while self._battery.expected and self._battery.percent is None and time.monotonic() < end:
            stop.wait(POLL)
            stop.check()
        return super().battery(stop)

    def charge(self) -> float:
        percent = self._battery.percent
        if percent is None:
            raise NotSupported(
                "I cannot tell how full my battery is. Look at the display of the robot itself."
            )
        return percent

    def rest(self) -> None:
        self._halting.halt()

    def declares(self) -> dict[str, Any]:
        return {"stop_within": self._stop_within}


class JointStates:
    """The angles of all joints, in radians, as the robot tells them.

    Of those in `shown`, the changes are told to whoever listens at the hub; and now and then all,
    for who came later.
    """

    def __init__(self, hub: Hub, shown: Collection[str]) -> None:
        self.angles: dict[str, float] = {}
        self.heard = threading.Event()
        self._hub = hub
        self._shown = shown
        self._told: dict[str, tuple[float, float]] = {}
        """Each with the degrees that were told last, and when."""

    def hear(self, message: Mapping[str, Any]) -> None:
        """A sensor_msgs/JointState."""
        names, positions = message.get("name") or (), message.get("position") or ()
        for name, position in zip(names, positions, strict=False):
            angle = ros.number(position)
            if angle is not None:
                self.angles[str(name)] = angle
        self.heard.set()
        self._tell()

    def _tell(self) -> None:
        now = time.monotonic()
        for name in self._shown:
            if name not in self.angles:
                continue
            degrees = round(math.degrees(self.angles[name]), 1)
            told, when = self._told.get(name, (math.inf, -math.inf))
            if abs(degrees - told) >= _JOINT_NEWS or now - when > _JOINT_AGAIN:
                self._told[name] = degrees, now
                self._hub.publish("joint", name=name, degrees=degrees)


@dataclass(frozen=True)
class Controller:
    """A joint controller: an action, or a topic that takes a trajectory and says nothing."""

    joints: Sequence[str]
    action: Action | None = None
    publish: Callable[[Mapping[str, Any]], None] | None = None


class RosJoints(Joints):
    def __init__(
        self,
        controllers: Sequence[Controller],
        states: JointStates,
        ranges: Mapping[str, tuple[float, float]],
        dialect: ros.Dialect,
    ) -> None:
        self._of = {joint: controller for controller in controllers for joint in controller.joints}
        self._states = states
        self.ranges = ranges
        self._dialect = dialect

    def set_joint(self, stop: StopFlag, joint: str, degrees: float) -> None:
        controller, angle = self._of[joint], math.radians(degrees)
        here = self._states.angles.get(joint)
        seconds = max(1.0, abs(angle - here) / _JOINT_RATE if here is not None else 2.0)
        trajectory = self._trajectory(controller, joint, angle, seconds)
        if controller.action is not None:
            self._pursue(stop, controller.action, {"trajectory": trajectory}, joint, seconds)
            return
        assert controller.publish is not None
        controller.publish(trajectory)
        end = time.monotonic() + seconds + _JOINT_WITHIN
        while not self._there(joint, angle):
            if time.monotonic() > end:
                raise _held_up(joint)
            stop.wait(POLL)
            stop.check()

    def _pursue(
        self, stop: StopFlag, action: Action, goal: Mapping[str, Any], joint: str, seconds: float
    ) -> None:
        pursuit = action.start(goal, stop)
        end = time.monotonic() + seconds + _JOINT_WITHIN
        try:
            while not pursuit.ended.wait(POLL):
                stop.check()
                if time.monotonic() > end:
                    raise _held_up(joint)
        except BaseException:
            action.give_up(pursuit)
            raise
        stop.check()
        if pursuit.outcome != SUCCEEDED:
            raise _held_up(joint)

    def _trajectory(
        self, controller: Controller, joint: str, angle: float, seconds: float
    ) -> dict[str, Any]:
        """All joints of the controller, which takes no fewer: the others stay where they are."""
        known = self._states.angles
        joints = [name for name in controller.joints if name == joint or name in known]
        return {
            "joint_names": joints,
            "points": [
                {
                    "positions": [angle if name == joint else known[name] for name in joints],
                    "time_from_start": self._dialect.duration(seconds),
                }
            ],
        }

    def _there(self, joint: str, angle: float) -> bool:
        here = self._states.angles.get(joint)
        return here is not None and abs(here - angle) < _JOINT_NEAR


def _held_up(joint: str) -> NotPossible:
    return NotPossible(
        f"My joint {joint} has not come where it should. Look whether something holds it."
    )
