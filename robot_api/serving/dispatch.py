"""The calls in flight at a server: each in a worker thread with its stop flag, and how they end.

A `Dispatcher` knows no wire: it is given jobs and calls back when they are done, from any thread.
"""

from __future__ import annotations

import logging
import queue
import threading
from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Literal

from robot_api.driver import Driver, StopFlag
from robot_api.errors import InternalError, RobotError, StopNotConfirmed, Stopped

Lane = Literal["robot", "control", "work", "look", "wait"]
"""Where calls run, so that none has to wait for those of another sort: a service that calls the
robot would otherwise wait for itself, and who ends a program for who waits for its end.

- robot: what the robot does
- control: services that answer at once, such as those that pause and end a program
- work: those that take their time
- look: the same for guests who may only look on
- wait: those that last as long as something else does
"""
LANES: Final[Mapping[Lane, tuple[int, int]]] = {
    "robot": (256, 64),
    "control": (32, 8),
    "work": (32, 8),
    "look": (16, 4),
    "wait": (128, 16),
}
"""Of each lane the most calls that run at the same time, and the most of one connection: more of
them wait for the others of theirs."""

MAX_STOPS: Final = 64
"""Most stops that wait for the robot's confirmation at the same time."""

_log = logging.getLogger("robot_api.server")

Result = Any
Error = RobotError | Stopped
Done = Callable[[Result, Error | None], None]
"""Called once with the result, or with the error; from any thread, and must not block."""


@dataclass(eq=False)
class Job:
    """A call in flight."""

    name: str
    """The method, for the log."""
    run: Callable[[StopFlag], Any]
    """Does it, and returns its result."""
    done: Done
    owner: object
    """The connection it came from."""
    lane: Lane
    moves: bool = False
    """Whether it can set the body in motion."""
    fleeting: bool = False
    """Whether it ends with its connection though it is one of a service."""
    after_stop: bool = False
    """Whether it is begun even if it is stopped before: it looks at the flag itself."""
    stop: StopFlag = field(default_factory=StopFlag)
    _claim: threading.Lock = field(default_factory=threading.Lock)

    @property
    def robot(self) -> bool:
        """Whether it is a call of the robot, which ends with its connection, and not of a
        service."""
        return self.lane == "robot"

    def claim(self) -> bool:
        """True for the first who asks: the worker that runs it, or the stop that came before."""
        return self._claim.acquire(blocking=False)


class Dispatcher:
    """Runs jobs and stops them. Every method may be called from any thread, and returns at once."""

    def __init__(self, driver: Driver) -> None:
        self._driver = driver
        self._lock = threading.Lock()
        self._jobs: set[Job] = set()
        self._lanes = {lane: Workers(lane, most, each) for lane, (most, each) in LANES.items()}
        # Stops have threads of their own, so that they wait for nothing, and not for each other:
        # one whose robot does not confirm it must not hold up the next.
        self._stopper = Workers("stop", MAX_STOPS)

    @property
    def in_flight(self) -> int:
        return len(self._jobs)

    @property
    def moves(self) -> bool:
        """Whether a call is in flight that may move the robot."""
        with self._lock:
            return any(job.moves for job in self._jobs)

    def start(self, job: Job) -> None:
        with self._lock:
            self._jobs.add(job)
        if not job.after_stop:  # a stop also ends those that still wait for a worker
            job.stop.on_set(lambda: self._end_unstarted(job))
        self._lanes[job.lane].do(lambda: self._run(job), job.owner)

    def cancel(self, job: Job, because: str = "The call was cancelled.") -> None:
        """Set the job's stop flag."""
        self._stopper.do(lambda: _set_all([job], because))

    def stop(self, because: str, done: Done) -> None:
        """Stop every job in flight, then the body; `done` when the robot has confirmed that it
        stands, or has not in time."""
        with self._lock:
            jobs = list(self._jobs)
        self._stopper.do(lambda: self._stop(jobs, because, done))

    def drop(self, owner: object) -> None:
        """Stop the robot calls of a connection that is gone; services go on, but for those that
        are of no use without it."""
        because = "The connection to whoever asked for it was lost."
        with self._lock:
            robots = [job for job in self._jobs if job.robot]
            fleeting = [job for job in self._jobs if job.fleeting and job.owner is owner]
        self._stopper.do(lambda: _set_all(fleeting, because))
        lost = [job for job in robots if job.owner is owner]
        # A driver stops the whole robot; if others use it too, the flags must do.
        if any(job.moves for job in lost) and len(lost) == len(robots):
            self._stopper.do(lambda: self._stop(lost, because, _ignore))
        else:
            self._stopper.do(lambda: _set_all(lost, because))

    def close(self) -> None:
        """Let the threads end, each after the job it is at."""
        for workers in (*self._lanes.values(), self._stopper):
            workers.close()

    def _run(self, job: Job) -> None:
        if not job.claim():
            return
        try:
            self._finish(job, job.run(job.stop), None)
        except (RobotError, Stopped) as error:
            self._finish(job, None, error)
        except BaseException:  # noqa: BLE001 - whatever a driver raises must be answered
            _log.exception("%s failed", job.name)
            sentence = f"The robot's software has a fault: {job.name} failed. Its log says why."
            self._finish(job, None, InternalError(sentence))

    def _end_unstarted(self, job: Job) -> None:
        if job.claim():
            try:
                job.stop.check()
            except Stopped as stopped:
                self._finish(job, None, stopped)

    def _finish(self, job: Job, result: Result, error: Error | None) -> None:
        with self._lock:
            self._jobs.discard(job)
        job.done(result, error)

    def _stop(self, jobs: Iterable[Job], because: str, done: Done) -> None:
        error: Error | None = None
        try:
            _set_all(jobs, because)
            self._driver.stop(because)
        except StopNotConfirmed as unconfirmed:
            error = unconfirmed
        except BaseException:  # noqa: BLE001 - whatever a driver raises must be answered
            _log.exception("the driver failed to stop")
            error = InternalError("The robot's software has a fault: it may not have stopped.")
        done(None, error)


def _set_all(jobs: Iterable[Job], because: str) -> None:
    for job in jobs:
        try:
            job.stop.set(because)
        except BaseException:  # noqa: BLE001 - what one call does when stopped must not save another
            _log.exception("%s failed when it was stopped", job.name)


def _ignore(result: Result, error: Error | None) -> None:
    """Nobody waits for this."""


class Workers:
    """Threads that do what they are given, at most so many at a time, and of each owner at most
    `each`; started when needed.

    They are daemons, unlike those of `concurrent.futures`: a driver that does not come back must
    not keep the process from ending.
    """

    def __init__(self, name: str, most: int, each: int | None = None) -> None:
        self._name = name
        self._most = most
        self._each = each
        self._count = 0
        self._lock = threading.Lock()
        self._at_it: Counter[object] = Counter()
        self._held: dict[object, deque[Callable[[], None]]] = {}
        """What waits for another of the same owner's to end."""
        self._idle = threading.Semaphore(0)
        self._waiting: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()

    def do(self, task: Callable[[], None], owner: object = None) -> None:
        """Do it as soon as a thread is free, and its owner has not too much done already."""
        if owner is None or self._each is None:
            self._do(task)
            return
        with self._lock:
            if self._at_it[owner] >= self._each:
                self._held.setdefault(owner, deque()).append(task)
                return
            self._at_it[owner] += 1
        self._do(lambda: self._in_turn(task, owner))

    def close(self) -> None:
        with self._lock:
            for _ in range(self._count):
                self._waiting.put(None)

    def _do(self, task: Callable[[], None]) -> None:
        self._waiting.put(task)
        if self._idle.acquire(blocking=False):
            return
        with self._lock:
            if self._count < self._most:
                self._count += 1
                name = f"{self._name} {self._count}"
                threading.Thread(target=self._work, name=name, daemon=True).start()

    def _in_turn(self, task: Callable[[], None], owner: object) -> None:
        try:
            task()
        finally:
            with self._lock:
                held = self._held.get(owner)
                after = held.popleft() if held else None
                if not held:
                    self._held.pop(owner, None)
                if after is None:
                    self._at_it[owner] -= 1
                    if not self._at_it[owner]:
                        del self._at_it[owner]
            if after is not None:
                self._do(lambda: self._in_turn(after, owner))

    def _work(self) -> None:
        while (task := self._waiting.get()) is not None:
            task()
            self._idle.release()
