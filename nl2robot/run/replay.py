"""Replaying a logged run in the simulator.

The same program runs again in a fresh simulation of the same world, with the same seed, from where
the robot stood. What came from people then (answers, scanned codes, touches) comes from the log
again, so the program takes the same branches; everything else is simulated anew and compared. A
run that was broken off ends at the same call. What a pause broke into pieces is made in one, and
what was done in a run before this one, with which it went on, is not done here either.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from datetime import datetime
from typing import Any

import msgspec

from nl2robot.run.going_on import Recall, whole_calls
from nl2robot.run.runlog import LoggedCall, Run
from robot_api import errors
from robot_api.driver import StopFlag
from robot_api.drivers import simulated
from sandbox.execution import Execution
from sim.errors import SimError
from sim.simulation import Simulation

FROM_PEOPLE = frozenset({"ask", "listen", "answer", "scan", "touch"})
"""Methods whose results are taken from the log."""
EVER_CHANGING = frozenset({"battery", "clock", "location", "log"})
"""Methods whose results depend on what the robot did before the run."""
BROKEN_OFF = "The first run ended here."


class Replay(msgspec.Struct, frozen=True, kw_only=True):
    """How the second time went. `simulation.record` has what it looked like."""

    status: str
    message: str | None
    differences: tuple[str, ...]
    """What came out otherwise than it was logged, a sentence each; empty if nothing."""


def replay(
    run: Run,
    calls: Sequence[LoggedCall],
    simulation: Simulation,
    on_call: Callable[[int, str, dict[str, Any]], None],
    recall: Recall | None = None,
) -> Replay:
    """Run the program again; `on_call(line, method, arguments)` is told of each call. `recall` has
    what was done before, if it went on with another run."""
    driver = simulated(simulation)
    logged = deque(whole for whole, _ in whole_calls(calls))
    differences = list(_put_at_start(run, simulation))
    stop = StopFlag()

    def call(method: str, arguments: dict[str, Any], line: int) -> Any:
        if recall is not None and recall.goes_on:
            return recall.answer(method, arguments)
        if recall is not None:
            arguments = recall.left_of(method, arguments)
        then = logged.popleft() if logged else None
        if then is None and run.status != "done":
            raise errors.Stopped(BROKEN_OFF)
        on_call(line, method, arguments)
        if method == "stop":
            raise errors.Stopped
        if then is not None and _broken_off(then):
            raise errors.Stopped(BROKEN_OFF)
        if then is None:
            differences.append(f"Line {line}: {method} was not called the first time.")
        elif (then.method, then.line) != (method, line):
            differences.append(
                f"Line {line}: {method} was called where {then.method} of line {then.line} was."
            )
            then = None
        elif method in FROM_PEOPLE:
            return _as_logged(then)
        try:
            result = driver.call(method, arguments, stop)
        except errors.RobotError as error:
            if then is not None and not (then.error or "").startswith(type(error).__name__):
                differences.append(f"Line {line}: {method} failed this time: {error}")
            raise
        if then is not None:
            differences.extend(_difference(then, result))
        return result

    try:
        outcome = Execution(run.program, call, seed=run.seed).run()
    finally:
        driver.close()
    if logged and outcome.status == "done":
        differences.append(f"{len(logged)} calls of the first time were not made.")
    return Replay(
        status=outcome.status,
        message=None if outcome.status == "done" else outcome.message,
        differences=tuple(differences),
    )


def _put_at_start(run: Run, simulation: Simulation) -> Iterator[str]:
    """Put the robot where it stood; yields what is in the way of that."""
    if run.start is None:  # logged by an older version
        return
    start = json.loads(run.start)
    clock = start.pop("clock", None)  # not of runs that an older version logged
    if clock is not None:
        zone = simulation.clock().tzinfo
        simulation.set_clock(datetime.fromisoformat(clock).astimezone(zone))
    try:
        simulation.localize(**start)
    except SimError as error:
        yield f"The robot begins elsewhere this time: {error}"
    simulation.new_record()


def _broken_off(then: LoggedCall) -> bool:
    return then.seconds is None or (then.error or "").startswith(errors.Stopped.__name__)


def _difference(then: LoggedCall, result: Any) -> Iterator[str]:
    where = f"Line {then.line}: {then.method}"
    if then.error:
        yield f"{where} did not fail this time ({then.error})."
    elif then.method not in EVER_CHANGING:
        now = msgspec.to_builtins(result)
        if now != json.loads(then.result or "null"):
            yield f"{where} returned {now!r} this time, not {then.result}."


def _as_logged(then: LoggedCall) -> Any:
    if then.error:
        name, _, message = then.error.partition(": ")
        raise errors.error_named(name)(message)
    return json.loads(then.result or "null")
