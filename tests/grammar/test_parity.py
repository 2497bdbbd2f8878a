"""What English can mean, German and French can: but for what is listed, with the reason."""

from __future__ import annotations

import pytest

from grammar.language import languages
from tests.grammar.parity import ALLOWED, FIRST, allowed, gaps


@pytest.mark.parametrize("language", [each for each in languages() if each != FIRST])
def test_a_language_can_mean_what_english_can(language: str) -> None:
    known = {name for names in allowed(language).values() for name in names}
    new = sorted(gaps(language) - known)
    assert not new, (
        f"There are no words in {language!r} for: {', '.join(new)}. Give its rules templates for"
        f" them, or list them in {ALLOWED.name} (python -m tests.grammar.parity)."
    )
