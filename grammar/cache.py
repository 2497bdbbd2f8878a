"""Work that is done once and kept on disk: a compiled language.

What is kept is plain data in the user's cache folder, under a name that holds a hash of all it was
made from. It is never needed: where there is no such folder, or what is in it cannot be read, the
work is done again.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import sys
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Final, TypeVar

import msgspec

MOST_KEPT: Final = 8
"""Of the same name."""

_Kept = TypeVar("_Kept")


def kept(
    name: str, made_from: Iterable[bytes], kind: type[_Kept], make: Callable[[], _Kept]
) -> _Kept:
    """What `make` gives, from the disk if it was made from the same before. `kind` is its type, of
    which `msgspec` can read and write every part."""
    digest = hashlib.sha256(f"{sys.version} {msgspec.__version__}".encode())
    for source in made_from:
        digest.update(hashlib.sha256(source).digest())
    folder = _folder()
    if folder is None:
        return make()
    file = folder / f"{name}-{digest.hexdigest()[:32]}.msgpack"
    with contextlib.suppress(OSError, msgspec.DecodeError):
        return msgspec.msgpack.decode(file.read_bytes(), type=kind)
    made = make()
    with contextlib.suppress(OSError):
        _write(file, msgspec.msgpack.encode(made))
        _clear(folder.glob(f"{name}-*.msgpack"))
    return made


def _clear(files: Iterable[Path]) -> None:
    """Delete all but the newest: other copies of this program may keep theirs here, too."""
    newest = sorted(files, key=lambda file: file.stat().st_mtime, reverse=True)
    for file in newest[MOST_KEPT:]:
        file.unlink(missing_ok=True)


def _folder() -> Path | None:
    """Where things are kept; None where there is nowhere."""
    from platformdirs import user_cache_path

    try:
        return user_cache_path("nl2robot")
    except (OSError, RuntimeError):
        return None


def _write(file: Path, data: bytes) -> None:
    """Write a file that others see whole or not at all, whenever this stops."""
    file.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=file.parent, prefix=file.stem)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(data)
        Path(name).replace(file)
    except OSError:
        Path(name).unlink(missing_ok=True)
        raise
