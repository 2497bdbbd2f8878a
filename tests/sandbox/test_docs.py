"""What docs/programs.md says holds: its examples run, what it says is refused is refused."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from grammar.explain import explain_program
from robot_api.stub import stub
from sandbox.check import check
from sandbox.limits import MAX_PROGRAM, Limits
from tests.sandbox.ward import Ward

PAGE = (Path(__file__).parents[2] / "docs" / "programs.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"^```python(.*?)\n(.*?)^```", PAGE, re.MULTILINE | re.DOTALL)


def of_kind(kind: str) -> list[str]:
    found = [source for name, source in EXAMPLES if name.strip() == kind]
    assert found
    return found


@pytest.mark.parametrize("source", of_kind(""))
def test_examples_run(source: str) -> None:
    assert check(source, stub()) == []
    ward = Ward(answers=("yes", "no"))
    # Nobody has to come for a visitor to be shown the way here.
    ward.cancelled.set()
    outcome = ward.run(source.replace("robot.wait_for(", "robot.find("))
    assert outcome.status == "done", outcome
    assert explain_program(source)


@pytest.mark.parametrize("source", of_kind("refused"))
def test_what_is_refused_is(source: str) -> None:
    assert any(finding.severity == "error" for finding in check(source, stub()))


@pytest.mark.parametrize("source", of_kind("host"))
def test_the_example_for_developers(source: str, capsys: pytest.CaptureFixture[str]) -> None:
    scope: dict[str, object] = {}
    exec(source, scope)
    assert scope["findings"] == []
    assert getattr(scope["outcome"], "status", None) == "done"
    assert "line 2: say" in capsys.readouterr().out


def test_limits_are_as_the_page_says() -> None:
    limits = Limits()
    assert f"| {limits.computing:.0f} seconds |" in PAGE
    assert f"| {limits.total_computing:.0f} seconds |" in PAGE
    assert f"| {limits.memory // 1_000_000} MB |" in PAGE
    assert f"| {limits.calls:,} |" in PAGE
    assert f"| {limits.output // 1_000_000} MB |" in PAGE
    assert f"| {MAX_PROGRAM // 1000} kB |" in PAGE
