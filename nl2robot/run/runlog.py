"""The log of every run, in SQLite: heard, understood, program, who approved it, each call.

Each fact is committed as it happens (write-ahead log), so a crash or a kill loses nothing that was
done. A run that was never finished, and whose process is gone, reads as "interrupted". When a line
cannot be written (a full disk, a log that somebody deleted), `LogError` is raised: the caller stops
the robot, because what is not logged is not done.
"""

from __future__ import annotations

import json
import sqlite3
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any

import msgspec

from nl2robot.errors import UserError
from nl2robot.private_database import IN_MEMORY, private_database
from nl2robot.run.log_file import LogFile, Tampered
from nl2robot.run.process import lives, own_process
from robot_api.errors import cause

_SCHEMA = """
CREATE TABLE IF NOT EXISTS runs (
    id INTEGER PRIMARY KEY,
    started REAL NOT NULL,           -- seconds since the epoch
    finished REAL,
    heard TEXT,                      -- what the recogniser heard, if it was spoken
    utterance TEXT,
    language TEXT,
    plan TEXT,                       -- JSON
    program TEXT NOT NULL,
    sha256 TEXT NOT NULL,            -- of exactly this program, which is what was approved
    approved_by TEXT NOT NULL,
    approved_at REAL NOT NULL,
    world TEXT,                      -- a built-in world's name, or the path of its file
    seed INTEGER,
    robot TEXT,
    status TEXT,                     -- done | failed | stopped | limit; NULL while it runs
    message TEXT,
    picture TEXT,                    -- path of the picture of the run
    start TEXT,                      -- JSON: x, y (metres), theta (degrees), clock (ISO 8601;
                                     -- not of old runs) of a simulated robot
    process INTEGER,                 -- that runs it, see nl2robot/run/process.py
    continues INTEGER,               -- the run with which this one goes on
    proposed TEXT,                   -- the program that was proposed, if somebody changed it
    changed_by TEXT,                 -- who did
    stood TEXT                       -- JSON: the pose where it stood when it was not "done"
);
CREATE TABLE IF NOT EXISTS calls (
    run INTEGER NOT NULL REFERENCES runs(id),
    number INTEGER NOT NULL,         -- from 1
    line INTEGER NOT NULL,
    method TEXT NOT NULL,
    arguments TEXT NOT NULL,         -- JSON
    started REAL NOT NULL,
    seconds REAL,                    -- NULL: never came back
    result TEXT,                     -- JSON
    error TEXT,                      -- the error's name and sentence
    made TEXT,                       -- JSON: metres and degrees of a movement that was broken off
    place TEXT,                      -- where the robot was when it came back, by the place's name
    PRIMARY KEY (run, number)
);
CREATE TABLE IF NOT EXISTS output (
    run INTEGER NOT NULL REFERENCES runs(id),
    time REAL NOT NULL,
    text TEXT NOT NULL
);
CREATE TABLE IF NOT EXISTS states (
    run INTEGER NOT NULL REFERENCES runs(id),
    time REAL NOT NULL,
    state TEXT NOT NULL,             -- see nl2robot/run/state.py
    because TEXT
);
CREATE TABLE IF NOT EXISTS by_hand (
    time REAL NOT NULL,
    who TEXT NOT NULL,
    method TEXT NOT NULL,
    arguments TEXT NOT NULL          -- JSON
);
CREATE TABLE IF NOT EXISTS movements (
    run INTEGER PRIMARY KEY REFERENCES runs(id),
    record BLOB NOT NULL             -- see nl2robot/run/kept_record.py
);
CREATE TABLE IF NOT EXISTS numbers (
    of TEXT PRIMARY KEY,             -- "proposal": what is numbered, though it is kept elsewhere
    last INTEGER NOT NULL            -- the last number that was given
);
"""

_VERSION = 11
_ADDED = {
    "runs": {
        "start": "TEXT",
        "process": "INTEGER",
        "continues": "INTEGER",
        "proposed": "TEXT",
        "changed_by": "TEXT",
        "stood": "TEXT",
    },
    "calls": {"made": "TEXT", "place": "TEXT"},
}
"""Columns that a log of an older version has not got, by their tables."""


class LogError(UserError):
    """The run log cannot be read or written."""


_LARGEST = 2**63 - 1
"""Of the numbers that SQLite knows."""


class Run(msgspec.Struct, frozen=True, kw_only=True):
    """A row of `runs`; see the schema above for what the fields mean."""

    id: int
    started: float
    finished: float | None
    heard: str | None
    utterance: str | None
    language: str | None
    plan: str | None
    program: str
    sha256: str
    approved_by: str
    approved_at: float
    world: str | None
    seed: int | None
    robot: str | None
    status: str | None
    message: str | None
    picture: str | None
    start: str | None
    process: int | None
    continues: int | None = None
    proposed: str | None = None
    changed_by: str | None = None
    stood: str | None = None

    @property
    def going_on(self) -> bool:
        """Whether it is not over and the process that runs it still lives."""
        return self.status is None and self.process is not None and lives(self.process)


_COLUMNS = ", ".join(Run.__struct_fields__)


class LoggedCall(msgspec.Struct, frozen=True, kw_only=True):
    """A robot call of a run. `arguments`, `result` and `made` are JSON."""

    number: int
    line: int
    method: str
    arguments: str
    started: float
    seconds: float | None
    result: str | None
    error: str | None
    made: str | None = None
    place: str | None = None


class DoneByHand(msgspec.Struct, frozen=True, kw_only=True):
    """Something that somebody had the robot do without a program. `arguments` are JSON."""

    time: float
    who: str
    method: str
    arguments: str


_TELLING = (
    *("heard", "utterance", "plan", "message", "picture", "start", "proposed", "changed_by"),
    "stood",
)
"""The columns of a run that may be empty and tell of people."""


class RunLog:
    """The log in one file; safe to use from several threads and processes."""

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self._lock = threading.Lock()
        with self._trouble():
            self._db = private_database(path)
            self._db.execute("PRAGMA secure_delete=ON")  # what is deleted can be read nowhere
            self._bring_up_to_date()
            self._file = LogFile(self.path) if str(path) != IN_MEMORY else None
            if self._file is not None:
                self._file.note()

    def close(self) -> None:
        with self._lock:
            self._db.close()

    # --- writing

    def begin(
        self,
        *,
        program: str,
        sha256: str,
        approved_by: str,
        approved_at: float,
        utterance: str | None = None,
        heard: str | None = None,
        language: str | None = None,
        plan: str | None = None,
        world: str | None = None,
        seed: int | None = None,
        robot: str | None = None,
        continues: int | None = None,
        proposed: str | None = None,
        changed_by: str | None = None,
    ) -> int:
        """Note that an approved program starts; returns the run's number."""
        values = {
            "started": time.time(),
            "process": own_process(),
            "program": program,
            "sha256": sha256,
            "approved_by": approved_by,
            "approved_at": approved_at,
            "utterance": utterance,
            "heard": heard,
            "language": language,
            "plan": plan,
            "world": world,
            "seed": seed,
            "robot": robot,
            "continues": continues,
            "proposed": proposed,
            "changed_by": changed_by,
        }
        cursor = self._write(
            f"INSERT INTO runs ({', '.join(values)}) VALUES ({', '.join('?' * len(values))})",
            *values.values(),
        )
        return int(cursor.lastrowid or 0)

    def call_begins(self, run: int, number: int, line: int, method: str, arguments: str) -> None:
        self._write(
            "INSERT INTO calls (run, number, line, method, arguments, started)"
            " VALUES (?, ?, ?, ?, ?, ?)",
            *(run, number, line, method, arguments, time.time()),
        )

    def call_ends(
        self,
        run: int,
        number: int,
        seconds: float,
        *,
        result: str | None = None,
        error: str | None = None,
        made: str | None = None,
        place: str | None = None,
    ) -> None:
        self._write(
            "UPDATE calls SET seconds = ?, result = ?, error = ?, made = ?, place = ?"
            " WHERE run = ? AND number = ?",
            *(seconds, result, error, made, place, run, number),
        )

    def made(self, run: int, number: int, made: str) -> None:
        """Note how much of a movement that was broken off is made, now that the robot stands."""
        self._write("UPDATE calls SET made = ? WHERE run = ? AND number = ?", made, run, number)

    def state(self, run: int, since: float, state: str, because: str | None) -> None:
        """Note how the robot and the program stood from then on."""
        self._write("INSERT INTO states VALUES (?, ?, ?, ?)", run, since, state, because)

    def printed(self, run: int, text: str) -> None:
        self._write("INSERT INTO output VALUES (?, ?, ?)", run, time.time(), text)

    def end(self, run: int, status: str, message: str | None) -> None:
        self._write(
            "UPDATE runs SET finished = ?, status = ?, message = ? WHERE id = ?",
            *(time.time(), status, message, run),
        )

    def starts_at(self, run: int, x: float, y: float, theta: float, clock: datetime) -> None:
        """Note where a simulated robot stands when the run begins, and what its clock shows."""
        where = {"x": x, "y": y, "theta": theta, "clock": clock}
        start = msgspec.json.encode(where).decode()
        self._write("UPDATE runs SET start = ? WHERE id = ?", start, run)

    def stands_at(self, run: int, pose: str) -> None:
        """Note where the robot came to stand, JSON, when a run was broken off."""
        self._write("UPDATE runs SET stood = ? WHERE id = ?", pose, run)

    def by_hand(self, who: str, method: str, arguments: str) -> None:
        """Note that somebody has the robot do this without a program; `arguments` are JSON."""
        self._write("INSERT INTO by_hand VALUES (?, ?, ?, ?)", time.time(), who, method, arguments)

    def picture(self, run: int, path: str) -> None:
        self._write("UPDATE runs SET picture = ? WHERE id = ?", path, run)

    def keep_movement(self, run: int, record: bytes, kept: int) -> None:
        """Keep where the robot was in a run; of all those only the newest `kept`."""
        self._write("INSERT OR REPLACE INTO movements VALUES (?, ?)", run, record)
        self._write(
            "DELETE FROM movements WHERE run <="
            " (SELECT run FROM movements ORDER BY run DESC LIMIT 1 OFFSET ?)",
            kept,
        )

    def next_proposal(self) -> int:
        """A number for a proposal, which no other had or will have, also after a restart."""
        sql = (
            "INSERT INTO numbers VALUES ('proposal', 1)"
            " ON CONFLICT (of) DO UPDATE SET last = last + 1 RETURNING last"
        )
        with self._lock, self._trouble():
            if self._file is not None:
                self._file.check()
            [row] = self._db.execute(sql).fetchall()  # all of it: only then it is written
            if self._file is not None:
                self._file.note()
        return int(row[0])

    # --- deleting

    def older_than(self, seconds: float) -> list[int]:
        """The runs that began so long ago, but for one that is going on."""
        rows = self._read(
            "SELECT id, status, process FROM runs WHERE started < ?", time.time() - seconds
        )
        return [
            row["id"]
            for row in rows
            if row["status"] is not None or row["process"] is None or not lives(row["process"])
        ]

    def delete_by_hand(self, seconds: float) -> None:
        """Delete what was done by hand so long ago."""
        self._write("DELETE FROM by_hand WHERE time < ?", time.time() - seconds)

    def delete(self, runs: Sequence[int]) -> None:
        """Delete what was said, done and seen in these runs, and their pictures. Of the newest run
        its number is left, which no later one is to have."""
        newest = self._read("SELECT max(id) AS id FROM runs")[0]["id"]
        for run in runs:
            for row in self._read("SELECT picture FROM runs WHERE id = ?", run):
                if row["picture"]:
                    with self._trouble():
                        Path(row["picture"]).unlink(missing_ok=True)
            for table in ("calls", "output", "states", "movements"):
                self._write(f"DELETE FROM {table} WHERE run = ?", run)
            if run == newest:
                nothing = ", ".join(f"{name} = NULL" for name in _TELLING)
                self._write(
                    f"UPDATE runs SET program = '', approved_by = '', {nothing} WHERE id = ?", run
                )
            else:
                self._write("DELETE FROM runs WHERE id = ?", run)

    # --- reading

    def runs(self, last: int = 20) -> list[Run]:
        """The newest runs, newest first."""
        rows = self._read(f"SELECT {_COLUMNS} FROM runs ORDER BY id DESC LIMIT ?", last)
        return [Run(**row) for row in rows]

    def runs_with(self, name: str, since: float, last: int) -> list[Run]:
        """The newest runs since a moment whose program has this name in it, newest first."""
        rows = self._read(
            f"SELECT {_COLUMNS} FROM runs WHERE started >= ? AND instr(program, ?) > 0"
            " ORDER BY id DESC LIMIT ?",
            *(since, name, last),
        )
        return [Run(**row) for row in rows]

    def done_by_hand(self, last: int = 20) -> list[DoneByHand]:
        """What was done last without a program, the newest first."""
        rows = self._read("SELECT * FROM by_hand ORDER BY rowid DESC LIMIT ?", last)
        return [DoneByHand(**row) for row in rows]

    def run(self, number: int) -> Run | None:
        if number > _LARGEST:
            return None
        rows = self._read(f"SELECT {_COLUMNS} FROM runs WHERE id = ?", number)
        return Run(**rows[0]) if rows else None

    def continued_by(self, run: int) -> int | None:
        """The number of the last run that went on with that one."""
        rows = self._read("SELECT MAX(id) AS id FROM runs WHERE continues = ?", run)
        return rows[0]["id"] if rows else None

    def calls(self, run: int) -> list[LoggedCall]:
        rows = self._read(
            "SELECT number, line, method, arguments, started, seconds, result, error, made, place"
            " FROM calls WHERE run = ? ORDER BY number",
            run,
        )
        return [LoggedCall(**row) for row in rows]

    def states(self, run: int) -> list[dict[str, Any]]:
        """The states that a run went through while it lasted: time, state, because."""
        return self._read(
            "SELECT time, state, because FROM states WHERE run = ? ORDER BY rowid", run
        )

    def output(self, run: int) -> list[str]:
        rows = self._read("SELECT text FROM output WHERE run = ? ORDER BY time, rowid", run)
        return [row["text"] for row in rows]

    def movement(self, run: int) -> bytes | None:
        rows = self._read("SELECT record FROM movements WHERE run = ?", run)
        return rows[0]["record"] if rows else None

    def whole(self, run: Run) -> dict[str, Any]:
        """Everything about a run, as JSON data."""
        data: dict[str, Any] = msgspec.to_builtins(run)
        data["plan"] = json.loads(run.plan) if run.plan else None
        data["calls"] = msgspec.to_builtins(self.calls(run.id))
        data["output"] = self.output(run.id)
        data["states"] = self.states(run.id)
        return data

    # --- the file

    def _bring_up_to_date(self) -> None:
        """Make what is missing; a log of this version is not written to."""
        [version] = self._db.execute("PRAGMA user_version").fetchone()
        if version >= _VERSION:
            return
        self._db.executescript(f"BEGIN IMMEDIATE; {_SCHEMA}")
        for table, columns in _ADDED.items():
            there = {row[1] for row in self._db.execute(f"PRAGMA table_info({table})")}
            for name, kind in columns.items():
                if name not in there:
                    self._db.execute(f"ALTER TABLE {table} ADD COLUMN {name} {kind}")
        self._db.execute(f"PRAGMA user_version = {_VERSION}")
        self._db.execute("COMMIT")

    def _write(self, sql: str, *values: Any) -> sqlite3.Cursor:
        with self._lock, self._trouble():
            if self._file is not None:
                self._file.check()
            cursor = self._db.execute(sql, values)
            if self._file is not None:
                self._file.note()
            return cursor

    def _read(self, sql: str, *values: Any) -> list[dict[str, Any]]:
        with self._lock, self._trouble():
            cursor = self._db.execute(sql, values)
            names = [column[0] for column in cursor.description]
            return [dict(zip(names, row, strict=True)) for row in cursor]

    @contextmanager
    def _trouble(self) -> Iterator[None]:
        try:
            yield
        except Tampered as error:
            raise LogError(str(error)) from None
        except (sqlite3.Error, OSError) as error:
            raise LogError(
                f"The run log {self.path} cannot be used ({cause(error)})."
                " Free some disk space or check the folder's rights, then try again."
            ) from error
