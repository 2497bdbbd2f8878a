"""How long what was said and done is kept: a hospital decides that, and a server sees to it."""

from __future__ import annotations

import logging
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from nl2robot.run.runlog import LogError, RunLog

DAY: Final = 24 * 3600.0
LOOKS_EVERY: Final = 3600.0
"""Seconds between two looks for what is too old."""

_log = logging.getLogger("nl2robot.run.retention")


@contextmanager
def kept_for(log: RunLog, seconds: float) -> Iterator[None]:
    """Meanwhile runs are deleted from the log when they are so old; at once for the first time."""
    over = threading.Event()

    def delete() -> None:
        while True:
            try:
                log.delete(log.older_than(seconds))
                log.delete_by_hand(seconds)
            except LogError as error:  # the next run is told, which cannot begin
                _log.warning("old runs are not deleted: %s", error)
            if over.wait(LOOKS_EVERY):
                return

    thread = threading.Thread(target=delete, name="retention", daemon=True)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
