"""The process of a program: ended at any moment, and watched."""

from __future__ import annotations

import os
import select
import signal
import threading
from collections.abc import Callable
from typing import Final

_INTERRUPTING: Final = (signal.SIGINT, signal.SIGTERM, getattr(signal, "SIGHUP", None))


class Process:
    """The process of a program, held so that no other process can be hit when it is gone."""

    def __init__(self, pid: int, died: Callable[[bool], None]) -> None:
        """`died(interrupted)` is called when it has ended, where the system tells of that (on
        Linux)."""
        self._pid = pid
        self._handle = os.pidfd_open(pid) if hasattr(os, "pidfd_open") else None
        self._watch: threading.Thread | None = None
        if self._handle is not None:
            self._watch = threading.Thread(
                target=_when_readable, args=(self._handle, died), name="program", daemon=True
            )
            self._watch.start()

    def kill(self) -> None:
        try:
            if self._handle is not None:
                signal.pidfd_send_signal(self._handle, signal.SIGKILL)
            else:
                os.kill(self._pid, getattr(signal, "SIGKILL", signal.SIGTERM))
        except (ProcessLookupError, PermissionError):
            pass  # it is gone already

    def close(self) -> None:
        """After `kill`."""
        if self._handle is not None:
            if self._watch is not None and self._watch is not threading.current_thread():
                self._watch.join()
            os.close(self._handle)
            self._handle = None


def _when_readable(handle: int, died: Callable[[bool], None]) -> None:
    """A process is gone when its handle can be read."""
    waiting = select.poll()
    waiting.register(handle, select.POLLIN)
    waiting.poll()
    try:
        how = os.waitid(os.P_PIDFD, handle, os.WEXITED | os.WNOWAIT | os.WNOHANG)
    except ChildProcessError:  # somebody has asked before
        how = None
    died(how is not None and how.si_code == os.CLD_KILLED and how.si_status in _INTERRUPTING)
