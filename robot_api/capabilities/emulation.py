"""What the emulated capabilities share: the state of a robot that is not there."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime
from typing import Any

from robot_api.capabilities.base import Capability, Hub
from robot_api.driver import StopFlag
from robot_api.local_time import local_now
from robot_api.moments import in_a_zone, later
from robot_api.values import Location

DEFAULT_PLACES: Mapping[str, str] = {
    "lobby": "lobby",
    "reception": "reception",
    "pharmacy": "pharmacy",
    "radiology": "ward",
    "lab": "lab",
    "office": "office",
    "charger": "charger",
}
"""The places that the emulator lists, with their kinds, unless it is given others."""


class Emulation:
    """Where the emulated robot believes to be, what it holds, what people will answer.

    Without a `speed` no real time passes; with one, emulated seconds pass at that multiple of real
    time.
    """

    def __init__(
        self,
        answers: Iterable[str | None] = (),
        places: Mapping[str, str] | None = None,
        questions: Mapping[str, str] | None = None,
        contacts: Sequence[str] | None = None,
        speed: float | None = None,
        start: datetime | None = None,
    ) -> None:
        self.hub = Hub()
        self.answers = deque(answers)
        """What people say, touch and hold to the scanner, in order; None is silence."""
        self.any_place = places is None
        """Whether a place that is not listed is believed to exist."""
        self.places = dict(DEFAULT_PLACES if places is None else places)
        self.questions = dict(questions or {})
        self.contacts = tuple(contacts) if contacts is not None else ("reception", "Alice")
        self.location = Location(0.0, 0.0, 0.0, next(iter(self.places), None))
        self.held: list[str] = []
        self.language = "en"
        self.volume = 70
        self.battery = 100.0
        self.joints: dict[str, float] = {}
        self.emotion = "neutral"
        self._start = in_a_zone(start) if start is not None else local_now()
        self._speed = speed
        self._seconds = 0.0
        self._lock = threading.Lock()

    def publish(self, kind: str, **data: Any) -> None:
        self.hub.publish(kind, **data)

    def now(self) -> datetime:
        """The emulated date and time."""
        return later(self._start, self._seconds)

    @property
    def seconds(self) -> float:
        """Emulated seconds since the start."""
        return self._seconds

    def pass_time(self, seconds: float, stop: StopFlag) -> None:
        """Let so many emulated seconds pass. Raises `Stopped`."""
        stop.check()
        if self._speed is not None:
            stop.wait(seconds / self._speed)
            stop.check()
        with self._lock:
            self._seconds += seconds

    def next_answer(self, otherwise: str | None) -> str | None:
        """What somebody says, touches or holds up now; `otherwise` when nothing is left."""
        with self._lock:
            return self.answers.popleft() if self.answers else otherwise

    def stand_at(self, location: Location) -> None:
        self.location = location
        self.publish(
            "pose",
            x=location.x,
            y=location.y,
            theta=location.theta,
            place=location.place,
            speed=0.0,
            time=self._seconds,
        )


class InEmulation(Capability):
    """A capability of the emulated robot; goes before the interface among the base classes."""

    def __init__(self, emulation: Emulation, *others: Any) -> None:
        super().__init__(*others)
        self.emulation = emulation
