"""The JSON of a frame: looked at before it is read, in time that grows with nothing but its length.

Frames come from anybody and are read in the thread that hears a stop. So what is too deep or holds
too many values is refused before a single value is made of it.
"""

from __future__ import annotations

import json
import re
from typing import Any, Final

import msgspec

MAX_FRAME: Final = 256 * 1024
"""Longest frame, in bytes, that a server accepts."""
MAX_DEPTH: Final = 32
"""Deepest nesting of arrays and objects in a frame."""
MAX_VALUES: Final = 5000
"""Most values in a frame. Long are only the texts of programs and pages."""

# One that does not end is a text up to the end: each letter is looked at once, whatever it is.
_TEXT: Final = re.compile(r'"[^"\\]*+(?:\\.[^"\\]*+)*+(?:"|\\?\Z)', re.DOTALL)
_NO_BRACKET: Final = re.compile(r"[^][{}]+")


class Unreadable(Exception):
    """What is wrong with a frame as a whole, in a sentence."""


class TooMuch(Unreadable):
    """It is longer, deeper or holds more than a server reads."""


class NoJson(Unreadable):
    """It is no JSON. `message`: what it says in the JSON of Python and JavaScript, which know NaN;
    None if it is none either."""

    def __init__(self, sentence: str, message: Any = None) -> None:
        super().__init__(sentence)
        self.message = message


def read_frame(frame: str | bytes) -> Any:
    """The values of a frame. Raises `TooMuch` and `NoJson`."""
    if not isinstance(frame, str):
        raise NoJson("Frames must be text, not binary.")
    if len(frame) > MAX_FRAME:
        raise TooMuch(f"A frame holds {MAX_FRAME} bytes at most.")
    # Of so many texts, with as many names, not even the ends are looked for.
    if frame.count('"') - frame.count('\\"') > 4 * MAX_VALUES:
        raise TooMuch(f"A message holds {MAX_VALUES} values at most.")
    bare = _TEXT.sub("", frame)
    opened = bare.count("[") + bare.count("{")
    if max(bare.count(","), opened) >= MAX_VALUES:
        raise TooMuch(f"A message holds {MAX_VALUES} values at most.")
    if opened > MAX_DEPTH and _is_too_deep(bare):
        raise TooMuch(f"A message may be {MAX_DEPTH} levels deep at most.")
    try:
        return msgspec.json.decode(frame)
    except (msgspec.MsgspecError, ValueError):
        pass
    try:
        message = json.loads(frame)
    except ValueError:
        raise NoJson("The message is not JSON.") from None
    raise NoJson("The message is not JSON, which has no NaN and no Infinity.", message)


def _is_too_deep(bare: str) -> bool:
    """Whether brackets are nested too deeply. Pairs with nothing inside are taken out, level by
    level."""
    brackets = _NO_BRACKET.sub("", bare)
    for _ in range(MAX_DEPTH):
        fewer = brackets.replace("[]", "").replace("{}", "")
        if fewer == brackets:
            break
        brackets = fewer
    return brackets.count("[") + brackets.count("{") > 0
