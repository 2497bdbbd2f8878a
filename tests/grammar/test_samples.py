"""Sample sentences come from the same rules and names; what they promise, holds."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import grammar
from grammar.language import languages, load_language
from grammar.lexicon import Lexicon
from grammar.meanings.registry import MEANINGS
from grammar.naming import naming
from grammar.program import write_program
from grammar.sampler import random_sentence, sensible
from grammar.samples import all_samples, samples
from grammar.understand import understand
from robot_api.methods import METHODS
from robot_api.stub import stub
from sandbox.check import check
from tests.grammar.hospitals import hospital

STUB = stub()
SAMPLED = 36
MAKES_SENSE = 0.3
"""The share of what is drawn. Of ten lots of so many English ones it was from 0.36 to 0.55: any new
rule, however good, has others drawn."""


@pytest.mark.parametrize("language", languages())
def test_every_meaning_that_a_rule_names_exists(language: str) -> None:
    named = {each.means for each in load_language(language).network.productions if each.means}
    assert named <= MEANINGS.keys() | METHODS.keys()


@pytest.mark.parametrize("language", languages())
@pytest.mark.parametrize("world", [hospital, lambda language: Lexicon()])
def test_all_help_is_understood(language: str, world: Callable[[str], Lexicon]) -> None:
    lexicon = world(language)
    topics = samples(lexicon, language)
    assert len(topics) >= 6
    for phrases in topics.values():
        for phrase in phrases:
            understood = understand(phrase, lexicon, language)
            assert understood.status == "ok", f"{phrase}: {understood.message}"


@settings(max_examples=80, deadline=None)
@given(st.sampled_from(languages()), st.integers(0, 10**9))
def test_what_the_rules_can_say_they_understand(language: str, seed: int) -> None:
    """What a sentence may lack is what was said before it; the whole way to a run in the simulated
    world is gone in `tests/nl2robot/test_round_trip.py`."""
    lexicon = hospital(language)
    sentence = random_sentence(lexicon, language, seed)
    understood = understand(sentence, lexicon, language)
    if understood.request is not None:  # "how many said yes?": nothing for the robot to do
        return
    if understood.plan is None:  # "put it there": nothing was spoken of before
        assert understood.message is not None
        misunderstood = load_language(language).phrase("not_understood_at_all").split(".")[0] + "."
        assert misunderstood not in understood.message, sentence
        return
    program = write_program(understood.plan)
    assert not [finding for finding in check(program, STUB) if finding.severity == "error"], program


@pytest.mark.parametrize("language", languages())
def test_most_of_what_the_sampler_draws_makes_sense(language: str) -> None:
    lexicon = hospital(language)
    drawn = [sensible(lexicon, language, seed) for seed in range(SAMPLED)]
    refused = sum(len(each.refused) for each in drawn)
    assert SAMPLED / (SAMPLED + refused) > MAKES_SENSE


@pytest.mark.parametrize("language", languages())
def test_every_phrase_that_the_code_says_exists(language: str) -> None:
    code = "".join(
        path.read_text(encoding="utf-8") for path in Path(grammar.__file__).parent.rglob("*.py")
    )
    said = set(re.findall(r'(?:\.phrase|\bd\.say|\.sentence)\(\s*"(\w+)"', code))
    assert said <= load_language(language).phrases.keys()


@pytest.mark.parametrize("language", languages())
def test_everybody_in_a_world_stands_in_whole_sentences(language: str) -> None:
    lexicon = hospital(language)
    said = " ".join(all_samples(lexicon, language)).lower()
    for person in lexicon.people:  # places may be inflected
        called = naming(lexicon, load_language(language)).called(person.name)
        assert called.lower() in said, person
    assert {*itertools.chain(*samples(lexicon, language).values())} <= {
        *all_samples(lexicon, language)
    }


@pytest.mark.parametrize("language", languages())
def test_what_else_people_say_is_understood_alone_or_after_a_command(language: str) -> None:
    lexicon = hospital(language)
    commands = list(itertools.chain(*samples(lexicon, language).values()))
    sayings = load_language(language).sayings
    assert len(sayings) >= 100
    unknown = []
    for said in all_samples(lexicon, language):
        contexts = (understand(each, lexicon, language).context for each in commands)
        if not any(
            understood.status != "rejected" or understood.request is not None
            for context in itertools.chain([None], contexts)
            for understood in [understand(said, lexicon, language, context)]
        ):
            unknown.append(said)
    assert not unknown
