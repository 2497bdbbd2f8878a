"""Guesses of how a program goes on, so that a model need only agree: it reads several tokens at
once in hardly more time than one (Leviathan et al., arXiv:2211.17192).

Two sources: habits, which token has nearly always followed the last few in the programs of the
corpus (`nl2robot.training.planner.habits`); and the sentence itself, which programs say again
(prompt lookup: Saxena, https://github.com/apoorvumang/prompt-lookup-decoding).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Final

import msgspec

from nl2robot.paths import PACKAGED

FILE: Final = PACKAGED / "learned" / "habits.msgpack"
LONGEST: Final = 4
"""Tokens that are looked back on for a habit."""
REPEATED: Final = 2
"""Tokens that have to be the same for what stood behind them to be said again."""
MOST: Final = 4
"""Tokens that are guessed at once."""
NONE: Final = -1
"""What follows is known to be open."""

Habits = Mapping[str, int]
"""By the last tokens ("12 7 99"), what follows."""


def _of_the_corpus() -> Habits:
    if not FILE.exists():  # before they were learned
        return {}
    habits: Habits = msgspec.msgpack.decode(FILE.read_bytes(), type=dict[str, int])
    return habits


HABITS: Final = _of_the_corpus()


def key(tokens: Sequence[int]) -> str:
    return " ".join(map(str, tokens))


def guessed(habits: Habits, read: Sequence[int]) -> list[int]:
    """How a text probably goes on."""
    tokens, guesses = [*read], list[int]()
    while len(guesses) < MOST:
        token = _habit(habits, tokens)
        if token is None:
            token = _repeated(tokens)
        if token is None:
            break
        guesses.append(token)
        tokens.append(token)
    return guesses


def _habit(habits: Habits, tokens: Sequence[int]) -> int | None:
    for length in range(LONGEST, 0, -1):
        known = habits.get(key(tokens[-length:]))
        if known is not None:
            return None if known == NONE else known
    return None


def _repeated(tokens: Sequence[int]) -> int | None:
    last = tokens[-REPEATED:]
    for end in range(len(tokens) - 1, REPEATED - 1, -1):
        if tokens[end - REPEATED : end] == last:
            return tokens[end]
    return None
