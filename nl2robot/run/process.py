"""Which process runs something, in a number that no later one has.

Numbers of processes are given again: after a restart of a container the new server often has that
of the dead one. So the number is kept together with when the process began, where the system tells
that (on Linux).
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import Final

_BITS: Final = 22
"""Of the number of a process, at most."""


def own_process() -> int:
    """The present one."""
    number = os.getpid()
    return _born(number) << _BITS | number


def process_number(process: int) -> int:
    """As the system calls it."""
    return process & ((1 << _BITS) - 1)


def lives(process: int) -> bool:
    """Whether that process is there. Of a log that is older than these numbers it is told by the
    process's own number alone."""
    born, number = process >> _BITS, process_number(process)
    try:
        os.kill(number, 0)
    except ProcessLookupError:
        return False
    except OSError:  # it is somebody else's
        pass
    return born in (0, _born(number))


def _born(number: int) -> int:
    """When the process began, in ticks since the machine did; 0 where nobody tells."""
    try:
        said = Path(f"/proc/{number}/stat").read_text("utf-8", "replace")
    except OSError:
        return 0
    # The second field, in brackets, is the name and may hold anything.
    return int(said.rpartition(")")[2].split()[19])
