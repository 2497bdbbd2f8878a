"""From a program back to a plan, as far as plans go, so that an edited program can be explained.

What `grammar.program` writes is read back as what it was written from. Anything else that Python
can say is kept as code (`Code`, `CodeStep`, `Function`), which explanations quote as it stands: a
reader never misses a robot call, though it may not be in plain words.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final

from grammar import plan as p
from grammar.inference import form_for, walk
from grammar.program import HELPERS
from robot_api.methods import METHODS

FIGURES: Final = {f"{how}_of": how for how in ("sum", "average", "highest", "lowest")}
"""Functions of written programs that make one number of many."""


class Code(p.Recall, frozen=True, tag="code"):
    """A value that no plan could give; `name` is its source."""


class CodeStep(p.End, frozen=True, tag="code step"):
    """A statement that no plan could make."""

    source: str


class Function(p.Forever, frozen=True, tag="function"):
    """A function, with its steps."""

    name: str


@dataclass(frozen=True)
class Reading:
    """A program as a plan, and where its steps are."""

    plan: p.Plan
    lines: dict[int, int] = field(repr=False)
    """The line of each step, by its `id`."""
    otherwise: dict[int, int] = field(repr=False)
    """The line of its `else` or `except`, if it has one, by its `id`."""


def read_program(source: str, language: str = "en") -> Reading:
    """The plan of a program. Raises `SyntaxError` if it is no program."""
    reader = _Reader(source)
    steps = tuple(reader.steps(ast.parse(source).body))
    return Reading(p.Plan(steps, language), reader.lines, reader.otherwise)


_ELSE: Final = re.compile(r"\s*else\s*:")
_NEW_LINE: Final = re.compile(r"\r\n?|\n")  # what is one for Python
_OPERATORS: Final[dict[type[ast.cmpop], str]] = {
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.In: "in",
}


class _Reader:
    def __init__(self, source: str) -> None:
        self.source = source
        self.lines: dict[int, int] = {}
        self.otherwise: dict[int, int] = {}
        self.redefined = _redefined(source)

    def code(self, node: ast.AST) -> str:
        return ast.get_source_segment(self.source, node) or ast.unparse(node)

    # --- statements ------------------------------------------------------------------------------

    def steps(self, body: Iterable[ast.stmt]) -> Iterator[p.Step]:
        for statement in body:
            step = self.step(statement)
            if step is None:
                continue
            self.lines[id(step)] = statement.lineno
            if line := self.line_otherwise(statement):
                self.otherwise[id(step)] = line
            yield step

    def line_otherwise(self, statement: ast.stmt) -> int | None:
        """The line of a statement's `else` or `except`; Python only knows that of the second."""
        match statement:
            case ast.Try(handlers=[handler]):
                return handler.lineno
            case ast.If(body=[*_, last], orelse=[first, *_]):
                written = _NEW_LINE.split(self.source)
                between = range(first.lineno, (last.end_lineno or last.lineno) - 1, -1)
                return next((n for n in between if _ELSE.match(written[n - 1])), None)
            case _:
                return None

    def block(self, body: Iterable[ast.stmt]) -> tuple[p.Step, ...]:
        return tuple(self.steps(body))

    def step(self, statement: ast.stmt) -> p.Step | None:
        """The step of a statement; None for one that does nothing."""
        match statement:
            case ast.Pass() | ast.Import() | ast.ImportFrom():
                return None
            case ast.FunctionDef() if _is_helper(statement):
                return None
            case ast.FunctionDef(name=name, body=body):
                return Function(steps=self.block(body), name=name)
            case ast.Expr(value=ast.Constant()):
                return None
            case ast.Expr(value=ast.Call() as call):
                return self.call(call, None) or self.collect(call) or self.other(statement)
            case ast.Assign(targets=[ast.Name(id=name)], value=ast.Call() as call):
                return self.call(call, name) or p.Remember(name, self.value(call))
            case ast.Assign(targets=[ast.Name(id=name)], value=value):
                return p.Remember(name, self.value(value))
            case ast.AugAssign(target=ast.Name(id=name), op=ast.Add(), value=ast.Constant(value=1)):
                return p.Increase(name)
            case ast.AugAssign(target=ast.Name(id=name), op=ast.Add(), value=ast.Name(id=much)):
                return p.Increase(name, p.Recall(much))
            case ast.If(test=test, body=body, orelse=orelse):
                return p.If(self.condition(test), self.block(body), self.block(orelse))
            case ast.For(target=ast.Name(), orelse=[]):
                return self.for_loop(statement)
            case ast.While(orelse=[]):
                return self.while_loop(statement)
            case ast.Try(body=body, handlers=[handler], orelse=[], finalbody=[]):
                return p.Try(self.block(body), self.block(handler.body))
            case ast.Break():
                return p.End()
            case _:
                return self.other(statement)

    def other(self, statement: ast.stmt) -> p.Step:
        return CodeStep(source=self.code(statement))

    def call(self, call: ast.Call, save_as: str | None) -> p.Step | None:
        asked = self.asked(call)
        return p.Call(asked.method, asked.arguments, save_as) if asked else None

    def collect(self, call: ast.Call) -> p.Step | None:
        match call:
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id=name), attr="append"), args=[item], keywords=[]
            ):
                return p.Collect(name, self.value(item))
            case _:
                return None

    def for_loop(self, loop: ast.For) -> p.Step:
        assert isinstance(loop.target, ast.Name)
        steps = self.block(loop.body)
        match loop.iter:
            case ast.Call(func=ast.Name(id="range"), args=[times], keywords=[]) if (
                "range" not in self.redefined
            ):
                # Who uses the number of the round cannot be told "three times".
                if not _uses(loop.body, loop.target.id):
                    return p.Repeat(self.value(times), steps)
        return p.ForEach(loop.target.id, self.value(loop.iter), steps)

    def while_loop(self, loop: ast.While) -> p.Step:
        match loop:
            case ast.While(
                test=ast.Constant(value=True),
                body=[*body, ast.If(test=test, body=[ast.Break()], orelse=[])],
            ) if body:
                steps = self.block(body)
                if not any(isinstance(step, p.End) for step in walk(steps)):
                    return p.RepeatUntil(self.condition(test), steps)
            case _:
                pass
        steps = self.block(loop.body)
        if isinstance(loop.test, ast.Constant) and loop.test.value is True:
            return p.Forever(steps)
        return p.While(self.condition(loop.test), steps)

    # --- values ----------------------------------------------------------------------------------

    def asked(self, call: ast.Call) -> p.Ask | None:
        """A robot call with all its arguments by name; None if it is something else."""
        match call.func:
            case ast.Attribute(value=ast.Name(id="robot"), attr=name) if name in METHODS:
                method = METHODS[name]
            case _:
                return None
        if any(isinstance(each, ast.Starred) for each in call.args):
            return None
        named: dict[str, p.Value] = {}
        for keyword in call.keywords:
            if keyword.arg is None:
                return None
            named[keyword.arg] = self.value(keyword.value)
        for form in method.forms:
            if len(call.args) > len(form):
                continue
            by_place = {
                parameter.name: self.value(given)
                for parameter, given in zip(form, call.args, strict=False)
            }
            arguments = by_place | named
            if by_place.keys().isdisjoint(named) and form_for(method, arguments) == form:
                return p.Ask(name, arguments)
        return None

    def value(self, node: ast.expr) -> p.Value:
        match node:
            case ast.Constant(value=bool() as truth):
                return p.Truth(truth)
            case ast.Constant(value=str() as text):
                return p.Text(text)
            case ast.Constant(value=int() | float() as number):
                return p.Number(number)
            case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int() | float() as number)):
                return p.Number(-number)
            case ast.Name(id=name):
                return p.Recall(name)
            case ast.List(elts=items):
                return p.Items(tuple(map(self.value, items)))
            case ast.JoinedStr(values=parts):
                return p.Sentence(tuple(map(self.value, parts)))
            case ast.FormattedValue(value=value, conversion=-1, format_spec=None):
                return self.value(value)
            case ast.BinOp(op=ast.Add()) if (added := self.added(node)) is not None:
                return p.Sentence(tuple(added))
            case ast.Attribute(value=ast.Call() as call, attr=name):
                asked = self.asked(call)
                if asked is not None and not asked.arguments:
                    return p.Ask(asked.method, field=name)
            case ast.ListComp(
                elt=ast.Call(func=ast.Attribute(value=ast.Name(id=same), attr="lower")),
                generators=[ast.comprehension(target=ast.Name(id=name), iter=items, ifs=[])],
            ) if same == name:
                return self.value(items)
            case ast.Call():
                return self.called(node)
            case _:
                pass
        return Code(self.code(node))

    def called(self, call: ast.Call) -> p.Value:
        names = {node.id for node in ast.walk(call.func) if isinstance(node, ast.Name)}
        if names & self.redefined:
            return Code(self.code(call))
        match call:
            case ast.Call(
                func=ast.Name(id="str"),
                args=[ast.Call(func=ast.Attribute(ast.Name(id="robot"), "location"))],
            ):
                return p.Ask("location", field="place")
            case ast.Call(func=ast.Name(id="str" | "int" | "float"), args=[value], keywords=[]):
                return self.value(value)
            case ast.Call(func=ast.Name(id="len"), args=[value], keywords=[]):
                return p.Length(self.value(value))
            case ast.Call(func=ast.Name(id="percent"), args=[part, whole], keywords=[]):
                return p.Share(self.value(part), self.value(whole))
            case ast.Call(func=ast.Name(id=name), args=[of], keywords=[]) if name in FIGURES:
                return p.Figure(FIGURES[name], self.value(of))
            case ast.Call(func=ast.Name(id="minutes_since"), args=[since], keywords=[]):
                return p.Elapsed(self.value(since))
            case ast.Call(
                func=ast.Name(id="weekday_called"), args=[ast.List(elts=days)], keywords=[]
            ) if all(isinstance(name, ast.Constant) for name in days):
                named = (name.value for name in days if isinstance(name, ast.Constant))
                return p.Weekday(tuple(str(day) for day in named))
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id="random"), attr="choice"), args=[among]
            ):
                return p.Choice(self.value(among))
            case ast.Call(
                func=ast.Attribute(value=ast.Constant(value=", "), attr="join"), args=[items]
            ):
                return self.value(items)
            case ast.Call(func=ast.Attribute(value=text, attr="lower"), args=[], keywords=[]):
                return self.value(text)
            case _:
                return self.asked(call) or Code(self.code(call))

    def added(self, node: ast.expr) -> list[p.Value] | None:
        """The parts of texts put together with +; None if it is no text for certain."""
        parts: list[ast.expr] = []
        while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            parts.insert(0, node.right)
            node = node.left
        parts.insert(0, node)
        texts = (ast.Constant, ast.JoinedStr)
        if not any(
            isinstance(part, texts) and isinstance(getattr(part, "value", ""), str)
            for part in parts
        ):
            return None
        return [self.value(part) for part in parts]

    # --- conditions ------------------------------------------------------------------------------

    def condition(self, node: ast.expr) -> p.Condition:
        match node:
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return p.Not(self.condition(operand))
            case ast.BoolOp(op=ast.And(), values=values):
                return p.Both(tuple(map(self.condition, values)))
            case ast.BoolOp(values=values):
                return p.Either(tuple(map(self.condition, values)))
            case ast.Compare(left=left, ops=[ast.NotIn()], comparators=[right]):
                return p.Not(p.Compare(self.value(left), "in", self.value(right)))
            case ast.Compare(left=left, ops=[operator], comparators=[right]) if (
                type(operator) in _OPERATORS
            ):
                return p.Compare(self.value(left), _OPERATORS[type(operator)], self.value(right))
            case _:
                return p.Holds(self.value(node))


def _redefined(source: str) -> set[str]:
    """Names of Python's that the program gives another meaning, so that nobody can trust them."""
    bound: set[str] = set()
    for node in ast.walk(ast.parse(source)):
        match node:
            case ast.FunctionDef(name=name) if not _is_helper(node):
                bound.add(name)
            case ast.ClassDef(name=name) | ast.arg(arg=name):
                bound.add(name)
            case ast.Name(id=name, ctx=ast.Store()):
                bound.add(name)
            case ast.alias(name=name, asname=str() as other) if name != other:
                bound.add(other)
            case _:
                pass
    return bound & {"str", "int", "float", "len", "range", "random", *HELPERS}


def _is_helper(node: ast.FunctionDef) -> bool:
    """Whether it is one of the functions that written programs bring along."""
    helper = HELPERS.get(node.name)
    return helper is not None and ast.unparse(node) == ast.unparse(ast.parse("\n".join(helper)))


def _uses(body: Sequence[ast.stmt], name: str) -> bool:
    return any(
        isinstance(node, ast.Name) and node.id == name
        for statement in body
        for node in ast.walk(statement)
    )
