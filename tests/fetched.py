"""Models that tests need."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from nl2robot import models


def fetched(code: str) -> Path:
    """The model, fetched if need be; where that fails the test is skipped, in CI failed."""
    try:
        return models.get(code)
    except models.ModelError as error:
        if os.environ.get("CI") == "true":
            pytest.fail(str(error))
        pytest.skip(str(error))
