"""What is said at a terminal, by language."""

from __future__ import annotations

import functools
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

if TYPE_CHECKING:
    from nl2robot.translation import Translation

DATA: Final = Path(__file__).parent / "data" / "terminal.yaml"


@functools.cache
def words_in(language: str) -> Mapping[str, Any]:
    """What the terminal says in a language; in English where it does not speak that."""
    import yaml

    words: dict[str, dict[str, Any]] = yaml.safe_load(DATA.read_text(encoding="utf-8"))
    found: Mapping[str, Any] = words.get(language, words["en"])
    return found


def decimal(value: float, language: str) -> str:
    """A number as it is written in a language: "12.5", "12,5"."""
    return f"{value:g}".replace(".", words_in(language)["decimal_point"])


def authorship(translation: Translation, language: str) -> Iterator[str]:
    """What to know of a program that a language model has written, in sentences; nothing of one
    that the rules have made, who heed every word."""
    if translation.program is None or translation.source != "model":
        return
    words = words_in(language)
    yield words["by_model"]
    for what, texts in (("unused", translation.unused), ("own", translation.own)):
        if texts:
            quoted = ", ".join(words["quoted"].format(text=text) for text in texts)
            yield words[what].format(texts=quoted)
