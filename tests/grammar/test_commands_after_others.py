"""A whole command that cannot be done says so, whatever waits; the one that waits is left alone."""

from __future__ import annotations

import pytest

from grammar.understand import understand
from nl2robot.knowledge import Knowledge
from sim.world.loading import load_world

BEFORE = {
    "en": "go to the pharmacy and say hello",
    "de": "geh zur Apotheke und sag hallo",
    "fr": "va à la pharmacie et dis bonjour",
}


@pytest.fixture(scope="module")
def knowledge() -> Knowledge:
    return Knowledge(load_world("city-hospital"))


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "take out the trash"),
        ("en", "remove the plates from the table"),
        ("en", "replace the batteries with new ones"),
        ("en", "delete my files"),
        ("en", "cut the bread"),
        ("de", "streich die Wand"),
        ("fr", "enlève les assiettes de la table"),
    ],
)
def test_a_command_of_its_own_is_told_why_it_cannot_be_done(
    knowledge: Knowledge, language: str, words: str
) -> None:
    lexicon = knowledge.lexicon(language)
    before = understand(BEFORE[language], lexicon, language)
    alone = understand(words, lexicon, language)
    after = understand(words, lexicon, language, before.context)
    assert (after.status, after.message) == ("rejected", alone.message)
    assert after.context.plan == before.plan  # it waits as it was


@pytest.mark.parametrize("words", ["no, paint the wall", "paint the wall instead"])
def test_a_correction_to_what_cannot_be_done_says_that_it_cannot(
    knowledge: Knowledge, words: str
) -> None:
    lexicon = knowledge.lexicon("en")
    before = understand(BEFORE["en"], lexicon, "en")
    after = understand(words, lexicon, "en", before.context)
    assert after.message == understand("paint the wall", lexicon, "en").message
    assert after.context.plan == before.plan


@pytest.mark.parametrize(
    ("language", "words", "told"),
    [
        (
            "en",
            "skip rope",
            "I understand “skip rope” neither as a command nor as a change to “go to the pharmacy"
            " and say hello”. Say the whole command once more, please.",
        ),
        (
            "de",
            "lass das Licht brennen",
            "„lass das Licht brennen“ verstehe ich weder als Befehl noch als Änderung von „geh zur"
            " Apotheke und sag hallo“. Bitte sagen Sie den ganzen Befehl noch einmal.",
        ),
        (
            "fr",
            "oublie la guerre",
            "Je ne comprends « oublie la guerre » ni comme une demande ni comme un changement à"
            " « va à la pharmacie et dis bonjour ». Redites toute la demande, s'il vous plaît.",
        ),
    ],
)
def test_what_may_be_either_is_not_taken_for_a_change(
    knowledge: Knowledge, language: str, words: str, told: str
) -> None:
    lexicon = knowledge.lexicon(language)
    before = understand(BEFORE[language], lexicon, language)
    after = understand(words, lexicon, language, before.context)
    assert (after.status, after.message) == ("rejected", told)


def test_a_change_is_still_one(knowledge: Knowledge) -> None:
    lexicon = knowledge.lexicon("en")
    before = understand(BEFORE["en"], lexicon, "en")
    without = understand("without the greeting", lexicon, "en", before.context)
    assert without.plan == understand("go to the pharmacy", lexicon, "en").plan
    what = understand("no, the cinema", lexicon, "en", before.context)
    assert what.message == (
        "I do not know what “the cinema” should change. Say the whole command once more, please."
    )
