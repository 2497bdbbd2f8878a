"""Whoever runs a hospital's server asks which walls stand around programs there."""

from __future__ import annotations

import pytest

from sandbox.confinement import LAYERS
from sandbox.confinement import __main__ as table
from sandbox.worker import layers


def test_each_layer_is_told_to_hold_or_not(capsys: pytest.CaptureFixture[str]) -> None:
    table.main()
    said = capsys.readouterr().out
    for layer in LAYERS:
        assert f"{'yes' if layer in layers() else 'NO '}  {layer} " in said


def test_what_is_missing_is_explained(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(table, "layers", frozenset)
    table.main()
    said = capsys.readouterr().out
    assert "docs/programs.md" in said and "yes" not in said
