"""A server whose clock on the wall jumps when somebody says so.

    python -m tests.attacks.clock FILE serve ...

As far as Python sees it: `time.time`, `time.time_ns` and `datetime.now` are ahead by as many
seconds as stand in the file. The clock that nobody sets, `time.monotonic`, goes on as it does.
"""

from __future__ import annotations

import copyreg
import datetime
import mmap
import struct
import sys
import time
from pathlib import Path
from typing import Any

_DOUBLE = struct.Struct("<d")


def set_clock(file: Path, seconds: float) -> None:
    """How far it is ahead from now on; behind, if this is negative."""
    with file.open("r+b" if file.exists() else "w+b") as written:
        written.write(_DOUBLE.pack(seconds))


def _patch(file: Path) -> None:
    with file.open("r+b") as opened:
        ahead = mmap.mmap(opened.fileno(), _DOUBLE.size)
    real = time.time

    def now() -> float:
        return real() + float(_DOUBLE.unpack(ahead[:])[0])

    class Kind(type):
        def __instancecheck__(cls, instance: object) -> bool:  # those that C makes are of the other
            return isinstance(instance, other)

    other: Any = datetime.datetime

    class Jumping(other, metaclass=Kind):  # type: ignore[misc]
        @classmethod
        def now(cls, tz: datetime.tzinfo | None = None) -> Any:
            return other.fromtimestamp(now(), tz)

        @classmethod
        def today(cls) -> Any:
            return other.fromtimestamp(now())

        @classmethod
        def utcnow(cls) -> Any:
            return other.fromtimestamp(now(), datetime.UTC).replace(tzinfo=None)

    time.time = now
    time.time_ns = lambda: int(now() * 1e9)
    datetime.datetime = Jumping  # type: ignore[misc]
    for kind in (other, Jumping):  # what goes to another process is looked for by its name
        copyreg.pickle(kind, _as_text)


def _as_text(moment: datetime.datetime) -> tuple[Any, ...]:
    return eval, (f"__import__('datetime').datetime.fromisoformat({moment.isoformat()!r})",)


def main() -> None:
    file, *arguments = sys.argv[1:]
    _patch(Path(file))
    from nl2robot.cli import main as cli

    sys.exit(cli.main(arguments))


if __name__ == "__main__":
    main()
