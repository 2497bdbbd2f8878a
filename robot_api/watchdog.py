"""Stops a moving robot when nobody could hear a stop: the thread that reads the wire is at
something else, does not come to it, or has ended.

It cannot help against what keeps the whole process from running (`robots.guardian` does, from
another); but it takes a machine that is only busy for what it is: what others take of the processor
is not the loop's, and it is late then itself.
"""

from __future__ import annotations

import asyncio
import logging
import threading
import time
from collections.abc import Callable
from typing import Final

BEAT: Final = 0.025
"""Seconds between two looks."""
COMPUTES: Final = 0.05
"""Seconds for which the loop's thread may compute without a sign of life, on the processor's own
clock, where the system has one for a thread: what takes longer would make a stop wait too long."""
DEAF: Final = 0.5
"""Seconds on any clock: ten times what a stop may take, since a busy machine is late as well, and a
robot that stands for nothing helps nobody."""
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
        self._clock: int | None = None
        """The processor's, of the loop's thread."""
        loop.call_soon_threadsafe(self._begin)
        self._thread = threading.Thread(target=self._watch, name="watchdog", daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._over.set()
        self._thread.join()

    def _begin(self) -> None:
        if hasattr(time, "pthread_getcpuclockid"):
            self._clock = time.pthread_getcpuclockid(threading.get_ident())

    def _watch(self) -> None:
        silent, computed, barked = 0.0, self._computed(), False
        while not self._over.is_set():
            if not self._moves():
                silent, barked = 0.0, False
                self._over.wait(BEAT)
                continue
            if not silent:
                computed = self._computed()
            self._answered.clear()
            began = time.monotonic()
            alive = self._ask()
            # Not by the clock on the wall: who is woken late counts what it was to wait, no more.
            if alive and self._answered.wait(BEAT):
                silent, barked = 0.0, False
                self._over.wait(max(0.0, BEAT - (time.monotonic() - began)))
                continue
            silent += BEAT
            busy = self._computed() - computed
            if (not alive or silent >= DEAF or busy >= COMPUTES) and not barked:
                barked = True
                _log.error(
                    "the loop is silent for %.2f s, of which it computed %.2f s: the robot is"
                    " stopped",
                    silent,
                    busy,
                )
                self._stop(BECAUSE)
            if not alive:
                self._over.wait(BEAT)

    def _computed(self) -> float:
        """Seconds for which the loop's thread has computed."""
        if self._clock is None:
            return 0.0
        try:
            return time.clock_gettime(self._clock)
        except OSError:  # the thread has ended
            return 0.0

    def _ask(self) -> bool:
        """Whether the loop is there to be asked for a sign of life."""
        try:
            self._loop.call_soon_threadsafe(self._answered.set)
        except RuntimeError:  # it is closed
            return False
        return True
