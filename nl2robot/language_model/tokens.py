"""The tokens of a model: text to numbers and back, and which of them it may write.

Kept in one file beside the graph (`Tokens.save`, `Tokens.load`). The splitting is byte-level BPE
in the order of the tokens' numbers, as Qwen trained it, by tiktoken.
"""

from __future__ import annotations

import re
import unicodedata
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Final

import msgspec

if TYPE_CHECKING:
    from collections.abc import Sequence

    from tiktoken import Encoding

END: Final = "<|im_end|>"
"""The token at the end of a turn."""

# How text is parted before it becomes tokens: Qwen2Tokenizer in transformers (Apache-2.0).
_PARTED: Final = (
    r"(?i:'s|'t|'re|'ve|'m|'ll|'d)|[^\r\n\p{L}\p{N}]?\p{L}+|\p{N}| ?[^\s\p{L}\p{N}]+[\r\n]*"
    r"|\s*[\r\n]+|\s+(?!\S)|\s+"
)
_SIGNS: Final = frozenset("“”„‚‘’«»‹›–—…€£°·¿¡½¼¾×²³ºª§\u00a0\u202f")


class Stored(msgspec.Struct, frozen=True):
    """The file."""

    tokens: list[bytes]
    special: dict[str, int]
    written: list[int]


class Tokens:
    def __init__(
        self, tokens: Sequence[bytes], special: dict[str, int], written: Sequence[int]
    ) -> None:
        self._tokens = tuple(tokens)
        self._special = special
        self.written: tuple[int, ...] = tuple(written)
        """The tokens that the model may write, in the order in which the graph scores them."""
        self.end = special[END]

    @classmethod
    def of(cls, tokens: Sequence[bytes], special: frozenset[int]) -> Tokens:
        """Those of a model. Written are only texts in Latin letters, and the end: what a person
        here is to read."""
        named = {tokens[number].decode(): number for number in sorted(special)}
        plain = [n for n, text in enumerate(tokens) if n not in special and is_latin(text)]
        return cls(tokens, named, [*plain, named[END]])

    @classmethod
    def load(cls, path: Path) -> Tokens:
        """Raises `OSError` or `msgspec.DecodeError` where the file is missing or damaged."""
        stored = msgspec.msgpack.decode(path.read_bytes(), type=Stored)
        return cls(stored.tokens, stored.special, stored.written)

    def save(self, path: Path) -> None:
        stored = Stored(list(self._tokens), self._special, list(self.written))
        path.write_bytes(msgspec.msgpack.encode(stored))

    def __len__(self) -> int:
        return len(self._tokens)

    def encode(self, text: str, *, control: bool = False) -> list[int]:
        """The tokens of a text. Only with `control` do words like "<|im_end|>" mean more than their
        letters: never where people's words are encoded."""
        if control:
            return self._encoding.encode(text, allowed_special="all")
        return self._encoding.encode_ordinary(text)

    def text(self, token: int) -> str:
        """What a token that may be written stands for; "" for the end."""
        return "" if token == self.end else self._tokens[token].decode()

    @cached_property
    def _encoding(self) -> Encoding:
        from tiktoken import Encoding

        ranks: dict[bytes, int] = {}
        reserved = {*self._special.values()}
        for number, text in enumerate(self._tokens):
            if number not in reserved:
                ranks.setdefault(text, number)
        return Encoding(
            "qwen2", pat_str=_PARTED, mergeable_ranks=ranks, special_tokens=self._special
        )


def is_latin(token: bytes) -> bool:
    """Whether a token is whole text that somebody reads who reads Latin letters."""
    try:
        text = token.decode()
    except UnicodeDecodeError:
        return False  # a part of a letter
    if re.search(r"[\x00-\x09\x0b-\x1f\x7f]", text):
        return False
    return all(
        sign.isascii() or sign in _SIGNS or unicodedata.name(sign, "").startswith("LATIN ")
        for sign in text
    )
