"""The other end of the pipes to a process that speaks (`voice_worker`).

    ESPEAK = VoiceProcess("espeak")
    ESPEAK.ask({"do": "tell", "voice": "en-us", "text": "Hey robot!"}, never)

It is begun when it is first asked and stays. If it dies (too little memory, killed), another is
begun and asked the same, once: nobody hears more of it than a moment's silence. It ends with
whoever began it, however that ends. Who stops asking is free at once, whatever it is doing.
"""

from __future__ import annotations

import itertools
import json
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from io import FileIO
from pathlib import Path
from queue import Empty, SimpleQueue
from struct import Struct
from typing import Any, Final, NamedTuple, cast

from nl2robot.child_processes import look_after

WORKER: Final = Path(__file__).with_name("voice_worker.py")
ATTEMPTS: Final = 2
POLL: Final = 0.02
"""Seconds after which it is looked whether somebody has stopped it."""
PATIENCE: Final = 60.0
"""Seconds without an answer after which it counts as stuck: loading a voice takes its time."""
LEFT_ALONE: Final = 30.0
"""Seconds after a start that failed, before the next is tried."""
ENDS_WITHIN: Final = 5.0
MOST: Final = 1 << 26
"""Bytes of an answer: twenty minutes of speech, where ten seconds are asked for."""

_LENGTHS: Final = Struct(">II")


class Answer(NamedTuple):
    head: Mapping[str, Any]
    body: bytearray


class CannotSpeak(Exception):
    """Why, in a word: "start", "ended", or what the process says ("voice", "model")."""


class _Gone(Exception):
    """The process has ended, or has to."""


class VoiceProcess:
    """Any thread may ask; one at a time is answered."""

    def __init__(self, kind: str) -> None:
        """`kind` is what `voice_worker` calls it: "espeak" or "piper"."""
        self._kind = kind
        self._turn = threading.Lock()
        self._state = threading.Lock()
        self._worker: _Worker | None = None
        self._numbers = itertools.count(1)
        self._not_before = 0.0
        self._is_over = False
        look_after(self)

    @property
    def pid(self) -> int | None:
        """The number of the process; None where there is none."""
        worker = self._worker
        return None if worker is None else worker.pid

    def ask(self, order: Mapping[str, Any], stopped: Callable[[], bool]) -> Answer | None:
        """What comes of it; None if it is `stopped` before. Raises `CannotSpeak`."""
        while not self._turn.acquire(timeout=POLL):
            if stopped():
                return None
        try:
            was_ready = False
            for _ in range(ATTEMPTS):
                worker = self._begun()
                if worker is None or stopped():
                    return None
                try:
                    return self._answered(worker, order, stopped)
                except _Gone:
                    was_ready = worker.is_ready
                    self._end()
            if was_ready:
                raise CannotSpeak("ended")
            self._not_before = time.monotonic() + LEFT_ALONE
            raise CannotSpeak("start")
        finally:
            self._turn.release()

    def _begun(self) -> _Worker | None:
        """The process, or a new one; None if all ends."""
        worker = self._worker
        if worker is not None and worker.is_alive:
            return worker
        self._end()
        if time.monotonic() < self._not_before:
            raise CannotSpeak("start")
        with self._state:
            if self._is_over:
                return None
            self._worker = _Worker(self._kind)
            return self._worker

    def _answered(
        self, worker: _Worker, order: Mapping[str, Any], stopped: Callable[[], bool]
    ) -> Answer | None:
        number = next(self._numbers)
        worker.put({"id": number, **order})
        until = time.monotonic() + PATIENCE
        try:
            while True:
                try:
                    answer = worker.answers.get(timeout=POLL)
                except Empty:
                    if stopped():
                        worker.cancel(number)
                        return None
                    if time.monotonic() > until:
                        self._end()
                        raise CannotSpeak("ended") from None
                    continue
                if answer is None or answer.head.get("ready") is False:
                    raise _Gone
                if answer.head.get("ready"):
                    worker.is_ready = True
                elif answer.head.get("id") == number:  # else of somebody who stopped asking
                    break
        except (CannotSpeak, _Gone):
            raise
        except BaseException:  # Ctrl-C, say: nobody needs the rest
            worker.cancel(number)
            raise
        if "cannot" in answer.head:
            raise CannotSpeak(str(answer.head["cannot"]))
        return answer

    def _end(self) -> None:
        with self._state:
            worker, self._worker = self._worker, None
        if worker is not None:
            worker.close()

    def close(self) -> None:
        """End the process, if there is one; whoever asks next begins another."""
        self._end()

    def close_for_good(self) -> None:
        """When Python ends: a thread that still speaks begins none any more."""
        with self._state:
            self._is_over = True
        self._end()

    def forget(self) -> None:
        """In a copy of this process (`fork`): the one that speaks is that of the first."""
        self._turn, self._state = threading.Lock(), threading.Lock()
        worker, self._worker = self._worker, None
        if worker is not None:
            worker.forget()


class _Worker:
    """One process, and what it answers."""

    def __init__(self, kind: str) -> None:
        self.is_ready = False
        """Whether what speaks in it has been started."""
        self.answers: SimpleQueue[Answer | None] = SimpleQueue()
        """None: there will be no more."""
        self._process = subprocess.Popen(
            # -P: no file that lies beside it is taken for a module that piper imports.
            [sys.executable, "-P", str(WORKER), kind],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            bufsize=0,  # so that a copy of this process can let go of the pipes
            start_new_session=True,  # Ctrl-C ends what is said; the voice is there for the next
        )
        self._orders = cast(FileIO, self._process.stdin)
        self._source = cast(FileIO, self._process.stdout)
        self._listener = threading.Thread(target=self._listen, name="speaks", daemon=True)
        self._listener.start()

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def is_alive(self) -> bool:
        return self._process.poll() is None

    def put(self, order: Mapping[str, Any]) -> None:
        """Raises `_Gone`."""
        head = json.dumps(order).encode()
        left = memoryview(_LENGTHS.pack(len(head), 0) + head)
        try:
            while left:
                left = left[self._orders.write(left) or 0 :]
        except (OSError, ValueError) as error:  # nobody reads it, or it was closed
            raise _Gone from error

    def cancel(self, number: int) -> None:
        with suppress(_Gone):
            self.put({"id": number, "do": "cancel"})

    def _listen(self) -> None:
        with suppress(OSError, ValueError):  # it is closed, or talks nonsense
            while (answer := self._next()) is not None:
                self.answers.put(answer)
        self.answers.put(None)

    def _next(self) -> Answer | None:
        lengths = self._exactly(_LENGTHS.size)
        if lengths is None:
            return None
        size, more = _LENGTHS.unpack(lengths)
        if size + more > MOST:
            raise ValueError
        head, body = self._exactly(size), self._exactly(more)
        if head is None or body is None:
            return None
        known = json.loads(head)
        if not isinstance(known, dict):
            raise ValueError
        return Answer(known, body)

    def _exactly(self, size: int) -> bytearray | None:
        """So many bytes; None if there are no more."""
        data = bytearray(size)
        left = memoryview(data)
        while left:
            count = self._source.readinto(left)
            if not count:
                return None
            left = left[count:]
        return data

    def close(self) -> None:
        self._process.kill()
        self._process.wait()
        self._listener.join(ENDS_WITHIN)
        self._let_go()

    def forget(self) -> None:
        self._process.returncode = 0  # that of somebody else, who waits for it
        self._let_go()

    def _let_go(self) -> None:
        for stream in (self._orders, self._source):
            with suppress(OSError):
                stream.close()
