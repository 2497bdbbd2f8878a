"""Leading people at their pace, and going after them."""

from __future__ import annotations

import math

import pytest

from sim.errors import Blocked, NotFound, NotPossible, UnknownPlace


def gaps(simulation, name: str) -> list[float]:
    """The distance between the robot and a person over time."""
    number = simulation.record.people.index(name)
    return [math.dist((s.x, s.y), s.people[number]) for s in simulation.record.samples]


@pytest.mark.parametrize("seed", [1, 2])
def test_alice_is_led_from_ward_a_to_ward_b(small_ward, living, seed) -> None:
    ward = living(small_ward, seed)
    ward.goes_to("ward a")
    ward.does(ward.simulation.guide("Alice", *ward.simulation.locate("ward b")))
    robot, alice = ward.simulation.robot, ward.person("Alice")
    assert robot.place == "ward b" and robot.speed == 0
    assert small_ward.place_at(*alice.position).name == "ward b"
    assert math.dist((robot.x, robot.y), alice.position) < 2
    assert min(gaps(ward.simulation, "Alice")) > 0.5


def test_the_robot_waits_for_a_slow_visitor(corridor, living) -> None:
    quick = living(corridor("people: [{name: Tom, pose: [2.5, 1.25, 180]}]"))
    quick.does(quick.simulation.guide("Tom", 11, 1.25))
    slow = living(corridor("people: [{name: Tom, pose: [2.5, 1.25, 180], is: [with a walker]}]"))
    slow.does(slow.simulation.guide("Tom", 11, 1.25))
    assert slow.simulation.time > quick.simulation.time + 3
    # It never runs away from them.
    assert max(gaps(slow.simulation, "Tom")) < 3.2
    assert gaps(slow.simulation, "Tom")[-1] < 2


def test_somebody_lying_gets_up_to_come_along(small_ward, living) -> None:
    ward = living(small_ward)
    ward.goes_to("ward b")
    ward.does(ward.simulation.guide("patient", *ward.simulation.locate("corridor")))
    assert small_ward.place_at(*ward.person("Henry").position).name == "corridor"


def test_whoever_was_led_away_goes_home_after_a_while(small_ward, living) -> None:
    ward = living(small_ward)
    henry = ward.person("Henry")
    bed = henry.position
    ward.goes_to("ward b")
    ward.does(ward.simulation.guide("Henry", *ward.simulation.locate("ward a")))
    assert henry.posture == "standing" and math.dist(henry.position, bed) > 3
    ward.goes_to("charger")
    ward.does(ward.simulation.wait(150))
    assert math.dist(henry.position, bed) < 0.5 and henry.posture == "lying"


def test_somebody_who_is_not_here_cannot_be_led(small_ward, living) -> None:
    ward = living(small_ward)
    with pytest.raises(NotFound, match="Henry"):
        ward.does(ward.simulation.guide("Henry", *ward.simulation.locate("ward b")))
    ward.goes_to("ward a")  # the wheel is free


def test_nobody_is_led_into_a_wall(small_ward, living) -> None:
    ward = living(small_ward)
    ward.goes_to("ward a")
    with pytest.raises(NotPossible):
        ward.does(ward.simulation.guide("Alice", 6, 5))
    assert not ward.person("Alice").walking


def test_somebody_who_is_held_up_is_given_up_after_a_while(small_ward, living) -> None:
    ward = living(small_ward)
    ward.goes_to("ward a")
    behaviour = ward.simulation.guide("Alice", *ward.simulation.locate("ward b"))
    alice = ward.person("Alice")

    def hold_up(kind, data) -> None:
        alice.pace = 0.0

    ward.simulation.subscribe(hold_up)
    with pytest.raises(NotFound, match="Alice no longer comes along"):
        ward.does(behaviour)
    assert ward.simulation.robot.speed == 0


def test_the_next_place_is_reached_behind_alice(small_ward, living) -> None:
    ward = living(small_ward)
    ward.goes_to("ward a")
    ward.does(ward.simulation.follow("Alice", "ward b"))
    robot, alice = ward.simulation.robot, ward.person("Alice")
    assert small_ward.place_at(*alice.position).name == "ward b"
    assert math.dist((robot.x, robot.y), alice.position) < 2.5
    assert min(gaps(ward.simulation, "Alice")) > 0.5
    # It went after her, not ahead.
    assert not alice.walking


def test_following_without_a_place_ends_when_they_stand_still(hospital, living) -> None:
    ward = living(hospital, 3)
    assert ward.does(ward.simulation.find("porter"))
    before = ward.person("Victor").position
    ward.does(ward.simulation.follow("porter"))
    victor = ward.person("Victor").position
    robot = ward.simulation.robot
    assert math.dist(before, victor) > 3
    assert math.dist((robot.x, robot.y), victor) < 2.5


def test_a_nurse_on_her_round_can_be_asked_to_go_elsewhere(hospital, living) -> None:
    ward = living(hospital, 2)
    assert ward.does(ward.simulation.find("Maria"))
    ward.does(ward.simulation.follow("Maria", "kitchen"))
    assert hospital.place_at(*ward.person("Maria").position).name == "kitchen"


def test_a_place_unknown_or_out_of_reach_is_said_at_once(world_of, living) -> None:
    world = world_of(
        """\
        name: walled in
        robot: {start: hall}
        walls: [[0, 0, 8, 0, 8, 4, 0, 4, 0, 0], [4, 0, 4, 4]]
        places: [{name: hall, pose: [1, 2, 0]}, {name: vault, pose: [6, 2, 0]}]
        people: [{name: Tom, pose: [2.5, 2, 180]}]
        """
    )
    ward = living(world)
    with pytest.raises(UnknownPlace, match="cellar"):
        ward.does(ward.simulation.follow("Tom", "cellar"))
    with pytest.raises(Blocked, match="Tom finds no way to vault"):
        ward.does(ward.simulation.follow("Tom", "vault"))
    assert ward.simulation.time < 2
