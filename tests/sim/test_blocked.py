"""People and closed doors in the way: around them, another way, patience, or a clear word."""

from __future__ import annotations

import math
import threading

import pytest

from sim.errors import Blocked, NotPossible
from sim.hospital import chart_of


def nearest_approach(simulation) -> float:
    """The least distance between the middles of the robot and of a person."""
    return min(
        math.dist((sample.x, sample.y), person)
        for sample in simulation.record.samples
        for person in sample.people
    )


TWO_DOORS = """\
name: two doors
robot: {start: hall}
walls:
  - [0, 0, 12, 0, 12, 8, 0, 8, 0, 0]
  - [6, 0, 6, 8]
doors:
  - {at: lab, name: the south door of the lab, from: [6, 1], to: [6, 2.2], open: false}
  - {at: lab, name: the north door of the lab, from: [6, 6], to: [6, 7.2], open: %s}
places:
  - {name: hall, pose: [2, 2, 0], area: [0, 0, 6, 8]}
  - {name: lab, pose: [10, 2, 0], area: [6, 0, 12, 8]}
"""


def test_a_person_who_stands_in_the_corridor_is_passed_at_a_distance(corridor, living) -> None:
    ward = living(corridor("people: [{name: Tom, pose: [6, 1.0, 0], is: [standing]}]"))
    ward.goes_to("east end")
    assert ward.simulation.robot.x == pytest.approx(11, abs=0.05)
    assert nearest_approach(ward.simulation) > 0.55
    assert ward.simulation.time < 22


def test_a_person_who_steps_into_the_corridor_is_not_run_over(corridor, living) -> None:
    ward = living(corridor("people: [{name: Tom, pose: [7, 0.4, 90], is: [standing]}]"))
    simulation = ward.simulation
    tom = simulation._hospital.people[0]

    def step_out(kind, data) -> None:
        if kind == "pose" and data["x"] > 4.5 and not tom.walking and tom.position[1] < 1:
            tom.walk_to(simulation._hospital, (7, 1.25))

    simulation.subscribe(step_out)
    ward.goes_to("east end")
    assert tom.position[1] > 1.1
    assert nearest_approach(simulation) > 0.5
    assert simulation.robot.x == pytest.approx(11, abs=0.05)


def test_somebody_on_their_feet_in_a_narrow_way_makes_room(world_of, living) -> None:
    world = world_of(
        """\
        name: narrow
        robot: {start: west}
        walls:
          - [0, 0, 5, 0, 5, 3, 9, 3, 9, 0, 14, 0, 14, 5, 9, 5, 9, 4.2, 5, 4.2, 5, 5, 0, 5, 0, 0]
        places: [{name: west, pose: [1, 2.5, 0]}, {name: east, pose: [13, 2.5, 0]}]
        people: [{name: Tom, pose: [9.6, 3.6, 180]}]
        """
    )
    ward = living(world)
    ward.goes_to("east")
    assert ward.simulation.robot.x == pytest.approx(13, abs=0.05)
    assert nearest_approach(ward.simulation) > 0.49


def test_whoever_is_led_out_of_a_small_room_steps_out_of_the_doorway(world_of, living) -> None:
    world = world_of(
        """\
        name: closet
        robot: {start: closet}
        walls: [[0, 0, 8, 0, 8, 4, 0, 4, 0, 0], [3, 0, 3, 4]]
        doors: [{at: closet, from: [3, 1.4], to: [3, 2.4]}]
        places:
          - {name: closet, pose: [1.2, 1.9, 0], area: [0, 0, 3, 4]}
          - {name: hall, pose: [7, 2, 0], area: [3, 0, 8, 4]}
        people: [{name: Tom, pose: [2.8, 1.9, 180]}]
        """
    )
    ward = living(world)
    ward.does(ward.simulation.guide("Tom", *ward.simulation.locate("hall")))
    tom = ward.simulation._hospital.people[0]
    assert world.place_at(*tom.position).name == "hall"
    assert ward.simulation.robot.place == "hall"


def test_a_wheelchair_that_fills_the_corridor_blocks_it_and_is_named(world_of, living) -> None:
    world = world_of(
        """\
        name: narrow
        robot: {start: west end}
        walls: [[0, 0, 12, 0, 12, 1.4, 0, 1.4, 0, 0]]
        places:
          - {name: west end, pose: [1, 0.7, 0]}
          - {name: bottleneck, pose: [6, 0.7, 0]}
          - {name: east end, pose: [11, 0.7, 0]}
        people: [{name: Mrs Miller, pose: [6, 0.7, 0], is: [sitting]}]
        """
    )
    ward = living(world)
    with pytest.raises(Blocked, match="Mrs Miller is in the way at bottleneck") as no:
        ward.goes_to("east end")
    assert "east end" in str(no.value)
    robot = ward.simulation.robot
    assert 4.5 < robot.x < 5.6 and robot.speed == 0
    assert 10 < ward.simulation.time < 60


def test_behind_a_closed_door_it_takes_the_other(world_of, living) -> None:
    ward = living(world_of(TWO_DOORS % "true"))
    ward.goes_to("lab")
    assert ward.simulation.robot.place == "lab"
    # It has been at the south door before it knew.
    assert any(s.x > 4 and s.y < 3 for s in ward.simulation.record.samples if s.time < 8)
    assert any(abs(s.x - 6) < 0.5 and s.y > 5.5 for s in ward.simulation.record.samples)
    # Once it knows, it goes there straight away.
    ward.goes_to("hall")
    before = ward.simulation.time
    ward.goes_to("lab")
    assert not any(
        s.x > 4 and s.x < 5.5 and s.y < 3 for s in ward.simulation.record.samples if s.time > before
    )


def test_with_both_doors_closed_it_says_which(world_of, living) -> None:
    ward = living(world_of(TWO_DOORS % "false"))
    with pytest.raises(
        Blocked, match=r"The way to lab is blocked: the .* door of the lab is closed"
    ):
        ward.goes_to("lab")
    assert ward.simulation.robot.place == "hall"
    assert ward.simulation.robot.speed == 0


def test_a_door_that_was_opened_meanwhile_is_found_open(world_of, living) -> None:
    ward = living(world_of(TWO_DOORS % "false"))
    with pytest.raises(Blocked):
        ward.goes_to("lab")
    ward.simulation.set_door(0, True)
    ward.does(ward.simulation.wait(130))
    ward.goes_to("lab")
    assert ward.simulation.robot.place == "lab"


def test_a_door_that_closes_in_front_of_it_is_no_collision(world_of, living) -> None:
    world = world_of((TWO_DOORS % "true").replace("open: false", "open: true"))
    ward = living(world)
    simulation = ward.simulation

    def slam(kind, data) -> None:
        if kind == "pose" and data["x"] > 3.5 and simulation._hospital.open_doors[0]:
            simulation.set_door(0, False)

    simulation.subscribe(slam)
    ward.goes_to("lab")
    assert simulation.robot.place == "lab"
    assert any(s.y > 5.5 for s in simulation.record.samples)


def test_a_room_without_a_door_cannot_be_reached(world_of, living) -> None:
    world = world_of(
        """\
        name: walled in
        robot: {start: hall}
        walls: [[0, 0, 8, 0, 8, 4, 0, 4, 0, 0], [4, 0, 4, 4]]
        places: [{name: hall, pose: [2, 2, 0]}, {name: vault, pose: [6, 2, 0]}]
        """
    )
    with pytest.raises(Blocked, match=r"no way .*from hall to vault"):
        living(world).goes_to("vault")


def test_people_who_walk_about_are_met_without_a_push(hospital, living) -> None:
    ward = living(hospital, 5)
    for place in ("ward a", "kitchen", "ward c", "lift", "main corridor", "ward a"):
        ward.goes_to(place)
    # The middles of two who touch are half a metre apart; more than a brush would be less.
    assert nearest_approach(ward.simulation) > 0.48
    chart = chart_of(hospital)
    assert min(chart.distance(s.x, s.y) for s in ward.simulation.record.samples) >= 0.25


def test_a_world_without_a_map_cannot_be_simulated(world_of, living) -> None:
    with pytest.raises(NotPossible, match="no map"):
        living(world_of("name: paper\nplaces: [{name: pharmacy}]\n"))


def test_a_stop_that_was_pressed_before_keeps_it_from_moving(small_ward, living) -> None:
    from sim.errors import Interrupted

    ward = living(small_ward)
    stop = threading.Event()
    stop.set()
    with pytest.raises(Interrupted):
        ward.simulation.run(ward.simulation.move(1), stop)
    assert ward.simulation.robot.x == 1 and ward.simulation.time == 0
