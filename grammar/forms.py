"""How values are said in Python: one table, from which they are written and read back.

A template is Python in which the names of the node's fields stand for what is in them:

    Form(p.Occurrences, "of.count(item)")        ->   answers.count("yes")

The first form of a node whose fixed fields are as they are in it is the one that is written; all
are read, and so are those of `ALIKE`, other ways to say the same.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final

from grammar import plan as p
from grammar.layout import Atom, Brackets, Call, Document, Prefix, enclosed, flat


@dataclass(frozen=True)
class Form:
    node: type[p.Node]
    template: str
    fixed: dict[str, Any] = field(default_factory=dict)
    """Fields that are always like this where the form is used."""

    @cached_property
    def tree(self) -> ast.expr:
        return ast.parse(self.template, mode="eval").body

    @cached_property
    def gaps(self) -> frozenset[str]:
        """The fields that have a place in the template."""
        names = set(self.node.__struct_fields__) - self.fixed.keys()
        return frozenset(names & {each.id for each in _names(self.tree)})

    @cached_property
    def uses(self) -> frozenset[str]:
        """The functions and modules of Python, or helpers, in the template."""
        return frozenset(each.id for each in _names(self.tree)) - self.gaps

    def fits(self, node: p.Node) -> bool:
        return type(node) is self.node and all(
            getattr(node, name) == value for name, value in self.fixed.items()
        )

    def written(self, inside: Callable[[str], Document]) -> Document:
        """The template with a document in each gap."""
        return _document(self.tree, {name: inside(name) for name in self.gaps})

    def found(self, node: ast.expr) -> dict[str, ast.expr] | None:
        """What is in the gaps if the expression is said in this form."""
        gaps: dict[str, ast.expr] = {}
        return gaps if _alike(self.tree, node, self.gaps, gaps) else None


ZERO: Final = p.Number(0)

FORMS: Final = (
    Form(p.Length, "len(of)"),
    Form(p.Item, "of[at]", {"default": None}),
    Form(p.Item, "of.get(at, default)"),
    Form(p.Values, "list(of.values())"),
    Form(p.KeyOf, "key_of_max(of)", {"function": "max"}),
    Form(p.KeyOf, "key_of_min(of)", {"function": "min"}),
    Form(p.Occurrences, "of.count(item)"),
    Form(p.Sorted, "sorted(of)", {"descending": False}),
    Form(p.Sorted, "sorted(of, reverse=True)", {"descending": True}),
    Form(p.Distinct, "list(dict.fromkeys(of))"),
    Form(p.Range, "range(stop)", {"start": ZERO}),
    Form(p.Range, "range(start, stop)"),
    Form(p.Aggregate, "sum(of)", {"function": "sum"}),
    Form(p.Aggregate, "min(of, default=0)", {"function": "min"}),
    Form(p.Aggregate, "max(of, default=0)", {"function": "max"}),
    Form(p.Round, "round(of)", {"digits": ZERO}),
    Form(p.Round, "round(of, digits)"),
    Form(p.Absolute, "abs(of)"),
    Form(p.NumberIn, "number_in(of)"),
    Form(p.Share, "percent(part, whole)"),
    Form(p.Figure, "sum_of(of)", {"how": "sum"}),
    Form(p.Figure, "average_of(of)", {"how": "average"}),
    Form(p.Figure, "highest_of(of)", {"how": "highest"}),
    Form(p.Figure, "lowest_of(of)", {"how": "lowest"}),
    Form(p.Elapsed, "minutes_since(since)"),
    Form(p.HasCome, "has_come(time, since)"),
    Form(p.Choice, "random.choice(among)"),
    # After all that begin like it.
    Form(p.ListOf, "list(of)"),
)

ALIKE: Final = (
    Form(p.ListOf, "of.keys()"),
    Form(p.ListOf, "of.copy()"),
    Form(p.Values, "of.values()"),
    Form(p.KeyOf, "max(of, key=of.get)", {"function": "max"}),
    Form(p.KeyOf, "min(of, key=of.get)", {"function": "min"}),
    Form(p.Sorted, "sorted(of, reverse=False)", {"descending": False}),
    Form(p.Distinct, "set(of)"),
    Form(p.Aggregate, "min(of)", {"function": "min"}),
    Form(p.Aggregate, "max(of)", {"function": "max"}),
)


def form_of(node: p.Node) -> Form | None:
    """The form in which the node is written; None if it has none of its own."""
    return next((form for form in FORMS if form.fits(node)), None)


def _names(tree: ast.expr) -> Iterator[ast.Name]:
    return (each for each in ast.walk(tree) if isinstance(each, ast.Name))


# --- writing -------------------------------------------------------------------------------------


def _document(tree: ast.expr, gaps: dict[str, Document]) -> Document:
    match tree:
        case ast.Name(id=name):
            return gaps.get(name, Atom(name))
        case ast.Attribute(value=inner, attr=name):
            return Prefix("", enclosed(_document(inner, gaps)), f".{name}")
        case ast.Subscript(value=inner, slice=at):
            head = flat(enclosed(_document(inner, gaps)))
            return Brackets(f"{head}[", (_document(at, gaps),), "]", trailing_comma=False)
        case ast.Call(func=ast.Attribute(value=inner, attr=name), args=[], keywords=[]):
            return Prefix("", enclosed(_document(inner, gaps)), f".{name}()")
        case ast.Call(func=function, args=arguments, keywords=keywords):
            named = (Prefix(f"{each.arg}=", _document(each.value, gaps)) for each in keywords)
            written = (*(_document(each, gaps) for each in arguments), *named)
            return Call(flat(_document(function, gaps)), written)
        case _:
            return Atom(ast.unparse(tree))


# --- reading -------------------------------------------------------------------------------------


def _alike(tree: ast.AST, node: ast.AST, names: frozenset[str], gaps: dict[str, ast.expr]) -> bool:
    """Whether the node is as the template says, and what is in its gaps."""
    if isinstance(tree, ast.Name) and tree.id in names and isinstance(node, ast.expr):
        known = gaps.setdefault(tree.id, node)
        return ast.dump(known) == ast.dump(node)
    return type(tree) is type(node) and all(
        _parts_alike(getattr(tree, name), getattr(node, name, None), names, gaps)
        for name in tree._fields
    )


def _parts_alike(part: Any, other: Any, names: frozenset[str], gaps: dict[str, ast.expr]) -> bool:
    match part:
        case ast.AST():
            return isinstance(other, ast.AST) and _alike(part, other, names, gaps)
        case list():
            return len(part) == len(other) and all(
                _parts_alike(each, its, names, gaps) for each, its in zip(part, other, strict=True)
            )
        case _:
            return bool(part == other)
