"""What a robot's laser measures, as the pages draw it: distances evenly round the robot."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, Final

from robot_api.capabilities.base import Hub
from robot_api.robots.ros import dialect as ros

RAYS: Final = 180
"""How many distances are told: one every two degrees."""
EVERY: Final = 0.2
"""Seconds between two of them."""


class Laser:
    """Hears sensor_msgs/LaserScan. `turned`: degrees that the laser looks to the left of straight
    ahead."""

    def __init__(self, hub: Hub, turned: float) -> None:
        self._hub = hub
        self._turned = turned

    def hear(self, message: Mapping[str, Any]) -> None:
        metres = around(message, self._turned)
        if metres is not None:
            self._hub.publish("lidar", metres=metres)


def around(scan: Mapping[str, Any], turned: float = 0.0) -> list[float | None] | None:
    """The nearest distance in metres on each of `RAYS` sides, from straight ahead to the left;
    None where the laser saw nothing. None for a message that makes no sense."""
    first, step = ros.number(scan.get("angle_min")), ros.number(scan.get("angle_increment"))
    ranges = scan.get("ranges")
    if first is None or step is None or not isinstance(ranges, list):
        return None
    least = ros.number(scan.get("range_min")) or 0.0
    most = ros.number(scan.get("range_max")) or math.inf
    sides: list[float | None] = [None] * RAYS
    for number, told in enumerate(ranges):
        distance = ros.number(told)  # rosbridge writes what is no number as null
        if distance is None or not least <= distance <= most:
            continue
        degrees = math.degrees(first + number * step) + turned
        side = round(degrees * RAYS / 360) % RAYS
        nearest = sides[side]
        sides[side] = distance if nearest is None else min(nearest, distance)
    return [None if distance is None else round(distance, 2) for distance in sides]
