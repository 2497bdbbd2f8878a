"""Numbers in figures and words, as a language says them: `numbers` in its data."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping

from grammar.chart import Match
from grammar.language import Language
from grammar.tokens import Token


class Numerals:
    """The numbers of one sentence."""

    def __init__(self, tokens: tuple[Token, ...], language: Language) -> None:
        self.tokens = tokens
        self.language = language
        self._first_words = _first_words(language)
        self._ones = frozenset(language.numbers.get("ones", ()))
        self._zeros = frozenset(language.numbers.get("zeros", ()))

    def starting(self, at: int) -> list[Match]:
        """All numbers that begin at a token: "2.5", "twenty five", "two hundred and ten", "two and
        a half", "half a", "a"."""
        first = self.tokens[at] if at < len(self.tokens) else None
        if first is None or (first.value is None and first.norm not in self._first_words):
            return []
        numbers = self.language.numbers
        scales: Mapping[str, float] = numbers.get("scales", {})
        joiners = set(numbers.get("and", ()))
        if at < len(self.tokens) and self.tokens[at].norm in numbers.get("minus", ()):
            return [(end, cost, -value) for end, cost, value in self.starting(at + 1)]
        matches: list[Match] = []
        total, current, position, any_digit = 0.0, None, at, False
        while position < len(self.tokens):
            token = self.tokens[position]
            value, more = self._compound(position) or (token.value, 1)
            if value is None and current and current % 100 == 0 and token.norm in self._ones:
                value = 1.0  # "cent un"
            if value is not None:
                if (
                    current is not None
                    and not (current % 10 == 0 and current >= 20 and 0 < value < 10)
                    and not (current % 100 == 0 and current >= 100 and value < 100)
                ):
                    break
                if current is not None and self.tokens[position - 1].kind == "number":
                    break
                current = (current or 0.0) + value
                position += more - 1
            elif token.norm in scales:
                scale = scales[token.norm]
                current = (1.0 if current is None else current) * scale
                if scale >= 1000:
                    total, current = total + current, None
            elif token.norm in joiners and any_digit and position + 1 < len(self.tokens):
                following = self.tokens[position + 1]
                if following.value is None or (total + (current or 0)) < 100:
                    break
                position += 1
                continue
            else:
                break
            any_digit = True
            position += 1
            matches.append((position, 0.0, total + (current or 0.0)))
        whole = matches[-1] if matches else None
        if whole:
            for end, value in self._said("and_fractions", whole[0]):
                matches.append((end, 0.0, whole[2] + value))
        matches += [(end, 0.2, value) for end, value in self._said("phrases", at)]
        return matches

    def read_out(self, at: int) -> Iterator[tuple[int, str]]:
        """Numbers of at least two parts that are read out one by one, as those of rooms are: "one
        oh one", "two fourteen"; where each ends, and its digits."""
        digits = ""
        for position in range(at, len(self.tokens)):
            part = self._part(self.tokens[position])
            if part is None:
                return
            digits += part
            if position > at:
                yield position + 1, digits

    def _part(self, token: Token) -> str | None:
        if token.norm in self._zeros:
            return "0"
        if token.norm in self._ones:
            return "1"
        value = token.value
        return f"{value:g}" if value is not None and value in range(100) else None

    def _compound(self, at: int) -> tuple[float, int] | None:
        """A number said in several words that do not add up one by one, "quatre-vingt-dix", and
        how many words it has."""
        found = max(self._said("compounds", at), default=None)
        return None if found is None else (found[1], found[0] - at)

    def _said(self, kind: str, at: int) -> list[tuple[int, float]]:
        """The numbers of this kind that are said here in words of their own: where each ends, and
        its value."""
        if at >= len(self.tokens):
            return []
        return [
            (at + len(words), value)
            for words, value in _number_phrases(self.language, kind).get(self.tokens[at].norm, ())
            if tuple(token.norm for token in self.tokens[at : at + len(words)]) == words
        ]


@functools.cache
def _first_words(language: Language) -> frozenset[str]:
    """The words that a number can begin with and that are none themselves."""
    numbers = language.numbers
    phrases = (_number_phrases(language, kind) for kind in ("compounds", "phrases"))
    return frozenset().union(numbers.get("scales", ()), numbers.get("minus", ()), *phrases)


@functools.cache
def _number_phrases(
    language: Language, kind: str
) -> dict[str, list[tuple[tuple[str, ...], float]]]:
    """The numbers of several words of this kind, by their first one."""
    found: dict[str, list[tuple[tuple[str, ...], float]]] = {}
    for phrase, value in language.numbers.get(kind, {}).items():
        words = language.tokens_of(phrase)
        found.setdefault(words[0], []).append((words, float(value)))
    return found
