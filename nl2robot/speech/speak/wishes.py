"""What is to be heard of a robot, before anything is loaded that speaks or hears."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal

from robot_api.capabilities.sound import Sound

InBrowsers = Literal["browser"]

IN_BROWSERS: Final[InBrowsers] = "browser"

Clock = Callable[[], float]
"""Seconds of simulated time."""

SoundFor = Callable[[Clock], Sound]
"""What a robot is given, once there is a clock that its sounds go by."""


@dataclass(frozen=True)
class Wishes:
    """What is to be heard."""

    speak: bool | Path | InBrowsers = False
    """The robot speaks: on the loudspeaker, into a file, or on the pages that are open."""
    voices: bool = False
    """The simulated people answer aloud, and the robot has to hear them."""
    voice: str | None = None
    """The robot's voice, by name or kind ("piper", "espeak")."""
    language: str = "en"
    """The one that it begins with."""
    microphone: bool | str = False
    """Somebody real answers, at the microphone; or at the one with this in its name."""
    seed: int = 0
