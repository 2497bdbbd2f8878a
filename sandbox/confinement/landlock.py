"""Landlock: what files a thread and all that it starts may reach.

Nothing may be written, and nothing read but the interpreter and the libraries that it is made of;
no TCP from Linux 6.7 on, no signals and no hidden sockets to others from 6.12 on.
"""

from __future__ import annotations

import os
import struct
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Final

from sandbox.confinement import kernel

# The same numbers on all machines.
_CREATE_RULESET: Final = 444
_ADD_RULE: Final = 445
_RESTRICT_SELF: Final = 446
_ASK_VERSION: Final = 1
_BENEATH_PATH: Final = 1

_EXECUTE: Final = 1 << 0
_READ_FILE: Final = 1 << 2
_RIGHTS: Final = {1: 13, 2: 14, 3: 15, 4: 15}
"""How many rights on files a version knows; those after the last one know 16."""
_TCP: Final = 0b11
_OTHERS: Final = 0b11

LIBRARIES: Final = (
    *("/lib", "/lib64", "/usr/lib", "/usr/lib64", "/usr/local/lib"),
    *("/etc/ld.so.cache", "/nix/store", "/gnu/store"),
)
"""Where the parts of a program are, on the systems we know of."""


def version() -> int:
    """Of Landlock in this kernel; 0 where there is none."""
    try:
        return kernel.system_call(_CREATE_RULESET, None, 0, _ASK_VERSION)
    except OSError:
        return 0


def restrict(programs: Iterable[str], readable: Iterable[str] = LIBRARIES) -> None:
    """For this thread and what it starts, for good: `programs` may be read and started, `readable`
    files and folders be read. Raises `OSError`. Needs `kernel.no_new_privileges`."""
    known = version()
    files = (1 << _RIGHTS.get(known, 16)) - 1
    handled = [files, *([_TCP] if known >= 4 else []), *([_OTHERS] if known >= 6 else [])]
    attributes = struct.pack(f"={len(handled)}Q", *handled)
    rules = kernel.system_call(_CREATE_RULESET, attributes, len(attributes), 0)
    try:
        for path in [*programs, *loaders()]:
            _allow(rules, path, _READ_FILE | _EXECUTE)
        for path in readable:
            _allow(rules, path, _READ_FILE)
        kernel.system_call(_RESTRICT_SELF, rules, 0)
    finally:
        os.close(rules)


def _allow(rules: int, path: str, rights: int) -> None:
    try:
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return  # another system has its libraries elsewhere
    try:
        kernel.system_call(_ADD_RULE, rules, _BENEATH_PATH, struct.pack("=Qi", rights, place), 0)
    finally:
        os.close(place)


def loaders() -> Iterator[str]:
    """What puts a program together, and is started in its place: ld-linux-x86-64.so.2 and its
    like."""
    for folder in ("/lib", "/lib64"):
        yield from (str(path) for path in Path(folder).glob("ld-*.so*"))
