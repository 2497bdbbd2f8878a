"""Visitors answer the robot's questions, in more words than one or fewer than offered."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nl2robot.errors import UserError
from nl2robot.speech.audio import Audio, Samples, read
from nl2robot.speech.digits import classifier as digits
from nl2robot.speech.hear.answers import answer_in, expect, expected_by, hear_answer
from nl2robot.speech.hear.recogniser import Heard, Reading, Recogniser
from nl2robot.speech.hear.rescorer import Evidence, Judged, Opinion, SecondEar
from nl2robot.speech.hear.vocabulary import missing_words, number_words, spell_numbers
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
        ("i don't know", None),
        ("i do not know maybe", None),
        ("i am not sure", None),
        ("sure", "yes"),
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


@pytest.mark.parametrize(
    ("language", "said", "answer"),
    [
        ("en", "twenty three", "23"),
        ("en", "one hundred and five", "105"),
        ("en", "i think about a dozen", "12"),
        ("en", "none", "0"),
        ("en", "four zero seven", "407"),
        ("en", "two three hundred", None),
        ("en", "many", None),
        ("de", "einundzwanzig", "21"),
        ("de", "keine", "0"),
        ("fr", "quatre vingt dix neuf", "99"),
        ("fr", "une douzaine", "12"),
    ],
)
def test_numbers_are_answered_as_people_count(language: str, said: str, answer: str | None) -> None:
    assert expect("number", language).read(said) == answer


@pytest.mark.parametrize(
    ("language", "said", "answer"),
    [
        ("en", "at half past three please", "3:30"),
        ("en", "quarter to one", "0:45"),
        ("en", "noon", "12:00"),
        ("de", "um halb vier", "3:30"),
        ("de", "vierzehn uhr", "14:00"),
        ("fr", "trois heures et demie", "3:30"),
        ("fr", "midi", "12:00"),
        ("fr", "demain", None),
    ],
)
def test_times_of_day_are_answered_as_people_say_them(
    language: str, said: str, answer: str | None
) -> None:
    assert expect("times", language).read(said) == answer


@pytest.mark.parametrize(
    ("language", "question", "what"),
    [
        ("en", "How many chairs are there?", "number"),
        ("en", "How old are you?", "number"),
        ("en", "What is your phone number?", "digits"),
        ("en", "When shall I come back?", "times"),
        ("en", "Do you want tea?", "yes-no"),
        ("en", "Would you like tea or coffee?", ""),
        ("en", "What is your name?", ""),
        ("de", "Wie viele Stühle sind da?", "number"),
        ("de", "Um wie viel Uhr?", "times"),
        ("de", "Möchten Sie Tee?", "yes-no"),
        ("de", "Möchten Sie Tee oder Kaffee?", ""),
        ("de", "Wie heißen Sie?", ""),
        ("fr", "Combien de chaises y a-t-il ?", "number"),
        ("fr", "À quelle heure ?", "times"),
        ("fr", "Voulez-vous du thé ?", "yes-no"),
        ("fr", "Est-ce que tu as besoin d’aide ?", "yes-no"),
        ("fr", "Voulez-vous du thé ou du café ?", ""),
        ("fr", "Comment vous appelez-vous ?", ""),
    ],
)
def test_a_question_tells_what_is_expected(language: str, question: str, what: str) -> None:
    assert expected_by(question, None, language) == what
    if what:
        assert expect(what, language).phrases


def test_options_tell_more_than_the_question() -> None:
    assert expected_by("How many?", ["two", "three"], "en") == ["two", "three"]
    assert expected_by("Tee?", ["ja", "nein"], "de") == "yes-no"
    assert expected_by("Du thé ?", ["yes", "no"], "fr") == "yes-no"
    assert expected_by("Tea?", ["yes", "no", "later"], "en") == ["yes", "no", "later"]


def heard(*readings: tuple[str, float], doubtful: bool = False) -> Heard:
    return Heard(
        text=readings[0][0],
        confidence=0.9,
        words=(),
        doubtful=doubtful,
        free_text="big",
        readings=tuple(Reading(text, 0.0, doubtful, score) for text, score in readings),
        seconds_of_audio=1.0,
        seconds_taken=0.1,
    )


NOTHING = Audio(np.zeros(0, np.int16))


def test_when_two_answers_are_as_likely_the_robot_can_ask_which() -> None:
    expected = expect(WAYS, "en")
    answer = answer_in(heard(("pharmacy", 40.0), ("radiology", 39.9)), NOTHING, expected)
    assert answer.answer is None
    assert [way for way, _ in answer.likely] == ["pharmacy", "radiology"]
    assert sum(share for _, share in answer.likely) == pytest.approx(1)
    sure = answer_in(heard(("pharmacy", 40.0), ("radiology", 38.0)), NOTHING, expected)
    assert (sure.answer, sure.likely[0][0]) == ("pharmacy", "pharmacy")
    assert sure.confidence == pytest.approx(0.88, abs=0.01)


def test_what_sounded_like_something_else_can_still_be_asked_about() -> None:
    answer = answer_in(heard(("six", 40.0), doubtful=True), NOTHING, expect("number", "en"))
    assert (answer.heard, answer.answer, answer.confidence) == ("big", None, 0.0)
    assert answer.likely == (("6", 1.0),)


def test_their_sound_decides_between_digits_that_are_heard_alike(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A six whose last sound was lost is an eight to the recogniser."""

    class Ear:
        def shares(self, audio: Audio) -> dict[str, float] | None:
            return {"6": 0.98, "8": 0.02} if len(audio.samples) else None

    monkeypatch.setattr(digits, "load", lambda language: Ear())
    expected = expect("digits", "en")
    voice = Audio(np.ones(8000, np.int16))
    answer = answer_in(heard(("eight", 32.0), ("six", 31.6)), voice, expected)
    assert (answer.answer, [digit for digit, _ in answer.likely]) == ("6", ["6", "8"])
    rows = answer_in(heard(("eight eight", 32.0)), voice, expected)
    assert rows.answer == "88"  # for the recogniser alone
    assert answer_in(heard(("eight", 32.0)), NOTHING, expected).answer == "8"


class Sound:
    """An ear that hears this digit, whatever it is given."""

    def __init__(self, **shares: float) -> None:
        self._shares = {name.strip("_"): share for name, share in shares.items()}

    def shares(self, audio: Audio) -> dict[str, float] | None:
        return self._shares


def test_a_digit_without_its_edges_is_told_by_its_sound(monkeypatch: pytest.MonkeyPatch) -> None:
    """ "Six" without its end is "a" to who expects sentences, and "eight" to who expects digits."""
    monkeypatch.setattr(digits, "load", lambda language: Sound(_6=0.97, _8=0.02, _=0.01))
    judge = Judge(a=-1.4, eight=-2.1, six=-8.0)
    answer = answer_in(heard(("eight", 32.0)), NOTHING, expect("digits", "en"), judge)
    assert (answer.heard, answer.answer) == ("six", "6")
    nothing = heard(("", 0.0), doubtful=False)
    assert answer_in(nothing, NOTHING, expect("digits", "en"), judge).answer == "6"


def test_a_digit_that_sounds_like_another_is_asked_about(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(digits, "load", lambda language: Sound(_6=0.55, _8=0.44, _=0.01))
    judge = Judge(a=-1.4, eight=-2.1, six=-8.0)
    alike = heard(("six", 32.0), ("eight", 31.9))
    answer = answer_in(alike, NOTHING, expect("digits", "en"), judge)
    assert (answer.answer, [digit for digit, _ in answer.likely]) == (None, ["6", "8"])
    nothing = answer_in(heard(("", 0.0)), NOTHING, expect("digits", "en"), judge)
    assert (nothing.heard, nothing.answer, nothing.likely) == ("", None, ())


@pytest.mark.parametrize("judged", [{}, {"hello": -0.2, "zero": -14.0}])
def test_what_sounds_like_no_digit_is_none(
    judged: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    share = 0.05 if not judged else 0.95
    monkeypatch.setattr(digits, "load", lambda language: Sound(_0=share, _=1 - share))
    judge = Judge(**judged) if judged else None
    answer = answer_in(heard(("zero", 32.0)), NOTHING, expect("digits", "en"), judge)
    assert answer.answer is None


def test_several_digits_are_not_told_by_the_sound_of_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(digits, "load", lambda language: Sound(_4=1.0))
    judge = Judge(four_seven=-0.5, four=-6.0)
    answer = answer_in(heard(("four seven", 32.0)), NOTHING, expect("digits", "en"), judge)
    assert answer.answer == "47"


class Judge(SecondEar):
    """A second ear that thinks this of whatever it hears."""

    def __init__(self, **likelihoods: float) -> None:
        evidence = Evidence(1.0, 2, 3.0, True)
        self._readings = [
            Judged(text.replace("_", " "), likelihood, evidence)
            for text, likelihood in likelihoods.items()
        ]

    def hear(
        self, samples: Samples, phrases: Sequence[str], candidates: Iterable[str] = ()
    ) -> Opinion:
        return Opinion("good morning", tuple(self._readings))


def test_what_only_the_second_ear_hears_must_be_likely() -> None:
    expected = expect(WAYS, "en")
    unsure = heard(("pharmacy", 40.0), doubtful=True)
    sure = answer_in(unsure, NOTHING, expected, Judge(radiology=-0.5, pharmacy=-9.0))
    assert (sure.heard, sure.answer) == ("radiology", "radiology")
    hardly = answer_in(unsure, NOTHING, expected, Judge(radiology=-6.0, pharmacy=-12.0))
    assert (hardly.answer, hardly.likely[0][0]) == (None, "radiology")  # it can be asked about


def test_what_both_hear_is_taken_though_it_could_be_written_otherwise() -> None:
    """ "Tea" alone is freely a "d"."""
    tea = Judge(tea=-5.0, d=-0.5)
    answer = answer_in(heard(("tea", 40.0)), NOTHING, expect("tea, coffee", "en"), tea)
    assert answer.answer == "tea"
    alone = heard(("coffee", 40.0))
    assert answer_in(alone, NOTHING, expect("tea, coffee", "en"), tea).answer is None


def test_a_greeting_is_no_digit_though_the_recogniser_hears_one() -> None:
    judge = Judge(good_morning=-0.1, five=-9.5)
    answer = answer_in(heard(("five", 32.0)), NOTHING, expect("number", "en"), judge)
    assert (answer.heard, answer.answer) == ("good morning", None)


def test_a_number_among_other_words_is_none() -> None:
    """ "One handed" is what "one hundred" sounds like, and no one."""
    numbers = expect("number", "en")
    judge = Judge(one_handed=-1.9, one_hundred=-4.0, one=-7.5)
    answer = answer_in(heard(("one hundred", 32.0)), NOTHING, numbers, judge)
    assert (answer.heard, answer.answer) == ("one hundred", "100")
    hedged = answer_in(
        heard(("twelve", 32.0)), NOTHING, numbers, Judge(i_think_about_twelve=-0.9, twelve=-9.5)
    )
    assert hedged.answer == "12"


def test_everyday_words_are_an_answer_if_they_are_heard_freely_or_are_likely() -> None:
    """ "Look at that" is "okay" to an ear that only expects a yes or a no."""
    yes_no = expect("yes-no", "en")
    okay = heard(("okay", 40.0))  # freely "big"
    aside = answer_in(okay, NOTHING, yes_no, Judge(look_at_that=-2.6, okay=-7.8))
    assert (aside.heard, aside.answer) == ("look at that", None)
    likely = answer_in(okay, NOTHING, yes_no, Judge(oh_gay=-2.6, okay=-3.9))
    assert likely.answer == "yes"
    freely = replace(okay, free_text="okay then")
    sure = answer_in(freely, NOTHING, yes_no, Judge(look_at_that=-2.6, okay=-7.8))
    assert sure.answer == "yes"


def test_where_nothing_like_an_answer_is_heard_there_is_none() -> None:
    judge = Judge(good_morning=-0.1)
    answer = answer_in(heard(("pharmacy", 32.0)), NOTHING, expect(WAYS, "en"), judge)
    assert (answer.heard, answer.answer, answer.likely) == ("good morning", None, ())


@pytest.mark.parametrize("nothing", ["", " , ,"])
def test_nothing_to_choose_from_is_said(nothing: str) -> None:
    with pytest.raises(UserError, match="nothing to choose from"):
        expect(nothing, "en")


@pytest.mark.parametrize("language", ["en", "de", "fr"])
def test_each_language_has_its_yes_and_no(language: str) -> None:
    words = {
        "en": ("yes", "nope", "I have no idea"),
        "de": ("ja gerne", "nein danke", "das weiß ich nicht"),
        "fr": ("oui", "non merci", "je ne sais pas"),
    }
    yes, no, neither = words[language]
    assert expect("yes-no", language).read(yes) == "yes"
    assert expect("yes-no", language).read(no) == "no"
    assert expect("yes-no", language).read(neither) is None


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
