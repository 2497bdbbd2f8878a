"""Conditions and values of a plan in words."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Final, assert_never

from grammar import plan as p
from grammar.inference import Types, truth
from grammar.kinds import is_list, is_record
from grammar.read_values import Code
from grammar.speech import Speech, Words, fill, fitting, forms, gaps
from grammar.traversal import walk
from grammar.which_time import which_time
from grammar.writing import OPPOSITES as COMPARED
from robot_api.methods import METHODS

ROLES: Final = {
    "thing": "thing",
    "person": "thing",
    "place": "place",
    "to": "place",
    "where": "place",
    "kind": "bare",
    "name": "bare",
    "contact": "bare",
    "code": "bare",
    "language": "bare",
    "time": "bare",
    "date": "bare",
    "options": "options",
}
"""How a parameter's text is put into a sentence; all others are quoted."""
CHOICES: Final = frozenset(
    parameter.name
    for method in METHODS.values()
    for form in method.forms
    for parameter in form
    if parameter.kind.choices
)
"""Parameters whose text is one of a few, which the words of their method call by name."""

LENGTHS_OF_TIME: Final = frozenset({"seconds", "timeout"})
LANGUAGES: Final = frozenset({"code", "language"})
"""Parameters that a language's code is given to."""

NUMBERS: Final = frozenset(
    parameter.name
    for method in METHODS.values()
    for form in method.forms
    for parameter in form
    if parameter.kind.schema.get("type") in ("number", "integer")
)

OPPOSITES: Final = {**COMPARED, "in": "not in", "among": "not among"}


@dataclass
class ValueTeller:
    """Tells the conditions and values of one plan, each result by a name of its own."""

    words: Speech
    plan: p.Plan
    called: Callable[[str], str]
    types: Types = field(init=False)
    results: dict[str, str] = field(init=False, default_factory=dict)
    """What each remembered name is called wherever it is spoken of."""
    short: dict[str, str] = field(init=False, default_factory=dict)
    """What it may be called while it is the latest of its sort: "the answer"."""
    counting: dict[str, p.Value] = field(init=False, default_factory=dict)
    """The numbers of which only matters which time it is, each with how many times there are."""
    latest: dict[str, str] = field(init=False, default_factory=dict)
    """For each such short way the name that it means at this point of the plan."""
    makers: dict[str, p.Step | None] = field(init=False, default_factory=dict)
    """The step that makes each name, where it is only one."""
    told_apart: set[str] = field(init=False, default_factory=set)
    """The names whose spelling is needed to tell them from another."""

    def __post_init__(self) -> None:
        self.types = Types(self.plan)

    def named(self, name: str) -> str:
        return fill(self.words.values["named"], {"name": name})

    def quoted_code(self, source: str) -> str:
        return fill(self.words.values["code"], {"code": " ".join(source.split())})

    def finding(self, name: str, holds: bool = True) -> str | None:
        """How it is said that something was found out, or was not."""
        known = self.words.findings.get(sort_of(name))
        return known[0 if holds else 1] if known and name not in self.told_apart else None

    def record(self, name: str) -> str | None:
        return self.words.records.get(sort_of(name)) if name not in self.told_apart else None

    # --- values

    def patterned(self, patterns: tuple[str, ...], arguments: dict[str, p.Value]) -> str:
        """The most specific pattern filled, and after it whatever it leaves out."""
        pattern = fitting(patterns, set(arguments)) or patterns[-1]
        text = self.filled(pattern, arguments)
        left = [name for name in arguments if name not in gaps(pattern)]
        if not left:
            return text
        told = (
            f"{name.replace('_', ' ')}: {self.argument(name, arguments[name])}" for name in left
        )
        return f"{text} ({', '.join(told)})"

    def filled(self, pattern: str, arguments: dict[str, p.Value]) -> str:
        wanted = forms(pattern)
        for name, value in arguments.items():
            if isinstance(value, p.Number) and value.value == 1:
                pattern = self.words.nouns.one(pattern, name)
        return fill(
            pattern,
            {
                name: self.argument(name, arguments[name], form) if name in arguments else "…"
                for name, form in wanted.items()
            },
        )

    def argument(self, parameter: str, value: p.Value, form: str = "") -> str:
        role = ROLES.get(parameter, "quoted")
        nouns = self.words.nouns
        match value:
            case p.Number(value=seconds) if parameter in LENGTHS_OF_TIME:
                return self.words.durations.told(seconds)
            case _ if parameter in LENGTHS_OF_TIME:
                number = fill(self.words.values["inserted"], {"value": self.value(value)})
                return fill(self.words.durations.units[-1][2], {"number": number})
            case p.Text(value=text) if parameter in CHOICES:
                return self.words.choice(parameter, text)
            case p.Text(value=code) if parameter in LANGUAGES:
                return self.words.languages.get(code, code)
            case p.Text(value=text) if form == "plural":
                return nouns.many(self.called(text))
            case p.Text(value=text) if form == "the" or role == "place":
                return nouns.the(self.called(text))
            case p.Text(value=text) if role == "thing":
                return nouns.indefinite(self.called(text))
            case p.Text(value=text) if role == "bare":
                return self.called(text)
            case p.Items() if role == "options":
                return self.series(value.items, "or")
            case p.Recall() if role == "place" and self._is_answer(value.name):
                return fill(self.words.values["place"], {"value": self.value(value)})
            case p.Number() | p.Text() | p.Items() | p.Sentence():
                return self.value(value)
            case _ if parameter in NUMBERS:
                return fill(self.words.values["inserted"], {"value": self.value(value)})
            case _:
                return self.value(value)

    def _is_answer(self, name: str) -> bool:
        return any(
            isinstance(step, p.Call)
            and step.save_as == name
            and METHODS[step.method].returns.annotation == "str"
            for step in map(as_call, walk(self.plan.steps))
        )

    def recall(self, name: str) -> str:
        short = self.short.get(name)
        if short and self.latest.get(short) == name:
            return short
        return self.results.get(name) or self.named(name.replace("_", " "))

    def value(self, value: p.Value) -> str:
        say = self.words.values
        match value:
            case p.Text():
                return fill(say["quoted"], {"text": value.value})
            case p.Number():
                number = value.value
                whole = isinstance(number, float) and number.is_integer()
                return str(int(number)) if whole else str(number)
            case p.Truth():
                return say["true" if value.value else "false"]
            case Code(name=source):
                return self.quoted_code(source)
            case p.Recall():
                return self.recall(value.name)
            case p.Items():
                return self.series(value.items, "and")
            case p.Ask():
                return self.asked(value)
            case p.Sentence():
                return fill(say["quoted"], {"text": "".join(self._within_quotes(value.parts))})
            case p.Length(of=of) if self.types.of(of) == "int":
                return self.value(of)
            case p.Weekday():
                return self.words.methods["clock"].fields["weekday"]
            case p.Record(entries=()):
                return say["empty table"]
            case p.Record():
                entries = (
                    fill(say["entry"], {"key": self.value(key), "value": self.value(entry)})
                    for key, entry in value.entries
                )
                return fill(say["table"], {"entries": say["comma"].join(entries)})
            case p.Item():
                return self.item(value)
            case p.Range():
                values = {
                    "start": self.value(value.start),
                    "stop": self.value(more(value.stop, -1)),
                }
                known = isinstance(value.stop, p.Number)
                return fill(say["range" if known else "range to"], values)
            case p.Field(of=of, name="place"):
                return self.value(of)
            case p.Field():
                values = {"field": self.field(value), "of": self.value(value.of)}
                return fill(say["field"], values)
            case p.HasCome():
                return self.value(p.Holds(value))
            case p.Holds() | p.Compare() | p.Not() | p.Both() | p.Either():
                return fill(say["whether"], {"condition": self.condition(value)})
            case _:
                return self.phrased(say[self.kind_of(value)], value)

    def kind_of(self, value: p.Value) -> str:
        """The name of the phrase for a value; that of most is the tag of its node."""
        match value:
            case p.Length(of=p.Recall()):
                return "entries"
            case p.Figure(how=how):
                return how
            case p.KeyOf(function=function):
                return f"key of {function}"
            case p.Sorted(descending=True):
                return "sorted down"
            case p.Aggregate(function=function, of=p.Recall()):
                return {"max": "highest", "min": "lowest", "sum": "sum"}[function]
            case p.Aggregate(function=function):
                return f"{function} of"
            case p.Round(digits=digits) if digits != p.Number(0):
                return "round to"
            case p.Arithmetic(left=p.Number(value=0), operator="-"):
                return "negative"
            case p.Arithmetic(operator="+") if is_list(self.types.of(value)):
                return "together"
            case p.Arithmetic(operator=operator):
                return operator
            case _:
                return str(type(value).__struct_config__.tag)

    def phrased(self, pattern: str, value: p.Value) -> str:
        """A phrase whose gaps are the fields of a value."""
        for gap in gaps(pattern):
            if getattr(value, gap) == p.Number(1):
                pattern = self.words.nouns.one(pattern, gap)
        return fill(pattern, {gap: self.within(value, gap) for gap in gaps(pattern)})

    def within(self, value: p.Value, gap: str) -> str:
        """What is in a field of a value."""
        inside: p.Value = getattr(value, gap)
        if isinstance(value, p.Choice) and isinstance(inside, p.Items):
            return self.series(inside.items, "or")
        return self.grouped(inside) if isinstance(value, p.Arithmetic) else self.value(inside)

    def grouped(self, value: p.Value) -> str:
        """A value within another, in brackets if it would fall apart."""
        told = self.value(value)
        if isinstance(value, p.Arithmetic):
            return fill(self.words.values["group"], {"value": told})
        return told

    def item(self, item: p.Item) -> str:
        """The first of a list, or the entry of a record."""
        say = self.words.values
        of = self.value(item.of)
        match item:
            case p.Item(default=None) if is_record(self.types.of(item.of)):
                return fill(say["entry for"], {"at": self.value(item.at), "of": of})
            case p.Item(at=p.Number(value=0), default=None):
                return fill(say["first"], {"of": of})
            case p.Item(at=p.Number(value=-1), default=None):
                return fill(say["last"], {"of": of})
            case p.Item(at=at, default=default) if default is not None:
                told = fill(say["entry for"], {"at": self.value(at), "of": of})
                return fill(say["default"], {"value": told, "default": self.value(default)})
            case _:
                return fill(say["position"], {"at": self.grouped(more(item.at, 1)), "of": of})

    def field(self, field: p.Field) -> str:
        """What a part of a location or of the time is called."""
        for words in self.words.methods.values():
            if field.name in words.fields:
                return words.fields[field.name]
        return field.name

    def _within_quotes(self, parts: Iterable[p.Value]) -> Iterator[str]:
        for part in parts:
            match part:
                case p.Text():
                    yield part.value
                case p.Sentence():
                    yield from self._within_quotes(part.parts)
                case _:
                    value = self.words.joined_up(self.value(part))
                    yield fill(self.words.values["inserted"], {"value": value})

    def asked(self, ask: p.Ask) -> str:
        words = self.words.methods[ask.method]
        if ask.field in words.fields:
            return words.fields[ask.field]
        return self.patterned(words.value or words.do, ask.arguments)

    def minutes(self, value: p.Value) -> str:
        """So many minutes."""
        durations = self.words.durations
        if isinstance(value, p.Number):
            return durations.told(60 * value.value)
        number = fill(self.words.values["inserted"], {"value": self.value(value)})
        return next(
            fill(many, {"number": number}) for length, _, many in durations.units if length == 60
        )

    def series(self, items: Sequence[p.Value], word: str) -> str:
        return self.listed([self.value(item) for item in items], word)

    def listed(self, told: Sequence[str], word: str) -> str:
        if not told:
            return self.words.values["nothing"]
        if len(told) == 1:
            return told[0]
        return self.words.values["comma"].join(told[:-1]) + self.words.values[word] + told[-1]

    # --- conditions

    def condition(self, condition: p.Condition, holds: bool = True) -> str:
        say = self.words.conditions
        match condition:
            case p.Holds():
                return self.holds(condition.value, holds)
            case p.Compare():
                return self.comparison(condition, holds)
            case p.Not():
                return self.condition(condition.condition, not holds)
            case p.Both() | p.Either():
                if not condition.conditions:
                    return say["always" if isinstance(condition, p.Both) else "never"]
                # Not both hold if one of them does not.
                word = say["and" if isinstance(condition, p.Both) is holds else "or"]
                if len(condition.conditions) == 1:
                    return self.condition(condition.conditions[0], holds)
                return word.join(self.operand(each, holds) for each in condition.conditions)
            case _:
                assert_never(condition)

    def operand(self, condition: p.Condition, holds: bool) -> str:
        told = self.condition(condition, holds)
        if isinstance(condition, p.Both | p.Either) and len(condition.conditions) > 1:
            return fill(self.words.conditions["group"], {"condition": told})
        return told

    def holds(self, value: p.Value, holds: bool) -> str:
        say = self.words.conditions
        condition = truth(value, self.types.of(value))
        if not isinstance(condition, p.Holds):
            return self.condition(condition, holds)
        match value:
            case p.HasCome(time=time):
                told = time.value if isinstance(time, p.Text) else self.value(time)
                return fill(say["has come" if holds else "has not come"], {"time": told})
            case p.Truth():
                return say["always" if value.value is holds else "never"]
            case p.Ask() | p.Recall() if (so := self.came_to(value, holds)) is not None:
                return so
            case p.Recall(name=name) if (so := self.finding(name, holds)) is not None:
                return so
            case _:
                pass
        return fill(say["holds" if holds else "fails"], {"value": self.value(value)})

    def came_to(self, value: p.Value, holds: bool) -> str | None:
        """How it is said that a call gave something, or nothing: "I saw somebody"."""
        match value:
            case p.Ask(method=method, arguments=arguments, field=None):
                words = self.words.methods[method]
                patterns = words.holds if holds else words.fails
            case p.Recall(name=name) if name not in self.told_apart:
                call = self.makers.get(name)
                if not isinstance(call, p.Call):
                    return None
                words, arguments = self.words.methods[call.method], call.arguments
                patterns = words.held if holds else words.missed
            case _:
                return None
        return self.patterned(patterns, arguments) if patterns else None

    def comparison(self, compare: p.Compare, holds: bool) -> str:
        say = self.words.conditions
        for number, stop in self.counting.items():
            if (time := which_time(compare, number, stop)) is not None:
                return say[f"{time[0]} time" if time[1] is holds else f"not {time[0]} time"]
        operator = compare.operator
        if not holds and operator != "in":
            operator, holds = OPPOSITES[operator], True
        match compare:
            case p.Compare(left=p.Elapsed(since=since), right=right) if operator != "in":
                values = {"left": self.value(since), "right": self.minutes(right)}
                return fill(self.words.elapsed[operator], values)
            case p.Compare(operator="in", right=right) if is_record(self.types.of(right)):
                values = {"left": self.value(compare.left), "right": self.value(right)}
                return fill(say["has entry" if holds else "has no entry"], values)
            case p.Compare(operator="==" | "!=", left=p.Recall() as name, right=p.Text(value="")):
                so = self.finding(name.name, operator == "!=")
                if so is not None:
                    return so
                return fill(
                    say["unset" if operator == "==" else "set"], {"value": self.value(name)}
                )
            case p.Compare(operator="<" | ">", right=p.Recall(name=name)) if self.record(name):
                return fill(self.record(name) or "", {"left": self.value(compare.left)})
            case p.Compare(left=p.Ask(method=method, field=str(part)), right=p.Text(value=text)):
                patterns = self.words.methods[method].compared.get(part, {})
                if operator in patterns:
                    return fill(patterns[operator], {"right": text})
            case p.Compare(
                left=p.Length(of=p.Recall() | p.Ask() as names), right=p.Number(value=0)
            ):
                known = {"==": "empty", "<=": "empty", "!=": "not empty", ">": "not empty"}
                if operator in known and self.types.of(names) != "int":
                    so = self.came_to(names, known[operator] == "not empty")
                    if so is not None:
                        return so
                    values = {"value": self.value(names)}
                    return fill(self.words.conditions[known[operator]], values)
        values = {"left": self.value(compare.left), "right": self.value(compare.right)}
        if operator == "in":
            operator = "among" if is_list(self.types.of(compare.right)) else "in"
            if isinstance(compare.right, p.Items) and len(compare.right.items) == 1:
                operator = "=="  # "none of “Clara”" is not her
                values["right"] = self.value(compare.right.items[0])
            elif isinstance(compare.right, p.Items):
                values["right"] = self.series(compare.right.items, "or")
        if not holds:
            operator = OPPOSITES[operator]
        return fill(self.words.conditions[operator], values)


def more(value: p.Value, number: int) -> p.Value:
    """A value that is so much more: positions are told from 1 on, a range up to its last number."""
    match value:
        case p.Number(value=known):
            return p.Number(known + number)
        case p.Arithmetic(left=left, operator="+", right=p.Number(value=known)):
            return left if known == -number else p.Arithmetic(left, "+", p.Number(known + number))
        case _ if number < 0:
            return p.Arithmetic(value, "-", p.Number(-number))
        case _:
            return p.Arithmetic(value, "+", p.Number(number))


def sort_of(name: str) -> str:
    """A name without the number that tells it from others of its sort."""
    return name.rstrip("0123456789_")


def as_call(step: p.Step) -> p.Step:
    """Remembering what a robot method gives, as the call that it is."""
    match step:
        case p.Remember(name=name, value=p.Ask(field=None) as ask):
            return p.Call(ask.method, ask.arguments, name)
        case _:
            return step


def signed(
    words: Words, arguments: dict[str, p.Value]
) -> tuple[tuple[str, ...], dict[str, p.Value]]:
    """The patterns for what is done, and the arguments: turning by -90 is turning right by 90."""
    for name in gaps(words.negative[0]) if words.negative else ():
        number = arguments.get(name)
        if isinstance(number, p.Number) and number.value < 0:
            return words.negative, {**arguments, name: p.Number(-number.value)}
    return words.do, arguments
