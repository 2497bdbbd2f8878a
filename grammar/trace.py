"""How a sentence was read: which words became what, for people who want to see it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Final

from grammar.chart import Leaf, Node
from grammar.lexicon import Name, Question, Routine
from grammar.tokens import Token

SEQUENCE: Final = "steps"
"""The meaning of clauses one after the other: it is nothing in itself."""


@dataclass(frozen=True)
class Read:
    """Some words of a sentence and what they were read as."""

    words: str
    meaning: str
    """What a rule makes of them ("goto"), or the slot they are in ("place"); of a misspelt word,
    the word it was read as, in quotation marks."""
    value: str | None
    """What they stand for, where that is known: "pharmacy" for "the drugstore"."""
    start: int
    """The first character."""
    depth: int
    """How many of the other parts they are inside."""


def read(tree: Node, tokens: tuple[Token, ...], text: str) -> list[Read]:
    """The parts of a parse that mean something, the outer before the inner, from left to right."""

    def part(start: int, end: int, meaning: str, value: Any, depth: int) -> Read:
        if start >= end:
            return Read("", meaning, value, len(text), depth)
        first = tokens[start].start
        return Read(text[first : tokens[end - 1].end], meaning, value, first, depth)

    def visit(node: Node, depth: int) -> Iterator[Read]:
        meaning = node.production.means
        if meaning and meaning != SEQUENCE:
            yield part(node.start, node.end, meaning, None, depth)
            depth += 1
        for each in sorted(node.parts.values(), key=lambda each: (each.start, each.end)):
            if isinstance(each, Node):
                yield from visit(each, depth)
            else:
                yield part(each.start, each.end, each.slot, _stands_for(each), depth)

    found = list(visit(tree, 0))
    found += [part(at, at + 1, f"“{word}”", None, 0) for at, word in tree.corrections]
    return found


def _stands_for(leaf: Leaf) -> str | None:
    if not isinstance(leaf.value, tuple):
        return None if leaf.value is None else _shown(leaf.value)
    return " | ".join(dict.fromkeys(_shown(value) for value in leaf.value))


def _shown(value: Any) -> str:
    match value:
        case Name(name=name) | Routine(name=name):
            return name
        case Question(question=question):
            return question
        case float():
            return f"{value:g}"
        case _:
            return str(value)
