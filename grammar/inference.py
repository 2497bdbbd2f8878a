"""What kind of value everything in a plan is, so far as the method table tells (`grammar.kinds`).

Programs need it in a few spots only: texts are compared in lower case, what was heard has to be
made a number before it can be counted with, a list is spoken with commas.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, assert_never

from grammar import plan as p
from grammar.kinds import (
    FIELDS,
    NEVER,
    PROBLEM,
    is_list,
    is_number,
    is_record,
    item_of,
    joined,
    record,
    value_of,
)
from grammar.traversal import walk
from robot_api.methods import METHODS, Method, Parameter


def form_for(method: Method, arguments: Mapping[str, Any]) -> tuple[Parameter, ...] | None:
    """The form of the method that takes these arguments, or None."""
    for form in method.forms:
        known = {parameter.name for parameter in form}
        required = {parameter.name for parameter in form if parameter.required}
        if required <= arguments.keys() and (method.extra or arguments.keys() <= known):
            return form
    return None


class Types:
    """The kinds of a plan's values."""

    def __init__(self, plan: p.Plan) -> None:
        self.names: dict[str, str] = {}
        """Every name the plan gives, in order, with the kind of its value."""
        for step in walk(plan.steps):
            self._learn_from(step)

    def _learn_from(self, step: p.Step) -> None:
        match step:
            case p.Call(save_as=str() as name):
                self._learn(name, self.of(p.Ask(step.method)))
            case p.Remember():
                self._learn(step.name, self.of(step.value))
            case p.ForEach():
                kind = self.of(step.items)
                self._learn(step.variable, item_of(kind))
                if step.value is not None:
                    self._learn(step.value, value_of(kind) if is_record(kind) else "Any")
            case p.Collect():
                self._learn(step.name, f"list[{self.of(step.value)}]")
            case p.Increase(key=None):
                self._learn(step.name, self._added(self.names.get(step.name, NEVER), step.by))
            case p.Increase(key=key, by=by) if key is not None:
                self._learn_entry(step.name, key, self._added("int", by))
            case p.SetItem():
                self._learn_entry(step.name, step.key, self.of(step.value))
            case p.Try(problem=str() as name):
                self._learn(name, PROBLEM)
            case _:
                pass

    def _learn(self, name: str, kind: str) -> None:
        self.names[name] = joined((self.names.get(name, NEVER), kind))

    def _learn_entry(self, name: str, key: p.Value, kind: str) -> None:
        if is_list(self.names.get(name, NEVER)):
            self._learn(name, f"list[{kind}]")
        else:
            self._learn(name, record(self.of(key), kind))

    def _added(self, kind: str, by: p.Value | None) -> str:
        """The kind of a value of such a kind with something added to it."""
        more = "int" if by is None else self.of(by)
        if kind == "str" or is_list(kind):
            return joined((kind, more)) if is_list(kind) else kind
        return more if is_number(more) else "int"

    def of(self, value: p.Value) -> str:
        match value:
            case p.Text() | p.Sentence() | p.Weekday() | p.Join():
                return "str"
            case p.Number():
                number = value.value
                return "int" if isinstance(number, int) or number.is_integer() else "float"
            case p.HasCome():
                return "bool"
            case p.Truth() | p.Holds() | p.Compare() | p.Not() | p.Both() | p.Either():
                return "bool"
            case p.Recall():
                return self.names.get(value.name, "Any")
            case p.Items():
                return f"list[{joined(map(self.of, value.items))}]"
            case p.Record():
                keys = joined(self.of(key) for key, _ in value.entries)
                return record(keys, joined(self.of(entry) for _, entry in value.entries))
            case p.Range():
                return "list[int]"
            case p.Ask():
                method = METHODS.get(value.method)
                kind = method.returns.annotation if method else "Any"
                return kind if value.field is None else _field(kind, value.field)
            case p.Field():
                return _field(self.of(value.of), value.name)
            case p.Length() | p.Share() | p.Elapsed() | p.Occurrences() | p.NumberIn():
                return "int"
            case p.Item():
                kind = value_of(self.of(value.of))
                return kind if value.default is None else joined((kind, self.of(value.default)))
            case p.ListOf() | p.Sorted() | p.Distinct():
                return f"list[{item_of(self.of(value.of))}]"
            case p.Values():
                return f"list[{value_of(self.of(value.of))}]"
            case p.KeyOf() | p.Choice():
                return item_of(self.of(value.among if isinstance(value, p.Choice) else value.of))
            case p.Arithmetic():
                return self._calculated(value)
            case p.Aggregate():
                kind = item_of(self.of(value.of))
                return kind if is_number(kind) else "Any"
            case p.Round():
                return "int" if value.digits == p.Number(0) else "float"
            case p.Absolute():
                kind = self.of(value.of)
                return kind if is_number(kind) else "Any"
            case p.Figure():
                return "float" if value.how == "average" else "int"
            case _:
                assert_never(value)

    def _calculated(self, value: p.Arithmetic) -> str:
        left, right = self.of(value.left), self.of(value.right)
        if value.operator == "+" and is_list(left):
            return joined((left, right))
        if value.operator == "+" and puts_together(left, right):
            return "str"
        if value.operator == "/":
            return "float"
        kinds = joined((left, right))
        return kinds if is_number(kinds) else "Any"


def truth(value: p.Value, kind: str) -> p.Condition:
    """The condition that a value is: what is no yes or no holds if there is something in it."""
    if isinstance(value, p.Holds | p.Compare | p.Not | p.Both | p.Either):
        return value
    if is_list(kind) or is_record(kind):
        return p.Compare(p.Length(value), ">", p.Number(0))
    if kind == "str" and value != p.PLACE:  # which may be no named place
        return p.Compare(value, "!=", p.Text(""))
    return p.Compare(value, "!=", p.Number(0)) if is_number(kind) else p.Holds(value)


def puts_together(left: str, right: str) -> bool:
    """Whether the sum of two such values is a text."""
    return "str" in (left, right) and not (is_number(left) or is_number(right))


def _field(kind: str, field: str) -> str:
    return FIELDS.get(kind, {}).get(field, "Any")
