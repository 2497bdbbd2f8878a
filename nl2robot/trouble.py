"""What went wrong, or would: robots and the check of programs say it in English sentences."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Final

from robot_api.errors import Stopped

DATA: Final = Path(__file__).parent / "data" / "trouble.yaml"
_STOPPED = Stopped()


def told(kind: str | None, message: str, language: str) -> str:
    """What went wrong, for a reader of this language: what an error of this kind means there, and
    the sentence that has the details. `kind`: the name of an error, or the code of a finding; None
    where there was none."""
    meanings = _meanings()
    if message == _STOPPED.because:
        return meanings["Stopped"][language]
    if language == "en" or kind in (None, "Stopped"):
        return message  # whoever stopped the robot has said why in a language of their own
    return f"{meanings.get(kind, meanings['other'])[language]} ({message})"


@functools.cache
def _meanings() -> Mapping[str | None, Mapping[str, str]]:
    import yaml

    meanings: dict[str | None, dict[str, str]] = yaml.safe_load(DATA.read_text(encoding="utf-8"))
    return meanings
