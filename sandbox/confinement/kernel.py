"""What Linux offers and Python has no functions for."""

from __future__ import annotations

import ctypes
import functools
import os
import struct
from typing import Any, Final

_CLOSE_RANGE: Final = 436
_CLOSE_AT_EXEC: Final = 4
_NO_NEW_PRIVS: Final = 38
_CAPABILITIES_VERSION: Final = 0x20080522
CAP_DAC_READ_SEARCH: Final = 2


@functools.cache
def _library() -> Any:
    return ctypes.CDLL(None, use_errno=True)


def _checked(result: int) -> int:
    if result < 0:
        error = ctypes.get_errno()
        raise OSError(error, os.strerror(error))
    return result


def system_call(number: int, *arguments: int | bytes | None) -> int:
    """Raises `OSError`."""
    words = [ctypes.c_long(each) if isinstance(each, int) else each for each in arguments]
    function = _library().syscall
    function.restype = ctypes.c_long
    return _checked(function(ctypes.c_long(number), *words))


def no_new_privileges() -> None:
    """From now on no program that this thread starts has more rights than it. Raises `OSError`."""
    zero = ctypes.c_ulong(0)
    _checked(_library().prctl(_NO_NEW_PRIVS, ctypes.c_ulong(1), zero, zero, zero))


def keep_files() -> None:
    """Whatever is open here is closed in a program that is started, but for its input and output.
    Python sees to that by itself; not so libraries, nor whoever started us. Raises `OSError`."""
    system_call(_CLOSE_RANGE, 3, 0xFFFFFFFF, _CLOSE_AT_EXEC)


def set_capabilities(effective: int, permitted: int) -> None:
    """Root's rights of this thread, as sets of bits; none is inherited. Raises `OSError`."""
    low, high = 0xFFFFFFFF, 32
    header = struct.pack("=Ii", _CAPABILITIES_VERSION, 0)
    data = struct.pack(
        "=6I", effective & low, permitted & low, 0, effective >> high, permitted >> high, 0
    )
    _checked(_library().capset(header, data))


def permitted_capabilities() -> int:
    """Of this thread. Raises `OSError`."""
    header = struct.pack("=Ii", _CAPABILITIES_VERSION, 0)
    data = ctypes.create_string_buffer(24)
    _checked(_library().capget(header, data))
    _, low, _, _, high, _ = struct.unpack("=6I", data.raw)
    return int(low | high << 32)


def status(process: int | str) -> dict[str, str]:
    """What the system tells of a process, by its names. Raises `OSError`."""
    with open(f"/proc/{process}/status") as lines:  # noqa: PTH123 - quicker, at each start of a run
        told = (line.partition(":") for line in lines)
        return {name: value.strip() for name, _, value in told}
