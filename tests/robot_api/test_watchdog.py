"""A robot does not drive on when nobody could hear a stop."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from robot_api.client import Robot
from robot_api.drivers import emulated
from robot_api.errors import Stopped
from robot_api.server import Server
from robot_api.serving.watchdog import BECAUSE, DEAF, LAGS

SOON = 20.0


class Deafened:
    """A server whose loop is kept busy, with a robot that drives meanwhile."""

    def __init__(
        self, seconds: float, method: str = "drive", busy: Callable[[float], None] = time.sleep
    ) -> None:
        self.stops: list[str] = []
        driver = emulated(speed=1.0)
        stop = driver.stop
        driver.stop = lambda because: (self.stops.append(because), stop(because))[1]  # type: ignore[method-assign, func-returns-value, return-value]
        begun, self.ended = threading.Event(), None
        driver.subscribe(
            lambda kind, data: (
                begun.set() if str(data.get("message", "")).startswith(method) else None
            )
        )
        with Server(driver, port=0) as server, Robot(server.address) as robot:

            def call() -> None:
                try:
                    robot.drive(0.5, 0, 3) if method == "drive" else robot.wait(3)
                except Stopped as stopped:
                    self.ended = stopped.because

            thread = threading.Thread(target=call)
            thread.start()
            assert begun.wait(SOON)
            server.in_loop(busy, seconds)
            thread.join(SOON)
            self.during = list(self.stops)


def test_a_robot_that_drives_is_stopped_when_its_server_is_deaf() -> None:
    deafened = Deafened(3 * DEAF)
    assert deafened.during == [BECAUSE]
    assert deafened.ended == BECAUSE


def locked_out(seconds: float) -> None:
    lock = threading.Lock()
    lock.acquire()
    lock.acquire(timeout=seconds)


def compute(seconds: float) -> None:
    ends = time.thread_time() + seconds
    while time.thread_time() < ends:
        pass


TRIES = 3


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="this system does not say it")
@pytest.mark.parametrize("busy", [compute, time.sleep, locked_out])
def test_one_whose_server_is_at_something_else_is_stopped_at_once(
    busy: Callable[[float], None],
) -> None:
    """Long before it counts as deaf: it is at a fault then, and not only late. A machine may be so
    busy that the watchdog itself is late, but not again and again."""
    assert LAGS < DEAF / 4
    assert any(Deafened(DEAF / 2, busy=busy).during == [BECAUSE] for _ in range(TRIES))


def beside_others_who_compute(seconds: float) -> None:
    """Python lets one of them run at a time, and the loop comes to it a little late."""
    over = threading.Event()

    def work() -> None:
        while not over.is_set():
            pass

    for _ in range(2):
        threading.Thread(target=work, daemon=True).start()
    threading.Timer(seconds, over.set).start()


@pytest.mark.parametrize(
    ("seconds", "method", "busy"),
    [
        (LAGS / 4, "drive", time.sleep),
        (3 * DEAF, "wait", time.sleep),
        (3 * DEAF, "drive", beside_others_who_compute),
    ],
)
def test_not_for_a_moment_and_not_one_that_stands(
    seconds: float, method: str, busy: Callable[[float], None]
) -> None:
    assert Deafened(seconds, method, busy).during == []
