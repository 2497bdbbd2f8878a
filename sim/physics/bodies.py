"""Bodies and contacts: the robot and the people as discs among walls, on pymunk.

A body is driven by a servo: a kinematic body carries the wanted velocity and a joint of limited
force pulls the real one along, so that contacts hold (to set a body's velocity every step would
push it through walls). Metres, seconds, radians.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import pymunk

Outline = tuple[tuple[float, float], ...]

STEP = 1 / 60
"""Seconds of one step."""

_PULL = 8.0
"""The servo's greatest acceleration in m/s²."""

BORDER_WIDTH = 0.04
"""Metres; contacts give a little, and the robot is not to be in a zone by even that."""

_WALL, _FURNITURE, _ROBOT, _PERSON, _BORDER, _FEELER = 1, 2, 4, 8, 16, 32

# What each kind of body bumps into. People sit on chairs and lie in beds, so furniture does not
# stop them (their routes go around it); and they make room for one another.
_FILTERS = {
    _ROBOT: pymunk.ShapeFilter(categories=_ROBOT, mask=_WALL | _FURNITURE | _PERSON),
    _PERSON: pymunk.ShapeFilter(categories=_PERSON, mask=_WALL | _ROBOT),
}
# The border of a keep-out zone stops nothing but the robot, and is not to be seen.
_BORDERS = pymunk.ShapeFilter(categories=_BORDER, mask=_FEELER)
_FEELERS = pymunk.ShapeFilter(categories=_FEELER, mask=_BORDER)
_LIDAR = pymunk.ShapeFilter(categories=_ROBOT, mask=_WALL | _FURNITURE | _PERSON)
_SIGHT = pymunk.ShapeFilter(categories=_ROBOT | _PERSON, mask=_WALL)


class Motion(NamedTuple):
    """Where a body is, how it moves and how it is to move. Metres, m/s."""

    position: tuple[float, float]
    velocity: tuple[float, float]
    wanted: tuple[float, float]


class Body:
    """A disc that is driven by a servo."""

    def __init__(
        self, space: pymunk.Space, x: float, y: float, radius: float, mass: float, kind: int
    ) -> None:
        self.radius = radius
        # Discs turn freely: nothing that they touch turns them, so heading is not physics.
        self._body = pymunk.Body(mass, math.inf)
        self._shape = pymunk.Circle(self._body, radius)
        self._shape.filter = _FILTERS[kind]
        self._servo = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
        joint = pymunk.PivotJoint(self._servo, self._body, (0, 0), (0, 0))
        joint.max_bias = 0
        joint.max_force = mass * _PULL
        self._body.position = self._servo.position = (x, y)
        self._parts = (self._body, self._shape, self._servo, joint)
        space.add(*self._parts)
        self._wanted = (0.0, 0.0)

    @property
    def position(self) -> tuple[float, float]:
        x, y = self._body.position
        return x, y

    @property
    def velocity(self) -> tuple[float, float]:
        vx, vy = self._body.velocity
        return vx, vy

    def drive(self, vx: float, vy: float) -> None:
        """From now on aim at this velocity."""
        if (vx, vy) != self._wanted:
            self._wanted = (vx, vy)
            self._servo.velocity = (vx, vy)

    def rest(self) -> None:
        """Stand still this instant."""
        self.drive(0.0, 0.0)
        self._body.velocity = (0.0, 0.0)

    def place(self, x: float, y: float) -> None:
        """Put it elsewhere, at rest."""
        self.rest()
        self._body.position = (x, y)

    @property
    def motion(self) -> Motion:
        return Motion(self.position, self.velocity, self._wanted)

    def resume(self, motion: Motion) -> None:
        """Take over where another body was and how it moved."""
        self._body.position = motion.position
        self._body.velocity = motion.velocity
        self.drive(*motion.wanted)

    def remove(self, space: pymunk.Space) -> None:
        space.remove(*self._parts)


class RobotBody(Body):
    """The robot's: what else stops it are the borders of keep-out zones, for which it counts as
    wide as its `feeler`."""

    def __init__(self, space: pymunk.Space, x: float, y: float, radius: float) -> None:
        super().__init__(space, x, y, radius, 30.0, _ROBOT)
        self._feeler = pymunk.Circle(self._body, radius)
        self._feeler.filter = _FEELERS
        space.add(self._feeler)

    @property
    def feeler(self) -> float:
        return self._feeler.radius

    @feeler.setter
    def feeler(self, radius: float) -> None:
        self._feeler.unsafe_set_radius(radius)


class Physics:
    """A floor with walls (x1, y1, x2, y2) of some thickness, furniture and closed doors."""

    def __init__(
        self,
        walls: Iterable[tuple[float, float, float, float]],
        thickness: float,
        furniture: Iterable[Sequence[tuple[float, float]]],
        doors: Iterable[tuple[float, float, float, float]] = (),
    ) -> None:
        self.space = pymunk.Space()
        self._thickness = thickness
        ground = self.space.static_body
        shapes: list[pymunk.Shape] = [self._wall(segment) for segment in walls]
        for corners in furniture:
            shape = pymunk.Poly(ground, list(corners))
            shape.filter = pymunk.ShapeFilter(categories=_FURNITURE)
            shapes.append(shape)
        self.space.add(*shapes)
        self._borders: dict[Outline, list[pymunk.Segment]] = {}
        self._doors: dict[tuple[float, float, float, float], pymunk.Segment] = {}
        for door in doors:
            self.close_door(door)

    def _wall(self, segment: tuple[float, float, float, float]) -> pymunk.Segment:
        x1, y1, x2, y2 = segment
        shape = pymunk.Segment(self.space.static_body, (x1, y1), (x2, y2), self._thickness / 2)
        shape.filter = pymunk.ShapeFilter(categories=_WALL)
        return shape

    def close_door(self, door: tuple[float, float, float, float]) -> None:
        if door not in self._doors:
            self._doors[door] = self._wall(door)
            self.space.add(self._doors[door])

    def open_door(self, door: tuple[float, float, float, float]) -> None:
        if door in self._doors:
            self.space.remove(self._doors.pop(door))

    def raise_border(self, zone: Outline) -> None:
        """From now on the robot does not cross the outline of the zone."""
        if zone in self._borders:
            return
        ground = self.space.static_body
        sides = itertools.pairwise((*zone, zone[0]))
        self._borders[zone] = [pymunk.Segment(ground, *side, BORDER_WIDTH / 2) for side in sides]
        for side in self._borders[zone]:
            side.filter = _BORDERS
        self.space.add(*self._borders[zone])

    def lift_border(self, zone: Outline) -> None:
        self.space.remove(*self._borders.pop(zone, ()))

    def lift_borders(self) -> None:
        for zone in self.borders():
            self.lift_border(zone)

    def borders(self) -> set[Outline]:
        """The zones whose border is raised."""
        return set(self._borders)

    def add_robot(self, x: float, y: float, radius: float) -> RobotBody:
        return RobotBody(self.space, x, y, radius)

    def add_person(self, x: float, y: float, radius: float) -> Body:
        return Body(self.space, x, y, radius, 70.0, _PERSON)

    def remove(self, body: Body) -> None:
        body.remove(self.space)

    def step(self) -> None:
        self.space.step(STEP)

    def lidar(
        self, x: float, y: float, heading: float, rays: int, reach: float, inner: float
    ) -> list[float]:
        """The distance from the middle that each ray runs free, at most `reach`; rays start
        `inner` metres out, the first straight ahead, then to the left."""
        first_hit = self.space.segment_query_first
        ranges = []
        for i in range(rays):
            angle = heading + i * 2 * math.pi / rays
            cosine, sine = math.cos(angle), math.sin(angle)
            hit = first_hit(
                (x + inner * cosine, y + inner * sine),
                (x + reach * cosine, y + reach * sine),
                0.0,
                _LIDAR,
            )
            ranges.append(reach if hit is None else inner + hit.alpha * (reach - inner))
        return ranges

    def free_ahead(self, body: Body, heading: float, reach: float) -> float:
        """How many metres the body could go straight that way before it touches something, at
        most `reach`."""
        x, y = body.position
        hit = self.space.segment_query_first(
            (x, y),
            (x + reach * math.cos(heading), y + reach * math.sin(heading)),
            body.radius,
            _LIDAR,
        )
        return reach if hit is None else hit.alpha * reach

    def free_of_borders(self, body: RobotBody, heading: float, reach: float) -> float:
        """How many metres the robot could go straight that way before it comes to a keep-out zone,
        at most `reach`."""
        x, y = body.position
        hit = self.space.segment_query_first(
            (x, y),
            (x + reach * math.cos(heading), y + reach * math.sin(heading)),
            body.feeler,
            _FEELERS,
        )
        return reach if hit is None else hit.alpha * reach

    def sees(self, start: tuple[float, float], end: tuple[float, float]) -> bool:
        """Whether no wall and no closed door stands between the two spots."""
        return self.space.segment_query_first(start, end, 0.0, _SIGHT) is None
