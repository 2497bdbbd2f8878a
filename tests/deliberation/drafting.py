"""Drafts as a language model would have written them, for the stories of this folder."""

from __future__ import annotations

from grammar.language import load_language
from grammar.normal import normal
from grammar.planning.model.expansion import expanded
from grammar.planning.model.prompt import vocabulary
from grammar.planning.planner import Draft
from grammar.planning.turn import Turn
from grammar.understanding import Context
from nl2robot.knowledge import Knowledge
from robot_api.driver import Capabilities
from sim.world.loading import load_world

WARD = Knowledge(load_world("ward", names_only=True))
ARMLESS = Knowledge(
    WARD.world,
    Capabilities(
        name="Armless",
        kind="pepper",
        methods=("goto", "say", "ask", "find", "sees", "wait", "stop"),
        languages=("en",),
    ),
)
"""A robot that cannot gesture or grab."""


def turn(text: str, language: str = "en", knowledge: Knowledge = WARD) -> Turn:
    return Turn(text, knowledge.lexicon(language), load_language(language))


def draft(turn: Turn, written: str, probability: float = 0.5, **known: float) -> Draft:
    """A draft of a program in the dialect."""
    plan = normal(expanded(written, vocabulary(turn).people, turn.lexicon, turn.language))
    return Draft(plan, "model", probability, Context(plan=plan, text=turn.text), **known)  # type: ignore[arg-type]


def drafts(turn: Turn, *written: str) -> list[Draft]:
    """Each a little less likely than the one before."""
    weights = [0.9**number for number in range(len(written))]
    return [draft(turn, each, w / sum(weights)) for each, w in zip(written, weights, strict=True)]
