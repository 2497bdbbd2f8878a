"""Kill a server again and again in mid-program: what of its runs is in the log afterwards?

    python -m tests.attacks.kills [TIMES]

Whatever a client has been told of must be there, and the run of a dead server reads as interrupted.
"""

from __future__ import annotations

import contextlib
import os
import random
import re
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Mapping
from contextlib import closing
from pathlib import Path
from typing import Any

from nl2robot.operator import Operator
from nl2robot.runlog import RunLog
from robot_api.client import Robot
from robot_api.errors import RobotError, Stopped

TIMES = 40
PROGRAM = "while True:\n    robot.say('Good night.')\n    robot.battery()\n"


def server(home: Path) -> tuple[subprocess.Popen[str], str]:
    process = subprocess.Popen(
        [sys.executable, "-m", "nl2robot.cli", "serve", "--port", "0", "--speed", "50"],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "NL2ROBOT_HOME": str(home), "NL2ROBOT_LANGUAGE_MODEL": "none"},
    )
    assert process.stdout is not None
    found = re.search(r"ws://([^/ ]+)", process.stdout.readline())
    assert found is not None
    return process, found[1]


def killed(home: Path, chance: random.Random) -> tuple[int, int]:
    """The run, and the number of the last call whose result somebody was told of."""
    process, address = server(home)
    results, begun = [0], threading.Event()

    def told(kind: str, data: Mapping[str, Any]) -> None:
        if data["what"] == "result":
            results.append(data["number"])
            begun.set()

    run = 0
    with contextlib.suppress(RobotError, Stopped), Robot(address) as robot:
        operator = Operator(robot, "Kim")
        operator.watch(told, "program")
        run = operator.run(operator.approve(operator.check(PROGRAM), insists=True))
        begun.wait(60)
        time.sleep(chance.uniform(0, 0.5))
        process.send_signal(signal.SIGKILL)
    process.wait()
    return run, max(results)


def trouble(home: Path, run: int, last: int) -> str | None:
    """What the log has lost."""
    file = home / "runs.sqlite"
    with closing(sqlite3.connect(file)) as database:
        [[whole]] = database.execute("PRAGMA integrity_check").fetchall()
    if whole != "ok":
        return f"run {run}: {whole}"
    log = RunLog(file)
    try:
        row = log.run(run)
        known = [each.number for each in log.calls(run) if each.seconds is not None]
        if row is None or max(known, default=0) < last:
            return f"run {run}: call {last} was told of and is not in the log ({max(known)})"
        if row.going_on or row.status is not None:
            return f"run {run} does not read as interrupted"
    finally:
        log.close()
    return None


def main() -> int:
    times = int(sys.argv[1]) if len(sys.argv) > 1 else TIMES
    chance, lost, calls = random.Random(1), 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for _ in range(times):
            run, last = killed(Path(folder), chance)
            calls += last
            wrong = trouble(Path(folder), run, last)
            if wrong is not None:
                lost += 1
                print(wrong)
    print(f"{times} servers killed after {calls} calls in all: {lost} logs with something lost.")
    return min(1, lost)


if __name__ == "__main__":
    sys.exit(main())
