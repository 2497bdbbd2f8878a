"""Sentences as people type them in a hurry, and as a speech recogniser writes them down.

Made by code over the corpus, so that a model learns that "bring den rolator in zimer 3" means what
its careful form means. What has to be copied into a program (messages) is only spelled without
capitals and marks, never garbled beyond that.
"""

from __future__ import annotations

import random
import re
from typing import Final

_FILLERS: Final = {
    "en": ("uh", "um", "er", "like", "you know", "okay so"),
    "de": ("äh", "ähm", "also", "na ja", "halt", "ja also"),
    "fr": ("euh", "ben", "alors", "bon", "du coup", "enfin"),
}
_STARTS: Final = {
    "en": ("hey robot", "hello", "okay", "listen", "robot"),
    "de": ("hallo roboter", "hey", "du", "pass auf", "roboter"),
    "fr": ("salut robot", "dis", "écoute", "bonjour", "hé"),
}
_KEYS: Final = ("qwertzuiop", "asdfghjkl", "yxcvbnm")
_SHORTEST_GARBLED: Final = 5
"""Letters of words in which a slip may be."""


def as_heard(text: str, language: str, chance: random.Random) -> str:
    """As a recogniser writes it: no capitals, no marks; sometimes with a filler or a false
    start."""
    words = re.sub(r"[^\w\s'’%:./-]|(?<=\D)[.:](?=\s|$)", " ", text).lower().split()
    if chance.random() < 0.4:
        words.insert(chance.randrange(len(words)), chance.choice(_FILLERS[language]))
    if chance.random() < 0.2:
        words.insert(0, chance.choice(_STARTS[language]))
    if chance.random() < 0.15 and len(words) > 4:
        at = chance.randrange(1, len(words) - 1)
        words.insert(at, words[at])
    return " ".join(words)


def as_typed(text: str, chance: random.Random, names: frozenset[str]) -> str:
    """As fingers in a hurry type it: a slip or two in longer words that are no names, capitals and
    accents forgotten."""
    words = text.split(" ")
    places = [
        at
        for at, word in enumerate(words)
        if len(word) >= _SHORTEST_GARBLED and word.isalpha() and word.lower() not in names
    ]
    for at in chance.sample(places, min(len(places), chance.choice((1, 1, 2)))):
        words[at] = _slip(words[at], chance)
    typed = " ".join(words)
    if chance.random() < 0.5:
        typed = typed.lower()
    if chance.random() < 0.3:
        typed = re.sub(r"[.,;:!?]", "", typed)
    return typed


def _slip(word: str, chance: random.Random) -> str:
    at = chance.randrange(1, len(word) - 1)
    match chance.choice(("swap", "drop", "double", "beside")):
        case "swap":
            return word[:at] + word[at + 1] + word[at] + word[at + 2 :]
        case "drop":
            return word[:at] + word[at + 1 :]
        case "double":
            return word[:at] + word[at] + word[at:]
        case _:
            return word[:at] + _beside(word[at], chance) + word[at + 1 :]


def _beside(letter: str, chance: random.Random) -> str:
    """A key next to this one."""
    for row in _KEYS:
        at = row.find(letter.lower())
        if at >= 0:
            return chance.choice([row[max(0, at - 1)], row[min(len(row) - 1, at + 1)]])
    return letter
