"""Which programs need no question before they run: those that only look or tell.

Which calls do so says the method table (`looks_or_tells`). Somebody still approves: whoever asked
for it, by asking, and the log says that they were not asked again.
"""

from __future__ import annotations

import ast
from typing import Final

from grammar.language import load_language
from nl2robot.review.review import Review
from nl2robot.translate.outcome import Translation
from robot_api.methods import METHODS

HARMLESS: Final = frozenset(method.name for method in METHODS.values() if method.looks_or_tells)
ONLY_LOOKS: Final = HARMLESS - {"say", "answer", "log"} | {"wait"}
"""What leaves no trace in the world."""
TOLD: Final = "answer"
"""It listens to people, unless it is given what to answer."""


def needs_no_question(review: Review, translation: Translation | None = None) -> bool:
    """Whether a reviewed program does nothing but look and tell, and nothing is to be thought
    about: no mark of the review, a dry run to its end, and nothing that a language model left out
    or made up. `translation`: what it was made of, if it stands as it was made."""
    if translation is not None and (translation.unused or translation.own):
        return False
    if review.dry_run is not None and review.dry_run.status != "done":
        return False
    return not (review.findings or review.risks) and only_looks_or_tells(review.program)


def only_looks_or_tells(program: str) -> bool:
    """Whether a program does nothing but look and tell, one thing after the other."""
    tree = ast.parse(program)
    if any(isinstance(node, ast.For | ast.While | ast.FunctionDef) for node in ast.walk(tree)):
        return False
    return _methods(tree) <= HARMLESS


def approver(who: str, language: str) -> str:
    """What the log says of who approved a program that nobody was asked about."""
    return load_language(language).phrase("needed_no_question", who=who)


def _methods(tree: ast.Module) -> set[str]:
    """The robot's methods that it calls; "" for one that goes by another name."""
    plain = {
        id(node.func.value): node.func.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and isinstance(node.func.value, ast.Name)
        and node.func.value.id == "robot"
        and (node.func.attr != TOLD or node.args or node.keywords)
    }
    return {
        plain.get(id(node), "")
        for node in ast.walk(tree)
        if isinstance(node, ast.Name) and node.id == "robot"
    }
