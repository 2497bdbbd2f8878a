"""Waiting for a language model: what it is at is told meanwhile, and whoever waits can give it up.

Rules answer in milliseconds, a model takes seconds, and does not look up at every moment of them.
So what may take long is thought about in a thread of its own, which is left to itself when it is
given up.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final, Generic, Literal, TypeVar

from grammar.planning.planner import Interrupted, Watch

T = TypeVar("T")

EVENT: Final = "translation"
"""The kind of event that tells of it on the wire."""
OFTEN: Final = 0.1
"""Seconds between two events that tell how far a program is written, at least."""
LOOK_UP: Final = 0.1
"""Seconds after which a waiting main thread looks up: the system may hand a Ctrl-C to another
thread."""


@dataclass(frozen=True)
class Progress:
    """How far it is."""

    what: Literal["thinking", "writing"]
    text: str = ""
    """The program as far as it is written."""


OnProgress = Callable[[Progress], None]
"""Called from the thread that thinks; must not block."""


class Thought(Generic[T]):
    """Something that is thought about; begun when it is made. Any thread may use it."""

    def __init__(self, think: Callable[[Watch], T], on_progress: OnProgress | None = None) -> None:
        self._changed = threading.Condition()
        self._on_progress = on_progress
        self._watch = Watch(
            thinking=lambda: self._tell(Progress("thinking")),
            writing=lambda text: self._tell(Progress("writing", text)),
        )
        self._takes_long = False
        self._over = False
        self._result: T | None = None
        self._error: BaseException | None = None
        threading.Thread(target=self._run, args=(think,), name="thinking", daemon=True).start()

    @property
    def over(self) -> bool:
        return self._over

    def result(self) -> T:
        """Wait for what came of it. Raises what it raised, and `Interrupted` once it is given
        up."""
        main = threading.current_thread() is threading.main_thread()
        with self._changed:
            while not self._changed.wait_for(lambda: self._over, LOOK_UP if main else None):
                pass
        if self._error is not None:
            raise self._error
        return self._result  # type: ignore[return-value]

    def wait_a_moment(self, seconds: float) -> bool:
        """Wait so long, but no longer than until it is known to take long; whether it is over."""
        with self._changed:
            self._changed.wait_for(lambda: self._over or self._takes_long, seconds)
            return self._over

    def give_up(self) -> None:
        """Whoever waits is told at once; who thinks, as soon as they look up."""
        if self._end(None, Interrupted()):
            # What writes may take a moment to hear of it; a robot that is to be stopped has none.
            threading.Thread(target=self._watch.cancel, name="giving up", daemon=True).start()

    def _run(self, think: Callable[[Watch], T]) -> None:
        try:
            self._end(think(self._watch), None)
        except BaseException as error:  # noqa: BLE001 - it is for whoever waits
            self._end(None, error)

    def _end(self, result: T | None, error: BaseException | None) -> bool:
        """Whether it was not over yet."""
        with self._changed:
            if self._over:
                return False
            self._over, self._result, self._error = True, result, error
            self._changed.notify_all()
            return True

    def _tell(self, progress: Progress) -> None:
        with self._changed:
            if self._over:
                return
            self._takes_long = True
            self._changed.notify_all()
        if self._on_progress is not None:
            self._on_progress(progress)


def published(
    publish: Callable[[str, Mapping[str, Any]], None],
    about: Mapping[str, Any],
    clock: Callable[[], float] = time.monotonic,
) -> OnProgress:
    """Tells of it in events with the data `about` which thought it is; not of every letter."""
    last = -OFTEN

    def tell(progress: Progress) -> None:
        nonlocal last
        now = clock()
        if progress.what == "writing":
            if now - last < OFTEN:
                return
            last = now
        text = {"text": progress.text} if progress.what == "writing" else {}
        publish(EVENT, {"what": progress.what, **about, **text})

    return tell
