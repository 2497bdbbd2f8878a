"""Words to speak are told from orders, in every language; nothing that is no command is obeyed."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from grammar.language import languages
from grammar.understand import understand
from tests.grammar.hospitals import hospital
from tests.grammar.ward import WARD, program

HERE = Path(__file__).parent
ACCEPTED_AT_MOST = 0.01
"""Of the sentences that are no commands."""


@pytest.mark.parametrize("language", languages())
def test_what_is_no_command_moves_no_robot(language: str) -> None:
    obeyed: list[str] = []
    total = 0
    for file in sorted(HERE.glob(f"not_commands_{language}*.yaml")):
        rows = yaml.load(file.read_text(encoding="utf-8"), Loader=yaml.BaseLoader)
        for sentence in (each for topic in rows.values() for each in topic):
            understood = understand(sentence, hospital(language), language)
            total += 1
            assert understood.message or understood.plan or understood.request
            if understood.plan is not None:
                obeyed.append(f"{sentence}: {program(understood.plan)}")
    assert len(obeyed) <= ACCEPTED_AT_MOST * total, "\n".join(obeyed)


@pytest.mark.parametrize(
    ("sentence", "doubted"),
    [
        ("say good morning and peel an orange", "and peel an orange"),
        ("say 3, 2, 1, happy new year, in the lobby", "in the lobby"),
        ("say that visiting hours are over and throw everybody out", "and throw everybody out"),
        ("tell Bob to leave and mop up behind him", "and mop up behind him"),
        ('say "welcome" and hum a tune', "and hum a tune"),
        ("say hello in the gym", "in the gym"),
        ("say hello backwards", "backwards"),
        ("tell Bob the gist", "the gist"),
        ("say lunch when you are back", "when you are back"),
        ("show the text please wait here and paint the wall", "and paint the wall"),
    ],
)
def test_what_may_not_be_meant_as_text_is_named(sentence: str, doubted: str) -> None:
    understood = understand(sentence, WARD)
    assert understood.status == "rejected", understood.plan and program(understood.plan)
    assert understood.unclear == doubted


@pytest.mark.parametrize(
    "sentence",
    [
        "ask Bob if he wants coffee and brew it for him",
        "tell Bob who broke it",
        "say the sum when you are back",
    ],
)
def test_what_would_have_to_be_found_out_is_not_said(sentence: str) -> None:
    understood = understand(sentence, WARD)
    assert understood.plan is None, program(understood.plan)


@pytest.mark.parametrize(
    ("sentence", "said"),
    [
        ("say bread and butter", "Bread and butter."),
        ("say sit down and relax", "Sit down and relax."),
        ("say good night and sleep well", "Good night and sleep well."),
        (
            "say good morning everyone and welcome to the tour",
            "Good morning everyone and welcome to the tour.",
        ),
        (
            "announce that the cafeteria is closed and the soup is cold",
            "The cafeteria is closed and the soup is cold.",
        ),
        ("say that you can sit down and paint a picture", "You can sit down and paint a picture."),
        ("say what a lovely day", "What a lovely day."),
        (
            "say that the doctor is here and wants a coffee",
            "The doctor is here and wants a coffee.",
        ),
        ("say I am sorry", "I am sorry."),
    ],
)
def test_what_is_meant_as_text_is_said(sentence: str, said: str) -> None:
    understood = understand(sentence, WARD)
    assert understood.plan is not None, understood.message
    assert program(understood.plan) == f'say("{said}")'


def test_quotation_marks_settle_it() -> None:
    understood = understand("tell Bob lunch", WARD)
    assert understood.suggestions == ['tell Bob "lunch"']
    assert understand(understood.suggestions[0], WARD).plan is not None
