"""A line at the terminal that is written again in place: how far the robot has come.

It stands above the cursor, so that what somebody types meanwhile ("stop") stays where it is.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Final

from rich.console import Console

PERIOD: Final = 0.25
"""Seconds between two writings."""
_SAVE, _RESTORE, _UP, _CLEAR = "\x1b7", "\x1b8", "\x1b[1A", "\r\x1b[2K"


class LiveLine:
    """Whoever prints anything else, or sees a line typed, calls `leave` first. Any thread."""

    def __init__(self, console: Console, clock: Callable[[], float] = time.monotonic) -> None:
        self._console = console
        self._clock = clock
        self._shown: str | None = None
        self._at = float("-inf")
        self._lock = threading.Lock()

    @property
    def possible(self) -> bool:
        """Whether a line can be written again: into a file or a pipe none is written at all."""
        return self._console.is_terminal and not self._console.is_dumb_terminal

    def show(self, text: str) -> None:
        """Write the line, or write it again; at most four times a second."""
        with self._lock:
            now = self._clock()
            text = text[: self._console.width - 1]
            if not self.possible or text == self._shown or now < self._at + PERIOD:
                return
            if self._shown is None:
                self._console.file.write(f"{text}\n")
            else:
                self._console.file.write(f"{_SAVE}{_UP}{_CLEAR}{text}{_RESTORE}")
            self._console.file.flush()
            self._shown, self._at = text, now

    def leave(self) -> None:
        """Let it stand as it is; what is shown next begins another line."""
        with self._lock:
            self._shown = None
