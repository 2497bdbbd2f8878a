"""The run log, looked through: by words, state and date, a page at a time.

    archive = Archive(log.path)
    page = archive.page(Wanted(words="pharmacy", state="failed"))
    older = archive.page(Wanted(words="pharmacy", state="failed"), before=page.runs[-1].id)

It reads over connections of its own, so that a long search never holds up the program that is being
logged. Nothing is written. Of 50 000 runs, each search reads all in some 30 ms: no index is needed.
"""

from __future__ import annotations

import math
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing
from datetime import date, datetime, timedelta
from pathlib import Path
from typing import Any, Final, Literal, get_args
from urllib.parse import quote

import msgspec

from nl2robot.run.process import lives
from nl2robot.run.runlog import LogError

State = Literal["running", "done", "failed", "stopped", "limit", "interrupted"]
STATES: Final[tuple[State, ...]] = get_args(State)
PAGE: Final = 50
"""Runs on a page."""
READ_AT_ONCE: Final = 1000
"""Runs, of those for a file."""
LONGEST: Final = 200
"""Letters of what is looked for; the rest is left out."""
MOST_WORDS: Final = 8
WAITS: Final = 2000
"""Milliseconds for whoever has locked the log."""

_SEARCHED: Final = ("utterance", "heard", "program", "approved_by", "message", "world")


class Wanted(msgspec.Struct, frozen=True, kw_only=True):
    """Which runs; all, if nothing is said."""

    words: str = ""
    """All of these are in what was said or heard, the program, the name of who approved it, why it
    ended or the world; `status` and `when` have their own fields."""
    state: State | None = None
    since: date | None = None
    """The first day, by this machine's clock."""
    until: date | None = None
    """The last day."""


class Brief(msgspec.Struct, frozen=True, kw_only=True):
    """A run in a list."""

    id: int
    started: float
    finished: float | None
    heard: str | None
    utterance: str | None
    program: str
    approved_by: str
    proposed: str | None
    changed_by: str | None
    world: str | None
    robot: str | None
    status: str | None
    message: str | None
    process: int | None
    calls: int

    @property
    def state(self) -> State:
        return state_of(self.status, self.process)

    @property
    def title(self) -> str:
        """What was said, or the first line of what was written."""
        return self.utterance or self.heard or self.program.strip().partition("\n")[0]


class Page(msgspec.Struct, frozen=True, kw_only=True):
    """Some runs, newest first."""

    runs: tuple[Brief, ...]
    more: bool
    """Whether there are older ones."""
    found: int
    """How many there are on all pages."""


def state_of(status: str | None, process: int | None) -> State:
    """How a run stands: what was never finished was interrupted, if its process is gone."""
    if status in STATES:
        return status
    return "running" if process is not None and lives(process) else "interrupted"


class Archive:
    """Past runs in the log's file. Any thread may use it. Its methods raise `LogError`."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def page(self, wanted: Wanted, before: int | None = None, size: int = PAGE) -> Page:
        """The newest runs that are wanted; with `before`, of those older than that run."""
        with self._reading() as db:
            where, values = _condition(wanted, db)
            [found] = db.execute(f"SELECT count(*) FROM runs WHERE {where}", values).fetchone()
            runs = _briefs(db, where, values, before, size + 1)
        return Page(runs=tuple(runs[:size]), more=len(runs) > size, found=found)

    def times_said(self, names: Sequence[str], since: float) -> int:
        """How many runs since then (seconds since the epoch) were asked for with one of these
        names in the sentence."""
        with self._reading() as db:
            said = " OR ".join(["instr(lower(utterance), ?)"] * len(names))
            [times] = db.execute(
                f"SELECT count(*) FROM runs WHERE started >= ? AND ({said or 0})",
                (since, *(name.lower() for name in names)),
            ).fetchone()
        return int(times)

    def all(self, wanted: Wanted, most: int) -> Iterator[Brief]:
        """The newest `most` runs that are wanted, read some at a time."""
        before = None
        while most > 0:
            with self._reading() as db:
                runs = _briefs(db, *_condition(wanted, db), before, min(most, READ_AT_ONCE))
            yield from runs
            if len(runs) < READ_AT_ONCE:
                return
            most -= len(runs)
            before = runs[-1].id

    def neighbours(self, run: int) -> tuple[int | None, int | None]:
        """The runs before and after this one."""
        with self._reading() as db:
            [older] = db.execute("SELECT max(id) FROM runs WHERE id < ?", (run,)).fetchone()
            [newer] = db.execute("SELECT min(id) FROM runs WHERE id > ?", (run,)).fetchone()
        return older, newer

    def _reading(self) -> _Reading:
        return _Reading(self.path)


class _Reading:
    """A connection for a question or two."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __enter__(self) -> sqlite3.Connection:
        try:
            self.db = sqlite3.connect(
                f"file:{quote(str(self.path.absolute()))}?mode=ro",
                uri=True,
                timeout=WAITS / 1000,
                isolation_level=None,
            )
        except sqlite3.Error as error:
            raise self._trouble(error) from error
        self.db.create_function("mentions", -1, _mentions, deterministic=True)
        return self.db

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        with closing(self.db):
            if isinstance(error, sqlite3.Error):
                raise self._trouble(error) from error

    def _trouble(self, error: sqlite3.Error) -> LogError:
        return LogError(cannot_be_read(self.path, error))


def cannot_be_read(path: Path, error: sqlite3.Error) -> str:
    """What happened and what to do."""
    if not path.exists():
        return (
            f"The run log {path} is gone. Nothing more can be read from it;"
            " start nl2robot again, and a new one is made."
        )
    if "locked" in str(error) or "busy" in str(error):
        return (
            f"The run log {path} is locked by another program."
            " Close that program, then load this page again."
        )
    return (
        f"The run log {path} is damaged or cannot be read ({error}). Check the disk and the"
        " folder's rights. To begin a new log, move the file away and start nl2robot again."
    )


def _condition(wanted: Wanted, db: sqlite3.Connection) -> tuple[str, dict[str, Any]]:
    parts: list[str] = ["1"]
    values: dict[str, Any] = {}
    for number, word in enumerate(wanted.words[:LONGEST].split()[:MOST_WORDS]):
        values[f"like{number}"] = _pattern(word)
        some = " OR ".join(f"{name} LIKE :like{number} ESCAPE '\\'" for name in _SEARCHED)
        parts.append(f"({some})")
        if not word.isascii():  # of which LIKE does not know the capitals
            values[f"word{number}"] = word.casefold()
            parts.append(f"mentions(:word{number}, {', '.join(_SEARCHED)})")
    if wanted.state in ("running", "interrupted"):
        parts.append("status IS NULL")
        alive = _alive(db)
        running = f"ifnull(process IN ({', '.join(map(str, alive))}), 0)"
        parts.append(running if wanted.state == "running" else f"NOT {running}")
    elif wanted.state is not None:
        parts.append("status = :state")
        values["state"] = wanted.state
    if wanted.since is not None:
        parts.append("started >= :since")
        values["since"] = _midnight(wanted.since, 0)
    if wanted.until is not None:
        parts.append("started < :until")
        values["until"] = _midnight(wanted.until, 1)
    return " AND ".join(parts), values


def _pattern(word: str) -> str:
    """Of LIKE: what has this word in it, whatever its other letters than ASCII's are."""
    escaped = "".join(f"\\{sign}" if sign in "\\%_" else sign for sign in word)
    return "%" + "".join(sign if sign.isascii() else "%" for sign in escaped) + "%"


def _mentions(sought: str, *texts: str | None) -> bool:
    return any(text is not None and sought in text.casefold() for text in texts)


def _alive(db: sqlite3.Connection) -> list[int]:
    rows = db.execute("SELECT DISTINCT process FROM runs WHERE status IS NULL")
    return [process for (process,) in rows if process is not None and lives(process)]


def _midnight(day: date, later: int) -> float:
    """Where a day begins, so many days later; for days that no clock knows, long ago or never."""
    if not 1970 < day.year < 9999:
        return math.inf if day.year >= 9999 else -math.inf
    return (datetime(day.year, day.month, day.day) + timedelta(days=later)).timestamp()


def _briefs(
    db: sqlite3.Connection, where: str, values: dict[str, Any], before: int | None, size: int
) -> list[Brief]:
    names = [name for name in Brief.__struct_fields__ if name != "calls"]
    rows = db.execute(
        f"SELECT {', '.join(names)}, (SELECT count(*) FROM calls WHERE run = runs.id) AS calls"
        f" FROM runs WHERE ({where}) AND id < ifnull(:before, 9223372036854775807)"
        " ORDER BY id DESC LIMIT :size",
        {**values, "before": before, "size": size},
    )
    return [Brief(**dict(zip([*names, "calls"], row, strict=True))) for row in rows]
