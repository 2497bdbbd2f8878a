"""A server that kills itself at a chosen step of its first run; "never": it ends when that is over.

python -m tests.schedule.killed_at FOLDER before|claimed|running|ended|never
"""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from nl2robot.run.runlog import RunLog
from nl2robot.run.runner import Runner
from nl2robot.schedule.appointments import OVER
from nl2robot.schedule.book import Book
from nl2robot.schedule.clerk import Clerk
from nl2robot.schedule.schedule import FILE
from nl2robot.schedule.service import Timing
from nl2robot.station.station import simulated_station
from sim.world.loading import load_world
from tests.schedule.conftest import at

DUE = at("2026-11-30 08:00")
PATIENCE = 60.0


def die(*_: Any, **__: Any) -> Any:
    os.kill(os.getpid(), signal.SIGKILL)


def dies_after(function: Callable[..., Any]) -> Callable[..., Any]:
    def done(*given: Any, **more: Any) -> Any:
        function(*given, **more)
        die()

    return done


def main(folder: Path, moment: str) -> None:
    match moment:
        case "before":
            Book.claim = die  # type: ignore[method-assign]
        case "claimed":
            Runner.check = die  # type: ignore[method-assign]
        case "running":
            Runner.run = dies_after(Runner.run)  # type: ignore[method-assign]
        case "ended":
            Clerk.ended = die  # type: ignore[method-assign]
    log = RunLog(folder / "runs.sqlite")
    timing = Timing(clock=lambda: DUE + 1.0, every=0.01)
    with simulated_station(load_world("ward"), log, seed=1, timing=timing):
        ends = time.monotonic() + PATIENCE
        book = Book(folder / FILE)
        while not any(each.due == DUE and each.state in OVER for each in book.history()):
            assert time.monotonic() < ends, book.history()
            time.sleep(0.02)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2])
