"""The tutorials, done: their commands are run one after the other, and say what stands there."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.played import ROOT, play

PAGES = sorted((ROOT / "docs").rglob("tutorials/*.md"))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT / "docs").as_posix())
def test_a_tutorial_says_what_happens(page: Path, tmp_path: Path) -> None:
    assert play(page, tmp_path) > 2
