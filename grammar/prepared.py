"""The words of a sentence, ready to be read: its tokens, slips mended, and their chart.

A sentence that is not understood at once is tried in several ways, and parts of it again and
again; each wording is prepared, and charted, only once in that time.
"""

from __future__ import annotations

import functools
import threading
from typing import Final

from grammar.chart import CORRECTION, Chart
from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.names import Names, names_of
from grammar.slips import command_words, fillers_by_first, mended, perfects, spellings, swapped_back
from grammar.slots import Slots
from grammar.tokens import COMMA, tokenise

COMMA_PASSED_OVER: Final = 1.5
FILLER_PASSED_OVER: Final = 0.1
FALSE_START: Final = 0.5
MOST_BEGUN: Final = 3
"""Words with which somebody begins and, after a hesitation, begins anew."""
MOST_KEPT: Final = 64
"""Wordings of one sentence that are remembered at once."""


class Prepared:
    """Some words in a language and a world."""

    def __init__(self, text: str, lexicon: Lexicon, language: Language) -> None:
        self.lexicon = lexicon
        self.language = language
        self.names: Names = names_of(language, lexicon)
        known = self.names.known
        commands = command_words(language)
        self.text, self.slips = swapped_back(text, language, known)
        self.tokens = mended(tokenise(self.text, language.spelling), language, known, commands)
        self.corrections = spellings(self.tokens, language, lexicon)
        self.skips = self._skips()
        self.forms = dict(perfects(self.tokens, language, commands))

    @functools.cached_property
    def slots(self) -> Slots:
        return Slots(self.names, self.tokens, self.corrections)

    @functools.cached_property
    def chart(self) -> Chart:
        return Chart(
            self.language.network,
            self.tokens,
            self.slots,
            skips=self.skips,
            corrections=self.corrections,
            forms=self.forms,
        )

    def _skips(self) -> dict[int, list[tuple[int, float]]]:
        """Where words may be passed over: fillers, and commas that no rule asks for."""
        skips: dict[int, list[tuple[int, float]]] = {}
        words = [token.norm for token in self.tokens]
        perfect = self.language.speech.get("perfects", {})
        for at, token in enumerate(self.tokens):
            parted = at and words[at - 1] in perfect.get("parted_by", ())
            if parted and token.norm in perfect["after"]:  # "quand tu l'as saluée"
                skips.setdefault(at, []).append((at + 1, FILLER_PASSED_OVER))
            said_twice = words[max(0, at - 2) : at].count(token.norm) == 1 and token.kind == "word"
            said_twice = said_twice and words[at - 1] == token.norm
            if token.norm == COMMA or said_twice:
                skips.setdefault(at, []).append((at + 1, COMMA_PASSED_OVER))
            for filler in fillers_by_first(self.language).get(token.norm, ()):
                if tuple(words[at : at + len(filler)]) == filler:
                    skips.setdefault(at, []).append((at + len(filler), FILLER_PASSED_OVER))
            if any((other,) in self.language.fillers for other in self.corrections.get(at, ())):
                skips.setdefault(at, []).append((at + 1, CORRECTION))  # "pleas"
            again = self._begun_again(words, at)
            if again is not None:
                skips.setdefault(at, []).append((again, FALSE_START))
        return skips

    def _begun_again(self, words: list[str], at: int) -> int | None:
        """Where the words that begin here are said once more: "go to, uh, go to the lab"."""
        hesitations = self.language.words_called("hesitations")
        for end in range(at + 1, min(at + MOST_BEGUN, len(words)) + 1):
            if self.tokens[end - 1].kind == "mark" or words[end - 1] in hesitations:
                return None
            again, hesitates = end, end > at + 1  # of two words nobody says the same twice
            while again < len(words) and (words[again] in hesitations or words[again] == COMMA):
                hesitates = hesitates or words[again] in hesitations
                again += 1
            if hesitates and words[at:end] == words[again : again + end - at]:
                return again
        return None


class _Lately(threading.local):
    """What was prepared while this thread reads one sentence."""

    def __init__(self) -> None:
        self.prepared: dict[str, Prepared] = {}


_lately: Final = _Lately()


def prepared(text: str, lexicon: Lexicon, language: Language) -> Prepared:
    """Some words, prepared unless they were just now."""
    known = _lately.prepared.get(text)
    if known is None or known.lexicon is not lexicon or known.language is not language:
        if len(_lately.prepared) >= MOST_KEPT:
            forget()
        known = _lately.prepared[text] = Prepared(text, lexicon, language)
    return known


def forget() -> None:
    """Begin a new sentence."""
    _lately.prepared.clear()
