"""From the corpus to what a model is shown: tokens to read, and tokens to learn.

    python -m nl2robot.training.planner.examples INSTALLED_FOLDER OUT.msgpack [--passes 3]

The file is all that `train` needs besides the weights.
"""

from __future__ import annotations

import argparse
import random
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Final

from grammar.planning.model.prompt import request
from grammar.said import forget
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


def learned(items: Iterable[Item], tokens: Tokens, epoch: int) -> Iterator[Example]:
    """The examples of one pass over the corpus, in no order; each time other ones are noisy."""
    chance = random.Random(epoch)
    chosen = [item for item in items if not is_held_out(item)]
    chance.shuffle(chosen)
    for item in chosen:
        yield example(noisy(item, chance) if chance.random() < NOISY else item, tokens)


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
    parser.add_argument("--passes", type=int, default=3, help="over the corpus")
    given = parser.parse_args()
    tokens, items = Tokens.load(given.installed / TOKENS), list(load(files()))
    passes = [list(learned(items, tokens, number)) for number in range(given.passes)]
    unseen = [example(item, tokens) for item in items if is_held_out(item)]
    Examples(passes, unseen, list(tokens.written)).save(given.out)
    print(f"{len(passes[0])} examples in {len(passes)} passes, {len(unseen)} never learned from")


if __name__ == "__main__":
    main()
