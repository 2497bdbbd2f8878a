"""Every sentence that the documentation says can be said is understood."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from grammar.understand import understand
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from sim.world.loading import load_world

PAGE = Path(__file__).parents[2] / "docs" / "talking.md"
SENTENCES = re.findall(r"^- (.+)$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
LEXICON = Knowledge(load_world(DEFAULT_WORLD)).lexicon("en")


@pytest.mark.parametrize("sentence", SENTENCES)
def test_a_sentence_of_the_page_is_understood(sentence: str) -> None:
    understood = understand(sentence, LEXICON)
    assert understood.status == "ok", understood.message
    assert understood.plan is not None
