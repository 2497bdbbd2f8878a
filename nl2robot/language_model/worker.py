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
from contextlib import suppress
from pathlib import Path
from queue import SimpleQueue
from typing import BinaryIO, Final

import msgspec

from grammar.planning.model.decoding import Decoder, Full
from grammar.planning.model.recogniser import Partial
from grammar.planning.model.request import Request
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
from nl2robot.language_model.remembered import remembered

NICENESS: Final = 10


class _Reading:
    """The model as `grammar.planning.model.decoding.LanguageModel` wants it."""

    def __init__(self, model: OnnxModel) -> None:
        self.encode = model.tokens.encode
        self.text = model.tokens.text
        self.read = model.read
        self.following = model.following


class Worker:
    """Does what it is told, one order after the other; only a cancellation overtakes."""

    def __init__(self, folder: Path, learned: Path | None, out: BinaryIO) -> None:
        self._folder = folder
        self._out = out
        self._encode = msgspec.json.Encoder().encode
        self.orders: SimpleQueue[Write | None] = SimpleQueue()
        self._cancelled: set[int] = set()
        self._now: int | None = None
        self._lock = threading.Lock()
        self._model = OnnxModel(folder, learned=learned)
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
        until = time.monotonic() + request.seconds
        begin = self._begun(request)
        if not request.said:
            self.tell(Done(order.id, ()))
            return
        tokens = [
            token
            for piece in request.said
            for token in self._model.tokens.encode(piece.text, control=piece.marks)
        ]
        [prompt] = self._model.read([(begin, tokens)])
        decoder = Decoder(_Reading(self._model))
        written = decoder.written(
            prompt,
            Partial.begin(request.words),
            request.most,
            lambda text: self.tell(Growing(order.id, text)),
            lambda: time.monotonic() >= until,
        )
        self.tell(Done(order.id, tuple(written)))

    def _begun(self, request: Request) -> Branch:
        """What is read before every sentence, and nothing behind it."""
        if self._begin is None or self._prefix != request.prefix:
            self._begin = None
            self._begin = remembered(self._model, self._folder, request.prefix)
            self._prefix = request.prefix
        self._model.forget(len(self._begin.tokens))
        return self._begin


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
