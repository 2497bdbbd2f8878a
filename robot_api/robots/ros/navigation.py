"""Finding its way: NavigateToPose of Nav2, move_base of ROS 1."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from robot_api.capabilities.base import POLL
from robot_api.capabilities.driving import Dock, Goal, Navigation
from robot_api.driver import StopFlag
from robot_api.errors import Blocked, InvalidCall, NotPossible, RobotError
from robot_api.robots.link import Link
from robot_api.robots.places import Places
from robot_api.robots.ros.actions import ABORTED, CANCELED, SUCCEEDED, Action, Pursuit
from robot_api.robots.ros.dialect import Dialect, Pose, field, number
from robot_api.robots.ros.keep_out import Guarding, KeepOut
from robot_api.robots.ros.settings import RosSettings
from robot_api.robots.ros.wheels import Wheels, Whereabouts
from robot_api.values import Location

_BEGINS_WITHIN = 10.0
"""Seconds in which a goal is heard of."""
_LOOK_EVERY = 0.1
_PROGRESS = 0.05
"""Metres that count as getting on."""
_LOCALIZE_WITHIN = 3.0
_LOCALIZE_AGAIN = 0.5

_UNKNOWN_START = (
    "I do not know well enough where I am to find a way. Show me where I am on the map."
)
_NO_WAY = "I have found no way there. Clear the way, or send me somewhere else."
_STUCK = "I could not get on, and have given up. Clear the way, then send me again."
REASONS: Mapping[int, tuple[type[RobotError], str]] = {
    102: (NotPossible, _UNKNOWN_START),
    103: (Blocked, _NO_WAY),
    104: (Blocked, _STUCK),
    105: (Blocked, _STUCK),
    106: (Blocked, _STUCK),
    107: (NotPossible, "My wheels' control was too slow, so I have stopped. Send me again."),
    202: (NotPossible, _UNKNOWN_START),
    203: (NotPossible, "I am outside my map. Show me where I am on the map."),
    204: (NotPossible, "That place is outside my map. Send me somewhere on it."),
    205: (Blocked, "I stand too close to something to drive off. Make room around me."),
    206: (Blocked, "Something stands at that place. Clear it, or send me somewhere else."),
    207: (NotPossible, "Finding a way has taken too long. Send me again, or somewhere nearer."),
    208: (Blocked, _NO_WAY),
}
"""What Nav2's error codes mean (nav2_msgs/FollowPath, ComputePathToPose)."""
_WORDS = (
    (("valid plan", "no path", "no valid path"), 208),
    (("off the global costmap", "outside the map", "off the map", "out of bounds"), 204),
    (("timed out", "timeout", "time out"), 207),
    (("stuck", "oscillat", "collision", "progress"), 105),
)
"""What move_base says, for want of a code."""


@dataclass(frozen=True)
class Bounds:
    """The robot's map: how large it is, and where."""

    origin: Pose
    width: float
    height: float

    def hold(self, x: float, y: float) -> bool:
        inside = self.origin.inverse().times(Pose(x, y, 0.0))
        return 0 <= inside.x <= self.width and 0 <= inside.y <= self.height


@dataclass(frozen=True, kw_only=True)
class Way:
    """What is needed to drive somewhere, whatever for."""

    action: Action
    link: Link
    wheels: Wheels
    where: Whereabouts
    keep_out: KeepOut
    settings: RosSettings

    def pursue(self, stop: StopFlag, message: Mapping[str, Any], task: str) -> Pursuit:
        """Returns when it has ended, however. `task`: "drive there". Raises `Blocked` if it does
        not get on or enters a zone, `NotPossible` if nothing happens."""
        self.link.check()
        guarding = Guarding(self.keep_out)
        pursuit = self.action.start(message, stop)
        progress = _Progress(self.settings.patience)
        looked = began = time.monotonic()
        try:
            while not pursuit.ended.wait(POLL):
                stop.check()
                self.link.check()
                now = time.monotonic()
                if now - looked < _LOOK_EVERY:
                    continue
                looked = now
                guarding.check(self.where.guess())
                if not pursuit.heard and now - began > _BEGINS_WITHIN:
                    raise NotPossible(
                        f"I was told to {task}, but nothing has begun for {_BEGINS_WITHIN:g}"
                        " seconds. Tell whoever looks after the robot."
                    )
                moment = self.wheels.last()
                remaining = number(field(pursuit.feedback, "distance_remaining"))
                progress.check(now, moment.pose if moment else None, remaining)
        except BaseException:
            self.action.give_up(pursuit)
            raise
        stop.check()  # which is why it was cancelled, perhaps
        self.link.check()
        return pursuit


class _Progress:
    """Whether it gets on."""

    def __init__(self, patience: float) -> None:
        self._patience = patience
        self._since = time.monotonic()
        self._pose: Pose | None = None
        self._remaining: float | None = None

    def check(self, now: float, pose: Pose | None, remaining: float | None) -> None:
        if self._moved(pose) or self._nearer(remaining):
            self._since, self._pose, self._remaining = now, pose, remaining
        elif now - self._since > self._patience:
            raise Blocked(
                f"I have not got on for {self._patience:g} seconds, and have given up."
                " Clear the way, then send me again."
            )

    def _moved(self, pose: Pose | None) -> bool:
        if pose is None:
            return False
        last = self._pose
        return (
            last is None
            or math.hypot(pose.x - last.x, pose.y - last.y) > _PROGRESS
            or abs(pose.theta - last.theta) > _PROGRESS
        )

    def _nearer(self, remaining: float | None) -> bool:
        if remaining is None:
            return False
        return self._remaining is None or remaining < self._remaining - _PROGRESS


class RosNavigation(Navigation):
    """`set_pose` tells the robot where it is, where it takes that; None where it does not."""

    def __init__(
        self,
        way: Way,
        dialect: Dialect,
        places: Places,
        bounds: Bounds | None,
        set_pose: Callable[[Pose], None] | None,
    ) -> None:
        self._way = way
        self._dialect = dialect
        self._places = places
        self._bounds = bounds
        self._set_pose = set_pose

    def offers(self) -> tuple[str, ...]:
        return tuple(
            name for name in super().offers() if name != "localize" or self._set_pose is not None
        )

    def locate(self, place: str) -> Goal:
        return self._places.goal_of(place)

    def drive_to(self, stop: StopFlag, goal: Goal) -> None:
        self._check(goal)
        frame = self._way.settings.frames.map
        target = {"header": self._dialect.header(frame), "pose": self._pose(goal).message()}
        one = self._dialect.version == 1
        message = {"target_pose": target} if one else {"pose": target, "behavior_tree": ""}
        pursuit = self._way.pursue(stop, message, "drive there")
        if pursuit.outcome != SUCCEEDED:
            raise failure(pursuit)
        self._check_arrival(goal)

    def location(self, stop: StopFlag) -> Location:
        self._way.link.check()
        return self.location_at(self._way.where.now())

    def location_at(self, pose: Pose) -> Location:
        """With the place that is near, if one is."""
        near = self._places.near(pose.x, pose.y, self._way.settings.place_radius)
        return Location(pose.x, pose.y, math.degrees(pose.theta), near)

    def localize(
        self,
        stop: StopFlag,
        place: str | Location | None = None,
        x: float | None = None,
        y: float | None = None,
        theta: float | None = None,
    ) -> None:
        self._believe(stop, self.goal(place, x, y, theta))

    def believe(self, goal: Goal) -> None:
        self._believe(StopFlag(), goal)

    # --- inside ----------------------------------------------------------------------------------

    def _believe(self, stop: StopFlag, goal: Goal) -> None:
        """Tell it until it says the same: the first message after advertising is often lost."""
        assert self._set_pose is not None
        _check_numbers(goal)
        where, pose = self._way.where, self._pose(goal)
        known, told = where.fixes, -math.inf
        end = time.monotonic() + _LOCALIZE_WITHIN
        while not (where.fixes > known and _near(where.guess(), pose)):
            self._way.link.check()
            now = time.monotonic()
            if now >= end:
                raise NotPossible(
                    "I was shown where I am, but my map says otherwise. Show me once more."
                )
            if now - told > _LOCALIZE_AGAIN:
                told = now
                self._set_pose(pose)
            stop.wait(POLL)
            stop.check()

    def _check(self, goal: Goal) -> None:
        _check_numbers(goal)
        if self._bounds is not None and not self._bounds.hold(goal.x, goal.y):
            raise REASONS[204][0](REASONS[204][1])
        self._way.keep_out.check_goal(goal.x, goal.y)

    def _check_arrival(self, goal: Goal) -> None:
        here = self._way.where.guess()
        if here is None:
            return
        missing = math.hypot(goal.x - here.x, goal.y - here.y)
        if missing > self._way.settings.arrival:
            raise NotPossible(
                f"My navigation says that I have arrived, but I stand {missing:.1f} metres away."
                " Send me again."
            )

    def _pose(self, goal: Goal) -> Pose:
        """Facing where it would come from, if nobody has said where to."""
        if goal.theta is not None:
            return Pose(goal.x, goal.y, math.radians(goal.theta))
        here = self._way.where.guess()
        if here is None or math.hypot(goal.x - here.x, goal.y - here.y) < _PROGRESS:
            return Pose(goal.x, goal.y, here.theta if here else 0.0)
        return Pose(goal.x, goal.y, math.atan2(goal.y - here.y, goal.x - here.x))


class RosDock(Dock):
    """DockRobot, where there is such an action; else it drives to a place to charge at."""

    def __init__(
        self, navigation: RosNavigation, charger: str | None, docking: Way | None, dock_id: str
    ) -> None:
        self._navigation = navigation
        self._charger = charger
        self._docking = docking
        self._dock_id = dock_id

    def dock(self, stop: StopFlag) -> None:
        if self._docking is None:
            if self._charger is None:
                raise NotPossible("There is no charging station here. Send me to a place instead.")
            self._navigation.drive_to(stop, self._navigation.locate(self._charger))
            return
        message = {
            "use_dock_id": bool(self._dock_id),
            "dock_id": self._dock_id,
            "navigate_to_staging_pose": True,
            "max_staging_time": 1000.0,
        }
        pursuit = self._docking.pursue(stop, message, "dock")
        if pursuit.outcome != SUCCEEDED or field(pursuit.values, "success") is False:
            raise NotPossible(
                f"I could not dock{_quoted(pursuit.text)}."
                " Look whether the charging station is free."
            )


def failure(pursuit: Pursuit) -> RobotError:
    """Why it did not arrive."""
    if pursuit.outcome == CANCELED:
        return NotPossible(
            "Somebody else has called me off on my way. Send me again when I am free."
        )
    code = field(pursuit.values, "error_code")
    if code not in REASONS:
        said = pursuit.text.lower()
        code = next((known for words, known in _WORDS if any(word in said for word in words)), None)
    if code in REASONS:
        kind, reason = REASONS[code]
        return kind(reason)
    if pursuit.outcome == ABORTED:
        return Blocked(
            f"I have given up on my way{_quoted(pursuit.text)}."
            " Clear the way, or send me somewhere else."
        )
    return NotPossible(
        f"My navigation does not take that goal{_quoted(pursuit.text)}."
        " Tell whoever looks after the robot."
    )


def _quoted(text: str) -> str:
    """What the robot says about it, for a sentence."""
    said = " ".join(text.split()).rstrip(".!? ")[:120]
    return f" ({said})" if said else ""


def _check_numbers(goal: Goal) -> None:
    if not all(map(math.isfinite, (goal.x, goal.y, goal.theta or 0.0))):
        raise InvalidCall("That is no place: one of its numbers is none. Give x and y in metres.")


def _near(here: Pose | None, there: Pose) -> bool:
    return here is not None and math.hypot(here.x - there.x, here.y - there.y) < 1.0
