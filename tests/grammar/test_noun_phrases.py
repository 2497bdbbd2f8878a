"""Noun phrases and single commands of English, each with its exact program, or with what the robot
answers instead."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from grammar.explain import explain
from grammar.program import write_program
from grammar.understand import understand
from robot_api.stub import stub
from sandbox.check import check
from tests.grammar.test_honest import unbound
from tests.grammar.ward import WARD, program

FILES = [Path(__file__).with_name(f"{name}_en.yaml") for name in ("noun_phrases", "commands")]
ROWS = [
    (row["say"], row.get("means"), row.get("refused"))
    for file in FILES
    for rows in yaml.load(file.read_text(encoding="utf-8"), Loader=yaml.BaseLoader).values()
    for row in rows
]
STUB = stub()


@pytest.mark.parametrize(("sentence", "meaning", "answer"), ROWS, ids=[row[0][:60] for row in ROWS])
def test_a_noun_phrase_means_this(sentence: str, meaning: str | None, answer: str | None) -> None:
    understood = understand(sentence, WARD)
    if meaning is None:
        assert understood.plan is None
        assert understood.message == answer
        return
    assert understood.plan is not None, understood.message
    assert program(understood.plan) == meaning
    source = write_program(understood.plan)
    assert not unbound(source)
    assert not [each for each in check(source, STUB) if each.severity == "error"], source
    assert explain(understood.plan)
