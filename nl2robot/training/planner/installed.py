"""The weights of an installed model, as numbers: what it learns then fits what runs.

Its files are those of `nl2robot.language_model.files`, its matrices in four or eight bits as
`nl2robot.language_model.graph` has written them.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray

from nl2robot.language_model.files import GRAPH, LEVELS, SCALES
from nl2robot.language_model.weights import BLOCK, Floats


@dataclass(frozen=True)
class Installed:
    """A model, by the folder that it is installed in."""

    folder: Path

    @cached_property
    def _graph(self) -> Any:
        return onnx.load(self.folder / GRAPH, load_external_data=False).graph

    @cached_property
    def _constants(self) -> dict[str, Any]:
        return {each.name: each for each in self._graph.initializer}

    def _first(self, kind: str) -> dict[str, Any]:
        """How the first node of a kind is set."""
        node = next(each for each in self._graph.node if each.op_type == kind)
        return {each.name: onnx.helper.get_attribute_value(each) for each in node.attribute}

    # --- sizes

    @property
    def layers(self) -> int:
        return sum(each.op_type == "GroupQueryAttention" for each in self._graph.node)

    @property
    def heads(self) -> tuple[int, int]:
        """Those that ask, and those that answer."""
        attention = self._first("GroupQueryAttention")
        return attention["num_heads"], attention["kv_num_heads"]

    @property
    def epsilon(self) -> float:
        return float(self._first("SimplifiedLayerNormalization")["epsilon"])

    # --- weights

    def constant(self, name: str) -> NDArray[Any]:
        """A constant of the graph as it is kept; read when it is looked at."""
        tensor = self._constants[name]
        place = {each.key: each.value for each in tensor.external_data}
        kind = onnx.helper.tensor_dtype_to_np_dtype(tensor.data_type)
        data = self.folder / place["location"]
        return np.memmap(data, kind, "r", int(place["offset"]), tuple(tensor.dims))

    def matrix(self, name: str) -> Floats:
        """A product's matrix (rows, columns)."""
        levels, scales = self.constant(f"{name}.levels"), self.constant(f"{name}.scales")
        halves = levels.shape[-1] < BLOCK  # two of four bits in a byte
        if halves:
            levels = np.stack([levels & 15, levels >> 4], -1).reshape(*scales.shape, BLOCK)
        weights = (levels.astype(np.float32) - (8 if halves else 128)) * scales[..., None]
        if halves:  # what is multiplied with the sum of each block of inputs
            correction = self.matrix(f"{name}.correction")[:, : scales.shape[1]]
            weights += correction[..., None]
        return weights.reshape(len(weights), -1)

    def bias(self, name: str) -> Floats | None:
        """What is added to a product, if anything."""
        key = f"{name}.bias"
        return np.array(self.constant(key)) if key in self._constants else None

    def normal(self, name: str) -> Floats:
        """The weights of a normalisation."""
        return np.array(self.constant(f"{name}.weights"))

    @property
    def embeddings(self) -> Floats:
        levels = np.load(self.folder / LEVELS, mmap_mode="r").astype(np.float32)
        levels -= 128
        levels *= np.repeat(np.load(self.folder / SCALES), BLOCK, -1)
        return levels
