"""Loops that go on until somebody stops the robot: a reception, a patrol."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence


def loops(tree: ast.AST) -> Iterator[ast.While]:
    """Those that nothing in them ends."""
    for node in ast.walk(tree):
        if isinstance(node, ast.While) and _is_true(node.test) and not _ends(node.body):
            yield node


def went_on(program: str, lines: Sequence[int]) -> bool:
    """Whether a program that was broken off is one that has no end, and was going on as it is
    meant to. `lines`: of the robot calls that it made, the one at which it was broken off last.

    It is if it was in a loop without end that stands in no other loop: what stands in one that
    ought to end keeps that from it. For the same reason it is not if it was in a loop within, such
    as one that waits for something, that has never come to its end."""
    if not lines:
        return False
    loop = next(
        (each for each in _outermost(ast.parse(program).body) if _covers(each, lines[-1])), None
    )
    return loop is not None and all(
        _ended_before(inner, lines) for inner in _within(loop) if _covers(inner, lines[-1])
    )


def _outermost(steps: Sequence[ast.stmt]) -> Iterator[ast.While]:
    """The loops without end that a program comes to once: in no loop, and in no function."""
    for step in steps:
        if isinstance(step, ast.While) and step in loops(step):
            yield step
        elif isinstance(step, ast.If | ast.With | ast.Try):
            yield from _outermost(
                [each for each in ast.iter_child_nodes(step) if isinstance(each, ast.stmt)]
            )


def _within(loop: ast.While) -> Iterator[ast.While]:
    """The loops in it that ought to end, but those that go round a list, which do."""
    endless = set(loops(loop))
    for node in ast.walk(loop):
        if isinstance(node, ast.While) and node not in endless:
            yield node


def _ended_before(loop: ast.While, lines: Sequence[int]) -> bool:
    """Whether the program was in it before, and then elsewhere."""
    been = [_covers(loop, line) for line in lines]
    return True in been and False in been[been.index(True) :]


def _covers(loop: ast.While, line: int) -> bool:
    return loop.lineno <= line <= (loop.end_lineno or loop.lineno)


def _is_true(test: ast.expr) -> bool:
    try:
        return bool(ast.literal_eval(test))
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return False


def _ends(body: Sequence[ast.stmt], in_inner_loop: bool = False) -> bool:
    """Whether something in a loop's body may end it. A `break` of a loop in it ends only that."""
    for statement in body:
        match statement:
            case ast.Return() | ast.Raise():
                return True
            case ast.Break() if not in_inner_loop:
                return True
            case ast.Expr() if ast.unparse(statement.value) == "robot.stop()":
                return True
            case ast.For(body=inner) | ast.While(body=inner):
                if _ends(inner, True) or _ends(statement.orelse, in_inner_loop):
                    return True
            case ast.If(body=inner) | ast.With(body=inner):
                if _ends([*inner, *getattr(statement, "orelse", ())], in_inner_loop):
                    return True
            case ast.Try(body=inner, orelse=orelse, finalbody=final):
                caught = [each for handler in statement.handlers for each in handler.body]
                if _ends([*inner, *caught, *orelse, *final], in_inner_loop):
                    return True
            case ast.Match(cases=cases):
                if _ends([each for case in cases for each in case.body], in_inner_loop):
                    return True
    return False
