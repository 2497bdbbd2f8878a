"""Every sentence that the documentation says can be said is understood."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from grammar.understand import understand
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from sim.world.loading import load_world

DOCS = Path(__file__).parents[2] / "docs"
PAGES = {"en": "talking.md", "de": "de/talking.md", "fr": "fr/talking.md"}
SENTENCES = [
    (language, sentence)
    for language, page in PAGES.items()
    for sentence in re.findall(r"^- (.+)$", (DOCS / page).read_text("utf-8"), re.MULTILINE)
]
KNOWLEDGE = Knowledge(load_world(DEFAULT_WORLD))


@pytest.mark.parametrize(("language", "sentence"), SENTENCES)
def test_a_sentence_of_the_page_is_understood(language: str, sentence: str) -> None:
    understood = understand(sentence, KNOWLEDGE.lexicon(language), language)
    assert understood.status == "ok", understood.message
    assert understood.plan is not None
