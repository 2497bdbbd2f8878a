"""A writer that knows its programs by heart: for tests, and for trying what people see while a
model writes, without one.

    ScriptedWriter({"wheel the tea round": ["say(\\"Tea!\\")"]})
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence

from grammar.planning.model.request import Interrupted, Request, Unavailable, Written


class ScriptedWriter:
    """A `grammar.planning.model.request.Writer`: the likeliest program of a sentence first.

    While `held` is set, nothing is written beyond the first line of a program, until it is cleared
    or the writing is cancelled. With `ill`, there is no model, for this reason.
    """

    def __init__(self, programs: Mapping[str, Sequence[str]], ill: str = "") -> None:
        self._programs = programs
        self.ill = ill
        self.asked: list[Request] = []
        """All that was asked for so far."""
        self.held = threading.Event()
        self._changed = threading.Condition()
        self._cancelled = False

    def write(
        self, request: Request, on_text: Callable[[str], None] | None = None
    ) -> list[Written]:
        self.asked.append(request)
        self._cancelled = False
        if self.ill:
            raise Unavailable(self.ill)
        programs = self._programs.get(request.words.said, ())[: request.most]
        if programs and on_text is not None:
            lines = programs[0].splitlines(keepends=True)
            on_text(lines[0])
            self._wait()
            for number in range(2, len(lines) + 1):
                on_text("".join(lines[:number]))
        else:
            self._wait()
        return [
            Written(text, -0.1 - number, 0.9 - 0.1 * number, len(text) // 3)
            for number, text in enumerate(programs)
        ]

    def _wait(self) -> None:
        with self._changed:
            while self.held.is_set() and not self._cancelled:
                self._changed.wait(0.01)
            if self._cancelled:
                raise Interrupted

    def cancel(self) -> None:
        with self._changed:
            self._cancelled = True
            self._changed.notify_all()
