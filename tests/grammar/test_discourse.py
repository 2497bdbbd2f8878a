"""What was spoken of is remembered in values, so that nothing that is only tried leaves a trace."""

from __future__ import annotations

import dataclasses
import re
from contextlib import suppress
from typing import Any

import pytest

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse
from grammar.errors import NotUnderstood
from grammar.program import write_program
from grammar.understand import understand
from tests.grammar.ward import WARD

ERRANDS = (
    "ask Alice and Bob whether they want tea, and bring it to whoever wants some",
    "go to every ward and count the people, then come back and tell me how many there are in each",
    "if Bob is in the lobby, tell him to wait there; if not, look for him in the kitchen",
    "bring the cup from the kitchen to Alice, then put the plate there",
    "wait for Bob in the lobby, then come back and tell me where he was",
)


def test_no_room_can_be_changed() -> None:
    rooms = [
        field.default_factory
        for field in dataclasses.fields(Discourse)
        if dataclasses.is_dataclass(field.default_factory)
    ]
    assert len(rooms) == 9
    for room in rooms:
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(room(), dataclasses.fields(room)[0].name, None)
        for field in dataclasses.fields(room):
            assert not re.search(r"\b(list|dict|set|Steps)\b", str(field.type)), field.name


@pytest.mark.parametrize("errand", ERRANDS)
def test_what_is_only_tried_changes_nothing(errand: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each part is tried before it is made: all is as it was, and so is the program."""
    program = _program(errand)
    build = Discourse.build
    tried = []

    def trying_first(d: Discourse, part: Leaf | Node) -> Any:
        if not tried or tried[-1] is not None:  # not while something is tried
            before = {name: _kept(value) for name, value in vars(d).items()}
            tried.append(None)
            with suppress(NotUnderstood):
                d.tried(part)
            tried[-1] = part
            assert {name: _kept(value) for name, value in vars(d).items()} == before
        return build(d, part)

    monkeypatch.setattr(Discourse, "build", trying_first)
    assert _program(errand) == program
    assert len(tried) > 3


def _program(errand: str) -> str:
    plan = understand(errand, WARD).plan
    assert plan is not None
    return write_program(plan)


def _kept(value: Any) -> Any:
    return [_kept(each) for each in value] if isinstance(value, list) else value
