"""The language model in a process of its own: `python -m nl2robot.language_model.worker FOLDER
[LEARNED]`.

What the model computes must not hold up a robot's loop, and a model for which there is too little
memory must not take a server with it. So it runs apart, with less right to the processor than
others, and may be killed at any time. One line of JSON in is something to do, lines out tell what
comes of it (`nl2robot.language_model.messages`).
"""

from __future__ import annotations

import os
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path
from queue import SimpleQueue
from typing import BinaryIO, Final

import msgspec

from grammar.planning.model.decoding import Decoder, Full
from grammar.planning.model.recogniser import Partial
from grammar.planning.model.request import Piece, Request, Written
from grammar.planning.model.vocabulary import Vocabulary
from nl2robot.language_model.habits import HABITS, Habits, guessed
from nl2robot.language_model.messages import (
    Cancel,
    Done,
    Failed,
    Growing,
    Order,
    Ready,
    Report,
    Write,
)
from nl2robot.language_model.model import Branch, Cancelled, OnnxModel

NICENESS: Final = 10


class Reading:
    """The model as `grammar.planning.model.decoding.LanguageModel` wants it; without habits it
    guesses nothing."""

    def __init__(self, model: OnnxModel, habits: Habits | None = HABITS) -> None:
        self._tokens = model.tokens
        self.encode = model.tokens.encode
        self.text = model.tokens.text
        self.read = model.read
        self.read_along = model.read_along
        self.following = model.following
        self._habits = habits

    def guess(self, branch: Branch, tokens: Sequence[int]) -> list[int]:
        if self._habits is None:
            return []
        known = len(self._tokens)  # another model may have others
        guesses = guessed(self._habits, (*branch.tokens, *tokens))
        return list(takewhile(lambda token: token < known, guesses))


@dataclass(frozen=True)
class _Last:
    """What was asked last, and the first program for it: whoever asks again wants others, too."""

    asked: tuple[str, tuple[Piece, ...], Vocabulary]
    decoder: Decoder
    first: Written | None


class Worker:
    """Does what it is told, one order after the other; only a cancellation overtakes."""

    def __init__(self, folder: Path, learned: Path | None, out: BinaryIO) -> None:
        self._out = out
        self._encode = msgspec.json.Encoder().encode
        self.orders: SimpleQueue[Write | None] = SimpleQueue()
        self._cancelled: set[int] = set()
        self._now: int | None = None
        self._lock = threading.Lock()
        self._model = OnnxModel(folder, learned=learned)
        self._reading = Reading(self._model)
        self._last: _Last | None = None
        self._prefix = ""
        self._begin: Branch | None = None

    def tell(self, report: Report) -> None:
        self._out.write(self._encode(report) + b"\n")
        self._out.flush()

    def listen(self, source: BinaryIO) -> None:
        """Take orders until there are no more; in a thread of its own."""
        decoder = msgspec.json.Decoder(Order)
        for line in source:
            order = decoder.decode(line)
            if isinstance(order, Cancel):
                self._cancel(order.id)
            else:
                self.orders.put(order)
        self.orders.put(None)
        self._model.cancel()

    def _cancel(self, number: int) -> None:
        with self._lock:
            self._cancelled.add(number)
            if self._now == number:
                self._model.cancel()

    def work(self) -> None:
        """Do what was ordered until nobody is there any more."""
        self.tell(Ready())
        while (order := self.orders.get()) is not None:
            with self._lock:
                self._now = order.id
                if order.id in self._cancelled:  # before it was begun
                    self._model.cancel()
                else:
                    self._model.resume()
            try:
                self._write(order)
            except Cancelled:
                self.tell(Failed(order.id, cancelled=True))
            except Full:
                self.tell(Done(order.id, ()))  # too long for any program to follow
            finally:
                with self._lock:
                    self._now = None
                    self._cancelled.discard(order.id)

    def _write(self, order: Write) -> None:
        request = order.request
        until = _now() + request.seconds
        last = self._last
        if last is None or last.asked != (request.prefix, request.said, request.words):
            last = self._last = None
            last = self._first(order, until)
        if last is None or last.first is None:
            late = last is not None and _now() >= until
            self.tell(Failed(order.id, late=True) if late else Done(order.id, ()))
            return
        self._last = last
        others = last.decoder.others(last.first, request.most - 1, lambda: _now() >= until)
        self.tell(Done(order.id, (last.first, *others)))

    def _first(self, order: Write, until: float) -> _Last | None:
        """Write the first program; None if it was only to get ready for one."""
        request = order.request
        begin = self._begun(request)
        if not request.said:
            return None
        tokens = [
            token
            for piece in request.said
            for token in self._model.tokens.encode(piece.text, control=piece.marks)
        ]
        [prompt] = self._model.read([(begin, tokens)])
        decoder = Decoder(self._reading)
        first = decoder.first(
            prompt,
            Partial.begin(request.words),
            lambda text: self.tell(Growing(order.id, text)),
            lambda: _now() >= until,
        )
        return _Last((request.prefix, request.said, request.words), decoder, first)

    def _begun(self, request: Request) -> Branch:
        """What is read before every sentence, and nothing behind it."""
        if self._begin is None or self._prefix != request.prefix:
            self._begin = None
            self._model.forget(0)
            tokens = self._model.tokens.encode(request.prefix, control=True)
            [self._begin] = self._model.read([(Branch(), tokens)])
            self._prefix = request.prefix
        self._model.forget(len(self._begin.tokens))
        return self._begin


def _now() -> float:
    return time.monotonic()


def main() -> None:
    # What libraries print must not come between the lines.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    with suppress(OSError, AttributeError):
        os.nice(NICENESS)
    folder, *learned = map(Path, sys.argv[1:])
    worker = Worker(folder, learned[0] if learned else None, out)
    threading.Thread(target=worker.listen, args=(sys.stdin.buffer,), daemon=True).start()
    with suppress(BrokenPipeError):
        worker.work()


if __name__ == "__main__":
    main()
