"""What is added to a command, or taken from it, is heard: a command that is spoilt is refused, and
one that means something else becomes another program."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar.language import languages
from grammar.understand import understand
from tests.grammar.hospitals import hospital
from tests.grammar.ward import program

HERE = Path(__file__).parent

# What no robot here can do or keep to, for the end of a command that does not end in free text.
SPOILT = {
    "en": ["and hum a tune", "without shouting", "unless it rains", "like yesterday",
           "but keep it secret", "and zorple it",  "as Bob does"],
    "de": ["und summ ein Lied", "ohne zu schreien", "außer es regnet", "wie gestern",
           "aber heimlich", "und zorpel es", "wie Bob"],
    "fr": ["et fredonne une chanson", "sans crier", "sauf s'il pleut", "comme hier",
           "mais en secret", "et zorple-le", "jamais", "comme Bob"],
}  # fmt: skip
REVERSED = {
    "en": ["don't", "never", "pretend to", "I forgot to", "nobody should", "yesterday I had to"],
    "de": ["tu so, als ob du", "niemand soll", "statt zu"],
    "fr": ["fais semblant de", "personne ne doit", "au lieu de"],
}
OPEN = {"text", "noun", "word", "remark", "question", "ask_to"}
"""What may go on with any words."""
TAKEN_BACK = {"no", "nein", "non", "sorry", "pardon"}
"""Who says this takes back what they said."""
UNKNOWN = {"en": "zorple", "de": "zorpel", "fr": "zorple"}


def said(value: Any) -> list[str]:
    if isinstance(value, dict):
        return [value["say"]] if "say" in value else [s for v in value.values() for s in said(v)]
    return [s for v in value for s in said(v)] if isinstance(value, list) else []


@functools.cache
def commands(language: str) -> list[tuple[str, str]]:
    """Proper commands with their programs."""
    found: list[tuple[str, str]] = []
    files = sorted(HERE.glob(f"sentences_{language}*.yaml"))
    for file in files:
        for each in said(yaml.load(file.read_text(encoding="utf-8"), Loader=yaml.BaseLoader)):
            understood = understand(each, hospital(language), language)
            plain = not TAKEN_BACK & set(each.lower().replace(",", "").split()) and '"' not in each
            if understood.plan is not None and plain:
                found.append((each.rstrip(" .!?"), program(understood.plan)))
    return found


def ends_in_text(sentence: str, language: str) -> bool:
    """Whether words more at the end may belong to what is said, asked or looked for."""
    understood = understand(sentence, hospital(language), language)
    end = len(sentence.rstrip(" .!?"))
    return any(
        part.meaning in OPEN and part.start + len(part.words) >= end for part in understood.parts
    )


def draw(data: st.DataObject, language: str) -> tuple[str, str]:
    return data.draw(st.sampled_from(commands(language)))


@pytest.mark.parametrize("language", languages())
@settings(max_examples=60)
@given(data=st.data())
def test_what_spoils_a_command_is_not_passed_over(language: str, data: st.DataObject) -> None:
    sentence, before = draw(data, language)
    spoilt = f"{sentence} {data.draw(st.sampled_from(SPOILT[language]))}"
    understood = understand(spoilt, hospital(language), language)
    if understood.plan is None or understood.plan.background:
        return  # what is said besides is shown
    after = program(understood.plan)
    assert after != before, f"{spoilt}: {after}"
    assert ends_in_text(sentence, language), f"{spoilt}: {after}"


@pytest.mark.parametrize("language", languages())
@settings(max_examples=40)
@given(data=st.data())
def test_what_turns_a_command_round_is_not_obeyed(language: str, data: st.DataObject) -> None:
    sentence, before = draw(data, language)
    turned = f"{data.draw(st.sampled_from(REVERSED[language]))} {sentence[0].lower()}{sentence[1:]}"
    understood = understand(turned, hospital(language), language)
    assert understood.plan is None or program(understood.plan) != before, turned


@pytest.mark.parametrize("language", languages())
@settings(max_examples=60)
@given(data=st.data())
def test_no_word_is_passed_over(language: str, data: st.DataObject) -> None:
    """A word that nobody knows, anywhere in a command, is in its program or a reason to refuse."""
    sentence, _ = draw(data, language)
    words = sentence.split()
    at = data.draw(st.integers(0, len(words)))
    changed = " ".join([*words[:at], UNKNOWN[language], *words[at:]])
    understood = understand(changed, hospital(language), language)
    if understood.plan is None:
        return
    shown = program(understood.plan) + " ".join(understood.plan.background)
    assert UNKNOWN[language][:4] in shown.lower(), f"{changed}: {shown}"
