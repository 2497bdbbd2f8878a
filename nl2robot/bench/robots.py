"""How fast the robots are that there are here, by the wires that they are driven over.

The emulator, the simulator and a server of ours are always there; others are named by their
addresses. `nl2robot bench robots` prints it.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from nl2robot.bench.benchmark import served
from nl2robot.bench.figures import megabytes
from nl2robot.station.robots import Chosen, chosen
from robot_api.driver import Driver
from robot_api.errors import RobotError
from robot_api.robots.address import Address
from robot_api.robots.benchmark import STOPS, measure_calls, measure_losses, measure_stops
from robot_api.robots.opening import open_robot

HERE = ("emulator", "sim")
"""The robots that need no other process."""
WHAT: Mapping[str, tuple[str, str, str]] = {
    "calls_per_second": ("calls, one after the other", "/s", ""),
    "round_trip_ms": ("round trip, median", "ms", ""),
    "round_trip_p99_ms": ("round trip, p99", "ms", ""),
    "confirmed_ms": ("stop to its confirmation, median", "ms", "50"),
    "confirmed_worst_ms": (f"the same, worst of {STOPS}", "ms", "50"),
    "zero_speed_ms": ("stop to zero speed, median", "ms", "50"),
    "zero_speed_worst_ms": (f"the same, worst of {STOPS}", "ms", "50"),
    "unconfirmed": (f"stops of {STOPS} that were not confirmed", "", "0"),
    "cut_s": ("until a cut link is noticed", "s", ""),
    "silent_s": ("until a silent robot is noticed", "s", ""),
    "serve_mb": ("memory of `serve` with it", "MB", ""),
}
"""What is measured, by the keys of the figures: in words, its unit, and the aim, which is ours
alone: what the robot itself needs comes on top."""


def measure(addresses: Iterable[str]) -> Iterator[tuple[str, dict[str, float]]]:
    """Each robot's address with its figures, as they come. Raises `UserError` for an address that
    is none, `RobotError` for a robot that is not there."""
    for address in (*HERE, *addresses):
        yield address, _measure_robot(address)
    with served() as (_, address):
        yield "ws", _measure_robot(f"ws://{address}")


def _measure_robot(text: str) -> dict[str, float]:
    robot = chosen(text)
    address = robot.address
    if address.port is None and address.host:
        address = replace(address, port=robot.kind.port)
    driver = _open(robot, address)
    try:
        figures = measure_calls(driver) | measure_stops(driver)
    finally:
        with contextlib.suppress(RobotError):
            driver.close()
    if address.host and address.port is not None:
        figures |= measure_losses(lambda where: _open(robot, where), address)
    with contextlib.suppress(ChildProcessError), served("--robot", text) as (process, _):
        figures["serve_mb"] = megabytes(process)
    return figures


def _open(robot: Chosen, address: Address) -> Driver:
    return open_robot(address, robot.kind, read=robot.read)
