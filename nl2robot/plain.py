"""Text of others, made fit for a terminal."""

from __future__ import annotations


def visible(text: str) -> str:
    """The text with what a terminal would obey or hide (escape sequences, characters that turn the
    direction of writing) spelled out: what is approved must be what was seen."""
    lines = text.replace("\r\n", "\n").replace("\r", "\n")
    return "".join(
        sign if sign.isprintable() or sign in "\n\t\xa0\u202f" else ascii(sign)[1:-1]
        for sign in lines
    )
