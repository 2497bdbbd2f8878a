"""What somebody takes back while still speaking: "bring Bob the blue cup, no, the red one".

Behind such a word stands what is meant instead, and before it, as its last part, what that takes
the place of: a person for a person, a place for a place, "to Bob" for "to Alice". Where it is not
the last part ("bring the cup to Bob, no, the plate"), the sentence so far is taken as a command and
the rest as a change to it, as in a conversation. The outcome is a whole sentence, understood anew.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator
from typing import Final

from grammar import conversation
from grammar.chart import TooMuch
from grammar.coverage import TEXTS
from grammar.distinguish import with_other_look
from grammar.edits import Sentence
from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.pieces import Piece, is_pieces, leading, leaves, pieces_at, words_listed
from grammar.reader import SentenceReader
from grammar.understanding import Context, Understanding

MOST_REPAIRS: Final = 3
"""Times that somebody puts themselves right in one sentence."""
MOST_TRIED: Final = 6
MOST_TRIED_IN_ALL: Final = 30
"""Of one sentence: with each time that somebody puts themselves right there are more ways to."""
MOST_WORDS: Final = 6
"""Words that take something back at once: "oh no sorry i meant"."""


def understood(
    text: str,
    lexicon: Lexicon,
    language: Language,
    context: Context,
    depth: int = 0,
    tried_before: list[str] | None = None,
) -> Understanding:
    """Understand a sentence of a conversation, as it was put right in the end."""
    all_tried: list[str] = [] if tried_before is None else tried_before
    reader = SentenceReader(text, lexicon, language, context)
    for start, end in taken_back(reader) if depth < MOST_REPAIRS else ():
        before = SentenceReader(reader.words(0, start), lexicon, language, context)
        end = _behind_what_was_wrong(reader, end)
        behind = SentenceReader(reader.text[reader.tokens[end].start :], lexicon, language, context)
        others = itertools.chain(
            _broken_off(before, behind),
            _named_instead(before, behind),
            _with_other_look(before, behind),
            _in_its_place(before, behind),
        )
        for tried, fixed in enumerate(others):
            if tried == MOST_TRIED or len(all_tried) >= MOST_TRIED_IN_ALL:
                break
            all_tried.append(fixed)
            result = understood(fixed, lexicon, language, context, depth + 1, all_tried)
            if result.plan is not None:
                return result
        if len(all_tried) >= MOST_TRIED_IN_ALL:
            break
        changed = _as_a_change(before, behind, reader.words(start, end), context)
        if changed is not None:
            return changed
    return conversation.understood(text, lexicon, language, context)


def taken_back(reader: SentenceReader) -> Iterator[tuple[int, int]]:
    """Where words take back what stands before them, with the marks around them."""
    tokens, at = reader.tokens, 1
    while at < len(tokens):
        parted = tokens[at - 1].kind == "mark"
        end = 0 if tokens[at].kind == "mark" else _end_of_term(reader, at, parted)
        start = at - parted
        if end and start and end < len(tokens) and not _said_aloud(reader, start, end):
            yield start, end
        at = max(end, at + 1)


def _behind_what_was_wrong(reader: SentenceReader, at: int) -> int:
    """Where it is said what is meant, if it is said once more what is not: "no, not the pharmacy,
    the lab"."""
    rest = reader.tokens[at:]
    if rest[0].norm not in reader.language.speech["taking_back"].get("not", ()):
        return at
    marks = (place for place, token in enumerate(rest, at) if token.kind == "mark")
    behind = next(marks, reader.last_word - 1) + 1
    return behind if behind < reader.last_word else at


def _broken_off(before: SentenceReader, behind: SentenceReader) -> Iterator[str]:
    """A sentence broken off at a little word, and gone on with: "go to, no wait, the lab"."""
    if before.tokens[before.last_word - 1].norm in before.language.speech.get("half_ends", ()):
        yield f"{before.text.rstrip(' ,')} {behind.text}"


def _named_instead(before: SentenceReader, behind: SentenceReader) -> Iterator[str]:
    """ "Tell Alice ..., no wait, she is away, tell Bob instead": the same for somebody else, where
    no other word of the last clause is new."""
    end = behind.last_word - 1
    if end < 1 or behind.tokens[end].norm not in before.language.speech["taking_back"]["instead"]:
        return
    marks = (at for at in range(end, 0, -1) if behind.tokens[at - 1].kind == "mark")
    begin = next(marks, 0)
    said = {token.norm for token in before.tokens}
    for start in range(begin, end):
        if not behind.is_little(range(begin, start)) and not (behind.content(begin, start) <= said):
            return
        for new in pieces_at(behind, start):
            if new.end != end or not new.known:
                continue
            for at in range(before.last_word - 1, -1, -1):
                for old in pieces_at(before, at):
                    if old.rule == new.rule and old.known:
                        yield before.with_words(old.start, old.end, behind.words(new.start, end))


def _end_of_term(reader: SentenceReader, at: int, parted: bool) -> int:
    """Where words that take something back end, with the marks in them and behind: "no, sorry,"; 0
    if there are none."""
    ends: dict[tuple[str, ...], int] = {(): at}
    said: tuple[str, ...] = ()
    for place, token in enumerate(reader.tokens[at:], at):
        if token.kind == "mark":
            ends[said] = place + 1
        elif len(said) < MOST_WORDS:
            said = (*said, token.norm)
            ends[said] = place + 1
        else:
            break
    found = [end for term, end in ends.items() if term in _terms(reader.language, "anywhere")]
    if parted:
        found += [end for term, end in ends.items() if term in _terms(reader.language, "parted")]
        found += [
            end
            for term, end in ends.items()
            if term in _terms(reader.language, "marked") and reader.tokens[end - 1].kind == "mark"
        ]
    return max(found, default=0)


@functools.cache
def _terms(language: Language, where: str) -> frozenset[tuple[str, ...]]:
    """Words that take something back "anywhere", "parted" by a comma, or "marked" on both sides."""
    listed = language.speech.get("taking_back", {}).get(where, ())
    return frozenset(map(language.tokens_of, listed))


def _said_aloud(reader: SentenceReader, start: int, end: int) -> bool:
    """Whether these words are a part of what is to be said: "tell Bob no, he must wait"."""
    try:
        tree = reader.chart().best("utterance")
    except (TooMuch, RecursionError):
        return False
    return tree is not None and any(
        leaf.slot in TEXTS and leaf.start <= start and end <= leaf.end for leaf in leaves(tree)
    )


def _with_other_look(before: SentenceReader, behind: SentenceReader) -> Iterator[str]:
    """The sentence with its last thing looking otherwise: "the blue cup, no, the red one"."""
    end = _first_mark(behind)
    look = SentenceReader(behind.words(0, end), behind.lexicon, behind.language, behind.context)
    fixed = with_other_look(Sentence(before), look, instead=True) if look.tokens else None
    if fixed is not None:
        yield fixed.rstrip(" ,") + behind.text[behind.tokens[end - 1].end :]


def _first_mark(reader: SentenceReader) -> int:
    marks = (at for at, token in enumerate(reader.tokens) if token.kind == "mark")
    return next(marks, reader.last_word)


def _in_its_place(before: SentenceReader, behind: SentenceReader) -> Iterator[str]:
    """The sentence with its last part before the words replaced by the first one behind them."""
    for new in _first_pieces(behind):
        lead, whole = leading(behind, new.start), _has_article(behind, new)
        for old in sorted(
            (old for old in _last_pieces(before) if old.rule == new.rule),
            key=lambda old: whole and not _has_article(before, old),
        ):
            old_lead = leading(before, old.start)
            if lead and not old_lead:
                continue  # "to the pharmacy" is no lab, but "to the blood lab" is its like
            first = old.start - (old_lead if lead else 0)
            if not lead and _has_article(before, old) and not whole:
                first += 1  # "the blue, no, red cup": the article stays
            kept = before.text[: before.tokens[first].start]
            said, rest = behind.words(0, new.end), behind.text[behind.tokens[new.end - 1].end :]
            until = old.replaced_until(new)
            if until < old.end:
                said = f"{said} {before.words(until, old.end)}"
            yield f"{kept}{said}{rest.lstrip(' ,') if rest.startswith(',') else rest}"
            if rest.startswith(","):
                yield f"{kept}{said} {rest.lstrip(' ,')}"


def _is_like_it(parts: SentenceReader) -> bool:
    """Whether it is another of what was spoken of: "the red one"."""
    likes = {norm for norms in words_listed(parts.language, "counted_words") for norm in norms}
    return parts.last_word > 1 and parts.tokens[parts.last_word - 1].norm in likes


def _first_pieces(behind: SentenceReader) -> list[Piece]:
    """The parts that stand first, the longest before the others."""
    starts = [at for at in range(min(4, behind.last_word)) if at == 0 or leading(behind, at) == at]
    found = [piece for start in starts for piece in pieces_at(behind, start)]
    end = _first_mark(behind)
    if not found and end < behind.last_word:  # "to the lab, and give it ..." is no list of places
        words = behind.words(0, end)
        return _first_pieces(SentenceReader(words, behind.lexicon, behind.language, behind.context))
    return sorted(found, key=lambda piece: (not piece.known, -piece.end))


def _last_pieces(before: SentenceReader) -> list[Piece]:
    """The parts that stand last, the shortest before the others."""
    end = before.last_word
    found = [
        piece
        for start in range(end - 1, -1, -1)
        for piece in pieces_at(before, start)
        if piece.end == end
    ]
    return sorted(found, key=lambda piece: (not piece.known, piece.end - piece.start))


def _has_article(reader: SentenceReader, piece: Piece) -> bool:
    """Whether a part of several words begins with a little one."""
    return piece.end - piece.start > 1 and reader.is_little(range(piece.start, piece.start + 1))


def _as_a_change(
    before: SentenceReader, behind: SentenceReader, words: str, context: Context
) -> Understanding | None:
    """What stands behind as a change to the command before, with what goes on behind it."""
    end = _first_mark(behind)
    change = behind.words(0, end)
    parts = SentenceReader(change, behind.lexicon, behind.language, context)
    if not parts.tokens or not (is_pieces(parts) or _is_like_it(parts)):
        return None
    rest = behind.text[behind.tokens[end - 1].end :]
    first = conversation.understood(before.text + rest, before.lexicon, before.language, context)
    if first.plan is None:
        return None
    plainest = next(iter(before.language.speech["taking_back"]["parted"]))
    for lead in (words.strip(" ,."), plainest):
        changed = conversation.understood(
            f"{lead} {change}", before.lexicon, before.language, first.context
        )
        if changed.plan is not None:
            return changed
    return None
