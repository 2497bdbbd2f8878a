"""What the stories about speech share: a real speech model, and recordings."""

from __future__ import annotations

from pathlib import Path

import pytest

from nl2robot.paths import PACKAGED
from nl2robot.speech.hear.recogniser import Recogniser, load
from tests.fetched import fetched

SHOWN = PACKAGED / "recordings"  # the two that `make run` plays
RECORDED = Path(__file__).parent / "recordings"  # synthesised for these tests, see docs/voice.md


@pytest.fixture(scope="session")
def recogniser() -> Recogniser:
    """The English one."""
    fetched("en")
    return load("en")


@pytest.fixture(scope="session")
def second_model() -> Path:
    """The folder of the second English speech model."""
    return fetched("en-moonshine")


@pytest.fixture(scope="session")
def whisper_model() -> Path:
    """The folder of the model that hears German and French."""
    return fetched("whisper")
