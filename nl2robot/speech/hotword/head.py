"""A head: how surely the last second of speech embeddings ends with a word. Plain numpy.

Heads are trained by `nl2robot.training.hotword.training`. Those of the default words come with
nl2robot; those for words of one's own lie in the user's data folder.
"""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.paths import PACKAGED, data_file
from nl2robot.speech.embeddings import SIZE, Embeddings

SHIPPED: Final = PACKAGED / "hotwords"


@dataclass(frozen=True, eq=False)
class Head:
    """A network of one hidden layer over the last `steps` embeddings."""

    word: str
    threshold: float
    """Scores above it are the word."""
    weights: tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any]]
    """Of the hidden layer (steps * 96, hidden), its bias, of the score (hidden, 1), its bias."""

    @property
    def steps(self) -> int:
        return len(self.weights[0]) // SIZE

    def scores(self, embeddings: Embeddings) -> NDArray[np.float32]:
        """For each embedding from the `steps`-th on: how surely the word ends there, 0 to 1."""
        windows = np.lib.stride_tricks.sliding_window_view(embeddings, self.steps, axis=0)
        inputs = windows.transpose(0, 2, 1).reshape(len(windows), -1)
        return probability(forward(self.weights, inputs)[1])

    def save(self, folder: Path) -> Path:
        """As a file of this folder, half precision: what it loses is far below what matters."""
        names = ("hidden", "hidden_bias", "score", "score_bias")
        weights = {name: w.astype(np.float16) for name, w in zip(names, self.weights, strict=True)}
        path = folder / file_name(self.word)
        np.savez_compressed(path, threshold=np.float32(self.threshold), **weights)  # type: ignore[arg-type]
        return path


def forward(
    weights: tuple[NDArray[Any], ...], inputs: NDArray[Any]
) -> tuple[NDArray[Any], NDArray[Any]]:
    """The hidden layer and the score, before it becomes a probability."""
    hidden, hidden_bias, score, score_bias = weights
    layer = np.maximum(inputs @ hidden + hidden_bias, 0)
    return layer, (layer @ score + score_bias)[:, 0]


def probability(scores: NDArray[Any]) -> NDArray[np.float32]:
    return np.asarray(1 / (1 + np.exp(-np.clip(scores, -30, 30))), np.float32)


def load_head(language: str, word: str) -> Head | None:
    """The head of this word, if there is one; the user's own before ours."""
    for folder in (data_file("hotwords"), SHIPPED):
        path = folder / language / file_name(word)
        if path.is_file():
            with np.load(path, allow_pickle=False) as file:
                weights = [file[n] for n in ("hidden", "hidden_bias", "score", "score_bias")]
                first, second, third, fourth = (w.astype(np.float32) for w in weights)
                return Head(word, float(file["threshold"]), (first, second, third, fourth))
    return None


def file_name(word: str) -> str:
    """Of plain letters: "arrête" lies in arrete.npz."""
    letters = unicodedata.normalize("NFKD", word.lower()).encode("ascii", "ignore").decode()
    return "-".join(re.findall(r"\w+", letters)) + ".npz"
