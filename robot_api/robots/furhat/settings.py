"""What a robot file says of a Furhat in its section `furhat`."""

from __future__ import annotations

from typing import Final

import msgspec

DEFAULT_PORT: Final = 9000


class FurhatSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    locales: dict[str, str] = {}
    """Which kind of a language it hears, and speaks where no voice is named: {en: en-GB}."""
    voices: dict[str, str] = {}
    """The voice for a language, by the name that the robot's own page lists. None: the robot keeps
    the voice that it has if it speaks the language, else it chooses one."""
    end_of_speech: float = 1.0
    """Seconds of silence after which somebody has done speaking."""
