"""From the corpus to what a model is shown: tokens to read, and tokens to learn."""

from __future__ import annotations

import random
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Final

from grammar.planning.model.prompt import request
from grammar.prepared import forget
from nl2robot.language_model.files import TOKENS
from nl2robot.language_model.tokens import Tokens
from nl2robot.training.planner.corpus import Item, digest, files, knowledge, load
from nl2robot.training.planner.course import OFTEN
from nl2robot.training.planner.example import Example, Examples
from nl2robot.training.planner.noise import as_heard, as_typed
from nl2robot.training.planner.recipe import RECIPE, Recipe

HELD_OUT: Final = "-6"
"""The sixth file of each author is never learned from."""


def example(item: Item, tokens: Tokens) -> Example:
    forget()
    asked = request(item.turn, item.after.do if item.after else "")
    prompt = [*tokens.encode(asked.prefix, control=True)]
    for piece in asked.said:
        prompt += tokens.encode(piece.text, control=piece.marks)
    return Example(tuple(prompt), (*tokens.encode(item.do), tokens.end))


def is_held_out(item: Item) -> bool:
    return HELD_OUT in item.where.split(".")[0]


def passes(
    items: Sequence[Item], tokens: Tokens, recipe: Recipe, tell: Callable[[str], None]
) -> Iterator[list[Example]]:
    """The examples of all passes over the corpus, in no order; each time others are noisy."""
    chosen = [item for item in items if not is_held_out(item)]
    plain = [example(item, tokens) for item in told(chosen, "sentences to learn from", tell)]
    for number in range(recipe.passes):
        chance = random.Random(recipe.seed + number)
        shown = []
        named = f"sentences for pass {number + 1} of {recipe.passes}"
        for at, item in enumerate(told(chosen, named, tell)):
            is_noisy = chance.random() < recipe.noisy
            shown.append(example(noisy(item, chance), tokens) if is_noisy else plain[at])
        chance.shuffle(shown)
        yield shown


def told(items: Sequence[Item], what: str, tell: Callable[[str], None]) -> Iterable[Item]:
    """The items, while it is told from time to time how many have been looked at."""
    last = time.monotonic()
    for number, item in enumerate(items):
        if time.monotonic() - last > OFTEN:
            tell(f"{number} of {len(items)} {what}.")
            last = time.monotonic()
        yield item


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


def make_examples(
    folder: Path, out: Path, tell: Callable[[str], None], recipe: Recipe = RECIPE
) -> Examples:
    """The examples of the whole corpus, for the model that is installed in `folder`, written to
    `out`."""
    tokens, items = Tokens.load(folder / TOKENS), list(load(files()))
    unseen = [item for item in items if is_held_out(item)]
    made = Examples(
        digest(),
        list(passes(items, tokens, recipe, tell)),
        [example(item, tokens) for item in told(unseen, "sentences never to learn from", tell)],
        list(tokens.written),
    )
    made.save(out)
    return made
