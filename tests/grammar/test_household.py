"""What people ask a robot of at home: each construct with its exact program, in the household."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from grammar.lexicon import Lexicon
from grammar.program import write_program
from grammar.understand import understand
from nl2robot.knowledge import Knowledge
from robot_api.stub import stub
from sandbox.check import check
from sim.world.loading import load_world
from tests.grammar.test_honest import unbound
from tests.grammar.ward import program

FILE = Path(__file__).with_name("household_en.yaml")
ROWS = [
    row
    for rows in yaml.load(FILE.read_text(encoding="utf-8"), Loader=yaml.BaseLoader).values()
    for row in rows
]
STUB = stub()


@pytest.fixture(scope="module")
def home() -> Lexicon:
    return Knowledge(load_world("household", names_only=True)).lexicon("en")


@pytest.mark.parametrize("row", [row for row in ROWS if "means" in row], ids=lambda row: row["say"])
def test_a_construct_means_this(row: dict[str, str], home: Lexicon) -> None:
    understood = understand(row["say"], home)
    assert understood.plan is not None, understood.message
    assert program(understood.plan) == row["means"]
    source = write_program(understood.plan)
    assert not unbound(source)
    assert not [each for each in check(source, STUB) if each.severity == "error"], source


@pytest.mark.parametrize("row", [row for row in ROWS if "not" in row], ids=lambda row: row["say"])
def test_what_cannot_be_done_is_said(row: dict[str, str], home: Lexicon) -> None:
    understood = understand(row["say"], home)
    assert understood.plan is None
    assert row["not"] in (understood.message or "")
