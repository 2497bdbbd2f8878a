"""Driving to a goal: plan a way, follow it, and find another around what is in the way.

`drive_to`, `move`, `turn`, `drive` and `dock` are whole behaviours; `travel` is a part for other
behaviours that have the wheel already.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from sim.behaviours.tracking import KEEP, Progress, is_still, track
from sim.behaviours.wheel import braking, check_battery, come_to_rest, face, turn_by, wheel
from sim.errors import Blocked, NotPossible
from sim.hospital import PERSON_RADIUS, Hospital
from sim.people.crowd import Errand, Human
from sim.physics.bodies import STEP
from sim.physics.navigation import Disc, Route, Spot
from sim.physics.robot import bearing
from sim.runner import Behaviour

_KEEP_AROUND = 0.15
"""Metres to leave to somebody when planning a way around them."""
_DOOR_REMEMBERED = 120.0
_FREE_ENOUGH = 1.5
"""Metres ahead in which something may be in the way of a straight drive."""
_PATIENCE = 12.0
"""Seconds that the robot waits where there is no way around."""


# --- whole behaviours ----------------------------------------------------------------------------


def drive_to(hospital: Hospital, x: float, y: float, theta: float | None) -> Behaviour[None]:
    with wheel(hospital):
        yield from travel(hospital, (x, y), theta)


def dock(hospital: Hospital) -> Behaviour[None]:
    charger = hospital.world.charger
    if charger is None or charger.pose is None:
        raise NotPossible(
            "There is no charging station on this map. Add a place of kind charger to the world."
        )
    with wheel(hospital):
        yield from travel(hospital, (charger.pose.x, charger.pose.y), charger.pose.theta)


def move(hospital: Hospital, metres: float) -> Behaviour[None]:
    robot = hospital.robot
    ahead = math.copysign(1.0, metres)
    with wheel(hospital):
        start = robot.position
        heading = math.radians(robot.theta + (0 if ahead > 0 else 180))
        gone = 0.0
        while (left := abs(metres) - gone) > 0.005:
            check_battery(hospital)
            free = _free_ahead(hospital, heading)
            if free < min(left, 0.02):
                raise Blocked(_in_the_way(hospital, heading, gone))
            robot.aim(ahead * min(robot.pace.speed, braking(min(left, free))), 0.0)
            yield
            x, y = robot.position
            gone = (x - start[0]) * math.cos(heading) + (y - start[1]) * math.sin(heading)
        yield from come_to_rest(hospital)


def turn(hospital: Hospital, degrees: float) -> Behaviour[None]:
    with wheel(hospital):
        yield from turn_by(hospital, degrees)


def drive(hospital: Hospital, linear: float, angular: float, seconds: float) -> Behaviour[None]:
    robot = hospital.robot
    pace = robot.pace
    linear = max(-pace.speed, min(pace.speed, linear))
    angular = max(-pace.turn_rate, min(pace.turn_rate, angular))
    with wheel(hospital, joystick=True) as mine:
        end = hospital.time + seconds
        while hospital.time < end - STEP / 2:
            check_battery(hospital)
            speed = linear
            if linear:
                heading = math.radians(robot.theta + (0 if linear > 0 else 180))
                free = _free_ahead(hospital, heading)
                if free < 0.02:
                    raise Blocked(_in_the_way(hospital, heading, None))
                speed = math.copysign(min(abs(linear), braking(free)), linear)
            robot.aim(speed, angular)
            yield
            if robot.driver is not mine:
                return  # a newer movement of the joystick
        yield from come_to_rest(hospital)


def _free_ahead(hospital: Hospital, heading: float) -> float:
    body, physics = hospital.robot.body, hospital.physics
    return min(
        physics.free_ahead(body, heading, _FREE_ENOUGH),
        physics.free_of_borders(body, heading, _FREE_ENOUGH),
    )


def _in_the_way(hospital: Hospital, heading: float, gone: float | None) -> str:
    """A sentence about what stops a straight drive."""
    x, y = hospital.robot.position
    beyond = (x + 0.5 * math.cos(heading), y + 0.5 * math.sin(heading))
    near = [human for human in hospital.people if human.distance(beyond) < 0.45]
    what = near[0].name if near else "A wall or furniture"
    body, physics = hospital.robot.body, hospital.physics
    border = physics.free_of_borders(body, heading, _FREE_ENOUGH)
    if border < physics.free_ahead(body, heading, _FREE_ENOUGH):
        what = _zone_beside(hospital, beyond) or what
    after = f" after {max(0.0, gone):.1f} metres" if gone is not None else ""
    return f"{what} is in the way{after}. Turn first, or drive to a place instead."


def _zone_beside(hospital: Hospital, spot: Spot) -> str | None:
    """The zone nearest to a spot, to be spoken of."""
    near = [(hospital.chart.to_zone(name, *spot), zone.name) for name, zone in hospital.zones]
    return f'The keep-out zone "{min(near)[1]}"' if near else None


# --- to a goal -----------------------------------------------------------------------------------


def travel(
    hospital: Hospital,
    goal: Spot,
    theta: float | None = None,
    limit: Callable[[], float] | None = None,
) -> Behaviour[None]:
    """Drive to a spot and turn to `theta`. `limit` says each step how fast it may drive at most.
    Raises `NotPossible` if it cannot stand there, `Blocked` if there is no way."""
    progress = Progress(hospital)
    around: Human | None = None
    while True:
        check_goal(hospital, goal)
        route = _plan(hospital, goal, around)
        trouble = yield from track(hospital, route, around, progress, limit)
        if trouble is None:
            break
        progress.detour(goal)
        around = trouble if isinstance(trouble, Human) else None
        if around is not None and _around(hospital, goal, around) is None:
            yield from _wait_for_person(hospital, around, progress, goal)
    hospital.robot.waits_for = None
    yield from come_to_rest(hospital)
    if theta is not None:
        yield from face(hospital, theta)


def check_goal(hospital: Hospital, goal: Spot) -> None:
    """Raise `NotPossible` if the robot cannot stand there."""
    name = hospital.name_of_spot(*goal)
    if not hospital.chart.fits(*goal):
        raise NotPossible(
            f"The robot cannot stand at {goal[0]:.1f}, {goal[1]:.1f} ({name}): there is a wall or "
            "furniture, or no floor. Choose a spot on free floor."
        )
    for gate, zone in hospital.zones:
        if hospital.chart.to_zone(gate, *goal) < hospital.chart.radius:
            raise NotPossible(
                f'{name} lies in the keep-out zone "{zone.name}". Choose another place, or have '
                "the zone removed."
            )


def way_to(hospital: Hospital, goal: Spot) -> Route | None:
    """The way the robot would take to a spot, for all it knows; None if there is none."""
    return hospital.chart.route(hospital.robot.position, goal, _closed(hospital))


def lengths_to(hospital: Hospital, goals: Sequence[Spot]) -> list[float]:
    """How long the robot's way to each of several spots is; infinite where there is none."""
    return hospital.chart.lengths(hospital.robot.position, goals, _closed(hospital))


def _closed(hospital: Hospital) -> set[str]:
    """The gates that the robot does not plan to pass: doors it knows are closed, keep-out zones."""
    now = hospital.time
    doors = {gate for gate, seen in hospital.known_closed.items() if now - seen < _DOOR_REMEMBERED}
    return doors | {gate for gate, _ in hospital.zones}


def _plan(hospital: Hospital, goal: Spot, around: Human | None) -> Route:
    """A way around those who stand here, else one through where they stand."""
    found = _around(hospital, goal, around) or way_to(hospital, goal)
    if found is None:
        raise Blocked(_no_way(hospital, goal))
    return found


def _around(hospital: Hospital, goal: Spot, human: Human | None) -> Route | None:
    here = hospital.robot.position
    keep = hospital.robot.body.radius + PERSON_RADIUS
    near = [
        other
        for other in hospital.people
        if other is human or (is_still(other) and other.distance(here) < 5.0)
    ]
    for other in near:
        if other.distance(goal) < keep + KEEP:
            goal = _beside(hospital, other, keep + _KEEP_AROUND) or goal
    discs = [Disc(*other.position, keep + _KEEP_AROUND) for other in near]
    return hospital.chart.route(here, goal, _closed(hospital), discs)


def _beside(hospital: Hospital, human: Human, reach: float) -> Spot | None:
    """The nearest spot next to somebody who stands where the robot should go."""
    x, y = human.position
    towards = math.radians(bearing((x, y), hospital.robot.position))
    for side in (0, 30, -30, 60, -60, 90, -90, 130, -130, 180):
        angle = towards + math.radians(side)
        spot = (x + reach * math.cos(angle), y + reach * math.sin(angle))
        if hospital.chart.fits(*spot) and hospital.physics.sees((x, y), spot):
            return spot
    return None


def _wait_for_person(
    hospital: Hospital, human: Human, progress: Progress, goal: Spot
) -> Behaviour[None]:
    """Nobody gets past somebody: wait until they have gone on."""
    robot = hospital.robot
    robot.waits_for = human.name
    yield from come_to_rest(hospital)
    where = human.position
    next_try = hospital.time + 1.0
    while human.distance(where) < 0.4:
        if hospital.time >= next_try:
            next_try += 1.0
            if _around(hospital, goal, human) is not None:
                return
            if progress.waited > 3.0 and human.errand in (Errand.NONE, Errand.COME_ALONG):
                human.make_way(hospital)
        if progress.waited > _PATIENCE:
            place = hospital.name_of_spot(*human.position)
            raise Blocked(
                f"{human.name} is in the way at {place}, and there is no way around to "
                f"{hospital.name_of_spot(*goal)}. Ask them to step aside, then try again."
            )
        yield


def _no_way(hospital: Hospital, goal: Spot) -> str:
    name = hospital.name_of_spot(*goal)
    here = hospital.robot.position
    zones = {gate for gate, _ in hospital.zones}
    for gates in (zones, ()):
        route = hospital.chart.route(here, goal, gates)
        shut = sorted(route.gates & hospital.known_closed.keys()) if route else []
        if shut:
            door = hospital.gate_name(shut[0])
            return (
                f"The way to {name} is blocked: {door} is closed. "
                "Have it opened, or choose another place."
            )
        if route is not None and (crossed := sorted(route.gates & zones)):
            return (
                f"The way to {name} leads through {hospital.gate_name(crossed[0])}, and there is "
                "no other. Choose another place, or have the zone removed."
            )
    return (
        f"There is no way for the robot from {hospital.name_of_spot(*here)} to {name}. "
        "Choose another place."
    )
