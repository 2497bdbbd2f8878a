"""What a program for one sentence may name: what the recogniser lets the language model write.

A literal that stands for something of the world is one of a few: a place that was spoken of, a
number that was said, in the unit that it is needed in. Only what is spoken or shown is free.
"""

from __future__ import annotations

from typing import Final

import msgspec

from robot_api.methods import METHODS, Parameter


class Vocabulary(msgspec.Struct, frozen=True, kw_only=True):
    """The literals of one sentence, by what they are for."""

    places: tuple[str, ...] = ()
    kinds: tuple[str, ...] = ()
    """Of places: "office"."""
    people: tuple[str, ...] = ()
    """Names, kinds and descriptions: "Alice", "nurse", "person with a hat"."""
    things: tuple[str, ...] = ()
    furniture: tuple[str, ...] = ()
    contacts: tuple[str, ...] = ()
    gestures: tuple[str, ...] = ()
    emotions: tuple[str, ...] = ()
    joints: tuple[str, ...] = ()
    skills: tuple[str, ...] = ()
    languages: tuple[str, ...] = ()
    numbers: tuple[str, ...] = ()
    """As they are written: "3", "-0.5"."""
    seconds: tuple[str, ...] = ()
    minutes: tuple[str, ...] = ()
    """The same as minutes."""
    metres: tuple[str, ...] = ()
    degrees: tuple[str, ...] = ()
    percents: tuple[str, ...] = ()
    times: tuple[str, ...] = ()
    """Times of day: "17:00"."""
    urls: tuple[str, ...] = ()
    selectors: tuple[str, ...] = ()
    phrases: tuple[str, ...] = ()
    """Words of the sentence that may stand in a list."""
    said: str = ""
    """The sentence."""


_NEVER: Final = frozenset({"html", "timeout", "prompt"})
"""Parameters that only some methods offer to a model."""
_OFFERED: Final = frozenset({("wait_for", "timeout"), ("touch", "prompt")})


def form(method: str) -> tuple[Parameter, ...]:
    """The parameters of a method that a model may give, in their order."""
    known = METHODS[method]
    return tuple(
        parameter
        for parameter in known.forms[0]
        if parameter.name not in _NEVER or (method, parameter.name) in _OFFERED
    )
