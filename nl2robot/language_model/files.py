"""The files that an installed language model consists of."""

from __future__ import annotations

from typing import Final

GRAPH: Final = "model.onnx"
WEIGHTS: Final = f"{GRAPH}.data"
TOKENS: Final = "tokens.msgpack"
LEVELS: Final = "embeddings.npy"
SCALES: Final = "embeddings-scales.npy"
FILES: Final = (GRAPH, WEIGHTS, TOKENS, LEVELS, SCALES)

GGUF: Final = "model.gguf"
"""What they are made from; not kept."""
