"""The robot keeps out of zones, however it is driven; from within one it may leave."""

from __future__ import annotations

import contextlib
import itertools
import math
import threading

import msgspec
import pytest
import shapely
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from sim.errors import Blocked, NotPossible
from sim.hospital import chart_of
from sim.pictures.scene import hatching
from sim.world.loading import load_world
from sim.world.model import World, WorldError, Zone
from sim.world.zones import MOST_CORNERS, trouble_with

HALL = """\
name: hall
robot: {start: west}
walls: [[0, 0, 12, 0, 12, 8, 0, 8, 0, 0]]
places:
  - {name: west, pose: [1, 4, 0]}
  - {name: middle, pose: [6, 4, 0]}
  - {name: east, pose: [11, 4, 180]}
"""
BLOCK = Zone("wet floor", ((4, 1.5), (8, 1.5), (8, 6.5), (4, 6.5)))


def nearest(ward, *zones: Zone) -> float:
    """How near the robot's middle came to the zones in all it did; 0 is in one."""
    areas = [shapely.Polygon(zone.polygon) for zone in zones]
    samples = ward.simulation.record.samples
    return min(area.distance(shapely.Point(s.x, s.y)) for area in areas for s in samples)


@pytest.fixture
def hall(world_of, living):
    ward = living(world_of(HALL))
    ward.simulation.set_zones([BLOCK])
    return ward


def test_it_drives_around_a_zone_that_was_drawn(hall) -> None:
    hall.goes_to("east")
    assert hall.simulation.robot.place == "east"
    assert nearest(hall, BLOCK) >= 0.25
    assert hall.simulation.world.zone_at(6, 4) == BLOCK
    assert hall.simulation.world.zone_at(1, 4) is None


def test_a_goal_in_a_zone_is_refused_at_once_with_its_name(hall) -> None:
    with pytest.raises(NotPossible, match=r'middle lies in the keep-out zone "wet floor"'):
        hall.goes_to("middle")
    assert hall.simulation.time == 0


def test_where_the_only_way_leads_through_a_zone_it_says_so(hall) -> None:
    hall.simulation.set_zones([Zone("wet floor", ((4, -1), (8, -1), (8, 9), (4, 9)))])
    with pytest.raises(Blocked, match=r'leads through the keep-out zone "wet floor"'):
        hall.goes_to("east")


@pytest.mark.parametrize("drives", [lambda s: s.move(8), lambda s: s.drive(0.9, 0, 30)])
def test_straight_ahead_it_stops_at_the_border(hall, drives) -> None:
    with pytest.raises(Blocked, match=r'The keep-out zone "wet floor" is in the way'):
        hall.does(drives(hall.simulation))
    assert hall.simulation.robot.x == pytest.approx(4 - 0.25 - 0.02, abs=0.03)
    assert nearest(hall, BLOCK) >= 0.25
    hall.does(hall.simulation.move(-1))


def test_a_wall_before_a_zone_is_still_a_wall(hall) -> None:
    hall.does(hall.simulation.turn(180))
    with pytest.raises(Blocked, match="A wall or furniture"):
        hall.does(hall.simulation.move(3))


def test_from_within_it_leaves_by_the_shortest_way_and_cannot_return(hall) -> None:
    hall.simulation.localize(4.8, 4, 0)
    hall.simulation.new_record()
    hall.goes_to("east")
    area = shapely.Polygon(BLOCK.polygon)
    inside = [area.covers(shapely.Point(s.x, s.y)) for s in hall.simulation.record.samples]
    assert inside[0] and not inside[-1]
    assert sum(a != b for a, b in itertools.pairwise(inside)) == 1
    assert min(s.x for s in hall.simulation.record.samples) < 3.8  # back out, where it is near
    with pytest.raises(NotPossible):
        hall.goes_to("middle")


def test_half_in_a_zone_it_comes_no_deeper(hall) -> None:
    hall.simulation.localize(3.85, 4, 0)
    with pytest.raises(Blocked, match="wet floor"):
        hall.does(hall.simulation.move(1))
    hall.goes_to("east")
    assert nearest(hall, BLOCK) >= 0.145


def test_a_zone_drawn_on_its_way_is_driven_around(hall) -> None:
    hall.simulation.set_zones([])
    drawn = []

    def draw(kind, data) -> None:
        if kind == "pose" and data["x"] > 2 and not drawn:
            drawn.append(data)
            hall.simulation.set_zones([BLOCK])

    hall.simulation.subscribe(draw)
    hall.goes_to("east")
    assert drawn and hall.simulation.robot.place == "east"
    assert nearest(hall, BLOCK) >= 0.25


def test_a_copy_keeps_out_of_the_same_zones(hall, living) -> None:
    twin = hall.simulation.copy()
    hall.simulation.set_zones([])
    with pytest.raises(NotPossible, match="wet floor"):
        twin.run(twin.drive_to(6, 4), threading.Event())


def test_people_walk_through_zones(world_of, living) -> None:
    ward = living(world_of(HALL + "people:\n  - {name: Ann, at: west, walks: [west, east]}\n"))
    ward.simulation.set_zones([BLOCK])
    ward.does(ward.simulation.wait(120))
    assert any(
        4.5 < x < 7.5 and 2 < y < 6 for s in ward.simulation.record.samples for x, y in s.people
    )


# --- whatever is asked ---------------------------------------------------------------------------

SMALL = load_world("ward")
FLOOR = chart_of(SMALL)
spots = st.tuples(st.floats(0.3, 11.7), st.floats(0.3, 7.7)).filter(lambda spot: FLOOR.fits(*spot))


@st.composite
def zones(draw: st.DrawFn) -> Zone:
    """A star about a spot: every outline that goes once around it."""
    x, y = draw(st.tuples(st.floats(0.5, 11.5), st.floats(0.5, 7.5)))
    count = draw(st.integers(3, 8))
    turn = draw(st.floats(0, 360))
    corners = []
    for number in range(count):
        angle = math.radians(turn + 360 * number / count)
        reach = draw(st.floats(0.3, 2))
        corners.append((x + reach * math.cos(angle), y + reach * math.sin(angle)))
    return Zone("zone", tuple(corners))


errands = st.lists(
    st.one_of(
        st.tuples(st.just("drive_to"), spots),
        st.tuples(st.just("move"), st.tuples(st.floats(-4, 4))),
        st.tuples(st.just("turn"), st.tuples(st.floats(-180, 180))),
        st.tuples(
            st.just("drive"),
            st.tuples(st.floats(-0.9, 0.9), st.floats(-110, 110), st.floats(0.1, 5)),
        ),
    ),
    min_size=1,
    max_size=5,
)


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(drawn=st.lists(zones(), min_size=1, max_size=3), start=spots, errands=errands)
def test_whatever_is_asked_it_is_never_in_a_zone(living, drawn, start, errands) -> None:
    assert all(trouble_with(zone.polygon) is None for zone in drawn)
    ward = living(SMALL)
    areas = [shapely.Polygon(zone.polygon) for zone in drawn]
    ward.simulation.localize(*start, 0)
    room = [area.distance(shapely.Point(start)) for area in areas]
    ward.simulation.set_zones(Zone(f"{number}", zone.polygon) for number, zone in enumerate(drawn))
    ward.simulation.new_record()
    for method, arguments in errands:
        with contextlib.suppress(Blocked, NotPossible):
            ward.does(getattr(ward.simulation, method)(*arguments))
    for area, at_first in zip(areas, room, strict=True):
        if at_first > 0:  # a robot that is partly in a zone already comes no deeper
            least = min(0.25, at_first) - 0.005
            assert all(
                area.distance(shapely.Point(s.x, s.y)) >= least
                for s in ward.simulation.record.samples
            )


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(zone=zones(), start=spots, goal=spots)
def test_a_robot_in_a_zone_can_always_leave(living, zone, start, goal) -> None:
    assume(FLOOR.route(start, goal) is not None)
    area = shapely.Polygon(zone.polygon)
    ward = living(msgspec.structs.replace(SMALL, people=()))
    ward.simulation.localize(*start, 0)
    ward.simulation.set_zones([zone])
    free = area.distance(shapely.Point(goal)) > 0.36 and FLOOR.distance(*goal) > 0.36
    try:
        ward.does(ward.simulation.drive_to(*goal))
    except Blocked as error:
        assert "leads through the keep-out zone" in str(error)
    except NotPossible as error:
        assert "lies in the keep-out zone" in str(error)
        assert not free
    else:
        robot = ward.simulation.robot
        assert math.dist((robot.x, robot.y), goal) < 0.1


# --- in a file -----------------------------------------------------------------------------------


def test_a_world_may_have_zones(world_of) -> None:
    world: World = world_of(
        HALL
        + "zones:\n  - {name: store, polygon: [[4, 1], [6, 1], [6, 3]]}\nkeep_out: [[8, 1, 9, 2]]\n"
    )
    assert world.zones == (
        Zone("store", ((4, 1), (6, 1), (6, 3))),
        Zone("area 1", ((8, 1), (9, 1), (9, 2), (8, 2))),
    )


@pytest.mark.parametrize(
    ("zone", "told"),
    [
        ("{polygon: [[0, 0], [1, 0], [1, 1]]}", "A zone has no name"),
        ("{name: store}", 'The zone "store" has no "polygon"'),
        ("{name: store, polygon: [[0, 0], [2, 2], [2, 0], [0, 2.1]]}", "crosses itself"),
        ("{name: store, polygon: [[0, 0], [0.1, 0], [0.1, 0.1]]}", "smaller than 0.04"),
        ("{name: store, polygon: [[0, 0], [1, 0]]}", "at least three corners"),
        ("{name: store, polygon: [[0, 0], [.inf, 0], [1, 1]]}", "A corner of|x is|number"),
        ("{name: store, polygon: [0, 0, 1, 1], height: 2}", 'no field "height"'),
    ],
)
def test_what_is_wrong_with_a_zone_is_told_with_its_line(world_of, zone, told) -> None:
    with pytest.raises(WorldError, match=told) as error:
        world_of(HALL + f"zones:\n  - {zone}\n")
    assert [problem.line for problem in error.value.problems] == [9]


def test_two_zones_of_one_name_are_one_too_many(world_of) -> None:
    polygon = "polygon: [0, 0, 1, 1]"
    with pytest.raises(WorldError, match=':10: The zone "Store" is on line 9 already'):
        world_of(HALL + f"zones:\n  - {{name: store, {polygon}}}\n  - {{name: Store, {polygon}}}\n")


@pytest.mark.parametrize(
    ("outline", "told"),
    [
        ([(0, 0), (1, 0)], "fewer than three"),
        ([(0, 0), (1, 0), (math.nan, 1)], "no point"),
        ([(0, 0), (math.inf, 0), (1, 1)], "no point"),
        ([(0, 0), (2000, 0), (1, 1)], "farther than 1000 metres"),
        ([(0, 0), (2, 0), (1, 0)], "crosses itself"),
        ([(0, 0), (2, 0), (2, 2), (1, 0), (0, 2)], "crosses itself"),
        ([(0, 0), (0.1, 0), (0, 0.1)], "smaller"),
        ([(math.cos(i), math.sin(i)) for i in range(MOST_CORNERS + 1)], "more than 100"),
    ],
)
def test_an_outline_that_encloses_nothing_is_refused(outline, told) -> None:
    assert told in str(trouble_with(tuple(outline)))


corners = st.tuples(st.integers(-4, 4), st.integers(-4, 4))


@given(st.lists(corners, min_size=3, max_size=7))
def test_it_agrees_with_shapely_on_what_crosses_itself(outline) -> None:
    trouble = trouble_with(tuple((float(x), float(y)) for x, y in outline))
    area = shapely.Polygon(outline)
    assert (trouble is None) == (area.is_valid and area.area > 0)


@given(zones())
def test_the_hatching_of_a_zone_is_within_it(zone) -> None:
    area = shapely.Polygon(zone.polygon).buffer(1e-6)
    lines = hatching(zone.polygon, 0.1)
    assert lines and all(area.covers(shapely.LineString(line)) for line in lines)
