"""A program whose rounds are counted: of its loops, and the calls of its functions.

What a program may compute is counted, where it has to be the same on every machine, since Monty
itself knows only seconds. Each round calls `TICK` first, which the interpreter defines; nothing is
moved to another line.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from typing import Final

TICK: Final = "_robot_tick()"
"""Called at each round; its value counts as false."""

_DEFINITIONS: Final = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


def counted(program: str) -> str:
    """The program with a tick at each round; as it was where that is more than we understand, and
    if it is no Python."""
    try:
        lines = program.encode().split(b"\n")
        pieces = sorted(_ticks(ast.parse(program)), key=lambda piece: piece[0])
        for (line, column), text in reversed(pieces):
            row = lines[line - 1]
            lines[line - 1] = row[:column] + text + row[column:]
        with_ticks = b"\n".join(lines).decode()
        ast.parse(with_ticks)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return program
    return with_ticks


_Piece = tuple[tuple[int, int], bytes]
"""Line and column (in bytes) at which something is put in, and what."""


def _ticks(tree: ast.AST) -> Iterator[_Piece]:
    for node in ast.walk(tree):
        match node:
            case ast.For() | ast.AsyncFor() | ast.FunctionDef() | ast.AsyncFunctionDef():
                yield from _first(node.body)
            case ast.While():
                yield from _around(node.test)
            case ast.Lambda():
                yield from _around(node.body)
            case ast.DictComp():
                yield from _around(node.key)
                yield from _within(node.generators)
            case ast.ListComp() | ast.SetComp() | ast.GeneratorExp():
                yield from _around(node.elt)
                yield from _within(node.generators)


def _within(generators: Sequence[ast.comprehension]) -> Iterator[_Piece]:
    """What a comprehension does without giving anything."""
    for generator in generators:
        for condition in generator.ifs:
            yield from _around(condition)
    for generator in generators[1:]:
        yield from _around(generator.iter)


def _first(body: Sequence[ast.stmt]) -> Iterator[_Piece]:
    """Before the first statement of a body that does something; a compound one has no room before
    it on its line, so the tick goes to what it looks at first."""
    for statement in body:
        match statement:
            case ast.If(test=first) | ast.Match(subject=first):
                yield from _around(first)
            case ast.For(iter=first) | ast.AsyncFor(iter=first):
                yield from _around(first)
            case ast.With(items=[ast.withitem(context_expr=first), *_]):
                yield from _around(first)
            case ast.Try(body=inner):
                yield from _first(inner)
            case ast.While():
                pass  # it ticks by itself
            case _ if isinstance(statement, _DEFINITIONS):
                continue
            case _:
                yield (statement.lineno, statement.col_offset), f"{TICK}; ".encode()
        return


def _around(node: ast.expr) -> Iterator[_Piece]:
    """An expression with a tick before it."""
    assert node.end_lineno is not None and node.end_col_offset is not None
    yield (node.lineno, node.col_offset), f"({TICK} or (".encode()
    yield (node.end_lineno, node.end_col_offset), b"))"
