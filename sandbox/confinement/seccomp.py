"""Seccomp: which system calls a thread and all that it starts may make.

What is not in the list does not exist for them (ENOSYS), which C libraries are prepared for. To
start a process or a program is asked of us instead: `Questions` says yes while the interpreter is
being started, and when it is closed the system says no by itself, for good.
"""

from __future__ import annotations

import contextlib
import ctypes
import errno
import functools
import os
import platform
import struct
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final, Self

from sandbox.confinement import kernel
from sandbox.confinement.calls import AARCH64, ASKED, NUMBERS, X86_64

if sys.platform != "win32":
    import fcntl

# --- which arguments ---------------------------------------------------------------------------

# The numbers are those of <linux/*.h>.
_THREAD: Final = 0x10000
_WRITING: Final = 0o3 | 0o100 | 0o1000 | 0o20000000  # and O_CREAT, O_TRUNC, O_TMPFILE
_PROT_WRITE, _PROT_EXEC, _MAP_ANONYMOUS = 2, 4, 0x20
_FCNTL: Final = (0, 1, 2, 3, 4, 1030)  # F_DUPFD ... F_SETFL, F_DUPFD_CLOEXEC; no F_SETOWN
_IOCTL: Final = (0x5401, 0x5413, 0x5421, 0x5451)  # TCGETS, TIOCGWINSZ, FIONBIO, FIOCLEX
_PRCTL: Final = (15, 16, 0x53564D41)  # PR_SET_NAME, PR_GET_NAME, PR_SET_VMA

# --- as a filter ---------------------------------------------------------------------------------

_ALLOW: Final = 0x7FFF0000
_ASK: Final = 0x7FC00000
_ERROR: Final = 0x00050000
_ABSENT: Final = _ERROR | errno.ENOSYS
_FORBIDDEN: Final = _ERROR | errno.EPERM

_NUMBER, _KIND, _ARGUMENTS = 0, 4, 16
"""Where in what a filter looks at."""

_Lines = list[tuple[int, int, int, int]]


@dataclass(frozen=True)
class _Machine:
    column: int
    audit: int
    """The system's number for the kind of machine."""
    seccomp: int
    """The number of the call."""


_MACHINES: Final = {
    "x86_64": _Machine(X86_64, 0xC000003E, 317),
    "aarch64": _Machine(AARCH64, 0xC00000B7, 277),
}


def machine() -> _Machine | None:
    """None where the numbers of the calls are not known here, or programs have 32 bits."""
    return _MACHINES.get(platform.machine()) if sys.maxsize > 2**32 else None


def _load(place: int) -> _Lines:
    return [(0x20, 0, 0, place)]


def _argument(position: int, high: bool = False) -> _Lines:
    return _load(_ARGUMENTS + 8 * position + (4 if high else 0))


def _say(answer: int) -> _Lines:
    return [(0x06, 0, 0, answer)]


def _if_is(value: int, then: _Lines) -> _Lines:
    return [(0x15, 0, len(then), value), *then]


def _if_any(bits: int, then: _Lines) -> _Lines:
    return [(0x45, 0, len(then), bits), *then]


def _one_of(position: int, values: Iterable[int]) -> _Lines:
    known = [line for value in values for line in _if_is(value, _say(_ALLOW))]
    return [*_argument(position), *known, *_say(_FORBIDDEN)]


def _nothing_written(flags: int) -> _Lines:
    return [*_argument(flags), *_if_any(_WRITING, _say(_FORBIDDEN)), *_say(_ALLOW)]


def _no_code_made(column: int, anonymous: bool) -> _Lines:
    """Memory that can be written is never run, nor is any that does not come from a file. Arm marks
    code by a second `mprotect` of it."""
    lines: _Lines = []
    if anonymous:  # mmap(address, length, protection, flags ...)
        no_file = [*_argument(3), *_if_any(_MAP_ANONYMOUS, _say(_FORBIDDEN))]
        lines = [*_argument(2), *_if_any(_PROT_EXEC, no_file)]
    elif column == X86_64:  # mprotect(address, length, protection)
        lines = [*_argument(2), *_if_any(_PROT_EXEC, _say(_FORBIDDEN))]
    both = _if_any(_PROT_WRITE, _say(_FORBIDDEN))
    return [*lines, *_argument(2), *_if_any(_PROT_EXEC, both), *_say(_ALLOW)]


def _limits_only_read() -> _Lines:
    """prlimit64(process, kind, new, old) without a new one."""
    read = [*_argument(2, high=True), *_if_is(0, _say(_ALLOW))]
    return [*_argument(2), *_if_is(0, read), *_say(_FORBIDDEN)]


@functools.cache
def _filter(of: _Machine, asking: bool) -> bytes:
    asked = _ASK if asking else _ALLOW
    column = of.column
    conditions: dict[str, _Lines] = {
        **dict.fromkeys(ASKED, _say(asked)),
        "clone": [*_argument(0), *_if_any(_THREAD, _say(_ALLOW)), *_say(asked)],
        "open": _nothing_written(1),
        "openat": _nothing_written(2),
        "mmap": _no_code_made(column, anonymous=True),
        "mprotect": _no_code_made(column, anonymous=False),
        "fcntl": _one_of(1, _FCNTL),
        "ioctl": _one_of(1, _IOCTL),
        "prctl": _one_of(0, _PRCTL),
        "prlimit64": _limits_only_read(),
    }
    lines = [
        # Programs of another kind of machine count their calls otherwise.
        *_load(_KIND),
        (0x15, 1, 0, of.audit),
        *_say(_ABSENT),
        *_load(_NUMBER),
    ]
    for name, numbers in NUMBERS.items():
        number = numbers[column]
        if number is not None:
            lines += _if_is(number, conditions.get(name, _say(_ALLOW)))
    lines += _say(_ABSENT)
    return b"".join(struct.pack("=HBBI", *line) for line in lines)


_SET_FILTER: Final = 1
_NEW_LISTENER: Final = 1 << 3


def restrict(asking: bool) -> Questions | None:
    """For this thread and what it starts, for good. Raises `OSError`. Needs
    `kernel.no_new_privileges`. None: nobody is asked, or this kernel cannot ask, so that starting a
    process is allowed."""
    of = machine()
    if of is None:
        raise OSError(errno.ENOSYS, "The system calls of this machine are not known")
    if asking:
        with contextlib.suppress(OSError):  # before Linux 5.5, or somebody is asked already
            return Questions(_install(of, asking=True))
    _install(of, asking=False)
    return None


def _install(of: _Machine, asking: bool) -> int:
    code = ctypes.create_string_buffer(_filter(of, asking))
    program = struct.pack("HxxxxxxQ", (len(code) - 1) // 8, ctypes.addressof(code))
    return kernel.system_call(of.seccomp, _SET_FILTER, _NEW_LISTENER if asking else 0, program)


# --- what is asked -------------------------------------------------------------------------------

_QUESTION: Final = struct.Struct("=QII64x")  # its number, the process, flags, the call
_RECEIVE: Final = 0xC0502100
_ANSWER: Final = 0xC0182101
_GO_ON: Final = 1


class Questions:
    """Where the system asks whether a process or a program may be started."""

    def __init__(self, handle: int) -> None:
        self.handle = handle

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        os.close(self.handle)

    def allow(self) -> None:
        """Say yes to what is asked; to be called when the handle can be read."""
        question = bytearray(_QUESTION.size)
        try:
            fcntl.ioctl(self.handle, _RECEIVE, question)
            number = _QUESTION.unpack(question)[0]
            fcntl.ioctl(self.handle, _ANSWER, struct.pack("=QqiI", number, 0, 0, _GO_ON))
        except FileNotFoundError:
            pass  # whoever asked is gone
