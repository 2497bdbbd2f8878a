"""What ROS 1 and ROS 2 spell differently, and numbers that are numbers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

Version = Literal[1, 2]
Message = Mapping[str, Any]


@dataclass(frozen=True)
class Dialect:
    version: Version

    def type(self, name: str) -> str:
        """ "geometry_msgs/Twist" as this ROS writes it."""
        package, _, kind = name.partition("/")
        return name if self.version == 1 else f"{package}/msg/{kind}"

    def header(self, frame: str) -> dict[str, Any]:
        """A header without a time: rosbridge, or who reads it, takes the robot's own."""
        return {"frame_id": frame}

    def duration(self, seconds: float) -> dict[str, int]:
        whole, rest = divmod(round(seconds * 1e9), 10**9)
        if self.version == 1:
            return {"secs": whole, "nsecs": rest}
        return {"sec": whole, "nanosec": rest}


def plain(kind: str) -> str:
    """The type's name without what only ROS 2 writes: "geometry_msgs/Twist"."""
    parts = kind.strip("/").split("/")
    return f"{parts[0]}/{parts[-1]}"


def number(value: Any) -> float | None:
    """The value if it is a finite number; rosbridge writes NaN as null, as NaN, or not at all."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return float(value)


def field(message: Any, *path: str) -> Any:
    """The value at that path of a message, None where there is none."""
    for name in path:
        if not isinstance(message, Mapping):
            return None
        message = message.get(name)
    return message


@dataclass(frozen=True)
class Pose:
    """Metres, and radians that the robot faces: 0 along x, left is +."""

    x: float
    y: float
    theta: float

    def times(self, other: Pose) -> Pose:
        """`other`, seen from this one, in the frame that this one is in."""
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        return Pose(
            self.x + cos * other.x - sin * other.y,
            self.y + sin * other.x + cos * other.y,
            wrapped(self.theta + other.theta),
        )

    def inverse(self) -> Pose:
        cos, sin = math.cos(self.theta), math.sin(self.theta)
        return Pose(-cos * self.x - sin * self.y, sin * self.x - cos * self.y, wrapped(-self.theta))

    def message(self) -> dict[str, Any]:
        return {
            "position": {"x": self.x, "y": self.y, "z": 0.0},
            "orientation": {
                "x": 0.0,
                "y": 0.0,
                "z": math.sin(self.theta / 2),
                "w": math.cos(self.theta / 2),
            },
        }


def wrapped(radians: float) -> float:
    """The same angle, from -pi to pi."""
    return (radians + math.pi) % math.tau - math.pi


def pose_in(message: Any, position: str = "position", orientation: str = "orientation") -> Any:
    """The `Pose` in a geometry_msgs/Pose (or a Transform, with its own names), or None if
    anything in it is not a finite number."""
    x, y = (number(field(message, position, axis)) for axis in "xy")
    turn = [number(field(message, orientation, axis)) for axis in "xyzw"]
    if x is None or y is None or any(part is None for part in turn):
        return None
    qx, qy, qz, qw = (part or 0.0 for part in turn)
    if math.hypot(qx, qy, qz, qw) < 0.5:  # no rotation at all: nobody has filled it in
        return None
    theta = math.atan2(2 * (qw * qz + qx * qy), 1 - 2 * (qy * qy + qz * qz))
    return Pose(x, y, theta)
