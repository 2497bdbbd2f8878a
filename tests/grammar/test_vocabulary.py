"""The recogniser hears the words that the grammar and the world can say."""

from __future__ import annotations

from grammar.samples import samples
from grammar.vocabulary import vocabulary
from tests.grammar.ward import WARD


def test_names_numbers_and_commands_are_among_the_words() -> None:
    words = vocabulary(WARD)
    assert {"pharmacy", "drugstore", "miller", "twelve", "bring", "otherwise", "offices"} <= {
        *words
    }
    assert words == sorted(set(words))
    assert all(word == word.lower() and " " not in word for word in words)


def test_all_words_of_the_help_can_be_heard() -> None:
    words = set(vocabulary(WARD))
    for phrases in samples(WARD).values():
        for phrase in phrases:
            spoken = {word.strip(",.?") for word in phrase.lower().split()}
            assert {word for word in spoken if word.isalpha()} <= words, phrase
