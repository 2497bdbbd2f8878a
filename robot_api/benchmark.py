"""How fast the wire is: client and emulated robot in two processes, over loopback.

python -m robot_api.benchmark
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from robot_api.client import Robot
from robot_api.driver import Driver, StopFlag
from robot_api.drivers import emulated
from robot_api.errors import Stopped
from robot_api.server import Context, Server, Service

CLIENTS = 8
WAITING = 63
"""Calls that are in flight when a stop is measured; with the stop as many as a client may have."""


def measure(calls: int = 3000, stops: int = 50) -> dict[str, float]:
    """What was measured. All calls are `say("Hello")`, validated, each in a worker thread, done at
    once by the emulator.

    - "calls_per_second": one client, each call made when the one before has returned
    - "calls_per_second_pipelined": eight threads that share one client
    - "round_trip_ms", "round_trip_p99_ms": of the calls of the one client
    - "stop_ms", "stop_p99_ms": from asking for a stop, with 63 calls in flight, to `Driver.stop`
    """
    with _server() as address, Robot(address) as robot:
        _say(robot, calls // 10)  # warm up
        trips = _say(robot, calls)
        began = time.perf_counter()
        threads = [
            threading.Thread(target=_say, args=(robot, calls // CLIENTS)) for _ in range(CLIENTS)
        ]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        pipelined = calls // CLIENTS * CLIENTS / (time.perf_counter() - began)
        waits = [_stop(robot) for _ in range(stops)]
    return {
        "calls_per_second": len(trips) / sum(trips),
        "calls_per_second_pipelined": pipelined,
        "round_trip_ms": 1000 * statistics.median(trips),
        "round_trip_p99_ms": 1000 * statistics.quantiles(trips, n=100)[98],
        "stop_ms": 1000 * statistics.median(waits),
        "stop_p99_ms": 1000 * statistics.quantiles(waits, n=100)[98],
    }


def _say(robot: Robot, calls: int) -> list[float]:
    """Seconds that each call took."""
    trips = []
    for _ in range(calls):
        began = time.perf_counter()
        robot.say("Hello")
        trips.append(time.perf_counter() - began)
    return trips


def _stop(robot: Robot) -> float:
    """Seconds from asking for a stop until the driver is told, while many calls wait.

    The clock, `time.monotonic`, is the machine's, the same in both processes."""

    def wait() -> None:
        try:
            robot.wait(60)
        except Stopped:
            return

    threads = [threading.Thread(target=wait) for _ in range(WAITING)]
    for thread in threads:
        thread.start()
    robot.request("benchmark.held", {"calls": WAITING})
    began = time.monotonic()
    robot.stop()
    for thread in threads:
        thread.join()
    stopped: float = robot.request("benchmark.stopped_at")
    return stopped - began


@contextmanager
def _server() -> Iterator[str]:
    """The address of a server in a process of its own."""
    process = subprocess.Popen(
        [sys.executable, "-m", "robot_api.benchmark", "--serve"], stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout is not None
        yield process.stdout.readline().strip()
    finally:
        process.terminate()
        process.wait(10)


class _Watched:
    """A driver whose waits last until they are stopped, and that notes when it is stopped."""

    def __init__(self, driver: Driver) -> None:
        self._driver = driver
        self.capabilities = driver.capabilities
        self.subscribe = driver.subscribe
        self.close = driver.close
        self.waiting = threading.Semaphore(0)
        """Counts the waits that have begun."""
        self.stopped_at = 0.0

    def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        if method != "wait":
            return self._driver.call(method, arguments, stop)
        self.waiting.release()
        stop.wait(60)
        stop.check()
        return None

    def stop(self, because: str) -> None:
        self.stopped_at = time.monotonic()
        self._driver.stop(because)


def _serve() -> None:
    driver = _Watched(emulated())

    def held(params: dict[str, Any], context: Context) -> None:
        for _ in range(params["calls"]):
            driver.waiting.acquire()

    services = {
        "benchmark.held": Service(held),
        "benchmark.stopped_at": Service(lambda params, context: driver.stopped_at),
    }
    server = Server(driver, port=0, services=services)
    server.serve_forever(lambda server: print(server.address, flush=True))


if __name__ == "__main__":
    if "--serve" in sys.argv[1:]:
        _serve()
    else:
        for name, value in measure().items():
            print(f"{name:28} {value:10.3f}")
