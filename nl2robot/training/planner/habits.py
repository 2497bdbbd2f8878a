"""Which token nearly always follows which few in the programs of the corpus:
`nl2robot.language_model.habits`."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from typing import Final

from nl2robot.language_model.habits import LONGEST, NONE, guessed, key
from nl2robot.training.planner.example import Example

OFTEN: Final = 3
"""How often something has to have been seen to be a habit, or to be none."""
NEARLY_ALWAYS: Final = 0.7


def habits_of(examples: Iterable[Example], end: int) -> dict[str, int]:
    seen: dict[str, Counter[int]] = defaultdict(Counter)
    for each in examples:
        tokens = [*each.prompt[-LONGEST:], *each.program]
        for place in range(LONGEST, len(tokens)):
            for length in range(1, LONGEST + 1):
                seen[key(tokens[place - length : place])][tokens[place]] += 1
    habits = {last: _habit(what, end) for last, what in seen.items() if what.total() >= OFTEN}
    return {last: what for last, what in habits.items() if what != _shorter(habits, last)}


def _habit(what: Counter[int], end: int) -> int:
    [(token, often)] = what.most_common(1)
    return token if often >= NEARLY_ALWAYS * what.total() and token != end else NONE


def _shorter(habits: dict[str, int], last: str) -> int | None:
    """What is known by fewer tokens anyhow."""
    _, _, rest = last.partition(" ")
    return habits.get(rest)


def share_guessed(habits: dict[str, int], examples: Sequence[Example]) -> float:
    """The share of tokens that the first guess has right."""
    right = total = 0
    for each in examples:
        for place, token in enumerate(each.program):
            guesses = guessed(habits, [*each.prompt, *each.program[:place]])
            right += guesses[:1] == [token]
            total += 1
    return right / total
