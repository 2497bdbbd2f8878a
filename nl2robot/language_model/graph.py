"""A Qwen2 model as a graph for onnxruntime.

    embeddings of the new tokens -> layers, each with the keys and values of all tokens so far
        -> the scores of the tokens that may follow

The graph looks at one row of tokens, but what each of them sees is an input (`sees`), and so is
its place (`places`): several continuations of one text can be read side by side, as a tree whose
branches do not see each other, and share the text before them.

What was learned for this project (`learned`) are inputs as well: changes of low rank to the
products of the layers (LoRA: Hu et al., arXiv:2106.09685), so that they may be others without a
new graph.

Qwen2: Yang et al., Qwen2 Technical Report, arXiv:2407.10671.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO, Final

import numpy as np
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper

from nl2robot.language_model.weights import BLOCK, Blocks, Blocks4, Floats, GgufFile, eight_bits

LONGEST: Final = 4096
"""Tokens for whose places the rotations are worked out."""
CHANGED: Final = ("qkv", "told", "gate", "up", "down")
"""The products of a layer that may have learned something."""
_ALIGNED: Final = 4096
"""Where a matrix may begin in the file of weights, to be mapped into memory."""
_MICROSOFT: Final = "com.microsoft"
_AS_INT8: Final = 4
"""`accuracy_level`: the inputs of a product are rounded to eight bits, as llama.cpp does it."""


class _Graph:
    """Nodes that are put together, and constants, which go into a file as they come."""

    def __init__(self, data: BinaryIO, location: str) -> None:
        self.nodes: list[Any] = []
        self.constants: list[Any] = []
        self.learned: list[Any] = []
        """The inputs for what was learned."""
        self._data = data
        self._location = location
        self._sums: dict[str, str] = {}

    def constant(self, name: str, value: NDArray[Any]) -> str:
        kind = helper.np_dtype_to_tensor_dtype(value.dtype)
        if value.dtype == np.int64:  # shapes: looked at while the graph is loaded
            self.constants.append(numpy_helper.from_array(value, name))
            return name
        self._data.write(b"\0" * (-self._data.tell() % _ALIGNED))
        tensor = TensorProto(name=name, data_type=kind, dims=value.shape)
        tensor.data_location = TensorProto.EXTERNAL
        place = {"location": self._location, "offset": self._data.tell(), "length": value.nbytes}
        for key, entry in place.items():
            tensor.external_data.add(key=key, value=str(entry))
        self._data.write(np.ascontiguousarray(value).tobytes())
        self.constants.append(tensor)
        return name

    def node(
        self, kind: str, inputs: Sequence[str], output: str, domain: str = "", **how: Any
    ) -> str:
        self.nodes.append(helper.make_node(kind, inputs, [output], domain=domain, **how))
        return output

    def product(self, of: str, name: str, matrix: Blocks, bias: Floats | None = None) -> str:
        """`of` times a matrix: a row of `matrix.rows` numbers for each token."""
        inputs = [
            of,
            self.constant(f"{name}.levels", matrix.levels),
            self.constant(f"{name}.scales", matrix.scales),
        ]
        if bias is not None:
            inputs += ["", "", self.constant(f"{name}.bias", bias)]
        product = self.node(
            "MatMulNBits",
            inputs,
            f"{name}.product",
            _MICROSOFT,
            K=matrix.columns,
            N=matrix.rows,
            bits=4 if isinstance(matrix, Blocks4) else 8,
            block_size=BLOCK,
            accuracy_level=_AS_INT8,
        )
        if not isinstance(matrix, Blocks4):
            return product
        correction = eight_bits(matrix.correction)
        sums = self.sums_of_blocks(of, matrix.columns // BLOCK, correction.columns)
        corrected = self.product(sums, f"{name}.correction", correction)
        return self.node("Add", [product, corrected], f"{name}.corrected")

    def changed(
        self, of: str, layer: int, which: str, matrix: Blocks, bias: Floats | None = None
    ) -> str:
        """The same with what was learned for it."""
        name = f"{layer}.{which}"
        product = self.product(of, f"blk.{name}", matrix, bias)
        rank, few = f"{name}.rank", of
        shapes: dict[str, Sequence[int | str]] = {
            "down": (matrix.columns, rank),
            "up": (rank, matrix.rows),
        }
        for side, shape in shapes.items():
            self.learned.append(_info(f"learned.{name}.{side}", TensorProto.FLOAT, shape))
            few = self.node("MatMul", [few, f"learned.{name}.{side}"], f"blk.{name}.learned.{side}")
        return self.node("Add", [product, few], f"blk.{name}.changed")

    def sums_of_blocks(self, of: str, blocks: int, filled: int) -> str:
        """The sum of each 32 numbers of a row, with zeros at the end up to `filled`."""
        if of not in self._sums:
            shape = self.constant(f"{of}.shape", np.array([0, 0, blocks, BLOCK], np.int64))
            parted = self.node("Reshape", [of, shape], f"{of}.parted")
            last = self.constant(f"{of}.last", np.array([-1], np.int64))
            sums = self.node("ReduceSum", [parted, last], f"{of}.sums", keepdims=0)
            if filled > blocks:
                pads = np.array([0, 0, 0, 0, 0, filled - blocks], np.int64)
                sums = self.node("Pad", [sums, self.constant(f"{of}.pads", pads)], f"{of}.filled")
            self._sums[of] = sums
        return self._sums[of]

    def normalised(
        self, added: str, to: str, name: str, weights: Floats, epsilon: float
    ) -> tuple[str, str]:
        """The sum of two, and the same normalised: (normalised, sum)."""
        inputs = [added, to, self.constant(f"{name}.weights", weights)]
        outputs = [name, "", "", f"{name}.sum"]
        self.nodes.append(
            helper.make_node(
                "SkipSimplifiedLayerNormalization",
                inputs,
                outputs,
                domain=_MICROSOFT,
                epsilon=epsilon,
            )
        )
        return name, f"{name}.sum"


def write_graph(file: GgufFile, kept: Sequence[int], path: Path) -> None:
    """Write the graph to `path` and its weights beside it, to `path` with ".data" at its end.

    Of the tokens, only those `kept` get a score, in this order. Inputs, where n tokens are new and
    t is how many there are with those before:
        embeddings  float (1, n, width)
        asked       int64 (r,)          for which of the new ones scores are wanted
        last        int32 (1,)          t - 1
        total       int32 ()            t
        places      int64 (1, n)        their places in their text
        sees        float (1, 1, n, t)  0 for what a token sees, a very small number for the rest
        key_<l>, value_<l>              float (1, kv_heads, room, head_width), changed in place
        learned.<l>.<product>.down      float (columns, rank)
        learned.<l>.<product>.up        float (rank, rows); the products are those of `CHANGED`
    Outputs: scores float (1, r, len(kept)); new_key_<l>, new_value_<l>.
    """
    data = path.with_name(f"{path.name}.data")
    with data.open("wb") as written:
        model = _model(file, kept, _Graph(written, data.name))
    path.write_bytes(model.SerializeToString())


def _model(file: GgufFile, kept: Sequence[int], graph: _Graph) -> Any:
    sizes = file.sizes
    _rotations(graph, sizes.head_width, sizes.rope_base)
    first = graph.constant("first.weights", file.vector("blk.0.attn_norm.weight"))
    hidden = graph.node(
        "SimplifiedLayerNormalization",
        ["embeddings", first],
        "first",
        epsilon=sizes.epsilon,
        axis=-1,
    )
    stream = "embeddings"
    inputs, outputs = [], []
    for layer in range(sizes.layers):
        hidden, stream = _layer(graph, file, layer, hidden, stream)
        shape: list[int | str] = [1, sizes.kv_heads, "room", sizes.head_width]
        for what in ("key", "value"):
            inputs.append(_info(f"{what}_{layer}", TensorProto.FLOAT, shape))
            outputs.append(_info(f"new_{what}_{layer}", TensorProto.FLOAT, shape))
    graph.node("Gather", [hidden, "asked"], "last_hidden", axis=1)
    head = file.matrix("output.weight", rows=np.asarray(kept, np.int64))
    graph.node("Identity", [graph.product("last_hidden", "head", head)], "scores")
    own = [
        _info("embeddings", TensorProto.FLOAT, [1, "new", sizes.width]),
        _info("asked", TensorProto.INT64, ["asked"]),
        _info("last", TensorProto.INT32, [1]),
        _info("total", TensorProto.INT32, []),
        _info("places", TensorProto.INT64, [1, "new"]),
        _info("sees", TensorProto.FLOAT, [1, 1, "new", "all"]),
    ]
    scores = _info("scores", TensorProto.FLOAT, [1, "asked", len(kept)])
    return helper.make_model(
        helper.make_graph(
            graph.nodes,
            "qwen2",
            [*own, *inputs, *graph.learned],
            [*outputs, scores],
            graph.constants,
        ),
        opset_imports=[helper.make_opsetid("", 18), helper.make_opsetid(_MICROSOFT, 1)],
        ir_version=10,
    )


def _layer(graph: _Graph, file: GgufFile, layer: int, hidden: str, stream: str) -> tuple[str, str]:
    """One layer: attention, then the two products with a gate. (normalised, sum) as it leaves."""
    sizes, name = file.sizes, f"blk.{layer}"
    asks = [f"{name}.attn_{each}" for each in "qkv"]
    bias = np.concatenate([file.vector(f"{each}.bias") for each in asks])
    asked = file.matrix(*(f"{each}.weight" for each in asks))
    attended = f"{name}.attended"
    graph.nodes.append(
        helper.make_node(
            "GroupQueryAttention",
            [
                *(graph.changed(hidden, layer, "qkv", asked, bias), "", ""),
                *(f"key_{layer}", f"value_{layer}", "last", "total"),
                *("cosines", "sines", "places", "sees"),
            ],
            [attended, f"new_key_{layer}", f"new_value_{layer}"],
            domain=_MICROSOFT,
            num_heads=sizes.heads,
            kv_num_heads=sizes.kv_heads,
            do_rotary=1,
        )
    )
    told = graph.changed(attended, layer, "told", file.matrix(f"{name}.attn_output.weight"))
    weights = file.vector(f"{name}.ffn_norm.weight")
    hidden, stream = graph.normalised(told, stream, f"{name}.middle", weights, sizes.epsilon)
    gate = graph.changed(hidden, layer, "gate", file.matrix(f"{name}.ffn_gate.weight"))
    up = graph.changed(hidden, layer, "up", file.matrix(f"{name}.ffn_up.weight"))
    # x * sigmoid(x)
    opened = graph.node("QuickGelu", [gate], f"{name}.opened", _MICROSOFT, alpha=1.0)
    gated = graph.node("Mul", [opened, up], f"{name}.gated")
    down = graph.changed(gated, layer, "down", file.matrix(f"{name}.ffn_down.weight"))
    after = f"blk.{layer + 1}.attn_norm" if layer + 1 < sizes.layers else "output_norm"
    weights = file.vector(f"{after}.weight")
    return graph.normalised(down, stream, f"{name}.out", weights, sizes.epsilon)


def _rotations(graph: _Graph, head_width: int, base: float) -> None:
    """Rotary position embedding (Su et al., RoFormer, arXiv:2104.09864)."""
    turns = base ** (np.arange(0, head_width, 2) / head_width)
    angles = np.arange(LONGEST)[:, None] / turns[None]
    graph.constant("cosines", np.cos(angles).astype(np.float32))
    graph.constant("sines", np.sin(angles).astype(np.float32))


def _info(name: str, kind: int, shape: Sequence[int | str]) -> Any:
    return helper.make_tensor_value_info(name, kind, list(shape))
