"""Who wants another language asks for it in that one."""

import pytest

from grammar.language import known_by_word, languages
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.translation import translate
from sim.world import load_world

KNOWLEDGE = Knowledge(load_world(DEFAULT_WORLD))


@pytest.mark.parametrize(
    ("language", "said", "asked_for"),
    [
        ("en", "sprich Deutsch", "de"),
        ("en", "Deutsch bitte", "de"),
        ("en", "sprich Französisch", "fr"),
        ("fr", "speak German", "de"),
        ("en", "en français s'il te plaît", "fr"),
        ("de", "speak English please", "en"),
        ("de", "auf Englisch bitte", "en"),
        ("fr", "English please", "en"),
        ("fr", "können wir Deutsch reden?", "de"),
    ],
)
def test_a_visitor_asks_for_their_own_language(language, said, asked_for) -> None:
    translation = translate(said, KNOWLEDGE, language)
    assert translation.status == "ok"
    assert translation.program == f'robot.set_language("{asked_for}")\n'


@pytest.mark.parametrize("said", ["fahr in die Deutsch", "geh zur Lobby und sprich Deutsch"])
def test_nothing_else_is_understood_in_another_language(said) -> None:
    assert translate(said, KNOWLEDGE, "en").program is None


@pytest.mark.parametrize("language", ["en", "de", "fr"])
@pytest.mark.parametrize(
    "cry", ["stop!", "halt", "freeze", "stopp", "anhalten!", "arrête", "arrêtez-vous !"]
)
def test_a_cry_of_stop_is_heard_in_every_language(language, cry) -> None:
    assert translate(cry, KNOWLEDGE, language).program == "robot.stop()\n"


def test_every_language_is_known_by_its_name() -> None:
    named = {"en": "speak English", "de": "sprich Deutsch", "fr": "parle français"}
    for code in languages():
        assert code in known_by_word(named[code])


@pytest.mark.parametrize(
    ("language", "said", "told"),
    [
        ("de", "sprich Englisch und sag Alice, wenn du fertig bist", "I have finished."),
        ("de", "sprich Französisch und sag mir, wenn du fertig bist", "J'ai terminé."),
        ("de", "sprich Englisch und richte Alice einen schönen Gruß aus", "kind regards"),
        ("en", "speak German and give Alice my regards", "einen schönen Gruß"),
        ("fr", "parle anglais et remercie Alice", "Thank you."),
    ],
)
def test_what_it_has_ready_is_said_in_the_language_it_is_to_speak(language, said, told) -> None:
    program = translate(said, KNOWLEDGE, language).program
    assert program is not None
    assert told in program
