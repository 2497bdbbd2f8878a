"""Starting a process behind the wall: a thread that gives up its rights, starts it, and ends."""

from __future__ import annotations

import contextlib
import gc
import os
import select
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Final, Generic, TypeVar

from sandbox.confinement import kernel, landlock, probe, seccomp

T = TypeVar("T")

LAYERS: Final = frozenset({"limits", "privileges", "landlock", "seccomp", "processes"})


def confined(
    start: Callable[[], T], programs: tuple[str, ...], layers: frozenset[str] = LAYERS
) -> tuple[T, frozenset[str]]:
    """What `start()` returns, and which of the `layers` hold for the processes that it has started:
    they and their threads may run the `programs`, and reach nothing but this process's answers.

    `start` runs on a thread of its own. It has to let go of Python's lock while it waits for the
    process to begin, and must import nothing, since it may read no file.
    """
    if sys.platform != "linux" or not layers - {"limits"}:
        return start(), frozenset()
    allowed = probe.survived()
    with _nothing_collected():
        thread = _Starting(start, programs, layers, allowed)
        thread.start()
        try:
            thread.answer()
        finally:
            thread.join()
    if thread.error is not None:
        raise thread.error
    return thread.result[0], frozenset(thread.held)


def holding(process: int, layers: frozenset[str]) -> frozenset[str]:
    """Those of the `layers` that `confined` told of, if the process is one that it has started: not
    if that has died meanwhile, and another was started in its place."""
    try:
        status, own = kernel.status(process), kernel.status("self")
    except OSError:
        return frozenset()
    if status.get("NoNewPrivs") == "0":
        return frozenset()
    if "seccomp" in layers and status.get("Seccomp_filters", "1") == own.get("Seccomp_filters"):
        return frozenset()
    return layers


_BEHIND, _STARTED = b"b", b"s"
"""What the thread tells: that it has given up its rights, and that it has started the process."""


class _Starting(threading.Thread, Generic[T]):
    def __init__(
        self,
        start: Callable[[], T],
        programs: tuple[str, ...],
        layers: frozenset[str],
        allowed: frozenset[str],
    ) -> None:
        super().__init__(name="sandbox", daemon=True)
        self._start_process = start
        self._programs = programs
        self._layers = layers
        self._allowed = allowed
        self._hear, self._tell = os.pipe()
        self._questions: seccomp.Questions | None = None
        self.held: set[str] = set()
        self.result: list[T] = []
        self.error: BaseException | None = None

    def run(self) -> None:
        try:
            self._give_up()
            os.write(self._tell, _BEHIND)
            self.result.append(self._start_process())
        except BaseException as error:  # noqa: BLE001 - raised again where it is waited for
            self.error = error
        finally:
            # In words: its end can be held open by a process that somebody forks meanwhile.
            with contextlib.suppress(OSError):
                os.write(self._tell, _STARTED)
            os.close(self._tell)

    def answer(self) -> None:
        """Say yes to what the thread wants to start, until it has ended."""
        with contextlib.ExitStack() as stack:
            stack.callback(os.close, self._hear)
            if os.read(self._hear, 1) != _BEHIND:
                return
            waiting = select.poll()
            waiting.register(self._hear, select.POLLIN)
            if self._questions is not None:
                stack.enter_context(self._questions)
                waiting.register(self._questions.handle, select.POLLIN)
            while self._hear not in dict(waiting.poll()):
                assert self._questions is not None
                self._questions.allow()

    def _give_up(self) -> None:
        """As many rights as the system lets us give up."""
        if "files" in self._allowed:
            with contextlib.suppress(OSError):
                kernel.keep_files()
        with contextlib.suppress(OSError):
            kernel.no_new_privileges()
            self._try("landlock", self._no_files)
            self._try("privileges", self._no_privileges)
            self._try("seccomp", self._no_calls)

    def _try(self, layer: str, give_up: Callable[[], None]) -> None:
        if layer in self._layers & self._allowed:
            with contextlib.suppress(OSError):
                give_up()
                self.held.add(layer)

    def _no_files(self) -> None:
        landlock.restrict(self._programs)

    def _no_privileges(self) -> None:
        had = kernel.permitted_capabilities()
        kernel.set_capabilities(0, had)
        kept = 0
        try:
            for program in self._programs:
                os.close(os.open(program, os.O_RDONLY))
        except PermissionError:
            # Root started it from a folder of somebody else's.
            kept = had & 1 << kernel.CAP_DAC_READ_SEARCH
        kernel.set_capabilities(0, kept)

    def _no_calls(self) -> None:
        self._questions = seccomp.restrict("processes" in self._layers)
        if self._questions is not None:
            self.held.add("processes")


_COLLECTING = threading.Lock()
_starting = 0
_collected = True


@contextlib.contextmanager
def _nothing_collected() -> Iterator[None]:
    """Python tidies up on whatever thread is running, and one without rights cannot remove a file.
    It waits for the milliseconds that a start takes."""
    global _starting, _collected
    with _COLLECTING:
        if _starting == 0:
            _collected = gc.isenabled()
            gc.disable()
        _starting += 1
    try:
        yield
    finally:
        with _COLLECTING:
            _starting -= 1
            if _starting == 0 and _collected:
                gc.enable()
