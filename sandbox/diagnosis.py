"""What the interpreter's parser and type checker say of a program; nothing of it is run."""

from __future__ import annotations

import atexit
import json
import os
import threading
from dataclasses import dataclass
from typing import Final, Self

import pydantic_monty as monty

from robot_api.errors import cause
from sandbox.worker import FAILURES, Unavailable, Worker

_MEMORY: Final = 200_000_000
"""Bytes of data for a check."""


class _Replaced(RuntimeError):
    """The worker has died unasked, and Monty has started another, which no wall is around."""


@dataclass(frozen=True)
class Diagnostic:
    """What the type checker says of a program, in its own words; line and column count from 1."""

    line: int
    column: int
    code: str
    message: str


def diagnose(program: str, stub: str, seconds: float = 60.0) -> list[Diagnostic]:
    """What Monty's parser and type checker say of a program; nothing of it is run. A check takes
    milliseconds; after so many `seconds` by the clock on the wall it is given up, far above what a
    busy machine needs. Raises `Unavailable`."""
    with CHECKER as kept:
        try:
            try:
                return _diagnosed(program, stub, kept.worker(seconds))
            except (monty.MontyCrashedError, _Replaced) as error:
                if isinstance(error, monty.MontyCrashedError) and error.timed_out:
                    raise
                kept.close()  # Ctrl-C ends the worker as well, wherever it was at
                return _diagnosed(program, stub, kept.worker(seconds))
        except monty.MontyCrashedError as error:
            kept.close()
            if not error.timed_out:
                raise Unavailable(cause(error)) from error
            message = "CheckError: The program is too involved to be checked. Make it simpler"
            return [Diagnostic(1, 1, "unsupported", message)]
        except FAILURES as error:
            kept.close()
            raise Unavailable(cause(error)) from error


class Checker:
    """The worker that checks programs, kept for the next one: to start it takes forty times as long
    as a check."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._worker: Worker | None = None
        self._of: tuple[int, float] | None = None
        """The process that it belongs to, which a fork is not, and its seconds for a check."""

    def __enter__(self) -> Self:
        self._lock.acquire()
        return self

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    def worker(self, seconds: float) -> Worker:
        """To be asked for under the lock."""
        of = (os.getpid(), seconds)
        if self._worker is None or self._of != of:
            if self._of is not None and self._of[0] == of[0]:
                self.close()
            self._worker = Worker(
                lambda pool: pool.checkout(), memory=_MEMORY, request_timeout=seconds
            )
            self._of = of
            self._worker.leave()
        return self._worker

    def close(self) -> None:
        """Let go of the worker; the next check starts another."""
        worker, self._worker = self._worker, None
        if worker is not None and self._of is not None and self._of[0] == os.getpid():
            worker.close()


CHECKER: Final = Checker()
atexit.register(CHECKER.close)


def _diagnosed(program: str, stub: str, worker: Worker) -> list[Diagnostic]:
    # The name is looked up before anything else happens, and never found.
    guard = "program_starts_here"
    with (
        worker.pool.checkout(
            limits={"max_memory": _MEMORY},
            type_check=True,
            type_check_stubs=f"{stub}\n{guard}: int\n",
            type_check_format="json",
        ) as session,
    ):
        if session.worker_pid != worker.process:
            raise _Replaced
        try:
            snapshot = session.feed_start(f"{guard}\n{program}")
            while isinstance(snapshot, monty.FunctionSnapshot) and snapshot.is_os_function:
                snapshot = snapshot.resume_not_handled()  # stubs of modules that do not exist
        except monty.MontyTypingError as error:
            return [
                Diagnostic(
                    each["location"]["row"] - 1,
                    each["location"]["column"],
                    each["code"],
                    each["message"],
                )
                for each in json.loads(error.display())
                if each["severity"] == "error"
            ]
        except monty.MontyCrashedError:
            raise
        except monty.MontyError as error:
            frames: list[monty.Frame] = getattr(error, "traceback", list)()
            line = frames[-1].line - 1 if frames else 1
            column = frames[-1].column if frames else 1
            return [Diagnostic(max(1, line), column, "unsupported", str(error))]
    return []
