"""What runs elsewhere when something is pushed is what everybody runs."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import yaml

ROOT = Path(__file__).parents[1]
FILES = (*ROOT.glob(".git*/workflows/*.yml"), *ROOT.glob(".git*-ci.yml"))


def commands(part: Any) -> Iterator[str]:
    """All that a pipeline runs."""
    if isinstance(part, list):
        for each in part:
            yield from commands(each)
    elif isinstance(part, dict):
        for name, value in part.items():
            if name in ("run", "script"):
                yield from [value] if isinstance(value, str) else value
            else:
                yield from commands(value)


def test_the_pipelines_run_the_gate_and_ten_minutes_of_the_soak() -> None:
    targets = set(re.findall(r"^([a-z0-9]+):", (ROOT / "Makefile").read_text("utf-8"), re.M))
    assert len(FILES) == 2
    for file in FILES:
        run = set(commands(yaml.safe_load(file.read_text("utf-8"))))
        assert run == {".ci/run", "make attacks MINUTES=10"}, file
        made = {each.split()[1] for each in run if each.startswith("make ")}
        assert made <= targets and (ROOT / ".ci/run").stat().st_mode & 0o100
