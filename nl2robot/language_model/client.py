"""The side of a program that asks the language model's own process (`worker`) to write.

The process is begun when it is first needed and stays. If it dies (too little memory, killed), the
sentence at hand gets no program from it, and the next one begins a new process; one that dies at
every start is not tried again for a while. Who cancels is free at once, whatever the process does:
it loads on, and what it still says of that sentence is not listened to.
"""

from __future__ import annotations

import itertools
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import IO, Final, NamedTuple

import msgspec

from grammar.planning.model.request import Interrupted, Request, TooLate, Unavailable, Written
from nl2robot.language_model.messages import Cancel, Done, Failed, Growing, Ready, Report, Write
from nl2robot.memory import free_megabytes, used_megabytes

STARTS_WITHIN: Final = 60.0
"""Seconds that loading the model may take."""
BESIDES_FILES: Final = 300
"""Megabytes that a model needs besides what its files have."""
LEFT_ALONE: Final = 30.0
"""Seconds after a start that failed, before the next is tried."""
ENDS_WITHIN: Final = 5.0
SILENT: Final = 300.0
"""Seconds without a word after which a process counts as stuck: reading what stands before every
sentence for the first time may take minutes."""


class _GivenUp(NamedTuple):
    """Nobody waits for this sentence any more."""

    id: int


class Process:
    """A `grammar.planning.model.request.Writer` whose model runs in another process; one sentence
    at a time."""

    def __init__(self, folder: Path, learned: Path | None = None) -> None:
        """`learned` is a file of `nl2robot.language_model.changes`."""
        self._folders = [str(path) for path in (folder, learned) if path is not None]
        self._turn = threading.Lock()
        self._state = threading.Lock()
        self._running: _Worker | None = None
        self._numbers = itertools.count(1)
        self._now: int | None = None
        self._cancelled = False
        self._not_before = 0.0

    # --- writing

    def write(
        self, request: Request, on_text: Callable[[str], None] | None = None
    ) -> list[Written]:
        with self._turn:
            with self._state:
                self._cancelled = False
                number = self._now = next(self._numbers)
            try:
                return self._written(number, request, on_text)
            finally:
                with self._state:
                    self._now = None

    def get_ready(self, prefix: str) -> None:
        """Load the model and have it read what stands before every sentence. Raises as `write`."""
        self.write(Request(prefix=prefix))

    def _written(
        self, number: int, request: Request, on_text: Callable[[str], None] | None
    ) -> list[Written]:
        try:
            order = msgspec.json.encode(Write(number, request))
        except UnicodeEncodeError:
            return []  # half a letter, such as a broken terminal sends: no model can read that
        worker = self._ready(number)
        self._send(worker, order)
        try:
            while True:
                match self._heard(worker, number, SILENT):
                    case Growing(id=mine, text=text) if mine == number:
                        if on_text is not None:
                            on_text(text)
                    case Done(id=mine, written=written) if mine == number:
                        # What was written first need not be what turned out the likeliest.
                        return sorted(written, key=lambda each: -each.score)
                    case Failed(id=mine, late=True) if mine == number:
                        raise TooLate
                    case Failed(id=mine, cancelled=cancelled) if mine == number:
                        raise Interrupted if cancelled else self._lost()
                    case _:
                        continue  # of a sentence before
        except (Interrupted, TooLate, Unavailable):
            raise
        except BaseException:  # who looks on, or Ctrl-C: nobody needs the rest
            worker.cancel(number)
            raise

    def cancel(self) -> None:
        with self._state:
            self._cancelled = True
            number, worker = self._now, self._running
        if number is not None and worker is not None:
            worker.reports.put(_GivenUp(number))
            worker.cancel(number)

    # --- the process

    def _send(self, worker: _Worker, order: bytes) -> None:
        try:
            worker.put(order)
        except (OSError, ValueError) as error:
            raise self._lost() from error

    def _heard(self, worker: _Worker, number: int, patience: float) -> Report:
        """What it says next. Raises `Interrupted` when this sentence is given up."""
        while True:
            try:
                report = worker.reports.get(timeout=max(0.0, patience))
            except Empty:
                report = None  # it is stuck
            if report is None:
                raise self._lost()
            if not isinstance(report, _GivenUp):
                return report
            if report.id == number:
                raise Interrupted

    def _ready(self, number: int) -> _Worker:
        """The process with its model loaded; begun if there is none."""
        worker = self._running
        if worker is None or not worker.is_alive:
            self.close()
            if time.monotonic() < self._not_before:
                raise Unavailable(
                    "The language model could not be started a moment ago."
                    " Try again in half a minute, or say it in other words."
                )
            self._need_memory()
            worker = _Worker(self._folders)
            with self._state:
                self._running = worker
                if self._cancelled:
                    raise Interrupted
        while not worker.is_ready:
            try:
                left = worker.begun + STARTS_WITHIN - time.monotonic()
                worker.is_ready = isinstance(self._heard(worker, number, left), Ready)
            except Unavailable:
                self._not_before = time.monotonic() + LEFT_ALONE
                raise
        return worker

    def _need_memory(self) -> None:
        """A process that the system kills for want of memory may take others with it: where there
        is too little, none is begun. Raises `Unavailable`."""
        needed = BESIDES_FILES + sum(
            path.stat().st_size / 1e6 for path in Path(self._folders[0]).glob("*")
        )
        free = free_megabytes()
        if free is not None and free < needed:
            raise Unavailable(
                f"The language model needs about {needed:.0f} MB of memory, and only {free:.0f} MB"
                " are free. Close other programs, or say it in other words."
            )

    def memory(self) -> float | None:
        """How many megabytes its process uses; None where there is none, or nobody knows."""
        worker = self._running
        return None if worker is None else used_megabytes(worker.pid)

    def _lost(self) -> Unavailable:
        """The process is gone, or has to go."""
        self.close()
        return Unavailable(
            "The language model has ended unexpectedly, maybe for want of memory (it needs about"
            " 1.6 GB, the small one 0.7 GB). Say it in shorter sentences, or free some memory."
        )

    def close(self) -> None:
        """End the process, if there is one."""
        with self._state:
            worker, self._running = self._running, None
        if worker is not None:
            worker.close()


_SPARING: Final = {"MALLOC_MMAP_THRESHOLD_": "65536"}
"""Has the C library of Linux give large pieces back as soon as they are free: 50 MB less."""


class _Worker:
    """One process, and what it says."""

    def __init__(self, folders: Sequence[str]) -> None:
        self.begun = time.monotonic()
        self.is_ready = False
        """Whether it has loaded its model."""
        self.reports: SimpleQueue[Report | _GivenUp | None] = SimpleQueue()
        """None: it says nothing more."""
        self._pipe = threading.Lock()
        self._process = subprocess.Popen(
            [sys.executable, "-m", "nl2robot.language_model.worker", *folders],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,  # Ctrl-C gives up a sentence; the model is loaded for the next
            env=os.environ | _SPARING,
        )
        self._listener = threading.Thread(
            target=self._listen, args=(_stream(self._process.stdout),), daemon=True
        )
        self._listener.start()

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def is_alive(self) -> bool:
        return self._process.poll() is None

    def put(self, order: bytes) -> None:
        """Raises `OSError` or `ValueError` if nobody is there any more."""
        stream = _stream(self._process.stdin)
        with self._pipe:
            stream.write(order + b"\n")
            stream.flush()

    def cancel(self, number: int) -> None:
        with suppress(OSError, ValueError):
            self.put(msgspec.json.encode(Cancel(number)))

    def _listen(self, stream: IO[bytes]) -> None:
        decode = msgspec.json.Decoder(Report).decode
        with suppress(OSError, ValueError):  # it is closed, or talks nonsense
            for line in stream:
                self.reports.put(decode(line))
        self.reports.put(None)

    def close(self) -> None:
        self._process.kill()
        self._process.wait()
        self._listener.join(ENDS_WITHIN)
        for stream in (self._process.stdin, self._process.stdout):
            with suppress(OSError):
                _stream(stream).close()


def _stream(stream: IO[bytes] | None) -> IO[bytes]:
    assert stream is not None, "the process was begun with pipes"
    return stream
