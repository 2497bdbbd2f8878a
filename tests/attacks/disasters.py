"""The disk is full, the log is tampered with, the clock jumps: what does the robot do?

    python -m tests.attacks.disasters [--seed S] [--times N]

A program drives the robot about meanwhile. Whatever happens, it is not told that something was done
which the log does not have, the robot comes to stand, a stop is heard, and it is said in a sentence
what is wrong.
"""

from __future__ import annotations

import argparse
import contextlib
import logging
import random
import resource
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

import msgspec

from nl2robot.cli.operator import Operator
from nl2robot.run.runs import Status
from nl2robot.run.state import GOING
from robot_api.client import Robot
from robot_api.errors import AccessDenied, RobotError
from tests.attacks.clock import set_clock
from tests.attacks.kills import ENDLESS, Told, trouble
from tests.attacks.outcome import Row, report, what_is_no_sentence
from tests.attacks.served import Served, Watched, memory, served

DISK: Final = 3_000_000
"""Bytes of a disk that is soon full."""
WITHIN: Final = 20.0
"""Seconds in which a run that cannot be logged ends."""
STANDS_WITHIN: Final = 3.0
"""Seconds in which its robot stands."""
JUMPS: Final = (1e12, -86_400.0 * 400, 3600.0, -3600.0, 86_400.0 * 400, 1e10, -1e12, -1e9, 2.0**62)
"""Seconds. With some of them there is no date any more that Python knows."""
A_DATE_HAS: Final = 2e11
"""Seconds of a clock of which Python can tell the year; no system's own comes that far. Beyond,
websockets cannot greet: who is connected is heard, and nobody new comes in."""
SHORT: Final = 'robot.say("Still here.")\n'


# --- the disk ------------------------------------------------------------------------------------


@contextlib.contextmanager
def small_disk(folder: Path) -> Iterator[bool]:
    """A disk of its own in this folder. False where none may be mounted: files may not become
    long then, which is another error of the same kind."""
    folder.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", f"size={DISK}", "none", str(folder)]
    try:
        mounted = subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        mounted = False
    try:
        yield mounted
    finally:
        if mounted:
            subprocess.run(["umount", "-l", str(folder)], check=False)


def _short_files() -> None:
    resource.setrlimit(resource.RLIMIT_FSIZE, (DISK // 8, DISK // 8))


def disk_full(chance: random.Random, row: Row) -> None:
    """Fill it while a program runs, and make room again."""
    with tempfile.TemporaryDirectory() as folder, small_disk(Path(folder) / "disk") as mounted:
        home = Path(folder) / "disk" / "home"
        home.mkdir()
        prepare = None if mounted else _short_files
        with served(home, "--speed", "50", prepare=prepare) as server:
            row.add(_in_mid_program(server, chance, row, lambda: _fill(home, chance, mounted)))
            (home.parent / "filler").unlink(missing_ok=True)
            if mounted:
                row.add(_runs_again(server))
            row.add(server.faults())


def _fill(home: Path, chance: random.Random, mounted: bool) -> None:
    if not mounted:
        return  # it comes by itself
    left = shutil.disk_usage(home).free
    with contextlib.suppress(OSError), (home.parent / "filler").open("wb") as file:
        for size in (max(0, left - chance.randrange(1, 200_000)), 4096, 1024, 1):
            with contextlib.suppress(OSError):
                while size:
                    written = file.write(b"\0" * min(size, 65_536))
                    file.flush()
                    size = size - written if size > 65_536 else 0


# --- the log -------------------------------------------------------------------------------------


def deleted(path: Path) -> None:
    path.unlink()


def without_what_was_just_written(path: Path) -> None:
    Path(f"{path}-wal").unlink()


def cut(path: Path) -> None:
    with path.open("r+b") as file:
        file.truncate(path.stat().st_size // 2)


def what_was_just_written_cut(path: Path) -> None:
    with Path(f"{path}-wal").open("r+b") as file:
        file.truncate(0)


def replaced(path: Path) -> None:
    other = path.with_name("other")
    other.write_bytes(path.read_bytes())
    other.replace(path)


def folder_gone(path: Path) -> None:
    path.parent.rename(path.parent.with_name("elsewhere"))


TAMPERINGS: Final[tuple[Callable[[Path], None], ...]] = (
    deleted,
    without_what_was_just_written,
    cut,
    what_was_just_written_cut,
    replaced,
    folder_gone,
)


def tampered(chance: random.Random, row: Row, how: Callable[[Path], None]) -> None:
    """Do it to the log while a program runs; the run ends, and there is no next one."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "home"
        home.mkdir()
        with served(home, "--speed", "50") as server:
            harm = _in_mid_program(
                server, chance, row, lambda: how(home / "runs.sqlite"), logged=False
            )
            row.add(harm and f"{how.__name__}: {harm}")
            row.add(_is_refused(server))
            row.add(server.faults())


def _is_refused(server: Served) -> str | None:
    with Robot(server.address) as robot:
        operator = Operator(robot, "Kim")
        try:
            run = operator.run(operator.approve(operator.check(SHORT)))
        except RobotError as error:
            return what_is_no_sentence(str(error))
        return f"run {run} began though the log is not the one that was written"


# --- the clock -----------------------------------------------------------------------------------


def clock_jumps(chance: random.Random, row: Row, times: int) -> None:
    """One server whose clock jumps again and again, while programs run and stops are asked for."""
    with tempfile.TemporaryDirectory() as folder:
        home, file = Path(folder) / "home", Path(folder) / "clock"
        home.mkdir()
        set_clock(file, 0.0)
        launch = ("-m", "tests.attacks.clock", str(file), "serve")
        with served(home, "--speed", "20", launch=launch) as server:
            for each in range(times):
                seconds = JUMPS[each % len(JUMPS)] * chance.uniform(0.9, 1.0)
                harm = _jumped(server, row, file, seconds)
                row.add(harm and f"the clock jumps by {seconds:g} s: {harm}")
                row.add(server.faults())
                server.forget_faults()
            row.used(memory(server.pid))


def _jumped(server: Served, row: Row, file: Path, seconds: float) -> str | None:
    set_clock(file, 0.0)
    with Watched(server.address) as watched, Robot(server.address) as robot:
        operator = Operator(robot, "Kim")
        approval = operator.approve(operator.check(ENDLESS), insists=True)
        other = operator.approve(operator.check(SHORT))
        run = operator.run(approval)
        if not watched.moves(WITHIN):
            return "the robot does not move"
        set_clock(file, seconds)
        watched.robot.battery()
        watched.stop(row)
        if not watched.stands(STANDS_WITHIN):
            return "the robot moves on after a stop"
        status = operator.wait(run)
        if status.state != "stopped":
            return f"the run ends with {status.state}: {status.message}"
        if abs(seconds) > A_DATE_HAS:
            set_clock(file, 0.0)
        # What was approved just now holds, whatever the clock on the wall says, and once.
        again = operator.run(other)
        ended = operator.wait(again)
        if ended.state != "done":
            return f"the next run ends with {ended.state}: {ended.message}"
        try:
            operator.run(other)
        except AccessDenied as error:
            harm = what_is_no_sentence(str(error))
        else:
            harm = "an approval holds twice"
        set_clock(file, 0.0)
        return harm


# --- all of them ---------------------------------------------------------------------------------


def _in_mid_program(
    server: Served, chance: random.Random, row: Row, strike: Callable[[], None], logged: bool = True
) -> str | None:
    """Strike while a program drives the robot; what was not borne."""
    with Watched(server.address) as watched, Robot(server.address) as robot:
        operator = Operator(robot, "Kim")
        told = Told(operator)
        run = operator.run(operator.approve(operator.check(ENDLESS), insists=True))
        if not watched.moves(WITHIN) or not told.until(chance.randint(0, 3), WITHIN):
            return "the program does not get on"
        strike()
        parameters = {"run": run, "timeout": WITHIN}
        status = msgspec.convert(robot.request("program.wait", parameters), Status)
        row.used(memory(server.pid))
        if status.state in GOING:
            return f"nothing can be logged, and the run goes on for {WITHIN:.0f} s"
        if not watched.stands(STANDS_WITHIN):
            return "the robot moves on"
        watched.stop(row)
        harm = what_is_no_sentence(status.message)
        return trouble(server.home, run, told.last, over=None) if logged and not harm else harm


def _runs_again(server: Served) -> str | None:
    """Once there is room, the robot does what it is told."""
    with Robot(server.address) as robot:
        operator = Operator(robot, "Kim")
        try:
            run = operator.run(operator.approve(operator.check(SHORT)))
        except RobotError as error:
            return f"there is room again, and still: {error}"
        status = operator.wait(run)
        return None if status.state == "done" else f"{status.state}: {status.message}"


def struck(seed: int, times: int) -> list[Row]:
    """Each of them so often."""
    chance = random.Random(f"disasters {seed}")
    full, log, clock = Row("disk full"), Row("log tampered with"), Row("clock jumps")
    for _ in range(times):
        disk_full(chance, full)
    for each in range(times):
        tampered(chance, log, TAMPERINGS[each % len(TAMPERINGS)])
    clock_jumps(chance, clock, times)
    return [full, log, clock]


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--times", type=int, default=9)
    given = parser.parse_args()
    logging.disable()  # of clients whose server is gone
    return report(struck(given.seed, given.times), f"Disasters, seed {given.seed}")


if __name__ == "__main__":
    sys.exit(main())
