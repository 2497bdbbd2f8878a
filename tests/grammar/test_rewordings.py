"""Other ways to say the same (`rewordings:` in a language's folder)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest

from grammar import rewordings
from grammar.language import load_language
from grammar.network import RuleError
from nl2robot.translate.translation import translate
from tests.errands.families import knowledge

BUILDING = {"en": "building.yaml", "de": "building_de.yaml", "fr": "building_fr.yaml"}


def shown() -> Iterator[Any]:
    for code in ("en", "de", "fr"):
        for entry in load_language(code).rewordings:
            for said, plainly in entry["like"].items():
                yield pytest.param(code, said, plainly, id=f"{code}: {said}")


@pytest.mark.parametrize(("code", "said", "plainly"), [*shown()])
def test_what_is_said_otherwise_becomes_the_same_program(
    code: str, said: str, plainly: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    meant = translate(plainly, knowledge(BUILDING[code]), code)
    assert meant.program is not None, meant.message
    assert _steps(translate(said, knowledge(BUILDING[code]), code).program) == _steps(meant.program)
    # And the rules alone would not make it.
    monkeypatch.setattr(rewordings, "_listed", lambda language: {})
    assert _steps(translate(said, knowledge(BUILDING[code]), code).program) != _steps(meant.program)


def _steps(program: str | None) -> list[str]:
    return [line for line in (program or "").splitlines() if not line.lstrip().startswith("#")]


def test_every_rewording_shows_what_it_is_good_for() -> None:
    for code in ("en", "de", "fr"):
        for entry in load_language(code).rewordings:
            assert entry.get("like"), entry["say"]


def test_what_is_quoted_is_spoken_as_it_is() -> None:
    translation = translate('Say "Somebody should go to the kitchen"', knowledge("building.yaml"))
    assert "Somebody should go to the kitchen" in (translation.program or "")


def test_a_part_stands_first_only_at_the_beginning_of_a_clause() -> None:
    entry = {"say": "<person_ref> ought to", "instead": "please", "like": {}}
    odd = replace(load_language("en"), rewordings=(entry,))
    with pytest.raises(RuleError, match="begin with words"):
        rewordings._listed(odd)


def test_who_was_asked_is_not_asked_again_in_other_words() -> None:
    asked = "Ask Clara whether she can see the visitor. If she is busy, tell the visitor to wait"
    assert "busy" not in (translate(asked, knowledge("building.yaml")).program or "")


def test_what_is_refused_for_its_sense_is_not_said_otherwise() -> None:
    assert translate("Somebody should hit Bob", knowledge("building.yaml")).program is None
