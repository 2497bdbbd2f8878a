"""Visitors answer the robot's questions, in more words than one or fewer than offered."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nl2robot.errors import UserError
from nl2robot.speech.answers import expect, hear_answer
from nl2robot.speech.audio import Audio, read
from nl2robot.speech.recogniser import Recogniser
from nl2robot.speech.vocabulary import missing_words, number_words, spell_numbers
from tests.speech.conftest import RECORDED, SHOWN

WAYS = "radiology, pharmacy, intensive care unit"
DRINKS = ["tea", "green tea", "coffee", "water"]


@pytest.mark.parametrize(
    ("said", "answer"),
    [
        ("yes", "yes"),
        ("yes please", "yes"),
        ("of course", "yes"),
        ("i do", "yes"),
        ("i do not", "no"),
        ("no thank you", "no"),
        ("yes no", None),
        ("", None),
    ],
)
def test_yes_and_no_come_in_many_words(said: str, answer: str | None) -> None:
    assert expect("yes-no", "en").read(said) == answer


@pytest.mark.parametrize(
    ("said", "answer"),
    [
        ("pharmacy", "pharmacy"),
        ("to the pharmacy please", "pharmacy"),
        ("i would like to go to the intensive care unit", "intensive care unit"),
        ("intensive care", "intensive care unit"),
        ("care", None),  # too little of it
        ("radiology pharmacy", None),
        ("the please", None),
    ],
)
def test_an_option_is_found_in_what_is_said(said: str, answer: str | None) -> None:
    assert expect(WAYS, "en").read(said) == answer


def test_the_longer_of_two_options_wins() -> None:
    drinks = expect(DRINKS, "en")
    assert drinks.read("green tea please") == "green tea"
    assert drinks.read("tea please") == "tea"
    assert drinks.read("green tea coffee") is None


def test_options_come_back_exactly_as_they_were_given() -> None:
    options = expect(["Dr. Weber", "Room 12", "X-ray", "21"], "en")
    assert options.read("dr weber please") == "Dr. Weber"
    assert options.read("room twelve") == "Room 12"
    assert options.read("the x-ray") == "X-ray"
    assert options.read("twenty one") == "21"


def test_digits_may_come_in_a_row() -> None:
    assert expect("digits", "en").read("four zero seven") == "407"
    assert expect("digits", "de").read("drei") == "3"
    assert expect("digits", "fr").read("") is None


@settings(max_examples=50, deadline=None)
@given(st.integers(0, 10**6))
def test_every_number_of_digits_comes_back(number: int) -> None:
    said = " ".join(number_words(digit, "en") for digit in str(number))
    assert expect("digits", "en").read(said) == str(number)


@settings(max_examples=50, deadline=None)
@given(st.text(alphabet="abc éß-'12 ", max_size=30))
def test_whatever_is_heard_the_answer_is_an_option_or_none(said: str) -> None:
    assert expect("a, b c, é-12", "en").read(said) in {"a", "b c", "é-12", None}


@pytest.mark.parametrize("nothing", ["", " , ,"])
def test_nothing_to_choose_from_is_said(nothing: str) -> None:
    with pytest.raises(UserError, match="nothing to choose from"):
        expect(nothing, "en")


@pytest.mark.parametrize("language", ["en", "de", "fr"])
def test_each_language_has_its_yes_and_no(language: str) -> None:
    words = {"en": ("yes", "nope"), "de": ("ja gerne", "nein danke"), "fr": ("oui", "non merci")}
    yes, no = words[language]
    assert expect("yes-no", language).read(yes) == "yes"
    assert expect("yes-no", language).read(no) == "no"


# ── with the real model ──────────────────────────────────────────────────────────────────────


def test_answers_are_heard(recogniser: Recogniser) -> None:
    digit = hear_answer(recogniser, read(RECORDED / "seven.wav"), expect("digits", "en"))
    assert (digit.heard, digit.answer) == ("seven", "7")
    assert digit.confidence > 0.5
    yes = hear_answer(recogniser, read(RECORDED / "yes-please.wav"), expect("yes-no", "en"))
    assert yes.answer == "yes"
    way = hear_answer(recogniser, read(RECORDED / "to-the-pharmacy-please.wav"), expect(WAYS, "en"))
    assert way.answer == "pharmacy"


@pytest.mark.parametrize("expected", ["digits", "yes-no", WAYS])
def test_a_remark_is_no_answer(recogniser: Recogniser, expected: str) -> None:
    answer = hear_answer(recogniser, read(RECORDED / "chatter.wav"), expect(expected, "en"))
    assert answer.answer is None
    assert answer.confidence == 0.0
    assert "out of paper" in answer.heard


def test_a_command_is_no_digit(recogniser: Recogniser) -> None:
    answer = hear_answer(recogniser, read(SHOWN / "visitor.wav"), expect("digits", "en"))
    assert answer.answer is None


def test_silence_is_no_answer(recogniser: Recogniser) -> None:
    silence = Audio(np.zeros(16_000, np.int16))
    answer = hear_answer(recogniser, silence, expect("yes-no", "en"))
    assert (answer.heard, answer.answer, answer.confidence) == ("", None, 0.0)


# ── words that can never be heard ────────────────────────────────────────────────────────────


def test_names_the_model_does_not_know_are_told_with_a_way_round(recogniser: Recogniser) -> None:
    names = ["pharmacy", "Nwankwo's office", "orthopaedics", "x-ray", "ward 3", "stairlobby"]
    missing = {each.word: each for each in missing_words(recogniser, names)}
    assert set(missing) == {"Nwankwo's", "orthopaedics", "stairlobby"}
    assert missing["orthopaedics"].alike == "orthopedics"
    assert missing["stairlobby"].alike == "stair lobby"
    assert "“orthopedics”" in missing["orthopaedics"].message
    assert "alias that sounds alike" in missing["Nwankwo's"].message


def test_numerals_are_spoken_as_words() -> None:
    assert spell_numbers("ward 3b, room 21", "en") == "ward three b, room twenty one"
    assert spell_numbers("Zimmer 21", "de") == "Zimmer einundzwanzig"
    assert spell_numbers("no number", "en") == "no number"
    assert number_words("2.5", "en") == "two point five"
