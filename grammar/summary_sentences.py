"""What is told of a plan in a breath, put together as sentences: things that are done, and clauses
with what is done under them.

    Deed("go to ward a"), Clause("if I see a person", (Deed("wave"),))
    -> "I will go to ward a. Then, if I see a person, I will wave."
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeGuard

from grammar.speech import Speech, fill


@dataclass(frozen=True)
class Deed:
    text: str


@dataclass(frozen=True)
class Clause:
    """Something done under a condition, or several times."""

    text: str
    items: tuple[Item, ...]
    adverb: bool = False
    """Whether it stands in its sentence without a comma: "in every office"."""


Item = Deed | Clause


def sentences(items: Iterable[Item], words: Speech) -> Iterator[str]:
    """The sentences of a row of items, in a language."""
    brief = words.brief
    simple: list[Item] = []
    closing = re.escape(words.values["quoted"][-1])

    def sentence(pattern: str, **values: str) -> str:
        text = fill(brief[pattern], values)
        text = re.sub(rf"([.!?…]\s?{closing})\.$", r"\1", text)
        return text[:1].upper() + text[1:]

    said = False
    for item in items:
        if _is_deed(item):
            simple.append(item)
            continue
        assert isinstance(item, Clause)
        if simple:
            yield sentence("next" if said else "first", steps=_joined(simple, words))
            simple, said = [], True
        clause, pattern = item.text, "adverb" if item.adverb else "clause"
        match item:
            case Clause(adverb=True, items=(Clause(adverb=False) as inner,)):
                # "In every ward, if I see a person, I will ..."
                clause, pattern, item = f"{clause}{brief['comma']}{inner.text}", "clause", inner
        yield sentence(pattern, clause=clause, steps=_joined(item.items, words))
        said = True
    if simple:
        yield sentence("next" if said else "first", steps=_joined(simple, words))


def _is_deed(item: Item) -> TypeGuard[Deed]:
    return isinstance(item, Deed)


def _joined(items: Sequence[Item], words: Speech) -> str:
    """Items within a sentence: "a, b and, if so, c; otherwise d"."""
    brief = words.brief
    parts: list[list[str]] = [[]]
    for number, item in enumerate(items):
        if isinstance(item, Deed):
            if number and isinstance(items[number - 1], Clause):
                parts.append([])
            parts[-1].append(item.text)
            continue
        steps = _joined(item.items, words)
        pattern = brief["inner adverb" if item.adverb else "inner clause"]
        if number and isinstance(items[number - 1], Clause):
            parts.append([])
        parts[-1].append(fill(pattern, {"clause": item.text, "steps": steps}))
    told = [_listed(part, items_of, brief) for part, items_of in _with_items(parts, items)]
    return brief["semicolon"].join(told)


def _with_items(
    parts: Sequence[list[str]], items: Sequence[Item]
) -> Iterator[tuple[list[str], Item]]:
    """Each part with the item that it ends with."""
    at = -1
    for part in parts:
        at += len(part)
        yield part, items[at]


def _listed(texts: list[str], last: Item, brief: dict[str, str]) -> str:
    if len(texts) == 1:
        return texts[0]
    comma = isinstance(last, Clause) and not last.adverb
    joint = brief["and clause" if comma else "and"]
    return brief["comma"].join(texts[:-1]) + joint + texts[-1]
