"""Constructs of English, one by one: what each means, exactly; and that its program is sound."""

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

FILES = [
    Path(__file__).with_name(name)
    for name in ("constructs_en.yaml", "clauses_en.yaml", "reports_en.yaml")
]
ROWS = [
    (row["say"], row["means"])
    for file in FILES
    for rows in yaml.load(file.read_text(encoding="utf-8"), Loader=yaml.BaseLoader).values()
    for row in rows
]
STUB = stub()


@pytest.mark.parametrize(("sentence", "meaning"), ROWS, ids=[say[:60] for say, _ in ROWS])
def test_a_construct_means_this(sentence: str, meaning: str) -> None:
    understood = understand(sentence, WARD)
    assert understood.plan is not None, understood.message
    assert program(understood.plan) == meaning
    source = write_program(understood.plan)
    assert not unbound(source)
    assert not [each for each in check(source, STUB) if each.severity == "error"], source
    assert explain(understood.plan)
