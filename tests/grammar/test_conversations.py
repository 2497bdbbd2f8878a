"""Whole conversations: answers, corrections, additions make sentences that could have been said."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml

from grammar.understand import understand
from grammar.understanding import Context
from nl2robot.knowledge import Knowledge
from sim.world.loading import load_world

TALKS: dict[str, list[list[Any]]] = yaml.safe_load(
    (Path(__file__).parent / "conversations.yaml").read_text(encoding="utf-8")
)
HOSPITAL = Knowledge(load_world("city-hospital", names_only=True))


@pytest.mark.parametrize(
    ("language", "talk"),
    [
        pytest.param(code, talk, id=f"{code} {talk[0][0][:40]}")
        for code, talks in TALKS.items()
        for talk in talks
    ],
)
def test_a_conversation(language: str, talk: list[Any]) -> None:
    context: Context | None = None
    for turn in talk:
        if turn == "ran":
            assert context is not None
            context = replace(context, carried_out=True)
            continue
        said, wanted = turn
        understood = understand(said, HOSPITAL.lexicon(language), language, context)
        context = understood.context
        told = f"{said!r} -> {understood.status}: {context.text!r} {understood.message}"
        match wanted:
            case {"request": kind}:
                assert understood.request is not None and understood.request.kind == kind, told
            case {"clarify": part} | {"rejected": part}:
                assert understood.status == next(iter(wanted)), told
                assert part in (understood.message or ""), told
            case _:
                assert understood.plan is not None, told
                assert context.text == (said if wanted == "so" else wanted), told
