"""Looking for things and people from room to room, and waiting for whoever comes."""

from __future__ import annotations

import math

import pytest

from sim.errors import Blocked, UnknownPlace


def rooms(ward) -> list[str]:
    """The places that the robot came through, in order."""
    names = []
    for sample in ward.simulation.record.samples:
        place = ward.simulation.world.place_at(sample.x, sample.y)
        if place is not None and (not names or names[-1] != place.name):
            names.append(place.name)
    return names


def test_it_looks_in_one_room_after_the_other_until_it_sees_the_book(small_ward, living) -> None:
    ward = living(small_ward)
    assert ward.does(ward.simulation.find("book")) is True
    assert rooms(ward)[-1] == "ward b"
    (book,) = ward.simulation.visible("book")
    robot = ward.simulation.robot
    assert math.dist((robot.x, robot.y), (book.x, book.y)) < 1.3


def test_what_is_here_is_not_looked_for_elsewhere(small_ward, living) -> None:
    ward = living(small_ward)
    ward.goes_to("ward b")
    before = ward.simulation.time
    assert ward.does(ward.simulation.find("cup"))
    assert ward.simulation.time - before < 10
    assert ward.simulation.visible("cup")[0].attributes == ("blue",)


def test_an_attribute_sends_it_past_the_wrong_cup(small_ward, living) -> None:
    ward = living(small_ward)
    assert ward.does(ward.simulation.find("blue cup"))
    assert ward.simulation.robot.place == "ward b"
    assert ward.does(ward.simulation.find("red cup"))
    assert ward.simulation.robot.place == "ward a"


def test_what_is_nowhere_is_not_found_though_it_looked_everywhere(hospital, living) -> None:
    ward = living(hospital)
    assert ward.does(ward.simulation.find("unicorn")) is False
    with_pose = {place.name for place in hospital.places if place.pose}
    assert with_pose <= set(rooms(ward))
    assert ward.simulation.robot.speed == 0


def test_in_one_place_only(small_ward, living) -> None:
    ward = living(small_ward)
    assert ward.does(ward.simulation.find("book", "ward a")) is False
    assert ward.simulation.robot.place == "ward a"
    with pytest.raises(UnknownPlace):
        ward.does(ward.simulation.find("book", "library"))


def test_it_stands_by_a_person_and_deals_with_them(hospital, living) -> None:
    ward = living(hospital)
    assert ward.does(ward.simulation.find("Alice"))
    robot = ward.simulation.robot
    (alice,) = ward.simulation.visible("Alice")
    assert math.dist((robot.x, robot.y), (alice.x, alice.y)) < 1.9
    assert ward.does(ward.simulation.hear()) == "yes"


def test_a_person_who_walks_about_is_caught_up_with(hospital, living) -> None:
    ward = living(hospital, 4)
    assert ward.does(ward.simulation.find("Victor"))
    (victor,) = ward.simulation.visible("Victor")
    robot = ward.simulation.robot
    assert math.dist((robot.x, robot.y), (victor.x, victor.y)) < 1.5


def test_rooms_behind_closed_doors_are_left_out(world_of, living) -> None:
    world = world_of(
        """\
        name: three rooms
        robot: {start: hall}
        walls: [[0, 0, 12, 0, 12, 4, 0, 4, 0, 0], [4, 0, 4, 4], [8, 0, 8, 4]]
        doors:
          - {at: lab, from: [4, 1], to: [4, 2.4]}
          - {at: store, from: [8, 1], to: [8, 2.4], open: false}
        places:
          - {name: hall, pose: [2, 2, 0], area: [0, 0, 4, 4]}
          - {name: lab, pose: [6, 2, 0], area: [4, 0, 8, 4]}
          - {name: store, pose: [10, 2, 0], area: [8, 0, 12, 4]}
        objects: [{name: stapler, at: store}]
        """
    )
    ward = living(world)
    assert ward.does(ward.simulation.find("stapler")) is False
    with pytest.raises(Blocked, match="the door of store is closed"):
        ward.does(ward.simulation.find("stapler", "store"))
    ward.simulation.set_door(1, True)
    ward.does(ward.simulation.wait(130))
    assert ward.does(ward.simulation.find("stapler")) is True


# --- waiting -------------------------------------------------------------------------------------


def test_in_a_loop_wait_for_brings_the_next_person_each_time(hospital, living) -> None:
    ward = living(hospital)
    ward.goes_to("reception")
    met = []
    for _ in range(4):
        assert ward.does(ward.simulation.wait_for("person", 120)) is True
        met.append(ward.simulation._hospital.partner)
    assert len(set(met)) == 4
    assert met[:2] == ["Rosa", "Tom"]
    # Whoever comes in later stands before the robot when the robot has met them.
    robot = ward.simulation.robot
    for newcomer in met[2:]:
        human = ward.person(newcomer)
        assert human.distance((robot.x, robot.y)) < 3.5


def test_the_next_visitor_is_one_that_fits(hospital, living) -> None:
    ward = living(hospital)
    ward.goes_to("lobby")
    for _ in range(2):
        assert ward.does(ward.simulation.wait_for("woman visitor", 120))
    newcomers = [
        h.person
        for h in ward.simulation._hospital.people
        if h.name not in {p.name for p in hospital.people}
    ]
    assert newcomers and all(p.gender == "female" and p.kind == "visitor" for p in newcomers)


def test_a_nurse_of_the_house_comes_by_where_nobody_comes_in(small_ward, living) -> None:
    ward = living(small_ward)
    ward.goes_to("ward b")
    assert ward.does(ward.simulation.wait_for("nurse", 120)) is True
    assert [seen.name for seen in ward.simulation.visible("nurse")] == ["Alice"]


def test_a_thing_does_not_come_by_itself(small_ward, living) -> None:
    ward = living(small_ward)
    assert ward.does(ward.simulation.wait_for("wheelchair", 30)) is False
    assert ward.simulation.time == pytest.approx(30, abs=0.05)


def test_a_new_program_has_met_nobody(small_ward, living) -> None:
    ward = living(small_ward)
    ward.goes_to("ward a")
    assert ward.does(ward.simulation.wait_for("Alice", 0))
    assert not ward.does(ward.simulation.wait_for("Alice", 5))
    ward.simulation.forget_met()
    assert ward.does(ward.simulation.wait_for("Alice", 0))


def test_three_visitors_are_shown_the_way(hospital, living) -> None:
    """The program that the project exists for."""
    ward = living(hospital, 7)
    ward.goes_to("reception")
    desk = ward.simulation.locate("reception")
    shown = []
    for _ in range(3):
        assert ward.does(ward.simulation.wait_for("visitor"))
        place = ward.does(ward.simulation.hear(10, "Where to?", ["radiology", "pharmacy"]))
        place = "pharmacy" if place is None or "pharmacy" in place else "radiology"
        ward.does(ward.simulation.guide("visitor", *ward.simulation.locate(place)))
        guest = ward.person(ward.simulation._hospital.partner)
        assert hospital.place_at(*guest.position).name == place
        shown.append(guest.name)
        ward.does(ward.simulation.drive_to(*desk))
    assert len(set(shown)) == 3


# --- the likeliest place first -------------------------------------------------------------------


def test_a_person_is_looked_for_in_their_own_room_first(hospital, living) -> None:
    ward = living(hospital)
    ward.does(ward.simulation.find("Alice"))
    visited = [name for name in rooms(ward) if "office" in name]
    assert visited[:1] == ["alice's office"], rooms(ward)


def test_medicine_is_looked_for_at_the_pharmacy_first(hospital, living) -> None:
    ward = living(hospital)
    kinds = {thing.kind: thing.name for thing in hospital.objects}
    ward.does(ward.simulation.find(kinds["medicine"]))
    reached = [name for name in rooms(ward) if name not in ("charger", "corridor")]
    pharmacy = next(place.name for place in hospital.places if place.kind == "pharmacy")
    assert pharmacy in reached


def test_what_was_seen_is_looked_for_where_it_was_seen(small_ward, living) -> None:
    ward = living(small_ward)
    assert ward.does(ward.simulation.find("blue cup"))
    ward.goes_to("ward a")
    before = len(rooms(ward))
    assert ward.does(ward.simulation.find("blue cup"))
    assert rooms(ward)[-1] == "ward b"
    assert len(rooms(ward)) - before <= 3


def test_it_tells_where_it_has_looked_in_vain(small_ward, living) -> None:
    ward = living(small_ward)
    assert ward.does(ward.simulation.find("unicorn")) is False
    told = [each.data for each in ward.simulation.record.happenings if each.kind == "searched"]
    assert [each["thing"] for each in told] == ["unicorn"]
    assert {"ward a", "ward b"} <= set(told[0]["places"])
