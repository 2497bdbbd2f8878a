"""Stops a moving robot when nobody could hear a stop: the thread that reads the wire is at
something else, does not come to it, or has ended.

It cannot help against what keeps the whole process from running (`robots.guardian` does, from
another); but it takes a machine that is only busy for what it is. A thread that waits for its turn
at the processor neither computes nor sleeps, and who looks is late then as well.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import re
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Final

BEAT: Final = 0.01
"""Seconds between two looks."""
LAGS: Final = 0.05
"""Seconds for which the loop's thread may give no sign of life while it computes, by the
processor's clock for it, or sleeps: what takes longer would make a stop wait too long."""
DEAF: Final = 0.5
"""Seconds on any clock, where the system does not say what a thread is at: ten times what a stop
may take, since a busy machine is late as well, and a robot that stands for nothing helps nobody."""
_THREADS: Final = Path("/proc/self/task")
BECAUSE: Final = "The robot's server could not have heard a stop, so the robot was stopped."

_log = logging.getLogger("robot_api.serving.watchdog")


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
        self._watched: _Thread | None = None
        """The loop's."""
        loop.call_soon_threadsafe(self._begin)
        self._thread = threading.Thread(target=self._watch, name="watchdog", daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._over.set()
        self._thread.join()
        if self._watched is not None:
            self._watched.close()

    def _begin(self) -> None:
        self._watched = _Thread()

    def _watch(self) -> None:
        silence: _Silence | None = None
        while not self._over.is_set():
            if not self._moves():
                silence = None
                self._over.wait(BEAT)
                continue
            silence = silence or _Silence(self._watched)
            self._answered.clear()
            began = time.monotonic()
            alive = self._ask()
            if alive and self._answered.wait(BEAT):
                silence = None
                self._over.wait(max(0.0, BEAT - (time.monotonic() - began)))
                continue
            silence.lasts(punctual=time.monotonic() - began < 2 * BEAT)
            if (not alive or silence.too_long()) and not silence.told:
                silence.told = True
                _log.error("the loop is silent %s: the robot is stopped", silence)
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


class _Silence:
    """A time without a sign of life of the thread, and what it was at."""

    def __init__(self, thread: _Thread | None) -> None:
        self.told = False
        self._thread = thread
        # Not by the clock on the wall: who is woken late counts what it was to wait, no more.
        self._seconds = self._asleep = self._computed = 0.0
        self._since = thread.computed() if thread else 0.0
        self._sleep: int | None = None

    def lasts(self, punctual: bool) -> None:
        """For another beat; whether who looks was woken in time."""
        self._seconds += BEAT
        if self._thread is None:
            return
        self._computed = self._thread.computed() - self._since
        before, self._sleep = self._sleep, self._thread.sleep()
        if self._sleep is None or before not in (None, self._sleep):
            self._asleep = 0.0  # who waits for Python's lock is awake every few milliseconds
        elif punctual and not others_run():
            # Else it may wait for a lock whose holder does not come to its turn.
            self._asleep += BEAT

    def too_long(self) -> bool:
        return max(self._asleep, self._computed) >= LAGS or self._seconds >= DEAF

    def __str__(self) -> str:
        return (
            f"for {self._seconds:.2f} s, computed for {self._computed:.2f} s of it"
            f" and sleeps for {self._asleep:.2f} s"
        )


class _Thread:
    """What the thread that makes this is at, for others to see, as far as the system says it."""

    def __init__(self) -> None:
        self._clock: int | None = None
        if hasattr(time, "pthread_getcpuclockid"):
            self._clock = time.pthread_getcpuclockid(threading.get_ident())
        self._status: int | None = None
        """Linux's file about it, kept open: there may be none left to open when it is needed."""
        with contextlib.suppress(OSError):
            status = _THREADS / str(threading.get_native_id()) / "status"
            self._status = os.open(status, os.O_RDONLY)

    def computed(self) -> float:
        """Seconds for which it has computed."""
        if self._clock is None:
            return 0.0
        try:
            return time.clock_gettime(self._clock)
        except OSError:  # the thread has ended
            return 0.0

    def sleep(self) -> int | None:
        """Which of its sleeps it is in, counted from its start: for something other than its turn
        at the processor, or a disk. None if it is awake, or if the system does not say so."""
        if self._status is None:
            return None
        try:
            status = os.pread(self._status, 4096, 0)
        except OSError:  # the thread has ended
            return None
        said = re.search(rb"State:\t(S).*\nvoluntary_ctxt_switches:\t(\d+)", status, re.DOTALL)
        return int(said[2]) if said else None

    def close(self) -> None:
        if self._status is not None:
            os.close(self._status)
            self._status = None


def others_run() -> bool:
    """Whether a thread of this process runs or waits for its turn at the processor, besides the one
    that asks; so it counts, too, where the system does not say it."""
    own = str(threading.get_native_id())
    try:
        for thread in _THREADS.iterdir():
            if thread.name != own and b") R " in (thread / "stat").read_bytes():
                return True
    except OSError:  # one has just ended, or there is no descriptor left to look with
        return True
    return False
