"""Who touches the log while it is written is noticed, also between two looks."""

from __future__ import annotations

import os
import sqlite3
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from nl2robot.run.log_file import LogFile, Tampered


class Log:
    def __init__(self, path: Path) -> None:
        self.ahead = Path(f"{path}-wal")
        self.database = sqlite3.connect(path)
        self.database.execute("PRAGMA journal_mode=WAL")
        self.database.execute("CREATE TABLE lines (text TEXT)")
        self.file = LogFile(path)

    def write(self, text: str = "robot.goto('pharmacy')") -> None:
        """A line, with nobody looking at it."""
        self.database.execute("INSERT INTO lines VALUES (?)", (text,))
        self.database.commit()

    def write_and_note(self) -> None:
        self.file.check()
        self.write()
        self.file.note()


@pytest.fixture
def log(tmp_path: Path) -> Iterator[Log]:
    made = Log(tmp_path / "runs.sqlite")
    yield made
    made.database.close()


def test_nobody_touched_it_however_much_is_written(log) -> None:
    """Also when SQLite begins its write-ahead log anew."""
    for _ in range(50):
        log.write_and_note()
    log.database.execute("PRAGMA wal_checkpoint")
    for _ in range(1500):
        log.write_and_note()
    log.file.check()


@pytest.mark.parametrize("left", [0.0, 0.3, 0.6, 0.9])
def test_cut_between_a_look_and_a_line_that_makes_it_as_long_again(log, left: float) -> None:
    for _ in range(10):
        log.write_and_note()
    size = log.ahead.stat().st_size
    os.truncate(log.ahead, int(left * size))
    log.write()
    assert log.ahead.stat().st_size >= size
    with pytest.raises(Tampered):
        log.file.note()
    with pytest.raises(Tampered):  # for good
        log.file.check()


@pytest.mark.parametrize("how", [Path.unlink, lambda path: os.truncate(path, 0)])
@pytest.mark.parametrize("ahead", [True, False])
def test_deleted_or_emptied(log, how: Callable[[Path], None], ahead: bool) -> None:
    log.write_and_note()
    how(log.ahead if ahead else log.ahead.with_name("runs.sqlite"))
    with pytest.raises(Tampered):
        log.file.check()
