"""Kill the server, a program's process, a client, the command line: again and again, at any moment.

    python -m tests.attacks.kills [--seed S] [--times N]

Whatever a client has been told of must be in the log, which is whole; the run of whoever is dead
reads as interrupted; no process of theirs is left over; and the robot stands.
"""

from __future__ import annotations

import argparse
import contextlib
import json
import logging
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
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path
from typing import Any, Final

from nl2robot.cli.operator import Operator
from nl2robot.run.runlog import RunLog
from robot_api.client import Robot
from robot_api.errors import RobotError, Stopped
from tests.attacks.outcome import Row, report, what_is_no_sentence
from tests.attacks.served import (
    ROOT,
    Served,
    Watched,
    alive,
    children,
    memory,
    served,
)

TIMES: Final = 40
PROGRAM: Final = "while True:\n    robot.say('Good night.')\n    robot.battery()\n"
ENDLESS: Final = (
    "while True:\n"
    "    robot.goto('pharmacy')\n    robot.say('Good night.')\n    robot.goto('lobby')\n"
)
BEGINS_WITHIN: Final = 60.0
STANDS_WITHIN: Final = 3.0
"""Seconds in which the robot stands when whoever had it act is dead, or frozen."""
GONE_WITHIN: Final = 5.0
"""Seconds in which a program's process ends after its server."""
SHARES: Final[Mapping[str, int]] = {"server": 30, "program": 35, "client": 20, "command line": 15}
"""Of a hundred kills, how many hit whom."""
CALLED: Final = re.compile(r"^ +\d+ \w+\(.*\)", re.MULTILINE)
"""A line in which the command line tells of a call."""


class Told:
    """What a client is told of the calls of a program."""

    def __init__(self, operator: Operator) -> None:
        self.last = 0
        """The number of the last call whose result it was told."""
        self._changed = threading.Condition()
        operator.watch(self._hear, "program")

    def _hear(self, kind: str, data: Mapping[str, Any]) -> None:
        if data["what"] == "result":
            with self._changed:
                self.last = max(self.last, data["number"])
                self._changed.notify_all()

    def until(self, number: int, seconds: float) -> bool:
        """Whether it has been told of so many within that time."""
        with self._changed:
            return self._changed.wait_for(lambda: self.last >= number, seconds)


def trouble(home: Path, run: int, last: int, over: bool | None = False) -> str | None:
    """What the log has lost of a run, of which somebody was told up to the call `last`. `over`:
    whether it has come to an end that could be logged; None if that is not known."""
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
            most = max(known, default=0)
            return f"run {run}: call {last} was told of and is not in the log ({most})"
        if over is True and row.status is None:
            return f"run {run} is over, and the log does not say so"
        if over is False and (row.going_on or row.status is not None):
            return f"run {run} does not read as interrupted"
    finally:
        log.close()
    return None


def left_over(processes: list[int]) -> str | None:
    """Those of them that do not end by themselves."""
    ends = time.monotonic() + GONE_WITHIN
    while left := [each for each in processes if alive(each)]:
        if time.monotonic() > ends:
            return f"{len(left)} processes of a dead one are still there"
        time.sleep(0.02)
    return None


# --- the server ----------------------------------------------------------------------------------


def killed(home: Path, chance: random.Random, row: Row | None = None) -> tuple[int, int]:
    """Kill a server: the run, and the number of the last call whose result somebody was told of."""
    with served(home, "--speed", "50") as server:
        run, told = 0, None
        with contextlib.suppress(RobotError, Stopped), Robot(server.address) as robot:
            operator = Operator(robot, "Kim")
            told = Told(operator)
            run = operator.run(operator.approve(operator.check(PROGRAM), insists=True))
            told.until(1, BEGINS_WITHIN)
            time.sleep(chance.uniform(0, 0.5))
            workers = children(server.pid)
            if row is not None:
                row.used(memory(server.pid))
            server.kill()
            harm = left_over(workers)
            if row is not None and harm is not None:
                row.failures.append(harm)
    return run, told.last if told is not None else 0


def kill_servers(chance: random.Random, row: Row, times: int) -> None:
    """One after the other, all with the same log."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "home"
        home.mkdir()
        for _ in range(times):
            run, last = killed(home, chance, row)
            row.add(trouble(home, run, last))


# --- a program's process -------------------------------------------------------------------------


def kill_programs(chance: random.Random, row: Row, times: int) -> None:
    """The processes of programs, one after the other at the same server."""
    _at_one_server(chance, row, times, kill_program)


def kill_program(server: Served, chance: random.Random, row: Row) -> str | None:
    with Watched(server.address) as watched, Robot(server.address) as robot:
        operator = Operator(robot, "Kim")
        told = Told(operator)
        approval = operator.approve(operator.check(ENDLESS), insists=True)
        before = set(children(server.pid))
        run = operator.run(approval)
        if not watched.moves(BEGINS_WITHIN):
            return f"run {run}: the robot does not move"
        told.until(chance.choice((0, 0, 1, 2)), BEGINS_WITHIN)
        time.sleep(chance.uniform(0, 0.3))
        workers = set(children(server.pid)) - before
        if not workers:
            return f"run {run} has no process of its own"
        began = time.perf_counter()
        for each in workers:
            os.kill(each, signal.SIGKILL)
        if not watched.stands(STANDS_WITHIN):
            watched.stop(row)
            return f"run {run}: the robot moves on for {STANDS_WITHIN:.0f} s"
        row.stopped_in(1000 * (time.perf_counter() - began))
        status = operator.wait(run)
        if status.state != "failed":
            return f"run {run}: its process was killed, and it is {status.state}"
        wrong = what_is_no_sentence(status.message)
        return wrong or trouble(server.home, run, told.last, over=True)


def _at_one_server(
    chance: random.Random,
    row: Row,
    times: int,
    kill: Callable[[Served, random.Random, Row], str | None],
) -> None:
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "home"
        home.mkdir()
        with served(home, "--speed", "10") as server:
            for _ in range(times):
                row.add(kill(server, chance, row))
            row.used(memory(server.pid))
            faults = server.faults()
            if faults is not None:
                row.failures.append(f"the server complains:\n{faults}")


# --- a client ------------------------------------------------------------------------------------


def kill_clients(chance: random.Random, row: Row, times: int) -> None:
    """Those who have the robot driven about without a program; every third is frozen instead."""
    _at_one_server(chance, row, times, kill_client)


def kill_client(server: Served, chance: random.Random, row: Row) -> str | None:
    command = [sys.executable, "-m", "tests.attacks.kills", "--client", server.address]
    client = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    how = chance.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGSTOP))
    try:
        with Watched(server.address) as watched:
            if not watched.moves(BEGINS_WITHIN):
                return "the client's robot does not move"
            time.sleep(chance.uniform(0, 0.8))
            if not watched.moves(BEGINS_WITHIN):
                return "the client's robot does not move on"
            began = time.perf_counter()
            client.send_signal(how)
            if not watched.stands(STANDS_WITHIN):
                watched.stop(row)
                return f"the robot moves on for {STANDS_WITHIN:.0f} s after {how.name}"
            row.stopped_in(1000 * (time.perf_counter() - began))
            if watched.moves(0.3):
                watched.stop(row)
                return f"the robot moves again after {how.name}"
    finally:
        client.kill()
        done = json.loads((client.communicate()[0].splitlines() or ["0"])[-1])
    with closing(sqlite3.connect(server.home / "runs.sqlite")) as database:
        [[logged]] = database.execute("SELECT count(*) FROM by_hand").fetchall()
    before, server.by_hand = server.by_hand, logged
    if logged - before < done:
        return f"{done} calls were made by hand and {logged - before} are in the log"
    return None


def _drive_about(address: str) -> None:
    """What the client does, until it is killed: it says how many calls have come back."""
    done = 0
    with Robot(address) as robot:
        while True:
            for place in ("pharmacy", "lobby", "kitchen"):
                robot.goto(place)
                done += 1
                print(done, flush=True)


# --- the command line ----------------------------------------------------------------------------


def kill_command_lines(chance: random.Random, row: Row, times: int) -> None:
    """`nl2robot run`, which is its own server and runner, one after the other with one log."""
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder) / "home"
        home.mkdir()
        program = Path(folder) / "program.py"
        program.write_text(ENDLESS, "utf-8")
        for number in range(times):
            row.add(kill_command_line(home, program, chance, row, early=number % 5 == 4))


def kill_command_line(
    home: Path, program: Path, chance: random.Random, row: Row, early: bool = False
) -> str | None:
    """`early`: at any moment from its very start; else when it has told of some calls."""
    command = [sys.executable, "-m", "nl2robot.cli.main", "run", "-y", "--speed", "20"]
    with tempfile.TemporaryFile("w+", encoding="utf-8") as errors:
        process = subprocess.Popen(
            [*command, "--program", str(program)],
            cwd=ROOT,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
            env={**os.environ, "NL2ROBOT_HOME": str(home), "NL2ROBOT_LANGUAGE_MODEL": "none"},
        )
        assert process.stdout is not None
        said = ""
        if early:
            time.sleep(chance.uniform(0.05, 4.0))
        else:
            wanted = chance.randint(1, 4)
            for line in process.stdout:
                said += line
                if len(CALLED.findall(said)) >= wanted:
                    break
            time.sleep(chance.uniform(0, 0.5))
        workers = children(process.pid)
        row.used(memory(process.pid))
        process.kill()
        said += process.communicate()[0]
        errors.seek(0)
        complaint = errors.read()
    if "Traceback" in complaint:
        return complaint[-1000:]
    return left_over(workers) or _told_and_logged(home, len(CALLED.findall(said)))


def _told_and_logged(home: Path, told: int) -> str | None:
    if not (home / "runs.sqlite").exists():
        return f"{told} calls were told of, and there is no log" if told else None
    log = RunLog(home / "runs.sqlite")
    try:
        newest = log.runs(1)
        logged = len(log.calls(newest[0].id)) if newest else 0
    finally:
        log.close()
    if told > logged:
        return f"{told} calls were told of and {logged} are in the log"
    return trouble(home, newest[0].id, 0) if newest else None


# --- all of them ---------------------------------------------------------------------------------

KILLS: Final[Mapping[str, Callable[[random.Random, Row, int], None]]] = {
    "server": kill_servers,
    "program": kill_programs,
    "client": kill_clients,
    "command line": kill_command_lines,
}


def all_killed(seed: int, times: int, side_by_side: int = 2) -> list[Row]:
    """So many of all in all, two kinds at a time."""

    def one(name: str) -> Row:
        row = Row(f"killed: {name}")
        chance = random.Random(f"kills {seed} {name}")
        KILLS[name](chance, row, max(1, round(times * SHARES[name] / 100)))
        return row

    with ThreadPoolExecutor(side_by_side) as pool:
        return list(pool.map(one, KILLS))


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--times", type=int, default=TIMES)
    parser.add_argument("--client", metavar="ADDRESS", help=argparse.SUPPRESS)
    given = parser.parse_args()
    logging.disable()  # of clients whose server is gone
    if given.client:
        _drive_about(given.client)
    return report(all_killed(given.seed, given.times), f"Kills, seed {given.seed}")


if __name__ == "__main__":
    sys.exit(main())
