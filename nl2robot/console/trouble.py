"""What went wrong, or would: robots and the check of programs say it in English sentences."""

from __future__ import annotations

from nl2robot.console.visitor import texts
from robot_api.errors import Stopped

_STOPPED = Stopped()


def told(kind: str | None, message: str, language: str) -> str:
    """What went wrong, for a reader of this language: what an error of this kind means there, and
    the sentence that has the details. `kind`: the name of an error, or the code of a finding; None
    where there was none."""
    meanings = texts("trouble", language)
    if message == _STOPPED.because:
        return meanings["Stopped"]
    if language == "en" or kind in (None, "Stopped"):
        return message  # whoever stopped the robot has said why in a language of their own
    return f"{meanings.get(kind, meanings['other'])} ({message})"
