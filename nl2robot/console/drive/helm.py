"""The helm: who of several operators drives the robot, and the dead man's switch of the joystick.

One drives at a time. The helm is free, or somebody has it, and the others may ask for it; who has
it hands it over. Operators are known by the names of their connections, so who leaves lets go.

    helm = Helm(changed=publish)
    helm.take("7", "Ruth")                     # free: Ruth drives
    helm.take("9", "Karim")                    # Karim asks
    helm.give("7", "9")                        # Karim drives
    with helm.steering("9", stop, number=1):   # a movement of the joystick
        driver.call("drive", ..., stop)        # which lasts HOLDS seconds at most

What moves the robot is done by whoever calls, under `calling` and `steering`: they let in who
drives, and the helm sets their stop flags when that must end. Any thread may call any of it.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Final, Literal

import msgspec

from robot_api.driver import StopFlag
from robot_api.errors import AccessDenied, NotPossible, Stopped

HOLDS: Final = 0.3
"""Seconds that a movement of the joystick lasts unless it is renewed."""
IDLE: Final = 60.0
"""Seconds after which a driver who has done nothing loses the helm to whoever wants it."""


class Operator(msgspec.Struct, frozen=True):
    """Somebody at a console."""

    connection: str
    who: str
    """The name, for people."""


class State(msgspec.Struct, frozen=True):
    """Who drives; the data of the event "helm"."""

    driver: str | None
    """The connection of whoever drives; None while the helm is free."""
    who: str | None
    since: float | None
    """Seconds since the epoch."""
    asking: tuple[Operator, ...]
    """Who would like to drive, the one who asked first in front."""


@dataclass(frozen=True)
class _Flight:
    """A call in flight."""

    connection: str
    by_stick: bool


class Helm:
    """`changed` is told each new state, in order, and must return at once."""

    def __init__(
        self,
        changed: Callable[[State], None],
        now: Callable[[], float] = time.time,
        passed: Callable[[], float] = time.monotonic,
    ) -> None:
        self._changed = changed
        self._now = now
        self._passed = passed  # which nobody sets, unlike the clock on the wall
        self._lock = threading.RLock()  # for all that follows
        self._driver: Operator | None = None
        self._since: float | None = None
        self._asking: dict[str, Operator] = {}
        self._used = 0.0
        # A call may come to its turn after its connection is gone; names are used only once.
        self._gone: deque[str] = deque(maxlen=1000)
        self._flights: dict[StopFlag, _Flight] = {}
        self._stick: Literal["free", "held", "stopped"] = "free"
        # Frames are handled by several threads: an older one must not overtake a newer.
        self._newest = 0

    # --- who drives

    def state(self) -> State:
        with self._lock:
            driver = self._driver
            return State(
                driver=driver.connection if driver else None,
                who=driver.who if driver else None,
                since=self._since,
                asking=tuple(self._asking.values()),
            )

    def take(self, connection: str, who: str) -> State:
        """Drive, if nobody does or the driver has done nothing for long; else ask for it."""
        asking = Operator(connection, who)
        with self._lock:
            if connection in self._gone:
                raise NotPossible("Whoever wanted to drive has left.")
            if self._driver is None or self._driver.connection == connection or self._is_idle():
                ended = self._hand_to(asking)
            else:
                ended = []
                self._asking[connection] = asking
            state = self._tell()
        _end(ended, f"{who} drives now.")
        return state

    def give(self, connection: str, to: str | None = None) -> State:
        """Hand over to the one who asks from the connection `to`; to nobody in particular, it goes
        to whoever asked first. Raises `AccessDenied`, `NotPossible`."""
        with self._lock:
            self._check(connection)
            if to is not None and to not in self._asking:
                raise NotPossible("They do not want to drive any more. Choose somebody who asks.")
            ended = self._hand_to(self._asking[to] if to else self._next())
            state = self._tell()
        _end(ended, "The helm was handed over.")
        return state

    def keep(self, connection: str) -> State:
        """Go on driving: those who ask have their answer. Raises `AccessDenied`."""
        with self._lock:
            self._check(connection)
            self._asking.clear()
            self._used = self._passed()
            return self._tell()

    def left(self, connection: str) -> None:
        """The connection is gone: what it does ends, and who asked first drives."""
        with self._lock:
            self._gone.append(connection)
            known = self._asking.pop(connection, None) is not None
            ended = self._in_flight(lambda flight: flight.connection == connection)
            if self._driver is not None and self._driver.connection == connection:
                known = True
                ended += self._hand_to(self._next())
            if known:
                self._tell()
        _end(ended, "The connection to whoever drove was lost.")

    # --- what moves the robot

    @contextmanager
    def calling(self, connection: str, stop: StopFlag) -> Iterator[None]:
        """A call in the name of whoever drives; ends with its connection. Raises `AccessDenied`."""
        with self._lock:
            self._check(connection)
            self._flights[stop] = _Flight(connection, by_stick=False)
        with self._landing(stop):
            yield

    @contextmanager
    def steering(
        self, connection: str, stop: StopFlag, number: int | None = None
    ) -> Iterator[None]:
        """A movement of the joystick, the `number`th of its driver. It may last `HOLDS` seconds,
        and ends when the stick is let go or the helm handed over. Raises `AccessDenied`, `Stopped`
        if the stick was moved on since, and `NotPossible` after a stop, until it is let go."""
        with self._lock:
            self._check(connection)
            self._in_turn(number)
            if self._stick == "stopped":
                raise NotPossible("The robot was stopped. Let go of the joystick, then drive on.")
            self._stick = "held"
            self._flights[stop] = _Flight(connection, by_stick=True)
        # Whoever stops the robot sets the flag first: no movement slips in after it.
        stop.on_set(lambda: self._stick_stopped(stop))
        with self._landing(stop):
            yield

    def release(self, connection: str, number: int | None = None) -> None:
        """The driver lets go of the joystick: the robot stands at once. Others let go of
        nothing."""
        with self._lock:
            if self._driver is None or self._driver.connection != connection:
                return
            self._in_turn(number)
            ended = self._let_go()
        _end(ended, "The joystick was let go.")

    def stopped(self) -> None:
        """The robot was stopped: who holds the joystick must let go of it first to drive on."""
        with self._lock:
            if self._stick == "held":
                self._stick = "stopped"

    def yield_to_program(self) -> None:
        """A program begins to run, and drives: the joystick ends."""
        with self._lock:
            ended = self._in_flight(lambda flight: flight.by_stick)
        _end(ended, "A program has begun to run.")

    # --- inside, all with the lock

    def _check(self, connection: str) -> None:
        if self._driver is None:
            raise AccessDenied("You do not drive the robot. Take the helm first.")
        if self._driver.connection != connection:
            raise AccessDenied(f"{self._driver.who} drives the robot. Ask for the helm first.")

    def _in_turn(self, number: int | None) -> None:
        if number is None:
            return
        if number < self._newest:
            raise Stopped("A newer movement of the joystick came first.")
        self._newest = number

    def _is_idle(self) -> bool:
        return not self._flights and self._passed() - self._used >= IDLE

    def _next(self) -> Operator | None:
        return next(iter(self._asking.values()), None)

    def _hand_to(self, operator: Operator | None) -> list[StopFlag]:
        """Returns what of the joystick must end."""
        before, self._driver = self._driver, operator
        self._used = self._passed()
        if operator is not None:
            self._asking.pop(operator.connection, None)
        if before is not None and operator is not None and _same(before, operator):
            return []  # under another name, perhaps
        self._since = self._used if operator is not None else None
        self._newest = 0
        return self._let_go()

    def _let_go(self) -> list[StopFlag]:
        self._stick = "free"
        ended = self._in_flight(lambda flight: flight.by_stick)
        for stop in ended:
            del self._flights[stop]
        return ended

    def _in_flight(self, which: Callable[[_Flight], bool]) -> list[StopFlag]:
        return [stop for stop, flight in self._flights.items() if which(flight)]

    def _tell(self) -> State:
        state = self.state()
        self._changed(state)
        return state

    # --- inside, without it

    @contextmanager
    def _landing(self, stop: StopFlag) -> Iterator[None]:
        try:
            yield
        finally:
            with self._lock:
                self._flights.pop(stop, None)
                self._used = self._passed()

    def _stick_stopped(self, stop: StopFlag) -> None:
        """The flag of a movement was set; by the helm itself, if it no longer knows it."""
        with self._lock:
            if stop in self._flights:
                self.stopped()


def _same(one: Operator, other: Operator) -> bool:
    return one.connection == other.connection


def _end(flags: list[StopFlag], because: str) -> None:
    for stop in flags:
        stop.set(because)
