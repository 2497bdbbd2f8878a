"""Values and conditions of a plan as Python.

The plan is in its normal form (`grammar.normal`): whatever has to be made a text or a number says
so, and what is left is to put it down.
"""

from __future__ import annotations

import math
from typing import Final

from grammar import plan as p
from grammar.forms import form_of
from grammar.identifiers import Identifiers, all_names
from grammar.inference import Types, form_for
from grammar.kinds import FIELDS, is_list, item_of
from grammar.layout import (
    Atom,
    Brackets,
    Call,
    Compare,
    Document,
    Operators,
    Prefix,
    String,
    enclosed,
    flat,
)
from robot_api.methods import METHODS


class PlanError(ValueError):
    """The plan cannot be written as a program; the message says why in one sentence."""


LONGEST_IN_BRACES: Final = 60
"""Characters: an f-string cannot be broken within its braces."""

MOST: Final = 10**15
"""The largest number that every robot and every JSON reader agrees on."""

OPPOSITES: Final = {"==": "!=", "!=": "==", "<": ">=", "<=": ">", ">": "<=", ">=": "<"}

_PRECEDENCE: Final = {"+": 1, "-": 1, "*": 2, "/": 2, "//": 2, "%": 2}


class ValueWriter:
    """Writes the values and conditions of one plan."""

    def __init__(self, plan: p.Plan) -> None:
        self.types = Types(plan)
        self.names = Identifiers()
        for name in all_names(plan):  # loop counters and the like go around them
            self.names.of(name)
        self.uses: set[str] = set()
        """The functions and modules that what was written needs."""

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
            value = self.value(arguments[parameter.name])
            by_position = by_position and (
                place == 0 or parameter.required or parameter.name == "options"
            )
            written.append(value if by_position else Prefix(f"{parameter.name}=", value))
        extra = arguments.keys() - {parameter.name for parameter in form}
        for name in sorted(extra):
            written.append(Prefix(f"{name}=", self.value(arguments[name])))
        return Call(f"robot.{method.name}", tuple(written))

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
                return Atom(value.name)
            case p.Items():
                return Brackets("[", tuple(map(self.value, value.items)), "]")
            case p.Record():
                entries = (
                    Prefix(f"{flat(self.value(key))}: ", self.value(entry))
                    for key, entry in value.entries
                )
                return Brackets("{", tuple(entries), "}")
            case p.Ask() if value == p.PLACE:
                return Call("str", (self.call(value.method, value.arguments),))
            case p.Ask(method=method, arguments=arguments):
                asked = self.call(method, arguments)
                whole = p.Ask(method, arguments)
                return asked if value.field is None else self.part(asked, whole, value.field)
            case p.Field():
                return self.part(enclosed(self.value(value.of)), value.of, value.name)
            case p.Sentence():
                return self.sentence(value)
            case p.Join():
                return self.join(self.value(value.separator), value.of)
            case p.Weekday():
                self.uses.add("weekday_called")
                names = p.Items(tuple(map(p.Text, value.names)))
                return Call("weekday_called", (self.value(names),))
            case p.Arithmetic():
                return self.arithmetic(value)
            case p.Aggregate(of=of) if "str" in (kind := self.types.of(of), item_of(kind)):
                raise PlanError("Only numbers have a sum, a smallest and a largest one.")
            case p.Aggregate(
                of=p.Items(items=(_, _, *_) as items), function="min" | "max" as function
            ):
                return Call(function, tuple(map(self.value, items)))
            case p.Holds() | p.Compare() | p.Not() | p.Both() | p.Either():
                return self.condition(value)
            case _:
                return self.formed(value)

    def formed(self, value: p.Value) -> Document:
        """A value that has a form of its own."""
        form = form_of(value)
        if form is None:  # a function that the plan's schema does not know
            raise PlanError(f"No program knows how to work out this: {value}.")
        self.uses |= form.uses
        return form.written(lambda field: self.value(getattr(value, field)))

    def part(self, document: Document, of: p.Value, field: str) -> Document:
        kind = self.types.of(of)
        known = FIELDS.get(kind) or {name for fields in FIELDS.values() for name in fields}
        if field not in known:
            raise PlanError(f"A {kind.lower()} has no part {field!r}.")
        return Prefix("", document, f".{field}")

    def arithmetic(self, value: p.Arithmetic) -> Document:
        strength = _PRECEDENCE.get(value.operator)
        if strength is None:
            raise PlanError(f"Nothing can be calculated with {value.operator!r}.")
        right = self.value(value.right)
        if isinstance(value.right, p.Arithmetic) and not _is_negation(value.right):
            if _PRECEDENCE[value.right.operator] <= strength:
                right = enclosed(right)
        elif not isinstance(right, Atom) or right.text.startswith("-"):
            right = enclosed(right)
        if _is_negation(value):
            return Prefix("-", enclosed(right))
        left = self.value(value.left)
        if isinstance(value.left, p.Arithmetic):
            if _PRECEDENCE[value.left.operator] < strength:
                left = enclosed(left)
        elif isinstance(left, Operators | Compare | Prefix):
            left = enclosed(left)
        return Operators(value.operator, (left, right))

    # --- texts -----------------------------------------------------------------------------------

    def sentence(self, sentence: p.Sentence) -> Document:
        """An f-string; `+` where an f-string of Python 3.11 cannot hold what is asked for."""
        if len(sentence.parts) == 1:
            return self.as_text(sentence.parts[0])
        parts: list[tuple[str, bool]] = []
        for part in sentence.parts:
            if isinstance(part, p.Text):
                parts.append((part.value, False))
                continue
            inner = self.in_braces(part)
            if inner is None:
                return Operators("+", tuple(map(self.as_text, sentence.parts)))
            parts.append((inner, True))
        return String(tuple(parts))

    def as_text(self, value: p.Value) -> Document:
        """The value as a text; a list is spoken with commas."""
        kind = self.types.of(value)
        if kind == "str":
            return self.value(value)
        if is_list(kind):
            return self.join(String(((", ", False),)), value)
        return Call("str", (self.value(value),))

    def in_braces(self, value: p.Value) -> str | None:
        """The value as written between the braces of an f-string, None if that cannot be."""
        document = self.as_text(value)
        if isinstance(document, Call) and document.head == "str":  # the braces do that
            document = document.arguments[0]
        text = flat(document)
        if "'" in text or "\\" in text or "{" in text or len(text) > LONGEST_IN_BRACES:
            return None
        return text

    def join(self, separator: Document, items: p.Value) -> Document:
        written = self.value(items)
        if item_of(self.types.of(items)) != "str":
            each = self.names.spare("each")
            written = Operators(f"for {each} in", (Atom(f"str({each})"), written))
        return Call(f"{flat(enclosed(separator))}.join", (written,))

    # --- conditions ------------------------------------------------------------------------------

    def condition(self, condition: p.Condition | p.Value) -> Document:
        match condition:
            case p.Holds(value=p.Ask() as asked) if asked == p.PLACE:
                return Prefix("", self.call(asked.method, asked.arguments), ".place")
            case p.Holds():
                return self.value(condition.value)
            case p.Compare():
                return self.comparison(condition.left, condition.operator, condition.right)
            case p.Not(condition=p.Compare(left=left, operator="in", right=right)):
                return self.comparison(left, "not in", right)
            case p.Not():
                return Prefix("not ", self.operand(condition.condition))
            case p.Both():
                return Operators("and", tuple(map(self.operand, condition.conditions)))
            case p.Either():
                return Operators("or", tuple(map(self.operand, condition.conditions)))
            case _:
                return self.value(condition)

    def operand(self, condition: p.Condition) -> Document:
        document = self.condition(condition)
        return enclosed(document) if isinstance(document, Operators) else document

    def comparison(self, left: p.Value, operator: str, right: p.Value) -> Document:
        """Texts are compared in lower case."""
        if operator in ("in", "not in"):
            return Compare(*self.sought(left, operator, right))
        if operator not in OPPOSITES:
            raise PlanError(f"Values cannot be compared with {operator!r}.")
        sides = (left, right)
        letterless = any(isinstance(each, p.Text) and not _letters(each) for each in sides)
        if {self.types.of(each) for each in sides} == {"str"} and not letterless:
            return Compare(self.lowered(left), operator, self.lowered(right))
        return Compare(self.side(left), operator, self.side(right))

    def sought(
        self, left: p.Value, operator: str, right: p.Value
    ) -> tuple[Document, str, Document]:
        """The parts of a comparison with `in`."""
        kind = self.types.of(right)
        if "str" not in (self.types.of(left), kind):
            return self.side(left), operator, self.side(right)
        if isinstance(right, p.Items):
            items = Brackets("[", tuple(map(self.lowered, right.items)), "]")
            return self.lowered(left), operator, items
        if kind == "list[str]":
            each = self.names.spare("name")
            comprehension = Operators(
                f"for {each} in", (Atom(f"{each}.lower()"), self.value(right))
            )
            all_lowered = Brackets("[", (comprehension,), "]", trailing_comma=False)
            return self.lowered(left), operator, all_lowered
        if kind == "str":
            return self.lowered(left), operator, self.lowered(right)
        return self.side(left), operator, self.side(right)

    def side(self, value: p.Value) -> Document:
        """One side of a comparison."""
        document = self.value(value)
        is_condition = isinstance(value, p.Compare | p.Not | p.Both | p.Either)
        return enclosed(document) if is_condition else document

    def lowered(self, value: p.Value) -> Document:
        match value:
            case p.Text(value=text):
                return String(((text.lower(), False),))
            case _:
                return Prefix("", enclosed(self.value(value)), ".lower()")


def _is_negation(value: p.Arithmetic) -> bool:
    return value.operator == "-" and value.left == p.Number(0)


def _letters(text: p.Text) -> bool:
    return text.value.lower() != text.value.upper()


def _number(value: int | float) -> str:
    if isinstance(value, float):
        if not math.isfinite(value):
            raise PlanError(f"{value} is no number a robot can use.")
        return repr(value).replace("e+", "e")
    if abs(value) > MOST:
        raise PlanError("The number is too large for a robot.")
    return str(value)
