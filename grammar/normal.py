"""The normal form of a plan: the one form of all plans that say the same.

    normal(one) == normal(other)          exactly if both are written as the same program

Whatever writing a program loses is decided here: names become identifiers, texts that are compared
lose their capitals, what has to be made a text or a number says so (`Sentence`, `NumberIn`), pauses
are taken out. Equal ways of saying the same in Python become one: `x = x + 1` is an `Increase`, a
loop that begins with leaving it is a `While`.
"""

from __future__ import annotations

import keyword
import re
from collections.abc import Callable, Iterator
from typing import Any, Final, TypeVar

import msgspec

from grammar import plan as p
from grammar.identifiers import identifier, speaks_of, with_identifiers
from grammar.inference import Types, form_for, puts_together, truth
from grammar.kinds import is_list, is_number, item_of
from grammar.pauses import takes_time, without_pauses
from grammar.traversal import rebuilt
from grammar.writing import MOST, OPPOSITES
from robot_api.methods import METHODS

MIRRORED: Final = {"==": "==", "!=": "!=", "<": ">", "<=": ">=", ">": "<", ">=": "<="}
"""The same comparison with its sides exchanged."""

ZERO: Final = p.Number(0)
ONE: Final = p.Number(1)
NO_TEXT: Final = p.Text("")
MOST_TIMES: Final = 50
"""Three are enough for what people write."""
LITERALS: Final = (p.Text, p.Number, p.Truth)
CONDITIONAL: Final = (p.If, p.While, p.RepeatUntil, p.Not, p.Both, p.Either)
"""The nodes with conditions in them; all others have values."""

Part = TypeVar("Part", bound=p.Plan | p.Node)


def normal(plan: p.Plan) -> p.Plan:
    """The plan in its normal form, which is a plan, too, and its own normal form."""
    background = tuple(filter(None, map(_on_one_line, plan.background)))
    plan = msgspec.structs.replace(plan, background=background)
    for _ in range(MOST_TIMES):
        before, plan = plan, _simpler(plan)
        if plan == before:
            break
    return plan


def _simpler(plan: p.Plan) -> p.Plan:
    """One time through: what a change makes possible elsewhere is for the next time."""
    plan = with_identifiers(plan)
    return without_pauses(_Simplifier(plan).simplified(plan))


def _on_one_line(said: str) -> str:
    return " ".join("".join(each if each.isprintable() else " " for each in said).split())


# --- values, conditions, steps -------------------------------------------------------------------


class _Simplifier:
    """Makes the parts of one plan simpler, from the inside to the outside."""

    def __init__(self, plan: p.Plan) -> None:
        self.whole_plan = plan
        self.types = Types(plan)

    def simplified(self, part: Part) -> Part:
        part = rebuilt(part, self.simplified)
        if not isinstance(part, CONDITIONAL):
            part = rebuilt(part, _as_value)
        simpler: Any = self.simpler(part)
        return simpler  # type: ignore[no-any-return]

    def simpler(self, part: Any) -> Any:
        """A part whose own parts are as simple as they can be."""
        match part:
            # values
            case p.Number(value=number):
                return p.Number(_whole_if_it_is(number))
            case p.Sentence(parts=parts):
                return self.sentence(parts)
            case p.Ask(method=method, arguments=arguments):
                return msgspec.structs.replace(part, arguments=self.arguments(method, arguments))
            case p.Field(of=p.Ask(field=None) as ask, name=name):
                return msgspec.structs.replace(ask, field=name)
            case p.Field(of=of, name="place") if self.types.of(of) == "Location":
                return p.Sentence((of,))  # where there is no named place, its coordinates
            case p.Length(of=of):
                # A method that counts already gives the number.
                return of if self.types.of(of) == "int" else p.Length(_itself(of))
            case p.Item(of=of, at=at) if is_list(self.types.of(of)):
                return msgspec.structs.replace(part, at=self.whole(at))
            case p.ListOf(of=p.ListOf() | p.Values() | p.Sorted() | p.Distinct() as of):
                return of
            case p.Sorted(of=of) | p.Distinct(of=of):
                return msgspec.structs.replace(part, of=_itself(of))
            case p.Join(of=of, separator=separator):
                return self.join(_itself(of), self.text(separator))
            case p.Range(stop=stop, start=start):
                return p.Range(self.whole(stop), self.whole(start))
            case p.Arithmetic():
                return self.calculated(part)
            case p.Aggregate(of=p.Items(items=items)):
                numbers = p.Items(tuple(map(self.number, items)))
                return msgspec.structs.replace(part, of=numbers)
            case p.Aggregate(of=of):
                return msgspec.structs.replace(part, of=_itself(of))
            case p.Round(of=of, digits=digits):
                return p.Round(self.number(of), self.whole(digits))
            case p.Absolute(of=of):
                return p.Absolute(self.number(of))
            case p.NumberIn(of=of):
                return of if is_number(self.types.of(of)) else part
            case p.Share(part=one, whole=all_of_it):
                return p.Share(self.number(one), self.number(all_of_it))
            case p.Elapsed(since=since):
                return p.Elapsed(self.text(since))
            # conditions
            case p.Holds(value=p.Sentence(parts=(one,))) if self.types.of(one) == "Location":
                return p.Holds(p.Field(one, "place"))  # whether there is one
            case p.Holds(value=value):
                return truth(_itself(value), self.types.of(value))
            case p.Compare():
                return self.comparison(part.left, part.operator, part.right)
            case p.Not(condition=condition):
                return self.negated(condition)
            case p.Both(conditions=conditions) | p.Either(conditions=conditions):
                return _opened(type(part), conditions)
            # steps
            case p.Call(method=method, arguments=arguments):
                return msgspec.structs.replace(part, arguments=self.arguments(method, arguments))
            case p.Remember(name=name, value=value):
                return self.remembered(name, value)
            case p.Increase():
                return self.increased(part)
            case p.SetItem():
                step = as_increase(part)
                return self.increased(step) if isinstance(step, p.Increase) else step
            case p.If(condition=condition, then=(), otherwise=(_, *_) as otherwise):
                return p.If(self.negated(condition), otherwise)
            case p.Repeat(times=times, steps=steps):
                return p.Repeat(self.whole(times), steps)
            case p.ForEach(items=p.Range(stop=stop, start=p.Number(value=0)), value=None):
                return part if self.is_counted_with(part) else p.Repeat(stop, part.steps)
            case p.While() | p.RepeatUntil() | p.Forever():
                return self.loop(part)
            case p.Try(otherwise=otherwise, problem=str(name)) if not speaks_of(otherwise, name):
                return msgspec.structs.replace(part, problem=None)
            case _:
                return part

    # --- what has to be a text or a number -------------------------------------------------------

    def text(self, value: p.Value) -> p.Value:
        """The value where a text is wanted."""
        return value if self.types.of(value) == "Any" else self.made_text(value)

    def made_text(self, value: p.Value) -> p.Value:
        return value if self.types.of(value) == "str" else self.sentence((value,))

    def number(self, value: p.Value) -> p.Value:
        """The value where a number is wanted: what was heard has to be made one."""
        if self.types.of(value) != "str":
            return value
        if isinstance(value, p.Text) and re.fullmatch(r"-?[0-9]{1,9}(\.[0-9]{1,9})?", value.value):
            return p.Number(_whole_if_it_is(float(value.value)))
        return p.NumberIn(value)

    def whole(self, value: p.Value) -> p.Value:
        """The value where a whole number is wanted."""
        number = self.number(value)
        return p.Round(number) if self.types.of(number) == "float" else number

    def arguments(self, name: str, arguments: dict[str, p.Value]) -> dict[str, p.Value]:
        """The arguments of a call in the order of the method's parameters, each as it is wanted."""
        method = METHODS.get(name)
        form = method and form_for(method, arguments)
        if not form:
            return arguments
        wanted: dict[str, Callable[[p.Value], p.Value]] = {
            "float": self.number,
            "int": self.whole,
            "str": self.text,
            "list[str]": self.texts,
        }
        ordered: dict[str, p.Value] = {}
        for parameter in form:
            if parameter.name in arguments:
                annotation = parameter.kind.annotation.removesuffix(" | None")
                given, change = arguments[parameter.name], wanted.get(annotation)
                ordered[parameter.name] = change(given) if change else given
        extra = sorted(arguments.keys() - ordered.keys())
        return ordered | {_parameter(name): arguments[name] for name in extra}

    def texts(self, value: p.Value) -> p.Value:
        return p.Items(tuple(map(self.text, value.items))) if isinstance(value, p.Items) else value

    def sentence(self, parts: tuple[p.Value, ...]) -> p.Value:
        """Parts put together: those of sentences within opened, texts that meet made one."""
        opened: list[p.Value] = []
        for part in self.opened(parts):
            if isinstance(part, p.Text) and opened and isinstance(opened[-1], p.Text):
                opened[-1] = p.Text(opened[-1].value + part.value)
            elif part != NO_TEXT:
                opened.append(part)
        match opened:
            case []:
                return NO_TEXT
            case [one] if self.types.of(one) == "str":
                return one
            case _:
                return p.Sentence(tuple(opened))

    def opened(self, parts: tuple[p.Value, ...]) -> Iterator[p.Value]:
        for part in parts:
            match part:
                case p.Sentence(parts=inner):
                    yield from self.opened(inner)
                case p.Number(value=number) if abs(number) <= MOST:
                    yield p.Text(repr(_whole_if_it_is(number)))
                case p.Ask(method="location", field=None):
                    yield p.PLACE
                case p.ListOf(of=of):
                    yield from self.opened((self.join(of, p.Text(", ")),))
                case _:
                    yield part

    def join(self, items: p.Value, separator: p.Value) -> p.Value:
        """Items put together; with commas between them as a list is in a sentence."""
        if separator == p.Text(", ") and is_list(self.types.of(items)):
            return p.Sentence((items,))
        return p.Join(items, separator)

    def calculated(self, value: p.Arithmetic) -> p.Value:
        left, right = value.left, value.right
        kinds = self.types.of(left), self.types.of(right)
        if value.operator == "+":
            if any(map(is_list, kinds)):
                return value
            if puts_together(*kinds):
                return self.sentence((left, right))
        if value.operator == "-" and left == ZERO:
            return negative(self.number(right))
        return p.Arithmetic(self.number(left), value.operator, self.number(right))

    # --- conditions ------------------------------------------------------------------------------

    def negated(self, condition: p.Condition) -> p.Condition:
        match condition:
            case p.Not(condition=inner):
                return inner
            case p.Holds(value=p.Truth(value=truth)):
                return p.Holds(p.Truth(not truth))
            case p.Compare(left=left, operator=operator, right=right) if operator in OPPOSITES:
                return self.comparison(left, OPPOSITES[operator], right)
            case _:
                return p.Not(condition)

    def comparison(self, left: p.Value, operator: str, right: p.Value) -> p.Condition:
        if operator == "in":
            return self.sought(left, _itself(right))
        if operator in MIRRORED and isinstance(left, LITERALS) and not isinstance(right, LITERALS):
            left, operator, right = right, MIRRORED[operator], left
        kinds = {self.types.of(left), self.types.of(right)}
        match operator, right:
            case "==" | "!=", p.Items(items=()) | p.Record(entries=()):
                return self.comparison(p.Length(left), operator, ZERO)
            case "==" | "!=", p.Truth(value=yes) if kinds == {"bool"}:
                holds = truth(left, "bool")
                return holds if yes is (operator == "==") else self.negated(holds)
            case "!=" | "<=", p.Number(value=0) if isinstance(left, p.Length):
                operator = ">" if operator == "!=" else "=="
        if any(map(is_number, kinds)):
            left, right = self.number(left), self.number(right)
        elif "str" in kinds or kinds == {"Location"}:
            left, right = self.compared_text(left), self.compared_text(right)
        return p.Compare(left, operator, right)

    def sought(self, left: p.Value, right: p.Value) -> p.Condition:
        """Whether something is in something else."""
        kind, sought = self.types.of(right), self.types.of(left)
        if is_list(kind):
            if is_number(item_of(kind)) or (is_number(sought) and isinstance(right, p.Items)):
                return p.Compare(self.number(left), "in", self.each(right, self.number))
            if "str" in (item_of(kind), sought):
                left = self.compared_text(left)
                return p.Compare(left, "in", self.each(right, self.compared_text))
        if kind in ("str", "Any"):
            left, right = self.compared_text(left), self.compared_text(right)
        return p.Compare(left, "in", right)

    def each(self, items: p.Value, change: Callable[[p.Value], p.Value]) -> p.Value:
        return p.Items(tuple(map(change, items.items))) if isinstance(items, p.Items) else items

    def compared_text(self, value: p.Value) -> p.Value:
        text = self.made_text(value)
        return p.Text(text.value.lower()) if isinstance(text, p.Text) else text

    # --- steps -----------------------------------------------------------------------------------

    def remembered(self, name: str, value: p.Value) -> p.Step:
        """Keeping the result of a robot method is part of the call; adding to what a name has
        already is an increase."""
        match value:
            case p.Ask(method=method, arguments=arguments, field=None):
                return p.Call(method, arguments, name)
            case p.Arithmetic():
                step = as_increase(p.Remember(name, value))
                return self.increased(step) if isinstance(step, p.Increase) else step
            case p.Sentence(parts=(p.Recall(name=same), _, *_)) if same == name:
                if self.types.of(p.Recall(name)) == "str":
                    return p.Increase(name, self.sentence(value.parts[1:]))
        return p.Remember(name, value)

    def increased(self, step: p.Increase) -> p.Increase:
        kind = "int" if step.key is not None else self.types.of(p.Recall(step.name))
        by = step.by
        if by is not None and is_number(kind):
            by = self.number(by)
        elif by is not None and kind == "str":
            by = self.made_text(by)
        return msgspec.structs.replace(step, by=None if by == ONE else by)

    def is_counted_with(self, loop: p.ForEach) -> bool:
        """Whether something uses the number of the round: in the loop, or outside of all loops over
        numbers of the same name."""
        return speaks_of(loop.steps, loop.variable) or speaks_of(
            self.whole_plan.steps, loop.variable
        )

    def loop(self, loop: p.While | p.RepeatUntil | p.Forever) -> p.Step:
        """A loop without a number of rounds: a `While` if it is left before anything is done, a
        `RepeatUntil` if at the end of a round."""
        match loop:
            case p.While(condition=p.Holds(value=p.Truth(value=True)), steps=steps):
                return self.loop(p.Forever(steps))
            case p.RepeatUntil(condition=condition, steps=()) if takes_time(condition):
                return p.While(self.negated(condition), ())
            case p.Forever(steps=(p.If(condition, (p.End(),), otherwise), *rest)):
                return p.While(self.negated(condition), (*otherwise, *rest))
            case p.Forever(steps=(p.If(condition, then, (p.End(),)), *rest)):
                return p.While(condition, (*then, *rest))
            case p.Forever(steps=(*rest, p.If(then=(p.End(),), otherwise=()) as last)):
                return self.loop(p.RepeatUntil(last.condition, tuple(rest)))
            case _:
                return loop


def _whole_if_it_is(number: int | float) -> int | float:
    whole = isinstance(number, float) and number.is_integer() and abs(number) <= MOST
    return int(number) if whole else number


def _parameter(name: str) -> str:
    """The name of a skill's own parameter as Python can write it."""
    plain = name.isascii() and name.isidentifier() and not keyword.iskeyword(name)
    return name if plain else identifier(name)


def _as_value(part: p.Node) -> p.Node:
    """A condition where a value is wanted."""
    return part.value if isinstance(part, p.Holds) else part


def _itself(value: p.Value) -> p.Value:
    """What a list was made of, where a list of its own makes no difference."""
    return value.of if isinstance(value, p.ListOf) else value


def _opened(
    kind: type[p.Both] | type[p.Either], conditions: tuple[p.Condition, ...]
) -> p.Condition:
    """Conditions joined: those of the same kind within opened, one alone as it is."""
    opened: list[p.Condition] = []
    for each in conditions:
        opened += each.conditions if isinstance(each, kind) else [each]
    match opened:
        case []:
            return p.Holds(p.Truth(kind is p.Both))
        case [one]:
            return one
        case _:
            return kind(tuple(opened))


def as_increase(step: p.Remember | p.SetItem) -> p.Step:
    """Giving a name, or an entry of a record, more than it had as adding to it; what has no entry
    counts as 0."""
    match step:
        case p.Remember(name=name, value=p.Arithmetic() as value):
            before: p.Value = p.Recall(name)
            key = None
        case p.SetItem(name=name, key=key, value=p.Arithmetic() as value):
            before = p.Item(p.Recall(name), key)
        case _:
            return step
    left = value.left
    if isinstance(left, p.Item) and left.default == ZERO:
        left = p.Item(left.of, left.at)
    if left != before or value.operator not in ("+", "-"):
        return step
    by = value.right if value.operator == "+" else negative(value.right)
    return p.Increase(name, None if by == ONE else by, key)


def negative(value: p.Value) -> p.Value:
    """The value with the other sign."""
    return p.Number(-value.value) if isinstance(value, p.Number) else p.Arithmetic(ZERO, "-", value)
