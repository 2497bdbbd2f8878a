"""The worlds that come with the simulator: complete, and a robot gets everywhere in them."""

from __future__ import annotations

import math

import pytest
import shapely

from sim.world.builtin import builtin_worlds
from sim.world.loading import load_world
from sim.world.model import World

CELL = 0.1
ROBOT = 0.25
WORLDS = builtin_worlds()


@pytest.fixture(params=WORLDS)
def world(request: pytest.FixtureRequest) -> World:
    return load_world(request.param)


def obstacles(world: World) -> shapely.Geometry:
    walls = [shapely.LineString([wall[:2], wall[2:]]) for wall in world.walls]
    walls += [shapely.LineString([d.ends[:2], d.ends[2:]]) for d in world.doors if not d.open]
    solids = [shapely.Polygon(piece.outline) for piece in world.furniture if piece.outline]
    grown = shapely.union_all(walls).buffer(world.wall_thickness / 2)
    return shapely.union_all([grown, *solids])


def reachable(world: World) -> set[tuple[int, int]]:
    """The cells that a robot reaches from where it starts."""
    x1, y1, x2, y2 = world.bounds
    blocked = obstacles(world).buffer(ROBOT)
    shapely.prepare(blocked)
    columns, rows = math.ceil((x2 - x1) / CELL), math.ceil((y2 - y1) / CELL)
    points = [(x1 + i * CELL, y1 + j * CELL) for i in range(columns) for j in range(rows)]
    taken = shapely.contains_xy(blocked, points)
    free = {
        (round((x - x1) / CELL), round((y - y1) / CELL))
        for (x, y), is_taken in zip(points, taken, strict=True)
        if not is_taken
    }
    assert world.start is not None
    front = [cell(world, world.start.x, world.start.y)]
    seen = set(front)
    while front:
        i, j = front.pop()
        for there in ((i + 1, j), (i - 1, j), (i, j + 1), (i, j - 1)):
            if there in free and there not in seen:
                seen.add(there)
                front.append(there)
    return seen


def cell(world: World, x: float, y: float) -> tuple[int, int]:
    return round((x - world.bounds[0]) / CELL), round((y - world.bounds[1]) / CELL)


def test_the_robot_gets_to_every_place(world: World) -> None:
    cells = reachable(world)
    for place in world.places:
        assert place.pose is not None, place.name
        assert cell(world, place.pose.x, place.pose.y) in cells, f"{place.name} is cut off"


def test_the_robot_stays_in_the_building(world: World) -> None:
    x1, y1, x2, y2 = world.bounds
    for i, j in reachable(world):
        assert x1 < x1 + i * CELL < x2
        assert y1 < y1 + j * CELL < y2


def test_there_is_room_where_the_robot_stands(world: World) -> None:
    solid = obstacles(world)
    for place in world.places:
        assert place.pose is not None
        room = solid.distance(shapely.Point(place.pose.x, place.pose.y))
        assert room >= 0.45, f"{place.name} has only {room:.2f} m"


def test_every_pose_is_in_its_place(world: World) -> None:
    for place in world.places:
        assert place.pose is not None
        found = world.place_at(place.pose.x, place.pose.y)
        assert found is place, f"the pose of {place.name} is in {found and found.name}"


def test_people_and_furniture_are_where_they_are_said_to_be(world: World) -> None:
    for entry in (*world.people, *world.furniture):
        if entry.pose is not None:
            found = world.place_at(entry.pose.x, entry.pose.y)
            around = {found.name, found.inside} if found else set()
            assert entry.at in around, f"{entry.name}: {entry.at} or {around}"


def test_furniture_stands_apart_and_in_no_wall(world: World) -> None:
    walls = shapely.union_all([shapely.LineString([w[:2], w[2:]]) for w in world.walls])
    pieces = [(piece.name, shapely.Polygon(piece.outline)) for piece in world.furniture]
    for number, (name, shape) in enumerate(pieces):
        assert not shape.intersects(walls), f"{name} stands in a wall"
        for other, another in pieces[:number]:
            assert shape.intersection(another).area < 1e-3, f"{name} stands in {other}"


def test_doors_are_wide_enough(world: World) -> None:
    for door in world.doors:
        x1, y1, x2, y2 = door.ends
        assert math.hypot(x2 - x1, y2 - y1) >= 1.1


def test_bar_codes_are_valid_and_unique(world: World) -> None:
    codes = [thing.code for thing in world.objects if thing.code]
    assert len(codes) == len(set(codes)) == len(world.objects)
    for code in codes:
        digits = [int(digit) for digit in code]
        assert len(digits) == 13
        assert sum(d * (3 if i % 2 else 1) for i, d in enumerate(digits)) % 10 == 0, code


def test_every_place_has_a_name_in_three_languages(world: World) -> None:
    for place in world.places:
        assert {"en", "de", "fr"} <= set(place.aliases), place.name
    for question in world.questions:
        assert set(question.ask) == set(question.answer) == {"en", "de", "fr"}


def test_the_hospital_is_worth_a_visit() -> None:
    world = load_world("city-hospital")
    names = {place.name for place in world.places}
    assert {
        "pharmacy", "radiology", "lobby", "reception", "intensive care", "supply room", "kitchen",
        "lift", "charger", "alice's office", "bob's office", "ward a", "ward b", "ward c",
        "blood lab", "microbiology lab", "waiting room",
    } <= names  # fmt: skip
    assert len(names) >= 18
    assert len({person.kind for person in world.people}) >= 5
    assert len(world.people) >= 8
    postures = {word for person in world.people for word in person.is_}
    assert {"sitting", "standing", "lying", "walking", "waving"} <= postures
    assert all(person.answers for person in world.people)
    assert len(world.objects) >= 14
    assert len({thing.at for thing in world.objects if thing.name == "stapler"}) == 2
    assert any(thing.name == "cup" and "red" in thing.is_ for thing in world.objects)
    assert any(thing.name == "medication box" for thing in world.objects)
    assert len(world.questions) >= 10
    assert world.start == world.charger.pose if world.charger else False


@pytest.mark.parametrize(
    ("x", "y", "name"),
    [
        (-605, -1027, "pharmacy"),
        (-120, -490, "intensive care unit"),
        (157, -71, "outpatient pharmacy"),
    ],
)
def test_the_paper_s_coordinates_are_free_floor(x: float, y: float, name: str) -> None:
    world = load_world("lab-tour")
    assert world.units == "cm"
    place = world.place_at(x / 100, y / 100)
    assert place is not None
    assert place.name == name
    assert obstacles(world).distance(shapely.Point(x / 100, y / 100)) >= 0.5
    assert cell(world, x / 100, y / 100) in reachable(world)
