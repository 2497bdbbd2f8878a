"""How far a round had come that was broken off: whom and which places it had done, and which are
left. A round is a `for` over names that are known: a list of texts, or what `places` or `people`
came to.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Protocol


class Made(Protocol):
    """A robot call that the program made."""

    @property
    def method(self) -> str: ...
    @property
    def arguments(self) -> dict[str, Any]: ...
    @property
    def line(self) -> int: ...
    @property
    def result(self) -> Any: ...


@dataclass(frozen=True)
class Round:
    """How far a round had come."""

    lines: range
    """Of its `for`, with what is done in it."""
    done: tuple[str, ...]
    left: tuple[str, ...]
    """The first is the one that it was at; none if it was over."""


def rounds(program: str, done: Sequence[Made], line: int, again: Made | None = None) -> list[Round]:
    """The outermost rounds that a program had begun when it was broken off at a line; `again` is
    the call that was. Left out are those that do not tell what they go through."""
    tree = ast.parse(program)
    made = [*done, *([again] if again is not None else [])]
    return list(_rounds(tree, tree, made, line))


def _rounds(node: ast.AST, tree: ast.AST, made: Sequence[Made], at: int) -> Iterator[Round]:
    for child in ast.iter_child_nodes(node):
        found = _round(child, tree, made, at) if isinstance(child, ast.For) else None
        if found is not None:
            yield found
        else:
            yield from _rounds(child, tree, made, at)


def _round(loop: ast.For, tree: ast.AST, made: Sequence[Made], at: int) -> Round | None:
    lines = range(loop.lineno, (loop.end_lineno or loop.lineno) + 1)
    within = at in lines
    if not (within or any(call.line in lines for call in made)):
        return None
    names = _names(loop.iter, tree, made)
    if not names or not isinstance(loop.target, ast.Name):
        return None
    met = [names.index(name) for call in made for name in _used(loop, call) if name in names]
    # How often a name comes up tells nothing: it may be used in several steps.
    come = max(met, default=0) if within else max(met, default=-1) + 1
    return Round(lines, tuple(names[:come]), tuple(names[come:]) if within else ())


def _names(
    items: ast.expr, tree: ast.AST, made: Sequence[Made], through: frozenset[str] = frozenset()
) -> list[str] | None:
    """What it goes through; `through` are the variables that led there."""
    match items:
        case ast.List(elts=elements) | ast.Tuple(elts=elements):
            names = [each.value for each in elements if isinstance(each, ast.Constant)]
            whole = len(names) == len(elements)
            return [str(name) for name in names] if whole and _texts(names) else None
        case ast.Call(func=ast.Attribute(attr=method)):
            results = [c.result for c in made if (c.line, c.method) == (items.lineno, method)]
            known = results[-1] if results else None
            return known if isinstance(known, list) and _texts(known) else None
        case ast.Name(id=name) if name not in through:
            given = [
                node.value
                for node in ast.walk(tree)
                if isinstance(node, ast.Assign)
                and any(isinstance(each, ast.Name) and each.id == name for each in node.targets)
            ]
            return _names(given[0], tree, made, through | {name}) if len(given) == 1 else None
        case _:
            return None


def _texts(names: Sequence[Any]) -> bool:
    return bool(names) and all(isinstance(name, str) for name in names)


def _used(loop: ast.For, call: Made) -> Iterator[str]:
    """The name that a call of the round was made with."""
    assert isinstance(loop.target, ast.Name)
    for node in ast.walk(loop):
        if (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Attribute)
            and (node.lineno, node.func.attr) == (call.line, call.method)
        ):
            given = [*node.args, *(keyword.value for keyword in node.keywords)]
            if any(isinstance(each, ast.Name) and each.id == loop.target.id for each in given):
                yield from (value for value in call.arguments.values() if isinstance(value, str))
