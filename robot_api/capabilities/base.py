"""What every capability of a robot is built on."""

from __future__ import annotations

import logging
import threading
from abc import ABC
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, ClassVar

from robot_api.capabilities.tablet import NO_TABLET, Tablet
from robot_api.driver import Event, StopFlag
from robot_api.methods import METHODS

Listener = Callable[[str, Event], None]

_log = logging.getLogger(__name__)

POLL = 0.01
"""Seconds of real time between two looks at the stop flag while something is waited for."""


class Capability(ABC):
    """One capability of a robot. A subclass has the methods of the table that need it.

    Each such method takes a `StopFlag` first, then the parameters of the table by name, all of
    them: the driver fills in the defaults. A method that takes long looks at the flag at least
    every 20 ms and raises `Stopped` once it is set.
    """

    name: ClassVar[str]
    """Its name in the table: `Method.capability`."""
    lacking: ClassVar[str]
    """Why a robot without it cannot do its methods, after "this robot": "has no hand"."""
    stand_in: str | None = None
    """What does it in the place of the robot's own body, for people: "a face on the screen"; None
    if the robot does it itself."""
    tablet: Tablet = NO_TABLET
    """A real tablet, for the capabilities that people meet on its screen."""

    def offers(self) -> tuple[str, ...]:
        """The methods it does; a robot that can do only some of them names these."""
        return tuple(name for name, method in METHODS.items() if method.capability == self.name)

    def declares(self) -> dict[str, Any]:
        """What it adds to the robot's `Capabilities`, field by field."""
        return {}


class Hub:
    """Hands each event on to those who subscribed. Any thread may call any of it."""

    def __init__(self) -> None:
        self._listeners: dict[int, Listener] = {}
        self._next = 0
        self._lock = threading.Lock()

    def subscribe(self, listener: Listener) -> Callable[[], None]:
        """Call `listener(kind, data)` for each event from now on; returns what ends it."""
        with self._lock:
            number, self._next = self._next, self._next + 1
            self._listeners[number] = listener

        def unsubscribe() -> None:
            with self._lock:
                self._listeners.pop(number, None)

        return unsubscribe

    def publish(self, kind: str, **data: Any) -> None:
        """Tell all listeners, in this thread. `kind` and its data are those of `EVENTS`. One with
        a fault takes it from nobody else, nor from the robot."""
        self.forward(kind, data)

    def forward(self, kind: str, data: Event) -> None:
        """As `publish`."""
        with self._lock:
            listeners = list(self._listeners.values())
        for listener in listeners:
            try:
                listener(kind, data)
            except Exception:  # noqa: BLE001 - whatever it was, the next one is told
                _log.exception("a listener failed at the event '%s'", kind)


class Turns:
    """Lets one thread in after the other: a robot has one voice and one screen to touch."""

    def __init__(self) -> None:
        self._lock = threading.Lock()

    @contextmanager
    def mine(self, stop: StopFlag) -> Iterator[None]:
        """Wait for the turn and have it; raises `Stopped` while waiting if `stop` is set."""
        while not self._lock.acquire(timeout=POLL):
            stop.check()
        try:
            yield
        finally:
            self._lock.release()
