"""From a plan to a Python program that a beginner can read.

    steps of the plan -> statements -> lines, laid out as `ruff format` would lay them out

`write_program` gives the source; `program_lines` the same line by line, each with the step that
wrote it, so that what runs can be shown and explained. Whatever came from the user ends up in a
quoted string (`grammar.layout`) or as a cleaned identifier (`grammar.identifiers`), never as code.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, assert_never

from grammar import plan as p
from grammar.identifiers import Identifiers, identifier
from grammar.inference import Types, form_for, takes_time
from grammar.layout import (
    Atom,
    Brackets,
    Call,
    Compare,
    Document,
    Operators,
    Prefix,
    String,
    flat,
    lay_out,
)
from robot_api.methods import METHODS, Parameter


class PlanError(ValueError):
    """The plan cannot be written as a program; the message says why in one sentence."""


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
    """The lines of `write_program`, each with its step."""
    writer = _Writer(plan)
    body = list(writer.block(plan.steps, depth=0, in_loop=False)) if plan.steps else [Line("pass")]
    return [*writer.header(), *body]


PAUSE: Final = "robot.wait(1)"
"""Put into loops that would otherwise check something as fast as the computer can."""

PLACE: Final = p.Ask("location", field="place")
"""Written as `str(robot.location())`: where there is no named place, its coordinates."""

HELPERS: Final = {
    "percent": (
        "def percent(part, whole):",
        "    return round(100 * part / whole) if whole else 0",
    ),
    "numbers_in": (
        "def numbers_in(answers):",
        "    words = [word for answer in answers for word in answer.split()]",
        "    return [int(word) for word in words if word.isdigit()]",
    ),
    "sum_of": (
        "def sum_of(answers):",
        "    return sum(numbers_in(answers))",
    ),
    "average_of": (
        "def average_of(answers):",
        "    numbers = numbers_in(answers)",
        "    return round(sum(numbers) / len(numbers), 1) if numbers else 0",
    ),
    "highest_of": (
        "def highest_of(answers):",
        "    return max(numbers_in(answers), default=0)",
    ),
    "lowest_of": (
        "def lowest_of(answers):",
        "    return min(numbers_in(answers), default=0)",
    ),
    "minutes_since": (
        "def minutes_since(begin):",
        "    times = (begin, robot.clock().time)",
        "    then, now = [60 * int(time[:2]) + int(time[3:]) for time in times]",
        "    return (now - then) % (24 * 60)",
    ),
    "weekday_called": (
        "def weekday_called(names):",
        '    days = ["Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", "Sunday"]',
        "    return names[days.index(robot.clock().weekday)]",
    ),
}
"""Small functions that stand at the top of a program that needs them, by their names."""

LONGEST_IN_BRACES: Final = 60
"""Characters: an f-string cannot be broken within its braces."""

_FLIPPED: Final = {"==": "!=", "!=": "==", "<": ">=", "<=": ">", ">": "<=", ">=": "<"}


class _Writer:
    def __init__(self, plan: p.Plan) -> None:
        self.types = Types(plan)
        self.background = plan.background
        self.names = Identifiers()
        self.uses_random = False
        self.helpers: set[str] = set()
        # Names the user sees keep their spelling; loop counters go around them.
        for name in self.types.names:
            self.names.of(name)

    def header(self) -> Iterator[Line]:
        yield from (Line(f"# {' '.join(said.split())}") for said in self.background)
        if self.uses_random:
            yield Line("import random")
            yield Line("")
        if self.helpers and self.uses_random:
            yield Line("")
        for name in HELPERS:  # in the order in which one may need another
            if name not in self.helpers:
                continue
            yield from (Line(text) for text in HELPERS[name])
            yield Line("")
            yield Line("")

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
        def write(head: str, document: Document, tail: str = "") -> Iterator[Line]:
            return (Line(text, step) for text in lay_out(head, document, tail, depth))

        match step:
            case p.Call():
                head = f"{self.names.of(step.save_as)} = " if step.save_as else ""
                yield from write(head, self.call(step.method, step.arguments))
            case p.Remember():
                yield from write(f"{self.names.of(step.name)} = ", self.value(step.value))
            case p.Collect():
                list_name = self.names.of(step.name)
                yield from write("", Call(f"{list_name}.append", (self.value(step.value),)))
            case p.Increase():
                much = Atom("1") if step.by is None else self.as_number(step.by, "float")
                yield from write(f"{self.names.of(step.name)} += ", much)
            case p.If():
                yield from self.branches(step, depth, in_loop)
            case p.Repeat():
                times = self.as_number(step.times, "int")
                variable = self.names.fresh(_counter(step))
                yield from write(f"for {variable} in ", Call("range", (times,)), ":")
                yield from self.body(step, step.steps, depth + 1, in_loop=True)
            case p.ForEach():
                head = f"for {self.names.of(step.variable)} in "
                yield from write(head, self.value(step.items), ":")
                yield from self.body(step, step.steps, depth + 1, in_loop=True)
            case p.While():
                yield from write("while ", self.condition(step.condition), ":")
                yield from self.loop(step, step.steps, depth + 1, takes_time(step.condition))
            case p.RepeatUntil():
                yield from write("while ", Atom("True"), ":")
                yield from self.loop(step, step.steps, depth + 1, takes_time(step.condition))
                inner = "    " * (depth + 1)
                condition = self.condition(step.condition)
                yield from (Line(text, step) for text in lay_out("if ", condition, ":", depth + 1))
                yield Line(inner + "    break", step)
            case p.Forever():
                yield from write("while ", Atom("True"), ":")
                yield from self.loop(step, step.steps, depth + 1, False)
            case p.Try():
                yield from write("", Atom("try:"))
                yield from self.body(step, step.steps, depth + 1, in_loop)
                yield from write("", Atom("except Exception:"))
                yield from self.body(step, step.otherwise, depth + 1, in_loop)
            case p.End():
                if not in_loop:
                    raise PlanError("The plan leaves a loop where there is none.")
                yield from write("", Atom("break"))
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

    def loop(
        self, step: p.Step, steps: tuple[p.Step, ...], depth: int, waits: bool
    ) -> Iterator[Line]:
        """The body of a loop without an end of its own, with a pause in it if nothing else in it
        takes time."""
        yield from self.block(steps, depth, in_loop=True)
        if not (waits or takes_time(steps)):
            yield Line("    " * depth + PAUSE, step)
        elif not steps:
            yield Line("    " * depth + "pass", step)

    # --- calls -----------------------------------------------------------------------------------

    def call(self, name: str, arguments: dict[str, p.Value]) -> Document:
        """`robot.name(...)`: what must be given goes by position, what may be given by name."""
        method = METHODS.get(name)
        if method is None:
            raise PlanError(f"The robot has no method {name!r}.")
        form = form_for(method, arguments)
        if form is None:
            given = ", ".join(arguments) or "nothing"
            raise PlanError(f"robot.{name} cannot be called with {given}.")
        written: list[Document] = []
        by_position = True
        for place, parameter in enumerate(form):
            if parameter.name not in arguments:
                by_position = False
                continue
            value = self.argument(parameter, arguments[parameter.name])
            by_position = by_position and (
                place == 0 or parameter.required or parameter.name == "options"
            )
            written.append(value if by_position else Prefix(f"{parameter.name}=", value))
        taken = {parameter.name for parameter in form}
        for extra in sorted(arguments.keys() - taken):
            written.append(Prefix(f"{identifier(extra)}=", self.value(arguments[extra])))
        return Call(f"robot.{name}", tuple(written))

    def argument(self, parameter: Parameter, value: p.Value) -> Document:
        annotation = parameter.kind.annotation.removesuffix(" | None")
        if annotation in ("float", "int"):
            return self.as_number(value, annotation)
        if annotation == "str":
            return self.as_text(value)
        return self.value(value)

    # --- values ----------------------------------------------------------------------------------

    def value(self, value: p.Value) -> Document:
        match value:
            case p.Text():
                return String(((value.value, False),))
            case p.Number():
                return Atom(_number(value.value))
            case p.Truth():
                return Atom(str(value.value))
            case p.Recall():
                return Atom(self.names.of(value.name))
            case p.Items():
                return Brackets("[", tuple(self.value(item) for item in value.items), "]")
            case p.Ask():
                asked = self.call(value.method, value.arguments)
                if value.field is None:
                    return asked
                if value == PLACE:
                    return Call("str", (asked,))
                return Prefix("", asked, f".{identifier(value.field)}")
            case p.Sentence():
                return self.sentence(value)
            case p.Length():
                # A method that counts already gives the number.
                counted = self.value(value.of)
                return counted if self.types.of(value.of) == "int" else Call("len", (counted,))
            case p.Share():
                self.helpers.add("percent")
                part = self.as_number(value.part, "float")
                return Call("percent", (part, self.as_number(value.whole, "float")))
            case p.Figure():
                if f"{value.how}_of" not in HELPERS:
                    raise PlanError(f"No program knows the {value.how!r} of numbers.")
                self.helpers |= {"numbers_in", f"{value.how}_of"}
                return Call(f"{value.how}_of", (self.value(value.of),))
            case p.Elapsed():
                self.helpers.add("minutes_since")
                return Call("minutes_since", (self.as_text(value.since),))
            case p.Weekday():
                self.helpers.add("weekday_called")
                names = p.Items(tuple(p.Text(name) for name in value.names))
                return Call("weekday_called", (self.value(names),))
            case p.Choice():
                self.uses_random = True
                return Call("random.choice", (self.value(value.among),))
            case _:
                assert_never(value)

    def as_number(self, value: p.Value, kind: str) -> Document:
        """The value where a number is wanted: what was heard is text and has to be converted."""
        document = self.value(value)
        given = self.types.of(value)
        if given == "str" or (kind == "int" and given == "float" and not _whole(value)):
            return Call(kind, (document,))
        return document

    def as_text(self, value: p.Value) -> Document:
        """The value where text is wanted."""
        document = self.value(value)
        match self.types.of(value):
            case "str" | "Any":
                return document
            case "list[str]":
                return Call('", ".join', (document,))
            case _:
                return Call("str", (document,))

    def sentence(self, sentence: p.Sentence) -> Document:
        """An f-string; `+` where an f-string of Python 3.11 cannot hold what is asked for."""
        parts: list[tuple[str, bool]] = []
        for part in _parts(sentence):
            if isinstance(part, str):
                parts.append((part, False))
                continue
            inner = self.in_braces(part)
            if inner is None:
                return self.sum(sentence)
            parts.append((inner, True))
        return String(tuple(parts))

    def in_braces(self, value: p.Value) -> str | None:
        """The value as written between the braces of an f-string, None if that cannot be."""
        document = self.as_text(value)
        if isinstance(document, Call) and document.head == "str":  # the braces do that
            document = document.arguments[0]
        text = flat(document)
        if "'" in text or "\\" in text or "{" in text or len(text) > LONGEST_IN_BRACES:
            return None
        return text

    def sum(self, sentence: p.Sentence) -> Document:
        parts: list[Document] = []
        for part in _parts(sentence):
            if isinstance(part, str):
                parts.append(String(((part, False),)))
            else:
                parts.append(self.as_text(part))
        return Operators("+", tuple(parts))

    # --- conditions ------------------------------------------------------------------------------

    def condition(self, condition: p.Condition) -> Document:
        match condition:
            case p.Holds(value=p.Ask() as asked) if asked == PLACE:
                return Prefix("", self.call(asked.method, asked.arguments), ".place")
            case p.Holds():
                return self.value(condition.value)
            case p.Compare():
                return self.comparison(condition.left, condition.operator, condition.right)
            case p.Not(condition=p.Not(condition=inner)):
                return self.condition(inner)
            case p.Not(condition=p.Compare() as inner):
                operator = _FLIPPED.get(inner.operator, "not in")
                return self.comparison(inner.left, operator, inner.right)
            case p.Not():
                return Prefix("not ", self.operand(condition.condition))
            case p.Both():
                return self.joined("and", condition.conditions, Atom("True"))
            case p.Either():
                return self.joined("or", condition.conditions, Atom("False"))
            case _:
                assert_never(condition)

    def joined(
        self, operator: str, conditions: tuple[p.Condition, ...], none: Document
    ) -> Document:
        if not conditions:
            return none
        if len(conditions) == 1:
            return self.condition(conditions[0])
        return Operators(operator, tuple(self.operand(each) for each in conditions))

    def operand(self, condition: p.Condition) -> Document:
        document = self.condition(condition)
        if isinstance(document, Operators):
            return Brackets("(", (document,), ")", trailing_comma=False)
        return document

    def comparison(self, left: p.Value, operator: str, right: p.Value) -> Document:
        """Texts are compared in lower case, numbers as numbers."""
        kinds = {self.types.of(left), self.types.of(right)}
        if operator in ("in", "not in"):
            return Compare(self.lowered(left), operator, self.lowered_all(right))
        if operator not in _FLIPPED:
            raise PlanError(f"Values cannot be compared with {operator!r}.")
        letterless = any(isinstance(each, p.Text) and not _letters(each) for each in (left, right))
        if kinds == {"str"} and letterless:  # "12:00" is the same in upper and lower case
            return Compare(self.value(left), operator, self.value(right))
        if operator in ("==", "!="):
            if "str" in kinds or kinds == {"Location"}:
                return Compare(self.lowered(left), operator, self.lowered(right))
            return Compare(self.value(left), operator, self.value(right))
        if kinds & {"int", "float"}:
            return Compare(self.as_number(left, "float"), operator, self.as_number(right, "float"))
        return Compare(self.lowered(left), operator, self.lowered(right))

    def lowered(self, value: p.Value) -> Document:
        document = self.as_text(value)
        if isinstance(document, String) and not any(inserted for _, inserted in document.parts):
            return String(tuple((text.lower(), False) for text, _ in document.parts))
        if self.types.of(value) == "Any":
            document = Call("str", (document,))
        if isinstance(document, Operators):
            document = Brackets("(", (document,), ")", trailing_comma=False)
        return Prefix("", document, ".lower()")

    def lowered_all(self, value: p.Value) -> Document:
        """What something is looked for in: a list, each of its texts in lower case, or a text."""
        if isinstance(value, p.Items):
            return Brackets("[", tuple(self.lowered(item) for item in value.items), "]")
        if self.types.of(value) == "list[str]":
            each = self.names.spare("name")
            comprehension = Operators(
                f"for {each} in", (Atom(f"{each}.lower()"), self.value(value))
            )
            return Brackets("[", (comprehension,), "]", trailing_comma=False)
        return self.lowered(value)


def _parts(sentence: p.Sentence) -> Iterator[str | p.Value]:
    """The parts, what is fixed as text, sentences within it opened."""
    for part in sentence.parts:
        match part:
            case p.Text():
                yield part.value
            case p.Number():
                yield _number(part.value)
            case p.Sentence():
                yield from _parts(part)
            case _:
                yield part


def _letters(text: p.Text) -> bool:
    return text.value.lower() != text.value.upper()


def _counter(step: p.Repeat) -> str:
    """What a round is called: after who is waited for in it, if somebody is."""
    for inner in step.steps:
        if isinstance(inner, p.Call) and inner.method == "wait_for":
            thing = inner.arguments.get("thing")
            if isinstance(thing, p.Text):
                return "visitor" if thing.value == "person" else thing.value
    return "repetition"


def _whole(value: p.Value) -> bool:
    return isinstance(value, p.Number) and float(value.value).is_integer()


def _number(value: int | float) -> str:
    if isinstance(value, float):
        if not math.isfinite(value):
            raise PlanError(f"{value} is no number a robot can use.")
        if value.is_integer() and abs(value) < 1e15:
            return str(int(value))
        return repr(value).replace("e+", "e")
    if abs(value) > 10**15:
        raise PlanError("The number is too large for a robot.")
    return str(value)
