"""What the sandbox costs: `python -m sandbox.benchmark` prints it."""

from __future__ import annotations

import itertools
import statistics
import threading
import time
from typing import Any

from robot_api.errors import Stopped
from robot_api.stub import stub
from robot_api.values import Location
from sandbox.check import check
from sandbox.execution import Execution, Limits

_TYPICAL = """\
desk = robot.location()
for visitor in range(3):
    robot.wait_for("person")
    place = robot.ask("Where to?", ["radiology", "pharmacy"])
    robot.guide("person", place)
    robot.goto(desk)
robot.say("Three visitors have been shown the way.")
"""


def measure(rounds: int = 20) -> dict[str, float]:
    """Medians in milliseconds but for the call, which is in microseconds; of the stops, the worst
    case, too. Nothing of a robot's own time is in them."""
    return {
        "check_ms": _median(lambda: check(_TYPICAL, _STUB), rounds),
        "start_and_end_ms": _median(lambda: Execution("pass", _nothing).run(), rounds),
        "typical_program_ms": _median(lambda: Execution(_TYPICAL, _nothing).run(), rounds),
        "call_us": _call(3000),
        **_stops("computing", rounds),
        **_stops("in_a_call", rounds),
        **_stops("paused", rounds),
    }


_STUB = stub()


def _nothing(method: str, arguments: dict[str, Any], line: int) -> Any:
    return {"ask": "pharmacy", "wait_for": True, "location": Location(1.0, 2.0)}.get(method)


def _median(work: Any, rounds: int) -> float:
    taken = []
    for _ in range(rounds):
        begun = time.perf_counter()
        work()
        taken.append((time.perf_counter() - begun) * 1000)
    return round(statistics.median(taken), 3)


def _call(calls: int) -> float:
    """What a robot call costs beyond the robot's own time, in microseconds."""
    moments: list[float] = []

    def call(method: str, arguments: dict[str, Any], line: int) -> None:
        moments.append(time.perf_counter())

    Execution(f"for i in range({calls}):\n    robot.wait(1)", call).run()
    between = [after - before for before, after in itertools.pairwise(moments)]
    return round(statistics.median(between) * 1_000_000, 1)


def _stops(when: str, rounds: int) -> dict[str, float]:
    """From `stop()` to the return of `run()`, with the process gone."""
    taken = [_stop(when) for _ in range(rounds)]
    return {
        f"stop_{when}_ms": round(statistics.median(taken), 3),
        f"stop_{when}_worst_ms": round(max(taken), 3),
    }


def _stop(when: str) -> float:
    reached, cancelled = threading.Event(), threading.Event()
    ended: list[float] = []

    def call(method: str, arguments: dict[str, Any], line: int) -> None:
        reached.set()
        if when == "in_a_call" and cancelled.wait(10):
            raise Stopped

    program = "robot.wait(1)\nwhile True:\n    pass"
    execution = Execution(
        program,
        call,
        limits=Limits(computing=10),
        on_line=lambda line: reached.set() if when == "paused" else None,
    )
    if when == "paused":
        execution.pause()

    def run() -> None:
        execution.run()
        ended.append(time.perf_counter())

    thread = threading.Thread(target=run)
    thread.start()
    reached.wait(10)
    time.sleep(0.02)
    begun = time.perf_counter()
    execution.stop()
    cancelled.set()
    thread.join()
    return (ended[0] - begun) * 1000


if __name__ == "__main__":
    for name, value in measure().items():
        print(f"{name:28} {value}")
