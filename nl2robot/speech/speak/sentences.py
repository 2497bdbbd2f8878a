"""Text made ready to be spoken: cleaned, and cut where a voice may breathe.

A voice makes a sound for a whole piece before anything is heard of it. So the pieces are sentences,
long ones cut at a comma, and the first is the shortest.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator
from typing import Final

LONGEST: Final = 160
"""Characters of a piece, about 10 seconds of speech."""
FIRST: Final = 60
"""Characters of the first piece, if it can be cut at a comma."""
_LEAST: Final = 20
"""Fewer characters before a cut sound chopped off."""
_END: Final = re.compile(r"(?<=[.!?…])[\"'”»)]*\s+")
_BREATH: Final = re.compile(r"(?<=[,;:])\s+|\s+(?=[–—(])")
_ABBREVIATIONS: Final = frozenset(
    ["dr", "mr", "mrs", "ms", "prof", "st", "nr", "mme", "mlle", "bzw", "ca", "usw", "etc", "vs"]
)
_PICTURES: Final = "\u2190"
"""From here on a "symbol, other" is an arrow, a drawing or an emoji, which voices read out by its
name; before it are degrees and the like."""


def cleaned(text: str) -> str:
    """The text without what is no speech: control characters, emoji, and the brackets in which
    voices take phonemes or markup, as an attack or by accident."""
    kept = []
    for character in unicodedata.normalize("NFC", text):
        category = unicodedata.category(character)
        if category == "So" and character >= _PICTURES:
            kept.append(" ")
        elif category[0] in "CZ" or character in "<>[]{}|\\":
            kept.append("\n" if character in "\n\u2028\u2029" else " ")
        else:
            kept.append(character)
    lines = (" ".join(line.split()) for line in "".join(kept).split("\n"))
    return "\n".join(line for line in lines if any(map(str.isalnum, line)))


def pieces(text: str) -> Iterator[str]:
    """The cleaned text, piece by piece as it is to be spoken; nothing if it has no words."""
    first = True
    for line in cleaned(text).split("\n"):
        for sentence in _sentences(line):
            rest = sentence
            while rest:
                piece, rest = _cut(rest, FIRST if first else LONGEST)
                first = False
                yield piece


def _sentences(line: str) -> Iterator[str]:
    began = 0
    for end in _END.finditer(line):
        last = re.split(r"\W", line[began : end.start()].rstrip(".").lower())[-1]
        # "Dr. Smith", "z. B.", "J. Doe": the sentence goes on.
        if line[end.start() - 1] == "." and (last in _ABBREVIATIONS or len(last) == 1):
            continue
        yield line[began : end.end()].strip()
        began = end.end()
    if line[began:].strip():
        yield line[began:].strip()


def _cut(sentence: str, soon: int) -> tuple[str, str]:
    """A first piece, and the rest: at a comma before `soon`, else only where it is too long."""
    if len(sentence) <= soon:
        return sentence, ""
    breaths = [at.start() for at in _BREATH.finditer(sentence) if at.start() >= _LEAST]
    near = [at for at in breaths if at <= soon]
    if not near and len(sentence) <= LONGEST:
        return sentence, ""
    fitting = near or [at for at in breaths if at <= LONGEST]
    at = fitting[-1] if fitting else sentence.rfind(" ", 1, LONGEST)
    at = at if at > 0 else LONGEST
    return sentence[:at].strip(), sentence[at:].strip()
