"""A product in eight bits is nearly that of floats."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nl2robot.speech.hear.quantized import Product


@given(
    seed=st.integers(0, 2**32 - 1),
    inputs=st.integers(8, 64),
    outputs=st.integers(1, 40),
    rows=st.integers(1, 9),
    spread=st.floats(-3, 3),
)
def test_it_is_nearly_the_product_of_floats(
    seed: int, inputs: int, outputs: int, rows: int, spread: float
) -> None:
    rng = np.random.default_rng(seed)
    weights = rng.normal(0, 10**spread, (outputs, inputs)).astype(np.float32)
    bias = rng.normal(0, 1, outputs).astype(np.float32)
    x = rng.normal(0, 1, (rows, inputs)).astype(np.float32)
    right = x @ weights.T + bias
    # Half a step of each input, and of each weight: a row's errors add up like a random walk.
    step = (x.max() - x.min()) / 255 * np.sqrt(np.square(weights).sum(1))
    step += np.abs(weights).max(1) / 127 * np.sqrt(np.square(x).sum(1)).max()
    assert (np.abs(Product(weights, bias)(x) - right) < 2.5 * step + 1e-4).all()


def test_the_largest_values_do_not_overflow() -> None:
    weights = np.full((3, 2048), 1, np.float32) * np.array([[1], [-1], [0]], np.float32)
    (result,) = Product(weights)(np.full((1, 2048), 5, np.float32))
    assert result == pytest.approx([10240, -10240, 0], rel=0.01, abs=1)


def test_it_keeps_what_stands_before_the_inputs() -> None:
    product = Product(np.eye(6, 4, dtype=np.float32))
    assert product(np.ones((2, 3, 4), np.float32)).shape == (2, 3, 6)
    assert product(np.zeros((1, 4), np.float32)).tolist() == [[0] * 6]
