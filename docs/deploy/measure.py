#!/usr/bin/env python3
"""How long `nl2robot serve` takes to be there, and how much memory it takes then.

    python docs/deploy/measure.py                         # a simulated hospital
    python docs/deploy/measure.py --robot emulator        # what follows is handed to serve
    NL2ROBOT_LANGUAGE_MODEL=none python docs/deploy/measure.py

It is started several times, the first time apart: that one finds nothing in memory that the others
find there. The memory is that of the server and all its processes (what several share is counted
once), when it no longer grows: the language model, if there is one, has been loaded then.
"""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

RUNS = 5
STEADY = 5.0
"""Seconds for which the memory must not grow."""


@contextmanager
def served(arguments: Sequence[str]) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """A server in a process of its own, and the address of its page once it says it."""
    server = subprocess.Popen(
        [sys.executable, "-m", "nl2robot.cli.main", "serve", "--port", "0", *arguments],
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert server.stdout is not None
        yield server, server.stdout.readline().split("page: ")[1].split(")")[0]
    finally:
        server.terminate()
        server.wait()


def is_there(page: str) -> None:
    with urllib.request.urlopen(f"{page}healthz", timeout=10) as answer:
        assert answer.status == 200


def processes(pid: int) -> Iterator[int]:
    yield pid
    for task in Path(f"/proc/{pid}/task").iterdir():
        for child in (task / "children").read_text().split():
            yield from processes(int(child))


def worked(pid: int) -> float:
    """Seconds that a processor worked for it: on a busy machine it takes longer by the clock."""
    times = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[11:13]
    return sum(map(int, times)) / os.sysconf("SC_CLK_TCK")


def megabytes(pid: int) -> float:
    """Of memory that would be free if this process and its children were not."""
    kilobytes = 0
    for each in processes(pid):
        for line in Path(f"/proc/{each}/smaps_rollup").read_text().splitlines():
            if line.startswith("Pss:"):
                kilobytes += int(line.split()[1])
    return kilobytes / 1024


def steady(pid: int) -> float:
    """The memory once it has stopped growing."""
    most, since = 0.0, time.monotonic()
    while time.monotonic() - since < STEADY:
        now = megabytes(pid)
        if now > most + 1:
            most, since = now, time.monotonic()
        time.sleep(0.5)
    return megabytes(pid)


def main(arguments: Sequence[str]) -> None:
    seconds, processor, memory = [], [], []
    for _ in range(1 + RUNS):
        began = time.monotonic()
        with served(arguments) as (server, page):
            is_there(page)
            seconds.append(time.monotonic() - began)
            processor.append(worked(server.pid))
            memory.append(steady(server.pid))
    print(f"first start: {seconds[0]:.1f} s")
    print(
        f"start, median of {RUNS}: {statistics.median(seconds[1:]):.1f} s,"
        f" {statistics.median(processor[1:]):.1f} s of them a processor's"
    )
    print(f"memory, median: {statistics.median(memory):.0f} MB")


if __name__ == "__main__":
    main(sys.argv[1:])
