"""Which rights may be given up here without being killed for the attempt.

A service manager may have a list of system calls, and kill whoever makes another one: systemd's
`@system-service` of version 252 lacks those that a wall is made of. So each step is tried out
first, where there is such a list, by a process that nobody misses.
"""

from __future__ import annotations

import functools
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final

from sandbox.confinement import kernel, landlock, seccomp

STEPS: Final[dict[str, Callable[[], object]]] = {
    "files": kernel.keep_files,
    "landlock": lambda: landlock.restrict(()),
    "privileges": lambda: kernel.set_capabilities(0, 0),
    "seccomp": lambda: seccomp.restrict(asking=False),
}
_PATIENCE: Final = 30.0


def survived() -> frozenset[str]:
    """Those of the `STEPS` that may be tried in this process."""
    try:
        listed = kernel.status("self").get("Seccomp") == "2"
    except OSError:  # /proc is hidden
        listed = True
    return _tried(os.getpid()) if listed else frozenset(STEPS)


@functools.cache
def _tried(host: int) -> frozenset[str]:
    folder = str(Path(__file__).parents[2])
    program = (
        f"import sys; sys.path.insert(0, {folder!r}); "
        "from sandbox.confinement import probe; probe.main()"
    )
    try:
        done = subprocess.run(
            [sys.executable, "-c", program],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            timeout=_PATIENCE,
            text=True,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return frozenset()
    return frozenset(done.stdout.split()) & STEPS.keys()


def main() -> None:
    """Print the names of the steps that one gets over."""
    for name, step in STEPS.items():
        if survives(step):
            print(name)


def survives(step: Callable[[], object]) -> bool:
    """Whether one who takes the step, or is refused it, lives on. Only for a process that has one
    thread."""
    child = os.fork()
    if child == 0:
        status = 0
        try:
            kernel.no_new_privileges()
            step()
        except OSError:
            pass
        except BaseException:  # noqa: BLE001 - nobody is there to be told
            status = 1
        os._exit(status)
    return os.waitpid(child, 0)[1] == 0
