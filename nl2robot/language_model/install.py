"""From a GGUF file to the files that a model is loaded from, once, when it is installed."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from nl2robot.language_model.files import GRAPH, LEVELS, SCALES, TOKENS
from nl2robot.language_model.graph import write_graph
from nl2robot.language_model.tokens import Tokens
from nl2robot.language_model.weights import GgufFile, Unreadable

__all__ = ["Unreadable", "install"]


def install(gguf: Path, folder: Path) -> None:
    """Write the files of `files.FILES` into a folder; takes half a minute and, for a while, about
    twice the file's size in memory. Raises `weights.Unreadable` and `OSError`."""
    file = GgufFile(gguf)
    tokens = Tokens.of(file.vocabulary.tokens, file.vocabulary.special)
    tokens.save(folder / TOKENS)
    embeddings = file.eight_bits("token_embd.weight")
    np.save(folder / LEVELS, embeddings.levels.reshape(embeddings.rows, embeddings.columns))
    np.save(folder / SCALES, embeddings.scales)
    write_graph(file, tokens.written, folder / GRAPH)
