"""The recogniser hears German words as they are spelled, not as they are compared."""

from __future__ import annotations

from grammar.samples import samples
from grammar.vocabulary import vocabulary
from tests.grammar.ward_de import STATION


def test_words_are_spelled_as_people_write_them() -> None:
    words = set(vocabulary(STATION, "de"))
    assert {"küche", "apotheke", "fünf", "fährt", "abholen", "müller", "büros"} <= words
    assert not words & {"kueche", "fuenf", "mueller", "akk", "dat"}


def test_all_words_of_the_help_can_be_heard() -> None:
    words = set(vocabulary(STATION, "de"))
    for phrases in samples(STATION, "de").values():
        for phrase in phrases:
            spoken = {word.strip(",.?") for word in phrase.lower().split()}
            missing = {word for word in spoken if word.isalpha()} - words
            assert missing <= {"zur", "zum", "im"}, phrase
