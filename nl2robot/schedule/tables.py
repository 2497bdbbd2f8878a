"""The tables of the book of appointments, and what their rows are."""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping
from typing import Any, Final

import msgspec

from nl2robot.schedule.appointments import Appointment, Occurrence
from nl2robot.schedule.outcomes import Outcome
from nl2robot.schedule.rhythm import Rhythm
from nl2robot.schedule.triggers import Trigger

VERSION: Final = 3
SCHEMA: Final = """
CREATE TABLE IF NOT EXISTS appointments (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    program TEXT NOT NULL,
    sha256 TEXT NOT NULL,            -- of exactly this program, which is what was approved
    sentence TEXT NOT NULL,
    plan TEXT,                       -- JSON
    language TEXT NOT NULL,
    rhythm TEXT,                     -- JSON, see nl2robot/schedule/rhythm.py
    trigger TEXT,                    -- JSON, of one that something else than the clock begins
    robot TEXT NOT NULL,
    fleet TEXT,                      -- of one of the fleet: the id of the robot that keeps it
    approved_by TEXT NOT NULL,
    approved_at REAL NOT NULL,       -- seconds since the epoch, as all times here
    approved_until REAL NOT NULL,
    reviewed TEXT NOT NULL,          -- JSON, see nl2robot/schedule/findings.py
    insists INTEGER NOT NULL DEFAULT 0,
    priority INTEGER NOT NULL,
    makes_up INTEGER NOT NULL,       -- minutes
    paused INTEGER NOT NULL DEFAULT 0,
    asked TEXT,                      -- why it waits for a new approval
    added REAL NOT NULL,
    removed REAL,
    looked REAL NOT NULL             -- until then all times are in `occurrences`
);
CREATE TABLE IF NOT EXISTS occurrences (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    appointment INTEGER NOT NULL REFERENCES appointments(id),
    due REAL NOT NULL,
    state TEXT NOT NULL,
    run INTEGER,
    note TEXT,
    process INTEGER,                 -- that claimed it, see nl2robot/run/process.py
    began REAL,
    ended REAL,
    waited_for TEXT,
    done_by TEXT,                    -- the robot of the fleet that does it
    reminded TEXT,                   -- JSON, what that robot tells of it
    UNIQUE (appointment, due)
);
CREATE INDEX IF NOT EXISTS open_occurrences ON occurrences (state)
    WHERE state IN ('due', 'claimed', 'running');
CREATE TABLE IF NOT EXISTS keepers (
    robot TEXT PRIMARY KEY,
    process INTEGER NOT NULL         -- that looks after its appointments
);
CREATE TABLE IF NOT EXISTS notices (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    time REAL NOT NULL,
    kind TEXT NOT NULL,
    appointment INTEGER NOT NULL,
    occurrence INTEGER,
    parts TEXT NOT NULL              -- JSON
);
"""
_LATER: Final = {
    "appointments": {"fleet": "TEXT"},
    "occurrences": {"done_by": "TEXT", "reminded": "TEXT"},
}
"""Columns that books of version 2 lack."""


def missing_columns(db: sqlite3.Connection) -> str:
    """What adds the columns that an older book lacks; nothing where there is no book yet."""
    statements = []
    for table, columns in _LATER.items():
        known = {row[1] for row in db.execute(f"PRAGMA table_info({table})")}
        statements += [
            f"ALTER TABLE {table} ADD COLUMN {name} {kind};"
            for name, kind in columns.items()
            if known and name not in known
        ]
    return " ".join(statements)


def as_json(value: Any) -> str | None:
    return None if value is None else msgspec.json.encode(value).decode()


def appointment_of(row: Mapping[str, Any]) -> Appointment:
    rhythm, trigger = row["rhythm"], row["trigger"]
    return Appointment(
        **{
            **row,
            "rhythm": msgspec.json.decode(rhythm, type=Rhythm) if rhythm else None,
            "trigger": msgspec.json.decode(trigger, type=Trigger) if trigger else None,
            "insists": bool(row["insists"]),
            "paused": bool(row["paused"]),
        }
    )


def occurrence_of(row: Mapping[str, Any]) -> Occurrence:
    told = row["reminded"]
    reminded = msgspec.json.decode(told, type=tuple[Outcome, ...]) if told else ()
    return Occurrence(**{**row, "reminded": reminded})
