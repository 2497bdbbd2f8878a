"""Stops a moving robot when nobody could hear a stop: the thread that reads the wire does not come
to it, or has ended.

It cannot help against what keeps the whole process from running; but it takes a machine that is
only busy for what it is, since it is late then itself.
"""

from __future__ import annotations

import asyncio
import logging
import threading
import time
from collections.abc import Callable
from typing import Final

BEAT: Final = 0.05
"""Seconds between two looks."""
DEAF: Final = 0.5
"""Seconds without a sign of life after which a moving robot is stopped: ten times what a stop may
take, since a busy machine is late as well, and a robot that stands for nothing helps nobody."""
BECAUSE: Final = "The robot's server could not have heard a stop, so the robot was stopped."

_log = logging.getLogger("robot_api.watchdog")


class Watchdog:
    """`moves` says whether a call that may move the robot is in flight, `stop` stops it; both are
    called on the watchdog's own thread."""

    def __init__(
        self,
        loop: asyncio.AbstractEventLoop,
        moves: Callable[[], bool],
        stop: Callable[[str], None],
    ) -> None:
        self._loop = loop
        self._moves = moves
        self._stop = stop
        self._over = threading.Event()
        self._answered = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="watchdog", daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._over.set()
        self._thread.join()

    def _watch(self) -> None:
        silent, barked = 0.0, False
        while not self._over.is_set():
            self._answered.clear()
            began = time.monotonic()
            alive = self._ask()
            # Not by the clock on the wall: who is woken late counts what it was to wait, no more.
            waited = alive and self._answered.wait(BEAT)
            if waited:
                silent, barked = 0.0, False
                self._over.wait(max(0.0, BEAT - (time.monotonic() - began)))
                continue
            silent += BEAT
            if (not alive or silent >= DEAF) and not barked and self._moves():
                barked = True
                _log.error("the loop is silent for %.2f s: the robot is stopped", silent)
                self._stop(BECAUSE)
            if not alive:
                self._over.wait(BEAT)

    def _ask(self) -> bool:
        """Whether the loop is there to be asked for a sign of life."""
        try:
            self._loop.call_soon_threadsafe(self._answered.set)
        except RuntimeError:  # it is closed
            return False
        return True
