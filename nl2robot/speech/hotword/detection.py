"""That a word was heard."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

HELD: Final = 1.2
"""Seconds for which a word that was heard is not heard again: nobody says it twice so fast."""


@dataclass(frozen=True)
class Detection:
    """A word was heard."""

    word: str
    time: float
    """Seconds of sound fed until it was heard; the word ended shortly before."""
    score: float
    """How surely, 0 to 1."""
