"""News: what was found out on the way and is told at the end, to the speaker or somebody else.

What is to be told is a `Told` (`grammar.meanings.findings` makes it of whatever was found out);
several of them can be told together, to anybody, anywhere, spoken or on the screen
(`grammar.meanings.orders_to_tell`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from grammar.chart import Node, what_it_means
from grammar.discourse import START, Discourse, Steps, Thing
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import asked_yet, moved
from grammar.plan import (
    Call,
    Recall,
    Text,
)
from grammar.tidy import nodes

BACK: Final = Call("goto", {"place": Recall(START)})


@dataclass(frozen=True)
class Told:
    """Something to tell."""

    words: Steps
    """What says it."""
    first: Steps
    """What finds it out, before the robot goes to those whom it tells."""


@dataclass(frozen=True)
class News:
    """What was told last, so that it can be told to others."""

    words: Steps
    to_all: bool
    """Whether nobody was named whom to tell, so that whoever is named next is who was meant."""
    waiting: bool = False
    """Whether it is not told yet."""
    whom: Thing | None = None
    """Who wants to know it, if that was said before it was said to tell them."""


def just_went(d: Discourse) -> bool:
    """Whether the step before leads to a place."""
    last = d.done[-1] if d.done else None
    return isinstance(d.scene.at, Text) and last == Call("goto", {"place": d.scene.at})


def said_themselves(d: Discourse, node: Node, person: Thing) -> bool:
    """Whether a pronoun would stand for those who gave the answers, who know them."""
    pronoun = what_it_means(node.parts["whom"]) == "person_pronoun"
    return pronoun and asked_yet(d) and person.group is not None


def go_back(d: Discourse, more: Steps) -> Steps:
    """Back to who gave the command, unless the robot is there."""
    before = () if d.loops.in_loop else d.around
    if not moved([*before, *d.done, *more]) or (d.done and not more and d.done[-1] == BACK):
        return []
    d.came_back()
    return [BACK]


def back_to_speaker(d: Discourse) -> Steps:
    """The way to who gave the command, who is to be told something: "if he has no time, tell me
    that he has none". Whoever came along is there already."""
    steps = nodes((*d.around, d.done))
    led = any(isinstance(each, Call) and each.method in ("guide", "follow") for each in steps)
    if led or d.loops.in_loop or d.scene.at == Recall(START):
        return []
    if d.scene.at is None and not d.scene.away:
        return go_back(d, [])
    d.came_back()
    return [BACK]


def in_round(d: Discourse) -> bool:
    """Whether the robot is at one of the places that it goes round."""
    return d.loops.in_loop and isinstance(d.scene.at, Recall) and d.scene.at == d.scene.place


def told_at_end(d: Discourse, person: Thing | None) -> bool:
    """Whether what was just counted or seen is told when the round of places is done, for nobody is
    told of it at any of them: "go to every ward, count the patients and tell me how many"."""
    found = d.reports.last
    if found is None or not in_round(d):
        return False
    if not found.about_here or found.value is None:
        return False
    if not any(each is d.reports.step for each in nodes(tuple(d.done))):
        return False
    d.reports = replace(d.reports, after_round=(person, "each"))
    return True


def take_back(d: Discourse, found: News) -> None:
    """What was to be told to the speaker, because nobody else was named, is told elsewhere; the way
    back then comes to nothing."""
    if found.to_all and d.done[len(d.done) - len(found.words) :] == found.words:
        del d.done[len(d.done) - len(found.words) :]
        if d.done and d.done[-1] == BACK:
            d.done.pop()
            d.scene = replace(d.scene, at=None)
        d.reports = replace(d.reports, news=replace(found, to_all=False, waiting=True))
    else:
        d.reports = replace(d.reports, news=replace(found, to_all=False))


@meaning("told_list")
def told_list(d: Discourse, node: Node) -> list[Told]:
    """ "who said yes and what share that is"."""
    first: Told = d.get(node, "first")
    rest: list[Told] = d.get(node, "rest") or []
    return [first, *rest]


def not_back_yet(d: Discourse) -> None:
    """What was to be told to the speaker is told elsewhere: the way back comes to nothing."""
    if d.done and d.done[-1] == BACK:
        d.done.pop()
        d.scene = replace(d.scene, at=None)
