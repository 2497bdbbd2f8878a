"""The language model in torch, with low-rank changes that are learned while its weights stay as
they are (LoRA: Hu et al., arXiv:2106.09685).

Sentences of different lengths stand one behind the other in a row; only attention knows where
each begins.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Final

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from nl2robot.language_model.changes import SCALE
from nl2robot.language_model.graph import CHANGED
from nl2robot.language_model.weights import Floats
from nl2robot.training.planner.installed import Installed
from nl2robot.training.planner.recipe import RECIPE, Recipe

LONGEST: Final = 2048
"""Tokens of a text."""


class Product(nn.Module):
    """A product with fixed weights, and a change of low rank. What is learned is kept as floats
    of 32 bits, whatever the weights are."""

    def __init__(self, weights: Tensor, bias: Tensor | None, recipe: Recipe) -> None:
        super().__init__()
        self.share_dropped = recipe.dropped
        self.weights = nn.Parameter(weights, requires_grad=False)
        self.bias = None if bias is None else nn.Parameter(bias, requires_grad=False)
        rows, columns = weights.shape
        self.down = nn.Parameter(torch.randn(recipe.rank, columns) / columns**0.5)
        self.up = nn.Parameter(torch.zeros(rows, recipe.rank))

    def forward(self, x: Tensor) -> Tensor:
        y = functional.linear(x, self.weights, self.bias)
        between = functional.linear(self.dropped(x), self.down.to(x.dtype))
        return y + SCALE * functional.linear(between, self.up.to(x.dtype))

    def dropped(self, x: Tensor) -> Tensor:
        return functional.dropout(x, self.share_dropped, self.training)


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
    def __init__(self, model: Installed, number: int, recipe: Recipe, kind: torch.dtype) -> None:
        super().__init__()
        self.heads, self.kv_heads = model.heads
        self.epsilon = model.epsilon

        def product(which: str) -> Product:
            name = f"blk.{number}.{which}"
            bias = model.bias(name)
            return Product(
                torch.from_numpy(model.matrix(name)).to(kind),
                None if bias is None else torch.from_numpy(bias).to(kind),
                recipe,
            )

        before = "first" if number == 0 else f"blk.{number - 1}.out"
        self.before = _fixed(model.normal(before), kind)
        self.between = _fixed(model.normal(f"blk.{number}.middle"), kind)
        self.qkv, self.told = product("qkv"), product("told")
        self.gate, self.up = product("gate"), product("up")
        self.down = product("down")

    def forward(self, x: Tensor, row: Row, cosines: Tensor, sines: Tensor) -> Tensor:
        x = x + self.told(self.attended(self.qkv(self.normal(x, self.before)), row, cosines, sines))
        h = self.normal(x, self.between)
        gated: Tensor = functional.silu(self.gate(h)) * self.up(h)
        return x + self.down(gated)

    def normal(self, x: Tensor, weights: Tensor) -> Tensor:
        return functional.rms_norm(x, (x.shape[-1],), weights, self.epsilon)

    def attended(self, qkv: Tensor, row: Row, cosines: Tensor, sines: Tensor) -> Tensor:
        heads = qkv.view(len(qkv), self.heads + 2 * self.kv_heads, -1)
        q, k, v = heads.split((self.heads, self.kv_heads, self.kv_heads), 1)
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
    """A Qwen2 model that learns; only tokens that a program may have get a score."""

    def __init__(
        self, model: Installed, recipe: Recipe = RECIPE, kind: torch.dtype = torch.float32
    ) -> None:
        super().__init__()
        self.epsilon = model.epsilon
        self.embeddings = _fixed(model.embeddings, kind)
        self.layers = nn.ModuleList(
            Layer(model, number, recipe, kind) for number in range(model.layers)
        )
        self.last = _fixed(model.normal(f"blk.{model.layers - 1}.out"), kind)
        self.head = _fixed(model.matrix("head"), kind)
        self.cosines, self.sines = (
            _constant(torch.from_numpy(np.array(model.constant(name)[:LONGEST])))
            for name in ("cosines", "sines")
        )

    def forward(self, row: Row, wanted: Tensor) -> Tensor:
        """The scores of what follows the tokens at the places `wanted` of a row."""
        x = self.embeddings[row.tokens]
        places = row.places
        cosines, sines = self.cosines[places][:, None], self.sines[places][:, None]
        for layer in self.layers:
            x = layer(x, row, cosines, sines)
        x = functional.rms_norm(x[wanted], (x.shape[-1],), self.last, self.epsilon)
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


def _fixed(values: Floats, kind: torch.dtype) -> nn.Parameter:
    return _constant(torch.from_numpy(values).to(kind))


def _constant(values: Tensor) -> nn.Parameter:
    return nn.Parameter(values, requires_grad=False)


def _turned(x: Tensor, cosines: Tensor, sines: Tensor) -> Tensor:
    a, b = x.chunk(2, -1)
    return torch.cat([a * cosines - b * sines, b * cosines + a * sines], -1).to(x.dtype)
