"""Whether the file of the log is still the one that is written to.

On Linux a file that is deleted or replaced can be written on and on by whoever has it open, and
nobody will ever read that. SQLite notices none of this, so it is looked at before each line.
"""

from __future__ import annotations

import os
import struct
from contextlib import suppress
from pathlib import Path
from typing import Final

from nl2robot.errors import UserError


class Tampered(UserError):
    """Somebody has deleted, replaced or cut the log while it was written."""

    def __init__(self, path: Path) -> None:
        super().__init__(
            f"The run log {path} was deleted, replaced or cut while it was in use, so nothing more"
            " is done. Put it back or move it away, then start nl2robot again."
        )


_HEAD: Final = struct.Struct(">8xI")
"""Of a write-ahead log, as SQLite's file format has it; the number is the size of a page, of which
each is kept behind a head of its own."""
_FRAMES_BEGIN: Final = 32
_FRAME_HEAD: Final = 24


class LogFile:
    """The files of an SQLite database with a write-ahead log, which never get shorter while it is
    open."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._files = (path, Path(f"{path}-wal"))
        self._known: dict[Path, os.stat_result] = {}
        self._last_frame: int | None = None
        """Where the last page begins that was known to be written ahead."""
        self._touched = False

    def check(self) -> None:
        """Raises `Tampered`, once that has happened always."""
        self._look()
        if self._touched:
            raise Tampered(self._path)

    def note(self) -> None:
        """Something was written: so long they are now. Raises as `check` does."""
        self.check()
        for file in self._files:
            # Without a write-ahead log (of a file system that has none) there is one file.
            with suppress(FileNotFoundError):
                self._known.setdefault(file, file.stat())
        self._look()
        self._last_frame = self._frame()

    def _look(self) -> None:
        for file, known in self._known.items():
            try:
                now = file.stat()
            except OSError:
                self._touched = True
                return
            same = (now.st_dev, now.st_ino) == (known.st_dev, known.st_ino)
            self._touched = self._touched or not same or now.st_size < known.st_size
            self._known[file] = now if same else known
        if self._last_frame is not None and not self._has(self._last_frame):
            self._touched = True

    def _frame(self) -> int | None:
        """Where the last whole page begins now."""
        _, ahead = self._files
        with suppress(OSError), ahead.open("rb") as file:
            head = file.read(_HEAD.size)
            if len(head) == _HEAD.size:
                frame = int(_HEAD.unpack(head)[0]) + _FRAME_HEAD
                # A full disk may have left a part of one at the end.
                whole = (ahead.stat().st_size - _FRAMES_BEGIN) // frame
                return _FRAMES_BEGIN + (whole - 1) * frame if whole > 0 else None
        return None

    def _has(self, frame: int) -> bool:
        """Whether something is there. If the file was cut since it was last looked at, and then
        written to, it is as long as before, with nothing in between."""
        _, ahead = self._files
        try:
            with ahead.open("rb") as file:
                begins = file.read(_HEAD.size)
                file.seek(frame)
                return any(begins) and any(file.read(_FRAME_HEAD))
        except OSError:
            return False
