"""Words that would be taken for something else, said plainly: "tell everybody that lunch is ready,
except Clara" is "tell everybody except Clara that lunch is ready".

They are written down once, as data, in the template language of the rules:

    rewordings:
      - say: "if <someone> is {so} at <clock_time:then> ,"
        instead: "at <then>, if <someone> is {so},"
        where: begin                       # of a clause; or "end", or "clause": all of one
        like: {"If Bob is in at nine, wave": "At nine, if Bob is in, wave"}

`<rule>` is whatever a rule understands, as much of it as it can; `{so}` are words up to the next
mark, as few as will do. A sentence is said so before it is read. `like` shows what an entry is good
for, and the tests hold it to that.
"""

from __future__ import annotations

import functools
import itertools
from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Final, Literal

from grammar.chart import TooMuch
from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.network import RuleError
from grammar.reader import SentenceReader
from grammar.templates import NOTHING, Choice, Part, Sequence, Template, Word, parse_template
from grammar.tokens import words_of_template
from grammar.understanding import Context

MOST: Final = 4
"""Times that one sentence is said otherwise."""
MOST_WORDS: Final = 9
"""Words that `{so}` may stand for."""

CLAUSE_BEGINS: Final = ("begin", "clause")
ANY_WORD: Final = ""
"""What a part may begin with."""

Spans = Mapping[str, tuple[int, int]]
"""The tokens that each part of a template stands for."""


@dataclass(frozen=True)
class Rewording:
    say: Template
    instead: str
    where: Literal["anywhere", "begin", "end", "clause"]
    """Whether it begins a clause, ends one, or is one."""


def said_plainly(text: str, lexicon: Lexicon, language: Language, context: Context) -> str:
    """The sentence without words that would be taken for something else."""
    listed = _listed(language)
    if ANY_WORD not in listed and listed.keys().isdisjoint(language.tokens_of(text)):
        return text
    reader = SentenceReader(text, lexicon, language, context)
    return [text, *_reworded(reader, listed)][-1]


def _reworded(
    reader: SentenceReader, rewordings: Mapping[str, tuple[Rewording, ...]]
) -> Iterator[str]:
    for _ in range(MOST):
        text = next(_matches(reader, rewordings), None)
        if text is None:
            return
        yield text
        reader = SentenceReader(text, reader.lexicon, reader.language, reader.context)


@functools.cache
def _listed(language: Language) -> Mapping[str, tuple[Rewording, ...]]:
    """The rewordings by the words that they begin with."""
    listed: dict[str, list[Rewording]] = defaultdict(list)
    for entry in language.rewordings:
        unknown = entry.keys() - {"say", "instead", "where", "like"}
        if unknown:
            raise RuleError(f"a rewording has {', '.join(sorted(unknown))}")
        ways = entry["say"] if isinstance(entry["say"], list) else [entry["say"]]
        for say in ways:
            one = Rewording(
                _normal(parse_template(say), language),
                entry["instead"],
                entry.get("where", "anywhere"),
            )
            first_words = _first_words(one.say)
            if ANY_WORD in first_words and one.where not in CLAUSE_BEGINS:
                raise RuleError(f"the rewording {say!r} has to begin with words, or a clause")
            for first in first_words:
                listed[first].append(one)
    return {first: tuple(those) for first, those in listed.items()}


def _normal(template: Template, language: Language) -> Template:
    """A template with its words as they are compared."""
    match template:
        case Word(text):
            words = tuple(map(Word, words_of_template(text, language.spelling)))
            return words[0] if len(words) == 1 else Sequence(words)
        case Sequence(parts):
            return Sequence(tuple(_normal(part, language) for part in parts))
        case Choice(alternatives):
            ways = [_normal(each, language) for each in alternatives]
            return Choice(tuple(sorted(ways, key=lambda each: each == NOTHING)))  # the longer first
        case Part():
            return template


def _first_words(template: Template) -> frozenset[str]:
    first, empty = _begins(template)
    if empty:
        raise RuleError(f"a rewording may not be empty: {template}")
    return first


def _begins(template: Template) -> tuple[frozenset[str], bool]:
    """The words that a template can begin with, and whether it can be empty."""
    match template:
        case Word(text):
            return frozenset({text}), False
        case Part():
            return frozenset({ANY_WORD}), False
        case Choice(alternatives):
            found = [_begins(each) for each in alternatives]
            words = frozenset(itertools.chain.from_iterable(words for words, _ in found))
            return words, any(empty for _, empty in found)
        case Sequence(parts):
            first: frozenset[str] = frozenset()
            for part in parts:
                words, empty = _begins(part)
                first |= words
                if not empty:
                    return first, False
            return first, True


def _matches(
    reader: SentenceReader, rewordings: Mapping[str, tuple[Rewording, ...]]
) -> Iterator[str]:
    """The sentence with the first of them replaced."""
    for at, token in enumerate(reader.tokens):
        begins = _begins_clause(reader, at)
        anything = rewordings.get(ANY_WORD, ()) if begins else ()
        for one in (*rewordings.get(token.norm, ()), *anything):
            if one.where in CLAUSE_BEGINS and not begins:
                continue
            for end, spans in _walk(one.say, reader, at, {}):
                if one.where in ("end", "clause") and not _ends_clause(reader, end):
                    continue
                yield _replaced(reader, at, end, one, spans)


def _begins_clause(reader: SentenceReader, at: int) -> bool:
    joins = reader.language.speech.get("joins", ())
    return at == 0 or reader.tokens[at - 1].kind == "mark" or reader.tokens[at - 1].norm in joins


def _ends_clause(reader: SentenceReader, end: int) -> bool:
    marks = (token.kind == "mark" for token in reader.tokens[end - 1 : end + 1])
    return end >= len(reader.tokens) or any(marks)


def _walk(
    template: Template, reader: SentenceReader, at: int, spans: Spans
) -> Iterator[tuple[int, Spans]]:
    """Where a template that begins at a token can end, and what its parts stand for."""
    tokens = reader.tokens
    match template:
        case Word(text):
            if at < len(tokens) and tokens[at].norm == text:
                yield at + 1, spans
        case Choice(alternatives):
            for each in alternatives:
                yield from _walk(each, reader, at, spans)
        case Sequence(()):
            yield at, spans
        case Sequence((first, *rest)):
            for end, found in _walk(first, reader, at, spans):
                yield from _walk(Sequence(tuple(rest)), reader, end, found)
        case Part(name, binding, True):
            for end in _ends(reader, name, at):
                yield end, {**spans, binding or name: (at, end)}
        case Part(name):
            for end in range(at + 1, min(at + MOST_WORDS, len(tokens)) + 1):
                if tokens[end - 1].kind == "mark":
                    return
                yield end, {**spans, name: (at, end)}


def _ends(reader: SentenceReader, rule: str, at: int) -> list[int]:
    try:
        return reader.chart().ends(rule, at) if at < len(reader.tokens) else []
    except (TooMuch, RecursionError):
        return []


def _replaced(reader: SentenceReader, start: int, end: int, one: Rewording, spans: Spans) -> str:
    words = one.instead
    for name, (first, last) in spans.items():
        said = _said(reader, first, last)
        words = words.replace(f"<{name}>", said).replace(f"{{{name}}}", said)
    before = reader.text[: reader.tokens[start].start]
    if reader.opened(start):  # what stands before a part of a contraction: "he" of "he's"
        before += f"{reader.opened(start)} "
    rest = reader.text[reader.tokens[end - 1].end :]
    return f"{before}{words}{_left_of_contraction(reader, end)}{rest}"


def _said(reader: SentenceReader, first: int, last: int) -> str:
    """The words of some tokens; a part of a contraction in full."""
    if reader.opened(first) or _left_of_contraction(reader, last):
        return " ".join(token.norm for token in reader.tokens[first:last])
    return reader.words(first, last)


def _left_of_contraction(reader: SentenceReader, end: int) -> str:
    begin = reader.tokens[end - 1].start
    rest = itertools.takewhile(lambda token: token.start == begin, reader.tokens[end:])
    return "".join(f" {token.norm}" for token in rest)
