"""Text <-> the subwords that a speech model writes.

    subwords = Subwords.load(Path("tokenizer.bin"))
    ids = subwords.of("Go to the pharmacy.")
    assert subwords.text(ids) == "Go to the pharmacy."

The file holds one subword after the other, each with its length before it (one byte, or two from
128 on), in the order in which byte-pair encoding learned to merge them: so the merges need not be
kept, for of two possible ones that with the lower number comes first.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Final

BEGIN: Final = 1
END: Final = 2
_FIRST_BYTE: Final = 3  # the subword of byte 0; those of the others follow
_BLANK: Final = "▁"  # begins a word


class Subwords:
    """The vocabulary of one model; a `search.Tokenizer`."""

    begin: Final = (BEGIN,)
    end: Final = END

    def __init__(self, subwords: Sequence[bytes]) -> None:
        self._subwords = tuple(subwords)
        self._ids = {subword: number for number, subword in enumerate(subwords) if subword}
        self._of_word = lru_cache(maxsize=1 << 14)(self._merged)

    @classmethod
    def load(cls, path: Path) -> Subwords:
        """Raises OSError if it cannot be read, ValueError if it is no such file."""
        data, at = path.read_bytes(), 0
        subwords = []
        while at < len(data):
            length, at = data[at], at + 1
            if length >= 128 and at < len(data):
                length, at = data[at] * 128 + length - 128, at + 1
            if at + length > len(data):
                raise ValueError(f"{path} ends in the middle of a subword")
            subwords.append(data[at : at + length])
            at += length
        return cls(subwords)

    def __len__(self) -> int:
        return len(self._subwords)

    def of(self, text: str) -> list[int]:
        """The subwords of a text, without the begin and the end."""
        return [number for word in text.split() for number in self._of_word(_BLANK + word)]

    def text(self, numbers: Sequence[int]) -> str:
        """What these subwords write; the begin and the end write nothing."""
        written = b"".join(self._subwords[n] for n in numbers if n >= _FIRST_BYTE)
        return written.decode("utf-8", "replace").replace(_BLANK, " ").strip()

    def _merged(self, word: str) -> tuple[int, ...]:
        parts = list(word)
        while merges := [
            (number, at)
            for at in range(len(parts) - 1)
            if (number := self._ids.get((parts[at] + parts[at + 1]).encode())) is not None
        ]:
            _, at = min(merges)
            parts[at : at + 2] = [parts[at] + parts[at + 1]]
        return tuple(number for part in parts for number in self._of_part(part))

    def _of_part(self, part: str) -> list[int]:
        number = self._ids.get(part.encode())
        return [number] if number is not None else [_FIRST_BYTE + b for b in part.encode()]
