"""What is said at a terminal, by language."""

from __future__ import annotations

import locale
import os
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from nl2robot.texts import texts_in

if TYPE_CHECKING:
    from nl2robot.review.rehearsal import DryRun
    from nl2robot.translate.outcome import Translation


def words_in(language: str) -> Mapping[str, Any]:
    """What the terminal says in a language; in English where it does not speak that."""
    return texts_in(language, "terminal")


def terminal_language() -> str:
    """The language of the terminal, as its environment says; "" if it does not."""
    named = (os.environ.get(name) for name in ("LC_ALL", "LC_MESSAGES", "LANG"))
    setting = next(filter(None, named), "")  # the first that is set counts
    return locale.normalize(setting).partition("_")[0]


def decimal(value: float, language: str) -> str:
    """A number as it is written in a language: "12.5", "12,5"."""
    return f"{value:g}".replace(".", words_in(language)["decimal_point"])


def duration(seconds: float) -> str:
    """A duration for people."""
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"


def foreseen(dry_run: DryRun, language: str) -> str:
    """How a dry run ended, in a sentence: how long it took, how far it went."""
    ends = {
        "done": "would_be_done",
        "failed": "would_fail",
        "stopped": "would_be_stopped",
        "limit": "would_be_ended",
        "unfinished": "would_go_round" if dry_run.goes_on else "would_go_on",
    }[dry_run.status]
    sentence: str = words_in(language)[ends]
    return sentence.format(
        time=duration(dry_run.seconds),
        metres=decimal(dry_run.metres, language),
        line=dry_run.line,
    )


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
