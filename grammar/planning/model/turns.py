"""Who waits for a language model that writes one program at a time."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from grammar.planning.planner import Interrupted, Watch


class Turns:
    """Served as they came; who gives up leaves the line at once, wherever they stand in it."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._line: list[Watch] = []

    @contextmanager
    def taken(self, watch: Watch) -> Iterator[None]:
        """Wait for a turn and keep it while this lasts. Raises `Interrupted` when `watch` is
        cancelled before that."""
        with self._changed:
            self._line.append(watch)
        try:
            with watch.cancelling(self._look), self._changed:
                self._changed.wait_for(lambda: watch.cancelled or self._line[0] is watch)
            if watch.cancelled:
                raise Interrupted
            yield
        finally:
            with self._changed:
                self._line.remove(watch)
                self._changed.notify_all()

    def _look(self) -> None:
        with self._changed:
            self._changed.notify_all()
