"""What is added to a command, or taken from it, is heard: a command that is spoilt is refused, and
one that means something else becomes another program."""

from __future__ import annotations

import functools
import random
from pathlib import Path
from typing import Any

import pytest
import yaml

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
SAMPLED = 80
LOST_AT_MOST = 0.04
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


def sample(language: str, number: int) -> list[tuple[str, str, random.Random]]:
    """Commands with their programs, the same ones each time, each with dice of its own."""
    dice = random.Random(number)
    chosen = dice.choices(commands(language), k=SAMPLED)
    return [(*each, random.Random(dice.random())) for each in chosen]


def few(lost: list[str]) -> None:
    """Every loss is a mistake; but what others add must not stop everybody at once."""
    assert len(lost) <= LOST_AT_MOST * SAMPLED, "\n".join(lost)


@pytest.mark.parametrize("language", languages())
def test_what_spoils_a_command_is_not_passed_over(language: str) -> None:
    lost: list[str] = []
    for sentence, before, dice in sample(language, 1):
        spoilt = f"{sentence} {dice.choice(SPOILT[language])}"
        understood = understand(spoilt, hospital(language), language)
        if understood.plan is None or understood.plan.background:
            continue  # what is said besides is shown
        after = program(understood.plan)
        if after == before or not ends_in_text(sentence, language):
            lost.append(f"{spoilt}: {after}")
    few(lost)


@pytest.mark.parametrize("language", languages())
def test_what_turns_a_command_round_is_not_obeyed(language: str) -> None:
    lost: list[str] = []
    for sentence, before, dice in sample(language, 2):
        turned = f"{dice.choice(REVERSED[language])} {sentence[0].lower()}{sentence[1:]}"
        understood = understand(turned, hospital(language), language)
        if understood.plan is not None and program(understood.plan) == before:
            lost.append(turned)
    few(lost)


@pytest.mark.parametrize("language", languages())
def test_no_word_is_passed_over(language: str) -> None:
    """A word that nobody knows, anywhere in a command, is in its program or a reason to refuse."""
    lost: list[str] = []
    for sentence, _, dice in sample(language, 3):
        words = sentence.split()
        at = dice.randint(0, len(words))
        changed = " ".join([*words[:at], UNKNOWN[language], *words[at:]])
        understood = understand(changed, hospital(language), language)
        if understood.plan is None:
            continue
        shown = program(understood.plan) + " ".join(understood.plan.background)
        if UNKNOWN[language][:4] not in shown.lower():
            lost.append(f"{changed}: {shown}")
    few(lost)
