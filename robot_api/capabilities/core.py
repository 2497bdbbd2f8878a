"""What every robot has: `stop`, `wait`, `wait_until`, `places`, `log`, `clock`, `battery`."""

from __future__ import annotations

import math
import threading
from abc import abstractmethod
from collections import deque
from collections.abc import Callable, Mapping
from datetime import datetime
from typing import ClassVar

from robot_api.capabilities.base import Capability, Hub
from robot_api.capabilities.emulation import InEmulation
from robot_api.capabilities.languages import fold
from robot_api.capabilities.simulation import InSimulation
from robot_api.driver import StopFlag
from robot_api.methods import CORE, WEEKDAYS
from robot_api.moments import next_moment, seconds_until, zone_name
from robot_api.values import Clock


class LogBook:
    """The robot's debug log: what was called, what came of it. Any thread may write."""

    def __init__(
        self, now: Callable[[], datetime], hub: Hub, copy_to: Callable[[str], None] | None = None
    ) -> None:
        self._now = now
        self._hub = hub
        self._copy_to = copy_to
        self._lines: deque[str] = deque(maxlen=1000)
        self._lock = threading.Lock()

    def write(self, message: str, level: str = "info") -> None:
        """Add a line, with the robot's own time before it, and tell those who subscribed."""
        time = f"{self._now():%H:%M:%S}"
        line = f"{time} {message}" if level == "info" else f"{time} {level}: {message}"
        with self._lock:
            self._lines.append(line)
        self._hub.publish("log", level=level, message=message, time=time)
        if self._copy_to is not None:
            self._copy_to(line)

    def last(self, lines: int) -> list[str]:
        with self._lock:
            return list(self._lines)[-lines:]


class Core(Capability):
    """What a robot needs to be one. `stop` is the driver's, which wakes the other calls too."""

    name = CORE
    lacking = "is not switched on"
    looks_again: ClassVar[float] = 1.0
    """Seconds between two looks at a clock that may be set while a time is waited for."""

    def __init__(self, book: LogBook) -> None:
        super().__init__()
        self._book = book

    @abstractmethod
    def wait(self, stop: StopFlag, seconds: float) -> None: ...

    @abstractmethod
    def place_kinds(self) -> Mapping[str, str]:
        """The named places with their kinds."""

    @abstractmethod
    def now(self) -> datetime:
        """The date and time where the robot is, with the time zone there."""

    @abstractmethod
    def charge(self) -> float:
        """The battery's charge in percent."""

    @abstractmethod
    def rest(self) -> None:
        """Bring the body to rest at once."""

    def places(self, stop: StopFlag, kind: str | None) -> list[str]:
        """All places, or those of a kind, which may be in the plural."""
        kinds = self.place_kinds()
        if kind is None:
            return list(kinds)
        wanted = " ".join(fold(kind))
        return [
            name for name, of_kind in kinds.items() if wanted in _forms(" ".join(fold(of_kind)))
        ]

    def wait_until(self, stop: StopFlag, time: str, weekday: str | None, date: str | None) -> None:
        moment = next_moment(self.now(), time, weekday, date)
        stop.check()
        while (left := seconds_until(moment, self.now())) > 0:
            self.wait(stop, min(left, self.looks_again))

    def log(self, stop: StopFlag, lines: int) -> list[str]:
        return self._book.last(lines)

    def clock(self, stop: StopFlag) -> Clock:
        now = self.now()
        weekday = WEEKDAYS[now.weekday()]
        return Clock(f"{now:%H:%M}", weekday, f"{now:%Y-%m-%d}", zone_name(now))

    def battery(self, stop: StopFlag) -> int:
        return round(self.charge())


def _forms(kind: str) -> tuple[str, ...]:
    """A kind and its plural."""
    plural = f"{kind[:-1]}ies" if kind.endswith("y") else f"{kind}s"
    return kind, plural, f"{kind}es"


class EmulatedCore(InEmulation, Core):
    looks_again = math.inf  # nobody sets this clock

    def wait(self, stop: StopFlag, seconds: float) -> None:
        self.emulation.pass_time(seconds, stop)

    def place_kinds(self) -> Mapping[str, str]:
        return self.emulation.places

    def now(self) -> datetime:
        return self.emulation.now()

    def charge(self) -> float:
        return self.emulation.battery

    def rest(self) -> None:
        """The calls that pretend to take time look at their flags themselves."""


class SimulatedCore(InSimulation, Core):
    looks_again = math.inf

    def wait(self, stop: StopFlag, seconds: float) -> None:
        self.run(self.simulation.wait(seconds), stop)

    def place_kinds(self) -> Mapping[str, str]:
        return {place.name: place.kind for place in self.simulation.world.places}

    def now(self) -> datetime:
        return self.simulation.clock()

    def charge(self) -> float:
        return self.simulation.robot.battery

    def rest(self) -> None:
        self.simulation.halt()
