"""The code in docs/drivers.md runs."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from robot_api.methods import METHODS

PAGE = (Path(__file__).parents[2] / "docs" / "drivers.md").read_text(encoding="utf-8")


def test_the_examples_run(capsys: pytest.CaptureFixture[str]) -> None:
    examples = re.findall(r"```python\n(.*?)```", PAGE, re.S)
    assert len(examples) == 2
    for example in examples:
        exec(compile(example, "docs/drivers.md", "exec"), {"__name__": "example"})
    assert capsys.readouterr().out == ""  # the checker finds nothing wrong with the trolley


def test_the_page_names_every_method_of_the_table() -> None:
    missing = [name for name in METHODS if f"`{name}`" not in PAGE]
    assert missing == []
