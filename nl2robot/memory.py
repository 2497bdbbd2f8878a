"""How much memory there is, where the system says so (Linux)."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path

PROC = Path("/proc")


def free_megabytes() -> float | None:
    """What a new process could have without taking from others."""
    return _megabytes(PROC / "meminfo", "MemAvailable")


def used_megabytes(pid: int) -> float | None:
    """What a process has that is its own."""
    return _megabytes(PROC / str(pid) / "status", "VmRSS")


def _megabytes(file: Path, entry: str) -> float | None:
    with suppress(OSError):
        found = re.search(rf"^{entry}:\s*(\d+) kB", file.read_text(), re.MULTILINE)
        return int(found[1]) / 1024 if found else None
    return None
