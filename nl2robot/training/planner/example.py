"""The file that training reads: examples as tokens."""

from __future__ import annotations

from pathlib import Path
from typing import Self

import msgspec

from nl2robot.errors import UserError


class Example(msgspec.Struct, frozen=True):
    prompt: tuple[int, ...]
    program: tuple[int, ...]
    """Its end included."""

    def __len__(self) -> int:
        return len(self.prompt) + len(self.program)


class Examples(msgspec.Struct, frozen=True):
    corpus: str
    """The hash of the corpus that they were made from (`corpus.digest`)."""
    passes: list[list[Example]]
    """What is learned in each pass over the corpus."""
    unseen: list[Example]
    """What is never learned."""
    written: list[int]
    """Tokens that a program may have."""

    @classmethod
    def load(cls, path: Path) -> Self:
        """Raises `UserError` if it is no file of examples."""
        try:
            return msgspec.msgpack.decode(path.read_bytes(), type=cls)
        except msgspec.MsgspecError as error:
            raise UserError(
                f"{path} has no examples that this version can read. Delete it; `train` makes it"
                " anew."
            ) from error

    def save(self, path: Path) -> None:
        """All or nothing."""
        new = path.with_suffix(".new")
        new.write_bytes(msgspec.msgpack.encode(self))
        new.replace(path)
