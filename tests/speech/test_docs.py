"""What docs/voice.md shows works as shown."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from nl2robot.speech.hear.recogniser import Recogniser

ROOT = Path(__file__).parents[2]


def test_the_example_runs(recogniser: Recogniser, monkeypatch: pytest.MonkeyPatch) -> None:
    (example,) = re.findall(
        r"```python\n(.*?)```", (ROOT / "docs" / "voice.md").read_text("utf-8"), re.DOTALL
    )
    monkeypatch.chdir(ROOT)
    exec(compile(example, "docs/voice.md", "exec"), {})
