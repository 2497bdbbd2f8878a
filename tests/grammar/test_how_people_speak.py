"""How people speak to a robot: what they call before an order, begin anew, and add to a message."""

from __future__ import annotations

import pytest

from grammar.language import load_language
from tests.grammar.test_kinds import program, said

GO = {"en": "go to the pharmacy", "de": "fahr zur Apotheke", "fr": "va à la pharmacie"}
CALLS = {
    "en": ["Say, could you {}?", "You know what, {}", "Hang on, tell me, can you {}?"],
    "de": ["Sag mal, {}", "Hören Sie, {}", "Pass auf, {}", "Übrigens, {}"],
    "fr": ["Dites donc, {}", "Dis voir, {}", "Tiens, {}", "Au fait, {}"],
}


@pytest.mark.parametrize(
    ("language", "call"), [(each, call) for each, calls in CALLS.items() for call in calls]
)
def test_what_is_called_before_an_order_is_no_part_of_it(language: str, call: str) -> None:
    assert program(language, call.format(GO[language])) == 'robot.goto("pharmacy")\n'


WAIT = {"en": "wait {} seconds", "de": "warte {} Sekunden", "fr": "attends {} secondes"}
FIRST = {"en": "wait", "de": "warte", "fr": "attends"}


@pytest.mark.parametrize("language", WAIT)
def test_words_that_are_begun_anew_after_a_hesitation_are_said_once(language: str) -> None:
    order = WAIT[language].format(30)
    for hesitation in sorted(load_language(language).words_called("hesitations")):
        for begun in (f"{FIRST[language]} {hesitation}", f"{FIRST[language]}, {hesitation},"):
            assert program(language, f"{begun} {order}") == "robot.wait(30)\n", begun
    two_words = " ".join(GO[language].split()[:2])
    assert program(language, f"{two_words} {GO[language]}") == 'robot.goto("pharmacy")\n'


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "tell Bob the meeting is at noon; leave the others alone"),
        ("en", "tell Bob that we start now; leave the others alone"),
        ("de", "sag Bob, dass wir anfangen; die anderen lass in Ruhe"),
        ("fr", "dis à Bob que nous commençons ; laisse les autres tranquilles"),
    ],
)
def test_what_is_told_ends_where_its_sentence_does(language: str, words: str) -> None:
    assert said(language, words).program is None


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "wish me good night when we are there"),
        ("en", "say good night as soon as we arrive"),
        ("fr", "souhaite-moi bonne nuit quand on sera dans le hall"),
    ],
)
def test_when_it_is_wished_is_no_part_of_the_wish(language: str, words: str) -> None:
    assert "say" not in (said(language, words).program or "")


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "tell Bob that the uh the taxi is here"),
        ("de", "sag Bob, dass das äh das Taxi da ist"),
        ("fr", "dis à Bob que euh son taxi est là"),
    ],
)
def test_nobody_is_told_how_somebody_hesitated(language: str, words: str) -> None:
    found = said(language, words).program or ""
    assert not load_language(language).words_called("hesitations") & set(found.split())


BORROWED = {
    "en": ("Ask Bob if {} can borrow the stapler. If yes, bring it to me.", ["I", "we"]),
    "de": ("Frag Bob, ob {} den Locher haben {}. Wenn ja, bring ihn mir.", ["ich", "wir"]),
    "fr": ("Demande à Bob si {} {} emprunter l'agrafeuse. Si oui, apporte-la-moi.", ["je", "on"]),
}
CAN = {"ich": "kann", "wir": "können", "je": "peux", "on": "peut"}
THING = {"en": "stapler", "de": "Locher", "fr": "agrafeuse"}


@pytest.mark.parametrize("language", BORROWED)
def test_what_somebody_may_borrow_is_what_is_brought(language: str) -> None:
    words, speakers = BORROWED[language]
    for speaker in speakers:
        found = program(language, words.format(speaker, CAN.get(speaker)))
        assert f'robot.grab("{THING[language]}")' in found


def test_whose_it_is_in_a_question_is_not_to_whom() -> None:
    assert "Darf ich Ihr Buch haben?" in program("de", "frag Alice, ob ich ihr Buch haben darf")


def test_whoever_was_only_asked_is_not_led_anywhere() -> None:
    found = program("en", "Ask Bob whether he is ready. If he is, go on to the lobby.")
    assert "guide" not in found


def test_a_yes_with_an_order_behind_it_is_more_than_a_yes() -> None:
    """Words that the rules cannot read are not dropped because an answer stands before them."""
    words = "ask Bob if I can borrow the stapler. if yes xyzzy it to me here in the lobby"
    assert said("en", words).program is None
