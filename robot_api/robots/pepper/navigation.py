"""Finding the way on a map that Pepper has made itself (`ALNavigation.explore`): `goto`,
`location`, `localize`."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Final

from robot_api.capabilities.base import Hub
from robot_api.capabilities.driving import Goal, Navigation
from robot_api.driver import StopFlag
from robot_api.errors import Blocked, NotPossible, NotSupported
from robot_api.robots.pepper.body import STOP_MOVING, Body
from robot_api.robots.pepper.line import Line
from robot_api.robots.pepper.session import Wire
from robot_api.robots.places import Places
from robot_api.values import Location

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

_LOADS_WITHIN: Final = 20.0
"""Seconds that loading a map and finding oneself on it may take."""
_AT: Final = 1.0
"""Metres from a place within which the robot is there."""
_TELLS_EVERY: Final = 0.1
"""Seconds between two events of where it is."""
_FASTER: Final = 0.05
"""Metres per second that a measured speed may lie above the limit."""
Pose = tuple[float, float, float]
"""Metres, metres, degrees."""

_ARRIVED: Final = 0
"""What `navigateToInMap` returns then; every other number is a way of not arriving."""


class PepperNavigation(Navigation):
    def __init__(
        self, wire: Wire, body: Body, hub: Hub, places: Places, file: str, most: float | None
    ) -> None:
        """Loads the map. `most`: metres per second. Raises `NotSupported` if it is not there."""
        super().__init__()
        self._wire = wire
        self._body = body
        self._hub = hub
        self._places = places
        self._most = most
        self._keep_out = _area(places)
        places.on_keep_out(self._drawn_anew)
        self._file = file
        self._chosen = False  # the map; until then Pepper may have another
        wire.each_time(self._find_its_way)

    def _find_its_way(self, line: Line) -> None:
        """Have the map, and be looked for on it. A robot that is reached again and knows where it
        is keeps to that."""
        with suppress(NotPossible):  # it was restarted, and has no map
            told = line.call("ALNavigation", "getRobotPositionInMap") if self._chosen else None
            if _pose_of(told) is not None:
                return
        loaded = line.call("ALNavigation", "loadExploration", self._file, within=_LOADS_WITHIN)
        if loaded is False:
            raise NotSupported(
                f"Pepper has no map {self._file}. Let it explore the floor, save that, and write"
                " the name that it gives the map into the robot file."
            )
        line.call("ALNavigation", "startLocalization", within=_LOADS_WITHIN)
        self._chosen = True

    # --- places ----------------------------------------------------------------------------------

    def locate(self, place: str) -> Goal:
        return self._places.goal_of(place)

    # --- where it is -----------------------------------------------------------------------------

    def location(self, stop: StopFlag) -> Location:
        """Asked of the robot at this moment."""
        x, y, theta = self._pose()
        return Location(x, y, theta, self._places.near(x, y, _AT))

    def believe(self, goal: Goal) -> None:
        theta = self._pose()[2] if goal.theta is None else goal.theta
        pose = [goal.x, goal.y, math.radians(theta)]
        self._wire.call("ALNavigation", "relocalizeInMap", pose, within=_LOADS_WITHIN)

    # --- driving ---------------------------------------------------------------------------------

    def drive_to(self, stop: StopFlag, goal: Goal) -> None:
        self._body.be_ready(stop, to_drive=True)
        if self._forbidden(goal.x, goal.y):
            raise NotPossible("That is where I must not drive. Send me somewhere else.")
        here = self._pose()
        ahead = math.degrees(math.atan2(goal.y - here[1], goal.x - here[0]))
        theta = goal.theta if goal.theta is not None else ahead
        code = self._wire.run(
            stop,
            "ALNavigation",
            "navigateToInMap",
            [goal.x, goal.y, math.radians(theta)],
            ending=(STOP_MOVING,),
            meanwhile=self._watching(started_inside=self._forbidden(here[0], here[1])),
        )
        x, y, _ = self._pose()
        missing = math.hypot(goal.x - x, goal.y - y)
        if code != _ARRIVED or missing > _AT:
            raise Blocked(self._why(code, missing))

    def _why(self, code: object, missing: float) -> str:
        """Why it has not arrived, in a sentence. NAOqi documents no meaning of its numbers that
        holds for all versions, so it is the robot that is looked at."""
        number = f" (NAOqi says {code})" if code != _ARRIVED else ""
        return f"I stopped {missing:.1f} m before the goal{number}. {self._body.in_the_way()}"

    def _watching(self, *, started_inside: bool) -> Callable[[], None]:
        """What is done while it drives: tell where it is, and keep out of where it must not be.
        A robot that stands there already may leave."""
        told = 0.0
        inside = started_inside

        def watch() -> None:
            nonlocal told, inside
            if time.monotonic() - told < _TELLS_EVERY:
                return
            told = time.monotonic()
            x, y, theta = self._pose()
            ahead, sideways, _ = self._wire.call("ALMotion", "getRobotVelocity")
            speed = math.hypot(ahead, sideways)
            self._hub.publish(
                "pose",
                x=x,
                y=y,
                theta=theta,
                place=self._places.near(x, y, _AT),
                speed=speed,
                time=time.time(),
            )
            if self._most is not None and speed > self._most + _FASTER:
                raise NotPossible(
                    f"On its map Pepper drives at {speed:.2f} m/s, and it may drive at"
                    f" {self._most:g} at most. Allow it more, or let it move without the map."
                )
            was_inside, inside = inside, self._forbidden(x, y)
            if inside and not was_inside:
                raise Blocked(
                    "My way leads through where I must not drive, so I stopped."
                    " Send me another way."
                )

        return watch

    def _pose(self) -> Pose:
        """Raises `NotPossible` if the robot does not know."""
        pose = _pose_of(self._wire.call("ALNavigation", "getRobotPositionInMap"))
        if pose is None:
            raise NotPossible(
                "I do not know where I am on my map. Bring me to a place that I know, and tell me"
                " which it is."
            )
        return pose

    def _drawn_anew(self) -> None:
        self._keep_out = _area(self._places)

    def _forbidden(self, x: float, y: float) -> bool:
        from shapely import Point

        return self._keep_out is not None and bool(self._keep_out.intersects(Point(x, y)))


def _pose_of(told: Any) -> Pose | None:
    """What NAOqi tells of where the robot is; None if that is nowhere."""
    try:
        x, y, theta, *_ = (float(part) for part in told[0])
    except (IndexError, TypeError, ValueError):
        return None
    return (x, y, math.degrees(theta)) if all(map(math.isfinite, (x, y, theta))) else None


def _area(places: Places) -> BaseGeometry | None:
    """Where it must not drive."""
    from shapely import Polygon
    from shapely.ops import unary_union

    if not places.keep_out:
        return None
    return unary_union([Polygon(outline) for outline in places.keep_out])
