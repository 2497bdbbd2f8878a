"""Who gives an order may be elsewhere, and say so."""

from __future__ import annotations

import pytest

from grammar.language import load_language
from grammar.planning.turn import Turn
from grammar.planning.whereabouts import speakers_place
from nl2robot.knowledge import Knowledge
from nl2robot.translate.translation import translate
from sim.world.loading import load_world

WARD = Knowledge(load_world("ward", names_only=True))


def last_place(language: str, words: str) -> str:
    program = translate(words, WARD, language, "grammar").program
    assert program is not None
    return program.rsplit("goto(", 1)[1].split(")")[0]


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "Bring me the cup. I am waiting in the hallway."),
        ("en", "Tell Henry that lunch is on the table and come back. I'm in the hallway."),
        ("de", "Bring mir die Tasse, ich sitze im Flur."),
        ("fr", "Apporte-moi la tasse, je suis dans le couloir."),
    ],
)
def test_what_is_brought_comes_to_where_the_speaker_says_to_be(language: str, words: str) -> None:
    assert last_place(language, words) == '"corridor"'


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "Get the cup for me, we're in the hallway."),
        ("en", "I'm working in the hallway. Could you wait for Henry and then tell me?"),
        ("de", "Bring mir die Tasse, bin im Flur."),
    ],
)
def test_speakers_say_where_they_are_in_a_clause_of_its_own(language: str, words: str) -> None:
    turn = Turn(words, WARD.lexicon(language), load_language(language))
    place = speakers_place(turn)
    assert place is not None
    assert place.value == "corridor"


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "Bring me the cup from the hallway."),
        ("en", "Tell Henry that I am in the hallway, and come back."),
        ("de", "Sag Henry, ich bin im Flur, und komm zurück."),
    ],
)
def test_a_place_that_is_told_or_asked_for_is_not_where_the_speaker_is(
    language: str, words: str
) -> None:
    assert last_place(language, words) == "start"
