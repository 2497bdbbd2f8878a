"""Constructs of each language, one by one: what each means; and that its program is sound."""

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
from tests.grammar.ward_de import STATION
from tests.grammar.ward_fr import HOPITAL

FILES = {
    "constructs_en.yaml": "en",
    "clauses_en.yaml": "en",
    "reports_en.yaml": "en",
    "times_en.yaml": "en",
    "things_en.yaml": "en",
    "polls_en.yaml": "en",
    "constructs_de.yaml": "de",
    "constructs_fr.yaml": "fr",
}
WORLDS = {"en": WARD, "de": STATION, "fr": HOPITAL}
ROWS = [
    (row["say"], row["means"], language)
    for name, language in FILES.items()
    for file in [Path(__file__).with_name(name)]
    for rows in yaml.load(file.read_text(encoding="utf-8"), Loader=yaml.BaseLoader).values()
    for row in rows
]
STUB = stub()


@pytest.mark.parametrize(
    ("sentence", "meaning", "language"), ROWS, ids=[say[:60] for say, *_ in ROWS]
)
def test_a_construct_means_this(sentence: str, meaning: str, language: str) -> None:
    understood = understand(sentence, WORLDS[language], language)
    assert understood.plan is not None, understood.message
    assert program(understood.plan) == meaning
    source = write_program(understood.plan)
    assert not unbound(source)
    assert not [each for each in check(source, STUB) if each.severity == "error"], source
    assert explain(understood.plan, language)
