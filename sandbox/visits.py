"""Rounds go on: a place that cannot be reached ends the visit there, not the round.

A round is a `for` whose first step drives to what it goes through:

    for place in robot.places("ward"):
        robot.goto(place)
        robot.say("Good night.")

When the way there is blocked, or nobody can stand there, the rest of that visit is left out and the
round goes on with the next place; whoever runs the program is told, and reports it. A program that
came to none of its places has failed. One place in a list of one is no round, and a program that
sees to it by itself, with `try`, is left alone.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Final

from robot_api.errors import Blocked, NotPossible
from sandbox.source import unix_newlines

CLOSED: Final = (Blocked, NotPossible)
"""What a `goto` fails with where a place cannot be reached."""
METHOD: Final = "goto"


def going_on(program: str) -> tuple[str, frozenset[int]]:
    """The program as it is run, line by line the same, and the lines of its visits: there a call of
    `goto` that is answered with False ends the visit. The program must be free of syntax errors."""
    program = unix_newlines(program)
    lines = program.split("\n")
    found: set[int] = set()
    for visit in _visits(ast.parse(program), in_try=False):
        number = visit.lineno - 1
        text = lines[number]
        if visit.end_lineno != visit.lineno or text.strip() != ast.get_source_segment(
            program, visit
        ):
            continue  # over several lines, or with something beside it
        indent = text[: len(text) - len(text.lstrip())]
        lines[number] = f"{indent}if {text.strip()} == False: continue"
        found.add(visit.lineno)
    return "\n".join(lines), frozenset(found)


def _visits(node: ast.AST, in_try: bool) -> Iterator[ast.Expr]:
    """The statements that drive to the place of a round."""
    in_try = in_try or isinstance(node, ast.Try)
    if isinstance(node, ast.For) and not in_try and not _is_of_one(node.iter):
        first = node.body[0]
        if isinstance(first, ast.Expr) and _drives_to(first.value, node.target):
            yield first
    for child in ast.iter_child_nodes(node):
        yield from _visits(child, in_try)


def _is_of_one(items: ast.expr) -> bool:
    return isinstance(items, ast.List | ast.Tuple) and len(items.elts) < 2


def _drives_to(call: ast.expr, target: ast.expr) -> bool:
    return (
        isinstance(call, ast.Call)
        and isinstance(call.func, ast.Attribute)
        and call.func.attr == METHOD
        and isinstance(call.func.value, ast.Name)
        and call.func.value.id == "robot"
        and len(call.args) == 1
        and not call.keywords
        and isinstance(call.args[0], ast.Name)
        and isinstance(target, ast.Name)
        and call.args[0].id == target.id
    )
