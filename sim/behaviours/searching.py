"""Looking for somebody or something, and waiting for somebody."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Collection, Iterator

from sim.behaviours.driving import lengths_to, travel, way_to
from sim.behaviours.wheel import check_battery, come_to_rest, face, wheel
from sim.errors import Blocked, NotPossible
from sim.hospital import Hospital
from sim.people.crowd import Errand, Human
from sim.people.likely import likeliness, remember
from sim.people.perception import Sight, fits, fitting, in_view, parse, spot_of
from sim.physics.bodies import STEP
from sim.physics.navigation import Spot
from sim.physics.placing import Item
from sim.physics.robot import bearing
from sim.runner import Behaviour
from sim.world.geometry import contains
from sim.world.model import Person, Place, World
from sim.world.words import words

_LOOK_EVERY = 15  # steps: four times a second
_NEXT_TO = 0.75
"""Metres from the middle of what the robot stands by, where there is room."""
_NEWCOMER_AFTER = (12.0, 25.0)
"""Seconds after which somebody comes where nobody new is, at least and at most."""
_MOST_CHASES = 20


def find(hospital: Hospital, thing: str, place: str | None) -> Behaviour[bool]:
    """Look here, then from place to place, the likeliest next (`sim.people.likely`), of such that
    are as likely the nearest; stand by what is found. What is not found is told of with the event
    "searched"."""
    target = hospital.place_named(place) if place is not None else None
    with wheel(hospital):
        if target is not None:
            x, y, theta = hospital.locate(target.name)
            if _place_here(hospital) != target.name:
                yield from travel(hospital, (x, y), theta)
            found = yield from _look_around(hospital, thing)
            if not found:
                _tell_searched(hospital, thing, [target.name])
            return found
        looked: dict[str, None] = {}
        closed: set[str] = set()
        while True:
            found = yield from _look_around(hospital, thing)
            if found:
                return True
            here = hospital.place
            if here is not None:
                looked[here.name] = None
            ahead = _next_place(hospital, thing, looked)
            if ahead is None:
                _tell_searched(hospital, thing, [name for name in looked if name not in closed])
                return False
            looked[ahead.name] = None
            pose = hospital.pose_of(ahead)
            assert pose is not None
            try:
                yield from _travel_looking(hospital, pose, thing)
            except (Blocked, NotPossible):
                closed.add(ahead.name)  # it is not found there, and was not looked for


def _place_here(hospital: Hospital) -> str | None:
    here = hospital.place
    return here.name if here else None


def _tell_searched(hospital: Hospital, thing: str, places: list[str]) -> None:
    hospital.emit("searched", {"thing": thing, "places": places})


def _next_place(hospital: Hospital, thing: str, looked: Collection[str]) -> Place | None:
    """The likeliest place of those where it has not looked, and of these the one with the shortest
    way; None if there is no way to any."""
    check_battery(hospital)
    places: list[Place] = []
    spots: list[Spot] = []
    for place in hospital.world.places:
        pose = hospital.pose_of(place)
        if place.name in looked or pose is None:
            continue
        room = hospital.world.place_at(pose[0], pose[1])
        if room is not None and room.name != place.name and room.name in looked:
            continue  # it lies in a room that it has seen
        places.append(place)
        spots.append((pose[0], pose[1]))
    lengths = lengths_to(hospital, spots)
    rank = likeliness(hospital, thing)
    ranked = [
        (rank(place), length, number)
        for number, (place, length) in enumerate(zip(places, lengths, strict=True))
        if not math.isinf(length)
    ]
    return places[min(ranked)[-1]] if ranked else None


def _travel_looking(
    hospital: Hospital, pose: tuple[float, float, float], thing: str
) -> Behaviour[None]:
    """Drive to a place; done at once when one is in view on the way."""
    way = travel(hospital, (pose[0], pose[1]), pose[2])
    sought = [sight for sight in fitting(hospital, thing) if _is_free(sight)]
    steps = 0
    with contextlib.closing(way):
        for _ in way:
            steps += 1
            if steps % _LOOK_EVERY == 0 and any(hospital.here(*spot_of(one)) for one in sought):
                yield from come_to_rest(hospital)
                return
            yield


def _look_around(hospital: Hospital, thing: str) -> Behaviour[bool]:
    """Whether one is here; goes and stands by it."""
    sights = [sight for sight in in_view(hospital, thing) if _is_free(sight)]
    remember(hospital, thing, sights)
    for sight in sights:
        reached = yield from approach(hospital, sight)
        if reached:
            if isinstance(sight, Human):
                hospital.partner = sight.name
            return True
    # What cannot be reached is found all the same.
    if sights:
        yield from face(hospital, bearing(hospital.robot.position, spot_of(sights[0])))
    return bool(sights)


def _is_free(sight: Sight) -> bool:
    """Whether it is no thing that somebody holds: what was handed over is not looked for again."""
    return not isinstance(sight, Item) or sight.holder is None


def approach(hospital: Hospital, sight: Sight, reach: float = _NEXT_TO) -> Behaviour[bool]:
    """Drive next to it and face it; goes after somebody who walks. Returns whether it is there."""
    for _ in range(_MOST_CHASES):
        goal = spot_of(sight)
        if isinstance(sight, Human):
            sight.attend(hospital)
        spot = _spot_by(hospital, goal, reach)
        if spot is None:
            return False
        if math.dist(spot, hospital.robot.position) > 0.1:
            try:
                yield from travel(hospital, spot)
            except (Blocked, NotPossible):
                return False
        if math.dist(spot_of(sight), goal) < 0.5:
            yield from face(hospital, bearing(hospital.robot.position, spot_of(sight)))
            return True
    return False


def _spot_by(hospital: Hospital, goal: Spot, reach: float) -> Spot | None:
    """Where to stand by something: as near as there is room, on the robot's side, in its room."""
    here, chart = hospital.robot.position, hospital.chart
    if math.dist(here, goal) <= reach + 0.05 and hospital.physics.sees(here, goal):
        return here
    towards = math.radians(bearing(goal, here))
    for further in (0.0, 0.15, 0.3, 0.5, 0.7, 0.9):
        for side in (0, 20, -20, 45, -45, 70, -70, 100, -100, 135, -135, 180):
            angle = towards + math.radians(side)
            x = goal[0] + (reach + further) * math.cos(angle)
            y = goal[1] + (reach + further) * math.sin(angle)
            if (
                chart.distance(x, y) >= chart.clearance
                and hospital.physics.sees((x, y), goal)
                and all(human.distance((x, y)) > 0.6 for human in hospital.people)
                and way_to(hospital, (x, y)) is not None
            ):
                return x, y
    return None


# --- waiting -------------------------------------------------------------------------------------


def wait_for(hospital: Hospital, thing: str, timeout: float | None) -> Behaviour[bool]:
    """Until one is here that was not met here before. In a lobby somebody new comes in after a
    while; elsewhere somebody of the house whom the phrase fits comes by."""
    begin = hospital.time
    comes_after = hospital.random.uniform(*_NEWCOMER_AFTER)
    steps = 0
    while True:
        if steps % _LOOK_EVERY == 0:
            place = _place_here(hospital)
            met = hospital.met.setdefault(place, set())
            for sight in in_view(hospital, thing):
                name = _identity(sight)
                if name in met or (isinstance(sight, Human) and sight.comes):
                    continue
                met.add(name)
                if isinstance(sight, Human):
                    hospital.partner = sight.name
                    sight.attend(hospital)
                return True
            if hospital.time - begin >= comes_after:
                comes_after += hospital.random.uniform(*_NEWCOMER_AFTER)
                _let_somebody_come(hospital, thing, met)
        if timeout is not None and hospital.time - begin >= timeout - STEP / 2:
            return False
        steps += 1
        yield


def _identity(sight: Sight) -> str:
    return f"thing {sight.number}" if isinstance(sight, Item) else sight.name


def _let_somebody_come(hospital: Hospital, thing: str, met: set[str]) -> None:
    if any(human.comes for human in hospital.people):
        return
    robot = hospital.robot.position
    spot = hospital.free_spot(*robot, 1.0, 2.5)
    if spot is None:
        return
    newcomer = _newcomer(hospital, thing)
    if _is_public(hospital.world, robot) and newcomer is not None:
        door = _way_in(hospital, spot)
        human = hospital.add_person(newcomer, *door, bearing(door, spot), "standing")
        hospital.newcomers += 1
    else:
        free = [
            sight
            for sight in fitting(hospital, thing)
            if isinstance(sight, Human)
            and sight.name not in met
            and sight.posture != "lying"
            and sight.errand in (Errand.NONE, Errand.WALK)
        ]
        if not free:
            return
        human = min(free, key=lambda sight: (sight.posture == "sitting", sight.distance(robot)))
    human.comes = human.walk_to(hospital, spot)


def _is_public(world: World, spot: Spot) -> bool:
    """Whether people from outside may come there: a charger in the lobby is in the lobby."""
    here = [place for place in world.places if place.area and contains(place.area, *spot)]
    if not here and (near := world.place_at(*spot)) is not None:
        here = [near]
    return any(place.kind in words().public for place in here)


def _newcomer(hospital: Hospital, thing: str) -> Person | None:
    """Somebody from outside whom the phrase fits; None if it is about something else."""
    known = {human.person.kind for human in hospital.people} | {"visitor", "patient"}
    taken = {human.name for human in hospital.people}
    genders = ("female", "male") if hospital.random.random() < 0.5 else ("male", "female")
    kinds = ["visitor", *sorted(known - {"visitor"})]
    number = hospital.newcomers + 1
    while any(name.endswith(f" {number}") for name in taken):
        number += 1
    phrase = parse(thing)
    for kind in kinds:
        for gender in genders:
            person = Person(name=f"{kind} {number}", kind=kind, gender=gender)
            candidate = Human(-1, person, hospital.robot.body, 0.0, "standing")
            if fits(hospital, candidate, phrase):
                return person
    return None


def _way_in(hospital: Hospital, spot: Spot) -> Spot:
    """Where somebody new comes in: at the door of the house, else at the nearest other place,
    public ones first."""
    chart, closed = hospital.chart, hospital.closed_doors()
    doors = [inside for inside in _front_doors(hospital) if chart.route(inside, spot, closed)]
    if doors:
        return min(doors, key=lambda inside: math.dist(inside, spot))
    ways = []
    for place in hospital.world.places:
        pose = hospital.pose_of(place)
        if pose is None or place.name == _place_here(hospital):
            continue
        inside = hospital.free_spot(pose[0], pose[1], 0.0, 1.5)
        way = chart.route(inside, spot, closed) if inside else None
        if inside and way is not None:
            ways.append((place.kind not in words().public, way.length, inside))
    return min(ways)[2] if ways else spot


def _front_doors(hospital: Hospital) -> Iterator[Spot]:
    """The spots inside of the doors that lead out of the building."""
    least_x, least_y, most_x, most_y = hospital.world.bounds
    for door in hospital.world.doors:
        x1, y1, x2, y2 = door.ends
        width = math.hypot(x2 - x1, y2 - y1)
        if width == 0:
            continue
        for side in (0.7 / width, -0.7 / width):
            dx, dy = side * (y1 - y2), side * (x2 - x1)
            x, y = (x1 + x2) / 2 + dx, (y1 + y2) / 2 + dy
            out_x, out_y = x - 2 * dx, y - 2 * dy
            outside = not (least_x <= out_x <= most_x and least_y <= out_y <= most_y)
            if outside and hospital.chart.fits(x, y):
                yield x, y
