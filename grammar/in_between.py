"""When or how often something is done, said in the middle of its clause: "remind Alice every ten
minutes to drink", "take Bob at three to radiology".

The rules know such words before a clause and behind it. Where a sentence cannot be understood, they
are moved to the beginning of their clause, and the sentence is understood anew.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator
from typing import Final

from grammar import repairs
from grammar.accounts import TEXTS
from grammar.chart import TooMuch
from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.pieces import leaves
from grammar.understand import Reader
from grammar.understanding import Context, Understanding

WHEN: Final = ("delay", "rhythm")
"""The rules for what tells when or how often something is done."""
MOST_TRIED: Final = 3


def understood(
    reader: Reader, lexicon: Lexicon, language: Language, context: Context
) -> Understanding | None:
    """What the sentence means with such words moved; None if that makes none."""
    for tried, (moved, gap) in enumerate(_moved(reader)):
        if tried == MOST_TRIED:
            break
        result = repairs.understood(moved, lexicon, language, context)
        if result.plan is None:
            continue
        if not _said_over(Reader(moved, lexicon, language, context), gap):
            return result
    return None


def _moved(reader: Reader) -> Iterator[tuple[str, int]]:
    """The sentence with a time from the middle of a clause at its beginning, and where it stood."""
    tokens, text = reader.tokens, reader.text
    begins = _begins(reader.language)
    for at in range(1, len(tokens) - 1):
        if tokens[at].value is None and tokens[at].kind == "word" and tokens[at].norm not in begins:
            continue
        end = _end_of_time(reader, at)
        begin = _begin_of_clause(reader, at)
        if not end or end >= reader.last_word or begin == at or _parts(reader, end):
            continue
        first, last = tokens[begin].start, tokens[end - 1].end
        time = text[tokens[at].start : last]
        lead = f"{text[:first]}{time}, {text[first : tokens[at].start].rstrip()}"
        yield f"{lead} {text[last:].lstrip()}", len(lead)


@functools.cache
def _begins(language: Language) -> frozenset[str]:
    """The words that such a time can begin with."""
    network = language.network
    rules = {network.rule(rule) for rule in WHEN}
    return frozenset(word for word, those in network.beginning.items() if rules & those)


def _end_of_time(reader: Reader, at: int) -> int:
    """Where words that tell a time end which begin at a token; 0 if none do."""
    try:
        found = (reader.chart().longest(rule, at) for rule in WHEN)
        return max((node.end for node in found if node is not None), default=0)
    except TooMuch:
        return 0


def _parts(reader: Reader, at: int) -> bool:
    """Whether a token parts one clause from the next."""
    token = reader.tokens[at]
    return token.kind == "mark" or token.norm in reader.language.speech.get("joins", ())


def _begin_of_clause(reader: Reader, at: int) -> int:
    """The token that the clause begins with in which a token stands."""
    while at and not _parts(reader, at - 1):
        at -= 1
    return at


def _said_over(moved: Reader, gap: int) -> bool:
    """Whether words that are only to be spoken go on over where the time stood: it was a part of
    what is said."""
    tree = moved.chart().best("utterance")
    return tree is not None and any(
        leaf.slot in TEXTS and moved.tokens[leaf.start].start < gap < moved.tokens[leaf.end - 1].end
        for leaf in leaves(tree)
    )
