"""Whole conversations on the ward: translated, approved, run, and asked about afterwards."""

from pathlib import Path

import pytest
import yaml

TALKS = yaml.safe_load(
    (Path(__file__).parents[1] / "stories" / "ward_talks.yaml").read_text(encoding="utf-8")
)


@pytest.mark.parametrize("language", TALKS)
def test_a_day_on_the_ward(operator, language) -> None:
    program = None
    for said, wanted in TALKS[language]:
        if said == "run":
            assert program is not None
            review = operator.check(program.program, language)
            run = operator.run(operator.approve(review, program))
            assert operator.wait(run).state == wanted
            continue
        answer = operator.translate(said, language, "auto", "the ward")
        program = answer if answer.program is not None else program
        assert wanted in (answer.program or answer.message or ""), (said, answer)
