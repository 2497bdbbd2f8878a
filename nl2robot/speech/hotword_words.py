"""Which words are listened for, by language: data/hotwords.yaml."""

from __future__ import annotations

from pathlib import Path
from typing import Final

import msgspec
import yaml

_FILE: Final = Path(__file__).parents[1] / "data" / "hotwords.yaml"


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


WORDS: Final = {
    code: msgspec.convert({"language": code, **entry}, Words)
    for code, entry in yaml.safe_load(_FILE.read_text("utf-8")).items()
}
