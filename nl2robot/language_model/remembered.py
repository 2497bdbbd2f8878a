"""What a model has read before every sentence, kept on disk: reading it again would take a minute.

One file for each text, model and what the model has learned, in the user's cache folder. A file
that cannot be read, or is of another model, is made anew; nothing depends on it but time.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
import time
import zipfile
from contextlib import suppress
from pathlib import Path
from typing import Final

import numpy as np

from nl2robot.language_model.files import GRAPH
from nl2robot.language_model.model import Branch, OnnxModel
from nl2robot.paths import cache_folder

MOST_KEPT: Final = 4
"""Files that are kept: the oldest go."""
ABANDONED: Final = 600.0
"""Seconds after which a file that is not finished never will be: who wrote it was killed."""
_DAMAGED: Final = (
    *(OSError, EOFError, zipfile.BadZipFile, KeyError, TypeError, ValueError, MemoryError),
    RuntimeError,  # what calls itself encrypted, or of a version yet to come
)
"""What reading a file comes to in which any bit may be wrong."""


def remembered(model: OnnxModel, folder: Path, text: str) -> Branch:
    """The branch behind `text`, which is all that the model then remembers. Raises `Cancelled`."""
    tokens = model.tokens.encode(text, control=True)
    file = _file(model, folder, text)
    model.forget(0)
    with suppress(*_DAMAGED):
        with np.load(file) as kept:
            rows = dict(kept)
        if any(each.shape[2:3] != (len(tokens),) for each in rows.values()):
            raise ValueError("of another text")
        model.restore(rows, len(tokens))
        with suppress(OSError):  # it may belong to somebody else
            os.utime(file)
        return Branch(tuple(tokens), ((0, len(tokens)),))
    model.forget(0)
    [branch] = model.read([(Branch(), tokens)])
    with suppress(OSError, MemoryError):  # a full disk costs time, and nothing else
        _keep(model, file, len(tokens))
    return branch


def _file(model: OnnxModel, folder: Path, text: str) -> Path:
    """Where it is kept, by the text, by which model it is and by what it has learned."""
    graph = (folder / GRAPH).stat()
    which = hashlib.sha256(f"{folder.resolve()} {graph.st_size} {graph.st_mtime_ns} ".encode())
    for name, learned in sorted(model._learned.items()):
        which.update(name.encode())
        which.update(learned.numpy())
    which.update(text.encode())
    return cache_folder() / f"read-{which.hexdigest()[:20]}.npz"


def _keep(model: OnnxModel, file: Path, rows: int) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    newest = sorted(file.parent.glob("read-*.npz"), key=lambda each: -each.stat().st_mtime)
    for old in newest[MOST_KEPT - 1 :]:
        old.unlink(missing_ok=True)
    for half in file.parent.glob(".read-*"):
        if half.stat().st_mtime < time.time() - ABANDONED:
            half.unlink(missing_ok=True)
    handle, name = tempfile.mkstemp(dir=file.parent, prefix=".read-")
    try:
        with os.fdopen(handle, "wb") as unfinished:
            np.savez(unfinished, allow_pickle=False, **model.kept(rows))
        Path(name).replace(file)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise
