"""Whether a robot can be reached: a state that everybody sees.

A driver of a real robot tells its `Link` when the robot is lost and when it is found again. What is
in flight then ends with `LostConnection`, and nothing is taken up again unasked.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Literal

from robot_api.capabilities.base import Hub
from robot_api.driver import Event
from robot_api.errors import LostConnection

State = Literal["connected", "lost"]


class Link:
    """The state of the connection to a robot. Any thread may call any of it.

    `robot` is what people call it. `now` gives seconds since the epoch.
    """

    def __init__(self, hub: Hub, robot: str, now: Callable[[], float] = time.time) -> None:
        self._hub = hub
        self._robot = robot
        self._now = now
        self._lock = threading.Lock()
        self._state: State = "connected"
        self._since = now()
        self._because = ""
        self._when_lost: list[Callable[[], None]] = []
        self._when_found: list[Callable[[], None]] = []

    @property
    def state(self) -> State:
        return self._state

    @property
    def since(self) -> float:
        """When it came into this state: seconds since the epoch."""
        return self._since

    def on_lost(self, listener: Callable[[], None]) -> None:
        """Call it each time the robot is lost, in the thread that found out; must not block."""
        self._when_lost.append(listener)

    def on_found(self, listener: Callable[[], None]) -> None:
        """Call it each time the robot is found again; must not block."""
        self._when_found.append(listener)

    def lost(self, because: str) -> None:
        """The robot cannot be reached any more. `because`: a sentence for people."""
        self._change("lost", because, self._when_lost)

    def found(self) -> None:
        """It can be reached, again."""
        self._change("connected", "", self._when_found)

    def event(self) -> Event:
        """The data of the event `link`, as it is now."""
        with self._lock:
            return {"state": self._state, "since": self._since, "because": self._because}

    def check(self) -> None:
        """Raise `LostConnection` while it is lost."""
        if self._state == "lost":
            raise self.error()

    def error(self) -> LostConnection:
        because = self._because or f"{self._robot} cannot be reached."
        return LostConnection(f"{because} See that it is switched on and in the network.")

    def _change(self, state: State, because: str, listeners: list[Callable[[], None]]) -> None:
        with self._lock:
            if state == self._state:
                return
            self._state, self._because, self._since = state, because, self._now()
        try:
            for listener in listeners:
                listener()
        finally:
            self._hub.forward("link", self.event())
