"""Any noun phrase may be asked for; what fits and is here is seen."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.errors import NotFound
from sim.people.perception import parse
from sim.simulation import Simulation
from sim.world.loading import load_world

SHELF = """\
name: shelf
robot: {start: here}
walls: [[0, 0, 8, 0, 8, 6, 0, 6, 0, 0]]
places: [{name: here, pose: [2, 3, 0], area: [0, 0, 8, 6]}]
furniture:
  - {name: shelf, pose: [7, 3, 90], size: [5, 0.5]}
  - {name: table, pose: [4, 5.4, 0], size: [1, 0.6]}
people:
  - {name: Bob, kind: doctor, gender: male, pose: [5, 1, 0], is: [standing, wearing a white coat]}
  - {name: Alice, kind: nurse, gender: female, pose: [5, 5, 0], is: [sitting, waving],
     aliases: {de: [Schwester Alice]}}
  - {name: Ivy, kind: child, pose: [3, 1, 0], is: [standing, waving, small]}
objects:
  - {name: water bottle, kind: drink, on: shelf, pose: [7, 1, 0], is: [blue, big],
     size: [0.1, 0.1, 0.3], weight: 1.5}
  - {name: milk, kind: drink, on: shelf, pose: [7, 3, 0], is: [white],
     size: [0.1, 0.1, 0.2], weight: 1.0}
  - {name: glasses, kind: thing to read with, on: shelf, pose: [7, 4, 0], is: [black]}
  - {name: cup, kind: dishes, on: table, pose: [4, 5.4, 0], is: [red, small],
     size: [0.08, 0.08, 0.1], weight: 0.2,
     aliases: {de: [Tasse]}}
  - {name: knife, kind: tool, on: table, pose: [4.2, 5.4, 0], is: [sharp],
     size: [0.2, 0.02, 0.01], weight: 0.1}
"""


@pytest.fixture
def shelf(world_of) -> Simulation:
    return Simulation(world_of(SHELF))


@pytest.mark.parametrize(
    ("phrase", "names"),
    [
        ("cup", ["cup"]),
        ("the red cup", ["cup"]),
        ("blue cup", []),
        ("cups", ["cup"]),
        ("knives", ["knife"]),
        ("glasses", ["glasses"]),
        ("a drink", ["milk", "water bottle"]),
        ("2 objects", ["cup", "knife"]),
        ("2 heaviest objects", ["water bottle", "milk"]),
        ("woman sitting down", ["Alice"]),
        ("cup above the table", ["cup"]),
        ("drinks", ["milk", "water bottle"]),
        ("bottle", ["water bottle"]),
        ("large bottle", ["water bottle"]),
        ("objects", ["cup", "knife", "milk", "glasses", "water bottle"]),
        ("thing", ["cup", "knife", "milk", "glasses", "water bottle"]),
        ("person", ["Ivy", "Bob", "Alice"]),
        ("people", ["Ivy", "Bob", "Alice"]),
        ("someone", ["Ivy", "Bob", "Alice"]),
        ("woman", ["Alice"]),
        ("men", ["Bob"]),
        ("children", ["Ivy"]),
        ("person waving", ["Ivy", "Alice"]),
        ("the waving nurse", ["Alice"]),
        ("sitting person", ["Alice"]),
        ("people who are standing", ["Ivy", "Bob"]),
        ("seated person", ["Alice"]),
        ("lying person", []),
        ("the man in the white coat", ["Bob"]),
        ("the person with the white coat", ["Bob"]),
        ("doctor", ["Bob"]),
        ("ALICE", ["Alice"]),
        ("Schwester Alice", ["Alice"]),
        ("Tasse", ["cup"]),
        ("personne", ["Ivy", "Bob", "Alice"]),
        ("leftmost drink", ["milk"]),
        ("the rightmost drink", ["water bottle"]),
        ("biggest object", ["water bottle"]),
        ("smallest thing", ["knife"]),
        ("heaviest drink", ["water bottle"]),
        ("lightest drink", ["milk"]),
        ("thinnest object", ["knife"]),
        ("nearest person", ["Ivy"]),
        ("objects on the table", ["cup", "knife"]),
        ("the drink on the shelf", ["milk", "water bottle"]),
        ("cup on the shelf", []),
        ("the thing on the moon", []),
        ("table", ["table"]),
        ("unicorn", []),
        ("the", []),
        ("!?", []),
    ],
)
def test_a_phrase_means(shelf, phrase, names) -> None:
    assert [seen.name for seen in shelf.visible(phrase)] == names


def test_what_is_seen_comes_with_what_is_known_of_it(shelf) -> None:
    (alice,) = shelf.visible("nurse")
    assert alice.is_person and alice.kind == "nurse"
    assert alice.attributes == ("sitting", "waving")
    (cup,) = shelf.visible("cup")
    assert (cup.is_person, cup.kind, cup.attributes, cup.x) == (
        False,
        "dishes",
        ("red", "small"),
        4,
    )


def test_it_describes_in_a_sentence(shelf) -> None:
    assert shelf.describe("cup") == "It is a red small cup (dishes) on the table."
    assert shelf.describe("Alice") == "Alice, a nurse, is sitting and waving."
    with pytest.raises(NotFound, match="unicorn"):
        shelf.describe("unicorn")


def test_it_does_not_see_through_walls_nor_into_the_next_room(small_ward, living) -> None:
    ward = living(small_ward)
    assert ward.simulation.visible("person") == []
    ward.goes_to("ward a")
    assert [seen.name for seen in ward.simulation.visible("people")] == ["Alice"]
    assert [seen.attributes for seen in ward.simulation.visible("cup")] == [("red",)]


def test_without_rooms_on_the_map_it_sees_eight_metres_far(corridor, living) -> None:
    simulation = living(
        corridor(
            """\
            people: [{name: Near, pose: [8, 1.25, 0]}, {name: Far, pose: [10, 1.25, 0]}]
            objects: [{name: ball, pose: [5, 1, 0]}]
            """
        )
    ).simulation
    assert [seen.name for seen in simulation.visible("people")] == ["Near"]
    assert len(simulation.visible("ball")) == 1


def test_left_is_left_of_where_the_robot_looks_from(shelf) -> None:
    shelf.localize(4.5, 3, 180)
    assert [seen.name for seen in shelf.visible("leftmost drink")] == ["milk"]
    shelf.localize(6.2, 2, 0)
    assert [seen.name for seen in shelf.visible("leftmost drink")] == ["milk"]


HOSPITAL = Simulation(load_world("city-hospital"))


@settings(max_examples=150, deadline=None)
@given(
    st.text(max_size=60)
    | st.lists(
        st.sampled_from(
            [
                "the",
                "biggest",
                "person",
                "on",
                "of",
                "red",
                "leftmost",
                "men",
                "who",
                "'",
                "l'objet",
            ]
        )
    ).map(" ".join)
)
def test_no_phrase_is_too_strange(text: str) -> None:
    parse(text)
    for seen in HOSPITAL.visible(text):
        assert seen.name


def test_every_thing_of_the_hospital_is_found_by_its_own_words(hospital) -> None:
    simulation = Simulation(hospital)
    for thing in hospital.objects:
        place = hospital.place(thing.at)
        simulation.localize(place.pose.x, place.pose.y, 0)
        for phrase in (thing.name, thing.kind, " ".join([*thing.is_, thing.name])):
            found = [(seen.name, seen.attributes) for seen in simulation.visible(phrase)]
            assert (thing.name, thing.is_) in found
