"""The two values that robot methods return and that are more than text, number or list."""

from __future__ import annotations

import msgspec


class Location(msgspec.Struct, frozen=True):
    """Where the robot is: x and y in metres, theta in degrees (0 = along x, left is +), and the
    name of the place it is in, or None. `str()` of it is the place's name, or "x, y"."""

    x: float
    y: float
    theta: float = 0.0
    place: str | None = None

    def __str__(self) -> str:
        return self.place if self.place else f"{self.x:.2f}, {self.y:.2f}"


class Clock(msgspec.Struct, frozen=True):
    """The time "14:05", the weekday "Friday", the date "2026-11-20" and the time zone
    "Europe/Zurich" where the robot is."""

    time: str
    weekday: str
    date: str
    zone: str = ""

    def __str__(self) -> str:
        return self.time
