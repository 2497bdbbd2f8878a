"""From a plan to a Python program that a beginner can read.

    plan -> its normal form -> with pauses -> statements -> lines, laid out as `ruff format` would

`write_program` gives the source; `program_lines` the same line by line, each with the step that
wrote it, so that what runs can be shown and explained. Whatever came from the user ends up in a
quoted string (`grammar.layout`) or as a cleaned identifier (`grammar.identifiers`), never as code.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal, assert_never

from grammar import plan as p
from grammar.helpers import needed, source
from grammar.kinds import is_list
from grammar.layout import Atom, Call, Document, Prefix, enclosed, flat, lay_out
from grammar.normal import normal
from grammar.pauses import takes_time, with_pauses
from grammar.traversal import nodes
from grammar.writing import PlanError, ValueWriter

IMPORTED: Final = frozenset({"random", "re"})
"""The modules that written programs may need."""


@dataclass(frozen=True)
class Line:
    """A line of a program, and the step that wrote it; None for imports, helpers, empty lines."""

    text: str
    step: p.Step | None = None


def write_program(plan: p.Plan) -> str:
    """The program of the plan, formatted, with a newline at its end. Raises `PlanError` if the plan
    asks for what no program can do: an unknown method, a wrong argument, an `End` outside a loop.
    """
    return "".join(f"{line.text}\n" for line in program_lines(plan))


def program_lines(plan: p.Plan) -> list[Line]:
    """The lines of `write_program`, each with its step, which is one of the normal form."""
    written = with_pauses(normal(plan))
    writer = _Writer(written)
    body = list(writer.block(written.steps, depth=0, in_loop=False)) or [Line("pass")]
    return [*writer.header(written), *body]


class _Writer(ValueWriter):
    def header(self, plan: p.Plan) -> Iterator[Line]:
        """What was said besides, the imports and the helpers that the body needs."""
        yield from (Line(f"# {said}") for said in plan.background)
        used, helpers = needed(self.uses)
        modules = sorted(used & IMPORTED)
        yield from (Line(f"import {module}") for module in modules)
        if modules:
            yield from [Line("")] * (2 if helpers else 1)
        for name in helpers:
            try:
                yield from map(Line, source(name, plan.language))
            except LookupError as error:
                raise PlanError(str(error)) from error
            yield from [Line(""), Line("")]

    # --- steps -----------------------------------------------------------------------------------

    def block(self, steps: tuple[p.Step, ...], depth: int, in_loop: bool) -> Iterator[Line]:
        for step in steps:
            yield from self.step(step, depth, in_loop)

    def body(
        self, step: p.Step, steps: tuple[p.Step, ...], depth: int, in_loop: bool
    ) -> Iterator[Line]:
        if steps:
            yield from self.block(steps, depth, in_loop)
        else:
            yield Line("    " * depth + "pass", step)

    def step(self, step: p.Step, depth: int, in_loop: bool) -> Iterator[Line]:
        def write(head: str, document: Document, tail: str = "", deeper: int = 0) -> Iterator[Line]:
            return (Line(text, step) for text in lay_out(head, document, tail, depth + deeper))

        match step:
            case p.Call():
                head = f"{step.save_as} = " if step.save_as else ""
                yield from write(head, self.call(step.method, step.arguments))
            case p.Remember():
                yield from write(f"{step.name} = ", self.value(step.value))
            case p.Collect():
                yield from write("", Call(f"{step.name}.append", (self.value(step.value),)))
            case p.Increase():
                yield from write(*self.increase(step))
            case p.SetItem():
                yield from write(f"{self.entry(step.name, step.key)} = ", self.value(step.value))
            case p.If():
                yield from self.branches(step, depth, in_loop)
            case p.Repeat():
                counter = self.names.fresh(_counter(step))
                times = Call("range", (self.value(step.times),))
                yield from write(f"for {counter} in ", times, ":")
                yield from self.body(step, step.steps, depth + 1, in_loop=True)
            case p.ForEach():
                variables, items = step.variable, self.value(step.items)
                if step.value is not None:
                    variables = f"{variables}, {step.value}"
                    items = Prefix("", enclosed(items), ".items()")
                yield from write(f"for {variables} in ", items, ":")
                yield from self.body(step, step.steps, depth + 1, in_loop=True)
            case p.While():
                yield from write("while ", self.condition(step.condition), ":")
                yield from self.body(step, step.steps, depth + 1, in_loop=True)
            case p.RepeatUntil():
                yield from write("while ", Atom("True"), ":")
                yield from self.block(step.steps, depth + 1, in_loop=True)
                yield from write("if ", self.condition(step.condition), ":", deeper=1)
                yield from write("", Atom("break"), deeper=2)
            case p.Forever():
                yield from write("while ", Atom("True"), ":")
                yield from self.body(step, step.steps, depth + 1, in_loop=True)
            case p.Try():
                yield from write("", Atom("try:"))
                yield from self.body(step, step.steps, depth + 1, in_loop)
                name = f" as {step.problem}" if step.problem else ""
                yield from write("", Atom(f"except Exception{name}:"))
                yield from self.body(step, step.otherwise, depth + 1, in_loop)
            case p.End() | p.Continue():
                word = "break" if isinstance(step, p.End) else "continue"
                if not in_loop:
                    raise PlanError(f"The plan has a {word} where there is no loop.")
                yield from write("", Atom(word))
            case _:
                assert_never(step)

    def branches(self, step: p.If, depth: int, in_loop: bool) -> Iterator[Line]:
        """`if`, and `elif` as long as the other way is nothing but an `If` itself."""
        word = "if "
        current = step
        while True:
            condition = self.condition(current.condition)
            yield from (Line(text, current) for text in lay_out(word, condition, ":", depth))
            yield from self.body(current, current.then, depth + 1, in_loop)
            match current.otherwise:
                case ():
                    return
                case (p.If() as inner,):
                    current, word = inner, "elif "
                case others:
                    yield Line("    " * depth + "else:", current)
                    yield from self.block(others, depth + 1, in_loop)
                    return

    def increase(self, step: p.Increase) -> tuple[str, Document]:
        """`votes[name] = votes.get(name, 0) + 1`; with `+=` where nothing is missing, or where
        nobody must be asked for the key twice."""
        sign, by = _signed(step.by)
        if step.key is None:
            return f"{step.name} {sign}= ", self.value(by)
        entry = self.entry(step.name, step.key)
        record = p.Recall(step.name)
        if is_list(self.types.of(record)) or not _stays_the_same(step.key):
            return f"{entry} {sign}= ", self.value(by)
        before = p.Item(record, step.key, p.Number(0))
        return f"{entry} = ", self.value(p.Arithmetic(before, sign, by))

    def entry(self, name: str, key: p.Value) -> str:
        return flat(self.value(p.Item(p.Recall(name), key)))


def _signed(by: p.Value | None) -> tuple[Literal["+", "-"], p.Value]:
    """Whether so much is added or taken off, and how much that is."""
    match by:
        case None:
            return "+", p.Number(1)
        case p.Number(value=number) if number < 0:
            return "-", p.Number(-number)
        case p.Arithmetic(left=p.Number(value=0), operator="-", right=right):
            return "-", right
        case _:
            return "+", by


def _stays_the_same(value: p.Value) -> bool:
    """Whether a value is the same when it is looked at again at once, without troubling anybody."""
    return not (takes_time(value) or any(isinstance(each, p.Choice) for each in nodes(value)))


def _counter(step: p.Repeat) -> str:
    """What a round is called: after who is waited for in it, if somebody is."""
    for inner in step.steps:
        if isinstance(inner, p.Call) and inner.method == "wait_for":
            thing = inner.arguments.get("thing")
            if isinstance(thing, p.Text):
                return "visitor" if thing.value == "person" else thing.value
    return "repetition"
