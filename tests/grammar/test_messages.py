"""A message is said to its receiver as one person says it to another."""

from __future__ import annotations

import pytest

from grammar.program import write_program
from grammar.understand import understand
from tests.grammar.hospitals import hospital
from tests.grammar.ward import WARD


@pytest.mark.parametrize(
    ("sentence", "said"),
    [
        ("tell Bob that he's late", "You are late."),
        ("tell Bob I need him in the emergency room", "I need you in the emergency room."),
        (
            "tell the patient that the doctor will be with her shortly",
            "The doctor will be with you",
        ),
        ("tell Bob his taxi is here", "Your taxi is here."),
        ("let Alice know she needs to rest and drink a lot", "You need to rest and drink a lot."),
        ("inform the visitors that they can go home", "You can go home."),
        ("let Alice know that Bob is looking for her", "Bob is looking for you."),
    ],
)
def test_the_receiver_is_you(sentence: str, said: str) -> None:
    plan = understand(sentence, WARD).plan
    assert plan is not None
    assert said in write_program(plan)


@pytest.mark.parametrize(
    ("sentence", "said"),
    [
        ("tell Alice that Bob has forgotten his folder", "Bob has forgotten his folder."),
        ("tell Alice that her patient is here and that he is waiting", "and he is waiting."),
        ("say that he is late", "He is late."),
    ],
)
def test_others_are_not(sentence: str, said: str) -> None:
    plan = understand(sentence, WARD).plan
    assert plan is not None
    assert said in write_program(plan)


@pytest.mark.parametrize(
    "sentence",
    [
        "ask Bob whether he wants coffee or tea. Frobnicate what he wants from the kitchen",
        "ask everyone in the lobby if they need a blanket. For everyone who says yes, zorple one",
    ],
)
def test_no_text_goes_on_into_the_next_sentence_or_ends_half_way(sentence: str) -> None:
    assert understand(sentence, WARD).plan is None


@pytest.mark.parametrize(
    ("language", "said", "spoken"),
    [
        ("en", "tell Bob that you are waiting for him here", "I am waiting for you here."),
        ("en", "show on the screen that you will be back soon", "I will be back soon."),
        ("de", "zeig auf dem Bildschirm, dass du gleich wieder da bist", "Ich bin gleich wieder"),
        ("fr", "affiche à l'écran que tu reviens tout de suite", "Je reviens"),
    ],
)
def test_who_is_you_in_a_message_to_others_is_the_robot(
    language: str, said: str, spoken: str
) -> None:
    understood = understand(said, hospital(language), language)
    assert understood.plan is not None
    assert spoken in write_program(understood.plan)
