"""Which words are listened for, by language: data/hotwords.yaml."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import msgspec
import yaml

_FILE: Final = Path(__file__).parents[1] / "data" / "hotwords.yaml"


class Judged(msgspec.Struct, frozen=True):
    """How the second stage judges a word."""

    written: tuple[str, ...]
    """The ways in which the second speech model writes it."""
    rivals: tuple[str, ...]
    """What it is easily taken for, written as well."""
    seconds: float
    """Of sound up to now in which it is looked for."""
    floor: float
    """Scores of the head from which on it is."""
    weight: float
    """Of the log likelihood, beside the log odds of the head's score."""
    contrast: float
    """Of how much likelier (in logs) it is than the likeliest rival."""
    limit: float
    """Of their sum: above it the word was said."""


class Words(msgspec.Struct, frozen=True):
    """The words of one language."""

    language: str
    hot: str
    """What the robot answers to."""
    stop: tuple[str, ...]
    filler: tuple[str, ...]
    """Everyday words that a decoder may hear instead."""
    near: dict[str, list[str]]
    """By word, what sounds much like it and means nothing."""
    judged: dict[str, Judged] = {}
    """By word, how a second stage judges it; others are heard by their head alone."""


WORDS: Final = {
    code: msgspec.convert({"language": code, **entry}, Words)
    for code, entry in yaml.safe_load(_FILE.read_text("utf-8")).items()
}
