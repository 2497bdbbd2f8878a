"""The parser: the cheapest reading of a row of tokens by a network of rules.

A memoised walk (a chart): for a rule and a first token it finds, once, every token where the rule
may end, and keeps only the cheapest way to each (Viterbi), so that an ambiguous sentence costs no
more than a clear one. Words of rules are free; open slots, words passed over, corrected spellings
and rules marked as unlikely cost, so that the cheapest reading is the one that understands most.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final, Protocol

from grammar.network import Network, Production
from grammar.tokens import Token

STEPS_ALLOWED: Final = 60_000
"""More than any sensible sentence of 150 words needs; what goes on longer is given up."""

CORRECTION: Final = 4.0
"""What reading a misspelt word as a known one costs."""

FORM: Final = 0.3
"""What reading a verb in another form costs: "when you have greeted him"."""

Match = tuple[int, float, Any]
"""What a slot finds: the token after it, the cost, the value."""

Slot = Callable[[int], list[Match]]
"""Finds all matches of a slot that begin at a token."""


class SlotSet(Protocol):
    """The slots over a row of tokens; their names stand in braces."""

    def matches(self, slot: str, at: int) -> list[Match]:
        """All matches that begin at a token."""
        ...

    def starting(self, at: int) -> Iterable[str]:
        """At least those that have matches at a token."""
        ...


@dataclass(frozen=True)
class Corrected:
    """A value that a slot found by reading misspelt words otherwise."""

    value: Any
    corrections: tuple[tuple[int, str], ...]


class TooMuch(Exception):
    """The sentence has more possible readings than can be looked through."""


@dataclass(frozen=True, slots=True)
class Leaf:
    """What a slot matched."""

    slot: str
    value: Any
    start: int
    end: int


@dataclass(slots=True)
class Node:
    """What a rule matched: tokens `start` to `end`, and what its slots and rules are bound to."""

    production: Production
    start: int
    end: int
    cost: float
    parts: dict[str, Part] = field(default_factory=dict)
    corrections: list[tuple[int, str]] = field(default_factory=list)
    """Tokens that were read as another word, here or below."""

    @property
    def means(self) -> str:
        return self.production.means or self.production.rule


Part = Leaf | Node


def what_it_means(part: Part) -> str:
    """The meaning of a part that may stand for another one."""
    while isinstance(part, Node) and part.production.means is None and len(part.parts) == 1:
        (part,) = part.parts.values()
    return part.means if isinstance(part, Node) else part.slot


# A step on the way to a state, linked to the one before: (before, binding, callee, start, end,
# value). callee -1 is a corrected word.
_Way = tuple[Any, str | None, int, int, int, Any]
_End = tuple[float, int, _Way | None]


class Chart:
    """The readings of one row of tokens."""

    def __init__(
        self,
        network: Network,
        tokens: tuple[Token, ...],
        slots: SlotSet,
        *,
        skips: Mapping[int, list[tuple[int, float]]],
        corrections: Mapping[int, tuple[str, ...]],
        forms: Mapping[int, tuple[str, ...]],
    ) -> None:
        self.network = network
        self.tokens = tokens
        self.skips = skips
        self.corrections = corrections
        self.forms = forms
        self._slots = slots
        self._numbers = network.slot_numbers
        self._ends: list[dict[int, dict[int, _End]]] = [{} for _ in range(len(tokens) + 1)]
        """For each token, of the rules that were tried there."""
        self._matches: dict[tuple[int, int], list[Match]] = {}
        self._beginning: list[frozenset[int] | None] = [None] * len(tokens)
        self._steps = 0

    def best(self, rule: str) -> Node | None:
        """The cheapest reading of all tokens as this rule. Raises `TooMuch`."""
        number = self.network.rule(rule)
        end = self._walked(number, 0).get(len(self.tokens))
        return None if end is None else self._node(0, len(self.tokens), end)

    def longest(self, rule: str, start: int) -> Node | None:
        """The longest reading from this token on; of the same length, the cheapest."""
        ends = self._walked(self.network.rule(rule), start)
        if not ends:
            return None
        last = max(ends)
        return self._node(start, last, ends[last])

    def ends(self, rule: str, start: int) -> list[int]:
        """Where readings from this token on end, the cheapest first; of the same cost, the
        longest."""
        ends = self._walked(self.network.rule(rule), start)
        return sorted(ends, key=lambda end: (ends[end][0], -end))

    def reading(self, rule: str, start: int, end: int) -> Node:
        """The cheapest reading between two tokens, one of those of `ends`."""
        return self._node(start, end, self._walked(self.network.rule(rule), start)[end])

    # --- walking

    def _walked(self, rule: int, start: int) -> dict[int, _End]:
        """What a rule finds at a token. Raises `TooMuch`, and then for ever: what a walk that was
        broken off has noted is not the whole."""
        if self._steps > STEPS_ALLOWED:
            raise TooMuch
        try:
            return self._spans(rule, start)
        except RecursionError as error:
            self._steps = STEPS_ALLOWED + 1
            raise TooMuch from error

    def _spans(self, rule: int, start: int) -> dict[int, _End]:
        known = self._ends[start].get(rule)
        if known is not None:
            return known
        result: dict[int, _End] = {}
        self._ends[start][rule] = result
        network, tokens = self.network, self.tokens
        states, starts = network.states, network.starts
        count = len(tokens)
        agenda: dict[int, dict[int, tuple[float, _Way | None]]] = {
            start: {starts[rule]: (0.0, None)}
        }
        at = start
        while agenda:
            here = agenda.pop(at, None)
            if here is None:
                at += 1
                continue
            self._steps += len(here)
            if self._steps > STEPS_ALLOWED:
                raise TooMuch
            if at > start:
                for number, (cost, way) in here.items():
                    final = states[number].final
                    if final is not None:
                        total = cost + final[0]
                        if at not in result or total < result[at][0]:
                            result[at] = (total, final[1], way)
            if at < count:
                word, begin, tried = tokens[at].norm, self._begin(at), self._ends[at]
                spelled, formed = self.corrections.get(at), self.forms.get(at)
                for end, extra in self.skips.get(at, ()):
                    for number, (cost, way) in here.items():
                        _reach(agenda, end, number, cost + extra, way)
                for number, (cost, way) in here.items():
                    state = states[number]
                    following = state.words.get(word)
                    if following is not None:
                        _reach(agenda, at + 1, following, cost, way)
                    for other in spelled or ():
                        following = state.words.get(other)
                        if following is not None:
                            step: _Way = (way, None, -1, at, at + 1, other)
                            _reach(agenda, at + 1, following, cost + CORRECTION, step)
                    for other in formed or ():
                        following = state.words.get(other)
                        if following is not None:
                            _reach(agenda, at + 1, following, cost + FORM, way)
                    for callee, binding, following in state.calls:
                        if callee not in begin:
                            continue
                        if starts[callee] < 0:
                            for end, extra, value in self._slot(callee, at):
                                step = (way, binding, callee, at, end, value)
                                _reach(agenda, end, following, cost + extra, step)
                            continue
                        found = tried.get(callee)
                        if found is None:
                            found = self._spans(callee, at)
                        for end, inner in found.items():
                            step = (way, binding, callee, at, end, inner)
                            _reach(agenda, end, following, cost + inner[0], step)
            at += 1
        return result

    def _begin(self, at: int) -> frozenset[int]:
        """The rules and slots that can begin with a token: of the hundreds that are asked for at
        each, only they are walked. Where a word may be passed over, those of the next one too."""
        known = self._beginning[at]
        if known is None:
            beginning, word = self.network.beginning, self.tokens[at].norm
            spelled = (word, *self.corrections.get(at, ()), *self.forms.get(at, ()))
            known = self._beginning[at] = frozenset().union(
                *(beginning.get(each, ()) for each in spelled),
                *(
                    self.network.beginning_with_slot[slot]
                    for slot in map(self._numbers.get, self._slots.starting(at))
                    if slot is not None and self._slot(slot, at)
                ),
                *(self._begin(end) for end, _ in self.skips.get(at, ()) if end < len(self.tokens)),
            )
        return known

    def _slot(self, callee: int, at: int) -> list[Match]:
        key = (callee, at)
        if key not in self._matches:
            self._matches[key] = self._slots.matches(self.network.names[callee], at)
        return self._matches[key]

    # --- reading off

    def _node(self, start: int, end: int, found: _End) -> Node:
        cost, production, way = found
        node = Node(self.network.productions[production], start, end, cost)
        steps: list[_Way] = []
        while way is not None:
            steps.append(way)
            way = way[0]
        for _, binding, callee, first, last, value in reversed(steps):
            if callee < 0:
                node.corrections.append((first, value))
            elif self.network.starts[callee] < 0:
                name = self.network.names[callee][1:-1]
                if isinstance(value, Corrected):
                    node.corrections += value.corrections
                    value = value.value
                node.parts[binding or name] = Leaf(name, value, first, last)
            else:
                inner = self._node(first, last, value)
                node.corrections += inner.corrections
                if inner.production.means is None and binding is None:
                    node.parts.update(inner.parts)
                else:
                    node.parts[binding or inner.production.rule] = inner
        return node


def _reach(
    agenda: dict[int, dict[int, tuple[float, _Way | None]]],
    end: int,
    state: int,
    cost: float,
    way: _Way | None,
) -> None:
    there = agenda.setdefault(end, {})
    old = there.get(state)
    if old is None or cost < old[0]:
        there[state] = (cost, way)
