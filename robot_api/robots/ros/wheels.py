"""What the robot tells of itself while it drives: how fast it is, and where.

Its place on the map comes rarely (amcl speaks only after a quarter of a metre), its odometry often.
So a place is kept as where odometry began on the map: what it has driven since is added, and how
much that was says how far the place can be trusted.
"""

from __future__ import annotations

import math
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from robot_api.errors import NotPossible
from robot_api.robots.ros.dialect import Pose, field, number, plain, pose_in

FRESH = 1.0
"""Seconds after which what odometry said is too old to know by where it is."""
_STANDS = (0.02, math.radians(2.0))
"""Metres and radians per second below which it stands."""
_TELL_EVERY = 0.1

POSE_TYPES = (
    "geometry_msgs/PoseWithCovarianceStamped",
    "geometry_msgs/PoseStamped",
    "nav_msgs/Odometry",
    "tf2_msgs/TFMessage",
)


@dataclass(frozen=True)
class Moment:
    """What odometry said, once."""

    pose: Pose
    """In its own frame."""
    speed: float
    """Metres per second, back is negative."""
    turning: float
    """Radians per second."""
    at: float
    """When it came, on the monotonic clock."""

    @property
    def stands(self) -> bool:
        return abs(self.speed) < _STANDS[0] and abs(self.turning) < _STANDS[1]


class Wheels:
    """Odometry. Any thread may call any of it."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._recent: deque[Moment] = deque(maxlen=8)
        self._listeners: list[Callable[[Moment], None]] = []
        self._nonsense = False

    def hear(self, message: Mapping[str, Any]) -> None:
        """A nav_msgs/Odometry. One with a number that is none is not counted as told."""
        pose = pose_in(field(message, "pose", "pose"))
        ahead, aside = (number(field(message, "twist", "twist", "linear", a)) for a in "xy")
        turning = number(field(message, "twist", "twist", "angular", "z"))
        if pose is None or ahead is None or turning is None:
            self._nonsense = True
            return
        speed = math.copysign(math.hypot(ahead, aside or 0.0), ahead)
        moment = Moment(pose, speed, turning, time.monotonic())
        with self._changed:
            self._nonsense = False
            self._recent.append(moment)
            self._changed.notify_all()
        for listener in self._listeners:
            listener(moment)

    def on_moment(self, listener: Callable[[Moment], None]) -> None:
        """Must not wait."""
        self._listeners.append(listener)

    def _is_fresh(self, within: float) -> bool:
        return bool(self._recent) and time.monotonic() - self._recent[-1].at <= within

    def now(self, within: float = FRESH) -> Moment:
        """The last of it, waited for if it is older than `within` s. Raises `NotPossible` if none
        comes as long again."""
        with self._changed:
            self._changed.wait_for(lambda: self._is_fresh(within) or self._nonsense, within)
            last = self._recent[-1] if self._is_fresh(within) else None
        if last is None:
            raise NotPossible(
                "My wheels tell nonsense about how far I have come, so I do not drive."
                " Tell whoever looks after the robot."
                if self._nonsense
                else "My wheels do not tell how far I have come, so I do not drive."
                " Tell whoever looks after the robot."
            )
        return last

    def last(self) -> Moment | None:
        return self._recent[-1] if self._recent else None

    def stands_since(self, began: float) -> bool:
        """Whether it has said twice, since then, that it stands, and not otherwise after that."""
        with self._changed:
            later = [moment for moment in self._recent if moment.at > began]
        return len(later) >= 2 and all(moment.stands for moment in later[-2:])

    def wait(self, seconds: float) -> None:
        """Until the next word of it."""
        with self._changed:
            self._changed.wait(seconds)


class Whereabouts:
    """Where it is on the map."""

    def __init__(self, wheels: Wheels, kind: str, map_frame: str, odometry: str, drift: float):
        self._wheels = wheels
        self._kind = plain(kind)
        self._frames = map_frame, odometry
        self._drift = drift
        self._lock = threading.Lock()
        self._start: Pose | None = None
        """Where odometry began, on the map."""
        self._driven = 0.0
        """Metres since."""
        self._last: Pose | None = None
        self._nonsense = False
        self._fixes = 0
        wheels.on_moment(self._drove)

    @property
    def fixes(self) -> int:
        """How often it has been told where it is."""
        return self._fixes

    def hear(self, message: Mapping[str, Any]) -> None:
        """A message of one of `POSE_TYPES`."""
        if self._kind == "tf2_msgs/TFMessage":
            found = self._in_transforms(message)
            if found is not None:
                self._begin(found)
            return
        path = ("pose",) if self._kind == "geometry_msgs/PoseStamped" else ("pose", "pose")
        pose, moment = pose_in(field(message, *path)), self._wheels.last()
        if pose is None:
            with self._lock:
                self._nonsense, self._start = True, None
        elif moment is not None:
            self._begin(pose.times(moment.pose.inverse()))

    def now(self) -> Pose:
        """Raises `NotPossible` if it does not know, or what it knows is too old."""
        moment = self._wheels.now()
        with self._lock:
            start, driven, nonsense = self._start, self._driven, self._nonsense
        if start is None:
            raise NotPossible(
                "My map tells me a place that is none, so I do not know where I am."
                " Show me where I am on the map."
                if nonsense
                else "I do not know where I am. Show me where I am on the map."
            )
        if driven > self._drift:
            raise NotPossible(
                f"I have driven {driven:.0f} metres since I last knew where I am, so I am not sure"
                " any more. Show me where I am on the map."
            )
        return start.times(moment.pose)

    def guess(self) -> Pose | None:
        """Where it is, or None if it does not know."""
        try:
            return self.now()
        except NotPossible:
            return None

    # --- inside ----------------------------------------------------------------------------------

    def _begin(self, start: Pose) -> None:
        with self._lock:
            self._start, self._driven, self._nonsense = start, 0.0, False
            self._fixes += 1

    def _drove(self, moment: Moment) -> None:
        with self._lock:
            if self._last is not None:
                self._driven += math.hypot(
                    moment.pose.x - self._last.x, moment.pose.y - self._last.y
                )
            self._last = moment.pose

    def _in_transforms(self, message: Mapping[str, Any]) -> Pose | None:
        """Where odometry begins, if this is among them."""
        for transform in field(message, "transforms") or ():
            frames = (
                str(field(transform, "header", "frame_id")).strip("/"),
                str(field(transform, "child_frame_id")).strip("/"),
            )
            if frames == self._frames:
                found: Pose | None = pose_in(
                    field(transform, "transform"), "translation", "rotation"
                )
                return found
        return None


class Teller:
    """Tells those who subscribed where it is: ten times a second while it moves, and when it has
    come to stand."""

    def __init__(self, tell: Callable[[Pose, float, float], None], where: Whereabouts) -> None:
        self._tell = tell
        self._where = where
        self._told = 0.0
        self._stood = False
        self._began = time.monotonic()

    def hear(self, moment: Moment) -> None:
        if (moment.stands and self._stood) or moment.at - self._told < _TELL_EVERY:
            return
        pose = self._where.guess()
        if pose is None:
            return
        self._told, self._stood = moment.at, moment.stands
        self._tell(pose, moment.speed, moment.at - self._began)
