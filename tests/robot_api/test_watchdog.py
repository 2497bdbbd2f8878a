"""A robot does not drive on when nobody could hear a stop."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import pytest

from robot_api.client import Robot
from robot_api.drivers import emulated
from robot_api.errors import Stopped
from robot_api.server import Server
from robot_api.watchdog import BECAUSE, COMPUTES, DEAF

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


def compute(seconds: float) -> None:
    ends = time.thread_time() + seconds
    while time.thread_time() < ends:
        pass


@pytest.mark.skipif(
    not hasattr(time, "pthread_getcpuclockid"), reason="this system has no clock for a thread"
)
def test_one_whose_server_computes_is_stopped_at_once() -> None:
    """Long before it counts as deaf: it is at a fault then, and not only late."""
    assert COMPUTES < DEAF / 4
    assert Deafened(DEAF / 2, busy=compute).during == [BECAUSE]


@pytest.mark.parametrize(("seconds", "method"), [(DEAF / 3, "drive"), (3 * DEAF, "wait")])
def test_not_for_a_moment_and_not_one_that_stands(seconds: float, method: str) -> None:
    assert Deafened(seconds, method).during == []
