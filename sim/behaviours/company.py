"""Going somewhere together: lead a person, or follow one."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence

from sim.behaviours.driving import check_goal, lengths_to, travel
from sim.behaviours.searching import approach
from sim.behaviours.wheel import come_to_rest, face, wheel
from sim.errors import Blocked, NotFound
from sim.hospital import Hospital
from sim.people.crowd import Errand, Human
from sim.people.perception import person_in_view
from sim.physics.navigation import Spot
from sim.physics.robot import bearing
from sim.runner import Behaviour
from sim.world.model import Place

_SLOW_GAP, _WAIT_GAP = 1.8, 2.8
"""Metres of lead from which the robot slows down, and at which it waits."""
_CREEP = 0.1
"""A share of the speed below which it rather stands."""
_LOST_AFTER = 90.0
"""Seconds after which the robot waits no longer."""
_CRUMB = 0.2
"""Metres between two marks of the robot's trail."""
_FOLLOW_GAP = 1.2
_BY = 0.8
"""Metres from somebody's way at which the robot lets them by."""
_STANDS_AFTER = 4.0
"""Seconds of standing still that end following."""


def guide(
    hospital: Hospital, person: str, x: float, y: float, theta: float | None
) -> Behaviour[None]:
    """Lead somebody who is here, at their pace, waiting for them."""
    check_goal(hospital, (x, y))
    with wheel(hospital):
        human = person_in_view(hospital, person)
        hospital.partner = human.name
        if human.distance(hospital.robot.position) > 1.5:
            yield from approach(hospital, human, 1.0)
        hospital.trail = [hospital.robot.position]
        human.come_along(hospital)
        waiting = _Waiting(hospital, human)
        try:
            way = travel(hospital, (x, y), theta, waiting.limit)
            for _ in way:
                _leave_trail(hospital)
                waiting.check()
                yield
            _leave_trail(hospital)
            while human.distance(hospital.robot.position) > _SLOW_GAP:
                waiting.check()
                yield
        finally:
            human.stay(hospital)
            hospital.trail = []


class _Waiting:
    """How fast the robot may lead, and for how long it has waited."""

    def __init__(self, hospital: Hospital, human: Human) -> None:
        self._hospital, self._human = hospital, human
        self._near = hospital.time

    def limit(self) -> float:
        gap = self._human.distance(self._hospital.robot.position)
        share = (_WAIT_GAP - gap) / (_WAIT_GAP - _SLOW_GAP)
        most = self._hospital.robot.pace.speed
        return most * min(1.0, share) if share > _CREEP else 0.0

    def check(self) -> None:
        gap = self._human.distance(self._hospital.robot.position)
        if gap < _WAIT_GAP - 2 * _CREEP:
            self._near = self._hospital.time
        elif self._hospital.time - self._near > _LOST_AFTER:
            raise NotFound(
                f"{self._human.name} no longer comes along. Look for them and start again."
            )


def _leave_trail(hospital: Hospital) -> None:
    here = hospital.robot.position
    if math.dist(here, hospital.trail[-1]) >= _CRUMB:
        hospital.trail.append(here)


# --- following -----------------------------------------------------------------------------------


def follow(hospital: Hospital, person: str, to: str | None) -> Behaviour[None]:
    """Go after somebody who is here until they are at `to`, or stand still for a while."""
    target = hospital.place_named(to) if to is not None else None
    with wheel(hospital):
        human = person_in_view(hospital, person)
        hospital.partner = human.name
        if human.distance(hospital.robot.position) > 2.0:
            yield from approach(hospital, human, _FOLLOW_GAP)
        if human.errand is not Errand.WALK or target is not None:
            _send_ahead(hospital, human, target)
        else:
            human.errand = Errand.LEAD
        try:
            yield from _go_after(hospital, human)
        finally:
            human.stay(hospital)
        if target is not None and not _is_at(hospital, human, target):
            raise Blocked(
                f"{human.name} stopped on the way to {target.name}. "
                "Ask them to go on, then follow them again."
            )


def _send_ahead(hospital: Hospital, human: Human, target: Place | None) -> None:
    """Let the person walk to the place; without one, to the next on their round or to some place
    or other."""
    if target is None:
        here = hospital.world.place_at(*human.position)
        names = [name for name in human.person.walks if not here or name != here.name]
        if not names:
            names = [
                place.name
                for place in hospital.world.places
                if hospital.pose_of(place) and place is not here
            ]
            hospital.random.shuffle(names)
        for name in names:
            place = hospital.world.place(name)
            if place is not None and _set_out(hospital, human, place):
                return
        return
    if not _set_out(hospital, human, target):
        raise Blocked(
            f"{human.name} finds no way to {target.name}. Choose another place, or open the doors."
        )


def _set_out(hospital: Hospital, human: Human, place: Place) -> bool:
    pose = hospital.pose_of(place)
    if pose is None:
        return False
    spot = hospital.free_spot(pose[0], pose[1], 0.0, 2.0) or (pose[0], pose[1])
    return human.lead(hospital, spot, place.name)


def _go_after(hospital: Hospital, human: Human) -> Behaviour[None]:
    """Keep behind the person until they have stood still for a while."""
    robot = hospital.robot
    still_since = hospital.time
    spot = human.position
    while True:
        if human.distance(spot) > 0.3:
            spot, still_since = human.position, hospital.time
        if human.waits_since is not None:
            yield from _step_aside(hospital, human)
        elif human.distance(robot.position) > _FOLLOW_GAP + 0.3:
            yield from _catch_up(hospital, human)
            continue
        if hospital.time - still_since > _STANDS_AFTER and human.errand is not Errand.LEAD:
            break
        if hospital.time - still_since > _LOST_AFTER:
            break
        yield
    yield from come_to_rest(hospital)
    yield from face(hospital, bearing(robot.position, human.position))


def _step_aside(hospital: Hospital, human: Human) -> Behaviour[None]:
    """Let the person by, whose way leads past the robot."""
    chart, here = hospital.chart, hospital.robot.position
    way = (human.position, *human.route)
    spots = [
        (here[0] + reach * math.cos(angle), here[1] + reach * math.sin(angle))
        for reach in (0.8, 1.2, 1.8, 2.5, 3.5)
        for angle in (math.radians(human.theta + side) for side in (90, -90, 60, -60, 30, -30, 0))
    ]
    for spot in spots:
        if chart.distance(*spot) >= chart.clearance and _away(spot, way) > _BY:
            length = lengths_to(hospital, [spot])[0]
            if length < 2 * math.dist(here, spot):
                yield from travel(hospital, spot)
                return
    yield


def _away(spot: Spot, way: Sequence[Spot]) -> float:
    """How far a spot is from a way's first few metres."""
    nearest, gone = math.inf, 0.0
    for start, end in itertools.pairwise(way):
        length = math.dist(start, end)
        for i in range(int(length / 0.2) + 1):
            share = i * 0.2 / length if length else 0.0
            on_way = (
                start[0] + share * (end[0] - start[0]),
                start[1] + share * (end[1] - start[1]),
            )
            nearest = min(nearest, math.dist(spot, on_way))
        gone += length
        if gone > 6:
            break
    return nearest


def _catch_up(hospital: Hospital, human: Human) -> Behaviour[None]:
    """Drive the way to where the person is now until near them, or until they are elsewhere."""
    aim = human.position
    goal = _near(hospital, aim)
    if goal is None:
        yield
        return
    way = travel(hospital, goal, None, lambda: _speed_after(hospital, human))
    for steps, _ in enumerate(way):
        yield
        gap = human.distance(hospital.robot.position)
        if gap < _FOLLOW_GAP and not human.walking:
            break
        if steps > 20 and human.distance(aim) > 0.5:
            break
    way.close()


def _speed_after(hospital: Hospital, human: Human) -> float:
    gap = human.distance(hospital.robot.position)
    return hospital.robot.pace.speed * max(0.1, min(1.0, gap - _FOLLOW_GAP + 0.5))


def _near(hospital: Hospital, spot: Spot) -> Spot | None:
    return hospital.chart.nearest_free(*spot)


def _is_at(hospital: Hospital, human: Human, place: Place) -> bool:
    at = hospital.world.place_at(*human.position)
    pose = hospital.pose_of(place)
    return (at is not None and at.name == place.name) or (
        pose is not None and human.distance((pose[0], pose[1])) < 2.5
    )
