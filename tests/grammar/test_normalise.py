"""A sentence becomes tokens that keep where they stood."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar.language import load_language
from grammar.tokens import Token, tokenise

ENGLISH = load_language("en").spelling


def tokens(text: str) -> tuple[Token, ...]:
    return tokenise(text, ENGLISH)


def norms(text: str) -> str:
    return " ".join(token.norm for token in tokens(text))


@pytest.mark.parametrize(
    ("text", "normal"),
    [
        ("What's up? Don't!", "what is up . do not ."),
        ("Alice's office", "alice 's office"),
        ("room twelve, please", "room 12 , please"),
        ("Dr. Weber", "dr weber"),
        ("2.5m", "2.5 m"),
        ("turn -45°", "turn -45 degrees"),
        ("at 14:05", "at 14:05"),
        ("1,000 metres", "1000 metres"),
        ("the X-ray", "the x ray"),
        ("head_yaw", "head yaw"),
        ("wait ... here", "wait , here"),
        ("go to https://example.org/a?b=1.", "go to https://example.org/a?b=1 ."),
        ("click #submit", "click #submit"),
    ],
)
def test_words_numbers_and_marks(text: str, normal: str) -> None:
    assert norms(text) == normal


@pytest.mark.parametrize(
    "quoted", ['"good morning"', "“good morning”", "'good morning'", "«good morning»"]
)
def test_quotations_stay_whole(quoted: str) -> None:
    (say, quote) = tokens(f"say {quoted}")
    assert (say.norm, quote.kind, quote.inner) == ("say", "quote", "good morning")


def test_an_apostrophe_opens_no_quotation() -> None:
    assert norms("say it's Bob's cup") == "say it is bob 's cup"


@given(st.text(max_size=200))
def test_tokens_stand_in_order_within_the_text(text: str) -> None:
    found = tokens(text)
    assert all(0 <= token.start <= token.end <= len(text) for token in found)
    assert [token.start for token in found] == sorted(token.start for token in found)


def test_many_apostrophes_are_read_in_no_more_time_than_others() -> None:
    """With one quotation that is never closed, every way to end it was tried once: two to the power
    of them."""
    asked = " s'ils ont soif et affiche suren" * 60
    assert "demande" in norms(f"'demande{asked} !")
