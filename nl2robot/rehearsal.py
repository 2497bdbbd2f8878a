"""The dry run: the program in a copy of the simulated world, as fast as the machine allows."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any, Literal

import msgspec

from robot_api.driver import StopFlag
from robot_api.errors import Stopped

if TYPE_CHECKING:
    from sim.simulation import Simulation

REAL_SECONDS = 3.0
"""How long a person waits for a dry run before it is cut short."""
MANY_CALLS = 1000
"""A program that calls more often is not followed to its end."""


class DryRun(msgspec.Struct, frozen=True, kw_only=True):
    """What the program would do; people's answers are those of the simulated people."""

    status: Literal["done", "failed", "stopped", "limit", "unfinished"]
    """As an outcome of `sandbox.execution`, or "unfinished" if it was cut short."""
    message: str | None
    """Why it would not be done."""
    line: int | None
    """Where it would end, if it would not be done."""
    seconds: float
    """How long it would take, in simulated time."""
    metres: float
    """How far it would drive."""
    says: tuple[str, ...]
    asks: tuple[str, ...]
    holds: tuple[str, ...]
    """What it would hold at the end."""
    shows: tuple[str, ...]
    places: tuple[str, ...]
    """The places it would drive to or through, in order."""
    path: tuple[tuple[float, float], ...]
    """Where it would drive, in metres, a point every half metre or so."""
    calls: int


def rehearse(
    program: str,
    simulation: Simulation,
    real_seconds: float = REAL_SECONDS,
    seed: int | None = None,
) -> DryRun:
    """Run the program in a simulation of its own, whose time is free to run; its `random` begins
    with `seed`."""
    from robot_api.drivers import simulated
    from sandbox.execution import Execution

    driver = simulated(simulation)
    began = simulation.time
    stop = StopFlag()
    asks: list[str] = []
    cut_short = threading.Event()
    calls = 0

    def call(method: str, arguments: dict[str, Any], line: int) -> Any:
        nonlocal calls
        calls += 1
        if calls > MANY_CALLS:
            cut()
        stop.check()
        if method == "ask":
            asks.append(arguments["question"])
        if method == "stop":
            raise Stopped  # as the real robot's stop ends every program
        return driver.call(method, arguments, stop)

    def cut() -> None:
        cut_short.set()
        stop.set("The dry run was cut short.")
        driver.stop("The dry run was cut short.")

    def give_up() -> None:
        cut()
        execution.stop()

    execution = Execution(program, call, seed=seed)
    watchdog = threading.Timer(real_seconds, give_up)
    watchdog.daemon = True
    watchdog.start()
    try:
        outcome = execution.run()
    finally:
        watchdog.cancel()
        driver.close()

    record = simulation.record.between(began)
    path = _thinned([(sample.x, sample.y) for sample in record.samples])
    return DryRun(
        status="unfinished" if cut_short.is_set() else outcome.status,
        message=None if cut_short.is_set() or outcome.status == "done" else outcome.message,
        line=outcome.line,
        seconds=round(simulation.time - began, 1),
        metres=round(record.distance, 1),
        says=tuple(str(h.data["text"]) for h in record.happenings if h.kind == "speech"),
        asks=tuple(asks),
        holds=tuple(simulation.robot.holding),
        shows=tuple(
            str(next(iter(h.data.values()), "")) for h in record.happenings if h.kind == "screen"
        ),
        places=_visited(simulation, path),
        path=path,
        calls=calls,
    )


def _thinned(
    points: list[tuple[float, float]], apart: float = 0.5
) -> tuple[tuple[float, float], ...]:
    kept = points[:1]
    for x, y in points[1:]:
        if (x - kept[-1][0]) ** 2 + (y - kept[-1][1]) ** 2 >= apart**2:
            kept.append((round(x, 2), round(y, 2)))
    return tuple(kept)


def _visited(simulation: Simulation, path: tuple[tuple[float, float], ...]) -> tuple[str, ...]:
    names: list[str] = []
    for x, y in path:
        place = simulation.world.place_at(x, y)
        if place is not None and names[-1:] != [place.name]:
            names.append(place.name)
    return tuple(names)
