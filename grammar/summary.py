"""What a plan comes to, in a breath: what a colleague repeats before setting off.

    "In every office I will say “Good morning” and, if I see a person, ask “Do you want coffee?”"

The line-by-line reading (`grammar.explain`) says everything that a program does; this leaves out
what the robot notes for itself, and folds what belongs together: going somewhere in each round of a
loop, coming back and reporting, searching a thing and taking it. Nothing that moves, speaks, asks,
gives or calls is left out: each such call that is put into words is ticked off, and where one is
not, or where it would not be shorter, the full reading is given instead.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Final

from grammar import plan as p
from grammar.explain import explain
from grammar.inference import truth
from grammar.language import load_language, speech
from grammar.pauses import may_end
from grammar.program_parser import CodeStep, Function
from grammar.speech import fill, forms
from grammar.summary_sentences import Clause, Deed, Item, sentences
from grammar.telling.steps import Teller
from grammar.telling.values import as_call
from grammar.traversal import nodes
from robot_api.methods import METHODS

LOOKS: Final = frozenset(
    method.name
    for method in METHODS.values()
    if not method.moves and method.returns.annotation != "None" and method.capability == "vision"
) - {"wait_for"}
"""They only look at what is there."""
QUIET: Final = LOOKS | {"location", "places", "clock", "battery", "log", "wait"}
"""What may go without saying."""
NAMED: Final = ("person", "place", "thing")
"""Parameters that take a name."""
ENDLESS: Final = frozenset({"while", "repeat until", "again", "forever"})
"""Loops that go on for as long as it takes."""
LONGEST: Final = 5
"""Sentences; what needs more is not said in a breath."""


def summary(plan: p.Plan, language: str = "en", called: Callable[[str], str] | None = None) -> str:
    """The plan in a few sentences; its full reading where it cannot be told in fewer words.
    `called` as for `grammar.explain.explain`."""
    full = explain(plan, language, called)
    words = speech(language)
    teller = _Brief(words, plan, called or str)
    try:
        items = list(teller.items(plan.steps))
    except _TooMuch:
        return full
    if not items or teller.untold():
        return full
    told_in = list(sentences(items, words))
    told = words.joined_up(" ".join(told_in))
    if plan.background:
        said = "; ".join(plan.background)
        told = f"{told} {load_language(language).phrase('background', said=said)}"
    return told if len(told) < len(full) and len(told_in) <= LONGEST else full


class _TooMuch(Exception):
    """It cannot be said in a breath."""


@dataclass
class _Brief(Teller):
    """Puts the steps of a plan into items."""

    left: bool = field(init=False, default=False)
    """Whether the robot has gone from where it was sent."""
    back: bool = field(init=False, default=False)
    """Whether it has come back."""
    _starts: set[str] = field(init=False, default_factory=set)
    _told: set[int] = field(init=False, default_factory=set)
    _met: dict[str, bool] = field(init=False, default_factory=dict)
    """The variables that stand for somebody, each with whether they were spoken of already."""
    _found: p.Value | None = field(init=False, default=None)
    """Whom or what it has just looked for."""

    def untold(self) -> list[str]:
        """The methods that are called and may not be left out, and were."""
        return [
            call.method
            for call in p.calls(self.plan)
            if call.method not in QUIET and id(call) not in self._told
        ]

    # --- steps

    def items(self, steps: Sequence[p.Step]) -> Iterator[Item]:
        at = 0
        while at < len(steps):
            step, later = steps[at], steps[at + 1 :]
            folded = self._fetched(step, later)
            if folded is not None:
                text, number = folded
                yield Deed(text)
                at += number
                continue
            yield from self._item(step)
            at += 1

    def _fetched(self, step: p.Step, later: Sequence[p.Step]) -> tuple[str, int] | None:
        """Looking for a thing somewhere and taking it, or for somebody and giving it to them, or
        both; with how many steps that are."""
        found = [self._looked_and_did(step, later[:1]), None]
        if found[0] is not None and len(later) > 2:
            found[1] = self._looked_and_did(later[1], later[2:3])
        match found:
            case [("fetch" | "fetch anywhere" as how, values, did), ("bring", more, then)] if (
                values["thing"] == more["thing"]
            ):
                pattern, values, done = f"{how} and bring", {**values, **more}, (*did, *then)
            case [(pattern, values, done), _]:
                pass
            case _:
                return None
        self._tick(*done)
        self.left, self.back, self._found = True, False, None
        return self.filled(self.words.brief[pattern], values), len(done)

    @staticmethod
    def _looked_and_did(
        step: p.Step, later: Sequence[p.Step]
    ) -> tuple[str, dict[str, p.Value], tuple[p.Call, p.Call]] | None:
        """What is said of a search and what is done with what it finds, with its values."""
        match (step, *later):
            case (
                p.Call(method="find", arguments={"thing": one, "place": place}) as first,
                p.Call(method="grab", arguments={"thing": other}) as then,
            ) if one == other:
                return "fetch", {"thing": one, "place": place}, (first, then)
            case (
                p.Call(method="find", arguments={"thing": one}) as first,
                p.Call(method="grab", arguments={"thing": other}) as then,
            ) if one == other:
                return "fetch anywhere", {"thing": one}, (first, then)
            case (
                p.Call(method="find", arguments={"thing": one}) as first,
                p.Call(method="give", arguments={"thing": thing, "person": other}) as then,
            ) if one == other and "place" not in first.arguments:
                return "bring", {"thing": thing, "person": one}, (first, then)
            case _:
                return None

    def _item(self, step: p.Step) -> Iterator[Item]:
        if isinstance(step, p.Remember) and isinstance(step.value, p.Ask):
            self._told.add(id(step.value))  # told as the call that it is
        told = as_call(step)
        match told:
            case Function() | CodeStep():
                raise _TooMuch
            case p.Call():
                self._tick(step)
                yield from self._call(told)
            case p.Remember() | p.Collect() | p.Increase() | p.SetItem():
                yield from self._asked_in(told)
            case p.If():
                yield from self._branches(told)
            case p.ForEach():
                yield from self._each(told)
            case p.Repeat(times=times) if not isinstance(times, p.Number | p.Recall | p.NumberIn):
                raise _TooMuch
            case p.Repeat(times=times, steps=steps):
                known = isinstance(times, p.Number)
                yield from self._loop("repeat", steps, known, times=self.times(times))
            case p.While(steps=(p.Call(method="wait"),) | ()):
                until = self.condition(told.condition, holds=False)
                yield Deed(fill(self.words.steps["wait until"], {"condition": until}))
            case p.While():
                yield from self._loop("while", told.steps, condition=self.condition(told.condition))
            case p.RepeatUntil():
                until = self.condition(told.condition)
                yield from self._loop("repeat until", told.steps, condition=until)
            case p.Forever():
                leaves = any(map(may_end, told.steps))
                yield from self._loop("again" if leaves else "forever", told.steps, leaves)
            case p.Try():
                yield from self.items(told.steps)
                otherwise = tuple(self.items(told.otherwise))
                if otherwise:
                    yield Clause(self.words.clauses["failed"], otherwise)
            case p.End():
                yield Deed(self.words.steps["end"])
            case p.Continue():
                yield Deed(self.words.steps["continue"])

    # --- single calls

    def _call(self, call: p.Call) -> Iterator[Item]:
        brief = self.words.brief
        match call:
            case p.Call(method="location", save_as=str() as name):
                if not self.left:
                    self._starts.add(name)
            case p.Call(method="wait"):
                if call.arguments.get("seconds") != p.Number(1):
                    yield Deed(self.call(call))
            case p.Call(method=method, save_as=str()) if method in QUIET and self._is_used(call):
                pass
            case p.Call(method="goto", arguments={"place": p.Recall(name=name)}) if (
                name in self._starts
            ):
                self.back = True
                yield Deed(brief["back"])
                return
            case p.Call(method="say", arguments={"text": text}) if self._tells(text):
                yield Deed(fill(brief["tell"], {"values": self._values(text)}))
            case p.Call(
                method="say",
                arguments={"text": p.Sentence(parts=(p.Choice(among=p.Items(items=those)),))},
            ):
                yield Deed(fill(brief["say one of"], {"number": str(len(those))}))
            case p.Call(method="find"):
                arguments = dict(call.arguments)
                pattern = brief["search there" if "place" in arguments else "search"]
                yield Deed(self.filled(pattern, arguments))
            case p.Call(method="ask"):
                wanted = {"question": call.arguments["question"]}
                if "person" in call.arguments and call.arguments["person"] != self._found:
                    wanted["person"] = call.arguments["person"]
                yield Deed(self.call(replace_arguments(call, wanted)))
            case _:
                yield Deed(self.call(replace_arguments(call, call.arguments)))
        self._found = call.arguments.get("thing") if call.method == "find" else None
        if METHODS[call.method].moves:
            self.left, self.back = True, False

    @property
    def _is_home(self) -> bool:
        """Whether what is said now is said to whoever asked."""
        return self.back or not self.left

    def _is_used(self, call: p.Call) -> bool:
        return any(
            isinstance(node, p.Recall) and node.name == call.save_as
            for node in nodes(self.plan.steps)
        )

    def _tells(self, text: p.Value) -> bool:
        """Whether it is a report to whoever asked, with something in it that was found out."""
        match text:
            case p.Sentence():
                return self._is_home and not any(isinstance(node, p.Choice) for node in nodes(text))
            case p.Recall(name=name):
                return self._is_home and isinstance(self.makers.get(name), p.Call)
            case _:
                return False

    def _values(self, text: p.Value) -> str:
        """What a report tells: the one thing that is put into its words, or else "the result"."""
        parts = text.parts if isinstance(text, p.Sentence) else (text,)
        values = [part for part in parts if not isinstance(part, p.Text)]
        self._tick(*nodes(text))
        match values:
            case [p.Ask() as value]:
                return self.value(value)
            case [p.Recall(name=name)] if isinstance(maker := self.makers.get(name), p.Call):
                if maker.method not in ("location", "find"):
                    return self.recall(name)
        return self.words.brief["result"]

    def _asked_in(self, step: p.Step) -> Iterator[Item]:
        """What the robot does to know a value that it notes."""
        for node in nodes(step):
            if isinstance(node, p.Ask) and node.method not in QUIET - LOOKS:
                self._told.add(id(node))
                yield from self._call(p.Call(node.method, node.arguments))

    # --- branches

    def _branches(self, step: p.If) -> Iterator[Item]:
        report = self._report(step)
        if report is not None:
            yield from report
            return
        if (searches := _searches(step.condition)) is not None:
            yield from self._searched(searches, step)
            return
        if isinstance(step.condition, p.Not):
            searches = _searches(step.condition.condition)
            if searches is not None:
                turned = p.If(step.condition, step.otherwise, step.then)
                yield from self._searched(searches, turned)
                return
        self._tick(*nodes(step.condition))
        before = (self.left, self.back)
        then = tuple(self.items(step.then))
        after, (self.left, self.back) = (self.left, self.back), before
        otherwise = tuple(self.items(step.otherwise))
        self.left, self.back = after[0] or self.left, after[1] and self.back
        if then:
            yield Clause(self.condition_clause(step.condition), then)
        elif otherwise:
            yield Clause(self.condition_clause(step.condition, holds=False), otherwise)
            return
        else:
            yield from self._asked_in(p.Remember("", step.condition))
            return
        match otherwise:
            case (Clause(adverb=False) as inner, *rest):  # "otherwise, if ..."
                outer = {"outer": self.words.clauses["otherwise"], "inner": inner.text}
                yield replace(inner, text=fill(self.words.joining["clauses"], outer))
                yield from rest
            case (_, *_):
                yield Clause(self.words.clauses["otherwise"], otherwise, adverb=True)

    def condition_clause(self, condition: p.Condition, holds: bool = True) -> str:
        return fill(self.words.clauses["if"], {"condition": self.condition(condition, holds)})

    def _searched(self, searches: Sequence[p.Ask], step: p.If) -> Iterator[Item]:
        """Looking for something at one or several places, and what is done when it is found; "...,
        come back and tell you" where that is what is done either way."""
        self._told.update(map(id, searches))
        find = searches[0]
        if len(searches) == 1:
            yield from self._call(p.Call("find", find.arguments))
        else:
            yield self._search_among(searches)
            find = p.Ask("find", {"thing": find.arguments["thing"]})
        then, otherwise = self._reported(step.then), self._reported(step.otherwise)
        if then and otherwise and then[0] and otherwise[0]:
            self._tick(*nodes(step.then), *nodes(step.otherwise))
            yield Deed(self.words.brief["back"])
            self.back = True
            yield Deed(fill(self.words.brief["tell"], {"values": self.words.brief["result"]}))
            return
        yield from self.items(step.then)
        missed = p.Holds(find)
        if otherwise:
            self._tick(*nodes(step.otherwise))
            so: list[Item] = [Deed(self.words.brief["back"])] if otherwise[0] else []
            failed: tuple[Item, ...] = (*so, Deed(self.words.brief["so"]))
        else:
            failed = tuple(self.items(step.otherwise))
        if failed:
            yield Clause(self.condition_clause(missed, holds=False), failed)

    def _search_among(self, searches: Sequence[p.Ask]) -> Deed:
        """ "look for a book at Alice's office, at Bob's office and at Clara's office"."""
        brief, thing = self.words.brief, searches[0].arguments["thing"]
        places = ({"place": each.arguments["place"]} for each in searches)
        there = self.listed([self.filled(brief["there"], each) for each in places], "and")
        self.left, self.back, self._found = True, False, thing
        pattern = brief["search among"]
        told = self.argument("thing", thing, forms(pattern)["thing"])
        return Deed(fill(pattern, {"thing": told, "places": there}))

    def _report(self, step: p.If) -> list[Item] | None:
        """Both branches of it only tell whoever asked: "tell you whether ..."; not where the robot
        leaves them to know it."""
        if any(isinstance(node, p.Ask) and node.method == "find" for node in nodes(step.condition)):
            return None
        then, otherwise = self._reported(step.then), self._reported(step.otherwise)
        if not (then and otherwise) or then[0] or otherwise[0]:
            return None
        if not (self.back or (self._is_home and (then[1] or otherwise[1]))):
            return None
        brief = self.words.brief
        self._tick(*nodes(step))
        for inserted in (then[1], otherwise[1]):
            if inserted:
                return [Deed(fill(brief["tell"], {"values": self._values(inserted[0])}))]
        if not _is_plain(step.condition, self):
            return [Deed(fill(brief["tell"], {"values": brief["result"]}))]
        condition = self.condition(step.condition)
        return [Deed(fill(brief["whether"], {"condition": condition}))]

    def _reported(self, steps: Sequence[p.Step]) -> tuple[bool, list[p.Sentence]] | None:
        """Whether the robot comes back before it tells something, and what it tells of what it has
        found out; None where the steps do anything else."""
        comes, said = False, False
        told: list[p.Sentence] = []
        for step in map(as_call, steps):
            match step:
                case p.Call(method="location") | p.Remember() | p.Collect() | p.Increase():
                    if any(isinstance(node, p.Ask) for node in nodes(step)):
                        return None
                case p.Call(method="goto", arguments={"place": p.Recall(name=name)}) if (
                    name in self._starts and not said
                ):
                    comes = True
                case p.Call(method="say", arguments={"text": p.Text()}):
                    said = True
                case p.Call(method="say", arguments={"text": p.Sentence() as text}):
                    said = True
                    told.append(text)
                case _:
                    return None
        return (comes, told) if said else None

    # --- loops

    def _loop(
        self, kind: str, steps: Sequence[p.Step], adverb: bool = False, **values: str
    ) -> Iterator[Item]:
        items = tuple(self.items(steps))
        if items:
            yield Clause(fill(self.words.clauses[kind], values), items, adverb)
        elif kind in ENDLESS:  # what it waits for would go untold
            raise _TooMuch

    def _each(self, step: p.ForEach) -> Iterator[Item]:
        if any(isinstance(node, p.Ask) and node.method not in QUIET for node in nodes(step.items)):
            raise _TooMuch
        match step:
            case p.ForEach(
                items=p.Ask(method="places") as places,
                steps=(
                    p.Call(method="goto", arguments={"place": p.Recall(name=name)}) as go,
                    *rest,
                ),
            ) if name == step.variable:
                self._tick(go)
                self.left, self.back = True, False
                kind = places.arguments.get("kind", p.Text(""))
                if not isinstance(kind, p.Text):
                    raise _TooMuch
                items = tuple(self.items(rest))
                form = "each place" if kind.value else "each place at all"
                if not items:
                    form = f"go to {form}"
                noun = self.words.nouns.the(self.called(kind.value))
                text = fill(self.words.brief[form], {"kind": noun, "noun": self.called(kind.value)})
                yield Clause(text, items, adverb=True) if items else Deed(text)
            case p.ForEach(items=p.Ask(method="people") | p.Recall()) if self._is_somebody(step):
                self._met[step.variable] = False
                items = tuple(self.items(step.steps))
                if any(isinstance(item, Clause) for item in items) or not self._met[step.variable]:
                    yield Clause(self.words.brief["for everybody"], items, adverb=True)
                else:
                    yield from items
            case p.ForEach(items=p.Range(stop=stop, start=p.Number(value=0))):
                known = isinstance(stop, p.Number)
                yield from self._loop("repeat", step.steps, known, times=self.times(stop))
            case p.ForEach(items=p.Items(items=named)) if self._is_named(step):
                names = [self.called(item.value) for item in named if isinstance(item, p.Text)]
                them = self.listed([self.words.nouns.the(name) for name in names], "and")
                yield from self._loop("for each", step.steps, True, items=them)
            case _:
                yield from self._loop("for each", step.steps, True, items=self.each_of(step))

    def _is_named(self, step: p.ForEach) -> bool:
        """Whether a loop goes over names of people, places or things, for the robot to go to."""
        assert isinstance(step.items, p.Items)
        used = p.Recall(step.variable)
        return all(isinstance(item, p.Text) for item in step.items.items) and any(
            isinstance(node, p.Call | p.Ask) and used in map(node.arguments.get, NAMED)
            for node in nodes(step.steps)
        )

    def _is_somebody(self, step: p.ForEach) -> bool:
        if isinstance(step.items, p.Recall):
            maker = self.makers.get(step.items.name)
            return isinstance(maker, p.Call) and maker.method == "people"
        return True

    # --- words

    def recall(self, name: str) -> str:
        if name in self._met:
            known, self._met[name] = self._met[name], True
            return self.words.brief["them" if known else "everybody"]
        return super().recall(name)

    def value(self, value: p.Value) -> str:
        match value:
            case p.Text(value=text) if text.endswith(".") and not text.endswith(".."):
                return super().value(p.Text(text[:-1]))
            case p.Sentence(parts=(*first, p.Text(value="."))) if first:
                return super().value(p.Sentence(tuple(first)))
        return super().value(value)

    def asked(self, ask: p.Ask) -> str:
        self._told.add(id(ask))
        return super().asked(ask)

    def _tick(self, *told: object) -> None:
        self._told.update(map(id, told))


def replace_arguments(call: p.Call, arguments: dict[str, p.Value]) -> p.Call:
    """The call with other arguments, its result not remembered."""
    return p.Call(call.method, arguments)


def _is_plain(condition: p.Condition, teller: Teller) -> bool:
    """Whether a condition is one that is said in words of its own: "I saw somebody"."""
    match condition:
        case p.Holds(value=value):
            return not isinstance(truth(value, teller.types.of(value)), p.Compare)
        case p.Not(condition=inner):
            return _is_plain(inner, teller)
        case _:
            return False


def _searches(condition: p.Condition) -> tuple[p.Ask, ...] | None:
    """The searches that a condition consists of: one, or several for the same thing at one place
    after the other."""
    match condition:
        case p.Holds(value=p.Ask(method="find") as find):
            return (find,)
        case p.Either(conditions=each):
            found = [_searches(one) for one in each]
        case _:
            return None
    searches = [one[0] for one in found if one is not None and len(one) == 1]
    things = [one.arguments["thing"] for one in searches]
    somewhere = all(isinstance(one.arguments.get("place"), p.Text) for one in searches)
    same = len(searches) == len(found) and all(thing == things[0] for thing in things)
    return tuple(searches) if somewhere and same else None
