"""The second English speech model is one that this machine can run."""

from __future__ import annotations

from pathlib import Path

import onnxruntime
import pytest

from nl2robot.models import catalogue as models


@pytest.mark.parametrize(
    ("network", "takes", "gives"),
    [
        ("encoder_model.ort", "input_values", "last_hidden_state"),
        ("decoder_model_merged.ort", "input_ids", "logits"),
    ],
)
def test_its_networks_open_and_are_those_of_moonshine(
    second_model: Path, network: str, takes: str, gives: str
) -> None:
    session = onnxruntime.InferenceSession(second_model / network)
    assert takes in {node.name for node in session.get_inputs()}
    assert gives in {node.name for node in session.get_outputs()}


def test_it_is_what_was_fetched(second_model: Path) -> None:
    assert second_model == models.find("en-moonshine")
    assert models.verify("en-moonshine") == []
