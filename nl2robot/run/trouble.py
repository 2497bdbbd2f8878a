"""What went wrong, or would, for a reader of another language than the sentences of robots."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from typing import TYPE_CHECKING, Final

from grammar.lexicon import Lexicon
from nl2robot.paths import PACKAGED
from nl2robot.run.state import PAUSED
from nl2robot.sentences import in_language
from robot_api.errors import Stopped

if TYPE_CHECKING:
    from nl2robot.run.runlog import LoggedCall

DATA: Final = PACKAGED / "trouble.yaml"
_STOPPED = Stopped()


def told(kind: str | None, message: str, language: str, lexicon: Lexicon | None = None) -> str:
    """What went wrong, for a reader of this language: the sentence of our own software in it, with
    the names of the lexicon; of somebody else's what an error of this kind means, and what they
    say. `kind`: the name of an error, or the code of a finding; None where there was none."""
    meanings = _meanings()
    if message == _STOPPED.because:
        return meanings["Stopped"].get(language, message)
    if language == "en" or not message:
        return message
    known = in_language(message, language, lexicon)
    if known is not None or kind in (None, "Stopped"):
        return known or message  # whoever stopped it has said why in a language of their own
    meaning = meanings.get(kind, meanings["other"]).get(language)
    return f"{meaning} ({message})" if meaning else message


def error_told(error: str, language: str, lexicon: Lexicon | None = None) -> str:
    """The same of an error as the log has it, with its name before its sentence."""
    kind, _, message = error.partition(": ")
    return told(kind, message, language, lexicon) if message else kind


def call_trouble(call: LoggedCall, language: str, lexicon: Lexicon | None = None) -> str | None:
    """The same of a call that went wrong; a pause is none, and stays as it is."""
    if call.error is None or call.error.startswith(PAUSED):
        return call.error
    return error_told(call.error, language, lexicon)


@functools.cache
def _meanings() -> Mapping[str | None, Mapping[str, str]]:
    import yaml

    meanings: dict[str | None, dict[str, str]] = yaml.safe_load(DATA.read_text(encoding="utf-8"))
    return meanings
