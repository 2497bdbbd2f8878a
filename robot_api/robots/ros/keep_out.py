"""Where the robot must not drive.

A robot with Nav2's keep-out filter is given the zones as a mask, and plans around them. We hold
them ourselves as well: no goal inside is sent, and a robot that enters one is stopped.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from robot_api.errors import Blocked, NotPossible
from robot_api.robots.places import Point
from robot_api.robots.ros.dialect import Dialect, Pose

_MOST_CELLS = 250_000
"""A mask has at most so many; it is made coarser if it would have more."""


class KeepOut:
    """The zones: outlines in metres on the robot's map."""

    def __init__(self, zones: Sequence[Sequence[Point]]) -> None:
        self.hold(zones)

    def hold(self, zones: Sequence[Sequence[Point]]) -> None:
        """These are all of them from now on."""
        from shapely import Polygon, prepare, union_all

        area = union_all([Polygon(zone).buffer(0) for zone in zones if len(zone) >= 3])
        prepare(area)
        self._area = area

    def __bool__(self) -> bool:
        return not self._area.is_empty

    def forbids(self, x: float, y: float) -> bool:
        from shapely import intersects_xy

        return bool(intersects_xy(self._area, x, y))

    def check_goal(self, x: float, y: float) -> None:
        """Raises `NotPossible` for a goal inside."""
        if self and self.forbids(x, y):
            raise NotPossible(
                "That place lies where I must not drive. Send me to another one, or change the"
                " zone on the map."
            )

    def mask(self, dialect: Dialect, frame: str, resolution: float) -> dict[str, Any]:
        """A nav_msgs/OccupancyGrid around the zones: every cell that touches one is 100."""
        import numpy as np
        from shapely import intersects_xy

        left, bottom, right, top = self._area.bounds if self else (0.0, 0.0, 0.0, 0.0)
        cell = max(resolution, math.sqrt((right - left + 1) * (top - bottom + 1) / _MOST_CELLS))
        left, bottom = left - 2 * cell, bottom - 2 * cell
        width = math.ceil((right - left) / cell) + 2
        height = math.ceil((top - bottom) / cell) + 2
        xs = left + (np.arange(width) + 0.5) * cell
        ys = bottom + (np.arange(height) + 0.5) * cell
        grid_x, grid_y = np.meshgrid(xs, ys)
        inside = intersects_xy(self._area.buffer(cell * math.sqrt(0.5)), grid_x, grid_y)
        return {
            "header": dialect.header(frame),
            "info": {
                "resolution": cell,
                "width": width,
                "height": height,
                "origin": Pose(left, bottom, 0.0).message(),
            },
            "data": np.where(inside, 100, 0).ravel().tolist(),
        }


class Guarding:
    """Watches one drive: it may come out of a zone, but not go into one."""

    def __init__(self, zones: KeepOut) -> None:
        self._zones = zones
        self._inside: bool | None = None

    def check(self, pose: Pose | None) -> None:
        """Raises `Blocked` when it has entered one. None: nobody knows where it is."""
        if pose is None or not self._zones:
            return
        inside = self._zones.forbids(pose.x, pose.y)
        if inside and self._inside is False:
            raise Blocked(
                "I have stopped, because I had come to where I must not drive. Show me another way."
            )
        self._inside = inside
