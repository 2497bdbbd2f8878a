"""Text <-> the subwords that Whisper writes: bytes, merged in pairs (Sennrich et al. 2016) as in
GPT-2.

    pairs = BytePairs.load(folder / "tokenizer.json", language="de")
    assert pairs.text(pairs.of("Geh zur Apotheke.")) == "Geh zur Apotheke."
"""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Final

# Words with the blank before them, numerals, and whatever else stands in a row.
_PIECES: Final = re.compile(
    r"'(?:s|t|re|ve|m|ll|d)| ?[^\W\d_]+| ?\d+| ?(?:[^\s\w]|_)+|\s+(?!\S)|\s+"
)
_PROMPT: Final = "<|startoftranscript|><|{language}|><|transcribe|><|notimestamps|>"
_END: Final = "<|endoftext|>"


def _letters() -> dict[int, str]:
    """The letter that stands for each byte in the file: itself where it can be seen."""
    seen = [*range(33, 127), *range(161, 173), *range(174, 256)]
    hidden = (byte for byte in range(256) if byte not in seen)
    return {byte: chr(byte) for byte in seen} | {
        byte: chr(256 + n) for n, byte in enumerate(hidden)
    }


_LETTER: Final = _letters()
_BYTE: Final = {letter: byte for byte, letter in _LETTER.items()}


class BytePairs:
    """The vocabulary of one model, for one language; a `search.Tokenizer`."""

    def __init__(
        self,
        numbers: Mapping[str, int],
        merges: Sequence[tuple[str, str]],
        special: Mapping[str, int],
        language: str,
    ) -> None:
        """`special` are those that write nothing. Raises KeyError for a language that it lacks."""
        self._numbers = dict(numbers)
        self._ranks = {pair: rank for rank, pair in enumerate(merges)}
        prompt = re.findall(r"<.*?>", _PROMPT.format(language=language))
        self.begin = tuple(special[part] for part in prompt)
        self.end = special[_END]
        self._written = {number: subword for subword, number in numbers.items()}
        self._of_piece = lru_cache(maxsize=1 << 14)(self._merged)

    @classmethod
    def load(cls, path: Path, language: str) -> BytePairs:
        """From the file tokenizer.json beside a model. Raises OSError, ValueError or KeyError if it
        is no such file."""
        described = json.loads(path.read_text("utf-8"))
        model = described["model"]
        pairs = [pair.split(" ") if isinstance(pair, str) else pair for pair in model["merges"]]
        special = {token["content"]: token["id"] for token in described["added_tokens"]}
        merges = [(first, second) for first, second in pairs]
        return cls(
            {text: n for text, n in model["vocab"].items() if text not in special},
            merges,
            special,
            language,
        )

    def of(self, text: str) -> list[int]:
        """The subwords of a text, without the begin and the end. It begins with a blank, as
        whatever Whisper writes."""
        pieces = _PIECES.findall(" " + " ".join(text.split())) if text else []
        return [number for piece in pieces for number in self._of_piece(piece)]

    def text(self, numbers: Sequence[int]) -> str:
        """What these subwords write; the begin and the end write nothing."""
        letters = "".join(self._written.get(number, "") for number in numbers)
        data = bytes(_BYTE[letter] for letter in letters)
        return data.decode("utf-8", "replace").strip()

    def _merged(self, piece: str) -> tuple[int, ...]:
        parts = [_LETTER[byte] for byte in piece.encode()]
        while len(parts) > 1:
            ranked = [
                (self._ranks.get((parts[at], parts[at + 1])), at) for at in range(len(parts) - 1)
            ]
            known = [(rank, at) for rank, at in ranked if rank is not None]
            if not known:
                break
            _, at = min(known)
            parts[at : at + 2] = [parts[at] + parts[at + 1]]
        return tuple(self._numbers[part] for part in parts)
