"""Work in processes of its own: what computes for more than a moment must not hold up the loop that
hears a stop.

    made = HELPERS.call(partial(review, program, knowledge), seconds=200)

Work and result are pickled between processes of this program, nobody else's. A process is begun
when one is needed, stays for the next call and ends with whoever began it, however that ends. One
that is over its time is killed; one that dies in its work (too little memory, killed) is begun anew
and asked once more.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from queue import SimpleQueue
from typing import IO, Any, Final, ParamSpec, TypeVar, cast

from nl2robot.child_processes import look_after
from nl2robot.work import Died, TookTooLong
from robot_api.errors import cause

P = ParamSpec("P")
T = TypeVar("T")

ATTEMPTS: Final = 2
STAYS: Final = 60.0
"""Seconds for which a process that nobody needs waits for more to do; one waits for ever."""
NICENESS: Final = 5
"""Less right to the processor than the robot's loop has."""


class Helpers:
    """Any thread may call."""

    def __init__(self, most: int) -> None:
        """`most` processes at a time; who comes when all are at work waits."""
        self._places = threading.BoundedSemaphore(most)
        self._lock = threading.Lock()
        self._idle: list[_Helper] = []
        """The one that worked last comes last."""
        self._busy: set[_Helper] = set()
        self._sweep: threading.Timer | None = None
        self._is_over = False
        look_after(self)

    def call(self, work: Callable[[], T], seconds: float) -> T:
        """`work()`, done elsewhere: a function, or a `partial` of one. Raises what it raises,
        `TookTooLong` and `Died`. The time counts from when its turn has come."""
        order = pickle.dumps(work, pickle.HIGHEST_PROTOCOL)
        with self._places:
            for _ in range(ATTEMPTS):
                helper = self._taken()
                try:
                    is_done, value = helper.answer(order, seconds)
                except _Gone:
                    self._drop(helper)
                    continue
                except BaseException:  # its time is over, or Ctrl-C: whatever it is at is not done
                    self._drop(helper)
                    raise
                self._give_back(helper)
                if is_done:
                    return cast(T, value)
                raise value
            raise Died

    @property
    def pids(self) -> list[int]:
        """The processes that there are."""
        with self._lock:
            return [helper.pid for helper in (*self._idle, *self._busy)]

    def _taken(self) -> _Helper:
        with self._lock:
            while self._idle:
                helper = self._idle.pop()
                if helper.is_alive:
                    self._busy.add(helper)
                    return helper
                helper.close()
            if self._is_over:
                raise Died
            try:
                helper = _Helper()
            except OSError as error:  # no memory, no room for a process
                raise Died from error
            self._busy.add(helper)
            return helper

    def _give_back(self, helper: _Helper) -> None:
        with self._lock:
            self._busy.discard(helper)
            helper.idle_since = time.monotonic()
            self._idle.append(helper)
            self._sweep_later()

    def _sweep_later(self) -> None:
        """Called with the lock held."""
        if len(self._idle) > 1 and self._sweep is None:
            self._sweep = threading.Timer(STAYS, self._swept)
            self._sweep.daemon = True
            self._sweep.start()

    def _swept(self) -> None:
        """End those that nobody has needed for long, but for the last."""
        with self._lock:
            self._sweep = None
            since = time.monotonic() - STAYS / 2
            old = [each for each in self._idle[:-1] if each.idle_since < since]
            self._idle = [each for each in self._idle if each not in old]
            self._sweep_later()
        for helper in old:
            helper.close()

    def _drop(self, helper: _Helper) -> None:
        with self._lock:
            self._busy.discard(helper)
        helper.close()

    def close(self) -> None:
        """End all processes; who calls next begins another."""
        with self._lock:
            idle, self._idle = self._idle, []
            busy = list(self._busy)
        for helper in idle:
            helper.close()
        for helper in busy:
            helper.kill()  # closed by whoever waits for it

    def close_for_good(self) -> None:
        self._is_over = True
        self.close()

    def forget(self) -> None:
        """In a copy of this process (`fork`): they work for the first."""
        self._lock = threading.Lock()
        self._idle, self._busy, self._sweep = [], set(), None


class _Gone(Exception):
    """The process has ended."""


class _Helper:
    """One process; one thread at a time asks it."""

    def __init__(self) -> None:
        self.idle_since = 0.0
        self._process = subprocess.Popen(
            # -P: no file that lies beside whoever began it is taken for one of our modules.
            [sys.executable, "-P", "-m", "nl2robot.review.apart"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,  # Ctrl-C is for whoever waits
        )
        assert self._process.stdin is not None and self._process.stdout is not None
        self._orders: IO[bytes] = self._process.stdin
        self._answers: IO[bytes] = self._process.stdout

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def is_alive(self) -> bool:
        return self._process.poll() is None

    def answer(self, order: bytes, seconds: float) -> tuple[bool, Any]:
        """Whether it was done, and what came of it or was raised. Raises `_Gone`, and
        `TookTooLong` when it had to be killed."""
        is_late = threading.Event()

        def end() -> None:
            is_late.set()
            self.kill()

        watchdog = threading.Timer(seconds, end)
        watchdog.daemon = True
        watchdog.start()
        try:
            self._orders.write(order)
            self._orders.flush()
            answer: tuple[bool, Any] = pickle.load(self._answers)
            return answer
        except (OSError, EOFError, pickle.UnpicklingError) as error:
            if is_late.is_set():
                raise TookTooLong from None
            raise _Gone from error
        finally:
            watchdog.cancel()

    def kill(self) -> None:
        self._process.kill()

    def close(self) -> None:
        self._process.kill()
        self._process.wait()
        for stream in (self._orders, self._answers):
            with suppress(OSError):  # what nobody has read
                stream.close()


REVIEWS: Final = max(2, os.cpu_count() or 2)
"""How many may be at work at a time,"""
HELPERS: Final = Helpers(REVIEWS + 2)
"""so that some place is left for thinking."""
THINKS: Final = 10.0
"""Seconds for which the rules may think about a sentence: nearly all take milliseconds."""


def think(function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> T:
    """In another process, in the time that there is for a sentence."""
    return HELPERS.call(partial(function, *args, **kwargs), seconds=THINKS)


def main() -> None:
    """Answer one order after the other, and end in the middle of one when nobody waits any more."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what is printed is no answer
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    orders: SimpleQueue[Any] = SimpleQueue()
    threading.Thread(target=_listen, args=(orders,), daemon=True).start()
    while True:
        work = orders.get()
        answer: tuple[bool, Any]
        try:
            answer = (True, work())
        except Exception as error:  # noqa: BLE001 - it is raised where somebody waits for it
            error.add_note(f"In a process of its own:\n{traceback.format_exc()}")
            answer = (False, error)
        try:
            answers.write(_pickled(answer))
            answers.flush()
        except BrokenPipeError:
            return


def _listen(orders: SimpleQueue[Any]) -> None:
    with suppress(EOFError), os.fdopen(os.dup(0), "rb") as source:
        while True:
            orders.put(pickle.load(source))
    os._exit(0)


def _pickled(answer: tuple[bool, Any]) -> bytes:
    try:
        return pickle.dumps(answer, pickle.HIGHEST_PROTOCOL)
    except Exception as error:  # noqa: BLE001 - somebody waits for an answer
        return pickle.dumps((False, TypeError(f"What came of it cannot be sent: {cause(error)}")))


if __name__ == "__main__":
    main()
