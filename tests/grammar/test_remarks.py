"""What people say besides a command: used where it helps, else shown and never acted on."""

from __future__ import annotations

import pytest

from grammar.explain import explain
from grammar.program import write_program
from grammar.understand import understand
from tests.grammar import ward_de, ward_fr
from tests.grammar.ward import WARD


def program(sentence: str) -> str:
    found = understand(sentence, WARD)
    assert found.plan is not None, f"{sentence}: {found.message}"
    return write_program(found.plan)


@pytest.mark.parametrize(
    ("sentence", "looks"),
    [
        ("bring the cup to Alice, she's in radiology", 'robot.find("Alice", place="radiology")'),
        ("Bob is in the cafeteria. Bring him the cup.", 'robot.find("Bob", place="cafeteria")'),
        ("I forgot my umbrella in the lobby, can you get it?", '("umbrella", place="lobby")'),
        ("tell Alice that lunch is ready. She's in the kitchen.", '("Alice", place="kitchen")'),
    ],
)
def test_where_somebody_is_said_to_be_is_where_they_are_looked_for(
    sentence: str, looks: str
) -> None:
    assert looks in program(sentence)


def test_a_name_that_is_told_is_who_is_meant() -> None:
    text = program("I am looking for my wife, her name is Alice. Could you find her?")
    assert 'robot.find("Alice")' in text


def test_what_is_told_can_be_passed_on() -> None:
    text = program("Somebody spilled coffee in the lobby, tell Bob")
    assert 'robot.say("Somebody spilled coffee in the lobby.")' in text


def test_reasons_stand_in_the_program_and_in_its_words() -> None:
    found = understand("I don't hear so well. Set your volume to 80 percent.", WARD)
    assert found.plan is not None
    assert found.plan.background == ("I don't hear so well",)
    assert write_program(found.plan) == "# I don't hear so well\nrobot.set_volume(80)\n"
    assert "I don't hear so well" in explain(found.plan)


@pytest.mark.parametrize(
    "sentence",
    [
        "Alice went to the lobby",
        "my leg hurts",
        "the lift is broken and the coffee is cold",
        "go to the kitchen and the moon is made of cheese",
        "Alice went to the lobby and wave",
        "Bob has to be washed. Say hello.",
    ],
)
def test_remarks_alone_and_duties_are_no_background(sentence: str) -> None:
    assert understand(sentence, WARD).plan is None


@pytest.mark.parametrize(
    ("language", "sentence", "background", "last"),
    [
        (
            "de",
            "Ich höre schlecht. Stell die Lautstärke auf 80 Prozent.",
            "Ich höre schlecht",
            "80",
        ),
        ("de", "Ich suche meine Frau, sie heißt Alice. Kannst du sie finden?", "Alice", "Alice"),
        ("fr", "J'entends mal. Mets le volume à 80 pour cent.", "J'entends mal", "80"),
        ("fr", "J'ai froid, apporte-moi une couverture", "J'ai froid", "blanket"),
    ],
)
def test_in_every_language(language: str, sentence: str, background: str, last: str) -> None:
    words = {"de": ward_de.STATION, "fr": ward_fr.HOPITAL}[language]
    plan = understand(sentence, words, language).plan
    assert plan is not None
    assert background in "; ".join(plan.background)
    assert last in write_program(plan)


@pytest.mark.parametrize(
    ("language", "sentence"),
    [
        ("en", "Bring the cup to Alice, she is in the kitchen"),
        ("de", "Bring die Tasse zu Alice, sie ist in der Küche"),
        ("fr", "Apporte la tasse à Alice, elle est à la cuisine"),
    ],
)
def test_what_is_heeded_is_not_said_to_have_no_effect(language: str, sentence: str) -> None:
    words = {"en": WARD, "de": ward_de.STATION, "fr": ward_fr.HOPITAL}[language]
    plan = understand(sentence, words, language).plan
    assert plan is not None and 'place="kitchen"' in write_program(plan)
    assert plan.background == ()
