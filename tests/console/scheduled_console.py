"""A console whose appointments go by a clock that a test sets: `python scheduled_console.py [what
nl2robot serve takes]`.

Each line on its input is what the clocks of Zurich show from then on, as 2026-11-30T10:30; it is
answered by the same on its output. At first it is Monday, six in the morning.
"""

from __future__ import annotations

import os
import sys
import threading
from datetime import datetime
from functools import partial

os.environ["TZ"] = "Europe/Zurich"

from nl2robot.cli.commands import serve
from nl2robot.cli.main import main
from nl2robot.schedule.rhythm import moment_of
from nl2robot.schedule.service import Timing


class Clock:
    """Seconds since the epoch."""

    def __init__(self) -> None:
        self.set("2026-11-30T06:00")

    def __call__(self) -> float:
        return self._now

    def set(self, local: str) -> None:
        self._now = moment_of(datetime.fromisoformat(local), os.environ["TZ"])


def obey(clock: Clock) -> None:
    for line in sys.stdin:
        clock.set(line.strip())
        print(line, end="", flush=True)


if __name__ == "__main__":
    clock = Clock()
    serve.Timing = partial(Timing, clock=clock, every=0.05)  # type: ignore[misc, assignment]
    threading.Thread(target=obey, args=(clock,), daemon=True).start()
    sys.exit(main(["serve", *sys.argv[1:]]))
