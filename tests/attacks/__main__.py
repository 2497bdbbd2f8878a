"""How long a stop takes while somebody attacks: a table.

    python -m tests.attacks [SECONDS FOR EACH]

A server of its own with a simulated robot, which another client sends about; a stop is measured
from its request to the answer that the robot stands. It is asked then whether it does.
"""

from __future__ import annotations

import contextlib
import logging
import os
import re
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from pathlib import Path

from rich.table import Table

from nl2robot.terminal import Terminal
from robot_api.client import Robot
from robot_api.errors import RobotError, Stopped
from tests.attacks.attackers import ATTACKS

SECONDS = 15.0
NOBODY = "nobody"
WANTED = 50.0
"""Milliseconds."""


@contextlib.contextmanager
def server() -> Iterator[tuple[str, int]]:
    """Its address and its process."""
    with tempfile.TemporaryDirectory() as home:
        command = [sys.executable, "-m", "nl2robot.cli", "serve", "--port", "0"]
        environment = {"NL2ROBOT_HOME": home, "NL2ROBOT_LANGUAGE_MODEL": "none"}
        process = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, **environment},
        )
        try:
            assert process.stdout is not None
            said = process.stdout.readline()
            found = re.search(r"ws://([^/ ]+)", said)
            assert found, said
            yield found[1].rstrip("/"), process.pid
        finally:
            process.terminate()
            process.wait(20)


def memory(process: int) -> float:
    """Megabytes that it has used at most."""
    status = Path(f"/proc/{process}/status").read_text("utf-8")
    found = re.search(r"VmHWM:\s+(\d+) kB", status)
    return int(found[1]) / 1000 if found else 0.0


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


def stops(address: str, seconds: float) -> list[float]:
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


def attacked(name: str, seconds: float) -> tuple[int, list[float], float]:
    """How often it was tried, the stops meanwhile, and the server's memory."""
    with server() as (address, process):
        attacker = None
        if name != NOBODY:
            command = [sys.executable, "-m", "tests.attacks.attackers"]
            attacker = subprocess.Popen(
                [*command, name, address, str(seconds + 2)], stdout=subprocess.PIPE, text=True
            )
            time.sleep(2)
        taken = stops(address, seconds)
        tried = int(attacker.communicate(timeout=60)[0] or 0) if attacker else 0
        return tried, taken, memory(process)


def main() -> None:
    logging.disable()  # of clients whose server is gone
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else SECONDS
    table = Table("attack", "tried", "stops", "median", "95 %", "worst", "memory", title="Stops")
    console = Terminal().console
    worst = 0.0
    for name in (NOBODY, *ATTACKS):
        tried, taken, used = attacked(name, seconds)
        taken.sort()
        at95 = taken[int(0.95 * (len(taken) - 1))]
        worst = max(worst, taken[-1])
        row = (f"{statistics.median(taken):.1f} ms", f"{at95:.1f} ms", f"{taken[-1]:.1f} ms")
        table.add_row(name, str(tried), str(len(taken)), *row, f"{used:.0f} MB")
        console.print(name, *row)
    console.print(table)
    console.print(f"The worst took {worst:.0f} ms; wanted: {WANTED:.0f} ms.")


if __name__ == "__main__":
    main()
