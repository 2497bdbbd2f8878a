"""The robot drives where it is sent, smoothly and without touching anything, or says why not."""

from __future__ import annotations

import itertools
import math

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sim.errors import Blocked, NotPossible, UnknownPlace
from sim.hospital import chart_of
from sim.physics.robot import Pace
from sim.world.loading import load_world


@pytest.mark.parametrize("seed", [1, 2])
def test_from_the_charger_to_the_pharmacy_and_never_near_a_wall(hospital, living, seed) -> None:
    ward = living(hospital, seed)
    ward.goes_to("pharmacy")
    robot, chart = ward.simulation.robot, chart_of(hospital)
    assert robot.place == "pharmacy"
    x, y, theta = ward.simulation.locate("pharmacy")
    assert math.dist((robot.x, robot.y), (x, y)) < 0.05
    assert robot.theta == pytest.approx(theta, abs=1)
    assert robot.speed == 0
    samples = ward.simulation.record.samples
    assert min(chart.distance(s.x, s.y) for s in samples) >= hospital.robot.radius
    # 25 metres at less than a metre a second, and not much slower.
    assert 20 < ward.simulation.time < 45


def test_it_speeds_up_and_slows_down_smoothly(hospital, living) -> None:
    ward = living(hospital)
    speeds = []
    ward.simulation.subscribe(lambda kind, data: kind == "pose" and speeds.append(data["speed"]))
    ward.goes_to("lobby")
    assert max(speeds) <= Pace().speed
    assert all(abs(b - a) < 0.2 for a, b in itertools.pairwise(speeds))


def test_it_drives_no_faster_than_it_may(hospital, living) -> None:
    ward = living(hospital)
    ward.simulation.limit_pace(speed=0.3, acceleration=0.2)
    ward.simulation.limit_pace(speed=0.5, turn_rate=45)  # what is slower stays
    speeds = []
    ward.simulation.subscribe(lambda kind, data: kind == "pose" and speeds.append(data["speed"]))
    ward.goes_to("lobby")
    assert 0.29 < max(speeds) <= 0.3
    assert max(b - a for a, b in itertools.pairwise(speeds)) <= 0.2 * 0.1 + 1e-6
    before = ward.simulation.time
    ward.does(ward.simulation.turn(-90))
    assert ward.simulation.time - before > 2


def test_a_goal_in_a_bed_is_refused_at_once(small_ward, living) -> None:
    ward = living(small_ward)
    with pytest.raises(NotPossible, match=r"cannot stand .*ward a.*furniture"):
        ward.does(ward.simulation.drive_to(1.2, 6.8))
    assert ward.simulation.time == 0


def test_a_place_nobody_named_is_unknown(small_ward, living) -> None:
    with pytest.raises(UnknownPlace, match="swimming pool"):
        living(small_ward).simulation.locate("swimming pool")


def test_an_alias_in_another_language_is_the_same_place(hospital, living) -> None:
    simulation = living(hospital).simulation
    assert simulation.locate("Apotheke") == simulation.locate("pharmacy")


def test_a_goal_that_somebody_stands_on_is_reached_as_near_as_possible(corridor, living) -> None:
    ward = living(corridor("people: [{name: Tom, pose: [8, 1.25, 180]}]"))
    ward.does(ward.simulation.drive_to(8, 1.25))
    robot = ward.simulation.robot
    assert 0.5 < math.dist((robot.x, robot.y), (8, 1.25)) < 0.8


def test_turn_left_is_positive_and_turns_may_be_more_than_one(small_ward, living) -> None:
    ward = living(small_ward)
    ward.does(ward.simulation.turn(90))
    assert ward.simulation.robot.theta == pytest.approx(90, abs=0.5)
    before = ward.simulation.time
    ward.does(ward.simulation.turn(-450))
    assert ward.simulation.robot.theta == pytest.approx(0, abs=1)
    assert ward.simulation.time - before > 4


def test_move_drives_straight_there_and_back(small_ward, living) -> None:
    ward = living(small_ward)
    ward.does(ward.simulation.move(1.5))
    assert ward.simulation.robot.x == pytest.approx(2.5, abs=0.02)
    ward.does(ward.simulation.move(-1.0))
    assert ward.simulation.robot.x == pytest.approx(1.5, abs=0.02)
    assert ward.simulation.robot.y == pytest.approx(1.5, abs=0.001)


def test_move_stops_at_the_wall_and_says_how_far_it_came(small_ward, living) -> None:
    ward = living(small_ward)
    ward.does(ward.simulation.turn(180))
    with pytest.raises(Blocked, match=r"wall or furniture .*0\.\d metres"):
        ward.does(ward.simulation.move(3))
    # The wall is 0.1 thick and the robot 0.25 round.
    assert 0.3 <= ward.simulation.robot.x < 0.36
    assert ward.simulation.robot.speed == 0


def test_the_joystick_cannot_push_the_robot_through_a_wall(small_ward, living) -> None:
    ward = living(small_ward)
    with pytest.raises(Blocked):
        ward.does(ward.simulation.drive(-0.8, 0, 10))
    assert ward.simulation.robot.x >= 0.3


def test_the_joystick_drives_curves(small_ward, living) -> None:
    ward = living(small_ward)
    ward.does(ward.simulation.drive(0.4, 30, 2.0))
    robot = ward.simulation.robot
    assert robot.x > 1.5 and robot.y > 1.6
    assert 45 < robot.theta < 75


def test_the_wheel_is_free_again_after_a_failure(small_ward, living) -> None:
    ward = living(small_ward)
    ward.does(ward.simulation.turn(180))
    with pytest.raises(Blocked):
        ward.does(ward.simulation.move(5))
    ward.goes_to("ward b")
    assert ward.simulation.robot.place == "ward b"


def test_two_behaviours_cannot_have_the_wheel_at_once(small_ward, living) -> None:
    ward = living(small_ward)
    first = ward.simulation.drive_to(*ward.simulation.locate("ward b"))
    next(first)
    with pytest.raises(NotPossible, match="already driving"):
        ward.does(ward.simulation.turn(90))
    first.close()
    ward.does(ward.simulation.turn(90))


def test_the_battery_drains_on_the_way_and_charges_at_the_station(hospital, living) -> None:
    ward = living(hospital)
    ward.goes_to("pharmacy")
    low = ward.simulation.robot.battery
    assert low < 90
    ward.does(ward.simulation.dock())
    docked = ward.simulation.robot
    assert docked.place == "charger" and docked.charging
    ward.does(ward.simulation.wait(60))
    assert ward.simulation.robot.battery > docked.battery + 0.5


def test_with_an_empty_battery_it_stops_where_it_is(world_of, living) -> None:
    world = world_of(
        """\
        name: corridor
        robot: {start: west end, battery: 0.05}
        walls: [[0, 0, 40, 0, 40, 2.5, 0, 2.5, 0, 0]]
        places:
          - {name: west end, pose: [1, 1.25, 0]}
          - {name: east end, pose: [39, 1.25, 0]}
        """
    )
    ward = living(world)
    with pytest.raises(NotPossible, match="battery is empty"):
        ward.goes_to("east end")
    stranded = ward.simulation.robot
    assert 2 < stranded.x < 38 and stranded.speed == 0 and stranded.battery == 0
    with pytest.raises(NotPossible, match="battery is empty"):
        ward.does(ward.simulation.move(1))
    assert ward.simulation.robot.x == stranded.x


def test_without_a_charger_there_is_nowhere_to_dock(corridor, living) -> None:
    ward = living(corridor(""))
    with pytest.raises(NotPossible, match="no charging station"):
        ward.does(ward.simulation.dock())


def test_it_keeps_out_of_where_it_must_not_go_and_leaves_when_inside(world_of, living) -> None:
    world = world_of(
        """\
        name: hall
        robot: {start: west}
        walls: [[0, 0, 12, 0, 12, 8, 0, 8, 0, 0]]
        keep_out: [[[4, 0], [8, 0], [8, 6], [4, 6]]]
        places:
          - {name: west, pose: [1, 2, 0]}
          - {name: east, pose: [11, 2, 0]}
        """
    )
    ward = living(world)
    ward.goes_to("east")
    assert not any(4 < s.x < 8 and s.y < 6 for s in ward.simulation.record.samples)
    with pytest.raises(NotPossible, match="keep-out zone"):
        ward.does(ward.simulation.drive_to(6, 3))
    ward.simulation.localize(6, 3, 0)
    ward.goes_to("west")
    assert ward.simulation.robot.x == pytest.approx(1, abs=0.05)


def test_localize_sets_it_down_but_not_in_a_wall(small_ward, living) -> None:
    simulation = living(small_ward).simulation
    simulation.localize(9, 5, 90)
    assert (simulation.robot.place, simulation.robot.theta) == ("ward b", 90)
    with pytest.raises(NotPossible, match="no room"):
        simulation.localize(6, 5, 0)


def test_the_lidar_measures_the_room(small_ward, living) -> None:
    ranges = living(small_ward).simulation.lidar()
    assert len(ranges) == 36
    # From the charger at 1, 1.5: ahead more than eight metres, walls 1.5 to the sides, 1 behind,
    # all less half their thickness.
    assert ranges[0] == pytest.approx(8)
    assert ranges[9] == pytest.approx(1.45, abs=0.01)
    assert ranges[18] == pytest.approx(0.95, abs=0.01)
    assert ranges[27] == pytest.approx(1.45, abs=0.01)


SMALL = load_world("ward")
FLOOR = chart_of(SMALL)
FREE = st.tuples(st.floats(0.3, 11.7), st.floats(0.3, 7.7)).filter(lambda spot: FLOOR.fits(*spot))


@settings(
    max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(start=FREE, goal=FREE)
def test_wherever_it_is_sent_it_is_never_in_a_wall(living, start, goal) -> None:
    ward = living(SMALL)
    ward.simulation.localize(*start, 0)
    try:
        ward.does(ward.simulation.drive_to(*goal))
    except (Blocked, NotPossible) as no:
        assert len(str(no)) > 20
    else:
        robot = ward.simulation.robot
        near = [p.body for p in ward.simulation._hospital.people if p.distance(goal) < 0.6]
        assert near or math.dist((robot.x, robot.y), goal) < 0.06
    # A centimetre is what the contact of two bodies may give way.
    for sample in ward.simulation.record.samples:
        assert FLOOR.distance(sample.x, sample.y) >= SMALL.robot.radius - 0.01


def test_a_newer_movement_of_the_joystick_takes_over(small_ward, living) -> None:
    ward = living(small_ward)
    hold = ward.simulation.drive(0.5, 0, 10)
    hospital = ward.simulation._hospital
    for _ in range(30):
        next(hold)
        hospital.step()
    ward.does(ward.simulation.drive(0.0, 45, 2))
    with pytest.raises(StopIteration):
        next(hold)
    assert ward.simulation.robot.theta == pytest.approx(90, abs=12)
    # The older one did not take the wheel back when it ended.
    assert ward.simulation.robot.speed == 0
