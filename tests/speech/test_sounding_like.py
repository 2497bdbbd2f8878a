"""A word that the world's names explain is heard as that: "fork", not "fourth"."""

import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.speech.hear.recogniser import Heard
from nl2robot.speech.hear.sounding_like import respelled, sounds
from nl2robot.voice.hearing import Ear
from nl2robot.work import here
from sim.world.loading import load_world


@pytest.fixture
def ear():
    """An ear in the kitchen that has heard already: what it hears with is of no matter here."""
    ear = Ear.__new__(Ear)
    ear._think = here
    ear.knowledge = Knowledge(load_world("household"))
    ear.language = "en"
    return ear


def heard(text: str, doubtful: bool = False) -> Heard:
    return Heard(text, 0.9, (), doubtful, None, (), 2.0, 0.1)


def test_fork_sounds_like_fourth() -> None:
    assert next(respelled("bring me the fourth", ["cup", "fork"], "en")) == "bring me the fork"
    assert not list(respelled("bring me the fork", ["cup", "fork"], "en"))
    assert not list(respelled("go to the window", ["cup", "fork"], "en"))
    assert sounds("fork", "en")


@pytest.mark.parametrize(
    ("said", "meant"),
    [
        ("bring me the fourth", "bring me the fork"),
        ("put the fourth on the table", "put the fork on the table"),
        ("go to the kitten", "go to the kitchen"),
        ("ask Alec if he wants tea", "ask Alex if he wants tea"),
    ],
)
def test_a_name_of_the_world_is_heard(ear, said, meant) -> None:
    assert ear.understood(heard(said)).text == meant


@pytest.mark.parametrize(
    "said",
    [
        "bring me the fork",
        "bring me the bottle",  # of water
        "the weather is nice",
        "take the cereal to the patient",  # and not to the Peyton
        "I was the fourth today",
        "turn around four times",
        "what time is it",
        "no, the fourth",
        "stop",
        "yes",
    ],
)
def test_what_makes_sense_or_no_more_with_a_name_stays(ear, said) -> None:
    assert ear.understood(heard(said), also={"yes"}).text == said


def test_what_is_in_doubt_stays_in_doubt(ear) -> None:
    unsure = heard("bring me the fourth", doubtful=True)
    assert ear.understood(unsure) == unsure
