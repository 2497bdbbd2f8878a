"""The side of a program that asks the language model's own process (`worker`) to write.

The process is begun when it is first needed and stays. If it dies (too little memory, killed), the
sentence at hand gets no program from it, and the next one begins a new process; one that dies at
every start is not tried again for a while.
"""

from __future__ import annotations

import itertools
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import IO, Any, Final

import msgspec

from grammar.planning.model.request import Interrupted, Request, Unavailable, Written
from nl2robot.language_model.messages import Cancel, Done, Failed, Growing, Order, Report, Write

STARTS_WITHIN: Final = 60.0
"""Seconds that loading the model may take."""
LEFT_ALONE: Final = 30.0
"""Seconds after a start that failed, before the next is tried."""


class Process:
    """A `grammar.planning.model.request.Writer` whose model runs in another process; one sentence
    at a time."""

    def __init__(self, folder: Path, learned: Path | None = None) -> None:
        """`learned` is a file of `nl2robot.language_model.changes`."""
        self._folders = [str(path) for path in (folder, learned) if path is not None]
        self._turn = threading.Lock()
        self._state = threading.Lock()
        self._running: subprocess.Popen[bytes] | None = None
        self._numbers = itertools.count(1)
        self._now: int | None = None
        self._cancelled = False
        self._not_before = 0.0
        self._encode = msgspec.json.Encoder().encode
        self._decode = msgspec.json.Decoder(Report).decode

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
        self._send(Write(number, request))
        while True:
            match self._heard():
                case Growing(id=mine, text=text) if mine == number:
                    if on_text is not None:
                        on_text(text)
                case Done(id=mine, written=written) if mine == number:
                    return list(written)
                case Failed(id=mine) if mine == number:
                    raise Interrupted
                case _:
                    continue  # of a sentence before

    def cancel(self) -> None:
        with self._state:
            self._cancelled = True
            number, process = self._now, self._running
        if number is not None and process is not None:
            with suppress(OSError, ValueError):
                self._put(process, Cancel(number))

    # --- the process

    def _send(self, order: Order) -> None:
        process = self._process()
        try:
            self._put(process, order)
        except (OSError, ValueError) as error:
            raise self._lost() from error

    def _put(self, process: subprocess.Popen[bytes], order: Order) -> None:
        stream = _stream(process.stdin)
        with self._state:
            stream.write(self._encode(order) + b"\n")
            stream.flush()

    def _heard(self) -> Any:
        process = self._running
        line = _stream(process.stdout).readline() if process is not None else b""
        with self._state:
            cancelled = self._cancelled
        if not line:
            lost = self._lost()
            raise Interrupted if cancelled else lost
        return self._decode(line)

    def _process(self) -> subprocess.Popen[bytes]:
        running = self._running
        if running is not None and running.poll() is None:
            return running
        if time.monotonic() < self._not_before:
            raise Unavailable(
                "The language model could not be started a moment ago."
                " Try again in half a minute, or say it in other words."
            )
        command = [sys.executable, "-m", "nl2robot.language_model.worker", *self._folders]
        process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,  # Ctrl-C gives up a sentence; the model is loaded for the next
        )
        with self._state:
            self._running = process
        patience = threading.Timer(STARTS_WITHIN, process.kill)
        patience.daemon = True
        patience.start()
        try:
            if not _stream(process.stdout).readline():
                self._not_before = time.monotonic() + LEFT_ALONE
                raise self._lost()
        finally:
            patience.cancel()
        return process

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
            process, self._running = self._running, None
        if process is None:
            return
        process.kill()
        process.wait()
        for stream in (process.stdin, process.stdout):
            with suppress(OSError):
                _stream(stream).close()


def _stream(stream: IO[bytes] | None) -> IO[bytes]:
    assert stream is not None, "the process was begun with pipes"
    return stream
