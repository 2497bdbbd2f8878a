"""Which programs may go through without being asked about, where somebody has chosen so."""

from __future__ import annotations

import ast
from typing import Final

from nl2robot.review import Review

HARMLESS: Final = frozenset(
    {
        *("say", "emotion", "set_language", "answer", "show"),
        *("location", "places", "battery", "clock", "log", "sees", "count", "objects", "people"),
        *("describe",),
    }
)
"""They move no part of the body, hand nothing over, wait for nobody and record nobody."""


def is_harmless(review: Review) -> bool:
    """Whether a reviewed program does nothing but harmless calls, one after the other, and the
    review has nothing against it."""
    if not review.acceptable or review.findings or review.risks:
        return False
    tree = ast.parse(review.program)
    if any(isinstance(node, ast.For | ast.While) for node in ast.walk(tree)):
        return False
    return _methods(tree) <= HARMLESS


def _methods(tree: ast.Module) -> set[str]:
    """The robot's methods that it calls; "" for one that goes by another name."""
    plain = {
        id(node.value): node.attr
        for node in ast.walk(tree)
        if isinstance(node, ast.Attribute)
        and isinstance(node.value, ast.Name)
        and node.value.id == "robot"
    }
    return {
        plain.get(id(node), "")
        for node in ast.walk(tree)
        if isinstance(node, ast.Name) and node.id == "robot"
    }
