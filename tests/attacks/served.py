"""A server to be attacked: a process of its own with a simulated robot."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from robot_api.client import Robot
from tests.attacks.outcome import Row

ROOT: Final = Path(__file__).parents[2]
SERVE: Final = ("-m", "nl2robot.cli.main", "serve")
STANDS: Final = 0.01
"""Metres per second, and less."""


@dataclass
class Served:
    """A server that is up."""

    address: str
    process: subprocess.Popen[str]
    home: Path
    errors: Path
    """What it has written to standard error."""
    seen: int = 0
    """Letters of its complaints that are known."""
    by_hand: int = 0
    """Calls in its log that were made without a program, when that was last looked at."""

    @property
    def pid(self) -> int:
        return self.process.pid

    def faults(self) -> str | None:
        """What it has complained of since `forget_faults`; None if nothing."""
        said = self._said()[self.seen :]
        return said[said.index("Traceback") :][-1500:] if "Traceback" in said else None

    def forget_faults(self) -> None:
        """They have been told."""
        self.seen = len(self._said())

    def _said(self) -> str:
        files = (self.errors, self.home / "faults.log")
        return "".join(each.read_text("utf-8", "replace") for each in files if each.exists())

    def kill(self) -> None:
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()


@contextlib.contextmanager
def served(
    home: Path,
    *more: str,
    launch: Sequence[str] = SERVE,
    prepare: Callable[[], None] | None = None,
) -> Iterator[Served]:
    """A server whose data are in `home`, which is not removed; `more` are its options."""
    errors = home.parent / f"{home.name}.errors"
    with errors.open("w", encoding="utf-8") as stderr:
        process = subprocess.Popen(
            [sys.executable, *launch, "--port", "0", *more],
            cwd=ROOT,
            stdout=subprocess.PIPE,
            stderr=stderr,
            text=True,
            env={
                **os.environ,
                "NL2ROBOT_HOME": str(home),
                "NL2ROBOT_LANGUAGE_MODEL": "none",
            },
            preexec_fn=prepare,
        )
    assert process.stdout is not None
    try:
        said = process.stdout.readline()
        found = re.search(r"ws://([^/ ]+)", said)
        assert found is not None, said + errors.read_text("utf-8", "replace")[-2000:]
        yield Served(found[1], process, home, errors)
    finally:
        process.terminate()
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()


def memory(process: int) -> float:
    """Megabytes that it has used at most; 0 if it is gone."""
    return _status(process, "VmHWM")


def memory_now(process: int) -> float:
    """Megabytes that it uses."""
    return _status(process, "VmRSS")


def _status(process: int, field: str) -> float:
    with contextlib.suppress(OSError):
        status = Path(f"/proc/{process}/status").read_text("utf-8")
        found = re.search(rf"{field}:\s+(\d+) kB", status)
        return int(found[1]) / 1000 if found else 0.0
    return 0.0


def children(process: int) -> list[int]:
    """The processes that it has begun and that are there."""
    found: list[int] = []
    with contextlib.suppress(OSError):
        for task in Path(f"/proc/{process}/task").iterdir():
            with contextlib.suppress(OSError):
                found += map(int, (task / "children").read_text("utf-8").split())
    return found


def alive(process: int) -> bool:
    """Whether it is there and has not ended."""
    try:
        said = Path(f"/proc/{process}/stat").read_text("utf-8", "replace")
    except OSError:
        return False
    return said.rpartition(")")[2].split()[0] not in "ZX"


class Watched:
    """Knows whether the robot moves, from a client's connection of its own."""

    def __init__(self, address: str) -> None:
        self.robot = Robot(address)
        self._changed = threading.Condition()
        self._speed = 0.0
        self.robot.subscribe(["pose"], self._seen)

    def __enter__(self) -> Watched:
        return self

    def __exit__(self, *_: object) -> None:
        self.robot.close()

    def _seen(self, kind: str, data: dict[str, Any]) -> None:
        with self._changed:
            self._speed = data["speed"]
            self._changed.notify_all()

    def moves(self, seconds: float) -> bool:
        """Whether it is on its way within that time."""
        with self._changed:
            return self._changed.wait_for(lambda: self._speed > 0.2, seconds)

    def stands(self, seconds: float) -> bool:
        """Whether it stands within that time."""
        with self._changed:
            return self._changed.wait_for(lambda: self._speed < STANDS, seconds)

    def stop(self, row: Row) -> None:
        """Stop it, and note how long that took."""
        began = time.perf_counter()
        self.robot.stop()
        row.stopped_in(1000 * (time.perf_counter() - began))
