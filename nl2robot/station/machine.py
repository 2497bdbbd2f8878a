"""What a server wants of the machine that it runs on."""

from __future__ import annotations

import contextlib
import sys
from typing import Final

from nl2robot.sentences import told
from nl2robot.words import terminal_language

PATCHED: Final = {(3, 11): 10, (3, 12): 6}
"""Of each Python the first that reads cookies in time that grows with their length
(CVE-2024-7592), and has what was mended before. Later ones began with that."""
OPEN_FILES: Final = 4096
"""That a server may have: connections, the log, a process for each program."""


def outdated_python(version: tuple[int, int, int] = sys.version_info[:3]) -> str | None:
    """A sentence about a Python with known faults."""
    patched = PATCHED.get(version[:2])
    if patched is None or version[2] >= patched:
        return None
    number, newer = (".".join(map(str, (*version[:2], each))) for each in (version[2], patched))
    sentence = (
        f"This Python, {number}, has faults that others can make use of."
        f" Bring it to {newer} or newer."
    )
    return told(sentence, terminal_language())


def allow_open_files(number: int = OPEN_FILES) -> None:
    """As many as that, or as the system allows."""
    with contextlib.suppress(ImportError, ValueError, OSError):
        import resource

        least, most = resource.getrlimit(resource.RLIMIT_NOFILE)
        wanted = number if most == resource.RLIM_INFINITY else min(number, most)
        if least < wanted:
            resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, most))
