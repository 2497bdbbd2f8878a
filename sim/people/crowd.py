"""The people: they stand, sit, lie, walk about, come along with the robot, and make way for it.

What a person is about to do is an `Errand`, plain data, so that a simulation can be copied at any
moment. They think fifteen times a second; in between the physics carries them on.
"""

from __future__ import annotations

import enum
import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from sim.physics.bodies import Body
from sim.physics.navigation import Disc, Spot
from sim.physics.robot import bearing, wrap
from sim.world.model import Person
from sim.world.words import words

if TYPE_CHECKING:
    from sim.hospital import Hospital

_THINK_EVERY = 4  # steps
_TURN = 12.0
"""Degrees between two thoughts: 180 a second."""
_REACHED = 0.15
_AT_HOME = 0.4
_VISIT = 90.0
"""Seconds that somebody stays where they were led before they go home."""
_BEHIND = 1.1
"""How near to the robot somebody comes along: metres between the middles."""
_ROOM = 0.25
"""Metres that people leave between themselves and the robot."""
_SLIP = 0.06
_PATIENCE = 1.5
"""Seconds that somebody who walks waits for the robot to get out of the way."""


class Errand(enum.Enum):
    NONE = enum.auto()
    WALK = enum.auto()
    """Walks a route, to a place or out of the way."""
    COME_ALONG = enum.auto()
    """Goes after the robot, which guides them."""
    LEAD = enum.auto()
    """Walks a route and waits for the robot, which follows them."""


@dataclass(frozen=True)
class Home:
    """Where somebody is when nobody wants anything of them, and how."""

    x: float
    y: float
    theta: float
    posture: str


@dataclass
class Human:
    """Somebody at this moment."""

    number: int
    person: Person
    body: Body
    theta: float
    posture: str
    home: Home | None = None
    """Where they go back to; None for somebody who came in from outside."""
    errand: Errand = Errand.NONE
    route: tuple[Spot, ...] = ()
    """Where they still have to go, the next spot first."""
    towards: str | None = None
    """The place where the route ends."""
    pace: float = 1.1
    walking: bool = False
    """Whether they are on their feet and moving, or about to."""
    comes: bool = False
    """Whether they come to the robot and have not arrived."""
    crumb: int = 0
    """How far along the robot's trail somebody who comes along has got."""
    busy_until: float = 0.0
    """They walk nowhere of their own accord before."""
    looks_until: float = 0.0
    """Until then they look at the robot."""
    waits_since: float | None = None
    """Since when the robot has been in their way."""
    stop: int = 0
    """Which of the places they walk between was the last."""
    answered: int = 0
    """How many of their answers they have given."""
    said: str | None = None
    """Their last answer."""
    holding: list[int] = field(default_factory=list)
    """Numbers of things."""

    def copy(self, body: Body) -> Human:
        return replace(self, body=body, holding=list(self.holding))

    @property
    def name(self) -> str:
        return self.person.name

    @property
    def position(self) -> Spot:
        return self.body.position

    def distance(self, spot: Spot) -> float:
        return math.dist(self.body.position, spot)

    # --- what others ask of them -----------------------------------------------------------------

    def attend(self, hospital: Hospital, seconds: float = 5.0) -> None:
        """Look at the robot, and do not walk away, for some time."""
        self.looks_until = max(self.looks_until, hospital.time + seconds)
        self.busy_until = max(self.busy_until, hospital.time + 3 * seconds)
        if self.errand is Errand.WALK and not self.comes:
            self.stand_still()

    def walk_to(self, hospital: Hospital, spot: Spot, towards: str | None = None) -> bool:
        """Set out for a spot; False if there is no way."""
        way = hospital.chart.route(self.position, spot, hospital.closed_doors())
        if way is None:
            return False
        self._stand_up()
        self.errand, self.route, self.towards = Errand.WALK, way.points[1:], towards
        self.walking = True
        return True

    def come_along(self, hospital: Hospital) -> None:
        """Let the robot guide them, at a pace of their own."""
        self._stand_up()
        self.errand, self.route, self.crumb = Errand.COME_ALONG, (), 0
        self.pace = self._own_pace(hospital)
        self.walking = True

    def lead(self, hospital: Hospital, spot: Spot, towards: str | None) -> bool:
        """Set out for a spot with the robot following; False if there is no way."""
        if not self.walk_to(hospital, spot, towards):
            return False
        self.errand = Errand.LEAD
        # The robot must be able to keep up.
        self.pace = min(self._own_pace(hospital), 0.8)
        return True

    def stand_still(self) -> None:
        """Stop walking, here."""
        self.errand, self.route, self.comes = Errand.NONE, (), False
        self.walking = False
        self.waits_since = None
        self.body.rest()

    def _stand_up(self) -> None:
        self.posture = "standing"

    def _own_pace(self, hospital: Hospital) -> float:
        attributes = {word for text in self.person.is_ for word in text.casefold().split()}
        if attributes & words().slow:
            return 0.5
        if hospital.random.random() < 0.25:
            return hospital.random.uniform(0.7, 0.95)
        return hospital.random.uniform(1.0, 1.2)

    # --- their own life --------------------------------------------------------------------------

    def step(self, hospital: Hospital) -> None:
        if (hospital.steps + self.number) % _THINK_EVERY:
            return
        if self.errand is Errand.COME_ALONG:
            self._go_after_robot(hospital)
        elif self.errand is not Errand.NONE:
            self._go_on(hospital)
        elif hospital.time < self.looks_until:
            self._look_at(hospital.robot.position)
        elif hospital.time >= self.busy_until:
            self._set_out(hospital)

    def _set_out(self, hospital: Hospital) -> None:
        """On to the next of the places they walk between, or back home."""
        if not self.person.walks:
            if self.home is not None and self.distance((self.home.x, self.home.y)) > _AT_HOME:
                self.busy_until = hospital.time + 10.0
                self.walk_to(hospital, (self.home.x, self.home.y))
            return
        self.busy_until = hospital.time + hospital.random.uniform(5.0, 20.0)
        self.stop = (self.stop + 1) % len(self.person.walks)
        name = self.person.walks[self.stop]
        place = hospital.world.place(name)
        pose = hospital.pose_of(place) if place else None
        if place is None or pose is None:
            return
        # Not where the robot would stand.
        spot = hospital.free_spot(pose[0], pose[1], 0.8, 2.5)
        if spot is not None:
            self.pace = self._own_pace(hospital)
            self.walk_to(hospital, spot, place.name)

    def _go_on(self, hospital: Hospital) -> None:
        if self.errand is Errand.LEAD and self.distance(hospital.robot.position) > 3.5:
            self._pause(hospital)
            return
        here = self.position
        while self.route and math.dist(here, self.route[0]) < _REACHED:
            self.route = self.route[1:]
        near_robot = self.comes and self.distance(hospital.robot.position) < 1.3
        if not self.route or near_robot:
            self.stand_still()
            self._settle(hospital)
            return
        if self._robot_in_way(hospital, self.route[0]):
            self._wait_for_robot(hospital)
            return
        self.waits_since = None
        self._walk_towards(hospital, self.route[0], self.pace)

    def _settle(self, hospital: Hospital) -> None:
        """They have arrived."""
        home = self.home
        if home is not None and self.distance((home.x, home.y)) < _AT_HOME:
            self.theta, self.posture = home.theta, home.posture
        else:
            self.looks_until = hospital.time + 2.0
        self.busy_until = hospital.time + hospital.random.uniform(8.0, 25.0)

    def stay(self, hospital: Hospital) -> None:
        """Stand still where somebody has brought them, for a while."""
        self.stand_still()
        self.attend(hospital)
        self.busy_until = hospital.time + _VISIT

    def _go_after_robot(self, hospital: Hospital) -> None:
        if self.route:  # out of the robot's way first
            self._walk_towards(hospital, self.route[0], self.pace)
            if self.distance(self.route[0]) < _REACHED:
                self.route = self.route[1:]
            return
        gap = self.distance(hospital.robot.position)
        trail, here = hospital.trail, self.position
        # The last crumb within reach is the one to go on from.
        while self.crumb < len(trail) - 1 and math.dist(here, trail[self.crumb]) < 0.3:
            self.crumb += 1
        if gap < _BEHIND or not trail:
            self._pause(hospital)
            return
        slower = min(1.0, (gap - _BEHIND) / 0.5 + 0.2)
        self._walk_towards(hospital, trail[self.crumb], self.pace * slower)

    def _pause(self, hospital: Hospital) -> None:
        self.body.drive(0.0, 0.0)
        self._look_at(hospital.robot.position)

    def _walk_towards(self, hospital: Hospital, spot: Spot, speed: float) -> None:
        x, y = self.position
        away = math.dist((x, y), spot)
        if away < 1e-6:
            self.body.drive(0.0, 0.0)
            return
        speed = min(speed, away * 15)
        vx, vy = speed * (spot[0] - x) / away, speed * (spot[1] - y) / away
        self.theta = bearing((x, y), spot)
        # Close to the robot they slip past without bumping into it.
        robot = hospital.robot
        rx, ry = robot.position
        apart = max(math.dist((x, y), (rx, ry)), 1e-6)
        ux, uy = (rx - x) / apart, (ry - y) / apart
        closing = vx * ux + vy * uy
        allowed = 2 * (apart - robot.body.radius - self.body.radius - _SLIP)
        if closing > allowed and apart < 1.0:
            vx, vy = vx - (closing - allowed) * ux, vy - (closing - allowed) * uy
        self.body.drive(vx, vy)

    def _look_at(self, spot: Spot) -> None:
        if self.posture == "lying":
            return
        off = wrap(bearing(self.position, spot) - self.theta)
        self.theta = wrap(self.theta + max(-_TURN, min(_TURN, off)))

    # --- the robot in the way --------------------------------------------------------------------

    def _robot_in_way(self, hospital: Hospital, spot: Spot) -> bool:
        robot = hospital.robot
        gap = self.distance(robot.position) - robot.body.radius - self.body.radius
        if gap > _ROOM:
            return False
        return abs(wrap(bearing(self.position, robot.position) - bearing(self.position, spot))) < 60

    def _wait_for_robot(self, hospital: Hospital) -> None:
        """First wait, then walk around the robot, and where there is no room step back."""
        self._pause(hospital)
        if self.waits_since is None:
            self.waits_since = hospital.time
        if hospital.time - self.waits_since < _PATIENCE:
            return
        self.waits_since = hospital.time
        robot = hospital.robot
        keep = robot.body.radius + self.body.radius + _ROOM
        way = hospital.chart.route(
            self.position,
            self.route[-1],
            hospital.closed_doors(),
            [Disc(*robot.position, keep)],
        )
        if way is not None:
            self.route = way.points[1:]
        elif robot.waits_for == self.name:
            self.make_way(hospital)

    def make_way(self, hospital: Hospital) -> bool:
        """Step out of the robot's way, if they are on their feet and there is somewhere to go."""
        if self.posture != "standing":
            return False
        robot = hospital.robot.position
        x, y = self.position
        first = hospital.chart.nearest_free(x, y)
        if first is None:
            return False
        away = math.radians(bearing(robot, (x, y)))
        for reach in (1.2, 1.8, 2.6):
            for side in (90, -90, 60, -60, 30, -30, 0):
                angle = away + math.radians(side)
                spot = (x + reach * math.cos(angle), y + reach * math.sin(angle))
                if (
                    math.dist(spot, robot) > 1.0
                    and hospital.chart.clear(first, spot)
                    and not _in_closed_door(hospital, first, spot)
                ):
                    later = () if self.errand is Errand.COME_ALONG else self.route[-1:]
                    self.route = (first, spot, *later)
                    if self.errand is Errand.NONE:
                        self.errand, self.walking = Errand.WALK, True
                    self.waits_since = None
                    return True
        return False


def _in_closed_door(hospital: Hospital, start: Spot, end: Spot) -> bool:
    return not hospital.physics.sees(start, end)
