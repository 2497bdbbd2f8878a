"""Values and conditions of a program as those of a plan.

What `grammar.writing` writes is read as what it was written from, and so are other ways to say the
same in Python. The rest is kept as `Code`, and why no plan can say it is noted (`problems`).
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Final

from grammar import plan as p
from grammar.forms import ALIKE, FORMS
from grammar.helpers import HELPERS, is_helper
from grammar.inference import Types, form_for
from grammar.kinds import FIELDS
from grammar.normal import negative
from grammar.writing import MOST
from robot_api.methods import METHODS


class Code(p.Recall, frozen=True, tag="code"):
    """A value that no plan could give; `name` is its source."""


@dataclass(frozen=True)
class Problem:
    """What no plan can say, and why."""

    line: int
    sentence: str


@dataclass(frozen=True)
class Doubt:
    """A value that is only what it was read as if it is not of this kind."""

    of: p.Value
    kind: str
    problem: Problem


COMPARISONS: Final[dict[type[ast.cmpop], str]] = {
    ast.Eq: "==",
    ast.NotEq: "!=",
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Is: "==",
    ast.IsNot: "!=",
}

_CALCULATED: Final[dict[type[ast.operator], str]] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "//",
    ast.Mod: "%",
}

_TEXT_AS_IT_IS: Final = frozenset({"lower", "casefold", "strip"})
"""Methods of texts that change nothing that a robot hears or compares."""

_PLAIN: Final = frozenset({"str", "int", "float", "bool", "map"})
_PYTHON: Final = _PLAIN.union(*(form.uses for form in (*FORMS, *ALIKE)))
"""What programs get from Python, and may give another meaning."""

_INSTEAD: Final[dict[type[ast.AST], str]] = {
    ast.FunctionDef: "It has no functions of its own: write the steps where they are needed.",
    ast.ClassDef: "It has no classes: use names, lists and dicts.",
    ast.Lambda: "It has no functions of its own: use a loop.",
    ast.ListComp: "Fill the list in a loop instead.",
    ast.SetComp: "Fill a list in a loop instead.",
    ast.DictComp: "Fill the dict in a loop instead.",
    ast.GeneratorExp: "Use a loop instead.",
    ast.IfExp: "Use if and else on lines of their own instead.",
    ast.NamedExpr: "Give the name its value on a line before.",
    ast.Slice: "Take items one by one in a loop instead.",
    ast.Starred: "Write the values one by one.",
    ast.With: "There is nothing to open.",
    ast.Match: "Use if and elif instead.",
    ast.Try: "Use try with one except Exception, and nothing after it.",
    ast.For: "Loop with one name over a list or a range, without else.",
    ast.While: "Use while without else.",
}
"""What to write instead of what no plan can say."""


_FUNCTIONS_INSTEAD: Final = {
    "print": "Use robot.say or robot.show instead.",
    "input": "Use robot.ask instead.",
    "any": "Use a loop instead.",
    "all": "Use a loop instead.",
    "enumerate": "Loop over the list itself and count, or over a range.",
    "zip": "Loop over a range and take items by their number.",
}


def problem_with(node: ast.stmt | ast.expr, source: str) -> Problem:
    """Why no plan can say this: the first part of it that explains it."""
    for part in ast.walk(node):
        instead = _INSTEAD.get(type(part))
        if isinstance(part, ast.Name):
            instead = _FUNCTIONS_INSTEAD.get(part.id)
        if instead is not None:
            return Problem(getattr(part, "lineno", node.lineno), f"No plan can say this. {instead}")
    shown = " ".join(source.split())
    shown = shown if len(shown) <= 60 else f"{shown[:57]}..."
    return Problem(node.lineno, f"No plan can say {shown}. Say it in simpler steps.")


@dataclass
class ValueReader:
    """Reads the values and conditions of one program."""

    source: str
    tree: ast.Module
    redefined: frozenset[str] = field(init=False)
    """Names of Python's that the program gives another meaning, so that nobody can trust them."""
    problems: list[Problem] = field(init=False, default_factory=list)
    doubts: list[Doubt] = field(init=False, default_factory=list)

    def __post_init__(self) -> None:
        self.redefined = frozenset(_bound(self.tree)) & (_PYTHON | HELPERS)

    def code(self, node: ast.AST) -> str:
        return ast.get_source_segment(self.source, node) or ast.unparse(node)

    def unknown(self, node: ast.expr, sentence: str = "") -> Code:
        source = self.code(node)
        problem = Problem(node.lineno, sentence) if sentence else problem_with(node, source)
        self.problems.append(problem)
        return Code(source)

    # --- robot calls -----------------------------------------------------------------------------

    def asked(self, call: ast.Call) -> p.Ask | None:
        """A robot call with all its arguments by name; None if it is something else."""
        match call.func:
            case ast.Attribute(value=ast.Name(id="robot"), attr=name) if name in METHODS:
                method = METHODS[name]
            case _:
                return None
        if any(isinstance(each, ast.Starred) for each in call.args):
            return None
        named = {each.arg: each.value for each in call.keywords if each.arg is not None}
        if len(named) < len(call.keywords):
            return None
        for form in method.forms:
            names = [parameter.name for parameter in form]
            by_place = dict(zip(names, call.args, strict=False))
            given = {**by_place, **named}
            fits = len(call.args) <= len(form) and by_place.keys().isdisjoint(named)
            if fits and form_for(method, given) == form:
                # What is not given is None.
                said = {name: each for name, each in given.items() if not is_none(each)}
                return p.Ask(name, {name: self.value(each) for name, each in said.items()})
        return None

    # --- values ----------------------------------------------------------------------------------

    def value(self, node: ast.expr) -> p.Value:
        match node:
            case ast.Constant(value=bool() as truth):
                return p.Truth(truth)
            case ast.Constant(value=str() as text):
                return p.Text(text)
            case ast.Constant(value=int() | float() as number) if (
                math.isfinite(number) and abs(number) <= MOST
            ):
                return p.Number(number)
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return negative(self.value(operand))
            case ast.Name(id=name) if name != "robot":
                return p.Recall(name)
            case ast.List(elts=items) | ast.Tuple(elts=items) | ast.Set(elts=items) if not any(
                isinstance(item, ast.Starred) for item in items
            ):
                return p.Items(tuple(map(self.value, items)))
            case ast.Dict(keys=keys, values=values) if None not in keys:
                entries = zip(filter(None, keys), values, strict=True)
                return p.Record(tuple((self.value(key), self.value(each)) for key, each in entries))
            case ast.JoinedStr(values=parts):
                return p.Sentence(tuple(map(self.value, parts)))
            case ast.FormattedValue():
                return self.formatted(node)
            case ast.BinOp():
                return self.calculated(node)
            case ast.Attribute(value=of, attr=name):
                return self.part(node, of, name)
            case ast.ListComp(
                elt=ast.Call(func=ast.Attribute(value=ast.Name(id=same), attr="lower")),
                generators=[ast.comprehension(target=ast.Name(id=name), iter=items, ifs=[])],
            ) if same == name:
                return self.value(items)
            case ast.Compare() | ast.BoolOp() | ast.UnaryOp(op=ast.Not()):
                condition = self.condition(node)
                return condition.value if isinstance(condition, p.Holds) else condition
            case ast.Call():
                return self.called(node)
            case ast.Subscript():
                return self.formed(node) or self.unknown(node)
            case _:
                return self.unknown(node)

    def formatted(self, node: ast.FormattedValue) -> p.Value:
        """A value in the braces of an f-string; `:.1f` rounds it."""
        match node.format_spec:
            case None if node.conversion in (-1, ord("s")):
                return self.value(node.value)
            case ast.JoinedStr(values=[ast.Constant(value=str(how))]) if digits := re.fullmatch(
                r"\.(\d)f", how
            ):
                return p.Round(self.value(node.value), p.Number(int(digits[1])))
            case _:
                return self.unknown(node)

    def calculated(self, node: ast.BinOp) -> p.Value:
        operator = _CALCULATED.get(type(node.op))
        if operator == "+" and (added := self.added(node)) is not None:
            return p.Sentence(tuple(added))
        sides = (node.left, node.right)
        texts = any(map(_is_text, sides)) or any(isinstance(each, ast.List) for each in sides)
        if operator is None or (texts and operator != "+"):
            return self.unknown(node)
        return p.Arithmetic(self.value(node.left), operator, self.value(node.right))  # type: ignore[arg-type]

    def added(self, node: ast.expr) -> list[p.Value] | None:
        """The parts of texts put together with +; None if it is no text for certain."""
        parts: list[ast.expr] = []
        while isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
            parts.insert(0, node.right)
            node = node.left
        parts.insert(0, node)
        return [self.value(part) for part in parts] if any(map(_is_text, parts)) else None

    def part(self, node: ast.Attribute, of: ast.expr, name: str) -> p.Value:
        """A part of a location or of the time."""
        value = self.value(of)
        if not any(name in fields for fields in FIELDS.values()):
            return self.unknown(node)
        match value:
            case p.Ask(field=None, method=method) if name in FIELDS.get(_gives(method), {}):
                return p.Ask(method, value.arguments, name)
            case p.Ask():
                return self.unknown(node)
            case _:
                return p.Field(value, name)

    def called(self, call: ast.Call) -> p.Value:
        match call.func:
            case ast.Name(id=name) if name in self.redefined:
                return self.unknown(call)
            case ast.Attribute(value=ast.Name(id="robot"), attr=name):
                return self.asked(call) or self.unknown(call, self.no_such_call(call, name))
            case _:
                return self.converted(call) or self.formed(call) or self.unknown(call)

    def no_such_call(self, call: ast.Call, name: str) -> str:
        if name not in METHODS:
            return f"The robot has no method {name!r}."
        return f"robot.{name} cannot be called like this: {self.code(call)}."

    def converted(self, call: ast.Call) -> p.Value | None:
        """What only makes a text, a number or a condition of a value, and functions that take any
        number of values."""
        match call:
            case ast.Call(func=ast.Name(id="str"), args=[value], keywords=[]):
                return p.Sentence((self.value(value),))
            case ast.Call(func=ast.Name(id="int" | "float" as how), args=[value], keywords=[]):
                return self.made_number(value, how)
            case ast.Call(func=ast.Name(id="bool"), args=[value], keywords=[]):
                return p.Not(p.Not(self.condition(value)))
            case ast.Call(func=ast.Attribute(value=text, attr=method), args=[], keywords=[]) if (
                method in _TEXT_AS_IT_IS
            ):
                return self.value(text)
            case ast.Call(func=ast.Attribute(value=between, attr="join"), args=[items]):
                return p.Join(self.value(_each_as_text(items)), self.value(between))
            case ast.Call(func=ast.Name(id="max" | "min" as how), args=[_, _, *_], keywords=[]):
                numbers = p.Items(tuple(map(self.value, call.args)))
                return self.of_numbers(call, p.Aggregate("max" if how == "max" else "min", numbers))
            case ast.Call(
                func=ast.Attribute(value=ast.Name(id="random"), attr="randint"), args=[first, last]
            ) if "random" not in self.redefined:
                return p.Choice(p.Range(_one_more(self.value(last)), self.value(first)))
            case ast.Call(
                func=ast.Name(id="weekday_called"), args=[ast.List(elts=days)], keywords=[]
            ) if all(map(_is_text, days)):
                names = (name.value for name in days if isinstance(name, ast.Constant))
                return p.Weekday(tuple(str(day) for day in names))
            case _:
                return None

    def made_number(self, node: ast.expr, how: str) -> p.Value:
        """`int(...)` or `float(...)`: the number that a text names. A fraction cut off is no part
        of a plan, but what is divided and cut off is divided without remainder."""
        value = self.value(node)
        if how == "int":
            if isinstance(value, p.Arithmetic) and value.operator == "/":
                return p.Arithmetic(value.left, "//", value.right)
            sentence = "A plan does not cut numbers off. Use round, or // to divide."
            self.doubts.append(Doubt(value, "float", Problem(node.lineno, sentence)))
        return p.NumberIn(value)

    def formed(self, node: ast.expr) -> p.Value | None:
        """A value that is said in one of the forms that plans have for values."""
        for form in (*FORMS, *ALIKE):
            found = form.found(node)
            if found is None or form.uses & self.redefined:
                continue
            if any(isinstance(each, ast.Slice | ast.Starred) for each in found.values()):
                continue
            value = form.node(**form.fixed, **{name: self.value(at) for name, at in found.items()})
            if isinstance(value, p.Aggregate):
                return self.of_numbers(node, value)
            return value  # type: ignore[return-value]
        return None

    def of_numbers(self, node: ast.expr, value: p.Aggregate) -> p.Value:
        sentence = "A plan only knows the sum, the smallest and the largest of numbers."
        one_of_them = p.Choice(value.of)
        problem = Problem(node.lineno, sentence)
        self.doubts += [Doubt(value.of, "str", problem), Doubt(one_of_them, "str", problem)]
        return value

    def doubted(self, types: Types) -> Iterable[Problem]:
        """What is not as it was read, by the kinds of the plan's values."""
        return (doubt.problem for doubt in self.doubts if types.of(doubt.of) == doubt.kind)

    # --- conditions ------------------------------------------------------------------------------

    def condition(self, node: ast.expr) -> p.Condition:
        match node:
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return p.Not(self.condition(operand))
            case ast.BoolOp(op=ast.And(), values=values):
                return p.Both(tuple(map(self.condition, values)))
            case ast.BoolOp(values=values):
                return p.Either(tuple(map(self.condition, values)))
            case ast.Compare():
                return self.compared(node)
            case _:
                return p.Holds(self.value(node))

    def compared(self, node: ast.Compare) -> p.Condition:
        """A comparison, or several in a row: `9 <= hour < 12`."""
        if any(isinstance(each, ast.Call) for at in node.comparators[:-1] for each in ast.walk(at)):
            sentence = "A plan would ask for the value in the middle twice. Give it a name before."
            return p.Holds(self.unknown(node, sentence))
        lefts = [node.left, *node.comparators]
        pairs = [
            self.comparison(node, left, operator, right)
            for left, operator, right in zip(lefts, node.ops, node.comparators, strict=False)
        ]
        return pairs[0] if len(pairs) == 1 else p.Both(tuple(pairs))

    def comparison(
        self, whole: ast.Compare, left: ast.expr, operator: ast.cmpop, right: ast.expr
    ) -> p.Condition:
        if isinstance(operator, ast.In | ast.NotIn):
            inside = p.Compare(self.value(left), "in", self.value(right))
            return p.Not(inside) if isinstance(operator, ast.NotIn) else inside
        identity = isinstance(operator, ast.Is | ast.IsNot)
        if identity and not (
            isinstance(right, ast.Constant) and right.value in (None, True, False)
        ):
            return p.Holds(self.unknown(whole, "A plan has no is between values. Use == instead."))
        if is_none(right) and not isinstance(left, ast.Name):
            return p.Holds(
                self.unknown(whole, "A plan has no None. Ask for what there is instead.")
            )
        against = p.Text("") if is_none(right) else self.value(right)
        return p.Compare(self.value(left), COMPARISONS[type(operator)], against)


def is_none(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is None


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr) or (
        isinstance(node, ast.Constant) and isinstance(node.value, str)
    )


def _gives(method: str) -> str:
    return METHODS[method].returns.annotation


def _one_more(value: p.Value) -> p.Value:
    if isinstance(value, p.Number):
        return p.Number(value.value + 1)
    return p.Arithmetic(value, "+", p.Number(1))


def _each_as_text(items: ast.expr) -> ast.expr:
    """What is put together: `str(each) for each in numbers` is `numbers`."""
    match items:
        case (
            ast.GeneratorExp(
                elt=ast.Call(func=ast.Name(id="str"), args=[ast.Name(id=same)]),
                generators=[ast.comprehension(target=ast.Name(id=name), iter=inner, ifs=[])],
            )
            | ast.ListComp(
                elt=ast.Call(func=ast.Name(id="str"), args=[ast.Name(id=same)]),
                generators=[ast.comprehension(target=ast.Name(id=name), iter=inner, ifs=[])],
            )
        ) if same == name:
            return inner
        case ast.Call(func=ast.Name(id="map"), args=[ast.Name(id="str"), inner]):
            return inner
        case _:
            return items


def _bound(tree: ast.Module) -> Iterable[str]:
    """The names that the program gives a meaning of its own."""
    for node in ast.walk(tree):
        match node:
            case ast.FunctionDef(name=name) if not is_helper(node):
                yield name
            case ast.ClassDef(name=name) | ast.arg(arg=name):
                yield name
            case ast.Name(id=name, ctx=ast.Store()):
                yield name
            case ast.alias(name=name, asname=str() as other) if name != other:
                yield other
            case _:
                pass
