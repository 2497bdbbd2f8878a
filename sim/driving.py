"""Driving: follow a route smoothly, slow down for people, find a way around what is in the way.

`drive_to`, `move`, `turn`, `drive` and `dock` are whole behaviours; `travel` and `face` are parts
for other behaviours that have the wheel already.
"""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from sim.errors import Blocked, NotPossible
from sim.hospital import PERSON_RADIUS, Hospital
from sim.navigation import Disc, Route, Spot
from sim.people import Errand, Human
from sim.physics import STEP
from sim.robot import SLOW_DOWN, TOP_SPEED, TOP_TURN, TURN_CHANGE, bearing, wrap
from sim.runner import Behaviour

_LOOK_EVERY = 4  # steps between two looks for people and doors
_LOOK_AHEAD = 2.5
"""Metres of the route in which people count."""
_KEEP = 0.08
"""Metres to leave to a person when passing; a way around somebody is planned with more."""
_KEEP_AROUND = 0.15
_DOOR_IN_VIEW = 2.0
_DOOR_REMEMBERED = 120.0
_HELD, _HELD_BY_WALKER = 1.0, 3.0
"""Seconds that it waits for somebody who stands, or who walks, before it looks for a way around."""
_PATIENCE = 12.0
"""Seconds that the robot waits where there is no way around."""
_MOST_DETOURS = 20


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
            robot.aim(ahead * min(TOP_SPEED, _braking(min(left, free))), 0.0)
            yield
            x, y = robot.position
            gone = (x - start[0]) * math.cos(heading) + (y - start[1]) * math.sin(heading)
        yield from come_to_rest(hospital)


def turn(hospital: Hospital, degrees: float) -> Behaviour[None]:
    with wheel(hospital):
        yield from _turn(hospital, degrees)


def drive(hospital: Hospital, linear: float, angular: float, seconds: float) -> Behaviour[None]:
    robot = hospital.robot
    linear = max(-TOP_SPEED, min(TOP_SPEED, linear))
    angular = max(-TOP_TURN, min(TOP_TURN, angular))
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
                speed = math.copysign(min(abs(linear), _braking(free)), linear)
            robot.aim(speed, angular)
            yield
            if robot.driver is not mine:
                return  # a newer movement of the joystick
        yield from come_to_rest(hospital)


# --- having the wheel ----------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Wheel:
    joystick: bool


@contextlib.contextmanager
def wheel(hospital: Hospital, joystick: bool = False) -> Iterator[object]:
    """Have the wheel; the robot rests afterwards. One behaviour has it at a time, but that a
    movement of the joystick takes over from the one before."""
    robot = hospital.robot
    holder = robot.driver
    if isinstance(holder, _Wheel) and not (joystick and holder.joystick):
        raise NotPossible("The robot is already driving. Stop it first, or wait until it is there.")
    check_battery(hospital)
    mine = robot.driver = _Wheel(joystick)
    try:
        yield mine
    finally:
        if robot.driver is mine:
            robot.driver = None
            robot.waits_for = None
            robot.rest()


def check_battery(hospital: Hospital) -> None:
    if hospital.robot.battery <= 0:
        raise NotPossible("The battery is empty. Push the robot to its charging station.")


def come_to_rest(hospital: Hospital) -> Behaviour[None]:
    hospital.robot.aim(0.0, 0.0)
    while hospital.robot.moving:
        yield


def face(hospital: Hospital, theta: float) -> Behaviour[None]:
    """Turn on the spot, the shorter way round."""
    yield from _turn(hospital, wrap(theta - hospital.robot.theta))
    hospital.robot.theta = wrap(theta)


def _turn(hospital: Hospital, degrees: float) -> Behaviour[None]:
    robot = hospital.robot
    yield from come_to_rest(hospital)
    while abs(degrees) > 0.3:
        check_battery(hospital)
        rate = min(TOP_TURN, math.sqrt(1.6 * TURN_CHANGE * abs(degrees)), abs(degrees) / STEP)
        robot.aim(0.0, math.copysign(rate, degrees))
        yield
        degrees -= robot.turning * STEP
    yield from come_to_rest(hospital)


# --- to a goal -----------------------------------------------------------------------------------


def travel(
    hospital: Hospital,
    goal: Spot,
    theta: float | None = None,
    limit: Callable[[], float] | None = None,
) -> Behaviour[None]:
    """Drive to a spot and turn to `theta`. `limit` says each step how fast it may drive at most.
    Raises `NotPossible` if it cannot stand there, `Blocked` if there is no way."""
    check_goal(hospital, goal)
    patience = _Patience(hospital)
    around: Human | None = None
    while True:
        route = _plan(hospital, goal, around)
        trouble = yield from _track(hospital, route, around, patience, limit)
        if trouble is None:
            break
        patience.detour(goal)
        around = trouble if isinstance(trouble, Human) else None
        if around is not None and _around(hospital, goal, around) is None:
            yield from _wait_for_person(hospital, around, patience, goal)
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
    if any(hospital.chart.in_gate(zone, *goal) for zone in _zones(hospital)):
        raise NotPossible(
            f"{name} lies in an area that the robot must keep out of. Choose another place."
        )


def way_to(hospital: Hospital, goal: Spot) -> Route | None:
    """The way the robot would take to a spot, for all it knows; None if there is none."""
    return hospital.chart.route(hospital.robot.position, goal, _closed(hospital))


def lengths_to(hospital: Hospital, goals: Sequence[Spot]) -> list[float]:
    """How long the robot's way to each of several spots is; infinite where there is none."""
    return hospital.chart.lengths(hospital.robot.position, goals, _closed(hospital))


def _closed(hospital: Hospital) -> set[str]:
    """The gates that the robot does not plan to pass: doors it knows are closed, zones to keep out
    of unless it is in one."""
    now, here = hospital.time, hospital.robot.position
    doors = {gate for gate, seen in hospital.known_closed.items() if now - seen < _DOOR_REMEMBERED}
    return doors | {zone for zone in _zones(hospital) if not hospital.chart.in_gate(zone, *here)}


def _zones(hospital: Hospital) -> Iterator[str]:
    return (f"zone {i}" for i in range(len(hospital.world.keep_out)))


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
        if other is human or (_still(other) and other.distance(here) < 5.0)
    ]
    for other in near:
        if other.distance(goal) < keep + _KEEP:
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


def _still(human: Human) -> bool:
    vx, vy = human.body.velocity
    return vx * vx + vy * vy < 0.01


class _Patience:
    """How long the robot has got no further."""

    def __init__(self, hospital: Hospital) -> None:
        self._hospital = hospital
        self._spot = hospital.robot.position
        self._since = hospital.time
        self._detours = 0

    @property
    def waited(self) -> float:
        """Seconds since it last got on."""
        if math.dist(self._spot, self._hospital.robot.position) > 0.5:
            self.renew()
        return self._hospital.time - self._since

    def renew(self) -> None:
        self._spot, self._since = self._hospital.robot.position, self._hospital.time
        self._detours = 0

    def detour(self, goal: Spot) -> None:
        """Count one; raises `Blocked` where many lead nowhere."""
        self._detours = self._detours + 1 if self.waited else 1
        if self._detours > _MOST_DETOURS:
            raise Blocked(
                f"The robot does not get through to {self._hospital.name_of_spot(*goal)}: "
                "the way is blocked again and again. Try again when it is calmer."
            )


def _wait_for_person(
    hospital: Hospital, human: Human, patience: _Patience, goal: Spot
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
            if patience.waited > 3.0 and human.errand in (Errand.NONE, Errand.COME_ALONG):
                human.make_way(hospital)
        if patience.waited > _PATIENCE:
            place = hospital.name_of_spot(*human.position)
            raise Blocked(
                f"{human.name} is in the way at {place}, and there is no way around to "
                f"{hospital.name_of_spot(*goal)}. Ask them to step aside, then try again."
            )
        yield


def _no_way(hospital: Hospital, goal: Spot) -> str:
    name = hospital.name_of_spot(*goal)
    here = hospital.robot.position
    zones = set(_zones(hospital))
    for gates in (zones, ()):
        route = hospital.chart.route(here, goal, gates)
        shut = sorted(route.gates & hospital.known_closed.keys()) if route else []
        if shut:
            door = hospital.gate_name(shut[0])
            return (
                f"The way to {name} is blocked: {door} is closed. "
                "Have it opened, or choose another place."
            )
    return (
        f"There is no way for the robot from {hospital.name_of_spot(*here)} to {name}. "
        "Choose another place."
    )


# --- along a route -------------------------------------------------------------------------------


@dataclass(frozen=True)
class _ClosedDoor:
    gate: str


@dataclass(frozen=True)
class _Stuck:
    pass


_Trouble = Human | _ClosedDoor | _Stuck


def _track(
    hospital: Hospital,
    route: Route,
    around: Human | None,
    patience: _Patience,
    limit: Callable[[], float] | None,
) -> Behaviour[_Trouble | None]:
    """Drive along a route, which was planned around somebody; returns None at its end, or what is
    in the way."""
    robot, points = hospital.robot, route.points
    rest = _lengths_from_end(points)
    leg = 1
    allowed = TOP_SPEED
    pushed = 0  # steps without getting anywhere though the wheels turn
    looks = 0
    held_since = hospital.time
    while leg < len(points):
        check_battery(hospital)
        here = robot.position
        while leg < len(points) - 1 and _off(here, points[leg], points[leg + 1]) <= _off(
            here, points[leg - 1], points[leg]
        ):
            leg += 1
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
            elif hospital.time - held_since > (_HELD if _still(human) else _HELD_BY_WALKER):
                return human
            if human is not None and human is not around and _still(human) and allowed > 0.3:
                return human  # seen in time to go around without a stop
        looks += 1
        ahead = _point_ahead(points, leg, here, 0.3 + 0.2 * robot.speed)
        off = wrap(bearing(here, ahead) - robot.theta)
        speed = min(allowed, _braking(remaining))
        if limit is not None:
            speed = min(speed, limit())
        # Turn first when the way leads elsewhere; slow down in bends.
        speed *= 0.0 if abs(off) > 50 else max(0.15, math.cos(math.radians(off))) ** 2
        robot.aim(speed, max(-TOP_TURN, min(TOP_TURN, 3.5 * off)))
        yield
        if robot.speed > 0.1 and math.dist(here, robot.position) < 0.3 * robot.speed * STEP:
            pushed += 1
            if pushed > 120:
                yield from come_to_rest(hospital)
                return _nearest_in_touch(hospital) or _Stuck()
        else:
            pushed = 0
        if limit is not None and limit() < 0.05:
            patience.renew()  # it waits because it wants to
    return None


def _closed_door_ahead(hospital: Hospital, route: Route) -> _ClosedDoor | None:
    here = hospital.robot.position
    for gate in route.gates & hospital.closed_doors():
        x1, y1, x2, y2 = hospital.world.doors[int(gate.removeprefix("door "))].ends
        if math.dist(here, ((x1 + x2) / 2, (y1 + y2) / 2)) < _DOOR_IN_VIEW:
            hospital.known_closed[gate] = hospital.time
            return _ClosedDoor(gate)
    return None


def _people_ahead(
    hospital: Hospital, points: tuple[Spot, ...], leg: int
) -> tuple[float, Human | None]:
    """How fast people allow to drive, and who is in the way."""
    here = hospital.robot.position
    allowed, who = TOP_SPEED, None
    keep = hospital.robot.body.radius + PERSON_RADIUS + _KEEP
    for human in hospital.people:
        now = human.distance(here)
        if now > _LOOK_AHEAD:
            continue
        vx, vy = human.body.velocity
        x, y = human.position
        for spot in ((x, y), (x + 0.6 * vx, y + 0.6 * vy)):
            free = _free_until(here, points, leg, spot, min(keep, now - 0.03))
            if free < _LOOK_AHEAD and (speed := _braking(free - 0.05)) < allowed:
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


def _free_ahead(hospital: Hospital, heading: float) -> float:
    return hospital.physics.free_ahead(hospital.robot.body, heading, 1.5)


def _in_the_way(hospital: Hospital, heading: float, gone: float | None) -> str:
    """A sentence about what stops a straight drive."""
    x, y = hospital.robot.position
    beyond = (x + 0.5 * math.cos(heading), y + 0.5 * math.sin(heading))
    near = [human for human in hospital.people if human.distance(beyond) < 0.45]
    what = near[0].name if near else "A wall or furniture"
    after = f" after {max(0.0, gone):.1f} metres" if gone is not None else ""
    return f"{what} is in the way{after}. Turn first, or drive to a place instead."


# --- geometry ------------------------------------------------------------------------------------


def _braking(distance: float) -> float:
    """The speed from which one can stop within the distance."""
    return math.sqrt(1.6 * SLOW_DOWN * distance) if distance > 0 else 0.0


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
