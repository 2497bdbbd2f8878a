"""Steps of a plan in words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from typing import Final, assert_never

from grammar import plan as p
from grammar.identifiers import speaks_of
from grammar.kinds import is_list, is_record
from grammar.pauses import may_end
from grammar.program_parser import CodeStep, Function
from grammar.roles import SORTS, role
from grammar.speech import fill, fitting, gaps
from grammar.telling.layout import Told
from grammar.telling.values import ValueTeller, as_call, signed, sort_of
from grammar.traversal import nodes, walk
from grammar.which_time import asks_only_which_time
from robot_api.methods import METHODS

_PEOPLE_TOO: Final = frozenset({"find", "sees", "count"})
"""What takes a thing or a person."""


@dataclass
class Teller(ValueTeller):
    """Tells the steps of one plan, each result by a name of its own."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self._name_results()

    def _name_results(self) -> None:
        """Give everything remembered words of its own: the shortest that nothing else has."""
        choices: dict[str, list[str]] = {}
        for name, step in self._made(self.plan.steps):
            self.makers[name] = step if name not in self.makers else None
            wishes = list(self._called(name, step))
            known = choices.setdefault(name, wishes)
            if known != wishes:  # made in several ways: only what they have in common
                choices[name] = [wish for wish in known if wish in wishes] or [
                    self.named(name.replace("_", " "))
                ]
        wished = Counter(wish for wishes in choices.values() for wish in {*wishes})
        for name, wishes in choices.items():
            self.short[name] = wishes[0]
            no_rivals = [choices[each] for each in self._apart_from(name) - {name}]
            allowed = [1 + sum(wish in other for other in no_rivals) for wish in wishes]
            free = [
                wish for wish, most in zip(wishes, allowed, strict=True) if wished[wish] == most
            ]
            if free:
                self.results[name] = free[0]
            else:
                self.told_apart.add(name)
                values = {"value": wishes[0], "name": name.replace("_", " ")}
                self.results[name] = fill(self.words.values["told apart"], values)

    def _made(self, steps: Iterable[p.Step]) -> Iterator[tuple[str, p.Step]]:
        """The names that steps give something, each with the step that does."""
        for step in walk(steps):
            match step:
                case p.Call(save_as=str() as name) | p.Remember(name=name):
                    yield name, as_call(step)
                case p.ForEach(variable=name, value=value):
                    yield name, step
                    if value is not None:
                        yield value, step
                case p.Try(problem=str() as name):
                    yield name, step

    def _apart_from(self, name: str) -> set[str]:
        """Of what a loop goes over, the items of other loops: two loops one after the other may
        both speak of "this place", one within the other may not."""
        loop = self.makers.get(name)
        if not isinstance(loop, p.ForEach):
            return set()
        loops = [each for each in walk(self.plan.steps) if isinstance(each, p.ForEach)]
        within = [each for each in loops if any(inner is loop for inner in walk(each.steps))]
        near = (each for each in (*within, *walk(loop.steps)) if isinstance(each, p.ForEach))
        return _loop_names(loops) - _loop_names(near)

    def forget(self, steps: Iterable[p.Step]) -> None:
        """After or before steps that may run or not: what they make is no longer just the latest,
        unless it would be the same anyway."""
        for step in map(as_call, walk(steps)):
            if isinstance(step, p.Call) and step.save_as:
                short = self.short[step.save_as]
                if self.latest.get(short) != step.save_as:
                    self.latest.pop(short, None)

    def _called(self, name: str, step: p.Step) -> Iterator[str]:
        readable = name.replace("_", " ")
        match step:
            case _ if (sort := sort_of(name)) in self.words.findings and sort in self.words.names:
                yield self.words.names[sort]  # however it is found out
            case p.Call():
                words = self.words.methods[step.method]
                if words.first and step == as_call(self.plan.steps[0]):
                    yield words.first
                    return
                given = step.arguments.keys()
                patterns = [each for each in words.result if gaps(each) <= given]
                yield from (self.filled(each, step.arguments) for each in patterns)
                if not patterns:
                    yield self.named(readable)
            case p.Try():
                yield self.words.values["problem"]
            case p.ForEach(value=value) if value == name:
                yield self.words.values["item value"]
            case p.ForEach(items=p.Range()):
                yield self.words.values["item number"]
            case p.ForEach():
                sort = readable.rstrip("0123456789").strip()
                kinds = (sort, *(("word",) if len(sort) > 2 else ()), *_taken_for(step))
                forms = (self.words.values.get(f"item {kind}") for kind in kinds)
                item = next(filter(None, forms), self.words.values["item"])
                yield fill(item, {"name": sort})
            case _:
                kept = self.kept(name, step)
                known = self.words.names.get(sort_of(name))
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

    # --- steps

    def told(self, steps: Iterable[p.Step]) -> Iterator[Told]:
        for step in steps:
            for told in self.step(step):
                yield told if told.step else replace(told, step=step)

    def step(self, step: p.Step) -> Iterator[Told]:
        say = self.words.steps
        match step := as_call(step):
            case p.Call():
                yield Told(self.call(step))
            case p.Remember() if (kept := self.started(step)) is not None:
                pattern = say["count" if isinstance(step.value, p.Number) else "list"]
                yield Told(fill(pattern, {"what": kept}))
            case p.Remember(value=p.Items(items=())):
                yield Told(fill(say["empty"], {"name": self.recall(step.name)}))
            case p.Remember(value=p.Record(entries=())):
                yield Told(fill(say["empty record"], {"name": self.recall(step.name)}))
            case p.Remember() if self.is_bookkeeping(step):
                pass
            case p.Remember(value=p.Truth(value=True)) if so := self.finding(step.name):
                yield Told(fill(say["note"], {"finding": so}))
            case p.Remember(value=p.Text(value="")):
                yield Told(fill(say["unset"], {"name": self.recall(step.name)}))
            case p.Remember(value=p.Compare() | p.Not() | p.Both() | p.Either() as so):
                values = {"condition": self.condition(so), "name": self.recall(step.name)}
                yield Told(fill(say["whether"], values))
            case p.Remember():
                pattern = say["start" if isinstance(step.value, p.Number) else "remember"]
                values = {"value": self.value(step.value), "name": self.recall(step.name)}
                yield Told(fill(pattern, values))
            case p.Collect():
                values = {"value": self.value(step.value), "name": self.recall(step.name)}
                yield Told(fill(say["collect"], values))
            case p.Increase():
                yield Told(self.increase(step))
            case p.SetItem():
                values = {"key": self.value(step.key), "value": self.value(step.value)}
                yield Told(fill(say["set item"], {**values, "name": self.recall(step.name)}))
            case CodeStep(source=source):
                yield Told(fill(say["code"], {"code": self.quoted_code(source)}))
            case p.End():
                yield Told(say["end"])
            case p.Continue():
                yield Told(say["continue"])
            case p.If():
                yield from self.branches(step)
            case p.Repeat():
                yield self.loop("repeat", step.steps, times=self.times(step.times))
            case p.ForEach(items=p.Range(stop=stop, start=p.Number(value=0))) if not speaks_of(
                step.steps, step.variable
            ):
                yield self.loop("repeat", step.steps, times=self.times(stop))
            case p.ForEach(variable=number, items=p.Range(stop=stop)) if asks_only_which_time(step):
                self.counting[number] = stop
                yield self.loop("repeat", step.steps, times=self.times(stop))
                del self.counting[number]
            case p.ForEach() if is_record(self.types.of(step.items)):
                yield self.loop("for each entry", step.steps, items=self.value(step.items))
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

    def increase(self, step: p.Increase) -> str:
        """What is added to a number, a list or an entry of a record."""
        say = self.words.steps
        name = self.recall(step.name)
        if step.key is not None:
            name = self.value(p.Item(p.Recall(step.name), step.key))
        match step.by:
            case None:
                return fill(say["increase"], {"name": name})
            case p.Number(value=number) if number < 0:
                return fill(say["decrease"], {"value": self.value(p.Number(-number)), "name": name})
            case p.Arithmetic(left=p.Number(value=0), operator="-", right=less):
                return fill(say["decrease"], {"value": self.value(less), "name": name})
            case by:
                several = is_list(self.types.of(by)) and not isinstance(by, p.Items)
                pattern = say["extend" if several else "collect"]
                return fill(pattern, {"value": self.value(by), "name": name})

    def is_bookkeeping(self, step: p.Remember) -> bool:
        """Whether it only says that nothing is known yet, or which number is to be passed next."""
        nothing_yet = step.value in (p.Text(""), p.Truth(False))
        return self.record(step.name) is not None or (
            nothing_yet and self.finding(step.name) is not None
        )

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
                    clause = self.clause("otherwise", others, continues=True)
                    yield replace(clause, step=step)
                    break
        self.latest = before
        self.forget((whole,))

    def each_of(self, step: p.ForEach) -> str:
        """What a loop goes over; places and people by the names that speakers have for them, and
        numbers that are counted as that."""
        items = step.items.items if isinstance(step.items, p.Items) else ()
        counted = [item.value for item in items if isinstance(item, p.Number)]
        if len(counted) == len(items) > 3:
            first, last = counted[0], counted[-1]
            if counted == [first + step for step in range(len(counted))]:
                return self.value(p.Range(p.Number(last + 1), p.Number(first)))
        names = [item.value for item in items if isinstance(item, p.Text)]
        if len(names) < len(items) or all(self.called(name) == name for name in names):
            return self.value(step.items)
        return self.listed([self.words.nouns.the(self.called(name)) for name in names], "and")

    def loop(self, kind: str, steps: tuple[p.Step, ...], **values: str) -> Told:
        self.forget(steps)
        told = self.clause(kind, steps, False, **values)
        if not steps and kind not in ("repeat", "for each", "for each entry"):
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
        action = self.patterned(*signed(words, arguments))
        if step.save_as:
            self.latest[self.short[step.save_as]] = step.save_as
        if step.save_as in self.told_apart:
            return fill(
                self.words.steps["save"],
                {"action": action, "result": self.named(step.save_as.replace("_", " "))},
            )
        return action

    def times(self, times: p.Value) -> str:
        if isinstance(times, p.NumberIn):
            times = times.of
        if isinstance(times, p.Number):
            word = self.words.times.words.get(int(times.value))
            if word and float(times.value).is_integer():
                return word
            return fill(self.words.times.number, {"number": self.value(times)})
        return fill(self.words.times.value, {"value": self.value(times)})


def _taken_for(loop: p.ForEach) -> Iterator[str]:
    """What the item of a loop is, by what lists it, then by what robot methods take it for: a
    place, a person, a thing."""
    if isinstance(loop.items, p.Ask):
        yield SORTS.get(loop.items.method, "")
    item = p.Recall(loop.variable)
    for node in nodes(loop.steps):
        if isinstance(node, p.Call | p.Ask) and node.method not in _PEOPLE_TOO:
            method = METHODS[node.method]
            for parameter in chain.from_iterable(method.forms):
                if node.arguments.get(parameter.name) == item:
                    yield SORTS.get(role(method, parameter), "")


def _loop_names(loops: Iterable[p.ForEach]) -> set[str]:
    """What the items of loops go by in them."""
    return {name for each in loops for name in (each.variable, each.value) if name is not None}
