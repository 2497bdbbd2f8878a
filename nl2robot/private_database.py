"""SQLite files for one user alone: runs, appointments, accounts, what a fleet has promised."""

from __future__ import annotations

import os
import sqlite3
from pathlib import Path
from typing import Final

BUSY_SECONDS: Final = 5.0
"""How long one process waits for another that is writing."""
IN_MEMORY: Final = ":memory:"


def private_database(path: Path | str, *, transactions: bool = False) -> sqlite3.Connection:
    """Open one, made with its folder if missing, readable to this user alone; any thread may use
    it. `transactions`: what is written begins one by itself, for `with database:` to end. Raises
    `OSError`, `sqlite3.Error`."""
    if str(path) != IN_MEMORY:
        file = Path(path)
        file.parent.mkdir(parents=True, exist_ok=True)
        # Before SQLite makes it, so that it is never anybody else's to read.
        os.close(os.open(file, os.O_RDWR | os.O_CREAT, 0o600))
        file.chmod(0o600)
    database = sqlite3.connect(
        path,
        check_same_thread=False,
        timeout=BUSY_SECONDS,
        isolation_level="DEFERRED" if transactions else None,
    )
    database.execute("PRAGMA journal_mode=WAL")
    return database
