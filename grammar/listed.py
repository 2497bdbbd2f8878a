"""Names in a row, "the kitchen, the lobby and ward a", and what people change about such a row:
"leave out the lobby", "add the pharmacy", "the other way round"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from grammar.chart import Leaf, Node
from grammar.pieces import Piece, leading, leaves, words_listed
from grammar.reader import SentenceReader

KINDS: Final = {
    "place": "place",
    "place_tail": "place",  # "b" of "ward a, b and c"
    "person": "person",
    "object": "thing",
    "noun": "thing",
}
"""What the slots that names are said in hold."""
RULES: Final = {"place_ref": "place", "person_ref": "person", "thing": "thing"}
"""What the parts hold that are said in an addition (`grammar.pieces.Piece.rule`)."""


@dataclass(frozen=True)
class Member:
    """One name of a row."""

    kind: str
    lead: str
    """The preposition before it, as it was said: "to", "ins"."""
    words: str
    """The name with its article."""
    start: int
    """The token where all this begins."""
    end: int
    called: frozenset[str]
    """The words of its name in full, also where only "b" was said."""


@dataclass(frozen=True)
class Row:
    """Several names that are said one after the other."""

    reader: SentenceReader
    members: tuple[Member, ...]
    begins_it: bool
    """Whether none of their kind was named before them."""

    @property
    def kind(self) -> str:
        return self.members[0].kind

    def about(self, words: set[str]) -> list[Member]:
        """The members that some words speak of."""
        return [member for member in self.members if words and words <= member.called]

    def without(self, member: Member) -> str:
        return self._said([each for each in self.members if each != member])

    def reversed(self) -> str:
        return self._said(self.members[::-1])

    def with_one(self, new: SentenceReader, piece: Piece, *, first: bool = False) -> str:
        """The sentence with one more name, at the end of the row or as its first."""
        more = _member(new, piece.start, piece.end, self.kind, set())
        return self._said([more, *self.members] if first else [*self.members, more])

    def _said(self, members: Sequence[Member]) -> str:
        """The sentence with these in place of the row. What stands before all of them goes on
        standing there: "to" of "to the kitchen and the lobby"."""
        first = self.members[0]
        leads = [each.lead for each in members]
        if not leads[0]:
            own = any(each.lead for each in self.members[1:])  # "in die Küche und zur Apotheke"
            leads = ["" if each is first and not own else each.lead for each in members]
            leads[0] = first.lead
        rest = [f"{lead} {each.words}".strip() for lead, each in zip(leads, members, strict=True)]
        join = str(self.reader.language.speech["joined_by"])
        said = f" {join} ".join(filter(None, (", ".join(rest[:-1]), rest[-1])))
        text, tokens = self.reader.text, self.reader.tokens
        return (
            text[: tokens[first.start].start] + said + text[tokens[self.members[-1].end - 1].end :]
        )


def rows_of(reader: SentenceReader, tree: Node | None) -> list[Row]:
    """The rows of at least two names in a sentence."""
    found: list[list[Member]] = []
    for kind, start, end, called in _spots(tree):
        member = _member(reader, start, end, kind, called)
        before = found[-1][-1] if found else None
        if before is not None and before.kind == kind and _joined(reader, before.end, member):
            found[-1].append(member)
        else:
            found.append([member])
    return [
        Row(reader, tuple(members), all(each[0].kind != members[0].kind for each in found[:at]))
        for at, members in enumerate(found)
        if len(members) > 1
    ]


def _spots(tree: Node | None) -> list[tuple[str, int, int, set[str]]]:
    """The names in a sentence: their kind, where they stand, and how those who have them are
    called."""
    found: list[tuple[str, int, int, set[str]]] = []
    for leaf in sorted(leaves(tree), key=lambda leaf: leaf.start) if tree is not None else ():
        kind = KINDS.get(leaf.slot)
        if kind is None or leaf.start == leaf.end:
            continue
        if found and found[-1][0] == kind == "thing" and found[-1][2] == leaf.start:
            _, start, _, called = found.pop()  # "red" and "cup"
            found.append((kind, start, leaf.end, called | _called(leaf)))
        else:
            found.append((kind, leaf.start, leaf.end, _called(leaf)))
    return found


def _called(leaf: Leaf) -> set[str]:
    named = leaf.value if isinstance(leaf.value, tuple) else ()
    return {word for each in named for word in getattr(each, "name", "").lower().split()}


def _member(reader: SentenceReader, start: int, end: int, kind: str, called: set[str]) -> Member:
    first = start
    if first > 0 and _is_article(reader, first - 1):
        first -= 1
    begin = first - leading(reader, first)
    contracted = begin < first and reader.tokens[first].start == reader.tokens[first - 1].start
    noun = first + 1 if contracted else first  # "zur Apotheke": its article belongs to its "zu"
    return Member(
        kind,
        reader.words(begin, noun) if begin < first else "",
        reader.words(noun, end),
        begin,
        end,
        frozenset(called | reader.content(start, end)),
    )


def _is_article(reader: SentenceReader, at: int) -> bool:
    norm = (reader.tokens[at].norm,)
    others = words_listed(reader.language, "joins")
    others |= words_listed(reader.language, "prepositions")
    return reader.is_little(range(at, at + 1)) and norm not in others


def _joined(reader: SentenceReader, end: int, member: Member) -> bool:
    """Whether nothing but a comma, an "and", a "then" stands between two names."""
    joins = words_listed(reader.language, "joins")
    between = range(end, member.start)
    return any(
        reader.tokens[at].kind == "mark" or (reader.tokens[at].norm,) in joins for at in between
    ) and all(
        reader.tokens[at].kind == "mark" or reader.is_little(range(at, at + 1)) for at in between
    )
