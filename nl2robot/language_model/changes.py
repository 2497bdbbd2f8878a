"""What a model has learned for this project: small changes to its products, in a file of their own.

The file (numpy's .npz) has two matrices for each product that was changed,
`<layer>.<product>.down` (rank, columns) and `.up` (rows, rank): the product of x is then
W x + `SCALE` up (down x). Each is kept in eight bits, with a number by which every row is
multiplied, `<matrix>.scales`. Written by `nl2robot.training.planner`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.language_model.weights import Floats

SCALE: Final = 2.0
"""What a change counts: alpha / rank."""
LEVELS: Final = 127
_SCALES: Final = ".scales"
PREFIX: Final = "learned."
"""What the names of the graph's inputs for changes begin with."""


def changes(
    inputs: Mapping[str, Sequence[int | str]], file: Path | None
) -> Iterator[tuple[str, Floats]]:
    """A matrix for each of a graph's inputs, given with their shapes, that take one; zeros where
    nothing was learned. Raises `ValueError` if the file is of another model."""
    learned = read(file) if file is not None else {}
    wanted = {name.removeprefix(PREFIX): name for name in inputs if name.startswith(PREFIX)}
    for key, change in learned.items():
        shape = inputs[wanted[key]] if key in wanted else ()
        known = {size for size in shape if isinstance(size, int)}
        if not known or not known <= {*change.shape}:
            raise ValueError(f"{file} was not learned by this model: {key} is {change.shape}.")
    for key, name in wanted.items():
        if key not in learned:
            rows, columns = (size if isinstance(size, int) else 1 for size in inputs[name])
            yield name, np.zeros((rows, columns), np.float32)
            continue
        counts = np.float32(SCALE if key.endswith(".up") else 1)
        yield name, np.ascontiguousarray(learned[key].T * counts)


def write(learned: Mapping[str, Floats], file: Path) -> None:
    """Write what was learned to a file."""
    arrays: dict[str, NDArray[np.int8] | NDArray[np.float16]] = {}
    for key, matrix in learned.items():
        scales = np.maximum(np.abs(matrix).max(1, keepdims=True) / LEVELS, 1e-7).astype(np.float16)
        arrays[key] = np.round(matrix / scales).clip(-LEVELS, LEVELS).astype(np.int8)
        arrays[f"{key}{_SCALES}"] = scales
    np.savez_compressed(file, allow_pickle=False, **arrays)


def read(file: Path) -> dict[str, Floats]:
    """What `write` has written."""
    with np.load(file) as arrays:
        return {
            key: arrays[key] * arrays[f"{key}{_SCALES}"].astype(np.float32)
            for key in arrays
            if not key.endswith(_SCALES)
        }
