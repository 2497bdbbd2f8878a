"""Words that weigh, by language, and how words of a sentence and of a plan are compared.

The closed classes (negations, conditions, "every", "only", "until") are data of a language:
`weighty` in its data on speech.
"""

from __future__ import annotations

import functools
from collections.abc import Iterable, Iterator, Set
from dataclasses import dataclass

from grammar.coverage import same_word
from grammar.language import Language
from grammar.tokens import Token, without_accents


@dataclass(frozen=True)
class Weighty:
    """Words of a language that turn the sense of an order."""

    negations: frozenset[str]
    conditions: frozenset[str]
    otherwise: frozenset[str]
    exceptions: frozenset[str]
    """ "only", "except"."""
    rounds: frozenset[str]
    """ "every", "both"."""
    until: frozenset[str]
    twice: frozenset[str]
    """That something is done again."""
    speakers: frozenset[str]
    """Who speaks of themselves, and forbids nobody anything: "I can't find it"."""
    staying: frozenset[str]
    """What those say who say only where they are: "I'm waiting in the lab"."""


@functools.cache
def weighty(language: Language) -> Weighty:
    data = language.speech.get("weighty", {})

    def words(name: str) -> frozenset[str]:
        return frozenset(
            token for each in data.get(name, ()) for token in language.tokens_of(str(each))
        )

    return Weighty(
        *(words(name) for name in ("negations", "conditions", "otherwise", "exceptions")),
        *(words(name) for name in ("rounds", "until", "twice", "speakers", "staying")),
    )


@functools.cache
def idle(language: Language) -> frozenset[str]:
    """Words that ask for nothing in themselves: function words, fillers, courtesies."""
    fillers = {word for filler in language.fillers for word in filler}
    return language.closed | fillers | language.words_called("idle")


@functools.cache
def words_of_phrases(language: Language) -> frozenset[str]:
    """The words of all that the language lets the robot say by itself."""
    return frozenset(
        word for phrase in language.phrases.values() for word in words_of(phrase, language)
    )


def content(tokens: Iterable[Token], language: Language) -> Iterator[tuple[int, Token]]:
    """The tokens that are words with a sense of their own, with their places."""
    for at, token in enumerate(tokens):
        if token.kind in ("word", "verb") and token.norm not in idle(language):
            yield at, token


def forms(token: Token, language: Language) -> set[str]:
    """The ways in which a word may stand elsewhere: without accents, in its base form."""
    base = language.speech.get("base_forms", {})
    words = {token.norm, token.spelled or token.norm, str(base.get(token.norm, token.norm))}
    return {without_accents(word.lower()) for word in words}


def alike(words: Set[str], known: Set[str]) -> bool:
    """Whether one of some words, or a form of it, is among those known."""
    return not words.isdisjoint(known) or any(
        same_word(one, other) for one in words for other in known
    )


def words_of(text: str, language: Language) -> set[str]:
    """The words of a text, comparable with `forms`."""
    words = (without_accents(word.lower()) for word in language.tokens_of(text))
    return {word for word in words if word[:1].isalnum()}
