"""The robot's camera: pictures for whoever looks, and for the scanner. It has no robot method."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

Look = Callable[[bytes], None]
"""Told each picture, a JPEG or PNG; from any thread, and returns at once."""


class Camera(Protocol):
    """Fetches pictures while somebody looks, and only then."""

    def watch(self, look: Look) -> Callable[[], None]:
        """Have `look` told each picture from now on, at most some five a second; returns what ends
        it. After a loss of the robot they come again by themselves. Raises `LostConnection` while
        the robot is lost."""
