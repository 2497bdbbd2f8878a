"""The language model in torch, with low-rank changes that are learned while its weights stay as
they are (LoRA: Hu et al., arXiv:2106.09685).

The weights are those of the GGUF file, as numbers: what is learned fits what runs. Sentences of
different lengths stand one behind the other in a row; only attention knows where each begins.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn import functional

from nl2robot.language_model.changes import SCALE
from nl2robot.language_model.graph import CHANGED
from nl2robot.language_model.weights import GgufFile, Sizes

RANK: Final = 8
FIRST_CHANGED: Final = 4
"""The layer from which on there are changes: below, a text is only read."""


class Product(nn.Module):
    """A product with fixed weights, and a change of low rank."""

    def __init__(self, weights: Tensor, bias: Tensor | None, changed: bool) -> None:
        super().__init__()
        self.weights = nn.Parameter(weights, requires_grad=False)
        self.bias = None if bias is None else nn.Parameter(bias, requires_grad=False)
        rows, columns = weights.shape
        self.down: nn.Parameter | None = None
        if changed:
            self.down = nn.Parameter(torch.randn(RANK, columns) / columns**0.5)
            self.up = nn.Parameter(torch.zeros(rows, RANK))

    def forward(self, x: Tensor) -> Tensor:
        y = functional.linear(x, self.weights, self.bias)
        if self.down is not None:
            y = y + SCALE * functional.linear(functional.linear(x, self.down), self.up)
        return y


@dataclass(frozen=True)
class Row:
    """Texts one behind the other."""

    tokens: Tensor
    lengths: tuple[int, ...]

    @property
    def places(self) -> Tensor:
        return torch.cat([torch.arange(length) for length in self.lengths])


class Layer(nn.Module):
    def __init__(self, file: GgufFile, number: int, changed: bool) -> None:
        super().__init__()
        self.sizes = file.sizes
        name = f"blk.{number}"

        def product(*which: str) -> Product:
            weights = np.concatenate([_dense(file, f"{name}.{each}.weight") for each in which])
            bias = None
            if which[0] == "attn_q":
                bias = torch.from_numpy(
                    np.concatenate([file.vector(f"{name}.{each}.bias") for each in which])
                )
            return Product(torch.from_numpy(weights), bias, changed)

        self.before = _fixed(file.vector(f"{name}.attn_norm.weight"))
        self.between = _fixed(file.vector(f"{name}.ffn_norm.weight"))
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
        repeated = s.heads // s.kv_heads
        k, v = k.repeat_interleave(repeated, 1), v.repeat_interleave(repeated, 1)
        texts = []
        for a, b, c in zip(
            q.split(row.lengths), k.split(row.lengths), v.split(row.lengths), strict=True
        ):
            seen = functional.scaled_dot_product_attention(
                a.transpose(0, 1), b.transpose(0, 1), c.transpose(0, 1), is_causal=True
            )
            texts.append(seen.transpose(0, 1).reshape(len(a), -1))
        return torch.cat(texts)


class Network(nn.Module):
    """A Qwen2 model that learns. `written` are the tokens that get a score."""

    def __init__(self, path: Path, written: tuple[int, ...]) -> None:
        super().__init__()
        file = GgufFile(path)
        self.sizes: Sizes = file.sizes
        self.embeddings = _fixed(_dense(file, "token_embd.weight"))
        self.layers = nn.ModuleList(
            Layer(file, number, number >= FIRST_CHANGED) for number in range(self.sizes.layers)
        )
        self.last = _fixed(file.vector("output_norm.weight"))
        self.head = _fixed(_dense(file, "output.weight")[np.array(written)])
        turns = self.sizes.rope_base ** (
            torch.arange(0, self.sizes.head_width, 2) / self.sizes.head_width
        )
        angles = torch.arange(2048)[:, None] / turns[None]
        self.cosines, self.sines = angles.cos(), angles.sin()

    def forward(self, row: Row, wanted: Tensor) -> Tensor:
        """The scores of what follows the tokens at the places `wanted` of a row."""
        x = self.embeddings[row.tokens]
        places = row.places
        cosines, sines = self.cosines[places][:, None], self.sines[places][:, None]
        for number, layer in enumerate(self.layers):
            if number < FIRST_CHANGED:
                with torch.no_grad():
                    x = layer(x, row, cosines, sines)
            else:
                x = layer(x, row, cosines, sines)
        x = functional.rms_norm(x[wanted], (x.shape[-1],), self.last, self.sizes.epsilon)
        return functional.linear(x, self.head)

    def changes(self) -> list[nn.Parameter]:
        return [each for each in self.parameters() if each.requires_grad]

    def learned(self) -> dict[str, Tensor]:
        """What was learned, by layer, product and side: "12.gate.down"."""
        return {
            f"{number}.{name}.{side}": getattr(getattr(layer, name), side).detach()
            for number, layer in enumerate(self.layers)
            if number >= FIRST_CHANGED
            for name in CHANGED
            for side in ("down", "up")
        }

    def restore(self, learned: dict[str, Any]) -> None:
        with torch.no_grad():
            for key, value in self.learned().items():
                value.copy_(torch.as_tensor(learned[key]))


def _dense(file: GgufFile, name: str) -> np.ndarray[Any, np.dtype[np.float32]]:
    return file._dense(name, None)


def _fixed(values: np.ndarray[Any, np.dtype[np.float32]]) -> nn.Parameter:
    return nn.Parameter(torch.from_numpy(np.ascontiguousarray(values)), requires_grad=False)


def _turned(x: Tensor, cosines: Tensor, sines: Tensor) -> Tensor:
    a, b = x.chunk(2, -1)
    return torch.cat([a * cosines - b * sines, b * cosines + a * sines], -1)
