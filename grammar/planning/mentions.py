"""What a sentence speaks of, as far as the names and the noun phrases of the language tell.

The rules of a language read noun phrases and quantities well, whatever is said around them: "den
roten Hefter aus Bobs Büro" is a "red stapler", and "bob's office"; "anderthalb Minuten" are 90
seconds. Each of these is a mention, with the literal that a program would hold.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

from grammar.chart import Chart, Node, TooMuch
from grammar.discourse import Discourse, Thing
from grammar.errors import Ambiguous, NotUnderstood
from grammar.lexicon import kind_of
from grammar.plan import Ask, Text
from grammar.reader import SentenceReader
from grammar.slips import command_words

Sort = (
    Literal["place", "kind", "person", "thing", "furniture", "contact", "gesture", "emotion"]
    | Literal["joint", "skill", "language", "url", "selector"]
    | Literal["seconds", "metres", "degrees", "percent", "times", "number", "time"]
)

_READ: Final[dict[str, Sort]] = {
    "place_ref": "place",
    "all_places": "kind",
    "person_ref": "person",
    "counted": "thing",
    "thing": "thing",
    "duration": "seconds",
    "length": "metres",
    "angle": "degrees",
    "percentage": "percent",
    "times": "times",
    "clock_time": "time",
}
"""Rules whose readings are mentions."""
_LISTED: Final[dict[str, Sort]] = {
    "kind": "kind",
    "kinds": "kind",
    "furniture": "furniture",
    "contact": "contact",
    "gesture": "gesture",
    "emotion": "emotion",
    "joint": "joint",
    "skill": "skill",
    "language": "language",
    "number": "number",
    "url": "url",
    "selector": "selector",
}
"""Slots whose matches are."""
MOST_TOKENS: Final = 8
_DEAREST: Final[dict[Sort, float]] = {"thing": 3.3, "place": 1.6, "person": 1.6, "kind": 1.6}
_DEAREST_QUANTITY: Final = 1.2
"""Costs up to which a reading counts."""
_MISSPELT: Final = 4.7
"""The same of a name with a misspelt word."""


@dataclass(frozen=True)
class Mention:
    start: int
    end: int
    """The tokens."""
    sort: Sort
    value: str
    """The literal: a name in the world's spelling, a noun phrase, a number in the robot's unit."""
    words: str
    """As it was said."""
    cost: float = 0.0
    """How far-fetched it is."""


def mentions(reader: SentenceReader) -> tuple[Mention, ...]:
    """All mentions of a sentence, also those that exclude each other, in the order of their words;
    of the same words and sort the likeliest first."""
    found: dict[tuple[int, int, Sort, str], Mention] = {}
    own = (*_listed(reader), *_read(reader), *_written_times(reader), *_single_units(reader))
    for mention in (*own, *_tails(reader, own)):
        key = (mention.start, mention.end, mention.sort, mention.value)
        if key not in found or mention.cost < found[key].cost:
            found[key] = mention
    return tuple(sorted(found.values(), key=lambda each: (each.start, -each.end, each.cost)))


def _listed(reader: SentenceReader) -> Iterator[Mention]:
    for at in range(len(reader.tokens)):
        for slot, sort in _LISTED.items():
            for end, cost, value in reader.slots.matches("{" + slot + "}", at):
                for each in _values(value):
                    yield Mention(at, end, sort, each, reader.words(at, end), cost)


def _tails(reader: SentenceReader, found: Sequence[Mention]) -> Iterator[Mention]:
    """The places of which only the end of the name is said, behind others of their kind: "rooms 21
    and 22"; and those of which only a long number is said: "Bob in 106"."""
    before: list[tuple[int, str]] = [
        (each.end, each.value) for each in found if each.sort in ("place", "kind")
    ]
    for at in range(1, len(reader.tokens)):
        for end, cost, names in reader.slots.matches("{place_tail}", at):
            long = end == at + 1 and len(reader.tokens[at].norm) >= 3 and reader.tokens[at].value
            for name in names if isinstance(names, tuple) else ():
                alike = {
                    each.name for each in reader.lexicon.places if kind_of(each) == kind_of(name)
                }
                alike.add(kind_of(name) or "")
                behind = any(last in range(at - 2, at + 1) and it in alike for last, it in before)
                if behind or (long and len(names) == 1):
                    yield Mention(at, end, "place", name.name, reader.words(at, end), cost + 1.0)
                    before.append((end, name.name))


def _single_units(reader: SentenceReader) -> Iterator[Mention]:
    """Lengths of time that are said without a number: "every hour", "the next minute"."""
    units: Mapping[str, float] = reader.language.numbers.get("units_of_time", {})
    for at, token in enumerate(reader.tokens):
        if token.norm in units:
            words = reader.words(at, at + 1)
            yield Mention(at, at + 1, "seconds", written(units[token.norm]), words, 1.0)
            for number, start in _fractions_before(reader, at):
                span = start, at + 1
                value = written(number * units[token.norm])
                yield Mention(*span, "seconds", value, reader.words(*span), 0.5)


def _fractions_before(reader: SentenceReader, at: int) -> Iterator[tuple[float, int]]:
    """Numbers that stand up to two words before a unit: "a quarter of an hour"."""
    for start in range(max(0, at - 4), at):
        for end, _, value in reader.slots.matches("{number}", start):
            if at - 2 <= end < at and 0 < value < 1:
                yield value, start


def _written_times(reader: SentenceReader) -> Iterator[Mention]:
    """Times that are written in figures as no rule reads them: "11.30", "11h30", "9h"."""
    for match in _TIME.finditer(reader.text):
        inside = [
            at
            for at, token in enumerate(reader.tokens)
            if match.start() <= token.start and token.end <= match.end()
        ]
        hour, minute = int(match[1]), int(match[2] or match[3] or 0)
        if inside and hour < 24 and minute < 60:
            span = inside[0], inside[-1] + 1
            yield Mention(*span, "time", f"{hour:02d}:{minute:02d}", reader.words(*span), 0.0)


_TIME: Final = re.compile(r"(?<![\d.,:])(\d{1,2})(?:[.:](\d{2})|\s?h\s?(\d{2})?)(?![\d.,:])")


def _values(value: Any) -> Iterator[str]:
    """The names that a match of a slot stands for."""
    value = getattr(value, "value", value)  # of misspelt words
    for each in value if isinstance(value, tuple) else (value,):
        yield written(each) if isinstance(each, float | int) else str(getattr(each, "name", each))


def written(number: float) -> str:
    """A number as programs hold it."""
    return f"{number:.10g}"


def _read(reader: SentenceReader) -> Iterator[Mention]:
    chart = reader.chart()
    known = {name for name in _READ if name in chart.network.names}
    try:
        for at, token in enumerate(reader.tokens):
            if token.kind == "mark":
                continue
            for rule in known:
                for end in chart.ends(rule, at):
                    if end - at <= MOST_TOKENS and reader.tokens[end - 1].kind != "mark":
                        yield from _meant(reader, chart, rule, at, end)
    except TooMuch:
        return


def _meant(reader: SentenceReader, chart: Chart, rule: str, at: int, end: int) -> Iterator[Mention]:
    node = chart.reading(rule, at, end)
    sort = _READ[rule]
    if node.cost > _MISSPELT or (sort == "thing" and _is_no_noun(reader, at, end)):
        return
    value = _value(reader, node)
    if not value:
        return
    named = sort in ("place", "person") and bool(node.corrections) and _is_name(reader, value)
    if named or node.cost <= _DEAREST.get(sort, _DEAREST_QUANTITY):
        yield Mention(at, end, sort, value, reader.words(at, end), node.cost)


def _is_name(reader: SentenceReader, value: str) -> bool:
    return any(each.name == value for each in (*reader.lexicon.places, *reader.lexicon.people))


def _is_no_noun(reader: SentenceReader, at: int, end: int) -> bool:
    """Whether words that may be a noun are an order, or none that anybody means."""
    norms = [token.norm for token in reader.tokens[at:end]]
    orders = command_words(reader.language)
    return all(norm in reader.language.closed or norm in orders for norm in norms)


def _value(reader: SentenceReader, node: Node) -> str:
    """The literal of a reading; "" where it has none."""
    discourse = Discourse(reader.language, reader.lexicon, reader.tokens, reader.text)
    try:
        meant = discourse.build(node)
    except (NotUnderstood, Ambiguous):
        return ""
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        return ""  # a rule that needs more than its own words
    match meant:
        case Text(value=text) | Thing(value=Text(value=text)):
            return text
        case Ask(method="places", arguments={"kind": Text(value=text)}):
            return text
        case str():
            return meant
        case int() | float():
            return written(meant)
        case _:
            return ""
