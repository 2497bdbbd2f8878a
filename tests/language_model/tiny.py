"""A Qwen2 model so small that a test makes it: random weights in the formats of the real ones, and
the same model in plain numpy, as a second opinion."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from gguf import GGMLQuantizationType, GGUFWriter, TokenType, quants
from numpy.typing import NDArray

WIDTH, HEADS, KV_HEADS, LAYERS, INNER = 256, 4, 2, 2, 512
HEAD = WIDTH // HEADS
WORDS = ("say", "goto", "(", ")", '"', "\n", " ", "Bob", "hello", "é", "家", "ab", "abc")
SPECIAL = ("<|endoftext|>", "<|im_start|>", "<|im_end|>")


def letters(text: bytes) -> str:
    """Bytes as GPT-2 writes them."""
    printable = {*range(33, 127), *range(161, 173), *range(174, 256)}
    others = [byte for byte in range(256) if byte not in printable]
    return "".join(chr(b) if b in printable else chr(256 + others.index(b)) for b in text)


def tokens() -> list[bytes]:
    single = [bytes([byte]) for byte in range(256)]
    return single + [word.encode() for word in WORDS if len(word.encode()) > 1]


class Tiny:
    """The weights as numbers, and the file that holds them."""

    def __init__(self, seed: int = 0) -> None:
        self.random = np.random.default_rng(seed)
        self.weights: dict[str, NDArray[np.float32]] = {}

    def write(self, path: Path, architecture: str = "qwen2") -> None:
        writer = GGUFWriter(path, architecture)
        writer.add_block_count(LAYERS)
        writer.add_embedding_length(WIDTH)
        writer.add_feed_forward_length(INNER)
        writer.add_head_count(HEADS)
        writer.add_head_count_kv(KV_HEADS)
        writer.add_layer_norm_rms_eps(1e-6)
        writer.add_rope_freq_base(1e6)
        writer.add_tokenizer_model("gpt2")
        writer.add_token_list([*map(letters, tokens()), *SPECIAL])
        writer.add_token_types([TokenType.NORMAL] * len(tokens()) + [TokenType.CONTROL] * 3)
        vocabulary = len(tokens()) + len(SPECIAL)
        kv = KV_HEADS * HEAD
        self._matrix(writer, "token_embd.weight", vocabulary, WIDTH, "Q8_0")
        self._matrix(writer, "output.weight", vocabulary, WIDTH, "Q8_0")
        self._vector(writer, "output_norm.weight", WIDTH, around=1.0)
        for layer in range(LAYERS):
            name = f"blk.{layer}"
            self._vector(writer, f"{name}.attn_norm.weight", WIDTH, around=1.0)
            self._vector(writer, f"{name}.ffn_norm.weight", WIDTH, around=1.0)
            for which, rows in (("q", WIDTH), ("k", kv), ("v", kv)):
                self._matrix(writer, f"{name}.attn_{which}.weight", rows, WIDTH, "Q4_K")
                self._vector(writer, f"{name}.attn_{which}.bias", rows)
            self._matrix(writer, f"{name}.attn_output.weight", WIDTH, WIDTH, "Q4_K")
            self._matrix(writer, f"{name}.ffn_gate.weight", INNER, WIDTH, "Q4_K")
            self._matrix(writer, f"{name}.ffn_up.weight", INNER, WIDTH, "Q4_K")
            self._matrix(writer, f"{name}.ffn_down.weight", WIDTH, INNER, "Q8_0")
        writer.write_header_to_file()
        writer.write_kv_data_to_file()
        writer.write_tensors_to_file()
        writer.close()

    def _vector(self, writer: Any, name: str, size: int, around: float = 0.0) -> None:
        vector = (around + self.random.normal(0, 0.1, size)).astype(np.float32)
        self.weights[name] = vector
        writer.add_tensor(name, vector)

    def _matrix(self, writer: Any, name: str, rows: int, columns: int, kind: str) -> None:
        type_ = GGMLQuantizationType[kind]
        if kind == "Q4_K":  # nobody writes it in Python: any bytes are a matrix
            data = self._random_q4k(rows, columns)
        else:
            dense = self.random.normal(0, columns**-0.5, (rows, columns)).astype(np.float32)
            data = quants.quantize(dense, type_)
        self.weights[name] = np.asarray(quants.dequantize(data, type_), np.float32)
        writer.add_tensor(name, data, raw_dtype=type_)

    def _random_q4k(self, rows: int, columns: int) -> NDArray[np.uint8]:
        data = self.random.integers(0, 256, (rows, columns // 256, 144)).astype(np.uint8)
        scale = np.full((rows, columns // 256, 1), columns**-0.5 / 200, np.float16)
        data[..., :2] = scale.view(np.uint8)
        data[..., 2:4] = (scale * 7.5).astype(np.float16).view(np.uint8)
        return data.reshape(rows, -1)

    def scores(self, read: list[int]) -> NDArray[np.float32]:
        """Of what may follow each token."""
        w, n = self.weights, len(read)
        x = w["token_embd.weight"][read]
        angles = np.arange(n)[:, None] / (1e6 ** (np.arange(0, HEAD, 2) / HEAD))[None]
        cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]

        def turned(v: NDArray[Any]) -> NDArray[Any]:
            a, b = v[..., : HEAD // 2], v[..., HEAD // 2 :]
            return np.concatenate([a * cos - b * sin, b * cos + a * sin], -1)

        def normalised(v: NDArray[Any], name: str) -> NDArray[Any]:
            return v / np.sqrt((v * v).mean(-1, keepdims=True) + 1e-6) * w[name]

        for layer in range(LAYERS):
            name = f"blk.{layer}"
            h = normalised(x, f"{name}.attn_norm.weight")
            q, k, v = (
                (h @ w[f"{name}.attn_{c}.weight"].T + w[f"{name}.attn_{c}.bias"]).reshape(
                    n, -1, HEAD
                )
                for c in "qkv"
            )
            q, k, out = turned(q), turned(k), np.empty((n, HEADS, HEAD))
            for head in range(HEADS):
                group = head * KV_HEADS // HEADS
                seen = q[:, head] @ k[:, group].T / np.sqrt(HEAD) + np.triu(
                    np.full((n, n), -1e9), 1
                )
                seen = np.exp(seen - seen.max(-1, keepdims=True))
                out[:, head] = seen / seen.sum(-1, keepdims=True) @ v[:, group]
            x = x + out.reshape(n, -1) @ w[f"{name}.attn_output.weight"].T
            h = normalised(x, f"{name}.ffn_norm.weight")
            gate, up = h @ w[f"{name}.ffn_gate.weight"].T, h @ w[f"{name}.ffn_up.weight"].T
            x = x + (gate / (1 + np.exp(-gate)) * up) @ w[f"{name}.ffn_down.weight"].T
        return np.asarray(normalised(x, "output_norm.weight") @ w["output.weight"].T, np.float32)
