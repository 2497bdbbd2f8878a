"""A draft with its program and what the check says of it."""

from __future__ import annotations

from dataclasses import dataclass

from grammar.checking import Checked, check
from grammar.planning.planner import Draft
from grammar.planning.turn import Turn
from grammar.program import write_program
from grammar.writing import PlanError


@dataclass(frozen=True)
class Considered:
    draft: Draft
    program: str
    checked: Checked


def consider(turn: Turn, draft: Draft) -> Considered | None:
    """None for a plan that no program can carry out."""
    try:
        program = write_program(draft.plan)
    except PlanError:
        return None
    return Considered(draft, program, check(turn, draft.plan, exact=draft.exact))
