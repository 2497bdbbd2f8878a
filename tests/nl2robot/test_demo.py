"""`make run`, as a stranger sees it first."""

from __future__ import annotations

from pathlib import Path

import pytest

from nl2robot.cli import main as cli
from nl2robot.errors import ExitStatus


def test_a_typed_and_a_spoken_command_are_run_and_drawn(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["demo", "--folder", str(tmp_path / "runs")]) == ExitStatus.OK
    said = capsys.readouterr().out
    assert "Typed:" in said
    assert "Spoken:" in said
    assert "The language model is left out, as NL2ROBOT_LANGUAGE_MODEL says." in said
    for name in ("typed", "spoken"):
        for ending in ("svg", "png", "webp"):
            assert (tmp_path / "runs" / f"{name}.{ending}").stat().st_size > 10_000
