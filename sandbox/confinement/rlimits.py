"""Limits of the system on a process that runs already: `limits`, the layer that is everywhere on
Linux, and that holds for root as well.

They are set once the process has answered for the first time and before it sees a program: it has
opened then whatever it needs, so that it may open nothing more, and no socket either.
"""

from __future__ import annotations

import contextlib
import sys
from typing import Final

from sandbox.limits import Limits

_OVERHEAD: Final = 200_000_000
"""Bytes that the interpreter needs for itself: 180 MB of addresses, most of them never used."""
_FOR_EACH: Final = 4
"""Bytes of memory for each byte of a program's data as the interpreter counts it. Of programs that
take all they may, 1.2 was measured at most; what is freed is not at once given back."""
_CALL: Final = 0.001
"""Seconds of computing for a robot call, on a slow machine."""


def _seconds(limits: Limits) -> int:
    """Of computing. The interpreter ends a program long before; and what a program waits for does
    not count, so that a reception that goes on for days comes nowhere near."""
    return int(limits.total_computing + limits.computing + _CALL * limits.calls + 10)


def limit(process: int, limits: Limits | None = None, memory: int = 0) -> bool:
    """Limit a process: computing and memory to what `limits` say of a program's, else memory alone
    to so many bytes of data. Whether that is possible here."""
    if sys.platform != "linux":
        return False
    import resource

    data = _OVERHEAD + _FOR_EACH * (limits.memory if limits else memory)
    bounds = {
        resource.RLIMIT_CORE: 0,
        resource.RLIMIT_FSIZE: 0,
        resource.RLIMIT_NOFILE: 0,
        resource.RLIMIT_NPROC: 0,  # threads are counted, too; not so of root
        resource.RLIMIT_MEMLOCK: 0,
        resource.RLIMIT_MSGQUEUE: 0,
        resource.RLIMIT_DATA: data,
        resource.RLIMIT_AS: data,
    }
    if limits is not None:
        bounds[resource.RLIMIT_CPU] = _seconds(limits)
    for kind, most in bounds.items():
        with contextlib.suppress(ValueError):  # the system grants less already
            try:
                # At the first one for computing time the process is told, at the second killed.
                later = 5 if kind == resource.RLIMIT_CPU else 0
                resource.prlimit(process, kind, (most, most + later))
            except OSError:  # no such limit; not for us to set; the process is gone
                return False
    return True
