"""The language model in torch, with low-rank changes that are learned while its weights stay as
they are (LoRA: Hu et al., arXiv:2106.09685).

The weights are those of the GGUF file, as numbers: what is learned fits what runs. Sentences of
different lengths stand one behind the other in a row; only attention knows where each begins.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from nl2robot.language_model.changes import SCALE
from nl2robot.language_model.graph import CHANGED
from nl2robot.language_model.weights import GgufFile, Sizes

RANK: Final = 16
DROPPED: Final = 0.2
"""The share of a change's inputs that is left out at each step of learning."""
LONGEST: Final = 2048
"""Tokens of a text."""


class Product(nn.Module):
    """A product with fixed weights, and a change of low rank. What is learned is kept as floats
    of 32 bits, whatever the weights are."""

    def __init__(self, weights: Tensor, bias: Tensor | None, rank: int) -> None:
        super().__init__()
        self.weights = nn.Parameter(weights, requires_grad=False)
        self.bias = None if bias is None else nn.Parameter(bias, requires_grad=False)
        rows, columns = weights.shape
        self.down = nn.Parameter(torch.randn(rank, columns) / columns**0.5)
        self.up = nn.Parameter(torch.zeros(rows, rank))

    def forward(self, x: Tensor) -> Tensor:
        y = functional.linear(x, self.weights, self.bias)
        between = functional.linear(self.dropped(x), self.down.to(x.dtype))
        return y + SCALE * functional.linear(between, self.up.to(x.dtype))

    def dropped(self, x: Tensor) -> Tensor:
        return functional.dropout(x, DROPPED, self.training)


@dataclass(frozen=True)
class Row:
    """Texts one behind the other."""

    tokens: Tensor
    lengths: tuple[int, ...]

    @cached_property
    def places(self) -> Tensor:
        """Of each token in its text."""
        return torch.cat([torch.arange(length) for length in self.lengths]).to(self.tokens.device)

    @cached_property
    def cells(self) -> Tensor:
        """Of each token, where texts stand below each other."""
        starts = torch.arange(len(self.lengths)) * max(self.lengths)
        return self.places + starts.repeat_interleave(torch.tensor(self.lengths)).to(
            self.tokens.device
        )


class Layer(nn.Module):
    def __init__(self, file: GgufFile, number: int, rank: int, kind: torch.dtype) -> None:
        super().__init__()
        self.sizes = file.sizes
        name = f"blk.{number}"

        def product(*which: str) -> Product:
            weights = np.concatenate([_dense(file, f"{name}.{each}.weight") for each in which])
            bias = None
            if which[0] == "attn_q":
                vectors = [file.vector(f"{name}.{each}.bias") for each in which]
                bias = torch.from_numpy(np.concatenate(vectors)).to(kind)
            return Product(torch.from_numpy(weights).to(kind), bias, rank)

        self.before = _fixed(file.vector(f"{name}.attn_norm.weight"), kind)
        self.between = _fixed(file.vector(f"{name}.ffn_norm.weight"), kind)
        self.qkv = product("attn_q", "attn_k", "attn_v")
        self.told = product("attn_output")
        self.gate, self.up = product("ffn_gate"), product("ffn_up")
        self.down = product("ffn_down")

    def forward(self, x: Tensor, row: Row, cosines: Tensor, sines: Tensor) -> Tensor:
        x = x + self.told(self.attended(self.qkv(self.normal(x, self.before)), row, cosines, sines))
        h = self.normal(x, self.between)
        gated: Tensor = functional.silu(self.gate(h)) * self.up(h)
        return x + self.down(gated)

    def normal(self, x: Tensor, weights: Tensor) -> Tensor:
        return functional.rms_norm(x, (x.shape[-1],), weights, self.sizes.epsilon)

    def attended(self, qkv: Tensor, row: Row, cosines: Tensor, sines: Tensor) -> Tensor:
        s = self.sizes
        heads = qkv.view(len(qkv), -1, s.head_width)
        q, k, v = heads.split((s.heads, s.kv_heads, s.kv_heads), 1)
        q, k = _turned(q, cosines, sines), _turned(k, cosines, sines)
        below = (len(row.lengths), max(row.lengths))
        q, k, v = (
            each.new_zeros((below[0] * below[1], *each.shape[1:]))
            .index_copy(0, row.cells, each)
            .view(*below, *each.shape[1:])
            .transpose(1, 2)
            for each in (q, k, v)
        )
        seen = functional.scaled_dot_product_attention(q, k, v, is_causal=True, enable_gqa=True)
        return seen.transpose(1, 2).reshape(below[0] * below[1], -1)[row.cells]


class Network(nn.Module):
    """A Qwen2 model that learns. `written` are the tokens that get a score."""

    def __init__(
        self,
        path: Path,
        written: Sequence[int],
        rank: int = RANK,
        kind: torch.dtype = torch.float32,
    ) -> None:
        super().__init__()
        file = GgufFile(path)
        self.sizes: Sizes = file.sizes
        self.embeddings = _fixed(_dense(file, "token_embd.weight"), kind)
        self.layers = nn.ModuleList(
            Layer(file, number, rank, kind) for number in range(self.sizes.layers)
        )
        self.last = _fixed(file.vector("output_norm.weight"), kind)
        self.head = _fixed(_dense(file, "output.weight")[np.array(written)], kind)
        turns = self.sizes.rope_base ** (
            torch.arange(0, self.sizes.head_width, 2) / self.sizes.head_width
        )
        angles = torch.arange(LONGEST)[:, None] / turns[None]
        self.cosines, self.sines = _constant(angles.cos()), _constant(angles.sin())

    def forward(self, row: Row, wanted: Tensor) -> Tensor:
        """The scores of what follows the tokens at the places `wanted` of a row."""
        x = self.embeddings[row.tokens]
        places = row.places
        cosines, sines = self.cosines[places][:, None], self.sines[places][:, None]
        for layer in self.layers:
            x = layer(x, row, cosines, sines)
        x = functional.rms_norm(x[wanted], (x.shape[-1],), self.last, self.sizes.epsilon)
        return functional.linear(x, self.head).float()

    def changes(self) -> list[nn.Parameter]:
        return [each for each in self.parameters() if each.requires_grad]

    def learned(self) -> dict[str, Tensor]:
        """What was learned, by layer, product and side: "12.gate.down"."""
        return {
            f"{number}.{name}.{side}": getattr(getattr(layer, name), side).detach()
            for number, layer in enumerate(self.layers)
            for name in CHANGED
            for side in ("down", "up")
        }

    def restore(self, learned: dict[str, Any]) -> None:
        with torch.no_grad():
            for key, value in self.learned().items():
                value.copy_(torch.as_tensor(learned[key]))


def _dense(file: GgufFile, name: str) -> np.ndarray[Any, np.dtype[np.float32]]:
    return file._dense(name, None)


def _fixed(values: np.ndarray[Any, np.dtype[np.float32]], kind: torch.dtype) -> nn.Parameter:
    return _constant(torch.from_numpy(np.array(values)).to(kind))


def _constant(values: Tensor) -> nn.Parameter:
    return nn.Parameter(values, requires_grad=False)


def _turned(x: Tensor, cosines: Tensor, sines: Tensor) -> Tensor:
    a, b = x.chunk(2, -1)
    return torch.cat([a * cosines - b * sines, b * cosines + a * sines], -1).to(x.dtype)
