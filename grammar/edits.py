"""Changes to the words of the command before: "no, the pharmacy", "without the greeting".

A change is made to the sentence, not to its plan: what comes out is a sentence that somebody could
have said at once, and it is understood as such, with all that hangs together in it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal

from grammar.chart import Leaf, Node, TooMuch
from grammar.coverage import TEXTS
from grammar.language import Language
from grammar.lexicon import Lexicon, Routine
from grammar.pieces import (
    CORRECTABLE,
    FURNITURE,
    NAMED,
    NOUNS,
    NUMBERS,
    PLACES,
    PRONOUNS,
    Piece,
    is_pieces,
    lead_words,
    leading,
    leaves,
    named_until,
    norms,
    pieces_at,
    pieces_of,
    words_listed,
)
from grammar.tokens import Token
from grammar.trace import SEQUENCE

if TYPE_CHECKING:
    from grammar.reader import SentenceReader
    from grammar.understanding import Context

EditKind = Literal[
    "cancel",
    "drop step",
    "drop",
    "instead",
    "correct",
    "only",
    "first",
    "add",
    "reverse",
    "again",
    "same",
    "manner",
]

SAME_LETTERS: Final = 4
"""With how many letters two words must begin alike to be forms of one: "waving" and "wave"."""


@dataclass(frozen=True)
class Edit:
    """What is to become of the command before."""

    kind: EditKind
    new: str = ""
    """The words that come in."""
    old: str = ""
    """The words that they take the place of, or that are left out."""
    late: str = ""
    """Of "again", when: "in ten minutes"."""
    which: int = -1
    """Of "drop step": the last step, or the first (0)."""


class Sentence:
    """The words of a command, as they can be changed."""

    def __init__(self, reader: SentenceReader) -> None:
        self.reader = reader
        self.text = reader.text
        self.tokens = reader.tokens
        try:
            self.tree = reader.chart().best("utterance")
        except TooMuch:
            self.tree = None

    # --- its parts

    def within_texts(self) -> list[Piece]:
        """The same parts, of what is to be said or asked."""
        found: list[Piece] = []
        for leaf in leaves(self.tree) if self.tree is not None else ():
            at = leaf.start if leaf.slot in TEXTS else leaf.end
            while at < leaf.end:
                here = [each for each in pieces_at(self.reader, at) if each.end <= leaf.end]
                longest = max((each.end for each in here), default=at + 1)
                found += [each for each in here if each.end == longest]
                at = longest
        return found

    def pieces(self) -> list[Piece]:
        """All parts that another of its kind could take the place of, in their order."""
        found: list[Piece] = []

        def visit(node: Node, inside: bool = False) -> None:
            for part in node.parts.values():
                name = part.slot if isinstance(part, Leaf) else part.production.rule
                means = part.means if isinstance(part, Node) else ""
                if name in NAMED and not inside:
                    found.append(Piece(NAMED[name], part.start, part.end, means))
                spot = part.parts if isinstance(part, Node) and name == "spot" else {}
                furniture = spot.get("furniture")
                if furniture is not None:  # "on the desk | in the kitchen"
                    told = furniture.end if furniture.end < part.end else 0
                    found.append(Piece("place_ref", part.start, part.end, FURNITURE, True, told))
                if name in CORRECTABLE:
                    told = named_until(part) if isinstance(part, Node) else 0
                    found.append(Piece(name, part.start, part.end, means, named_until=told))
                if isinstance(part, Node):
                    visit(part, inside or name in NOUNS)

        if self.tree is not None:
            visit(self.tree)
        return sorted(found, key=lambda piece: (piece.start, -piece.end))

    def routine(self) -> Routine | None:
        """The routine that it calls for, if that is all."""
        if self.tree is None or self.first_meaning() != "routine" or len(self.clauses()) > 1:
            return None
        found: Routine | None = next(
            (leaf.value[0] for leaf in leaves(self.tree) if leaf.slot == "routine"), None
        )
        return found

    def clauses(self) -> list[tuple[int, int]]:
        """The tokens of each clause, the outer before the inner."""
        found: list[tuple[int, int]] = []

        def visit(node: Node) -> None:
            for name, part in node.parts.items():
                if not isinstance(part, Node):
                    continue
                if node.means == SEQUENCE and name == "first":
                    found.append((part.start, part.end))
                visit(part)

        if self.tree is not None:
            visit(self.tree)
        return list(dict.fromkeys(found))

    def siblings(self) -> list[list[tuple[int, int]]]:
        """The clauses of each sequence, the outer sequences first."""
        found: list[list[tuple[int, int]]] = []

        def visit(node: Node, row: list[tuple[int, int]] | None) -> None:
            if node.means == SEQUENCE:
                if row is None:
                    row = []
                    found.append(row)
                first = node.parts["first"]
                row.append((first.start, first.end))
            for name, part in node.parts.items():
                if isinstance(part, Node):
                    visit(part, row if name == "rest" else None)

        if self.tree is not None:
            visit(self.tree, None)
        return found

    def world(self) -> tuple[Lexicon, Language, Context]:
        """What its words are understood by."""
        return self.reader.lexicon, self.reader.language, self.reader.context

    # --- changed

    def with_words(self, start: int, end: int, words: str) -> str:
        return self.reader.with_words(start, end, words)

    def corrected(
        self, new: SentenceReader, *, everywhere: bool = False, within_texts: bool = False
    ) -> Iterator[str]:
        """The sentence with the parts of `new` in the places of parts of their kind, the likeliest
        first. `everywhere`: a part may stand for any noun; `within_texts`: the places are in what
        is to be said."""
        places = self.within_texts() if within_texts else self.pieces()
        rows = list(pieces_of(new))
        # "and the tables", of "count the chairs in the lobby", is nowhere to count in
        for said in sorted(rows, key=lambda said: not self._led_alike(new, said, places)):
            text = self._with_pieces(new, said, places, everywhere)
            if text is not None:
                yield text

    def _led_alike(self, new: SentenceReader, said: list[Piece], places: list[Piece]) -> bool:
        """Whether what new parts correct has the prepositions before it that they have, or is
        furniture as they are."""
        old = [self._counterpart(new, piece, places, set(), False) for piece in said]
        return all(
            each is not None
            and (
                each.means == piece.means == FURNITURE
                or lead_words(self.reader, each) == lead_words(new, piece)
            )
            for each, piece in zip(old, said, strict=True)
        )

    def place_of(self, new: SentenceReader) -> Piece | None:
        """The part that a single new one is like, if it is the thing spoken of."""
        for said in pieces_of(new):
            if len(said) == 1 and said[0].rule == "thing":
                return self._counterpart(new, said[0], self.pieces(), set(), False)
        return None

    def without_repeated(self, new: SentenceReader) -> SentenceReader:
        """What is said without the words at its beginning that were said before: "tell Bob, too"
        of "tell Alice that ..." is about Bob."""
        if is_pieces(new):
            return new
        known = {token.norm for token in self.tokens} | new.language.closed
        at = 0
        while at < new.last_word and new.tokens[at].norm in known:
            at += 1
            rest = type(new)(new.words(at, new.last_word), *self.world())
            if rest.tokens and is_pieces(rest):
                return rest
        return new

    def spoken_earlier(self, new: SentenceReader) -> bool:
        """Whether a single thing has its like before the end: "and the folder", of "pick up the
        box and take it to the lab"."""
        place = self.place_of(new)
        return place is not None and place.end < self.reader.last_word

    def _with_pieces(
        self, new: SentenceReader, said: list[Piece], places: list[Piece], everywhere: bool
    ) -> str | None:
        changes: list[tuple[int, int, str]] = []
        taken: set[int] = set()
        for piece in said:
            old = self._counterpart(new, piece, places, taken, everywhere)
            if old is None or not (piece.known or self._sole(old, places)):
                return None
            taken.update(range(old.start, old.end))
            lead, old_lead = leading(new, piece.start), leading(self.reader, old.start)
            kept = (
                not lead
                or not old_lead
                or norms(new, piece.start - lead, piece.start)
                in (words_listed(new.language, "same_for_words"))
            )
            first = piece.start if kept else piece.start - lead
            start = old.start if kept else old.start - old_lead
            changes.append((start, old.replaced_until(piece), new.words(first, piece.end)))
        text = self.text
        for start, end, words in sorted(changes, reverse=True):
            changed = self.with_words(start, end, words)
            tail = len(self.text) - self.tokens[end - 1].end
            text = changed[: len(changed) - tail] + text[self.tokens[end - 1].end :]
        return text

    def _sole(self, old: Piece, places: list[Piece]) -> bool:
        """Whether a part is the only one of its kind. Which of two nouns that nobody knows is
        meant cannot be told: "dinner", of "lunch is late"."""
        return sum(each.rule == old.rule for each in places) == 1

    def _counterpart(
        self,
        new: SentenceReader,
        piece: Piece,
        places: list[Piece],
        taken: set[int],
        everywhere: bool,
    ) -> Piece | None:
        """The part of the sentence that a new one most likely corrects."""
        lead = lead_words(new, piece)
        away = words_listed(new.language, "from_words")
        words = new.content(piece.start, piece.end)
        best: Piece | None = None
        best_score: tuple[bool, bool, bool, bool, int] | None = None
        for old in places:
            alike = old.rule == piece.rule or any(
                old.rule in kinds and piece.rule in kinds
                for kinds in (PLACES, NUMBERS, *((NOUNS,) if everywhere else ()))
            )
            before = lead_words(self.reader, old)
            if not alike or taken.intersection(range(old.start, old.end)):
                continue
            if lead and (lead in away) != (before in away):
                continue  # "from the kitchen" is no other place to go to
            if lead and lead != before and piece.rule in PLACES and old.rule not in PLACES:
                continue  # "in ward b" is nobody to be asked instead
            score = (
                old.means not in PRONOUNS,
                old.rule == piece.rule,
                bool(lead) and before == lead,
                bool(words & self.reader.content(old.start, old.end)),
                old.start,
            )
            if best_score is None or score > best_score:
                best, best_score = old, score
        return best

    def with_clause(self, new: SentenceReader) -> str | None:
        """The sentence with a whole clause in the place of the last one that does the like."""
        other = Sentence(new)
        doing = other.first_meaning()
        for row in reversed(self.siblings()):
            for start, end in reversed(row):
                part = Sentence(type(new)(self.reader.words(start, end), *self.world()))
                if doing and part.first_meaning() == doing:
                    return self.with_words(start, end, new.words(0, new.last_word))
        return None

    def last_of_its_like(self) -> Sentence:
        """The last clause, if it does what all do: "tell Clara that ... Tell Bob that ..."; else
        the whole."""
        row = self.siblings()[0] if self.siblings() else []
        if len(row) < 2 or not self.all_do_the_like(row):
            return self
        return Sentence(type(self.reader)(self.reader.words(*row[-1]), *self.world()))

    def all_do_the_like(self, clauses: list[tuple[int, int]]) -> bool:
        """Whether each of some clauses means the same but for the names in it."""
        meant = {
            Sentence(type(self.reader)(self.reader.words(*each), *self.world())).first_meaning()
            for each in clauses
        }
        return len(meant) == 1 and "" not in meant

    def first_meaning(self) -> str:
        """What the first clause does."""
        row = self.siblings()[0] if self.siblings() else []
        found = ""

        def visit(node: Node) -> None:
            nonlocal found
            if not found and node.means not in (SEQUENCE, "utterance") and node.production.means:
                found = node.means
            for part in node.parts.values():
                if isinstance(part, Node) and not found:
                    visit(part)

        if row and self.tree is not None:
            visit(self.tree)
        return found

    def swapped(self, old: SentenceReader, new: SentenceReader) -> str | None:
        """The sentence with some of its words put for others, wherever they stand."""
        stripped_old, stripped_new = old.lead, new.lead
        for skip in (0, stripped_old):
            words = [token for token in old.tokens[skip : old.last_word] if token.kind != "mark"]
            spots = self._spots(words)
            if spots and words:
                lead = min(stripped_new, skip)
                put = new.words(lead, new.last_word)
                text = self.text
                for start, end in reversed(spots):
                    end += self._said_too(end, new.tokens[lead : new.last_word])
                    first, last = self.tokens[start].start, self.tokens[end - 1].end
                    text = text[:first] + put + text[last:]
                return text
        return None

    def _said_too(self, at: int, new: Sequence[Token]) -> int:
        """How many of the words that stand here end what is put before them: "ten minutes instead
        of five" in "wait five minutes"."""
        for length in range(len(new) - 1, 0, -1):
            here = self.tokens[at : at + length]
            pairs = zip(here, new[-length:], strict=False)
            if len(here) == length and all(same_word(a.norm, b.norm) for a, b in pairs):
                return length
        return 0

    def _spots(self, words: list[Token]) -> list[tuple[int, int]]:
        """Where these words stand in the sentence, in any of their forms."""
        count = len(words)
        return [
            (at, at + count)
            for at in range(len(self.tokens) - count + 1)
            if all(
                same_word(self.tokens[at + number].norm, word.norm)
                for number, word in enumerate(words)
            )
        ]

    def without(self, start: int, end: int) -> str | None:
        """The sentence without a clause, and without what joined it to the others."""
        row = next((row for row in self.siblings() if (start, end) in row), None)
        if row is None or len(row) < 2:
            return None
        at = row.index((start, end))
        if at == 0:
            return self.text[: self.tokens[start].start] + self.text[self.tokens[row[1][0]].start :]
        return self.text[: self.tokens[row[at - 1][1] - 1].end] + self.text[self._tail(end) :]

    def without_words(self, piece: Piece) -> Iterator[str]:
        """The sentence without a name in a list of several."""
        joins = self.reader.language.speech["joins"]
        first = piece.start
        while first > 0 and (
            self.tokens[first - 1].kind == "mark" or self.reader.is_little(range(first - 1, first))
        ):
            first -= 1
            if self.tokens[first].kind != "mark" and self.tokens[first].norm not in joins:
                continue
            yield (
                self.text[: self.tokens[first].start].rstrip() + self.text[self._tail(piece.end) :]
            )
        last = piece.end
        while last < len(self.tokens) and (
            self.tokens[last].kind == "mark" or self.reader.is_little(range(last, last + 1))
        ):
            last += 1
            joint = self.tokens[last - 1]
            if last < len(self.tokens) and (joint.kind == "mark" or joint.norm in joins):
                yield (
                    self.text[: self.tokens[piece.start].start]
                    + self.text[self.tokens[last].start :]
                )

    def except_for(self, words: str) -> Iterator[str]:
        """The sentence with an exception where it speaks of all of a kind."""
        word = self.reader.language.speech["except"]
        if self.tree is not None:
            for leaf in leaves(self.tree):
                if leaf.slot in ("kinds", "kind"):
                    end = self._tail(leaf.end)
                    yield f"{self.text[:end]} {word} {words}{self.text[end:]}"

    def _tail(self, end: int) -> int:
        return self.tokens[end - 1].end


def same_word(one: str, other: str) -> bool:
    """Whether two words are forms of one."""
    if one == other:
        return True
    shared = min(len(one), len(other))
    return (
        shared >= SAME_LETTERS
        and one[: max(SAME_LETTERS, shared - 2)] == (other[: max(SAME_LETTERS, shared - 2)])
    )
