"""Which token nearly always follows which few in the programs of the corpus.

    python -m nl2robot.training.planner.habits INSTALLED_FOLDER

Writes `nl2robot.language_model.habits.FILE` and says how many tokens it guesses right on held-out
programs.
"""

from __future__ import annotations

import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Final

import msgspec

from nl2robot.language_model.files import TOKENS
from nl2robot.language_model.habits import FILE, LONGEST, NONE, guessed, key
from nl2robot.language_model.tokens import Tokens
from nl2robot.training.planner.corpus import files, load
from nl2robot.training.planner.example import Example
from nl2robot.training.planner.examples import example, is_held_out

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


def main() -> None:
    tokens = Tokens.load(Path(sys.argv[1]) / TOKENS)
    items = list(load(files()))
    seen = [example(item, tokens) for item in items if not is_held_out(item)]
    unseen = [example(item, tokens) for item in items if is_held_out(item)]
    habits = habits_of(seen, tokens.end)
    FILE.parent.mkdir(exist_ok=True)
    FILE.write_bytes(msgspec.msgpack.encode(habits))
    print(f"{len(habits)} habits; {share_guessed(habits, unseen[:60]):.0%} of tokens guessed right")


if __name__ == "__main__":
    main()
