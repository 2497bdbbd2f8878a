"""The file that training reads: examples as tokens, so that a machine that trains needs neither
the grammar nor the corpus."""

from __future__ import annotations

from pathlib import Path
from typing import Self

import msgspec


class Example(msgspec.Struct, frozen=True):
    prompt: tuple[int, ...]
    program: tuple[int, ...]
    """Its end included."""

    def __len__(self) -> int:
        return len(self.prompt) + len(self.program)


class Examples(msgspec.Struct, frozen=True):
    passes: list[list[Example]]
    """What is learned in each pass over the corpus."""
    unseen: list[Example]
    """What is never learned."""
    written: list[int]
    """Tokens that a program may have."""

    @classmethod
    def load(cls, path: Path) -> Self:
        return msgspec.msgpack.decode(path.read_bytes(), type=cls)

    def save(self, path: Path) -> None:
        path.write_bytes(msgspec.msgpack.encode(self))
