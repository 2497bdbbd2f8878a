"""What the world is called in sentences."""

from __future__ import annotations

import pytest

from grammar.lexicon import Lexicon, Name, kind_of
from grammar.understand import understand
from tests.grammar.ward import program

HOUSE = Lexicon(
    places=(
        Name("pharmacy"),
        Name("east ward"),
        Name("west ward"),
        Name("Eva's office"),
        Name("lab 1", "lab"),
    ),
    people=(Name("Eva", "nurse"),),
    objects=(Name("blue mug", "mug", ("coffee cup",)),),
    furniture=(Name("medicine cabinet", "cabinet", inside="pharmacy"),),
)


def does(sentence: str) -> str:
    understood = understand(sentence, HOUSE)
    assert understood.plan is not None, understood.message
    return program(understood.plan)


def test_the_kind_of_a_place_is_the_last_word_of_its_name() -> None:
    assert [kind_of(place) for place in HOUSE.places] == [None, "ward", "ward", "office", "lab"]
    assert set(HOUSE.place_kinds) == {"ward", "office", "lab"}


@pytest.mark.parametrize(
    "said", ["Eva's office", "the office of Eva", "evas office", "the office", "EVA'S OFFICE"]
)
def test_an_office_by_its_owner_or_as_the_only_one(said: str) -> None:
    assert does(f"go to {said}") == 'goto("Eva\'s office")'


def test_of_several_of_a_kind_one_must_be_named() -> None:
    understood = understand("go to the ward", HOUSE)
    assert understood.status == "clarify"
    assert understood.suggestions == ["go to east ward", "go to west ward"]


@pytest.mark.parametrize("said", ["every ward", "all wards", "each of the wards", "both wards"])
def test_all_of_a_kind(said: str) -> None:
    assert does(f"go to {said}") == 'for place in places("ward") { goto(place) }'


def test_a_thing_by_another_name_is_the_worlds_thing() -> None:
    assert 'find("blue mug")' in does("bring me the coffee cup")


def test_furniture_is_gone_to_where_it_stands() -> None:
    assert does("put the blue mug in the medicine cabinet") == (
        'find("blue mug"); grab("blue mug"); goto("pharmacy"); put("blue mug", "medicine cabinet")'
    )


def test_two_people_by_one_name_are_asked_about() -> None:
    twins = Lexicon(
        places=(Name("lobby"),),
        people=(Name("Ann Smith", "nurse", ("Ann",)), Name("Ann Jones", "doctor", ("Ann",))),
    )
    understood = understand("take Ann to the lobby", twins)
    assert understood.status == "clarify"
    assert understood.suggestions == ["take Ann Smith to the lobby", "take Ann Jones to the lobby"]
