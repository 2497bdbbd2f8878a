"""How fast a robot is, by its driver: calls, stops, and how soon a dead robot is noticed.

`nl2robot bench robots` prints it for the robots that there are here.
"""

from __future__ import annotations

import statistics
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import Final

from robot_api.conformance.link import Proxy
from robot_api.conformance.losing import Connect
from robot_api.conformance.subject import Attempt
from robot_api.driver import Driver, Event, StopFlag
from robot_api.errors import RobotError, StopNotConfirmed
from robot_api.robots.address import Address

CALLS: Final = 300
STOPS: Final = 50
LOSSES: Final = 3
_ASKED: Final = "battery"
_SPEED: Final = 0.3
"""Metres a second at which the robot drives when it is stopped: to and fro, so that it stays."""
_MOVES, _STANDS = 0.05, 0.01
"""Metres a second from which it counts as moving, and to which as standing."""
_PATIENCE: Final = 3.0
"""Seconds that it may take to move, and to stand."""
_LOSS: Final = 60.0
"""Seconds in which a loss must be noticed at all."""


def measure_calls(driver: Driver, calls: int = CALLS) -> dict[str, float]:
    """Of asking for the battery's charge, each time when the answer before has come:
    "calls_per_second", "round_trip_ms" (the median) and "round_trip_p99_ms"."""
    trips = []
    for _ in range(calls):
        began = time.perf_counter()
        driver.call(_ASKED, {}, StopFlag())
        trips.append(time.perf_counter() - began)
    return {
        "calls_per_second": len(trips) / sum(trips),
        "round_trip_ms": 1000 * statistics.median(trips),
        "round_trip_p99_ms": 1000 * statistics.quantiles(trips, n=100)[98],
    }


def measure_stops(driver: Driver, stops: int = STOPS) -> dict[str, float]:
    """From asking a robot that drives to stop, median and worst:

    - "confirmed_ms", "confirmed_worst_ms": until it has confirmed that it stands
    - "zero_speed_ms", "zero_speed_worst_ms": until it reports no speed
    - "unconfirmed": how many of the stops were not confirmed

    A robot without wheels is stopped at nothing, and reports no speed.
    """
    confirmed, zero_speed, unconfirmed = [], [], 0
    with _speeds_of(driver) as speeds:
        for number in range(stops):
            drive = _drive(driver, speeds, 1 if number % 2 else -1)
            began = time.monotonic()
            try:
                driver.stop("The benchmark stops the robot.")
            except StopNotConfirmed:
                unconfirmed += 1
            else:
                confirmed.append(time.monotonic() - began)
            if drive is not None:
                stood = speeds.stood_since(began)
                if stood is not None:
                    zero_speed.append(stood - began)
                drive.returned()
    return {
        **_median_and_worst("confirmed", confirmed),
        **_median_and_worst("zero_speed", zero_speed),
        "unconfirmed": unconfirmed,
    }


def measure_losses(connect: Connect, address: Address, losses: int = LOSSES) -> dict[str, float]:
    """Seconds, the worst, until everybody is told that the robot is lost: "cut_s" when its
    connections end, "silent_s" when it says nothing any more."""
    measured = {}
    for name, lose in (("cut_s", Proxy.cut), ("silent_s", Proxy.freeze)):
        times = [_noticed(connect, address, lose) for _ in range(losses)]
        noticed = [seconds for seconds in times if seconds is not None]
        if len(noticed) == len(times):
            measured[name] = max(noticed)
    return measured


class _Speeds:
    """What a robot tells of its speed, with the time at which it was heard."""

    def __init__(self) -> None:
        self._heard: list[tuple[float, float]] = []
        self._news = threading.Condition()  # guards the above

    def __call__(self, kind: str, data: Event) -> None:
        if kind == "pose":
            with self._news:
                self._heard.append((time.monotonic(), abs(data["speed"])))
                self._news.notify_all()

    def moves(self, since: float) -> bool:
        """Whether it moves, sooner or later."""
        return self._first(since, lambda speed: speed >= _MOVES) is not None

    def stood_since(self, since: float) -> float | None:
        """When it first stood after that time, sooner or later."""
        return self._first(since, lambda speed: speed <= _STANDS)

    def _first(self, since: float, is_so: Callable[[float], bool]) -> float | None:
        def first() -> float | None:
            return next((at for at, speed in self._heard if at >= since and is_so(speed)), None)

        with self._news:
            self._news.wait_for(lambda: first() is not None, _PATIENCE)
            return first()


@contextmanager
def _speeds_of(driver: Driver) -> Iterator[_Speeds]:
    speeds = _Speeds()
    unsubscribe = driver.subscribe(speeds)
    try:
        yield speeds
    finally:
        unsubscribe()


def _drive(driver: Driver, speeds: _Speeds, sign: int) -> Attempt | None:
    """Set it in motion; None if it does not move."""
    if "drive" not in driver.capabilities().methods:
        return None
    arguments = {"linear": sign * _SPEED, "angular": 0, "seconds": 30}
    began = time.monotonic()
    drive = Attempt(lambda flag: driver.call("drive", arguments, flag))
    if drive.returned(0.01) or not speeds.moves(began):
        return None
    return drive


def _noticed(connect: Connect, address: Address, lose: Callable[[Proxy], None]) -> float | None:
    """Seconds from the loss of the link to the news; None if there are none."""
    assert address.port is not None
    lost = threading.Event()

    def listen(kind: str, data: Event) -> None:
        if kind == "link" and data["state"] == "lost":
            lost.set()

    with Proxy(address.host, address.port) as link:
        driver = connect(replace(address, host=link.host, port=link.port))
        unsubscribe = driver.subscribe(listen)
        try:
            driver.call(_ASKED, {}, StopFlag())
            began = time.monotonic()
            lose(link)
            return time.monotonic() - began if lost.wait(_LOSS) else None
        finally:
            unsubscribe()
            with suppress(RobotError):
                driver.close()


def _median_and_worst(name: str, seconds: list[float]) -> dict[str, float]:
    if not seconds:
        return {}
    return {
        f"{name}_ms": 1000 * statistics.median(seconds),
        f"{name}_worst_ms": 1000 * max(seconds),
    }
