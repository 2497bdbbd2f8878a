"""The hospital of the language tests as the speakers of each language call it."""

from __future__ import annotations

import importlib

from grammar.lexicon import Lexicon
from tests.grammar.ward import WARD


def hospital(language: str) -> Lexicon:
    """The ward with the names of this language, from `ward_<code>.py`."""
    if language == "en":
        return WARD
    module = importlib.import_module(f"tests.grammar.ward_{language}")
    return next(
        each for each in vars(module).values() if isinstance(each, Lexicon) and each is not WARD
    )
