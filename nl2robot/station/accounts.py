"""Who may come in: accounts with names, what they and tablets came in by, and who failed to.

In SQLite, readable to this user alone. Passwords are kept as Argon2id hashes, the secrets that
browsers keep in their cookies as SHA-256; only the two links that `nl2robot serve` prints at each
start are kept as they are. Several processes may use the file: what one changes (`nl2robot
accounts`), the others learn of within half a second.
"""

from __future__ import annotations

import contextlib
import hashlib
import secrets
import sqlite3
import threading
import time
import unicodedata
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

import msgspec

from nl2robot.errors import UserError
from nl2robot.private_database import private_database
from nl2robot.station import passwords
from robot_api.errors import cause
from robot_api.serving.access import Guest, new_token
from robot_api.serving.roles import PERSONAL, Role

LONGEST_NAME: Final = 60

SHIFT: Final = 12 * 3600.0
"""Seconds without a sign of them after which a person has to sign in again."""
YEAR: Final = 365 * 24 * 3600.0
"""The same of a tablet, and of a link."""
INVITED_FOR: Final = 600.0
"""Seconds for which a code to pair a tablet holds."""
LONGEST_INVITATION: Final = 7 * 24 * 3600.0

FREE_FAILURES: Final = 3
"""Wrong passwords in a row after which it takes longer."""
LONGEST_DELAY: Final = 60.0
REMEMBERED_FOR: Final = 900.0
"""Seconds in which failures count towards that."""
FAILURES_KEPT: Final = 500

NOTICED_AFTER: Final = 0.5
"""Seconds between two looks whether another process changed something."""
USES_KEPT_EVERY: Final = 30.0

_LARGEST: Final = 2**63 - 1
"""Of the numbers that SQLite knows."""
LINKED: Final[dict[Role, str]] = {
    "operator": "operators' link",
    "observer": "observers' link",
    "assistant": "assistants on this computer",
}
"""The links that `nl2robot serve` prints, and the one of `nl2robot mcp`, as they are called in
lists."""

_SCHEMA: Final = """
CREATE TABLE IF NOT EXISTS accounts (
    name TEXT PRIMARY KEY COLLATE NOCASE,
    role TEXT NOT NULL,
    password TEXT NOT NULL,          -- Argon2id, in PHC's format
    made REAL NOT NULL               -- seconds since the epoch, as all times here
);
CREATE TABLE IF NOT EXISTS sessions (
    id INTEGER PRIMARY KEY AUTOINCREMENT,
    digest TEXT NOT NULL UNIQUE,     -- SHA-256 of the secret
    account TEXT COLLATE NOCASE REFERENCES accounts(name) ON DELETE CASCADE,  -- NULL: no person's
    role TEXT NOT NULL,
    label TEXT NOT NULL,             -- the tablet, or the browser
    link TEXT,                       -- the secret of a link that is printed
    made REAL NOT NULL,
    made_by TEXT,
    used REAL NOT NULL
);
CREATE TABLE IF NOT EXISTS invitations (
    digest TEXT PRIMARY KEY,
    role TEXT NOT NULL,
    label TEXT NOT NULL,
    made_by TEXT,
    ends REAL NOT NULL
);
CREATE TABLE IF NOT EXISTS failures (
    time REAL NOT NULL,
    name TEXT NOT NULL COLLATE NOCASE,
    address TEXT NOT NULL,
    counts INTEGER NOT NULL DEFAULT 1  -- 0 once they have signed in after all
);
CREATE TABLE IF NOT EXISTS facts (name TEXT PRIMARY KEY, value TEXT NOT NULL);
"""


class Account(msgspec.Struct, frozen=True):
    name: str
    role: Role
    made: float


class Session(msgspec.Struct, frozen=True):
    """Something that somebody came in by, and may come in by again."""

    id: int
    role: Role
    account: str | None
    """Whose it is; None for a tablet and for a link."""
    label: str
    made: float
    made_by: str | None
    used: float
    """When it was last used, to the minute or so."""
    link: bool = False


class Invitation(msgspec.Struct, frozen=True):
    """What a code is good for."""

    role: Role
    label: str
    made_by: str | None
    ends: float


class Failure(msgspec.Struct, frozen=True):
    time: float
    name: str
    address: str


class _Held(msgspec.Struct, frozen=True):
    """What a secret is good for, as the server has it at hand."""

    guest: Guest
    used: float
    lasts: float


class TooSoon(Exception):
    """After so many wrong passwords the next one is not looked at yet."""

    def __init__(self, seconds: float) -> None:
        super().__init__(f"Wait {seconds:.0f} seconds.")
        self.seconds = seconds


class Accounts:
    """Those in this file. Any thread may use it; `known` and `holds` never wait for the disk."""

    def __init__(self, file: Path, clock: Callable[[], float] = time.time) -> None:
        self._clock = clock
        self._lock = threading.RLock()
        self._signing_in = threading.Lock()
        with _readable(file):
            self._database = private_database(file, transactions=True)
            self._database.execute("PRAGMA foreign_keys = ON")
            self._database.executescript(_SCHEMA)
        self._sessions: dict[str, _Held] = {}
        """By their digests."""
        self._used: dict[int, float] = {}
        """When sessions were used that is not written down yet."""
        self._version = 0
        self._listeners: list[Callable[[], None]] = []
        self._over = threading.Event()
        self._reload()

    # --- coming in

    def known(self, secret: str) -> Guest | None:
        """Who shows this secret, if it holds."""
        held = self._sessions.get(_digest(secret))
        if held is None or held.guest.session is None:
            return None
        now = self._clock()
        if max(held.used, self._used.get(held.guest.session, 0.0)) + held.lasts < now:
            return None
        self._used[held.guest.session] = now
        return held.guest

    def holds(self, guest: Guest) -> bool:
        """Whether somebody is still known as this."""
        return any(guest == held.guest for held in self._sessions.values())

    def sign_in(self, name: str, password: str, address: str, label: str) -> str | None:
        """Begin a session, of the browser `label` at an address; returns its secret, or None for a
        wrong name or password. Takes a while, on purpose. Raises `TooSoon`."""
        self._check_delay(name, address)
        # One after the other: many at once must neither fill the memory nor outrun the delay.
        with self._signing_in:
            self._check_delay(name, address)
            account = self._row("SELECT name, role, password FROM accounts WHERE name = ?", name)
            # An unknown name takes as long as a known one.
            right = passwords.is_right(password, account[2] if account else passwords.of_nobody())
            if account is None or not right:
                self._failed(name, address)
                return None
        with self._changing() as database:
            database.execute("UPDATE failures SET counts = 0 WHERE name = ?", (name,))
        return self._begin(account[1], account[0], label, account[0])

    def sign_out(self, secret: str) -> None:
        """End the session of this secret."""
        with self._changing() as database:
            database.execute(
                "DELETE FROM sessions WHERE digest = ? AND link IS NULL", (_digest(secret),)
            )

    def link(self, role: Role) -> str:
        """The secret of the link by which operators or observers come in; the same until it is
        withdrawn."""
        kept = self._row("SELECT link FROM sessions WHERE link IS NOT NULL AND role = ?", role)
        if kept is not None:
            return str(kept[0])
        return self._begin(role, None, LINKED[role], None, link=True)

    def let_in(self, role: Role, label: str, made_by: str | None) -> str:
        """The secret by which a program that is no person's comes in from now on."""
        return self._begin(role, None, _checked_name(label), made_by)

    # --- pairing

    def invite(
        self, role: Role, label: str, made_by: str | None, lasts: float = INVITED_FOR
    ) -> str:
        """A code by which one tablet comes in, once. `label` is what it is called. Raises
        `UserError`."""
        label = _checked_name(label)
        lasts = min(lasts, LONGEST_INVITATION)
        code = secrets.token_urlsafe(12).replace("-", "a").replace("_", "b")
        with self._changing() as database:
            database.execute("DELETE FROM invitations WHERE ends < ?", (self._clock(),))
            database.execute(
                "INSERT INTO invitations VALUES (?, ?, ?, ?, ?)",
                (_digest(code), role, label, made_by, self._clock() + lasts),
            )
        return code

    def invitation(self, code: str) -> Invitation | None:
        """What a code is good for; None if it is not, or not any more."""
        row = self._row(
            "SELECT role, label, made_by, ends FROM invitations WHERE digest = ? AND ends >= ?",
            *(_digest(code), self._clock()),
        )
        return Invitation(*row) if row else None

    def join(self, code: str) -> str | None:
        """Take up an invitation; returns the tablet's secret, None if the code does not hold."""
        with self._changing() as database:
            row = database.execute(
                "DELETE FROM invitations WHERE digest = ? AND ends >= ?"
                " RETURNING role, label, made_by",
                (_digest(code), self._clock()),
            ).fetchone()
        return self._begin(row[0], None, row[1], row[2]) if row else None

    def spend(self, code: str) -> None:
        """Nobody may take up this invitation any more."""
        with self._changing() as database:
            database.execute("DELETE FROM invitations WHERE digest = ?", (_digest(code),))

    # --- administering

    def check_new(self, name: str) -> str:
        """The name as an account can have it. Raises `UserError` if it is none, or taken."""
        name = _checked_name(name)
        if self._row("SELECT 1 FROM accounts WHERE name = ?", name):
            raise UserError(f"There is an account of {name} already. Choose another name.")
        return name

    def check_known(self, name: str) -> None:
        """Raises `UserError` if there is no such account."""
        if not self._row("SELECT 1 FROM accounts WHERE name = ?", name):
            raise UserError(
                f"There is no account of {name}. `nl2robot accounts list` says which there are."
            )

    def add(self, name: str, role: Role, password: str) -> None:
        """Make an account. Raises `UserError`."""
        name = self.check_new(name)
        _check_role(role)
        hashed = passwords.hashed(password)
        with self._changing() as database:
            database.execute(
                "INSERT INTO accounts VALUES (?, ?, ?, ?)", (name, role, hashed, self._clock())
            )

    def remove(self, name: str) -> None:
        """End an account and all that somebody came in by with it. Raises `UserError`."""
        self.check_known(name)
        with self._changing() as database:
            database.execute("DELETE FROM accounts WHERE name = ?", (name,))

    def set_password(self, name: str, password: str) -> None:
        """Who is signed in with the old one has to sign in again. Raises `UserError`."""
        self.check_known(name)
        hashed = passwords.hashed(password)
        with self._changing() as database:
            database.execute("UPDATE accounts SET password = ? WHERE name = ?", (hashed, name))
            database.execute("DELETE FROM sessions WHERE account = ?", (name,))

    def set_role(self, name: str, role: Role) -> None:
        """Raises `UserError`."""
        self.check_known(name)
        _check_role(role)
        with self._changing() as database:
            database.execute("UPDATE accounts SET role = ? WHERE name = ?", (role, name))
            database.execute("UPDATE sessions SET role = ? WHERE account = ?", (role, name))

    def withdraw(self, session: int) -> None:
        """Let nobody come in by this any more. Raises `UserError`."""
        with self._changing() as database:
            gone = session <= _LARGEST and database.execute(
                "DELETE FROM sessions WHERE id = ?", (session,)
            )
            if not gone or not gone.rowcount:
                raise UserError(f"There is no device {session}. `nl2robot accounts list` has them.")

    def accounts(self) -> list[Account]:
        """By name."""
        return [
            Account(*row)
            for row in self._rows("SELECT name, role, made FROM accounts ORDER BY name")
        ]

    def sessions(self) -> list[Session]:
        """Those that hold, the one used last first."""
        self._keep_uses()
        rows = self._rows(
            "SELECT id, role, account, label, made, made_by, used, link IS NOT NULL FROM sessions"
            " ORDER BY used DESC, id DESC"
        )
        found = [
            msgspec.convert(
                dict(zip(Session.__struct_fields__, row, strict=True)), Session, strict=False
            )
            for row in rows
        ]
        now = self._clock()
        return [each for each in found if each.used + _lasts(each.account) >= now]

    def failures(self, last: int = 20) -> list[Failure]:
        """Who tried to sign in and could not, the newest first."""
        rows = self._rows(
            "SELECT time, name, address FROM failures ORDER BY time DESC LIMIT ?", last
        )
        return [Failure(*row) for row in rows]

    # --- what a server has written down for the commands

    def note(self, name: str, value: str) -> None:
        """Keep a fact, such as the address of the pages."""
        with self._changing() as database:
            database.execute("INSERT OR REPLACE INTO facts VALUES (?, ?)", (name, value))

    def noted(self, name: str) -> str | None:
        row = self._row("SELECT value FROM facts WHERE name = ?", name)
        return str(row[0]) if row else None

    # --- changes

    def on_change(self, listener: Callable[[], None]) -> None:
        """Call it, in any thread, whenever somebody may not be known any more."""
        self._listeners.append(listener)

    def watch(self) -> None:
        """Notice from now on what other processes change."""
        threading.Thread(target=self._watch, name="accounts", daemon=True).start()

    def close(self) -> None:
        self._over.set()
        with self._lock:
            with contextlib.suppress(sqlite3.Error, UserError):
                self._keep_uses()
            self._database.close()

    def _watch(self) -> None:
        written = time.monotonic()
        while not self._over.wait(NOTICED_AFTER):
            with self._lock:
                if self._over.is_set():
                    return
                with contextlib.suppress(sqlite3.Error, UserError):  # a full disk, say
                    version = self._database.execute("PRAGMA data_version").fetchone()[0]
                    changed = version != self._version
                    if changed:
                        self._reload()
                    if time.monotonic() - written > USES_KEPT_EVERY:
                        written = time.monotonic()
                        self._keep_uses()
            if changed:
                self._tell()

    # --- inside

    def _begin(
        self, role: Role, account: str | None, label: str, made_by: str | None, link: bool = False
    ) -> str:
        secret, now = new_token() + new_token()[:8], self._clock()
        label = "".join(each for each in label if each.isprintable()).strip()[:LONGEST_NAME]
        with self._changing() as database:
            database.execute(
                "INSERT INTO sessions (digest, account, role, label, link, made, made_by, used)"
                " VALUES (?, ?, ?, ?, ?, ?, ?, ?)",
                (
                    _digest(secret),
                    account,
                    role,
                    label,
                    secret if link else None,
                    now,
                    made_by,
                    now,
                ),
            )
        return secret

    def _reload(self) -> None:
        with self._lock:
            self._version = self._database.execute("PRAGMA data_version").fetchone()[0]
            rows = self._rows("SELECT digest, id, role, account, label, link, used FROM sessions")
            self._sessions = {
                digest: _Held(
                    Guest(role, None if link else account or label, number), used, _lasts(account)
                )
                for digest, number, role, account, label, link, used in rows
            }

    def _tell(self) -> None:
        for listener in tuple(self._listeners):
            listener()

    def _keep_uses(self) -> None:
        with self._lock:
            used, self._used = self._used, {}
            if not used:
                return
            with _readable(None), self._database as database:
                database.executemany(
                    "UPDATE sessions SET used = ? WHERE id = ?",
                    [(when, number) for number, when in used.items()],
                )
            self._reload()

    def _check_delay(self, name: str, address: str) -> None:
        """Raises `TooSoon` for a name, or an address, that has failed too often just now."""
        since = self._clock() - REMEMBERED_FOR
        longest = 0.0
        for column, value in (("name", name), ("address", address)):
            count, newest = self._rows(
                f"SELECT COUNT(*), MAX(time) FROM failures WHERE {column} = ? AND counts"
                " AND time > ?",
                *(value, since),
            )[0]
            if count >= FREE_FAILURES:
                delay = min(LONGEST_DELAY, 2.0 ** (count - FREE_FAILURES + 1))
                longest = max(longest, newest + delay - self._clock())
        if longest > 0:
            raise TooSoon(longest)

    def _failed(self, name: str, address: str) -> None:
        with self._changing() as database:
            database.execute(
                "INSERT INTO failures (time, name, address) VALUES (?, ?, ?)",
                (self._clock(), name[:LONGEST_NAME], address),
            )
            database.execute(
                "DELETE FROM failures WHERE rowid NOT IN"
                " (SELECT rowid FROM failures ORDER BY time DESC LIMIT ?)",
                (FAILURES_KEPT,),
            )

    @contextlib.contextmanager
    def _changing(self) -> Iterator[sqlite3.Connection]:
        """Change something in one go, and let it be known."""
        with self._lock:
            with _readable(None), self._database as database:
                yield database
            self._reload()
        self._tell()

    def _rows(self, query: str, *values: object) -> list[tuple]:  # type: ignore[type-arg]
        with self._lock, _readable(None):
            return self._database.execute(query, values).fetchall()

    def _row(self, query: str, *values: object) -> tuple | None:  # type: ignore[type-arg]
        return next(iter(self._rows(query, *values)), None)


def _digest(secret: str) -> str:
    """Of a secret that was drawn by chance, so that nothing slower is needed."""
    return hashlib.sha256(secret.encode(errors="replace")).hexdigest()


def _lasts(account: str | None) -> float:
    """Seconds for which a session holds without being used."""
    return SHIFT if account else YEAR


def _check_role(role: str) -> None:
    if role not in PERSONAL:
        raise UserError(f"{role!r} is no role. Choose one of {', '.join(PERSONAL)}.")


def _checked_name(name: str) -> str:
    name = " ".join(unicodedata.normalize("NFC", name).split())
    if not name or len(name) > LONGEST_NAME or not name.isprintable():
        raise UserError(f"A name has 1 to {LONGEST_NAME} characters. Choose another.")
    return name


@contextlib.contextmanager
def _readable(file: Path | None) -> Iterator[None]:
    what = f"The file {file}" if file else "The file with the accounts"
    try:
        yield
    except (OSError, sqlite3.Error) as error:
        raise UserError(
            f"{what} cannot be used ({cause(error)}). See that it may be written, and that the disk"
            " is not full."
        ) from error
