"""Driving along a route: smoothly, slower where people are, until its end or until something is
in the way."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from sim.behaviours.wheel import braking, check_battery, come_to_rest
from sim.errors import Blocked
from sim.hospital import PERSON_RADIUS, Hospital
from sim.people.crowd import Human
from sim.physics.bodies import STEP
from sim.physics.navigation import Route, Spot
from sim.physics.robot import bearing, wrap
from sim.runner import Behaviour

_LOOK_EVERY = 4  # steps between two looks for people and doors
_LOOK_AHEAD = 2.5
"""Metres of the route in which people count."""
KEEP = 0.08
"""Metres to leave to a person when passing."""
_MOST_DETOURS = 20
_DOOR_IN_VIEW = 2.0
_HELD, _HELD_BY_WALKER = 1.0, 3.0
"""Seconds that it waits for somebody who stands, or who walks, before it looks for a way around."""


class Progress:
    """How long the robot has got no further."""

    def __init__(self, hospital: Hospital) -> None:
        self._hospital = hospital
        self._spot = hospital.robot.position
        self._since = hospital.time
        self._detours = 0

    @property
    def waited(self) -> float:
        """Seconds since it last got on."""
        self._look()
        return self._hospital.time - self._since

    def _look(self) -> None:
        if math.dist(self._spot, self._hospital.robot.position) > 0.5:
            self.renew()
            self._detours = 0

    def renew(self) -> None:
        self._spot, self._since = self._hospital.robot.position, self._hospital.time

    def detour(self, goal: Spot) -> None:
        """Count one; raises `Blocked` where many lead nowhere."""
        self._look()
        self._detours += 1
        if self._detours > _MOST_DETOURS:
            raise Blocked(
                f"The robot does not get through to {self._hospital.name_of_spot(*goal)}: "
                "the way is blocked again and again. Try again when it is calmer."
            )


@dataclass(frozen=True)
class ClosedDoor:
    gate: str


@dataclass(frozen=True)
class Stuck:
    pass


@dataclass(frozen=True)
class OtherZones:
    """The keep-out zones were drawn anew."""


Trouble = Human | ClosedDoor | Stuck | OtherZones


def track(
    hospital: Hospital,
    route: Route,
    around: Human | None,
    progress: Progress,
    limit: Callable[[], float] | None,
) -> Behaviour[Trouble | None]:
    """Drive along a route, which was planned around somebody; returns None at its end, or what is
    in the way."""
    robot, points, chart = hospital.robot, route.points, hospital.chart
    rest = _lengths_from_end(points)
    leg = 1
    allowed = robot.pace.speed
    pushed = 0  # steps without getting anywhere though the wheels turn
    looks = 0
    held_since = hospital.time
    while leg < len(points):
        check_battery(hospital)
        if hospital.chart is not chart:
            return OtherZones()
        here = robot.position
        while leg < len(points) - 1 and _off(here, points[leg], points[leg + 1]) <= _off(
            here, points[leg - 1], points[leg]
        ):
            leg += 1
        robot.way = points[leg:]
        remaining = rest[leg] + max(0.0, _left(here, points[leg - 1], points[leg]))
        if remaining < 0.02 or (leg == len(points) - 1 and math.dist(here, points[-1]) < 0.02):
            break
        if looks % _LOOK_EVERY == 0:
            door = _closed_door_ahead(hospital, route)
            if door is not None:
                return door
            allowed, human = _people_ahead(hospital, points, leg)
            robot.waits_for = human.name if human is not None else None
            if human is None or robot.speed > 0.05:
                held_since = hospital.time
            elif hospital.time - held_since > (_HELD if is_still(human) else _HELD_BY_WALKER):
                return human
            if human is not None and human is not around and is_still(human) and allowed > 0.3:
                return human  # seen in time to go around without a stop
        looks += 1
        ahead = _point_ahead(points, leg, here, 0.3 + 0.2 * robot.speed)
        off = wrap(bearing(here, ahead) - robot.theta)
        speed = min(allowed, braking(remaining))
        if limit is not None:
            speed = min(speed, limit())
        # Turn first when the way leads elsewhere; slow down in bends.
        speed *= 0.0 if abs(off) > 50 else max(0.15, math.cos(math.radians(off))) ** 2
        robot.aim(speed, max(-robot.pace.turn_rate, min(robot.pace.turn_rate, 3.5 * off)))
        yield
        if robot.speed > 0.1 and math.dist(here, robot.position) < 0.3 * robot.speed * STEP:
            pushed += 1
            if pushed > 120:
                yield from come_to_rest(hospital)
                return _nearest_in_touch(hospital) or Stuck()
        else:
            pushed = 0
        if limit is not None and limit() < 0.05:
            progress.renew()  # it waits because it wants to
    return None


def _closed_door_ahead(hospital: Hospital, route: Route) -> ClosedDoor | None:
    here = hospital.robot.position
    for gate in route.gates & hospital.closed_doors():
        x1, y1, x2, y2 = hospital.world.doors[int(gate.removeprefix("door "))].ends
        if math.dist(here, ((x1 + x2) / 2, (y1 + y2) / 2)) < _DOOR_IN_VIEW:
            hospital.known_closed[gate] = hospital.time
            return ClosedDoor(gate)
    return None


def _people_ahead(
    hospital: Hospital, points: tuple[Spot, ...], leg: int
) -> tuple[float, Human | None]:
    """How fast people allow to drive, and who is in the way."""
    here = hospital.robot.position
    allowed, who = hospital.robot.pace.speed, None
    keep = hospital.robot.body.radius + PERSON_RADIUS + KEEP
    for human in hospital.people:
        now = human.distance(here)
        if now > _LOOK_AHEAD:
            continue
        vx, vy = human.body.velocity
        x, y = human.position
        for spot in ((x, y), (x + 0.6 * vx, y + 0.6 * vy)):
            free = _free_until(here, points, leg, spot, min(keep, now - 0.03))
            if free < _LOOK_AHEAD and (speed := braking(free - 0.05)) < allowed:
                allowed, who = speed, human
    return allowed, who


def _free_until(here: Spot, points: tuple[Spot, ...], leg: int, spot: Spot, keep: float) -> float:
    """How far along the route one comes before being nearer than `keep` to the spot."""
    gone, start = 0.0, here
    for end in points[leg:]:
        length = math.dist(start, end)
        if length > 1e-9:
            ux, uy = (end[0] - start[0]) / length, (end[1] - start[1]) / length
            along = (spot[0] - start[0]) * ux + (spot[1] - start[1]) * uy
            aside = abs((spot[0] - start[0]) * uy - (spot[1] - start[1]) * ux)
            if aside < keep:
                half = math.sqrt(keep * keep - aside * aside)
                if along + half > 0 and along - half < length:
                    return gone + max(0.0, along - half)
        gone += length
        if gone > _LOOK_AHEAD:
            break
        start = end
    return math.inf


def _nearest_in_touch(hospital: Hospital) -> Human | None:
    here = hospital.robot.position
    near = min(hospital.people, key=lambda human: human.distance(here), default=None)
    touch = hospital.robot.body.radius + PERSON_RADIUS + 0.1
    return near if near is not None and near.distance(here) < touch else None


def is_still(human: Human) -> bool:
    vx, vy = human.body.velocity
    return vx * vx + vy * vy < 0.01


# --- geometry ------------------------------------------------------------------------------------


def _lengths_from_end(points: tuple[Spot, ...]) -> list[float]:
    """For each point, how long the rest of the route is."""
    rest = [0.0]
    for start, end in zip(points[-2::-1], points[:0:-1], strict=True):
        rest.append(rest[-1] + math.dist(start, end))
    return rest[::-1]


def _left(here: Spot, start: Spot, end: Spot) -> float:
    """How much of a leg is left, seen along it."""
    length = math.dist(start, end)
    if length < 1e-9:
        return 0.0
    return ((end[0] - here[0]) * (end[0] - start[0]) + (end[1] - here[1]) * (end[1] - start[1])) / (
        length
    )


def _off(here: Spot, start: Spot, end: Spot) -> float:
    """How far from a leg one is."""
    length = math.dist(start, end)
    left = min(max(_left(here, start, end), 0.0), length)
    share = left / length if length > 1e-9 else 0.0
    return math.dist(
        here, (end[0] + (start[0] - end[0]) * share, end[1] + (start[1] - end[1]) * share)
    )


def _point_ahead(points: tuple[Spot, ...], leg: int, here: Spot, reach: float) -> Spot:
    """The spot on the route so far ahead; its end if that is nearer."""
    start, end = points[leg - 1], points[leg]
    left = min(max(_left(here, start, end), 0.0), math.dist(start, end))
    while left < reach and leg < len(points) - 1:
        reach -= left
        leg += 1
        start, end = points[leg - 1], points[leg]
        left = math.dist(start, end)
    length = math.dist(start, end)
    if left <= reach or length < 1e-9:
        return end
    share = (left - reach) / length
    return end[0] + (start[0] - end[0]) * share, end[1] + (start[1] - end[1]) * share
