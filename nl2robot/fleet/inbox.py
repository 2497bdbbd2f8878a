"""What came from the network and was not looked at yet, with when it came."""

from __future__ import annotations

import itertools
import queue
import time
from collections.abc import Callable
from typing import Final

Deed = Callable[[float], None]
"""What is to be done with it, given when it came (seconds of the monotonic clock)."""
_FIRST: Final = 0
_ELSE: Final = 1


class Inbox:
    """Any thread may put something in. A robot with much to do falls behind: a stop is looked at
    before all that came earlier, and what is old is known to be."""

    def __init__(self) -> None:
        self._waits: queue.PriorityQueue[tuple[int, int, float, Deed | None]]
        self._waits = queue.PriorityQueue()
        self._number = itertools.count()

    def put(self, deed: Deed | None, *, urgent: bool = False) -> None:
        """None: nothing more is to be done."""
        rank = _FIRST if urgent else _ELSE
        self._waits.put((rank, next(self._number), time.monotonic(), deed))

    def get(self, timeout: float) -> tuple[float, Deed | None]:
        """The next, and when it came. Raises `queue.Empty` after so many seconds."""
        _, _, came, deed = self._waits.get(timeout=timeout)
        return came, deed
