"""The weights of a Qwen2 model, out of a GGUF file, as numbers that onnxruntime multiplies with.

A GGUF file holds each matrix in blocks of few bits. Those of four bits (Q4_K) are taken over as
they are: a weight is `scale * level - offset`, with a scale and an offset for every 32 of them,
and what onnxruntime's `MatMulNBits` computes is `scale * (level - 8)`. The difference, `8 * scale
- offset`, is the same for all weights of a block, so that it only has to be multiplied with the
sum of the block's inputs (`Blocks4.correction`). Rounded anew to a whole zero point, as converters
do it, the weights would carry twice the error of rounding. All others become whole numbers of
eight bits, which is closer than the five or six bits that they have.

The layout of Q4_K is that of ggml (MIT), `block_q4_K`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

BLOCK: Final = 32
"""Weights that share a scale."""
_MIDDLE: Final = 8
"""The level of four bits that stands for 0 in `MatMulNBits`."""

Floats = NDArray[np.float32]
Bytes = NDArray[np.uint8]


class Unreadable(ValueError):
    """The file is no GGUF file of a Qwen2 model; the message is a half-sentence that says why."""


@dataclass(frozen=True)
class Blocks8:
    """A matrix of `rows` x `columns` in eight bits."""

    levels: Bytes
    """(rows, blocks, 32); 128 stands for 0."""
    scales: Floats
    """(rows, blocks)"""

    @property
    def rows(self) -> int:
        return int(self.levels.shape[0])

    @property
    def columns(self) -> int:
        return int(self.levels.shape[1]) * BLOCK


@dataclass(frozen=True)
class Blocks4:
    """A matrix of `rows` x `columns` in four bits."""

    levels: Bytes
    """(rows, blocks, 16): two in a byte, the first in its lower half; 8 stands for 0."""
    scales: Floats
    """(rows, blocks)"""
    correction: Floats
    """(rows, blocks): to be multiplied with the sum of each block of inputs."""

    @property
    def rows(self) -> int:
        return int(self.levels.shape[0])

    @property
    def columns(self) -> int:
        return int(self.levels.shape[1]) * BLOCK


Blocks = Blocks4 | Blocks8


@dataclass(frozen=True)
class Sizes:
    """What a Qwen2 model measures."""

    layers: int
    width: int
    heads: int
    kv_heads: int
    epsilon: float
    """Of the normalisation."""
    rope_base: float

    @property
    def head_width(self) -> int:
        return self.width // self.heads


@dataclass(frozen=True)
class Vocabulary:
    """The tokens of a model by their numbers."""

    tokens: tuple[bytes, ...]
    special: frozenset[int]
    """Those that are no text."""


class GgufFile:
    """A GGUF file of a Qwen2 model, read matrix by matrix. Raises `Unreadable`."""

    def __init__(self, path: Path) -> None:
        from gguf import GGUFReader

        try:
            self._reader: Any = GGUFReader(path)
        except (OSError, ValueError, IndexError, KeyError) as error:
            raise Unreadable(f"{path.name} is no GGUF file") from error
        self._tensors: Mapping[str, Any] = {each.name: each for each in self._reader.tensors}
        family = self._text("general.architecture")
        if family != "qwen2":
            raise Unreadable(f"{path.name} holds a model of another kind ({family})")

    def _field(self, name: str) -> Any:
        try:
            return self._reader.fields[name]
        except KeyError as error:
            raise Unreadable(f"{name} is missing from it") from error

    def _number(self, name: str) -> float:
        field = self._field(name)
        return float(field.parts[field.data[0]][0])

    def _text(self, name: str) -> str:
        field = self._field(name)
        return bytes(field.parts[field.data[0]]).decode()

    @cached_property
    def sizes(self) -> Sizes:
        return Sizes(
            layers=int(self._number("qwen2.block_count")),
            width=int(self._number("qwen2.embedding_length")),
            heads=int(self._number("qwen2.attention.head_count")),
            kv_heads=int(self._number("qwen2.attention.head_count_kv")),
            epsilon=self._number("qwen2.attention.layer_norm_rms_epsilon"),
            rope_base=self._number("qwen2.rope.freq_base"),
        )

    @cached_property
    def vocabulary(self) -> Vocabulary:
        field, types = (
            self._field("tokenizer.ggml.tokens"),
            self._field("tokenizer.ggml.token_type"),
        )
        letters = _bytes_by_letter()
        tokens: list[bytes] = []
        special: set[int] = set()
        for number, (at, kind) in enumerate(zip(field.data, types.data, strict=True)):
            text = bytes(field.parts[at]).decode()
            normal = int(types.parts[kind][0]) == _NORMAL
            tokens.append(bytes(letters[letter] for letter in text) if normal else text.encode())
            if not normal:
                special.add(number)
        return Vocabulary(tuple(tokens), frozenset(special))

    def vector(self, name: str) -> Floats:
        """A row of numbers: a bias, the weights of a normalisation."""
        return self._dense(name, None).ravel()

    def matrix(self, *names: str, rows: NDArray[np.int64] | None = None) -> Blocks:
        """Matrices of the same number of columns, one below the other, or some `rows` of one."""
        tensors = [self._tensors[name] for name in names]
        if rows is None and all(tensor.tensor_type.name == "Q4_K" for tensor in tensors):
            parts = [_levels_of_q4k(np.asarray(tensor.data)) for tensor in tensors]
            levels, scales, offsets = (np.concatenate(part) for part in zip(*parts, strict=True))
            return Blocks4(_packed(levels), scales, _MIDDLE * scales - offsets)
        return self.eight_bits(*names, rows=rows)

    def eight_bits(self, *names: str, rows: NDArray[np.int64] | None = None) -> Blocks8:
        """The same, whatever it was before, in eight bits."""
        parts = [
            eight_bits(self._dense(name, some))
            for name in names
            for some in np.array_split(
                np.arange(len(self._tensors[name].data)) if rows is None else rows,
                1 + len(self._tensors[name].data) // _ROWS_AT_ONCE,
            )
        ]
        return Blocks8(
            np.concatenate([part.levels for part in parts]),
            np.concatenate([part.scales for part in parts]),
        )

    def _dense(self, name: str, rows: NDArray[np.int64] | None) -> Floats:
        from gguf import dequantize

        tensor = self._tensors[name]
        data = tensor.data if rows is None else tensor.data[rows]
        return np.asarray(dequantize(data, tensor.tensor_type), np.float32)


_ROWS_AT_ONCE: Final = 8192
"""Of a large matrix, so that installing a model takes no more memory than running it."""
_NORMAL: Final = 1
"""The type of a token that is text, in GGUF."""


def eight_bits(matrix: Floats) -> Blocks8:
    """A matrix in eight bits; its columns are filled up with zeros to whole blocks."""
    filled = np.pad(matrix, ((0, 0), (0, -matrix.shape[1] % BLOCK)))
    blocks = filled.reshape(len(matrix), -1, BLOCK)
    scales = np.abs(blocks).max(-1) / 127
    levels = np.round(blocks / np.where(scales, scales, 1)[..., None]) + 128
    return Blocks8(levels.astype(np.uint8), scales.astype(np.float32))


def _levels_of_q4k(data: Bytes) -> tuple[Bytes, Floats, Floats]:
    """Levels (rows, blocks, 32), scales and offsets (rows, blocks) of a matrix in Q4_K: eight
    blocks share a scale of their scales and one of their offsets, each of which has six bits."""
    rows = data.shape[0]
    groups = data.reshape(rows, -1, 144)
    whole = groups[..., :4].copy().view(np.float16).astype(np.float32)
    low, middle, high = np.moveaxis(groups[..., 4:16].reshape(*groups.shape[:2], 3, 4), 2, 0)
    scales = np.concatenate([low & 63, (high & 15) | ((low >> 2) & 0x30)], -1)
    offsets = np.concatenate([middle & 63, (high >> 4) | ((middle >> 2) & 0x30)], -1)
    halves = groups[..., 16:].reshape(*groups.shape[:2], 4, 1, BLOCK)
    levels = np.concatenate([halves & 15, halves >> 4], -2).reshape(rows, -1, BLOCK)
    return (
        levels,
        (whole[..., :1] * scales).reshape(rows, -1),
        (whole[..., 1:] * offsets).reshape(rows, -1),
    )


def _packed(levels: Bytes) -> Bytes:
    return np.asarray(levels[..., 0::2] | (levels[..., 1::2] << 4), np.uint8)


def _bytes_by_letter() -> Mapping[str, int]:
    """GPT-2's way to write any byte as a letter: printable ones as they are, others from 256 on."""
    printable = {*range(33, 127), *range(161, 173), *range(174, 256)}
    others = [byte for byte in range(256) if byte not in printable]
    letters = {chr(byte): byte for byte in printable}
    return letters | {chr(256 + place): byte for place, byte in enumerate(others)}
