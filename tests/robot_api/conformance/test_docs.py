"""What docs/conformance.md says, done."""

from __future__ import annotations

import re
from pathlib import Path

from robot_api.conformance import losing
from robot_api.conformance.report import PARTS

PAGE = (Path(__file__).parents[3] / "docs" / "conformance.md").read_text(encoding="utf-8")


def test_the_examples_run() -> None:
    code = "".join(re.findall(r"```python\n(.*?)```", PAGE, re.S))
    exec(compile(code, "docs/conformance.md", "exec"), {"__name__": "example"})


def test_the_page_names_every_part_and_the_times() -> None:
    assert [part for part in PARTS if f"\n| {part} |" not in PAGE] == []
    assert f"within {losing.FOUND_WITHIN:g} s" in PAGE
    assert f"within {losing.LOST_WITHIN:g} s" in PAGE
    assert f"within {losing.STANDS_WITHIN:g} s" in PAGE
