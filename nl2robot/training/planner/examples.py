"""From the corpus to what a model is shown: tokens to read, and tokens to learn.

    python -m nl2robot.training.planner.examples INSTALLED_FOLDER OUT.msgpack [--passes 2]

The file is all that `train` needs besides the weights.
"""

from __future__ import annotations

import argparse
import random
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from grammar.planning.model.prompt import request
from grammar.prepared import forget
from nl2robot.language_model.files import TOKENS
from nl2robot.language_model.tokens import Tokens
from nl2robot.training.planner.corpus import Item, files, knowledge, load
from nl2robot.training.planner.example import Example, Examples
from nl2robot.training.planner.noise import as_heard, as_typed

HELD_OUT: Final = "-6"
"""The sixth file of each author is never learned from."""
NOISY: Final = 0.2
"""The share of sentences that are shown as heard or as typed."""


def example(item: Item, tokens: Tokens) -> Example:
    forget()
    asked = request(item.turn, item.after.do if item.after else "")
    prompt = [*tokens.encode(asked.prefix, control=True)]
    for piece in asked.said:
        prompt += tokens.encode(piece.text, control=piece.marks)
    return Example(tuple(prompt), (*tokens.encode(item.do), tokens.end))


def is_held_out(item: Item) -> bool:
    return HELD_OUT in item.where.split(".")[0]


def passes(items: Sequence[Item], tokens: Tokens, number: int) -> Iterator[list[Example]]:
    """The examples of so many passes over the corpus, in no order; each time others are noisy."""
    chosen = [item for item in items if not is_held_out(item)]
    plain = [example(item, tokens) for item in chosen]
    for seed in range(number):
        chance = random.Random(seed)
        shown = [
            example(noisy(item, chance), tokens) if chance.random() < NOISY else as_written
            for item, as_written in zip(chosen, plain, strict=True)
        ]
        chance.shuffle(shown)
        yield shown


def noisy(item: Item, chance: random.Random) -> Item:
    if chance.random() < 0.5:
        return replace(item, say=as_heard(item.say, item.language, chance))
    lexicon = knowledge(item.world).lexicon(item.language)
    named = (*lexicon.places, *lexicon.people, *lexicon.objects)
    names = frozenset(
        word.lower()
        for each in named
        for text in (each.name, *each.aliases)
        for word in text.split()
    )
    return replace(item, say=as_typed(item.say, chance, names))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("installed", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--passes", type=int, default=2, help="over the corpus")
    given = parser.parse_args()
    tokens, items = Tokens.load(given.installed / TOKENS), list(load(files()))
    made = Examples(
        list(passes(items, tokens, given.passes)),
        [example(item, tokens) for item in items if is_held_out(item)],
        list(tokens.written),
    )
    made.save(given.out)
    print(f"{len(made.passes[0])} examples, {len(made.unseen)} never learned from")


if __name__ == "__main__":
    main()
