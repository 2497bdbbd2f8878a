"""Who lets time pass: runs behaviours step by step, in the caller's thread or by a clock.

A behaviour is a generator that yields once a step and returns its result. Any number of threads may
run one each at the same time: all behaviours advance together, a step at a time, in the order in
which they began. Without a `speed` one of the callers steps for all of them as fast as it can, and
no time passes when nobody runs anything; with one a clock thread steps, and the callers wait.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Generator
from types import TracebackType
from typing import Any, Protocol, TypeVar

from sim.errors import Interrupted

T = TypeVar("T")
Behaviour = Generator[None, None, T]

_POLL = 0.01
"""Seconds between two looks at a stop flag by a caller that waits for the clock thread."""
_GREATEST_LAG = 0.25
"""A clock that falls behind by more seconds gives them up instead of racing after them."""


class Stop(Protocol):
    """What tells a behaviour to end: an `Event`, a driver's stop flag."""

    def is_set(self) -> bool: ...


class Turn:
    """A lock that a busy loop hands over to whoever waits for it.

    A plain lock, let go of and taken again at once, would keep everyone else waiting."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._count = threading.Lock()
        self._waiting = 0

    def __enter__(self) -> None:
        with self._count:
            self._waiting += 1
        try:
            self._lock.acquire()
        finally:
            with self._count:
                self._waiting -= 1

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._lock.release()

    def let_others(self) -> None:
        """Wait until nobody waits; called without holding it."""
        while self._waiting:
            time.sleep(1e-5)


class _Task:
    """A behaviour and how it ended."""

    def __init__(self, behaviour: Behaviour[Any], stop: Stop) -> None:
        self.behaviour = behaviour
        self.stop = stop
        self.result: Any = None
        self.error: BaseException | None = None
        self.done = False

    def advance(self) -> None:
        if self.stop.is_set():
            self.interrupt()
            return
        try:
            next(self.behaviour)
        except StopIteration as end:
            self.result = end.value
            self.done = True
        except KeyboardInterrupt:
            self.fail(Interrupted("The robot was interrupted."))
            raise
        except BaseException as error:  # noqa: BLE001 - raised in the thread that runs it
            self.fail(error)

    def interrupt(self) -> None:
        self.behaviour.close()
        self.fail(Interrupted("The robot was stopped."))

    def fail(self, error: BaseException) -> None:
        self.error = error
        self.done = True


class Runner:
    """`step` lets one step pass, `rest` brings the robot to rest, `deliver` hands out the events
    that came up; `deliver` is called without the turn, so that listeners may ask questions."""

    def __init__(
        self,
        step: Callable[[], None],
        rest: Callable[[], None],
        deliver: Callable[[], None],
        seconds: float,
        speed: float | None,
    ) -> None:
        self.turn = Turn()
        """Hold it to look at or to change the hospital."""
        self._step, self._rest, self._deliver = step, rest, deliver
        self._tasks: list[_Task] = []
        self._halting = False
        self._changed = threading.Condition()
        self._leading = False  # whether one of the callers steps for all
        self._closed = threading.Event()
        self._clock: threading.Thread | None = None
        if speed is not None:
            self._clock = threading.Thread(
                target=self._keep_time, args=(seconds / speed,), name="sim clock", daemon=True
            )
            self._clock.start()

    def run(self, behaviour: Behaviour[T], stop: Stop) -> T:
        """Run it to its end and return its result; raises what it raises, and `Interrupted` as
        soon as `stop` is set or somebody halts."""
        task = _Task(behaviour, stop)
        with self.turn:
            if self._closed.is_set():
                raise Interrupted("The simulation has ended.")
            self._tasks.append(task)
        try:
            if self._clock is None:
                self._step_or_wait(task)
            else:
                self._wait(task)
        finally:
            if not task.done:
                with self.turn:
                    self._drop(task)
            self._deliver()
        if task.error is not None:
            raise task.error
        result: T = task.result
        return result

    def halt(self) -> None:
        """Bring the robot to rest and interrupt every behaviour, now, from any thread."""
        self._halting = True  # seen by whoever steps, even before the turn is ours
        with self.turn:
            if self._halting:
                self._interrupt_all()
        self._deliver()

    def close(self) -> None:
        """End the clock, and whatever runs."""
        self._closed.set()
        self.halt()
        if self._clock is not None and self._clock is not threading.current_thread():
            self._clock.join()

    def _interrupt_all(self) -> None:
        self._halting = False
        for task in self._tasks:
            task.interrupt()
        self._tasks.clear()
        self._rest()
        self._tell_callers()

    def _drop(self, task: _Task) -> None:
        if task in self._tasks:
            self._tasks.remove(task)
        if not task.done:
            task.interrupt()

    def _tell_callers(self) -> None:
        with self._changed:
            self._changed.notify_all()

    def _tick(self) -> None:
        """One step of everything; needs the turn."""
        if self._halting:
            self._interrupt_all()
        for task in tuple(self._tasks):
            task.advance()
            if task.done:
                self._tasks.remove(task)
                self._tell_callers()
        if self._tasks or self._clock is not None:
            self._step()

    # --- without a clock: one of the callers steps -----------------------------------------------

    def _step_or_wait(self, task: _Task) -> None:
        while not task.done:
            with self._changed:
                if self._leading:
                    self._changed.wait(1.0)
                    continue
                self._leading = True
            try:
                while not task.done:
                    with self.turn:
                        self._tick()
                    self._deliver()
                    self.turn.let_others()
            finally:
                with self._changed:
                    self._leading = False
                    self._changed.notify_all()

    # --- with a clock ----------------------------------------------------------------------------

    def _wait(self, task: _Task) -> None:
        while not task.done:
            with self._changed:
                if not task.done:
                    self._changed.wait(_POLL)
            if task.stop.is_set() and not task.done:
                with self.turn:
                    self._drop(task)

    def _keep_time(self, interval: float) -> None:
        due = time.monotonic()
        while not self._closed.is_set():
            early = due - time.monotonic()
            if early > 0:
                # Short waits cost more than they last: at great speeds steps go in bunches.
                self._closed.wait(max(early, 0.004))
                continue
            due = max(due, due - early - _GREATEST_LAG) + interval
            try:
                with self.turn:
                    self._tick()
                self._deliver()
            except Exception as error:  # noqa: BLE001 - raised in the threads that run something
                with self.turn:
                    for task in self._tasks:
                        task.behaviour.close()
                        task.fail(error)
                    self._tasks.clear()
                    self._rest()
                    self._tell_callers()
