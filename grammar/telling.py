"""Steps, conditions and values of a plan in words."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, assert_never

from grammar import plan as p
from grammar.inference import Types, may_end, walk
from grammar.reading import Code, CodeStep, Function
from grammar.speech import Speech, Words, fill, fitting, forms, gaps
from grammar.told import Told
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
    "options": "options",
}
"""How a parameter's text is put into a sentence; all others are quoted."""

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

OPPOSITES: Final = {
    "==": "!=",
    "!=": "==",
    "<": ">=",
    ">=": "<",
    ">": "<=",
    "<=": ">",
    "in": "not in",
    "among": "not among",
}


@dataclass
class Teller:
    """Tells the steps, conditions and values of one plan, each result by a name of its own."""

    words: Speech
    plan: p.Plan
    called: Callable[[str], str]
    types: Types = field(init=False)
    results: dict[str, str] = field(init=False, default_factory=dict)
    """What each remembered name is called wherever it is spoken of."""
    short: dict[str, str] = field(init=False, default_factory=dict)
    """What it may be called while it is the latest of its sort: "the answer"."""
    latest: dict[str, str] = field(init=False, default_factory=dict)
    """For each such short way the name that it means at this point of the plan."""
    makers: dict[str, p.Step | None] = field(init=False, default_factory=dict)
    """The step that makes each name, where it is only one."""
    told_apart: set[str] = field(init=False, default_factory=set)
    """The names whose spelling is needed to tell them from another."""

    def __post_init__(self) -> None:
        self.types = Types(self.plan)
        self._name_results()

    def _name_results(self) -> None:
        """Give everything remembered words of its own: the shortest that nothing else has."""
        choices: dict[str, list[str]] = {}
        for step in walk(self.plan.steps):
            match step:
                case p.Call(save_as=str() as name) | p.Remember(name=name):
                    step = _as_call(step)
                case p.ForEach(variable=name):
                    pass
                case _:
                    continue
            self.makers[name] = step if name not in self.makers else None
            wishes = list(self._called(name, step))
            known = choices.setdefault(name, wishes)
            if known != wishes:  # made in several ways: only what they have in common
                choices[name] = [wish for wish in known if wish in wishes] or [
                    self.named(name.replace("_", " "))
                ]
        for name, wishes in choices.items():
            self.short[name] = wishes[0]
            rivals = choices.keys() - {name} - self._apart_from(name)
            taken = {wish for other in rivals for wish in choices[other]}
            free = [wish for wish in wishes if wish not in taken]
            if free:
                self.results[name] = free[0]
            else:
                self.told_apart.add(name)
                values = {"value": wishes[0], "name": name.replace("_", " ")}
                self.results[name] = fill(self.words.values["told apart"], values)

    def _apart_from(self, name: str) -> set[str]:
        """Of what a loop goes over, the items of other loops: two loops one after the other may
        both speak of "this place", one within the other may not."""
        loop = self.makers.get(name)
        if not isinstance(loop, p.ForEach):
            return set()
        loops = [each for each in walk(self.plan.steps) if isinstance(each, p.ForEach)]
        within = [each for each in loops if any(inner is loop for inner in walk(each.steps))]
        near = {
            each.variable for each in (*within, *walk(loop.steps)) if isinstance(each, p.ForEach)
        }
        return {each.variable for each in loops} - near

    def forget(self, steps: Iterable[p.Step]) -> None:
        """After or before steps that may run or not: what they make is no longer just the latest,
        unless it would be the same anyway."""
        for step in map(_as_call, walk(steps)):
            if isinstance(step, p.Call) and step.save_as:
                short = self.short[step.save_as]
                if self.latest.get(short) != step.save_as:
                    self.latest.pop(short, None)

    def _called(self, name: str, step: p.Step) -> Iterator[str]:
        readable = name.replace("_", " ")
        match step:
            case p.Call():
                words = self.words.methods[step.method]
                if words.first and step == _as_call(self.plan.steps[0]):
                    yield words.first
                    return
                given = step.arguments.keys()
                patterns = [each for each in words.result if gaps(each) <= given]
                yield from (self.filled(each, step.arguments) for each in patterns)
                if not patterns:
                    yield self.named(readable)
            case p.ForEach():
                sort = readable.rstrip("0123456789").strip()
                item = self.words.values.get(f"item {sort}", self.words.values["item"])
                yield fill(item, {"name": sort})
            case _:
                kept = self.kept(name, step)
                known = self.words.names.get(name.rstrip("0123456789_"))
                yield kept[1] if kept else known or self.named(readable)

    def kept(self, name: str, step: p.Step) -> tuple[str, str] | None:
        """What a step starts to count or to list, and what the number or the list is called."""
        match step:
            case p.Remember(value=p.Number(value=0)):
                known = self.words.counts
            case p.Remember(value=p.Items(items=())):
                known = self.words.lists
            case _:
                return None
        readable = name.rstrip("0123456789").replace("_", " ").strip()
        for each in known:
            what, value = each.phrase(each.what, readable), each.phrase(each.value, readable)
            if what is not None and value is not None:
                return what, value
        return None

    def quoted_code(self, source: str) -> str:
        return fill(self.words.values["code"], {"code": " ".join(source.split())})

    def named(self, name: str) -> str:
        return fill(self.words.values["named"], {"name": name})

    # --- steps

    def told(self, steps: Iterable[p.Step]) -> Iterator[Told]:
        for step in steps:
            for told in self.step(step):
                yield told if told.step else replace(told, step=step)

    def step(self, step: p.Step) -> Iterator[Told]:
        say = self.words.steps
        match step := _as_call(step):
            case p.Call():
                yield Told(self.call(step))
            case p.Remember() if (kept := self.started(step)) is not None:
                pattern = say["count" if isinstance(step.value, p.Number) else "list"]
                yield Told(fill(pattern, {"what": kept}))
            case p.Remember(value=p.Items(items=())):
                yield Told(fill(say["empty"], {"name": self.recall(step.name)}))
            case p.Remember(value=p.Text(value="")):
                yield Told(fill(say["unset"], {"name": self.recall(step.name)}))
            case p.Remember():
                pattern = say["start" if isinstance(step.value, p.Number) else "remember"]
                values = {"value": self.value(step.value), "name": self.recall(step.name)}
                yield Told(fill(pattern, values))
            case p.Collect():
                values = {"value": self.value(step.value), "name": self.recall(step.name)}
                yield Told(fill(say["collect"], values))
            case p.Increase(by=p.Recall() as much):
                values = {"value": self.value(much), "name": self.recall(step.name)}
                yield Told(fill(say["collect"], values))
            case p.Increase():
                yield Told(fill(say["increase"], {"name": self.recall(step.name)}))
            case CodeStep(source=source):
                yield Told(fill(say["code"], {"code": self.quoted_code(source)}))
            case p.End():
                yield Told(say["end"])
            case p.If():
                yield from self.branches(step)
            case p.Repeat():
                yield self.loop("repeat", step.steps, times=self.times(step.times))
            case p.ForEach():
                yield self.loop("for each", step.steps, items=self.each_of(step))
            case p.While(steps=(p.Call(method="wait"),)):  # nothing is done but waiting
                until = self.condition(step.condition, holds=False)
                yield Told(fill(say["wait until"], {"condition": until}))
            case p.While():
                yield self.loop("while", step.steps, condition=self.condition(step.condition))
            case p.RepeatUntil():
                condition = self.condition(step.condition)
                yield self.loop("repeat until", step.steps, condition=condition)
            case Function(name=name):
                yield self.clause("function", step.steps, False, name=self.quoted_code(name))
            case p.Forever():
                leaves = any(map(may_end, step.steps))
                yield self.loop("again" if leaves else "forever", step.steps)
            case p.Try():
                yield self.clause("try", step.steps)
                self.forget(step.steps)
                if step.otherwise:
                    yield self.clause("failed", step.otherwise, continues=True)
                    self.forget(step.otherwise)
            case _:
                assert_never(step)

    def started(self, step: p.Remember) -> str | None:
        """What is counted or listed from here on, if its name says so and is that of nothing
        else."""
        kept = self.kept(step.name, step)
        return kept[0] if kept and self.results[step.name] == kept[1] else None

    def branches(self, step: p.If) -> Iterator[Told]:
        """If, otherwise if, otherwise: one after the other."""
        whole = step
        before = dict(self.latest)
        yield self.clause("if", step.then, condition=self.condition(step.condition))
        while True:
            self.latest = dict(before)
            match step.otherwise:
                case ():
                    break
                case (p.If() as inner,):
                    step = inner
                    clause = self.clause("if", step.then, condition=self.condition(step.condition))
                    values = {"outer": self.words.clauses["otherwise"], "inner": clause.text}
                    text = fill(self.words.joining["clauses"], values)
                    yield replace(clause, text=text, continues=True, step=step)
                case others:
                    yield self.clause("otherwise", others, continues=True)
                    break
        self.latest = before
        self.forget((whole,))

    def each_of(self, step: p.ForEach) -> str:
        """What a loop goes over; places and people by the names that speakers have for them."""
        items = step.items.items if isinstance(step.items, p.Items) else ()
        names = [item.value for item in items if isinstance(item, p.Text)]
        if len(names) < len(items) or all(self.called(name) == name for name in names):
            return self.value(step.items)
        return self.listed([self.words.nouns.the(self.called(name)) for name in names], "and")

    def loop(self, kind: str, steps: tuple[p.Step, ...], **values: str) -> Told:
        self.forget(steps)
        told = self.clause(kind, steps, False, **values)
        if not steps and kind not in ("repeat", "for each"):
            told = replace(told, steps=(Told(self.words.steps["pause"]),))
        self.forget(steps)
        return told

    def clause(
        self, kind: str, steps: tuple[p.Step, ...], continues: bool = False, **values: str
    ) -> Told:
        text = fill(self.words.clauses[kind], values)
        return Told(text, tuple(self.told(steps)), is_clause=True, continues=continues)

    def call(self, step: p.Call) -> str:
        words = self.words.methods[step.method]
        arguments = step.arguments
        if step.method == "drive":  # where it does not turn, nothing is said of turning
            still = p.Number(0)
            moves = {name: each for name, each in arguments.items() if each != still}
            arguments = moves if fitting(words.do, set(moves)) else arguments
        action = self.patterned(*_signed(words, arguments))
        if step.save_as:
            self.latest[self.short[step.save_as]] = step.save_as
        if step.save_as in self.told_apart:
            return fill(
                self.words.steps["save"],
                {"action": action, "result": self.named(step.save_as.replace("_", " "))},
            )
        return action

    def times(self, times: p.Value) -> str:
        if isinstance(times, p.Number):
            word = self.words.times.words.get(int(times.value))
            if word and float(times.value).is_integer():
                return word
            return fill(self.words.times.number, {"number": self.value(times)})
        return fill(self.words.times.value, {"value": self.value(times)})

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
            for step in map(_as_call, walk(self.plan.steps))
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
            case p.Length():
                if self.types.of(value.of) == "int":
                    return self.value(value.of)
                entries = "entries" if isinstance(value.of, p.Recall) else "length"
                return fill(say[entries], {"value": self.value(value.of)})
            case p.Share():
                values = {"part": self.value(value.part), "whole": self.value(value.whole)}
                return fill(say["share"], values)
            case p.Figure():
                return fill(say[value.how], {"value": self.value(value.of)})
            case p.Elapsed():
                return fill(say["elapsed"], {"value": self.value(value.since)})
            case p.Weekday():
                return self.words.methods["clock"].fields["weekday"]
            case p.Choice():
                among = value.among
                items = self.series(among.items, "or") if isinstance(among, p.Items) else None
                return fill(say["choice"], {"value": items or self.value(among)})
            case _:
                assert_never(value)

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
            case p.Not(condition=p.Both() | p.Either() as inner):
                told = self.condition(inner)
                return fill(say["not"], {"condition": told}) if holds else told
            case p.Not():
                return self.condition(condition.condition, not holds)
            case p.Both() | p.Either():
                if not condition.conditions:
                    return say["always" if isinstance(condition, p.Both) else "never"]
                word = say["and" if isinstance(condition, p.Both) else "or"]
                if len(condition.conditions) == 1:
                    return self.condition(condition.conditions[0], holds)
                joined = word.join(self.operand(each) for each in condition.conditions)
                return joined if holds else fill(say["not"], {"condition": joined})
            case _:
                assert_never(condition)

    def operand(self, condition: p.Condition) -> str:
        told = self.condition(condition)
        if isinstance(condition, p.Both | p.Either) and len(condition.conditions) > 1:
            return fill(self.words.conditions["group"], {"condition": told})
        return told

    def holds(self, value: p.Value, holds: bool) -> str:
        say = self.words.conditions
        match value:
            case p.Truth():
                return say["always" if value.value is holds else "never"]
            case p.Ask(method=method, field=None):
                words = self.words.methods[method]
                patterns = words.holds if holds else words.fails
                if patterns:
                    return self.patterned(patterns, value.arguments)
            case p.Recall(name=name) if isinstance(call := self.makers.get(name), p.Call):
                words = self.words.methods[call.method]
                patterns = words.held if holds else words.missed
                if patterns and name not in self.told_apart:
                    return self.patterned(patterns, call.arguments)
            case _:
                pass
        return fill(say["holds" if holds else "fails"], {"value": self.value(value)})

    def comparison(self, compare: p.Compare, holds: bool) -> str:
        say = self.words.conditions
        operator = compare.operator
        if not holds and operator != "in":
            operator, holds = OPPOSITES[operator], True
        match compare:
            case p.Compare(operator="==" | "!=", left=p.Recall() as name, right=p.Text(value="")):
                return fill(
                    say["unset" if operator == "==" else "set"], {"value": self.value(name)}
                )
            case p.Compare(left=p.Ask(method=method, field=str(part)), right=p.Text(value=text)):
                patterns = self.words.methods[method].compared.get(part, {})
                if operator in patterns:
                    return fill(patterns[operator], {"right": text})
            case p.Compare(left=p.Length(of=p.Recall() as names), right=p.Number(value=0)):
                known = {"==": "empty", "!=": "not empty", ">": "not empty"}
                if operator in known and self.types.of(names) != "int":
                    values = {"value": self.value(names)}
                    return fill(self.words.conditions[known[operator]], values)
        values = {"left": self.value(compare.left), "right": self.value(compare.right)}
        if operator == "in":
            is_list = self.types.of(compare.right).startswith("list[")
            operator = "among" if is_list else "in"
            if isinstance(compare.right, p.Items):
                values["right"] = self.series(compare.right.items, "or")
        if not holds:
            operator = OPPOSITES[operator]
        return fill(self.words.conditions[operator], values)


def _as_call(step: p.Step) -> p.Step:
    """Remembering what a robot method gives, as the call that it is."""
    match step:
        case p.Remember(name=name, value=p.Ask(field=None) as ask):
            return p.Call(ask.method, ask.arguments, name)
        case _:
            return step


def _signed(
    words: Words, arguments: dict[str, p.Value]
) -> tuple[tuple[str, ...], dict[str, p.Value]]:
    """The patterns for what is done, and the arguments: turning by -90 is turning right by 90."""
    for name in gaps(words.negative[0]) if words.negative else ():
        number = arguments.get(name)
        if isinstance(number, p.Number) and number.value < 0:
            return words.negative, {**arguments, name: p.Number(-number.value)}
    return words.do, arguments
