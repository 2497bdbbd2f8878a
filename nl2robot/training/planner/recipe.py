"""How the language model learns: the numbers that were tried out (README.md says how), and where
what comes of it is kept."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Final

import msgspec

from nl2robot.paths import data_file


class Recipe(msgspec.Struct, frozen=True):
    passes: int = 3
    """Over the corpus."""
    noisy: float = 0.2
    """The share of sentences that are shown as heard or as typed."""
    rank: int = 16
    """Of the changes to each product (LoRA); they count twice (`language_model.changes.SCALE`)."""
    dropped: float = 0.2
    """The share of a change's inputs that is left out at each step."""
    at_once: int = 4096
    """Tokens that are read for one step."""
    fastest: float = 8e-4
    """The learning rate at its highest; it falls as a cosine."""
    warm: float = 0.05
    """The share of all steps in which it rises."""
    decay: float = 0.01
    """Of weights (AdamW)."""
    seed: int = 0


RECIPE: Final = Recipe()


@dataclass(frozen=True)
class Kept:
    """The files of one training, in a folder of their own."""

    folder: Path

    @property
    def examples(self) -> Path:
        """`example.Examples`."""
        return self.folder / "examples.msgpack"

    @property
    def state(self) -> Path:
        """From what an interrupted training goes on."""
        return self.folder / "state.pt"

    @property
    def learned(self) -> Path:
        """A file of `language_model.changes`; there once everything was learned."""
        return self.folder / "learned.npz"

    @property
    def course(self) -> Path:
        """How it went: `course.Course`."""
        return self.folder / "course.json"

    @property
    def evaluated(self) -> Path:
        """What became of each held-out sentence, a line for each."""
        return self.folder / "evaluated.jsonl"


def usual_folder(model: str) -> Path:
    """Where a training is kept unless somebody says otherwise; need not be there."""
    return data_file("training") / model
