"""Of thousands of runs, the one that is looked for is found at once, page by page."""

import sqlite3
import time
from datetime import date, datetime

import pytest

from nl2robot.run.archive import Archive, Wanted
from nl2robot.run.process import lives
from nl2robot.run.runlog import LogError, RunLog

NOBODY = 2**22 + 7
"""The number of a process that there is not."""


@pytest.fixture
def log(tmp_path):
    log = RunLog(tmp_path / "a log, of 100%?" / "runs.sqlite")
    yield log
    log.close()


@pytest.fixture
def archive(log):
    return Archive(log.path)


def ran(
    log, utterance, *, status="done", by="Nurse Kim", at=None, program="robot.stop()\n", **more
):
    """A run as it stands in the log; its number."""
    run = log.begin(
        program=program,
        sha256="0" * 64,
        approved_by=by,
        approved_at=1.0,
        utterance=utterance,
        **more,
    )
    if status is not None:
        log.end(run, status, None if status == "done" else "The door is closed.")
    if at is not None:
        with sqlite3.connect(log.path) as db:
            db.execute("UPDATE runs SET started = ? WHERE id = ?", (at, run))
    return run


def found(archive, words="", **wanted) -> list[int]:
    return [run.id for run in archive.page(Wanted(words=words, **wanted)).runs]


def test_words_are_found_wherever_they_are(log, archive) -> None:
    tea = ran(log, "ask Alice if she wants tea", by="Dr. Müller")
    door = ran(log, None, status="failed", program='robot.goto("pharmacy")\n', heard="go")
    assert found(archive) == [door, tea]
    assert found(archive, "TEA") == [tea]
    assert found(archive, "tea müller") == [tea], "all the words, in any field"
    assert found(archive, "MÜLLER") == [tea], "capitals that SQLite does not know"
    assert found(archive, "mxller") == []
    assert found(archive, "pharmacy") == [door]
    assert found(archive, "closed") == [door], "why it ended"
    assert archive.page(Wanted(words="pharmacy")).runs[0].title == "go"


def test_signs_are_looked_for_as_they_stand(log, archive) -> None:
    share = ran(log, "turn up to 50%")
    ran(log, "turn up to 50 or x_y")
    assert found(archive, "50%") == [share]
    assert found(archive, "%' OR '1'='1") == []
    assert found(archive, "\\") == []
    assert found(archive, "'; DROP TABLE runs; --") == []
    assert found(archive, "ü" * 5000) == []


def test_a_state_is_told_as_a_person_would(log, archive) -> None:
    done, failed = ran(log, "say hello"), ran(log, "go", status="failed")
    running = ran(log, "wait", status=None)
    broken = ran(log, "dance", status=None)
    with sqlite3.connect(log.path) as db:
        db.execute("UPDATE runs SET process = ? WHERE id = ?", (NOBODY, broken))
    older = ran(log, "sit", status=None)  # logged when processes were not
    with sqlite3.connect(log.path) as db:
        db.execute("UPDATE runs SET process = NULL WHERE id = ?", (older,))
    states = [run.state for run in archive.page(Wanted()).runs]
    assert states == ["interrupted", "interrupted", "running", "failed", "done"]
    assert found(archive, state="running") == [running]
    assert found(archive, state="interrupted") == [older, broken]
    assert found(archive, state="failed") == [failed]
    assert found(archive, state="done") == [done]


def test_days_begin_at_midnight_here(log, archive) -> None:
    late = ran(log, "late", at=datetime(2026, 3, 1, 23, 59, 59).timestamp())
    early = ran(log, "early", at=datetime(2026, 3, 2, 0, 0, 0).timestamp())
    assert found(archive, until=date(2026, 3, 1)) == [late]
    assert found(archive, since=date(2026, 3, 2)) == [early]
    assert found(archive, since=date(2026, 3, 1), until=date(2026, 3, 2)) == [early, late]
    assert found(archive, until=date.max) == [early, late]
    assert found(archive, since=date.max) == found(archive, until=date.min) == []


def test_pages_follow_each_other(log, archive, monkeypatch) -> None:
    runs = [ran(log, f"say {number}") for number in range(7)]
    first = archive.page(Wanted(words="say"), size=3)
    assert ([run.id for run in first.runs], first.more, first.found) == (runs[:3:-1], True, 7)
    ran(log, "say something new")  # moves nothing on the pages behind
    second = archive.page(Wanted(words="say"), before=first.runs[-1].id, size=4)
    assert ([run.id for run in second.runs], second.more) == (runs[3::-1], False)
    assert [run.id for run in archive.all(Wanted(), 5)] == [8, 7, 6, 5, 4]
    monkeypatch.setattr("nl2robot.run.archive.READ_AT_ONCE", 3)
    assert [run.id for run in archive.all(Wanted(), 500)] == [8, 7, 6, 5, 4, 3, 2, 1]
    assert archive.neighbours(1) == (None, 2)
    assert archive.neighbours(8) == (7, None)


def test_calls_are_counted(log, archive) -> None:
    run = ran(log, "say hello")
    log.call_begins(run, 1, 1, "say", "{}")
    log.call_begins(run, 2, 1, "say", "{}")
    assert [run.calls for run in archive.page(Wanted()).runs] == [2]


def test_a_program_is_logged_while_somebody_searches(log, archive) -> None:
    run = ran(log, "say hello", status=None)
    with archive._reading() as db:
        db.execute("BEGIN")
        assert db.execute("SELECT count(*) FROM runs").fetchone() == (1,)
        began = time.monotonic()
        log.end(run, "done", None)
        assert time.monotonic() - began < 1
    assert lives(log.run(run).process)


def test_a_log_that_cannot_be_read_is_told_in_a_sentence(log, archive) -> None:
    ran(log, "say hello")
    log.close()
    log.path.write_bytes(b"no log at all " * 1000)
    for aside in ("-wal", "-shm"):
        log.path.with_name(log.path.name + aside).unlink(missing_ok=True)
    with pytest.raises(LogError, match="is damaged or cannot be read"):
        archive.page(Wanted())
    log.path.unlink()
    with pytest.raises(LogError, match=r"is gone.*start nl2robot again"):
        archive.page(Wanted())


def test_a_locked_log_is_told_in_a_sentence(log, monkeypatch) -> None:
    monkeypatch.setattr("nl2robot.run.archive.WAITS", 10)
    ran(log, "say hello")
    other = sqlite3.connect(log.path, isolation_level=None)
    log.close()
    other.execute("PRAGMA journal_mode=DELETE")
    other.execute("BEGIN EXCLUSIVE")
    with pytest.raises(LogError, match="locked by another program"):
        Archive(log.path).page(Wanted())
    other.close()
