"""The parts of a sentence that another of its kind could take the place of: "to the pharmacy"."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from grammar.chart import Leaf, Node, TooMuch
from grammar.language import Language
from grammar.slips import command_words
from grammar.slots import UNKNOWN_NAME

if TYPE_CHECKING:
    from grammar.reader import SentenceReader

CORRECTABLE: Final = (
    "place_ref",
    "all_places",
    "person_ref",
    "thing",
    "counted",
    "number",
    "count",
    "length",
    "angle",
    "duration",
    "times",
    "clock_time",
    "percentage",
    "language",
    "emotion",
    "gesture",
)
"""Rules and slots whose words can be put in the place of others."""
NOUNS: Final = frozenset({"place_ref", "person_ref", "thing"})
"""Those of them that may stand for each other: "go to Alice" - "no, the kitchen"."""
PLACES: Final = frozenset({"place_ref", "all_places"})
"""Those that stand for each other wherever they are said: "every office" - "only Bob's"."""
FURNITURE: Final = "place_of_furniture"
"""What a piece of furniture means that is spoken of as a place."""
THINGS: Final = frozenset({"thing", "counted"})
"""Rules for things that are spoken of by a noun."""
NUMBERS: Final = frozenset({"number", "count"})
NAMED: Final = {"person": "person_ref"}
"""Slots for names, and the rule that they count as where none of it is around them."""
PRONOUNS: Final = frozenset({"person_pronoun", "person_me", "thing_it", "place_there"})
MOST_ROWS: Final = 1000
"""Ways to read some words as parts that are looked at."""
UNHEARD: Final = frozenset({"noun", "unknown", "text", "word"})
"""Slots for words that nobody knows."""


@dataclass(frozen=True)
class Piece:
    """A part of what is said in a correction: "to the pharmacy"."""

    rule: str
    start: int
    end: int
    means: str = ""
    known: bool = True
    """Whether it is more than a noun that nobody has heard of."""
    named_until: int = 0
    """Of a thing of which more is told ("the cup | from the kitchen"), where that begins."""

    def replaced_until(self, new: Piece) -> int:
        """Where a new part takes the place of this one: what is told of a thing stays true of the
        thing that is meant instead, unless something else is told of it."""
        stays = self.named_until and self.means == new.means and not new.named_until
        return self.named_until if stays else self.end


def leaves(node: Node) -> Iterator[Leaf]:
    """All that slots have matched in a reading."""
    for part in node.parts.values():
        if isinstance(part, Node):
            yield from leaves(part)
        else:
            yield part


def named_until(node: Node) -> int:
    """Where more is told of a thing, or 0."""
    mods = node.parts.get("mods")
    told = node.production.rule in THINGS and isinstance(mods, Node) and mods.end == node.end
    return mods.start if told and isinstance(mods, Node) else 0


def is_pieces(reader: SentenceReader) -> bool:
    """Whether words are nothing but parts that could be put into a sentence, and known ones: "in
    ward b"."""
    return any(all(piece.known for piece in row) for row in pieces_of(reader))


def pieces_of(reader: SentenceReader) -> Iterator[list[Piece]]:
    """The ways to read all words of a correction as parts that can be put in, the longest parts
    first."""
    try:
        yield from itertools.islice(_rows(reader, 0, set()), MOST_ROWS)
    except TooMuch:
        return


def _rows(reader: SentenceReader, at: int, dead: set[int]) -> Iterator[list[Piece]]:
    """`dead`: where it is known already that nothing leads from to the end; there may be as many
    ways to each of them as there are ways to read a row of numbers."""
    end = reader.last_word
    while at < end and (reader.tokens[at].kind == "mark" or at in reader.skips):
        at += 1
    if at >= end:
        yield []
        return
    if at in dead:
        return
    found = False
    joined = words_listed(reader.language, "joins")
    begins = [at + 1] if (reader.tokens[at].norm,) in joined else []
    for begin in (at, *begins):
        leads = (len(each) for each in words_listed(reader.language, "prepositions"))
        for start in sorted({begin, *(begin + lead for lead in leads)}):
            if start > begin and leading(reader, start) < start - begin:
                continue
            if start >= end:  # a preposition without more
                continue
            for piece in sorted(_likely_at(reader, start), key=lambda piece: -piece.end):
                for rest in _rows(reader, piece.end, dead):
                    found = True
                    yield [piece, *rest]
    if not found:
        dead.add(at)


def _likely_at(reader: SentenceReader, start: int) -> list[Piece]:
    """The parts that begin here, without unheard-of nouns where rules know better: "two minutes"
    are a time, and "stay" is something to do."""
    pieces = list(pieces_at(reader, start))
    known = max((piece.end for piece in pieces if piece.known), default=0)
    begins_command = reader.tokens[start].norm in command_words(reader.language)
    return [piece for piece in pieces if piece.known or (piece.end > known and not begins_command)]


def leading(reader: SentenceReader, start: int) -> int:
    """How many words before a part belong to it: "to" of "to the pharmacy"."""
    return max(
        (
            len(words)
            for words in words_listed(reader.language, "prepositions")
            if norms(reader, start - len(words), start) == words
        ),
        default=0,
    )


def lead_words(reader: SentenceReader, piece: Piece) -> tuple[str, ...]:
    return norms(reader, piece.start - leading(reader, piece.start), piece.start)


def norms(reader: SentenceReader, start: int, end: int) -> tuple[str, ...]:
    return tuple(token.norm for token in reader.tokens[max(start, 0) : end])


@functools.cache
def words_listed(language: Language, name: str) -> frozenset[tuple[str, ...]]:
    """Words that the language lists by this name."""
    return frozenset(map(language.tokens_of, language.speech.get(name, ())))


def pieces_at(reader: SentenceReader, start: int) -> Iterator[Piece]:
    """The parts that begin here. Raises `TooMuch`."""
    for rule in CORRECTABLE:
        if rule in reader.language.rules:
            node = reader.chart().longest(rule, start)
            if node is not None and node.cost < UNKNOWN_NAME:
                known = all(leaf.slot not in UNHEARD for leaf in leaves(node))
                yield Piece(rule, node.start, node.end, node.means, known, named_until(node))
                if node.means == FURNITURE and not leading(reader, start):
                    for each in sorted(THINGS):  # tables can be counted, too
                        yield Piece(each, node.start, node.end, "thing")
        else:
            for end, _, _ in reader.slots.matches(f"{{{rule}}}", start):
                yield Piece(rule, start, end)
