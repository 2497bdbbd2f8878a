"""From a sentence to a plan, or to an honest answer why not.

    text -> said plainly -> put right -> heard after what was said before -> read: a plan

Each of these knows only those behind it (`rewordings`, `repairs`, `conversation`, `reader`). What
the name of a routine stands for is a whole sentence again, so its meaning is entered here.
"""

from __future__ import annotations

import itertools
from contextlib import suppress
from dataclasses import replace
from typing import Final

from grammar import repairs, rewordings
from grammar.chart import Node, TooMuch
from grammar.discourse import START, Discourse, Steps
from grammar.errors import NotUnderstood
from grammar.language import Language, load_language
from grammar.lexicon import Lexicon, Routine
from grammar.meanings.registry import meaning
from grammar.meanings.requests import with_own_names
from grammar.plan import Call, Plan, Text
from grammar.prepared import forget
from grammar.program_parser import NotAPlan, parse_program
from grammar.times.said import said_otherwise
from grammar.tokens import Token
from grammar.understanding import Clarification, Context, Understanding, rejected

LONGEST_TEXT: Final = 2000
"""Characters."""
MOST_WORDS: Final = 150
MOST_TRIED: Final = 3
"""Ways to put first what says when."""


def understand(
    text: str, lexicon: Lexicon, language: str = "en", context: Context | None = None
) -> Understanding:
    """Understand a sentence. Never raises for any text; `UnknownLanguage` for a language that
    there is no folder for."""
    pack = load_language(language)
    context = context or Context()
    if not text.strip():
        return rejected(text, pack.phrase("empty"), context)
    if len(text) > LONGEST_TEXT or len(text.split()) > MOST_WORDS:
        return rejected(text, pack.phrase("too_long"), context)
    forget()
    text = rewordings.said_plainly(text, lexicon, pack, context)
    try:
        understood = repairs.understood(text, lexicon, pack, context)
    except TooMuch:  # of one way to read it, and there are others that would take as long
        return rejected(text, pack.phrase("too_long"), context)
    if understood.status == "rejected":
        understood = _with_its_time_first(text, lexicon, pack, context) or understood
    return _with_quotes(understood, lexicon, language) if understood.quoted else understood


def _with_its_time_first(
    text: str, lexicon: Lexicon, language: Language, context: Context
) -> Understanding | None:
    """What says when may stand anywhere; rules know it at the beginning. None if that is not why
    nothing was understood."""
    with suppress(TooMuch):
        ways = said_otherwise(text, lexicon, language, context)
        for other, asked in itertools.islice(ways, MOST_TRIED):
            understood = repairs.understood(other, lexicon, language, context)
            if understood.plan is None:
                continue
            if asked is not None:
                return replace(
                    understood, utterance=text, plan=None, request=asked, context=context
                )
            return replace(understood, utterance=text)
    return None


def _with_quotes(understood: Understanding, lexicon: Lexicon, language: str) -> Understanding:
    """What might be meant to be said, suggested with quotation marks if that is understood."""
    quoted = understood.quoted
    tells = understand(quoted, lexicon, language).status == "ok"
    return replace(understood, suggestions=[quoted] if tells else [], quoted="")


@meaning("routine")
def routine(d: Discourse, node: Node) -> Steps:
    """A routine's name stands for the steps of its sentence, understood in the world as it is now,
    or of its program."""
    called: Routine = d.get(node, "routine")
    if not called.reviewed:
        raise NotUnderstood(d.language.phrase("routine_unreviewed", name=called.name))
    plan = _plan_of(called, d)
    if d.needs_start or node.end < len(d.tokens) - 1:
        d.variables |= {START}  # the sentence around may need the name
    steps = with_own_names(d, plan)
    d.scene = replace(d.scene, at=None, place=None, thing=None, person=None, with_person=None)
    if steps and isinstance(steps[-1], Call) and steps[-1].method == "goto":
        place = steps[-1].arguments.get("place")
        if isinstance(place, Text):
            d.went(place)
    return steps


def _plan_of(called: Routine, d: Discourse) -> Plan:
    """What a routine does. In there the routine itself is unknown, so that none can go round in
    circles. Raises `NotUnderstood`."""
    if called.program:
        try:
            return parse_program(called.program, d.language.code)
        except NotAPlan as error:
            raise _broken(called, d, str(error)) from None
    others = tuple(each for each in d.lexicon.routines if each.name != called.name)
    inner = understand(called.sentence, replace(d.lexicon, routines=others), d.language.code)
    if inner.plan is None:
        raise _broken(called, d, inner.message or d.language.phrase("not_understood_at_all"))
    if inner.confidence < 1:
        d.assumptions += (called.name,)
    return inner.plan


def _broken(called: Routine, d: Discourse, reason: str) -> NotUnderstood:
    return NotUnderstood(d.language.phrase("routine_broken", name=called.name, reason=reason))


__all__ = ["Clarification", "Context", "Token", "Understanding", "understand"]
