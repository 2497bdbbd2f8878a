"""What a driver of a real robot is told of the house: its places, and where not to drive."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from robot_api.capabilities.driving import Goal
from robot_api.capabilities.names import one_of, unknown_place, with_article
from robot_api.errors import UnknownPlace

Point = tuple[float, float]


@dataclass(frozen=True)
class NamedPlace:
    name: str
    kind: str
    goal: Goal | None = None
    """Where it is on the robot's map, in metres and degrees; None if nobody has said."""
    aliases: tuple[str, ...] = ()


@dataclass(frozen=True)
class Places:
    """What the world's file says of the house: a driver that knows its way is sent by these."""

    named: dict[str, NamedPlace] = field(default_factory=dict)
    """By name. Operators name more on the map while the robot is served, so a driver looks here at
    each call and keeps no copy."""
    keep_out: list[Sequence[Point]] = field(default_factory=list)
    """Outlines of where it must not drive, in metres on its map; drawn anew by `keep_out_of`."""
    _listeners: list[Callable[[], None]] = field(default_factory=list)

    def keep_out_of(self, outlines: Sequence[Sequence[Point]]) -> None:
        """Operators have drawn the zones anew: these are all of them now."""
        self.keep_out[:] = outlines
        for listener in self._listeners:
            listener()

    @property
    def keeps_out(self) -> bool:
        """Whether the driver heeds zones that are drawn while the robot is served."""
        return bool(self._listeners)

    def on_keep_out(self, listener: Callable[[], None]) -> None:
        """Call it, from any thread, whenever the zones were drawn anew."""
        self._listeners.append(listener)

    def goal_of(self, place: str) -> Goal:
        """Where the place of that name or alias is. Raises `UnknownPlace`."""
        names = {name: name for name in self.named}
        for name, known in self.named.items():
            for alias in known.aliases:
                names.setdefault(alias, name)
        found = one_of(place, names)
        if found is None:
            raise unknown_place(place, names)
        goal = self.named[names[found]].goal
        if goal is None:
            raise UnknownPlace(
                f"Nobody has said where {with_article(names[found])} is on my map."
                " Give it a pose in the world's file."
            )
        return Goal(goal.x, goal.y, goal.theta, names[found])

    def near(self, x: float, y: float, within: float) -> str | None:
        """The place that is nearest there, if one is within so many metres."""
        away = {
            name: math.hypot(known.goal.x - x, known.goal.y - y)
            for name, known in self.named.items()
            if known.goal is not None
        }
        nearest = min(away, key=away.__getitem__, default=None)
        return nearest if nearest is not None and away[nearest] <= within else None
