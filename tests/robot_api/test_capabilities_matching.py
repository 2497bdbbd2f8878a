"""What people answer on a ward, and which of the options they mean."""

from __future__ import annotations

import doctest

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from robot_api.capabilities import languages, matching
from robot_api.capabilities.languages import fold, known_languages, language_data
from robot_api.capabilities.matching import match_answer, match_question

PLACES = ["radiology", "pharmacy"]
YES_NO = ["yes", "no"]
PAIN = [str(number) for number in range(11)]
ROOMS = ["room 2", "room 3"]
DRINKS = ["coffee", "coffee with milk", "tea"]


@pytest.mark.parametrize(
    ("heard", "options", "meant"),
    [
        ("radiology", PLACES, "radiology"),
        ("to the radiology please", PLACES, "radiology"),
        ("I'd like to go to the PHARMACY, thank you.", PLACES, "pharmacy"),
        ("pharmacies", PLACES, "pharmacy"),
        ("farmacy", PLACES, None),
        ("pharmacie", PLACES, "pharmacy"),
        ("radio logy", PLACES, "radiology"),
        ("no, the pharmacy", PLACES, "pharmacy"),
        ("intensive care", ["intensive care unit", "ward a"], "intensive care unit"),
        ("alice office", ["Alice's office", "Bob's office"], "Alice's office"),
        ("coffee", DRINKS, "coffee"),
        ("a coffee with milk please", DRINKS, "coffee with milk"),
        ("anna", ["Anna", "Hanna"], "Anna"),
        ("the right one", ["left", "right"], "right"),
        ("no smoking please", ["smoking", "no smoking"], "no smoking"),
        ("without sugar", ["with sugar", "without sugar"], "without sugar"),
    ],
)
def test_an_answer_in_ones_own_words(heard: str, options: list[str], meant: str | None) -> None:
    assert match_answer(heard, options) == meant


@pytest.mark.parametrize(
    ("heard", "options", "meant"),
    [
        ("2", PAIN, "2"),
        ("seven", PAIN, "7"),
        ("number ten please", PAIN, "10"),
        ("I would say seven", PAIN, "7"),
        ("two", ["one", "two", "three"], "two"),
        ("2", ["one", "two", "three"], "two"),
        ("two", ["3", "2", "1"], "2"),
        ("two", ROOMS, "room 2"),
        ("room three", ROOMS, "room 3"),
        ("one oh two", ["102", "103"], "102"),
        ("twenty one", ["21", "20", "1"], "21"),
        ("two", PLACES, "pharmacy"),
        ("option one", PLACES, "radiology"),
        ("the second one", PLACES, "pharmacy"),
        ("the last one", PLACES, "pharmacy"),
        ("the second one", PAIN[1:], "2"),
    ],
)
def test_one_word_numbers_are_understood(heard: str, options: list[str], meant: str) -> None:
    """The paper's robot did not recognise an answer that was only a number."""
    assert match_answer(heard, options) == meant


@pytest.mark.parametrize(
    ("heard", "meant"),
    [
        ("yeah", "yes"),
        ("sure, why not", "yes"),
        ("yes please", "yes"),
        ("no problem", "yes"),
        ("of course not", "no"),
        ("not really", "no"),
        ("no thanks", "no"),
        ("I don't think so", "no"),
        ("yes and no", None),
        ("I don't know", None),
        ("maybe", None),
        ("yes, but not today", None),
        ("I have no idea", None),
        ("purple", None),
    ],
)
def test_the_ways_to_say_yes_and_no(heard: str, meant: str | None) -> None:
    assert match_answer(heard, YES_NO) == meant


@pytest.mark.parametrize(
    ("heard", "options"),
    [
        ("radiology or pharmacy", PLACES),
        ("pharmacie or radiology", PLACES),
        ("not the pharmacy", PLACES),
        ("milk", ["coffee with milk", "tea with milk"]),
        ("office", ["Alice's office", "Bob's office"]),
        ("unhappy", ["happy", "sad"]),
        ("yes", ["left", "right"]),
        ("one", ROOMS),
        ("three", PLACES),
        ("zero", PLACES),
        ("that one", PLACES),
        ("the second", ["1", "3", "2"]),
        ("two or three", PAIN),
        ("Radiology", ["RADIOLOGY", "radiologY"]),
        ("please", PLACES),
        ("", PLACES),
        ("...", PLACES),
        ("yes", []),
    ],
)
def test_nothing_is_guessed(heard: str, options: list[str]) -> None:
    assert match_answer(heard, options) is None


@pytest.mark.parametrize(
    ("language", "heard", "options", "meant"),
    [
        ("de", "ja gerne", YES_NO, "yes"),
        ("de", "lieber nicht", ["Ja", "Nein"], "Nein"),
        ("de", "zur Apotheke bitte", ["Apotheke", "Röntgen"], "Apotheke"),
        ("de", "in die Röntgenabteilung", ["Apotheke", "Röntgen"], "Röntgen"),
        ("de", "die zweite", ["Apotheke", "Röntgen"], "Röntgen"),
        ("de", "nicht in die Apotheke", ["Apotheke", "Röntgen"], None),
        ("de", "zwo", PAIN, "2"),
        ("de", "einundzwanzig", ["12", "21"], "21"),
        ("de-CH", "drei", ["two", "three"], "three"),
        ("fr", "oui, volontiers", YES_NO, "yes"),
        ("fr", "pas du tout", ["oui", "non"], "non"),
        ("fr", "à l'hôpital, s'il vous plaît", ["l'hôpital", "la pharmacie"], "l'hôpital"),
        ("fr", "quatre-vingt-dix-sept", ["17", "97"], "97"),
        ("fr", "la première", ["la radiologie", "la pharmacie"], "la radiologie"),
        ("xx", "radiology", PLACES, "radiology"),
    ],
)
def test_other_languages(language: str, heard: str, options: list[str], meant: str | None) -> None:
    assert match_answer(heard, options, language) == meant


@pytest.mark.parametrize(
    ("heard", "which"),
    [
        ("When is lunch?", 0),
        ("could you tell me when lunch is please", 0),
        ("where are the toilets", 1),
        ("where can I find the toilet", 1),
        ("I need the restroom", None),
        ("when does the pharmacy open", None),
        ("where is lunch", None),
        ("hello", None),
        ("", None),
    ],
)
def test_a_prepared_question_is_recognised(heard: str, which: int | None) -> None:
    questions = [["When is lunch?", "What time is lunch served?"], ["Where are the toilets?"]]
    assert match_question(heard, questions) == which


def test_two_prepared_questions_that_fit_alike_are_not_guessed_between() -> None:
    assert match_question("where is the ward", [["Where is the ward?"], ["where is ward"]]) is None


def test_the_examples_in_the_documentation() -> None:
    for module in (matching, languages):
        assert doctest.testmod(module).failed == 0


def test_every_language_has_its_numbers() -> None:
    for code in known_languages():
        words = language_data(code)
        assert set(range(101)) <= set(words.numbers.values()), code
        assert set(range(1, 21)) <= set(words.ordinals.values()), code
        for number in range(101):
            spoken = next(words for words, value in words.numbers.items() if value == number)
            options = [str(number), str(number + 1)]
            assert match_answer(" ".join(spoken), options, code) == str(number)


# --- properties ----------------------------------------------------------------------------------

_words = st.sampled_from(
    ["radiology", "pharmacy", "ward", "office", "cafeteria", "kitchen", "library", "chapel"]
)
_option = st.lists(_words, min_size=1, max_size=3, unique=True).map(" ".join)
_options = st.lists(_option, min_size=1, max_size=6, unique=True)
_filler = st.sampled_from(["please", "to the", "I would like", "well", "thank you"])
_text = st.text(max_size=40)


@settings(max_examples=150, deadline=None)
@given(
    _text,
    st.lists(st.text(min_size=1, max_size=20), max_size=5),
    st.sampled_from(["en", "de", "fr"]),
)
def test_the_answer_is_one_of_the_options_or_none(
    heard: str, options: list[str], language: str
) -> None:
    assert match_answer(heard, options, language) in {*options, None}


@settings(max_examples=100, deadline=None)
@given(st.lists(st.text(min_size=1, max_size=20), min_size=1, max_size=5))
def test_an_option_word_for_word_is_that_option(options: list[str]) -> None:
    assert [match_answer(option, options) for option in options] == options


@settings(max_examples=150, deadline=None)
@given(_options, st.data(), _filler, _filler)
def test_politeness_case_and_punctuation_do_not_count(
    options: list[str], data: st.DataObject, before: str, after: str
) -> None:
    option = data.draw(st.sampled_from(options))
    assert match_answer(f"{before} {option.upper()}, {after}!", options) in (
        [option] if _alone(option, options) else [option, None]
    )


def _alone(option: str, options: list[str]) -> bool:
    """Whether no other option has the same words in another order."""
    return not any(other != option and set(fold(other)) == set(fold(option)) for other in options)


@settings(max_examples=150, deadline=None)
@given(_options, st.data())
def test_the_order_of_the_options_does_not_count(options: list[str], data: st.DataObject) -> None:
    heard = data.draw(_option)
    shuffled = data.draw(st.permutations(options))
    assert match_answer(heard, options) == match_answer(heard, shuffled)


@settings(max_examples=100, deadline=None)
@given(_option, _option)
def test_whoever_names_two_options_has_chosen_none(one: str, other: str) -> None:
    assume(not set(one.split()) & set(other.split()))
    assert match_answer(f"{one} or {other}", [one, other]) is None


@settings(max_examples=100, deadline=None)
@given(_options, st.data())
def test_whoever_refuses_an_option_has_not_chosen_it(
    options: list[str], data: st.DataObject
) -> None:
    option = data.draw(st.sampled_from(options))
    assert match_answer(f"not the {option}", options) is None
