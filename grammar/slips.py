"""Slips of the keyboard, and forms of politeness, put right before a sentence is parsed.

"gothe" and "tothe" are two words, and after "would you mind" a command stands in its -ing form.
What tokens mean changes, never where they stand: free text is still taken from the original.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from typing import Final

from grammar.language import Language
from grammar.tokens import COMMA, Token

SHORTEST_JOINED: Final = 4
"""Letters of two words that a space is missing between."""
LONG_ENOUGH: Final = 5
"""Letters of a word that others may be run into: "laccueil", but "lait" is milk."""
VOWELS: Final = frozenset("aeiouy")
"""What a word may begin with that another is elided before."""


def mended(
    tokens: tuple[Token, ...],
    language: Language,
    known: Collection[str],
    verbs: Collection[str],
) -> tuple[Token, ...]:
    """The tokens with joined words parted and verbs in their plain forms."""
    parted = [part for token in tokens for part in _parted(token, language, known)]
    return tuple(_plain(parted, language, verbs))


def _parted(token: Token, language: Language, known: Collection[str]) -> list[Token]:
    """ "tothe" as "to the": two words of which one is a little word of the language."""
    word = token.norm
    if token.kind != "word" or word in known:
        return [token]
    for cut in (len(each) for each in language.speech.get("elided", ()) if word.startswith(each)):
        rest = word[cut:]
        if rest[:1] in VOWELS and len(rest) >= LONG_ENOUGH and rest in known:  # "laccueil"
            return _cut(token, cut)
    if token.capital or len(word) < SHORTEST_JOINED:
        return [token]
    little = language.speech.get("joined_to", ())
    for cut in range(2, len(word) - 1):
        first, second = word[:cut], word[cut:]
        if first in known and second in known and (first in little or second in little):
            return _cut(token, cut)
    return [token]


def _cut(token: Token, cut: int) -> list[Token]:
    """A token as two, the second of which begins after so many letters."""
    middle = token.start + cut
    return [
        replace(token, norm=token.norm[:cut], end=middle),
        replace(token, norm=token.norm[cut:], start=middle),
    ]


def _plain(tokens: list[Token], language: Language, verbs: Collection[str]) -> Iterator[Token]:
    """After "would you mind", "bringing me the cup and taking it away" is "bring ... and take"."""
    after = language.speech.get("gerund_after", ())
    joins = {COMMA, *language.speech.get("joins", ())}
    begun = False
    for position, token in enumerate(tokens):
        before = tokens[position - 1].norm if position else ""
        begun = begun or before in after
        if begun and (before in after or before in joins):
            base = next((each for each in _bases(token.norm, language) if each in verbs), None)
            yield replace(token, norm=base) if base is not None else token
        else:
            yield token


def _bases(word: str, language: Language) -> Iterator[str]:
    """What a verb in its -ing form may be in its plain one: "putting" -> "put"."""
    for ending, *endings in language.speech.get("gerund_endings", ()):
        if word.endswith(ending) and len(word) > len(ending) + 1:
            stem = word[: -len(ending)]
            yield from (stem + each for each in endings)
            if stem[-1] == stem[-2]:
                yield stem[:-1]
