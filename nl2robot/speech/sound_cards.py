"""What plays on sound cards and records from them: miniaudio, which is not everywhere."""

from __future__ import annotations

from typing import Any

from nl2robot.errors import UserError
from nl2robot.speech.alsa import quieten


def sound_cards(error: type[UserError]) -> Any:
    """The module `miniaudio`. Raises `error` where it is not installed: there are no wheels of it
    for 64-bit Arm."""
    try:
        import miniaudio
    except ModuleNotFoundError as missing:
        raise error(
            "This computer's sound card cannot be used, for the package miniaudio is not installed:"
            " on 64-bit Arm it has to be compiled. Install a C compiler and do: pip install"
            " miniaudio"
        ) from missing
    quieten()
    return miniaudio
