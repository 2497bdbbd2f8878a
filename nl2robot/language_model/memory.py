"""Giving memory back that was needed only to load a model.

While onnxruntime loads a graph, it copies the weights into the order in which it computes; the
mapped pages of the file that it has read them from stay counted as this process's. And what was
allocated on the way is kept by the C library for later. Together a seventh of what a model needs.
"""

from __future__ import annotations

import ctypes
import sys
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Final

_PAGEOUT: Final = 21
"""`MADV_PAGEOUT` (Linux 5.4): pages of a file are read again if they are needed after all, and what
was written to them is kept."""


def give_back(file: Path) -> None:
    """Give back the pages of a file that was mapped, and what is allocated and free. Where the
    system knows no such thing, nothing happens."""
    if sys.platform != "linux":
        return
    with suppress(OSError, AttributeError):  # another C library
        libc = ctypes.CDLL(None)
        libc.madvise.argtypes = (ctypes.c_void_p, ctypes.c_size_t, ctypes.c_int)
        for start, end in _mapped(file):
            libc.madvise(start, end - start, _PAGEOUT)
        libc.malloc_trim(0)


def _mapped(file: Path) -> Iterator[tuple[int, int]]:
    """Where a file is mapped into this process."""
    name = str(file.resolve())
    for line in Path("/proc/self/maps").read_text().splitlines():
        place, _, path = line.partition(" ")
        if path.endswith(name):
            start, end = place.split("-")
            yield int(start, 16), int(end, 16)
