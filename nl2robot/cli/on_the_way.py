"""Where a robot is driving to, and how far that still is: for a line that lives while it drives.

way = OnTheWay(world)
way.plan(review.dry_run.path)
way.begin("goto", {"place": "pharmacy"})
way.at(2.0, 4.5)                # metres left to the pharmacy
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Final

from sim.world.model import World

OFF: Final = 1.5
"""Metres from the path of the dry run at which it drives another way."""

Point = tuple[float, float]


class OnTheWay:
    """One drive after the other. Without a `world` only the names of goals are known."""

    def __init__(self, world: World | None = None) -> None:
        self._world = world
        self._path: Sequence[Point] = ()
        self._goal: Point | None = None
        self.place: str | None = None
        """Where it drives to; None while it drives nowhere in particular."""
        self._done = 0
        """The leg of the path that it is on."""
        self._left = math.inf

    def plan(self, path: Sequence[Point]) -> None:
        """The path of the dry run of the program that begins now."""
        self._path, self._done, self.place, self._goal = path, 0, None, None

    def begin(self, method: str, arguments: Mapping[str, Any]) -> None:
        """A robot call begins; of those that drive somewhere, the goal is remembered."""
        self.end()
        world, place = self._world, arguments.get("place")
        if method == "dock" and world is not None:
            place = next((each.name for each in world.places if each.kind == "charger"), None)
        if method not in ("goto", "guide", "dock"):
            return
        if isinstance(place, str):
            self.place = place
            known = world.place(place) if world is not None else None
            if known is not None and known.pose is not None:
                self._goal = (known.pose.x, known.pose.y)
            return
        spot = place if isinstance(place, Mapping) else arguments
        if isinstance(spot.get("x"), int | float) and isinstance(spot.get("y"), int | float):
            self._goal = (float(spot["x"]), float(spot["y"]))
            self.place = str(spot.get("place") or f"{self._goal[0]:.1f}, {self._goal[1]:.1f}")

    def end(self) -> None:
        """It has arrived, or gave up. What it drives next begins behind the way that is done."""
        if self._goal is not None and self._left < OFF:
            self._done = self._reached(self._done) or self._done
        self.place = self._goal = None
        self._left = math.inf

    def at(self, x: float, y: float) -> float | None:
        """How many metres are left from there: along the path of the dry run as far as it keeps to
        it, else as the crow flies. None where nobody knows."""
        if self._goal is not None:
            self._left = self._measured((x, y), self._goal)
        return self._left if self._goal is not None else None

    def _measured(self, here: Point, goal: Point) -> float:
        straight = math.dist(here, goal)
        ends = self._reached(self._done)
        legs = range(self._done, ends if ends is not None else self._done)
        off, leg = min((_off(self._path, leg, here), leg) for leg in legs) if legs else (OFF, 0)
        if ends is None or off >= OFF:
            return straight
        self._done = leg
        way = [here, *self._path[leg + 1 : ends], goal]
        return sum(math.dist(way[at], way[at + 1]) for at in range(len(way) - 1))

    def _reached(self, start: int) -> int | None:
        """The point of the path, from one on, at the end of the leg that comes by the goal first
        and nearest; None if none does."""
        assert self._goal is not None
        nearest, found = OFF, None
        for leg in range(start, len(self._path) - 1):
            off = _off(self._path, leg, self._goal)
            if off < nearest:
                nearest, found = off, leg + 1
            elif found is not None and off >= OFF:
                break
        return found


def _off(path: Sequence[Point], leg: int, spot: Point) -> float:
    """How far a spot is from the leg of a path that begins at that point."""
    (x, y), (to_x, to_y) = path[leg], path[leg + 1]
    along, across = to_x - x, to_y - y
    length = along**2 + across**2
    part = ((spot[0] - x) * along + (spot[1] - y) * across) / length if length else 0.0
    part = min(1.0, max(0.0, part))
    return math.dist((x + part * along, y + part * across), spot)
