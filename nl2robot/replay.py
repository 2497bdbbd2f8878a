"""Replaying a logged run in the simulator.

The same program runs again in a fresh simulation of the same world, with the same seed. What
came from people then (answers, scanned codes, touches) comes from the log again, so the program
takes the same branches; everything else is simulated anew and compared.
"""

from __future__ import annotations

import json
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

import msgspec

from nl2robot.runlog import LoggedCall, Run
from robot_api import errors
from robot_api.driver import StopFlag
from sandbox.execution import Execution
from sim.simulation import Simulation

FROM_PEOPLE = frozenset({"ask", "listen", "answer", "scan", "touch"})
"""Methods whose results are taken from the log."""


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
) -> Replay:
    """Run the program again; `on_call(line, method, arguments)` is told of each call."""
    from robot_api.drivers import simulated

    driver = simulated(simulation)
    logged = deque(calls)
    differences: list[str] = []
    stop = StopFlag()

    def call(method: str, arguments: dict[str, Any], line: int) -> Any:
        on_call(line, method, arguments)
        then = logged.popleft() if logged else None
        if then is None:
            differences.append(f"Line {line}: {method} was not called the first time.")
        elif (then.method, then.line) != (method, line):
            differences.append(
                f"Line {line}: {method} was called where {then.method} of line {then.line} was."
            )
        elif method in FROM_PEOPLE:
            return _as_logged(then)
        try:
            result = driver.call(method, arguments, stop)
        except errors.RobotError as error:
            if then is not None and not (then.error or "").startswith(type(error).__name__):
                differences.append(f"Line {line}: {method} failed this time: {error}")
            raise
        if then is not None and then.error:
            differences.append(f"Line {line}: {method} did not fail this time ({then.error}).")
        return result

    try:
        outcome = Execution(run.program, call).run()
    finally:
        driver.close()
    if logged and outcome.status == "done":
        differences.append(f"{len(logged)} calls of the first time were not made.")
    return Replay(status=outcome.status, message=outcome.message, differences=tuple(differences))


def _as_logged(then: LoggedCall) -> Any:
    if then.error:
        name, _, message = then.error.partition(": ")
        raise errors.error_named(name)(message)
    if then.result is None:
        raise errors.Stopped("The first run ended here.")
    return json.loads(then.result)
