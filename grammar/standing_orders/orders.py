"""Standing orders: "whenever somebody comes into the lobby, greet them".

Such a sentence is also a program that goes on for ever, and holds the robot. Whoever can have
something done each time that it happens (`nl2robot.schedule`) asks here first whether it is one;
the rules of commands know nothing of these.
"""

from __future__ import annotations

from typing import Final

import grammar.meanings.all_meanings  # noqa: F401 (what the rules name is entered there)
from grammar.chart import Leaf, Node, TooMuch
from grammar.discourse import ANYONE, Discourse, Thing
from grammar.errors import Ambiguous, NotUnderstood
from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.plan import Forever, Plan, RepeatUntil, Text, While
from grammar.prepared import forget, prepared
from grammar.requests import Request
from grammar.tidy import nodes
from grammar.tokens import Token
from grammar.understanding import Context

RULE: Final = "standing_order"
LONGEST: Final = 60
"""Words; nobody says a longer one."""


def standing_order(text: str, lexicon: Lexicon, language: Language) -> Request | None:
    """What is to be done each time that something happens, if this is an order to that: a request
    of the kind "schedule" with its `happening`. None for any other sentence."""
    if RULE not in language.rules or not 0 < len(text.split()) <= LONGEST:
        return None
    if not language.words_called("standing_words") & set(language.tokens_of(text)):
        return None
    forget()
    words = prepared(text, lexicon, language)
    try:
        tree = words.chart.best(RULE)
    except (TooMuch, RecursionError):
        return None
    if tree is None or _runs_on(tree, words.tokens):
        return None
    discourse = Discourse(language, lexicon, words.tokens, words.text)
    try:
        order: Request = discourse.build(tree)
    except (Ambiguous, NotUnderstood):
        return None
    return order


def said_of(order: Request) -> Context:
    """What is known when such an order is carried out: who has come, and where that is."""
    happening = order.happening
    assert happening is not None
    person = None
    if happening.what not in ("battery", "place"):
        name = happening.thing or ANYONE
        person = Thing(Text(name), known=happening.named, person=True, here=True, noun=name)
    return Context(person=person, place=Text(happening.place) if happening.place else None)


def goes_on(plan: Plan) -> bool:
    """Whether a plan ends by itself only at some time, or never: "greet them until noon" is to be
    done for a while, and not each time."""
    return any(isinstance(each, Forever | While | RepeatUntil) for each in nodes(plan.steps))


def _runs_on(tree: Node, tokens: tuple[Token, ...]) -> bool:
    """Whether it is not certain where the order begins or ends: another sentence follows, or its
    last words may be a message that what happens belongs to."""
    part = tree.parts["sentence"]
    inside = tokens[part.start : part.end]
    if any(each.kind == "mark" and each.norm in (".", "!", "?", ";") for each in inside[:-1]):
        return True
    if not tree.production.fixed.get("after"):
        return False
    last = _last_leaf(part)
    parted = tokens[part.end].kind == "mark"
    return last is not None and last.slot == "text" and not parted


def _last_leaf(part: Leaf | Node) -> Leaf | None:
    """The leaf at the end of a part, if its last word is one's."""
    if isinstance(part, Leaf):
        return part
    at_end = [each for each in part.parts.values() if each.end == part.end]
    return _last_leaf(at_end[-1]) if at_end else None
