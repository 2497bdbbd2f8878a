"""There and back: what the rules can say becomes a program that is sound, does what it can in the
simulated world, and is told in full."""

from __future__ import annotations

import functools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar.explain import explain
from grammar.language import languages, load_language
from grammar.lexicon import Lexicon
from grammar.naming import naming
from grammar.program import write_program
from grammar.sampler import sensible
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.review.rehearsal import Budget, rehearse
from robot_api import errors
from robot_api.stub import stub
from sandbox.check import check
from sim.simulation import Simulation
from sim.world.loading import load_world
from tests.grammar.program_words import untold

STUB = stub()
WORLD = load_world(DEFAULT_WORLD)
BUDGET = Budget(seconds=120, calls=100, rounds=10_000)
"""A loop without an end is cut short."""
FAULTS = {"InvalidCall", "InternalError"}
"""Errors of a robot that a program of ours never leads to; what is not there or cannot be done is
no fault of the program."""


@functools.cache
def names(language: str) -> Lexicon:
    return Knowledge(WORLD).lexicon(language)


def check_round_trip(language: str, seed: int) -> None:
    sampled = sensible(names(language), language, seed)
    program = write_program(sampled.plan)
    faults = [finding for finding in check(program, STUB) if finding.severity == "error"]
    assert not faults, f"{sampled.sentence}\n{program}"
    called = naming(names(language), load_language(language)).called
    told = explain(sampled.plan, language, called)
    left_out = untold(program, told, language, called)
    assert not left_out, f"{sampled.sentence}\n{program}\n{told}\nwithout {left_out}"
    run = rehearse(program, Simulation(WORLD, seed=seed), BUDGET, seed)
    known = run.error is None or hasattr(errors, run.error)
    assert run.status in ("done", "unfinished", "stopped") or (
        run.status == "failed" and known and run.error not in FAULTS
    ), f"{sampled.sentence}\n{program}\n{run.status}: {run.message}"


@pytest.mark.parametrize("language", languages())
@settings(max_examples=12, deadline=None)
@given(seed=st.integers(0, 10**9))
def test_what_can_be_said_can_be_done_and_is_told(language: str, seed: int) -> None:
    check_round_trip(language, seed)
