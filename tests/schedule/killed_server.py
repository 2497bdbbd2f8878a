"""A server whose scheduled day passes in seconds: run as a program of its own, to be killed.

python -m tests.schedule.killed_server FOLDER BEGAN SPEED
"""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path

from nl2robot.run.runlog import RunLog
from nl2robot.schedule.service import Timing
from nl2robot.station.station import simulated_station
from sim.world.loading import load_world
from tests.schedule.conftest import at

BEGINS = at("2026-11-30 07:55")


def main(folder: Path, began: float, speed: float) -> None:
    """`began`: when the day began, in seconds since the epoch; so many times faster it passes."""

    def clock() -> float:
        return BEGINS + (time.time() - began) * speed

    log = RunLog(folder / "runs.sqlite")
    timing = Timing(clock=clock, every=0.01)
    with simulated_station(load_world("ward"), log, seed=1, timing=timing):
        print("serving", flush=True)
        threading.Event().wait()


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]), float(sys.argv[3]))
