"""The log tells afterwards what was heard, approved and done, whatever happened in between."""

import json
import os
import signal
import sqlite3
import subprocess
import sys
import textwrap
import time

import pytest

from nl2robot.run.process import lives, own_process
from nl2robot.run.retention import kept_for
from nl2robot.run.runlog import LogError, RunLog
from nl2robot.station.by_hand import ByHand

ROUND = {
    "program": 'robot.say("Good night.")\n',
    "sha256": "0" * 64,
    "approved_by": "Nurse Kim",
    "approved_at": 1000.0,
    "utterance": "say good night",
}


@pytest.fixture
def log(tmp_path):
    log = RunLog(tmp_path / "runs.sqlite")
    yield log
    log.close()


def test_a_night_round_is_found_again(log) -> None:
    run = log.begin(**ROUND, heard="say good night", world="ward", seed=3)
    log.call_begins(run, 1, 1, "say", '{"text":"Good night."}')
    log.call_ends(run, 1, 0.5, result="null")
    log.call_begins(run, 2, 2, "goto", '{"place":"attic"}')
    log.call_ends(run, 2, 0.1, error="UnknownPlace: There is no attic.")
    log.printed(run, "done\n")
    log.end(run, "failed", "There is no attic.")

    [row] = log.runs()
    assert (row.utterance, row.approved_by, row.status) == ("say good night", "Nurse Kim", "failed")
    assert (row.heard, row.world, row.seed) == ("say good night", "ward", 3)
    said, went = log.calls(run)
    assert (said.method, said.result, said.error) == ("say", "null", None)
    assert went.error == "UnknownPlace: There is no attic."
    assert log.output(run) == ["done\n"]


def test_the_newest_run_comes_first(log) -> None:
    first, second = log.begin(**ROUND), log.begin(**ROUND)
    assert [row.id for row in log.runs()] == [second, first]
    assert log.run(first).status is None, "a run that was never ended has no status"
    assert log.run(99) is None


def test_a_killed_program_loses_nothing_that_was_done(tmp_path) -> None:
    path = tmp_path / "runs.sqlite"
    script = textwrap.dedent(f"""
        import time
        from nl2robot.run.runlog import RunLog
        log = RunLog({str(path)!r})
        run = log.begin(**{ROUND!r})
        log.call_begins(run, 1, 1, "say", "{{}}")
        print("begun", flush=True)
        time.sleep(60)
    """)
    process = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE)
    assert process.stdout.readline() == b"begun\n"
    os.kill(process.pid, signal.SIGKILL)
    process.wait()

    log = RunLog(path)
    [row] = log.runs()
    [call] = log.calls(row.id)
    assert row.status is None
    assert (call.method, call.seconds) == ("say", None), "it never came back"


def test_a_full_disk_is_said_and_the_log_stays_readable(tmp_path) -> None:
    log = RunLog(tmp_path / "runs.sqlite")
    log.begin(**ROUND)
    pages = log._db.execute("PRAGMA page_count").fetchone()[0]
    log._db.execute(f"PRAGMA max_page_count = {pages}")  # SQLite's own "disk full"
    with pytest.raises(LogError, match=r"full.*Free some disk space"):
        for _ in range(1000):
            log.begin(**{**ROUND, "program": "x" * 10_000})
    assert RunLog(tmp_path / "runs.sqlite").run(1).utterance == "say good night"


def test_a_file_that_is_no_log_is_refused_with_a_sentence(tmp_path) -> None:
    path = tmp_path / "runs.sqlite"
    path.write_bytes(b"this is no database" * 100)
    with pytest.raises(LogError, match=r"cannot be used"):
        RunLog(path)


def test_two_processes_write_side_by_side(tmp_path) -> None:
    one, other = RunLog(tmp_path / "runs.sqlite"), RunLog(tmp_path / "runs.sqlite")
    numbers = [log.begin(**ROUND) for log in (one, other, one, other)]
    assert len(set(numbers)) == 4
    assert (
        len(sqlite3.connect(tmp_path / "runs.sqlite").execute("SELECT 1 FROM runs").fetchall()) == 4
    )
    assert one.runs()[0].started <= time.time()


def test_what_was_proposed_is_kept_beside_what_was_approved(log) -> None:
    run = log.begin(**ROUND, proposed='robot.say("Hello.")\n', changed_by="Student Noor")
    [row] = log.runs()
    assert (row.proposed, row.changed_by) == ('robot.say("Hello.")\n', "Student Noor")
    assert log.whole(row)["changed_by"] == "Student Noor"
    plain = log.begin(**ROUND)
    assert (log.run(plain).proposed, log.run(plain).changed_by) == (None, None)
    assert run != plain


def test_a_log_from_before_changes_were_kept_is_read_and_goes_on(tmp_path) -> None:
    old = RunLog(tmp_path / "runs.sqlite")
    old.begin(**ROUND)
    old.close()
    database = sqlite3.connect(tmp_path / "runs.sqlite")
    for column in ("proposed", "changed_by"):
        database.execute(f"ALTER TABLE runs DROP COLUMN {column}")
    database.execute("PRAGMA user_version = 4")
    database.commit()
    database.close()
    log = RunLog(tmp_path / "runs.sqlite")
    assert log.run(1).proposed is None
    log.begin(**ROUND, proposed="x", changed_by="Kim")
    assert log.run(2).changed_by == "Kim"
    log.close()


def test_a_log_from_before_movements_were_measured_is_read_and_goes_on(tmp_path) -> None:
    old = RunLog(tmp_path / "runs.sqlite")
    run = old.begin(**ROUND)
    old.call_begins(run, 1, 1, "move", '{"metres":3}')
    old.close()
    database = sqlite3.connect(tmp_path / "runs.sqlite")
    database.execute("ALTER TABLE runs DROP COLUMN stood")
    database.execute("ALTER TABLE calls DROP COLUMN made")
    database.execute("ALTER TABLE calls DROP COLUMN place")
    database.execute("PRAGMA user_version = 7")
    database.commit()
    database.close()
    log = RunLog(tmp_path / "runs.sqlite")
    assert (log.run(run).stood, log.calls(run)[0].made) == (None, None)
    log.call_ends(
        run, 1, 2.0, error="Stopped: So.", made='{"metres":1.0,"degrees":0.0}', place="hall"
    )
    log.stands_at(run, '{"x":1.0,"y":0.0,"theta":0.0}')
    assert log.whole(log.run(run))["calls"][0]["made"] == '{"metres":1.0,"degrees":0.0}'
    assert log.run(run).stood is not None and log.calls(run)[0].place == "hall"
    log.close()


def test_a_run_of_a_process_whose_number_somebody_else_has_now_is_interrupted(tmp_path) -> None:
    """A container begins again: its new server has the number of the dead one."""
    own = own_process()
    assert lives(own) and lives(os.getpid())  # as an older log says it
    born = own >> 22
    if born:  # the system tells
        assert not lives((born + 1) << 22 | os.getpid())


def test_nobody_else_reads_what_patients_said(tmp_path) -> None:
    path = tmp_path / "kept" / "runs.sqlite"
    log = RunLog(path)
    log.begin(program="", sha256="", approved_by="Kim", approved_at=0.0)
    assert {each.stat().st_mode & 0o077 for each in path.parent.iterdir()} == {0}
    log.close()


def ran(log, text: str, started: float = 0.0) -> int:
    run = log.begin(
        program=f'robot.say("{text}")', sha256="", approved_by="Kim", approved_at=0.0, heard=text
    )
    log.call_begins(run, 1, 1, "say", json.dumps({"text": text}))
    log.call_ends(run, 1, 0.1, result="null")
    log.printed(run, text)
    log.end(run, "done", text)
    log._write("UPDATE runs SET started = ? WHERE id = ?", started, run)
    return run


def words_in(folder) -> bytes:
    return b"".join(each.read_bytes() for each in folder.iterdir() if each.is_file())


def test_what_is_deleted_can_be_read_nowhere(tmp_path, log) -> None:
    kept, secret = ran(log, "lunch is ready"), ran(log, "the test was positive")
    newest = ran(log, "her name is Grace")
    picture = tmp_path / "run.svg"
    picture.write_text("<svg/>", encoding="utf-8")
    log.picture(secret, str(picture))
    log.delete([secret, newest])
    assert not picture.exists()
    assert [each.id for each in log.runs()] == [newest, kept]
    assert log.calls(newest) == [] and log.run(newest).heard is None
    assert ran(log, "next") == newest + 1  # no number is given twice
    folder = log.path.parent
    log.close()
    read = words_in(folder)
    assert b"lunch is ready" in read
    assert b"positive" not in read and b"Grace" not in read


def test_runs_are_kept_as_long_as_the_hospital_says(log) -> None:
    now = time.time()
    old, going_on, new = (
        ran(log, "old", now - 100),
        ran(log, "runs", now - 100),
        ran(log, "new", now),
    )
    log._write("UPDATE runs SET status = NULL WHERE id = ?", going_on)
    with kept_for(log, 50):
        ends = time.monotonic() + 20
        while log.run(old) is not None and time.monotonic() < ends:
            time.sleep(0.01)
    assert [each.id for each in log.runs()] == [new, going_on]


def test_one_drive_with_the_joystick_is_one_line(log) -> None:
    clock = [0.0]
    hand = ByHand(log, lambda: clock[0])
    for _ in range(30):  # three seconds of it
        hand.note("Ruth", "drive", {"linear": 0.3, "angular": 0.0})
        clock[0] += 0.1
    hand.note("Karim", "drive", {"linear": 0.3, "angular": 0.0})
    clock[0] += 10
    hand.note("Ruth", "drive", {"linear": -0.3, "angular": 0.0})
    assert [each.who for each in log.done_by_hand()] == ["Ruth", "Karim", "Ruth"]
    log.delete_by_hand(0)
    assert log.done_by_hand() == []
