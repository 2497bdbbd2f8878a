"""The calls in flight at a server: each in a worker thread with its stop flag, and how they end.

A `Dispatcher` knows no wire: it is given jobs and calls back when they are done, from any thread.
"""

from __future__ import annotations

import logging
import queue
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Any, Final

from robot_api.driver import Driver, StopFlag
from robot_api.errors import InternalError, RobotError, StopNotConfirmed, Stopped

MAX_ROBOT_CALLS: Final = 64
"""Most robot calls that run at the same time; more of them wait."""
MAX_SERVICE_CALLS: Final = 32
"""The same for services, which have threads of their own: a service that calls the robot would
otherwise wait for itself."""

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
    robot: bool
    """Whether it is a call of the robot, which ends with its connection, and not of a service."""
    moves: bool = False
    """Whether it can set the body in motion."""
    fleeting: bool = False
    """Whether it ends with its connection though it is one of a service."""
    stop: StopFlag = field(default_factory=StopFlag)
    _claim: threading.Lock = field(default_factory=threading.Lock)

    def claim(self) -> bool:
        """True for the first who asks: the worker that runs it, or the stop that came before."""
        return self._claim.acquire(blocking=False)


class Dispatcher:
    """Runs jobs and stops them. Every method may be called from any thread, and returns at once."""

    def __init__(self, driver: Driver) -> None:
        self._driver = driver
        self._lock = threading.Lock()
        self._jobs: set[Job] = set()
        self._robot_workers = Workers("robot call", MAX_ROBOT_CALLS)
        self._service_workers = Workers("service", MAX_SERVICE_CALLS)
        # Stops have threads of their own, so that they wait for nothing, and not for each other:
        # one whose robot does not confirm it must not hold up the next.
        self._stopper = Workers("stop", MAX_STOPS)

    @property
    def in_flight(self) -> int:
        return len(self._jobs)

    def start(self, job: Job) -> None:
        with self._lock:
            self._jobs.add(job)
        # A stop also ends those that still wait for a worker.
        job.stop.on_set(lambda: self._end_unstarted(job))
        workers = self._robot_workers if job.robot else self._service_workers
        workers.do(lambda: self._run(job))

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
        for workers in (self._robot_workers, self._service_workers, self._stopper):
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
    """Threads that do what they are given, at most so many at a time; started when needed.

    They are daemons, unlike those of `concurrent.futures`: a driver that does not come back must
    not keep the process from ending.
    """

    def __init__(self, name: str, most: int) -> None:
        self._name = name
        self._most = most
        self._count = 0
        self._lock = threading.Lock()
        self._idle = threading.Semaphore(0)
        self._waiting: queue.SimpleQueue[Callable[[], None] | None] = queue.SimpleQueue()

    def do(self, task: Callable[[], None]) -> None:
        """Do it as soon as a thread is free."""
        self._waiting.put(task)
        if self._idle.acquire(blocking=False):
            return
        with self._lock:
            if self._count < self._most:
                self._count += 1
                name = f"{self._name} {self._count}"
                threading.Thread(target=self._work, name=name, daemon=True).start()

    def close(self) -> None:
        with self._lock:
            for _ in range(self._count):
                self._waiting.put(None)

    def _work(self) -> None:
        while (task := self._waiting.get()) is not None:
            task()
            self._idle.release()
