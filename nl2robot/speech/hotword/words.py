"""Which words are listened for, by language: data/hotwords.yaml."""

from __future__ import annotations

from typing import Final, Literal

import msgspec
import yaml

from nl2robot.paths import PACKAGED

_FILE: Final = PACKAGED / "hotwords.yaml"


class Opinion(msgspec.Struct, frozen=True):
    """How one speech model judges a word."""

    by: Literal["moonshine", "whisper"]
    seconds: float
    """Of sound up to now in which it looks for the word."""
    weight: float
    """Of the log likelihood of the word, beside the log odds of the head's score."""
    contrast: float = 0.0
    """Of how much likelier (in logs) it is than the likeliest rival."""


class Way(msgspec.Struct, frozen=True):
    """Who judges, and where the line is."""

    floor: float
    """Scores of the head from which on they are asked."""
    limit: float
    """Of the sum of all: above it the word was said."""
    opinions: tuple[Opinion, ...]
    """The quickest first."""


class Judged(msgspec.Struct, frozen=True):
    """How a second stage judges a word."""

    written: tuple[str, ...]
    """The ways in which speech models write it."""
    rivals: tuple[str, ...]
    """What it is easily taken for, written as well."""
    ways: tuple[Way, ...]
    """The first is taken whose speech models are all installed."""


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
