"""Which words of a sentence say when, wherever they stand: before what is to be done, behind it, or
in its middle ("fahr jeden Morgen um acht in die Lobby").

They are found by the same rules that read them at the beginning of a sentence, and taken out: the
rest says what is to be done.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from typing import Final

from grammar.chart import Chart, Node, TooMuch
from grammar.coverage import TEXTS
from grammar.discourse import Discourse
from grammar.errors import NotUnderstood
from grammar.language import Language, load_language
from grammar.lexicon import Lexicon
from grammar.meanings.amounts import moment_said, time_meant
from grammar.meanings.requests import A_MINUTE
from grammar.pieces import leaves
from grammar.plan import Call, Plan, Remember, Step, Text
from grammar.planning.by_the_clock import by_the_clock
from grammar.reader import SentenceReader
from grammar.requests import Request, When
from grammar.understanding import Context

_SETS: Final = ("set_times", "set_day", "delay")
"""The rules that say when."""
_AGAIN: Final = "set_times"
_MOMENTS: Final = ("day_time", "at_time")
_MARKS: Final = " ,:;"


@dataclass(frozen=True)
class Said:
    """Some words of a sentence that say when, and the others."""

    part: str
    rest: str
    node: Node


@dataclass(frozen=True)
class Later:
    """What is to be done later, once."""

    request: Request
    when: When
    waits: tuple[Step, ...]
    """The steps of its plan that wait for that."""
    steps: tuple[Step, ...]
    """What is left of it."""

    def waits_until(self, moment: datetime) -> bool:
        """Whether its plan waits for that time of day, too: at "9", said in the evening, it waits
        for the morning."""
        match self.waits[-1]:
            case Call(method="wait_until", arguments=arguments):
                return arguments["time"] == Text(f"{moment:%H:%M}")
            case _:
                return True


def times_said(reader: SentenceReader) -> Iterator[Said]:
    """The words that say when, the longest first."""
    chart = reader.chart()
    spans = sorted(
        (
            (start - end, start, rule)
            for rule in _SETS
            if rule in reader.language.rules  # not in every language that somebody added
            for start in range(reader.last_word)
            for end in _ends(chart, rule, start)
        ),
    )
    for length, start, rule in spans:
        end = start - length
        if reader.opened(start) or reader.opened(end):
            continue  # within a contraction
        if start in reader.skips or end - 1 in reader.skips:
            continue  # "please" is no part of it
        node = chart.reading(rule, start, end)
        before = reader.text[: reader.tokens[start].start].strip(_MARKS)
        behind = reader.text[reader.tokens[end - 1].end :].strip(_MARKS)
        rest = f"{before} {behind}".strip()
        if reader.content(0, start) or reader.content(end, reader.last_word):
            yield Said(reader.words(start, end), rest, node)


def said_otherwise(
    text: str, lexicon: Lexicon, language: Language, context: Context
) -> Iterator[tuple[str, Request | None]]:
    """For a sentence of which nothing was understood, what may be instead: what is to be done
    alone, with the request to do it at the times that were said; or the sentence with its moment at
    the beginning, where rules know it."""
    reader = SentenceReader(text, lexicon, language, context)
    for said in times_said(reader):
        if said.node.means == _AGAIN:
            d = Discourse(language, lexicon, reader.tokens, reader.text)
            with suppress(NotUnderstood):
                when = d.build(said.node)
                yield said.rest, Request("schedule", sentence=said.rest, part=said.part, when=when)
        elif said.node.means in _MOMENTS and not text.startswith(said.part):
            if _of_a_text(reader, said):
                continue  # "tell Bob the meeting is at noon, ..."
            yield f"{said.part} {said.rest}", None


def _of_a_text(reader: SentenceReader, said: Said) -> bool:
    """Whether the words stand within words to be spoken, or go on with them."""
    rest = SentenceReader(said.rest, reader.lexicon, reader.language, Context())
    try:
        tree = rest.chart().best("utterance")
    except (TooMuch, RecursionError):
        return True
    at = said.node.start
    parted = at == 0 or reader.tokens[at - 1].kind == "mark"
    return tree is not None and any(
        leaf.slot in TEXTS
        and leaf.start < at
        and (at < leaf.end or (at == leaf.end and not parted))
        for leaf in leaves(tree)
    )


def begun_by(text: str, lexicon: Lexicon, language: str, plan: Plan) -> Later | None:
    """What is to be done later, once, where a sentence says when and its plan begins with waiting
    for that: "tomorrow at eight go to the lobby". None for any other."""
    kept = tuple(itertools.takewhile(lambda step: isinstance(step, Remember), plan.steps))
    steps = plan.steps[len(kept) :]
    if not (steps and isinstance(steps[0], Call) and steps[0].method in ("wait", "wait_until")):
        return None
    reader = SentenceReader(text, lexicon, load_language(language), Context())
    for said in times_said(reader):
        discourse = Discourse(reader.language, lexicon, reader.tokens, reader.text)
        try:
            waits = _waits(discourse, said.node)
        except NotUnderstood:
            continue
        if waits and steps[: len(waits)] == waits and len(steps) > len(waits):
            when = _when(discourse, said.node)
            asked = Request("schedule", sentence=said.rest, part=said.part, when=when)
            return Later(asked, when, waits, (*kept, *steps[len(waits) :]))
    return None


def time_in(text: str, language: str) -> str | None:
    """The time of day that is all that some words say, such as an answer; None if it is not, or if
    it may be twelve hours off."""
    pack = load_language(language)
    reader = SentenceReader(text, Lexicon(), pack, Context())
    chart = reader.chart()
    for start in range(reader.last_word):
        if not reader.is_little(range(start)):
            return None
        if reader.last_word in _ends(chart, "clock_time", start):
            node = chart.reading("clock_time", start, reader.last_word)
            discourse = Discourse(pack, reader.lexicon, reader.tokens, reader.text)
            try:
                time, bare = time_meant(discourse, node, once=False)
            except NotUnderstood:
                return None
            return None if bare else time
    return None


def _waits(d: Discourse, node: Node) -> tuple[Step, ...]:
    """The steps that wait for what a `<delay>` says; none for what is no moment."""
    if node.means not in ("wait", "day_time", "at_time"):
        return ()
    return by_the_clock(Plan(tuple(d.build(node)), d.language.code)).steps


def _when(d: Discourse, node: Node) -> When:
    if node.means == "wait":
        return When(minutes=float(d.get(node, "seconds")) / A_MINUTE)
    return moment_said(d, node)


def _ends(chart: Chart, rule: str, start: int) -> list[int]:
    try:
        return chart.ends(rule, start)
    except (TooMuch, RecursionError):
        return []
