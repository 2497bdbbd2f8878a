"""How long a stop takes while somebody attacks: a table.

    python -m tests.attacks.stops [SECONDS FOR EACH]

A server of its own with a simulated robot, which another client sends about; a stop is measured
from its request to the answer that the robot stands. It is asked then whether it does.
"""

from __future__ import annotations

import contextlib
import logging
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from typing import Final

from rich.table import Table

from nl2robot.cli.terminal import Terminal
from robot_api.client import Robot
from robot_api.errors import RobotError, Stopped
from tests.attacks.attackers import ATTACKS
from tests.attacks.outcome import Row
from tests.attacks.served import ROOT, memory, served

SECONDS: Final = 15.0
NOBODY: Final = "nobody"
WANTED: Final = 50.0
"""Milliseconds."""
DEAF: Final = 1000.0
"""Milliseconds: a stop that takes longer was not heard in time."""


class Wanderer:
    """Sends the robot about, so that there is something to stop."""

    def __init__(self, address: str) -> None:
        self._robot = Robot(address)
        self._moving = threading.Event()
        self._robot.subscribe(["pose"], self._seen)
        self.over = False
        self._thread = threading.Thread(target=self._wander, daemon=True)
        self._thread.start()

    def _seen(self, kind: str, data: dict[str, float]) -> None:
        (self._moving.set if data["speed"] > 0.2 else self._moving.clear)()

    def _wander(self) -> None:
        places = ["lobby", "pharmacy", "kitchen", "ward a"]
        while not self.over:
            for place in places:
                with contextlib.suppress(RobotError, Stopped):
                    self._robot.goto(place)

    def moves(self, seconds: float) -> bool:
        return self._moving.wait(seconds)

    @property
    def stands(self) -> bool:
        return not self._moving.is_set()


def _stops(address: str, seconds: float) -> list[float]:
    """Milliseconds of each stop in that time."""
    taken = []
    wanderer = Wanderer(address)
    with Robot(address) as nurse:
        ends = time.monotonic() + seconds
        while time.monotonic() < ends:
            if not wanderer.moves(5):
                continue
            began = time.perf_counter()
            nurse.stop()
            taken.append(1000 * (time.perf_counter() - began))
            time.sleep(0.05)
    wanderer.over = True
    return taken


def attacked(name: str, seconds: float) -> tuple[int, list[float], float, str | None]:
    """How often it was tried, the stops meanwhile, the server's memory, and its complaints."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "home"
        home.mkdir()
        with served(home) as server:
            attacker = None
            if name != NOBODY:
                command = [sys.executable, "-m", "tests.attacks.attackers"]
                attacker = subprocess.Popen(
                    [*command, name, server.address, str(seconds + 2)],
                    cwd=ROOT,
                    stdout=subprocess.PIPE,
                    text=True,
                )
                time.sleep(2)
            taken = _stops(server.address, seconds)
            tried = int(attacker.communicate(timeout=60)[0] or 0) if attacker else 0
            return tried, taken, memory(server.pid), server.faults()


def measured(seconds: float) -> tuple[list[Row], Table]:
    """Each attack for so long; the rows, and all that was measured."""
    table = Table("attack", "tried", "stops", "median", "95 %", "worst", "memory", title="Stops")
    console, rows = Terminal().console, []
    for name in (NOBODY, *ATTACKS):
        tried, taken, used, faults = attacked(name, seconds)
        taken.sort()
        row = Row(f"stops: {name}", tried or len(taken), tried or len(taken), memory=used)
        rows.append(row)
        if faults is not None:
            row.failures.append(f"the server complains:\n{faults}")
        if not taken:
            row.failures.append("no stop was heard")
            continue
        row.stopped_in(taken[-1])
        if taken[-1] > DEAF:
            row.failures.append(f"a stop took {taken[-1]:.0f} ms")
        at95 = taken[int(0.95 * (len(taken) - 1))]
        told = (f"{statistics.median(taken):.1f} ms", f"{at95:.1f} ms", f"{taken[-1]:.1f} ms")
        table.add_row(name, str(tried), str(len(taken)), *told, f"{used:.0f} MB")
        console.print(name, *told)
    return rows, table


def main() -> int:
    logging.disable()  # of clients whose server is gone
    rows, table = measured(float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS)
    console = Terminal().console
    console.print(table)
    worst = max(row.stop or 0.0 for row in rows)
    console.print(f"The worst took {worst:.0f} ms; wanted: {WANTED:.0f} ms.")
    failures = [failure for row in rows for failure in row.failures]
    for failure in failures:
        console.print(failure, markup=False)
    return int(bool(failures))


if __name__ == "__main__":
    sys.exit(main())
