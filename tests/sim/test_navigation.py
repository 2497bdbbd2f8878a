"""Routes keep clear of what stands on the floor, and tell when there is none."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.hospital import chart_of
from sim.physics.navigation import Chart, Disc
from sim.world.loading import load_world
from sim.world.model import World

ROOM = [(0.0, 0.0, 10.0, 0.0), (10.0, 0.0, 10.0, 6.0), (10.0, 6.0, 0.0, 6.0), (0.0, 6.0, 0.0, 0.0)]
TWO_ROOMS = [*ROOM, (5.0, 0.0, 5.0, 2.0), (5.0, 3.0, 5.0, 6.0)]
DOOR = {"door": (5.0, 2.0, 5.0, 3.0)}


def test_the_straight_way_is_taken_where_it_is_free() -> None:
    route = Chart(ROOM).route((1, 1), (9, 5))
    assert route is not None
    assert route.points == ((1, 1), (9, 5))
    assert route.length == pytest.approx(math.dist((1, 1), (9, 5)))


def test_the_way_leads_around_a_bed_with_clearance() -> None:
    bed = [(4.0, 1.0), (6.0, 1.0), (6.0, 5.0), (4.0, 5.0)]
    chart = Chart(ROOM, [bed], radius=0.25, margin=0.1)
    route = chart.route((1, 3), (9, 3))
    assert route is not None
    assert route.length > 8.5
    for (x1, y1), (x2, y2) in zip(route.points, route.points[1:], strict=False):
        for i in range(21):
            x, y = x1 + (x2 - x1) * i / 20, y1 + (y2 - y1) * i / 20
            assert chart.distance(x, y) >= 0.35 - 0.002


def test_a_route_says_which_doors_it_passes_and_takes_none_that_is_closed() -> None:
    chart = Chart(TWO_ROOMS, gates=DOOR)
    route = chart.route((1, 1), (9, 5))
    assert route is not None
    assert route.gates == {"door"}
    assert chart.route((1, 1), (9, 5), closed={"door"}) is None
    assert chart.route((1, 1), (4, 5), closed={"door"}) is not None


def test_a_passage_too_narrow_for_the_robot_is_none() -> None:
    narrow = [*ROOM, (5.0, 0.0, 5.0, 2.0), (5.0, 2.4, 5.0, 6.0)]
    assert Chart(narrow, radius=0.25).route((1, 1), (9, 5)) is None


def test_people_are_passed_at_a_distance() -> None:
    alice = Disc(5, 3, 0.7)
    route = Chart(ROOM).route((1, 3), (9, 3), people=[alice])
    assert route is not None
    for (x1, y1), (x2, y2) in zip(route.points, route.points[1:], strict=False):
        for i in range(41):
            spot = (x1 + (x2 - x1) * i / 40, y1 + (y2 - y1) * i / 40)
            assert math.dist(spot, (5, 3)) >= 0.7 - 1e-6


def test_somebody_in_a_doorway_closes_it() -> None:
    assert Chart(TWO_ROOMS).route((1, 2.5), (9, 2.5), people=[Disc(5, 2.5, 0.6)]) is None


def test_a_zone_is_driven_around_only_when_the_query_closes_it() -> None:
    chart = Chart(ROOM, zones={"wet floor": [(4, 1), (6, 1), (6, 5), (4, 5)]})
    through = chart.route((1, 3), (9, 3))
    around = chart.route((1, 3), (9, 3), closed={"wet floor"})
    assert through is not None and around is not None
    assert through.length == pytest.approx(8.0)
    assert around.length > 8.5
    assert chart.to_zone("wet floor", 5, 3) == 0
    assert chart.to_zone("wet floor", 1, 3) == pytest.approx(3)


def test_a_start_close_to_the_wall_is_left_straight_away_from_it() -> None:
    route = Chart(ROOM).route((0.28, 3), (5, 3))
    assert route is not None
    assert route.points[0] == (0.28, 3)
    assert route.length == pytest.approx(4.72, abs=0.01)


def test_the_nearest_free_spot_is_on_this_side_of_the_wall() -> None:
    spot = Chart(TWO_ROOMS).nearest_free(4.9, 5.0)
    assert spot == pytest.approx((4.65, 5.0), abs=0.01)


def test_lengths_to_many_goals_are_those_of_the_routes(hospital: World) -> None:
    chart = chart_of(hospital)
    start = (20.5, 4.2)
    goals = [(p.pose.x, p.pose.y) for p in hospital.places if p.pose is not None]
    routes = [chart.route(start, goal) for goal in goals]
    lengths = chart.lengths(start, [*goals, (100.0, 100.0)])
    assert math.isinf(lengths[-1])
    for route, goal, length in zip(routes, goals, lengths, strict=False):
        assert route is not None
        off = math.dist(goal, chart.nearest_free(*goal) or goal)
        assert length == pytest.approx(route.length - off, abs=0.01)


HOSPITAL = chart_of(load_world("city-hospital"))


@settings(max_examples=60, deadline=None)
@given(
    *(st.tuples(st.floats(0.3, 39.7), st.floats(0.3, 24.7)) for _ in range(2)),
    st.sets(st.sampled_from([f"door {i}" for i in range(20)]), max_size=4),
)
def test_no_route_comes_near_a_wall_or_through_a_closed_door(
    start: tuple[float, float], goal: tuple[float, float], closed: set[str]
) -> None:
    if not (HOSPITAL.fits(*start) and HOSPITAL.fits(*goal)):
        return
    route = HOSPITAL.route(start, goal, closed)
    if route is None:
        return
    assert not route.gates & closed
    assert route.points[0] == start and route.points[-1] == goal
    for (x1, y1), (x2, y2) in zip(route.points, route.points[1:], strict=False):
        for i in range(11):
            x, y = x1 + (x2 - x1) * i / 10, y1 + (y2 - y1) * i / 10
            assert HOSPITAL.distance(x, y) >= HOSPITAL.radius - 0.002
