"""From a program back to a plan.

What `grammar.program` writes is read back as what it was written from, and much that says the same
in other words. `read_program` also takes what no plan can say, so that an edited program can be
explained: it is kept as code (`Code`, `CodeStep`, `Function`), which explanations quote as it
stands; a reader never misses a robot call, though it may not be in plain words. `parse_program`
refuses it, and gives the plan in its normal form.
"""

from __future__ import annotations

import ast
import re
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Final

from grammar import plan as p
from grammar.helpers import is_helper
from grammar.inference import Types
from grammar.normal import ZERO, as_increase, negative, normal
from grammar.read_values import Code, Doubt, Problem, ValueReader, is_none, problem_with
from grammar.traversal import walk

__all__ = ["Code", "CodeStep", "Function", "NotAPlan", "Reading", "parse_program", "read_program"]


class CodeStep(p.End, frozen=True, tag="code step"):
    """A statement that no plan could make."""

    source: str


class Function(p.Forever, frozen=True, tag="function"):
    """A function, with its steps."""

    name: str


class NotAPlan(ValueError):
    """The program says something that no plan can; `sentence` tells what, and what to say instead,
    `line` where."""

    def __init__(self, line: int, sentence: str) -> None:
        super().__init__(f"Line {line}: {sentence}")
        self.line = line
        self.sentence = sentence


@dataclass(frozen=True)
class Reading:
    """A program as a plan, and where its steps are."""

    plan: p.Plan
    lines: dict[int, int] = field(repr=False)
    """The line of each step, by its `id`."""
    otherwise: dict[int, int] = field(repr=False)
    """The line of its `else` or `except`, if it has one, by its `id`."""


def read_program(source: str, language: str = "en") -> Reading:
    """The plan of a program, as far as plans go. Raises `SyntaxError` if it is no program."""
    reader = _Reader(source, ast.parse(source))
    return Reading(reader.plan(language), reader.lines, reader.otherwise)


def parse_program(source: str, language: str = "en") -> p.Plan:
    """The plan that says what the program does, in its normal form:

        parse_program(write_program(plan), plan.language) == normal(plan)

    `language` is the one that the plan is for: nothing in a program tells it. Raises `NotAPlan`.
    """
    if "\0" in source:  # which Python tells in other words, and as another error, before 3.11.4
        raise NotAPlan(source[: source.index("\0")].count("\n") + 1, "It has a null character.")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SyntaxWarning)
            tree = ast.parse(source)
            compile(source, "program", "exec", dont_inherit=True)  # finds a break outside a loop
        reader = _Reader(source, tree)
        plan = reader.plan(language)
    except SyntaxError as error:
        raise NotAPlan(
            error.lineno or 1, f"Python does not understand this: {error.msg}."
        ) from None
    except (ValueError, RecursionError, MemoryError, OverflowError):
        raise NotAPlan(1, "This is no program, or one that is nested too deeply.") from None
    problems = [*reader.problems, *reader.doubted(Types(plan))]
    if problems:
        first = min(problems, key=lambda problem: problem.line)
        raise NotAPlan(first.line, first.sentence)
    return normal(plan)


MODULES: Final = frozenset({"random", "re", "math"})
"""What programs may import: whatever is said with it is looked at where it stands."""

_ELSE: Final = re.compile(r"\s*else\s*:")
_NEW_LINE: Final = re.compile(r"\r\n?|\n")  # what is one for Python


class _Reader(ValueReader):
    """Reads the statements of one program."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.lines: dict[int, int] = {}
        self.otherwise: dict[int, int] = {}
        self.written = _NEW_LINE.split(self.source)

    def plan(self, language: str) -> p.Plan:
        return p.Plan(self.block(self.tree.body), language, tuple(self.background()))

    def background(self) -> Iterator[str]:
        """What was said besides: the comments at the top."""
        for line in self.written:
            if not line.startswith("#"):
                return
            yield line.removeprefix("#").strip()

    # --- statements ------------------------------------------------------------------------------

    def block(self, body: Iterable[ast.stmt]) -> tuple[p.Step, ...]:
        steps: list[p.Step] = []
        for statement in body:
            for step in self.steps(statement):
                self.lines[id(step)] = statement.lineno
                if line := self.line_otherwise(statement):
                    self.otherwise[id(step)] = line
                steps.append(step)
        return tuple(steps)

    def line_otherwise(self, statement: ast.stmt) -> int | None:
        """The line of a statement's `else` or `except`; Python only knows that of the second."""
        match statement:
            case ast.Try(handlers=[handler]):
                return handler.lineno
            case ast.If(body=[*_, last], orelse=[first, *_]):
                between = range(first.lineno, (last.end_lineno or last.lineno) - 1, -1)
                return next((n for n in between if _ELSE.match(self.written[n - 1])), None)
            case _:
                return None

    def steps(self, statement: ast.stmt) -> Iterator[p.Step]:
        """The steps of a statement; none for one that does nothing."""
        match statement:
            case ast.Pass() | ast.AnnAssign(value=None) | ast.Expr(value=ast.Constant()):
                pass
            case ast.Import() | ast.ImportFrom():
                self.imported(statement)
            case ast.FunctionDef() if is_helper(statement):
                pass
            case ast.FunctionDef(name=name, body=body):
                self.problems.append(problem_with(statement, name))
                yield Function(steps=self.block(body), name=name)
            case ast.Expr(value=ast.Call() as call):
                yield self.call(call) or self.other(statement)
            case ast.Assign(targets=[ast.Tuple(elts=names)], value=ast.Tuple(elts=values)) if len(
                names
            ) == len(values) and all(isinstance(each, ast.Constant) for each in values):
                for target, value in zip(names, values, strict=True):
                    yield self.kept(statement, target, value)
            case ast.Assign(targets=[target], value=value):
                yield self.kept(statement, target, value)
            case ast.Assign(targets=targets, value=ast.Constant() as value):
                for target in targets:
                    yield self.kept(statement, target, value)
            case ast.AnnAssign(target=target, value=ast.expr() as value):
                yield self.kept(statement, target, value)
            case ast.AugAssign():
                yield self.increased(statement)
            case ast.If(test=test, body=body, orelse=orelse):
                yield p.If(self.condition(test), self.block(body), self.block(orelse))
            case ast.For(orelse=[]):
                yield self.for_loop(statement)
            case ast.While(orelse=[]):
                yield self.while_loop(statement)
            case ast.Try(handlers=[handler], orelse=[], finalbody=[]) if _catches_all(handler):
                yield p.Try(self.block(statement.body), self.block(handler.body), handler.name)
            case ast.Break():
                yield p.End()
            case ast.Continue():
                yield p.Continue()
            case _:
                yield self.other(statement)

    def other(self, statement: ast.stmt) -> p.Step:
        source = self.code(statement)
        self.problems.append(problem_with(statement, source))
        return CodeStep(source=source)

    def imported(self, statement: ast.Import | ast.ImportFrom) -> None:
        names = [each.name for each in statement.names]
        named = [each.asname for each in statement.names if each.asname]
        if isinstance(statement, ast.ImportFrom) or named or not MODULES.issuperset(names):
            sentence = f"A plan imports nothing but {' and '.join(sorted(MODULES))}."
            self.problems.append(Problem(statement.lineno, sentence))

    def call(self, call: ast.Call) -> p.Step | None:
        """A call of the robot, or of a method that changes a list."""
        match call:
            case ast.Call(func=ast.Attribute(value=ast.Name(id="robot"), attr=name)):
                if asked := self.asked(call):
                    return p.Call(asked.method, asked.arguments)
                self.problems.append(Problem(call.lineno, self.no_such_call(call, name)))
            case ast.Call(
                func=ast.Attribute(ast.Name(id=name), "append"), args=[item], keywords=[]
            ):
                return p.Collect(name, self.value(item))
            case ast.Call(
                func=ast.Attribute(ast.Name(id=name), "extend"), args=[more], keywords=[]
            ):
                return p.Increase(name, self.value(more))
            case ast.Call(func=ast.Attribute(ast.Name() as items, "sort"), args=[], keywords=how):
                in_order = ast.Call(ast.Name("sorted", ast.Load()), [items], how)
                value = self.formed(ast.copy_location(in_order, call))
                return p.Remember(items.id, value) if value else None
            case _:
                pass
        return None

    def kept(self, statement: ast.stmt, target: ast.expr, value: ast.expr) -> p.Step:
        """A value that is given a name, or put under a key."""
        match value:
            case ast.IfExp(test=test, body=one, orelse=other):
                then, otherwise = (self.kept(statement, target, each) for each in (one, other))
                return p.If(self.condition(test), (then,), (otherwise,))
        match target:
            case ast.Name(id=name):
                if isinstance(value, ast.Call) and (asked := self.asked(value)):
                    return p.Call(asked.method, asked.arguments, name)
                read = self.nothing(value, name) if is_none(value) else self.value(value)
                return as_increase(p.Remember(name, read))
            case ast.Subscript(value=ast.Name(id=name), slice=key) if not isinstance(
                key, ast.Slice
            ):
                return as_increase(p.SetItem(name, self.value(key), self.value(value)))
            case _:
                return self.other(statement)

    def nothing(self, none: ast.expr, name: str) -> p.Value:
        """None, before something is known: an empty text, unless it is no text that will be."""
        sentence = "A plan has no None. Begin with a value of the same kind, such as 0."
        self.doubts.append(Doubt(p.Recall(name), "Any", Problem(none.lineno, sentence)))
        return p.Text("")

    def increased(self, statement: ast.AugAssign) -> p.Step:
        """`votes += 1`; what is multiplied is given its new value."""
        target = statement.target
        match statement.op, self.value(statement.value):
            case ast.Add(), value:
                by = None if value == p.Number(1) else value
            case ast.Sub(), value:
                by = negative(value)
            case _:
                whole = ast.BinOp(target, statement.op, statement.value)
                return self.kept(statement, target, ast.copy_location(whole, statement))
        match target:
            case ast.Name(id=name):
                return p.Increase(name, by)
            case ast.Subscript(value=ast.Name(id=name), slice=key) if not isinstance(
                key, ast.Slice
            ):
                return p.Increase(name, by, self.value(key))
            case _:
                return self.other(statement)

    def for_loop(self, loop: ast.For) -> p.Step:
        match loop:
            case ast.For(target=ast.Name(id=name), iter=ast.Call(func=ast.Attribute(of, "keys"))):
                return p.ForEach(name, self.value(of), self.block(loop.body))
            case ast.For(target=ast.Name(id=name)):
                items, steps = self.value(loop.iter), self.block(loop.body)
                if isinstance(items, p.Range) and items.start == ZERO and not self.is_used(name):
                    return p.Repeat(items.stop, steps)
                return p.ForEach(name, items, steps)
            case ast.For(
                target=ast.Tuple(elts=[ast.Name(id=key), ast.Name(id=name)]),
                iter=ast.Call(func=ast.Attribute(of, "items"), args=[], keywords=[]),
            ):
                return p.ForEach(key, self.value(of), self.block(loop.body), name)
            case _:
                return self.other(loop)

    def is_used(self, name: str) -> bool:
        """Whether the program speaks of a name a second time: who counts the rounds of a loop and
        never looks at the number just says how many there are."""
        names = (each.id for each in ast.walk(self.tree) if isinstance(each, ast.Name))
        return list(names).count(name) > 1

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


def _catches_all(handler: ast.ExceptHandler) -> bool:
    match handler.type:
        case None | ast.Name(id="Exception"):
            return True
        case _:
            return False
