"""Files that people give: read whole, but never more than makes sense."""

from __future__ import annotations

import errno
import os
from pathlib import Path
from typing import Final

MOST: Final = 4_000_000
"""Bytes of a text that somebody wrote."""


def read_text(path: Path, most: int = MOST, encoding: str = "utf-8-sig") -> str:
    """What stands in a file; its size need not be known before, as that of a device. Raises
    `OSError` and `UnicodeDecodeError`."""
    with path.open("rb") as file:
        data = file.read(most + 1)
    if len(data) > most:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG))
    return data.decode(encoding)
