"""Standing orders in a conversation: "whenever somebody comes into the lobby, greet them" is to be
done each time, by an appointment; a program for it would hold the robot for ever.

| said                                        | becomes                                          |
|---------------------------------------------|--------------------------------------------------|
| whenever ..., each time ..., if ever ...    | an appointment                                   |
| when ..., as soon as ...                    | a question, where a program can be made of it    |
|                                             | and appointments are kept here; else a program   |
| whenever somebody comes ..., where none are | a program, which waits for them while it runs    |
| kept                                        |                                                  |
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import msgspec

from grammar.language import UnknownLanguage, load_language
from grammar.plan import from_data
from grammar.requests import Request
from grammar.standing_orders.orders import goes_on, said_of, standing_order
from nl2robot.knowledge import Knowledge
from nl2robot.schedule.standing import (
    Doubtful,
    choices_in,
    is_for_sure,
    may_be_each_time,
    question_in,
    trigger_of,
)
from nl2robot.schedule.telling import happening
from nl2robot.schedule.triggers import BadTrigger, possible
from nl2robot.sentences import in_language
from nl2robot.translate.outcome import Translation
from nl2robot.translate.talk import Talk

Understand = Callable[[str, Talk], Translation]
"""Understands words as an errand, in a conversation that remembers it."""


@dataclass(frozen=True)
class Each:
    """What became of a standing order: there is a translation, or words to be understood as an
    errand in their place."""

    translation: Translation | None = None
    errand: str = ""


def ordered(utterance: str, knowledge: Knowledge, language: str) -> Request | None:
    """The standing order that an utterance is, if it is one."""
    try:
        lexicon = knowledge.lexicon(language)
        return standing_order(utterance, lexicon, load_language(language))
    except UnknownLanguage:
        return None


def each_time(
    utterance: str,
    order: Request | None,
    knowledge: Knowledge,
    language: str,
    talk: Talk,
    understand: Understand,
    kept_here: bool,
) -> Each | None:
    """What becomes of a standing order, or of the answer whether one was meant. `order`: what
    `ordered` found; `kept_here`: somebody here keeps appointments. None for anything else."""
    doubtful, talk.doubtful = talk.doubtful, None
    meant = doubtful.each_time(utterance, language) if doubtful is not None else None
    if doubtful is not None and meant is not None:
        if not meant:
            return Each(errand=doubtful.utterance)
        made = _made(doubtful.order, utterance, knowledge, language, understand)
        return Each(made) if made is not None else None
    if order is None or order.happening is None:
        return None
    if not kept_here and (order.happening.what == "seen" or not is_for_sure(order.happening)):
        return None
    if is_for_sure(order.happening):
        made = _made(order, utterance, knowledge, language, understand)
        if made is not None and made.schedule is None and _is_errand(utterance, talk, understand):
            return None
        return Each(made) if made is not None else None
    if not may_be_each_time(order.happening):
        return None
    made = _made(order, utterance, knowledge, language, understand)
    if made is None or made.schedule is None:
        return None
    if not _is_errand(utterance, talk, understand):
        return Each(made)
    talk.doubtful = Doubtful(order, utterance)
    question = question_in(language)
    return Each(Translation.without_program(utterance, "clarify", question, choices_in(language)))


def _is_errand(utterance: str, talk: Talk, understand: Understand) -> bool:
    """Whether a program can be made of it as it stands."""
    return understand(utterance, talk.copy()).program is not None


def _made(
    order: Request, utterance: str, knowledge: Knowledge, language: str, understand: Understand
) -> Translation | None:
    """The order as an appointment to be approved, or why its part is not understood; None where it
    is to be done for a while and not each time."""
    assert order.happening is not None
    inner = Talk()
    inner.context = said_of(order)
    what = understand(order.sentence, inner)
    if what.plan is not None and goes_on(from_data(what.plan)):
        return None
    if what.program is None:
        if what.schedule is not None or what.request is not None:
            return None
        return msgspec.structs.replace(what, utterance=utterance)
    try:
        trigger = trigger_of(order.happening)
        if knowledge.capabilities is not None:
            places = [place.name for place in knowledge.world.places]
            trigger = possible(trigger, knowledge.capabilities.methods, places)
    except BadTrigger as error:
        message = in_language(str(error), language) or str(error)
        return Translation.without_program(utterance, "rejected", message)
    words = happening(trigger, language)
    return what.at(words, order, utterance, language, trigger=trigger)
