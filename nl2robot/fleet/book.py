"""What a robot has promised its fleet and what it has given to others, in SQLite (`fleet.sqlite`).

Whatever must not happen twice is written before it happens, so that a crash or a kill at any moment
has nothing done twice. The robot's id lives here as well: who has lost the book is another robot.
"""

from __future__ import annotations

import math
import secrets
import sqlite3
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

import msgspec

from nl2robot.errors import UserError
from nl2robot.fleet.messages import Plans, Stand, ZoneEntry
from nl2robot.private_database import private_database
from nl2robot.schedule.outcomes import Outcome
from robot_api.errors import cause

FILE: Final = "fleet.sqlite"
KEPT: Final = 1_000
"""Offers and errands of which all is kept, the newest."""
_SCHEMA: Final = """
CREATE TABLE IF NOT EXISTS own (key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS offers (
    number INTEGER PRIMARY KEY, id TEXT UNIQUE, offer BLOB, bare INTEGER NOT NULL DEFAULT 0
);
CREATE TABLE IF NOT EXISTS errands (
    number INTEGER PRIMARY KEY, id TEXT UNIQUE, errand BLOB, open INTEGER NOT NULL
);
CREATE TABLE IF NOT EXISTS zones (map TEXT, name TEXT, entry BLOB, PRIMARY KEY (map, name));
CREATE TABLE IF NOT EXISTS plans (robot TEXT PRIMARY KEY, plans BLOB);
"""


class Offer(msgspec.Struct, frozen=True, kw_only=True):
    """Something that a dispatcher offered to this robot."""

    id: str
    sender: str
    stand: Stand
    session: str
    """Of this robot's process that accepted or began it."""
    program: str = ""
    sha256: str = ""
    sentence: str = ""
    language: str = "en"
    by: str = ""
    reviewed: str = ""
    why: str | None = None
    run: int | None = None
    status: str | None = None
    reminded: tuple[Outcome, ...] = ()


class Errand(msgspec.Struct, frozen=True, kw_only=True):
    """Something that this robot's dispatcher has to have done once, by some robot."""

    id: str
    program: str
    sha256: str
    sentence: str
    language: str
    by: str
    reviewed: str
    at: float
    """When it was approved, in seconds since the epoch, by the clock here."""
    until: float | None = None
    """A robot is looked for until then, by the clock here; None: as long as the dispatcher looks
    for one."""
    wanted: str | None = None
    """The id of the only robot that may do it."""
    state: str = "looking"
    """looking: for a robot; given: one may begin it; begun; called_off; nobody; else as its run
    ended, or "broken_off"."""
    offer: str | None = None
    robot: str | None = None
    """The id of the robot that may begin it, does it or did it."""
    robot_name: str | None = None
    session: str = ""
    """Of that robot's process that accepted it."""
    run: int | None = None
    message: str | None = None
    refused: dict[str, str] = {}
    """Why a robot did not take it, by name."""
    reminded: tuple[Outcome, ...] = ()
    """What came of it, if it reminded somebody."""

    @property
    def open(self) -> bool:
        return self.state in ("looking", "given", "begun")


_pack = msgspec.msgpack.Encoder().encode
_offer = msgspec.msgpack.Decoder(Offer).decode
_errand = msgspec.msgpack.Decoder(Errand).decode
_zone = msgspec.msgpack.Decoder(ZoneEntry).decode
_plans = msgspec.msgpack.Decoder(Plans).decode


class FleetBook:
    """The book in one file, or in memory. Any thread may use it. Raises `UserError` wherever the
    file cannot be used."""

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        self._lock = threading.RLock()
        with self._trouble():
            self._db = private_database(path)
            self._db.execute("PRAGMA synchronous=FULL")  # a power cut forgets nothing promised
            self._db.executescript(_SCHEMA)
            given = ("id", secrets.token_hex(6))
            self._db.execute("INSERT OR IGNORE INTO own VALUES (?, ?)", given)
        self.robot: str = self._rows("SELECT value FROM own WHERE key = 'id'")[0][0]

    def close(self) -> None:
        with self._lock:
            self._db.close()

    def note_stop(self, at: float) -> None:
        """The robot was stopped then, in seconds since the epoch by the clock here."""
        self._write("INSERT OR REPLACE INTO own VALUES ('stopped', ?)", str(at))

    def last_stop(self) -> float:
        """When the robot was stopped last; minus infinity if it never was. A time that is still to
        come is no stop: somebody has set the clock."""
        rows = self._rows("SELECT value FROM own WHERE key = 'stopped'")
        at = float(rows[0][0]) if rows else -math.inf
        return at if at <= time.time() else -math.inf

    # --- what was offered to this robot

    def offer(self, id: str) -> Offer | None:
        rows = self._rows("SELECT offer FROM offers WHERE id = ?", id)
        return _offer(rows[0][0]) if rows else None

    def note(self, offer: Offer) -> Offer:
        """From now on it stands like that; on disk when this returns."""
        self._write(
            "INSERT INTO offers (id, offer) VALUES (?, ?)"
            " ON CONFLICT (id) DO UPDATE SET offer = excluded.offer",
            offer.id,
            _pack(offer),
        )
        return offer

    def runs(self, last: int) -> set[int]:
        """Those of the newest offers."""
        rows = self._rows("SELECT offer FROM offers ORDER BY number DESC LIMIT ?", last)
        return {run for row in rows if (run := _offer(row[0]).run) is not None}

    # --- what others are to do

    def errands(self, last: int = KEPT) -> list[Errand]:
        """The newest first."""
        return [
            _errand(row[0])
            for row in self._rows("SELECT errand FROM errands ORDER BY number DESC LIMIT ?", last)
        ]

    def errand(self, id: str) -> Errand | None:
        rows = self._rows("SELECT errand FROM errands WHERE id = ?", id)
        return _errand(rows[0][0]) if rows else None

    def keep(self, errand: Errand) -> Errand:
        """From now on it stands like that; on disk when this returns."""
        self._write(
            "INSERT INTO errands (id, errand, open) VALUES (?, ?, ?)"
            " ON CONFLICT (id) DO UPDATE SET errand = excluded.errand, open = excluded.open",
            errand.id,
            _pack(errand),
            errand.open,
        )
        return errand

    # --- keep-out zones

    def zones(self, floor: str) -> list[ZoneEntry]:
        return [_zone(row[0]) for row in self._rows("SELECT entry FROM zones WHERE map = ?", floor)]

    def keep_zone(self, floor: str, entry: ZoneEntry) -> None:
        self._write(
            "INSERT OR REPLACE INTO zones VALUES (?, ?, ?)", floor, entry.name, _pack(entry)
        )

    # --- what the others have planned

    def plans(self) -> dict[str, Plans]:
        """By the id of the robot that keeps them."""
        return {robot: _plans(row) for robot, row in self._rows("SELECT robot, plans FROM plans")}

    def keep_plans(self, robot: str, plans: Plans) -> None:
        if plans.plans:
            statement = "INSERT OR REPLACE INTO plans VALUES (?, ?)"
            self._write(statement, robot, _pack(plans))
        else:
            self._write("DELETE FROM plans WHERE robot = ?", robot)

    def forget(self, kept: int = KEPT) -> None:
        """What older errands were, unless they are open, and what was said in older offers. How
        those ended is kept for good: who is asked for one after years does not begin it again."""
        old = "number <= (SELECT MAX(number) FROM {0}) - ?"
        self._write(f"DELETE FROM errands WHERE open = 0 AND {old.format('errands')}", kept)
        ended = "bare = 0 AND " + old.format("offers")
        for [number, offer] in self._rows(f"SELECT number, offer FROM offers WHERE {ended}", kept):
            bare = msgspec.structs.replace(
                _offer(offer), program="", sentence="", by="", reviewed="", why=None
            )
            statement = "UPDATE offers SET offer = ?, bare = 1 WHERE number = ?"
            self._write(statement, _pack(bare), number)

    # --- inside

    def _rows(self, statement: str, *given: Any) -> list[Any]:
        with self._lock, self._trouble():
            return self._db.execute(statement, given).fetchall()

    def _write(self, statement: str, *given: Any) -> None:
        with self._lock, self._trouble():
            self._db.execute(statement, given)

    @contextmanager
    def _trouble(self) -> Iterator[None]:
        try:
            yield
        except (sqlite3.Error, OSError) as error:
            raise UserError(
                f"The book of the fleet in {self.path} cannot be used ({cause(error)})."
                " Check its rights and the disk."
            ) from error
