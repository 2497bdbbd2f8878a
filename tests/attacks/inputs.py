"""What is fed with inputs that are nearly right, in the process that reads them.

target = Target("worlds", make, feed)
case = target.make(random.Random(7))
target.feed(case)        # raises what nobody who hands in a file should meet
"""

from __future__ import annotations

import atexit
import functools
import random
import shutil
import tempfile
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from sim.world.yaml_nodes import FileProblems
from tests.attacks.outcome import what_is_no_sentence

LANGUAGES: Final = ("en", "de", "fr")
_SOME: Final = 16
"""One of so many is also put to what comes after reading it and takes its time."""


class Unfit(AssertionError):
    """An answer that is none for people."""


@dataclass(frozen=True)
class Case:
    """An input."""

    data: str | bytes
    how: str = ""
    """What it is read as: a language, a kind of robot."""

    def __str__(self) -> str:
        told = ascii(self.data)
        told = told if len(told) <= 700 else f"{told[:600]} ... ({len(self.data)} in all)"
        return f"{self.how} {told}".strip()


@dataclass(frozen=True)
class Target:
    """Somebody who reads them."""

    name: str
    make: Callable[[random.Random], Case]
    feed: Callable[[Case], None]
    share: int
    """Of a million inputs."""


def is_chosen(case: Case, one_of: int = _SOME) -> bool:
    """Whether this is one of the few; the same for the same case."""
    data = case.data.encode("utf-8", "replace") if isinstance(case.data, str) else case.data
    return zlib.crc32(data) % one_of == 0


def sentence(text: str | None) -> None:
    """Raises `Unfit` if it is none."""
    wrong = what_is_no_sentence(text)
    if wrong is not None:
        raise Unfit(wrong)


def problems(error: FileProblems) -> None:
    """Raises `Unfit` if one of them is not told in a sentence."""
    if not error.problems:
        raise Unfit("refused, and nothing is said to be wrong")
    for each in error.problems:
        sentence(each.message)


@functools.cache
def folder() -> Path:
    """One of this process, in memory where there is such."""
    memory = Path("/dev/shm")
    made = tempfile.mkdtemp(prefix="attacks", dir=memory if memory.is_dir() else None)
    atexit.register(shutil.rmtree, made, ignore_errors=True)
    return Path(made)


def file(name: str, data: str | bytes) -> Path:
    """A file with this in it."""
    path = folder() / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode("utf-8", "surrogatepass"))
    return path
