"""A stop for several robots: said again and again until each has confirmed that it stands. Without
I/O."""

from __future__ import annotations

import secrets
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Final

from nl2robot.fleet.messages import Stop, Stopped

AGAIN: Final = 0.25
"""Seconds after which it is said again to who has not answered."""
WITHIN: Final = 5.0
"""Seconds after which whoever waits is told who has not confirmed it; it is said on for `GOES_ON`,
so that a robot behind a short cut stops, too."""
GOES_ON: Final = 60.0


@dataclass
class Round:
    """One stop, and what each robot says to it."""

    stop: Stop
    began: float
    waits: set[str]
    said: float = float("-inf")
    results: dict[str, Stopped] = field(default_factory=dict)
    over: threading.Event = field(default_factory=threading.Event)
    """Set when all have answered, or the time is up."""


class Stops:
    """Those that were begun here."""

    def __init__(self, say: Callable[[str, Stop], None]) -> None:
        self._say = say
        self._rounds: dict[str, Round] = {}

    def begin(
        self, robots: Iterable[str], because: str, now: float, *, everyone: bool = False
    ) -> Round:
        made = Round(Stop(secrets.token_hex(8), because, everyone), now, set(robots))
        self._rounds[made.stop.stop] = made
        self.tick(now)
        return made

    def hear(self, sender: str, stopped: Stopped) -> None:
        made = self._rounds.get(stopped.stop)
        if made is None or sender not in made.waits | made.results.keys():
            return
        made.results[sender] = stopped
        made.waits.discard(sender)

    def tick(self, now: float) -> None:
        for id, made in tuple(self._rounds.items()):
            if not made.waits or now - made.began >= WITHIN:
                made.over.set()
            if not made.waits or now - made.began >= GOES_ON:
                del self._rounds[id]
            elif now - made.said >= AGAIN:
                made.said = now
                for robot in tuple(made.waits):  # one's own answer may come at once
                    self._say(robot, made.stop)
