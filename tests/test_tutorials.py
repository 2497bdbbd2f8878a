"""Pages to follow at a keyboard, done: their commands are run one after the other, and say what
stands there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from robot_api.methods import METHODS
from tests.clients.conftest import tool
from tests.played import ROOT, blocks, play

DOCS = ROOT / "docs"
COURSE = DOCS / "teaching.md"
OTHERS = [DOCS / "it.md", DOCS / "privacy.md", DOCS / "clients.md"]
PAGES = [*sorted(DOCS.rglob("tutorials/*.md")), COURSE, *OTHERS]
NEEDS = {
    "javascript.md": ("node", "It is followed with Node 20 or newer: make node"),
    "broker.md": ("mosquitto", "It is followed with a broker: apt-get install mosquitto"),
}
"""What else has to be there to follow a page."""


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(DOCS).as_posix())
@pytest.mark.timeout(400)  # some have a dozen runs
def test_a_page_says_what_happens(page: Path, tmp_path: Path) -> None:
    if page.name in NEEDS:
        tool(*NEEDS[page.name])
    assert play(page, tmp_path) > 2


def test_the_course_uses_every_function_of_the_paper() -> None:
    programs = "".join(text for _, text in blocks(COURSE.read_text("utf-8")))
    called = set(re.findall(r"robot\.(\w+)\(", programs))
    assert {METHODS[name].paper for name in called} - {None} == set(range(1, 17))
