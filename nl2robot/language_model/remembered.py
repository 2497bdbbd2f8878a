"""What a model has read before every sentence, kept on disk: reading it again would take a minute.

One file for each text and model, in the user's cache folder. A file that cannot be read, or is of
another model, is made anew; nothing depends on it but time.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
import zipfile
from contextlib import suppress
from pathlib import Path

import numpy as np

from nl2robot.language_model.files import GRAPH
from nl2robot.language_model.model import Branch, OnnxModel
from nl2robot.paths import cache_folder

MOST_KEPT = 4
"""Files that are kept: the oldest go."""


def remembered(model: OnnxModel, folder: Path, text: str) -> Branch:
    """The branch behind `text`, which is all that the model then remembers. Raises `Cancelled`."""
    tokens = model.tokens.encode(text, control=True)
    file = _file(folder, text)
    model.forget(0)
    with suppress(OSError, KeyError, ValueError, EOFError, zipfile.BadZipFile):
        with np.load(file) as kept:
            model.restore(dict(kept), len(tokens))
        os.utime(file)
        return Branch(tuple(tokens), ((0, len(tokens)),))
    model.forget(0)
    [branch] = model.read([(Branch(), tokens)])
    with suppress(OSError):  # a full disk costs time, and nothing else
        _keep(model, file, len(tokens))
    return branch


def _file(folder: Path, text: str) -> Path:
    """Where it is kept, by the text and by which model it is."""
    graph = (folder / GRAPH).stat()
    which = f"{folder.resolve()} {graph.st_size} {graph.st_mtime_ns} {text}"
    return cache_folder() / f"read-{hashlib.sha256(which.encode()).hexdigest()[:20]}.npz"


def _keep(model: OnnxModel, file: Path, rows: int) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    newest = sorted(file.parent.glob("read-*.npz"), key=lambda each: -each.stat().st_mtime)
    for old in newest[MOST_KEPT - 1 :]:
        old.unlink(missing_ok=True)
    handle, name = tempfile.mkstemp(dir=file.parent, prefix=".read-")
    try:
        with os.fdopen(handle, "wb") as unfinished:
            np.savez(unfinished, allow_pickle=False, **model.kept(rows))
        Path(name).replace(file)
    except OSError:
        Path(name).unlink(missing_ok=True)
        raise
