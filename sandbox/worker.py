"""A process of Monty's, begun behind the wall of `sandbox.confinement`, where there is one."""

from __future__ import annotations

import os
import threading
from collections.abc import Callable
from typing import Final

import pydantic_monty as monty
from pydantic_monty._binary import find_monty_binary

from robot_api.errors import cause
from sandbox import confinement
from sandbox.limits import Limits

FAILURES: Final = (monty.MontyError, RuntimeError, OSError)
"""What the start of a process may end with."""


class Unavailable(Exception):
    """The interpreter does not start on this machine."""


class Worker:
    """One process, and the first session in it. Raises one of `FAILURES` if it does not start."""

    def __init__(
        self,
        check_out: Callable[[monty.Monty], monty.MontySession],
        *,
        limits: Limits | None = None,
        memory: int = 0,
        request_timeout: float | None = None,
    ) -> None:
        """`check_out(pool)` opens the session. The process may use what `limits` say of a program,
        else `memory` bytes of data."""
        self._check_out = check_out
        self._limits = limits
        self._memory = memory
        self._request_timeout = request_timeout
        self._in_session = False
        self.pool: monty.Monty
        self.session: monty.MontySession
        self.process: int
        self.layers: frozenset[str] = frozenset()
        """Those of `confinement.LAYERS` that hold."""
        try:
            self._begin(confinement.LAYERS)
        except FAILURES:
            # A system that we do not know. Nothing of a program has been told to it, and a run
            # never fails for its second wall.
            self._begin(frozenset())

    def _begin(self, layers: frozenset[str]) -> None:
        program = _prepared(os.getpid(), os.environ.get("MONTY_BIN"))
        self.pool = monty.Monty(
            binary_path=program, max_processes=1, request_timeout=self._request_timeout
        )
        try:
            _, held = confinement.confined(self.pool.__enter__, (program,), layers)
            self.session = self._check_out(self.pool)
            self.session.__enter__()
            self._in_session = True
            process = self.session.worker_pid
            assert process is not None
            self.process = process
            held = confinement.holding(process, held)
            # In any case: nothing starts more easily without.
            if confinement.limit(process, self._limits, self._memory):
                held |= {"limits"}
            self.layers = held
        except BaseException:
            self.close()
            raise

    def leave(self) -> None:
        """End the session; the pool can open others."""
        self._in_session = False
        self.session.__exit__(None, None, None)

    def close(self) -> None:
        if self._in_session:
            self.leave()
        self.pool.__exit__(None, None, None)


_PREPARING: Final = threading.Lock()
_found: dict[tuple[int, str | None], str] = {}


def _prepared(host: int, named: str | None) -> str:
    """The interpreter's program, looked for once by each process (`host`), and by one thread at a
    time, which Python's own search for it wants. Monty has started the threads then that it keeps:
    one that it starts behind the wall would stay there."""
    with _PREPARING:
        if (host, named) not in _found:
            program = find_monty_binary()
            with monty.Monty(binary_path=program, min_processes=0):
                pass
            _found[host, named] = program
        return _found[host, named]


def layers() -> frozenset[str]:
    """Which layers hold here, found out by starting a process. Raises `Unavailable`."""
    try:
        worker = Worker(lambda pool: pool.checkout())
    except FAILURES as error:
        raise Unavailable(cause(error)) from error
    worker.close()
    return worker.layers
