"""All rules of a language, compiled into a network of states for `grammar.chart` to walk.

Each rule becomes a deterministic automaton over words and references to other rules or slots: the
templates of a rule share their common beginnings, so hundreds of templates cost no more to look
through than the words that really stand there. References between rules may be recursive, but not
at the left edge (`compile_rules` says which rule breaks that).
"""

from __future__ import annotations

import functools
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final, TypeVar

import msgspec

from grammar.templates import Choice, Part, Template, Word, parse_template
from grammar.templates import Sequence as TemplateSequence

INLINED: Final = 20
"""Words and references that a rule that stands for some words may have to be put in place wherever
it is named; a longer one is kept once and called."""


_Key = TypeVar("_Key")


class RuleError(ValueError):
    """The rules of a language contradict themselves; the message names the rule."""


@dataclass(frozen=True)
class Production:
    """One entry of a rule: templates that mean the same."""

    rule: str
    means: str | None
    """The meaning's name (`grammar.meanings`, or a robot method); None passes its parts on to
    the rule that refers to it."""
    source: tuple[str, ...]
    """The templates as they are written."""
    cost: float = 0.0
    fixed: Mapping[str, Any] = field(default_factory=dict)
    """Values that the meaning gets besides those of the slots."""

    @functools.cached_property
    def templates(self) -> tuple[Template, ...]:
        return tuple(map(parse_template, self.source))


class State(msgspec.Struct, frozen=True, gc=False):
    """There are thousands, none in a circle: nothing for the garbage collector to look through."""

    words: dict[str, int]
    calls: tuple[tuple[int, str | None, int], ...]
    """(callee, binding, next state)"""
    final: tuple[float, int] | None
    """(cost, production) if a rule may end here."""


@dataclass(frozen=True)
class Network:
    states: tuple[State, ...]
    names: tuple[str, ...]
    """Of the callees: rules, then slots in braces."""
    starts: tuple[int, ...]
    """The first state of each rule; -1 for a slot."""
    beginning: Mapping[str, frozenset[int]]
    """The rules that can begin with a word."""
    beginning_with_slot: Mapping[int, frozenset[int]]
    """The rules that can begin with a slot, and the slot itself."""
    productions: tuple[Production, ...]

    def rule(self, name: str) -> int:
        return self.names.index(name)

    @functools.cached_property
    def slot_numbers(self) -> Mapping[str, int]:
        """Of the slots, by their names in braces."""
        return {self.names[slot]: slot for slot in self.beginning_with_slot}


def compile_rules(
    rules: Mapping[str, Sequence[Production]], words_of: Callable[[str], tuple[str, ...]]
) -> Network:
    """Compile the rules; `words_of` gives the normal forms of a template's word. Raises
    `RuleError`."""
    return _Compiler(rules, words_of).compile()


class _Compiler:
    def __init__(
        self,
        rules: Mapping[str, Sequence[Production]],
        words_of: Callable[[str], tuple[str, ...]],
    ) -> None:
        self.rules = rules
        self.words_of = words_of
        self.numbers: dict[str, int] = {name: number for number, name in enumerate(rules)}
        self.productions: list[Production] = []
        self.states: list[State] = []
        self.inlined: dict[str, Template | None] = {}
        # the automaton of one rule before it is made deterministic
        self.edges: list[list[tuple[Any, int]]] = []
        self.empty: list[list[int]] = []

    def compile(self) -> Network:
        starts = [self._rule(name, productions) for name, productions in self.rules.items()]
        starts += [-1] * (len(self.numbers) - len(starts))
        self._refuse_left_recursion(starts)
        return Network(
            tuple(self.states),
            tuple(self.numbers),
            tuple(starts),
            *self._beginnings(starts),
            tuple(self.productions),
        )

    # --- one rule

    def _rule(self, name: str, productions: Sequence[Production]) -> int:
        self.edges, self.empty = [[]], [[]]
        finals: dict[int, tuple[float, int]] = {}
        for production in productions:
            number = len(self.productions)
            self.productions.append(production)
            end = self._node()
            for template in production.templates:
                self._add(template, 0, name, end)
            finals[end] = (production.cost, number)
        return self._deterministic(finals, name)

    def _node(self) -> int:
        self.edges.append([])
        self.empty.append([])
        return len(self.edges) - 1

    def _add(self, template: Template, at: int, rule: str, to: int | None = None) -> int:
        """Add what a template reads, from the node `at`; returns the node behind it, which is `to`
        if one is given: alternatives end in the same node, so that long lists of words stay small.
        """
        match template:
            case Word(text):
                words = self.words_of(text)
                for word in words[:-1]:
                    at = self._edge(at, word, None)
                return self._edge(at, words[-1], to) if words else self._skip(at, to)
            case TemplateSequence(parts):
                for part in parts[:-1]:
                    at = self._add(part, at, rule)
                return self._add(parts[-1], at, rule, to) if parts else self._skip(at, to)
            case Choice(alternatives):
                end = self._node() if to is None else to
                for alternative in alternatives:
                    self._add(alternative, at, rule, end)
                return end
            case Part(name, binding, True) if binding is None and self._inline(name, rule):
                inlined = self.inlined[name]
                assert inlined is not None
                return self._add(inlined, at, rule, to)
            case Part(name, binding, is_rule):
                return self._edge(at, self._callee(name, binding, is_rule, rule), to)

    def _edge(self, at: int, symbol: Any, to: int | None) -> int:
        following = self._node() if to is None else to
        self.edges[at].append((symbol, following))
        return following

    def _skip(self, at: int, to: int | None) -> int:
        """Nothing to read on the way to a node."""
        if to is None:
            return at
        self.empty[at].append(to)
        return to

    def _callee(
        self, name: str, binding: str | None, is_rule: bool, rule: str
    ) -> tuple[int, str | None]:
        if is_rule:
            if name not in self.rules:
                raise RuleError(f"the rule <{rule}> refers to <{name}>, which does not exist")
            meaningful = any(production.means for production in self.rules[name])
            return self.numbers[name], binding or (name if meaningful else None)
        slot = "{" + name + "}"
        return self.numbers.setdefault(slot, len(self.numbers)), binding or name

    def _inline(self, name: str, rule: str) -> bool:
        """Whether the rule only stands for some words, so that it can be put in place."""
        if name not in self.rules:
            raise RuleError(f"the rule <{rule}> refers to <{name}>, which does not exist")
        if name not in self.inlined:
            productions = self.rules[name]
            simple = (
                all(not each.means and not each.cost and not each.fixed for each in productions)
                and sum(_size(each) for one in productions for each in one.templates) <= INLINED
                and not self._reaches(name, name, set())
            )
            self.inlined[name] = (
                Choice(tuple(t for each in productions for t in each.templates)) if simple else None
            )
        return self.inlined[name] is not None

    def _reaches(self, name: str, goal: str, seen: set[str]) -> bool:
        if name in seen:
            return False
        seen.add(name)
        for production in self.rules.get(name, ()):
            for template in production.templates:
                for part in parts_of(template):
                    if part.is_rule and (part.name == goal or self._reaches(part.name, goal, seen)):
                        return True
        return False

    def _deterministic(self, finals: dict[int, tuple[float, int]], name: str) -> int:
        alone: dict[int, frozenset[int]] = {}  # most are asked for one node, again and again

        def closure(nodes: set[int]) -> frozenset[int]:
            if len(nodes) > 1:
                return frozenset().union(*(closure({node}) for node in nodes))
            (only,) = nodes
            if only not in alone:
                todo, found = [only], {only}
                while todo:
                    for node in self.empty[todo.pop()]:
                        if node not in found:
                            found.add(node)
                            todo.append(node)
                alone[only] = frozenset(found)
            return alone[only]

        start = closure({0})
        if any(node in finals for node in start):
            raise RuleError(f"the rule <{name}> can be empty")
        states: list[State] = []
        known = {start: 0}
        reached_from: dict[int | frozenset[int], int] = {}
        states.append(State({}, (), None))
        todo = [start]
        while todo:
            nodes = todo.pop()
            moves: dict[Any, set[int]] = {}
            for node in nodes:
                for symbol, following in self.edges[node]:
                    moves.setdefault(symbol, set()).add(following)
            words: dict[str, int] = {}
            calls: list[tuple[int, str | None, int]] = []
            for symbol, targets in moves.items():
                # Long lists of words lead to one node: looked up without its closure.
                key = next(iter(targets)) if len(targets) == 1 else frozenset(targets)
                state = reached_from.get(key)
                if state is None:
                    target = closure(targets)
                    if target not in known:
                        known[target] = len(states)
                        states.append(State({}, (), None))
                        todo.append(target)
                    state = reached_from[key] = known[target]
                if isinstance(symbol, str):
                    words[symbol] = state
                else:
                    calls.append((*symbol, state))
            reached = [finals[node] for node in nodes if node in finals]
            states[known[nodes]] = State(words, tuple(calls), min(reached) if reached else None)
        return self._shared(states)

    def _shared(self, states: list[State]) -> int:
        """Keep the states of a rule, those from which the same can follow as one: templates share
        their endings as they share their beginnings. No rule leads back to a state of its own, so
        that each is looked at after all that follow it. Returns the first one's number."""
        numbers: dict[int, int] = {}
        same: dict[Any, int] = {}

        def keep(at: int) -> int:
            if at not in numbers:
                old = states[at]
                words = {word: keep(following) for word, following in old.words.items()}
                calls = tuple((callee, name, keep(then)) for callee, name, then in old.calls)
                key = (frozenset(words.items()), frozenset(calls), old.final)
                if key not in same:
                    same[key] = len(self.states)
                    self.states.append(State(words, calls, old.final))
                numbers[at] = same[key]
            return numbers[at]

        return keep(0)

    # --- all rules

    def _refuse_left_recursion(self, starts: list[int]) -> None:
        names = list(self.numbers)
        done: set[int] = set()

        def visit(rule: int, path: tuple[int, ...]) -> None:
            if rule in path:
                circle = " -> ".join(f"<{names[each]}>" for each in (*path, rule))
                raise RuleError(f"a rule begins with itself: {circle}")
            if rule in done or starts[rule] < 0:
                return
            for callee, _, _ in self.states[starts[rule]].calls:
                visit(callee, (*path, rule))
            done.add(rule)

        for rule in range(len(starts)):
            visit(rule, ())

    def _beginnings(
        self, starts: list[int]
    ) -> tuple[dict[str, frozenset[int]], dict[int, frozenset[int]]]:
        """Which rules can begin with a word or a slot."""
        words: dict[int, frozenset[str]] = {}
        slots: dict[int, frozenset[int]] = {}

        def visit(rule: int) -> None:
            if rule in words:
                return
            if starts[rule] < 0:
                words[rule], slots[rule] = frozenset(), frozenset((rule,))
                return
            state = self.states[starts[rule]]
            below = {callee for callee, _, _ in state.calls}
            for callee in below:
                visit(callee)
            words[rule] = frozenset(state.words).union(*(words[each] for each in below))
            slots[rule] = frozenset().union(*(slots[each] for each in below))

        for rule in range(len(starts)):
            visit(rule)
        return _inverted(words), _inverted(slots)


def _inverted(sets: Mapping[int, Iterable[_Key]]) -> dict[_Key, frozenset[int]]:
    found: defaultdict[_Key, set[int]] = defaultdict(set)
    for number, keys in sets.items():
        for key in keys:
            found[key].add(number)
    return {key: frozenset(numbers) for key, numbers in found.items()}


def _size(template: Template) -> int:
    """How many words and references are in a template."""
    match template:
        case TemplateSequence(parts):
            return sum(map(_size, parts))
        case Choice(alternatives):
            return sum(map(_size, alternatives))
        case _:
            return 1


def parts_of(template: Template) -> list[Part]:
    """All references in a template."""
    match template:
        case Part():
            return [template]
        case TemplateSequence(parts):
            return [each for part in parts for each in parts_of(part)]
        case Choice(alternatives):
            return [each for alternative in alternatives for each in parts_of(alternative)]
        case _:
            return []
