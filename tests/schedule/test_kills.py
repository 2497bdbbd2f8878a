"""A server is killed at random moments of a scheduled day, and started again each time: nothing
runs twice, nothing is lost, and what was not done is told."""

from __future__ import annotations

import itertools
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.review.review import digest, review
from nl2robot.run.runlog import RunLog
from nl2robot.schedule.appointments import OVER
from nl2robot.schedule.book import Book
from nl2robot.schedule.findings import encoded, findings_of
from nl2robot.schedule.rhythm import times
from nl2robot.schedule.schedule import FILE
from sim.simulation import Simulation
from sim.world.loading import load_world
from tests.schedule.conftest import Clock, add, at, rhythm
from tests.schedule.killed_server import BEGINS

SPEED = 300.0
"""How much faster the clock of the day runs: ten minutes of it are two seconds."""
ROUNDS = ('robot.goto("ward a")\nrobot.say("One.")\n', 'robot.goto("ward b")\nrobot.say("Two.")\n')
TOLD = ("missed", "missed_many", "overtaken", "failed", "broken_off", "refused", "changed")


class Day:
    """A scheduled day of a server that is killed again and again."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.began = time.time()
        clock = Clock()
        clock.now = BEGINS
        book = Book(folder / FILE, clock)
        world = load_world("ward")
        for number, program in enumerate(ROUNDS):
            reviewed = review(program, Knowledge(world), Simulation(world))
            add(
                book,
                clock,
                program=program,
                sha256=digest(program),
                reviewed=encoded(findings_of(reviewed)),
                robot="The simulated robot",
                rhythm=rhythm("FREQ=MINUTELY;INTERVAL=10", f"2026-11-30 08:0{number * 5}"),
                makes_up=10 * number,
            )
        book.close()

    @property
    def now(self) -> float:
        return BEGINS + (time.time() - self.began) * SPEED

    def serve(self, seconds: float, how: signal.Signals) -> None:
        """Serve for so long, then end it so."""
        words = (str(self.folder), str(self.began), str(SPEED))
        with subprocess.Popen(
            [sys.executable, "-m", "tests.schedule.killed_server", *words],
            stdout=subprocess.PIPE,
            text=True,
        ) as server:
            assert server.stdout is not None
            assert server.stdout.readline() == "serving\n"
            try:
                server.wait(seconds)
            except subprocess.TimeoutExpired:
                server.send_signal(how)

    def check(self) -> None:
        """What the book, the log and the notices say of it all fits together."""
        book, log = Book(self.folder / FILE), RunLog(self.folder / "runs.sqlite")
        came = book.history(last=100_000)
        runs = log.runs(100_000)
        notices = book.notices(last=100_000)
        numbers = [each.run for each in came if each.run is not None]
        assert len(numbers) == len(set(numbers)), "a run belongs to one time"
        # Killed between the two, a run is in the log and not in the book yet: the next server
        # notes it with what was claimed for it.
        claimed = {each.process for each in came if each.state == "claimed"}
        beside = [run for run in runs if run.id not in numbers]
        assert len(beside) <= len(claimed), "nothing ran beside the book"
        assert {run.process for run in beside} <= claimed
        assert set(numbers) <= {run.id for run in runs}
        by_number = {run.id: run for run in runs}
        for each in came:
            if each.state == "done":
                assert by_number[each.run or 0].status == "done"
        for appointment in book.appointments():
            assert appointment.rhythm is not None
            mine = [each for each in came if each.appointment == appointment.id]
            dues = itertools.takewhile(
                lambda due, until=appointment.looked: due <= until,  # type: ignore[misc]
                times(appointment.rhythm, appointment.added),
            )
            assert sorted(each.due for each in mine) == list(dues), "each time is in the book once"
            told = {each.occurrence for each in notices if each.kind in TOLD}
            many = sum(
                each.parts["count"] - 1
                for each in notices
                if each.kind == "missed_many" and each.appointment == appointment.id
            )
            untold = [
                each
                for each in mine
                if each.state in ("missed", "failed", "asked") and each.id not in told
            ]
            assert len(untold) == many, "what was not done is told"
        book.close()
        log.close()

    def over(self) -> None:
        """Serve once more, until what was begun has its end."""
        self.serve(6.0, signal.SIGKILL)
        book = Book(self.folder / FILE)
        open_ = [each for each in book.history(last=100_000) if each.state not in OVER]
        # Of what came in the last moments something may still be open.
        assert all(each.due > self.now - 3600.0 for each in open_), open_
        book.close()


def test_killed_at_random_nothing_runs_twice_or_is_lost(tmp_path: Path, soak: bool) -> None:
    chance = random.Random(None if soak else 30)
    day = Day(tmp_path)
    for _ in range(200 if soak else 5):
        how = chance.choice((signal.SIGKILL, signal.SIGKILL, signal.SIGTERM))
        day.serve(chance.uniform(0.2, 4.0), how)
        day.check()
    day.over()
    day.check()
    book = Book(tmp_path / FILE)
    done = [each for each in book.history(last=100_000) if each.state == "done"]
    assert done, "and in between it works"
    book.close()


@pytest.mark.parametrize("moment", ["before", "claimed", "running", "ended"])
def test_killed_at_each_step_of_a_run(tmp_path: Path, moment: str) -> None:
    """Before its time is claimed, after, with its program begun, and before its end is noted."""
    words = ("tests.schedule.killed_at", str(tmp_path), moment)
    day = Day(tmp_path)
    killed = subprocess.run([sys.executable, "-m", *words], check=False)
    assert killed.returncode == -signal.SIGKILL
    book = Book(tmp_path / FILE)
    [first] = [each for each in book.history() if each.due == at("2026-11-30 08:00")]
    expected = {"before": "due", "claimed": "claimed", "running": "claimed", "ended": "running"}
    assert first.state == expected[moment]
    subprocess.run([sys.executable, "-m", *words[:2], "never"], check=True)
    runs = RunLog(tmp_path / "runs.sqlite").runs()
    [first] = [each for each in book.history() if each.due == at("2026-11-30 08:00")]
    kinds = [each.kind for each in book.notices() if each.occurrence == first.id]
    match moment:
        case "before":
            assert first.state == "done" and len(runs) == 1 and kinds == []
        case "claimed":
            assert first.state == "failed" and runs == [] and kinds == ["broken_off"]
        case "running":
            [run] = runs
            assert first.state == "failed" and first.run == run.id and kinds == ["broken_off"]
        case "ended":
            [run] = runs
            assert first.state == "done" and first.run == run.id and kinds == []
    book.close()
    day.check()
