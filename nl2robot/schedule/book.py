"""The book of appointments, in SQLite: what is due when, what came of it, what has to be told.

Whatever is decided is committed before it is done, so that a crash or a kill at any moment neither
loses a time nor has anything run twice: a time is in the book once for each appointment, and only
whoever turns it from "due" to "claimed" may begin it. What a process had claimed that is gone is
among `begun`. Several processes may use the file.
"""

from __future__ import annotations

import sqlite3
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import msgspec

from nl2robot.errors import UserError
from nl2robot.private_database import private_database
from nl2robot.run.process import lives, own_process
from nl2robot.schedule.appointments import Appointment, Notice, NoticeKind, Occurrence, State, Why
from nl2robot.schedule.outcomes import Outcome
from nl2robot.schedule.rhythm import Rhythm
from nl2robot.schedule.tables import (
    SCHEMA,
    VERSION,
    appointment_of,
    as_json,
    missing_columns,
    occurrence_of,
)
from nl2robot.schedule.triggers import Trigger
from robot_api.errors import cause

_LARGEST: Final = 2**63 - 1


class BookError(UserError):
    """The book cannot be read or written."""


class NoAppointment(UserError):
    def __init__(self, number: int) -> None:
        super().__init__(
            f"There is no appointment {number}. `nl2robot schedule` lists those there are."
        )


class Book:
    """The book in one file; made with its folder, if missing. Any thread may use it. Raises
    `BookError` wherever the file cannot be used."""

    def __init__(self, path: Path | str, clock: Callable[[], float] = time.time) -> None:
        self.path = Path(path)
        self._clock = clock
        self._lock = threading.RLock()
        with self._trouble():
            self._db = private_database(path)
            self._db.execute("PRAGMA secure_delete=ON")  # what is deleted can be read nowhere
            [version] = self._db.execute("PRAGMA user_version").fetchone()
            if version < VERSION:
                self._db.executescript(
                    f"BEGIN IMMEDIATE; {SCHEMA} {missing_columns(self._db)}"
                    f" PRAGMA user_version = {VERSION}; COMMIT;"
                )

    def close(self) -> None:
        with self._lock:
            self._db.close()

    @contextmanager
    def at_once(self) -> Iterator[None]:
        """What is written meanwhile is in the book whole or not at all; nobody else writes."""
        with self._lock, self._trouble():
            if self._db.in_transaction:
                yield
                return
            self._db.execute("BEGIN IMMEDIATE")
            try:
                yield
                self._db.execute("COMMIT")
            except BaseException:
                if self._db.in_transaction:
                    self._db.execute("ROLLBACK")
                raise

    # --- who keeps time

    def kept_by(self, robot: str) -> int:
        """The process that looks after the robot's appointments: this one, unless another does
        that lives (`nl2robot.run.process`)."""
        mine = own_process()
        with self.at_once():
            kept = self._read("SELECT process FROM keepers WHERE robot = ?", robot)
            if kept and kept[0]["process"] != mine and lives(kept[0]["process"]):
                return int(kept[0]["process"])
            if not kept or kept[0]["process"] != mine:
                self._write("INSERT OR REPLACE INTO keepers VALUES (?, ?)", robot, mine)
        return mine

    def leave(self, robot: str) -> None:
        """This process looks after the robot's appointments no more."""
        self._write("DELETE FROM keepers WHERE robot = ? AND process = ?", robot, own_process())

    # --- appointments

    def add(
        self,
        *,
        program: str,
        sha256: str,
        sentence: str,
        language: str,
        robot: str,
        approved_by: str,
        approved_until: float,
        reviewed: str,
        priority: int,
        makes_up: int,
        rhythm: Rhythm | None = None,
        trigger: Trigger | None = None,
        plan: str | None = None,
        insists: bool = False,
        fleet: str | None = None,
    ) -> Appointment:
        """Note an approved program with its times; they count from now on."""
        now = self._clock()
        values = {
            "program": program,
            "sha256": sha256,
            "sentence": sentence,
            "plan": plan,
            "language": language,
            "rhythm": as_json(rhythm),
            "trigger": as_json(trigger),
            "robot": robot,
            "fleet": fleet,
            "approved_by": approved_by,
            "approved_at": now,
            "approved_until": approved_until,
            "reviewed": reviewed,
            "insists": int(insists),
            "priority": priority,
            "makes_up": makes_up,
            "added": now,
            "looked": now,
        }
        cursor = self._write(
            f"INSERT INTO appointments ({', '.join(values)})"
            f" VALUES ({', '.join('?' * len(values))})",
            *values.values(),
        )
        return self.appointment(int(cursor.lastrowid or 0))

    def appointments(self, robot: str | None = None, removed: bool = False) -> list[Appointment]:
        """Those of a robot, or all, by their numbers; `removed`: those too that are no more."""
        found = map(
            appointment_of,
            self._read(
                "SELECT * FROM appointments WHERE (? IS NULL OR robot = ?)"
                " AND (? OR removed IS NULL) ORDER BY id",
                *(robot, robot, int(removed)),
            ),
        )
        return list(found)

    def appointment(self, number: int) -> Appointment:
        """Raises `NoAppointment`, also for one that was removed."""
        rows = self._read(
            "SELECT * FROM appointments WHERE id = ? AND removed IS NULL", min(number, _LARGEST)
        )
        if not rows:
            raise NoAppointment(number)
        return appointment_of(rows[0])

    def approve(
        self,
        number: int,
        by: str,
        until: float,
        reviewed: str,
        insists: bool,
        fleet: str | None = None,
    ) -> None:
        """Note that somebody approved it anew; one of the fleet is that robot's to keep now."""
        self._write(
            "UPDATE appointments SET approved_by = ?, approved_at = ?, approved_until = ?,"
            " reviewed = ?, insists = ?, fleet = ?, asked = NULL WHERE id = ?",
            *(by, self._clock(), until, reviewed, int(insists), fleet, number),
        )

    def ask(self, number: int, why: Why) -> None:
        """It waits for a new approval from now on."""
        self._write("UPDATE appointments SET asked = ? WHERE id = ?", why, number)

    def pause(self, number: int, paused: bool = True) -> None:
        self._write("UPDATE appointments SET paused = ? WHERE id = ?", int(paused), number)

    def remove(self, number: int) -> None:
        """It is not done any more; what was due and has not begun is skipped."""
        with self.at_once():
            now = self._clock()
            self._write("UPDATE appointments SET removed = ? WHERE id = ?", now, number)
            self._write(
                "UPDATE occurrences SET state = 'skipped', note = 'removed', ended = ?"
                " WHERE appointment = ? AND state = 'due'",
                *(now, number),
            )

    def finish(self, number: int) -> None:
        """Nothing more comes of it: it is removed, unless something of it is not over."""
        self._write(
            "UPDATE appointments SET removed = ? WHERE id = ? AND removed IS NULL AND NOT EXISTS"
            " (SELECT 1 FROM occurrences WHERE appointment = ?"
            " AND state IN ('due', 'claimed', 'running'))",
            *(self._clock(), number, number),
        )

    def look_until(self, number: int, moment: float) -> None:
        self._write("UPDATE appointments SET looked = ? WHERE id = ?", moment, number)

    # --- the times at which they are due

    def come(
        self, appointment: int, due: float, state: State = "due", note: str | None = None
    ) -> Occurrence | None:
        """Note that an appointment is due at that moment, or what became of that at once; None if
        it was in the book already."""
        ended = None if state == "due" else self._clock()
        cursor = self._write(
            "INSERT OR IGNORE INTO occurrences (appointment, due, state, note, ended)"
            " VALUES (?, ?, ?, ?, ?)",
            *(appointment, due, state, note, ended),
        )
        return self.occurrence(int(cursor.lastrowid or 0)) if cursor.rowcount else None

    def occurrence(self, number: int) -> Occurrence:
        return occurrence_of(self._read("SELECT * FROM occurrences WHERE id = ?", number)[0])

    def of_moment(self, appointment: int, due: float) -> Occurrence | None:
        """What is known of that time of an appointment."""
        rows = self._read(
            "SELECT * FROM occurrences WHERE appointment = ? AND due = ?", appointment, due
        )
        return occurrence_of(rows[0]) if rows else None

    def skipped_from(self, appointment: int, moment: float) -> list[Occurrence]:
        """The times from a moment on that somebody has called off beforehand."""
        rows = self._read(
            "SELECT * FROM occurrences WHERE appointment = ? AND due >= ? AND state = 'skipped'"
            " ORDER BY due",
            *(appointment, moment),
        )
        return [occurrence_of(row) for row in rows]

    def waiting(self, robot: str) -> list[tuple[Occurrence, Appointment]]:
        """What is due of a robot and not begun: by priority, then by time."""
        known = {each.id: each for each in self.appointments(robot)}
        rows = self._read("SELECT * FROM occurrences WHERE state = 'due'")
        found = [
            (occurrence_of(row), known[row["appointment"]])
            for row in rows
            if row["appointment"] in known
        ]
        return sorted(found, key=lambda pair: (-pair[1].priority, pair[0].due, pair[0].id))

    def wait_for(self, occurrence: int, why: str) -> None:
        """Note what it waits for."""
        self._write("UPDATE occurrences SET waited_for = ? WHERE id = ?", why, occurrence)

    def claim(self, occurrence: int) -> bool:
        """Take what is due, so that nobody else does; False if it is not due any more."""
        cursor = self._write(
            "UPDATE occurrences SET state = 'claimed', process = ?, began = ?"
            " WHERE id = ? AND state = 'due'",
            *(own_process(), self._clock(), occurrence),
        )
        return cursor.rowcount == 1

    def release(self, occurrence: int) -> None:
        """Put back what was claimed: its program was not begun."""
        self._write(
            "UPDATE occurrences SET state = 'due', process = NULL, began = NULL"
            " WHERE id = ? AND state = 'claimed'",
            occurrence,
        )

    def runs(self, occurrence: int, run: int | None) -> None:
        """Note that its program runs, and as which run of the log; None: of another robot's."""
        self._write(
            "UPDATE occurrences SET state = 'running', run = ? WHERE id = ? AND state = 'claimed'",
            *(run, occurrence),
        )

    def done_by(self, occurrence: int, robot: str | None) -> None:
        """Note which robot of the fleet was told to begin it."""
        self._write("UPDATE occurrences SET done_by = ? WHERE id = ?", robot, occurrence)

    def reminded(self, occurrence: int, found: Sequence[Outcome]) -> None:
        """Note what a robot of the fleet tells of a reminder."""
        told = as_json(msgspec.to_builtins(found))
        self._write("UPDATE occurrences SET reminded = ? WHERE id = ?", told, occurrence)

    def end(self, occurrence: int, state: State, note: str | None = None) -> bool:
        """Note what came of it; False if that is known already."""
        cursor = self._write(
            "UPDATE occurrences SET state = ?, note = ?, ended = ?"
            " WHERE id = ? AND state IN ('due', 'claimed', 'running')",
            *(state, note, self._clock(), occurrence),
        )
        return cursor.rowcount == 1

    def begun(self, robot: str) -> list[tuple[Occurrence, Appointment]]:
        """What of a robot was begun and has no end."""
        known = {each.id: each for each in self.appointments(robot, removed=True)}
        rows = self._read("SELECT * FROM occurrences WHERE state IN ('claimed', 'running')")
        return [
            (occurrence_of(row), known[row["appointment"]])
            for row in rows
            if row["appointment"] in known
        ]

    def runs_of(self, appointment: int) -> set[int]:
        """The numbers of its runs."""
        rows = self._read(
            "SELECT run FROM occurrences WHERE appointment = ? AND run IS NOT NULL", appointment
        )
        return {row["run"] for row in rows}

    def has_run(self, run: int) -> bool:
        """Whether a run of the log is one of an appointment."""
        return bool(self._read("SELECT 1 FROM occurrences WHERE run = ? LIMIT 1", run))

    def since(self, moment: float, last: int) -> list[Occurrence]:
        """The newest of the times from a moment on, the newest first."""
        rows = self._read(
            "SELECT * FROM occurrences WHERE due >= ? ORDER BY due DESC, id DESC LIMIT ?",
            *(moment, last),
        )
        return [occurrence_of(row) for row in rows]

    def call_back(self, appointment: int, due: float) -> bool:
        """Have a time to come done after all that was called off; False if it was not."""
        cursor = self._write(
            "DELETE FROM occurrences WHERE appointment = ? AND due = ? AND state = 'skipped'"
            " AND due > ?",
            *(appointment, due, self._clock()),
        )
        return cursor.rowcount == 1

    def history(self, appointment: int | None = None, last: int = 100) -> list[Occurrence]:
        """The latest times that came, the newest first; those to come that were called off are
        among them."""
        rows = self._read(
            "SELECT * FROM occurrences WHERE ? IS NULL OR appointment = ?"
            " ORDER BY due DESC, id DESC LIMIT ?",
            *(appointment, appointment, last),
        )
        return [occurrence_of(row) for row in rows]

    def between(self, begins: float, ends: float) -> list[Occurrence]:
        """The times from a moment on until before another that are in the book, in order."""
        rows = self._read(
            "SELECT * FROM occurrences WHERE due >= ? AND due < ? ORDER BY due, id", begins, ends
        )
        return [occurrence_of(row) for row in rows]

    # --- what is to be told

    def tell(
        self,
        kind: NoticeKind,
        appointment: int,
        occurrence: int | None = None,
        parts: Mapping[str, Any] | None = None,
    ) -> Notice:
        """Keep something that somebody has to know."""
        cursor = self._write(
            "INSERT INTO notices (time, kind, appointment, occurrence, parts)"
            " VALUES (?, ?, ?, ?, ?)",
            *(self._clock(), kind, appointment, occurrence, as_json(dict(parts or {}))),
        )
        return self.notices(int(cursor.lastrowid or 0) - 1, 1)[0]

    def notices(self, after: int = 0, last: int = 100) -> list[Notice]:
        """The newest notices with a higher number than that, the oldest of them first."""
        rows = self._read(
            "SELECT * FROM notices WHERE id > ? ORDER BY id DESC LIMIT ?", after, last
        )
        return [
            Notice(**{**row, "parts": msgspec.json.decode(row["parts"])}) for row in reversed(rows)
        ]

    def was_told(self, kind: NoticeKind, appointment: int, since: float) -> bool:
        """Whether such a notice was written after that moment."""
        return bool(
            self._read(
                "SELECT 1 FROM notices WHERE kind = ? AND appointment = ? AND time > ? LIMIT 1",
                *(kind, appointment, since),
            )
        )

    def how_often(self, appointment: int, until: float) -> tuple[int, float | None]:
        """How many times it came until then, and when last; without those that were called off."""
        [row] = self._read(
            "SELECT COUNT(*) AS came, MAX(due) AS last FROM occurrences"
            " WHERE appointment = ? AND due <= ? AND state != 'skipped'",
            *(appointment, until),
        )
        return row["came"], row["last"]

    # --- forgetting

    def forget(self, before: float) -> None:
        """Delete what was done, and told, before that moment, and what was removed before it."""
        with self.at_once():
            self._write(
                "DELETE FROM occurrences WHERE due < ?"
                " AND state NOT IN ('due', 'claimed', 'running')",
                before,
            )
            self._write("DELETE FROM notices WHERE time < ?", before)
            self._write(
                "DELETE FROM appointments WHERE removed < ?"
                " AND id NOT IN (SELECT appointment FROM occurrences)",
                before,
            )

    # --- the file

    def version(self) -> tuple[int, int]:
        """Another one whenever something was written, here or by another process."""
        with self._lock, self._trouble():
            [others] = self._db.execute("PRAGMA data_version").fetchone()
            return others, self._db.total_changes

    def _write(self, sql: str, *values: Any) -> sqlite3.Cursor:
        with self._lock, self._trouble():
            return self._db.execute(sql, values)

    def _read(self, sql: str, *values: Any) -> list[dict[str, Any]]:
        with self._lock, self._trouble():
            cursor = self._db.execute(sql, values)
            names = [column[0] for column in cursor.description]
            return [dict(zip(names, row, strict=True)) for row in cursor]

    @contextmanager
    def _trouble(self) -> Iterator[None]:
        try:
            yield
        except (sqlite3.Error, OSError) as error:
            raise BookError(
                f"The book of appointments {self.path} cannot be used ({cause(error)})."
                " Free some disk space or check the folder's rights, then try again."
            ) from error
