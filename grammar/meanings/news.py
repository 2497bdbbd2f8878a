"""Telling what was found out on the way, at the end: who said yes and what share that is, what each
of them said, the total, which labs have no stapler.

What is to be told is a `Told`; several of them can be told together, to anybody, anywhere, spoken
or on the screen (`grammar.meanings.polls`, `rounds`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Final

import msgspec

from grammar.chart import Node, what_it_means
from grammar.discourse import START, Discourse, Steps, Thing
from grammar.meanings.finding import go, speak_to
from grammar.meanings.persons import is_me
from grammar.meanings.registry import meaning
from grammar.meanings.sent_to_tell import searched_before
from grammar.meanings.surveys import asked_yet, moved
from grammar.plan import (
    Ask,
    Call,
    If,
    Recall,
    Remember,
    Text,
    Value,
)
from grammar.tidy import BODIES, nodes

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


# --- telling


@meaning("news")
def news(d: Discourse, node: Node) -> Steps:
    """ "come back and tell me who said yes", "announce the result in the lobby"."""
    sent = searched_before(d, node) if asks_where(node) else None
    search = searched_last(d, node, "whom") if asks_where(node) and sent is None else None
    if sent is not None:
        return told_to_sent(d, *sent)
    person: Thing | None = d.get(node, "whom")
    if d.thing is not None and d.delivered == d.thing.value and _speaks_of_it(d, node):
        return []  # "get the key from Alice and come back with it": it is here by now
    if d.asked_for is not None and d.thing is not None and _speaks_of_it(d, node):
        from grammar.meanings.carrying import deliver

        return deliver(d, replace(d.thing, pronoun=True), person, None)
    if search is not None:
        return where_it_is(d, search, person)
    if asks_where(node) and (told_there := told_where(d, person)) is not None:
        return told_there
    told: list[Told] = d.get(node, "told") or [last_found(d)]
    first = [step for each in told for step in each.first]
    words = [step for each in told for step in each.words]
    fixed = node.production.fixed
    steps: Steps = list(first)
    place: Value | None = d.get(node, "at_place")
    if just_went(d) and (person is None or said_themselves(d, node, person)):
        person, place = None, place or d.at  # "go to the kitchen and tell them what each wants"
    if "back" in node.parts or (
        (person is None or is_me(person)) and place is None and not fixed.get("screen")
    ):
        steps += go_back(d, first)
    if place is not None:
        steps += go(d, place)
    if fixed.get("screen"):
        words = [_shown(each) for each in words]
    if person is not None and not is_me(person):
        steps += speak_to(d, person, words)
    else:
        steps += words
    if steps:
        d.told = steps[-1]
    d.news = News(words, person is None and place is None)
    return steps


@meaning("wants_to_know")
def wants_to_know(d: Discourse, node: Node) -> Steps:
    """ "Bob wants to know which labs are free, so go and tell him": told to him at last."""
    person: Thing = d.get(node, "whom")
    told: list[Told] = d.get(node, "told")
    words = [step for each in told for step in each.words]
    d.news = News(words, False, waiting=True, whom=person)
    d.person, d.thing_last = person, False
    return [step for each in told for step in each.first]


def _speaks_of_it(d: Discourse, node: Node) -> bool:
    """Whether it is "it" that is brought: "ask her for the key and come back with it"."""
    told = node.parts.get("told")
    words = d.norms(told.start, told.end) if told is not None else []
    return len(words) == 1 and words[0] in d.language.speech.get("things_too", ())


def asks_where(node: Node) -> bool:
    """Whether nothing is to be told but where something is: "find Bob and tell me where he is"; or
    nothing is said of what is to be told: "find Bob and let me know"."""
    told = node.parts.get("told")
    if told is None:
        return "back" not in node.parts
    first = told.parts.get("first") if isinstance(told, Node) else None
    only = isinstance(told, Node) and told.parts.keys() == {"first"}
    return (
        only
        and isinstance(first, Node)
        and first.means == "lookout_told"
        and (first.production.fixed["tell"] == "which")
    )


def searched_last(d: Discourse, node: Node, whom: str) -> Thing | None:
    """What the last step looks for, if nothing else was found out: "find Bob and let me know", but
    not "and tell me the answer"."""
    last = d.done[-1] if d.done else None
    told_to = node.parts.get(whom)
    told = node.parts.get("told")
    if told is None and told_to is not None and told_to.end < node.end - 1:
        return None
    known = (d.report, d.answer, d.code, d.claim, d.news)
    if not (isinstance(last, Call) and last.method == "find") or any(each for each in known):
        return None
    return d.thing if d.thing_last else d.person


def where_it_is(d: Discourse, sought: Thing, person: Thing | None) -> Steps:
    from grammar.meanings.reports import found_for
    from grammar.meanings.sights import located

    return found_for(d, person, located(d, sought))


def told_to_sent(d: Discourse, sought: Thing, person: Thing) -> Steps:
    """ "find Alice, then go to Bob and tell him": where she is."""
    return told_where(d, person) or where_it_is(d, sought, person)


def told_where(d: Discourse, person: Thing | None) -> Steps | None:
    """ "find out where Alice is and tell Bob": the end of a search that would have told the speaker
    (`grammar.meanings.sights.located`); None if the last step is no such search."""
    from grammar.meanings.reports import found_for

    match d.done[-1:]:
        case [If(then=(Remember(value=Ask(method="location")), back, Call(method="say")))]:
            return found_for(d, person, [d.done.pop()]) if back == BACK else None
        case _:
            return None


def just_went(d: Discourse) -> bool:
    """Whether the step before leads to a place."""
    last = d.done[-1] if d.done else None
    return isinstance(d.at, Text) and last == Call("goto", {"place": d.at})


def said_themselves(d: Discourse, node: Node, person: Thing) -> bool:
    """Whether a pronoun would stand for those who gave the answers, who know them."""
    pronoun = what_it_means(node.parts["whom"]) == "person_pronoun"
    return pronoun and asked_yet(d) and person.group is not None


def last_found(d: Discourse) -> Told:
    """What "report back" speaks of."""
    from grammar.meanings.reports import found_told

    return found_told(d)


def go_back(d: Discourse, more: Steps) -> Steps:
    """Back to who gave the command, unless the robot is there."""
    before = () if d.in_loop else d.around
    if not moved([*before, *d.done, *more]) or (d.done and not more and d.done[-1] == BACK):
        return []
    d.came_back()
    return [BACK]


def back_to_speaker(d: Discourse) -> Steps:
    """The way to who gave the command, who is to be told something: "if he has no time, tell me
    that he has none". Whoever came along is there already."""
    steps = nodes((*d.around, d.done))
    led = any(isinstance(each, Call) and each.method in ("guide", "follow") for each in steps)
    if led or d.in_loop or d.at == Recall(START):
        return []
    if d.at is None and not d.away:
        return go_back(d, [])
    d.came_back()
    return [BACK]


def _shown(step: Any) -> Any:
    """What was to be said, on the screen."""
    if isinstance(step, Call) and step.method == "say":
        return Call("show", {"text": step.arguments["text"]})
    inner = {name: tuple(map(_shown, body)) for name in BODIES if (body := getattr(step, name, ()))}
    return msgspec.structs.replace(step, **inner) if inner else step


def on_screen(d: Discourse) -> Steps:
    """What was found out last, on the screen."""
    return [_shown(each) for each in last_found(d).words]


def told_again(d: Discourse, person: Thing | None) -> Steps | None:
    """The last news told to somebody else, too; None if there are none."""
    found: News | None = d.news
    if found is None:
        return None if person is None or is_me(person) else told_where(d, person)
    if person is None or is_me(person):
        if not found.waiting and d.done[len(d.done) - len(found.words) :] == found.words:
            return []  # it is told already
        d.news = replace(found, waiting=False)
        return [*go_back(d, []), *found.words]
    take_back(d, found)
    d.news = replace(d.news, waiting=False)
    return speak_to(d, person, found.words)


def in_round(d: Discourse) -> bool:
    """Whether the robot is at one of the places that it goes round."""
    return d.in_loop and isinstance(d.at, Recall) and d.at == d.place


def told_at_end(d: Discourse, person: Thing | None) -> bool:
    """Whether what was just counted or seen is told when the round of places is done, for nobody is
    told of it at any of them: "go to every ward, count the patients and tell me how many"."""
    found = d.report
    if found is None or not in_round(d):
        return False
    if not found.about_here or found.value is None:
        return False
    if not any(each is d.report_step for each in nodes(tuple(d.done))):
        return False
    d.after_round = (person, "each")
    return True


def take_back(d: Discourse, found: News) -> None:
    """What was to be told to the speaker, because nobody else was named, is told elsewhere; the way
    back then comes to nothing."""
    if found.to_all and d.done[len(d.done) - len(found.words) :] == found.words:
        del d.done[len(d.done) - len(found.words) :]
        if d.done and d.done[-1] == BACK:
            d.done.pop()
            d.at = None
        d.news = replace(found, to_all=False, waiting=True)
    else:
        d.news = replace(found, to_all=False)


@meaning("told_list")
def told_list(d: Discourse, node: Node) -> list[Told]:
    """ "who said yes and what share that is"."""
    first: Told = d.get(node, "first")
    rest: list[Told] = d.get(node, "rest") or []
    return [first, *rest]
