"""Orders to tell somebody what the robot finds out, or has found out before: "tell Bob how many are
waiting", "come back and tell me who said yes", "let Alice know, too"."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import msgspec

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.about_guests import host_told, who_is_told
from grammar.meanings.absences import undelivered
from grammar.meanings.answered_numbers import of_answers
from grammar.meanings.arrivals import arrival_told
from grammar.meanings.carrying import deliver
from grammar.meanings.finding import go, speak_to
from grammar.meanings.findings import found_told, summed_or_said
from grammar.meanings.lookouts import tell_lookout
from grammar.meanings.news import (
    BACK,
    News,
    Told,
    back_to_speaker,
    go_back,
    in_round,
    just_went,
    said_themselves,
    take_back,
    told_at_end,
)
from grammar.meanings.persons import is_me
from grammar.meanings.place_loops import last_round
from grammar.meanings.places import sought
from grammar.meanings.polls import said_by
from grammar.meanings.registry import meaning
from grammar.meanings.reports import (
    Report,
    counted_alone,
    found_for,
    found_out,
    gone_to_tell,
    known_words,
    retold,
    told_in_total,
)
from grammar.meanings.sent_to_tell import searched_before, sent_to
from grammar.meanings.sights import seen_around
from grammar.meanings.surveys import moved
from grammar.meanings.where_it_is import (
    asks_where,
    searched_last,
    told_to_sent,
    told_where,
    where_it_is,
)
from grammar.plan import Ask, Call, Recall, Remember, Text, Value
from grammar.texts.words import words_for
from grammar.tidy import BODIES, mentions, nodes


@meaning("report")
def report(d: Discourse, node: Node) -> Steps:
    receiver, info = node.parts.get("person_ref"), node.parts["info"]
    found: Report | Steps | None = None
    if receiver is not None and info.start < receiver.start:
        found = d.get(node, "info")  # "their" is not whom it is told to after that
    person: Thing | None = d.get(node, "person_ref")
    person_at: Where | None = d.get(node, "person_at")
    if person is not None and person_at is not None:  # "tell Bob the time in the kitchen"
        person = replace(person, place=person_at.place, here=False)
    if receiver is not None and not is_me(person) and states(d, receiver, info):
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    if person is not None and found is None:
        person = gone_to_tell(d, person)
    if found is None:
        found = d.get(node, "info")
    if isinstance(found, list):
        if receiver is not None and receiver.start < info.start:
            person = sent_to(d, person) or person
        steps = found_for(d, person, found)
        if is_me(person) and d.answers.last is not None and not mentions(steps, BACK):
            steps = [*back_to_speaker(d), *steps]
        d.reports = replace(d.reports, told=steps[-1] if steps else None)
        return steps
    fixed = node.production.fixed
    known = d.reports.news is not None and d.reports.news is d.round.present
    if known and isinstance(info, Node) and info.means == "names_here":
        return told_again(d, person)  # "see if Alice and Bob are in, and tell me who is there"
    if isinstance(info, Node) and info.production.fixed.get("total") and in_round(d):
        return told_in_total(d, found, person)
    d.reports = replace(
        d.reports,
        open=person is None and bool(fixed.get("open", not fixed.get("to_me"))),
        counts=person is None and bool(fixed.get("counted")),
    )
    return found_out(d, found, person, back=bool(fixed.get("to_me")) or is_me(person))


def states(d: Discourse, receiver: Leaf | Node, info: Leaf | Node) -> bool:
    """Whether what sounds like where somebody is and a question is what they are told, where the
    verb stands second: "sag Bob, in der Küche ist noch Milch"."""
    words = words_for(d.language)
    verb = d.tokens[info.start].norm
    finite = verb in words.finite or words.finite_pattern.search(verb) is not None
    return words.clauses and finite and info.start == receiver.end


def looks_around(d: Discourse) -> bool:
    """ "look at the desk and tell Bob what you saw": sent there to look, with nothing told."""
    untold = (
        d.reports.last is None
        and d.answers.last is None
        and d.answers.code is None
        and d.branch.claim is None
    )
    ways = [each for each in nodes(tuple(d.done)) if isinstance(each, Call)]
    return untold and isinstance(d.scene.at, Text) and [each.method for each in ways] == ["goto"]


@meaning("news")
def news(d: Discourse, node: Node) -> Steps:
    """ "come back and tell me who said yes", "announce the result in the lobby"."""
    sent = searched_before(d, node) if asks_where(node) else None
    search = searched_last(d, node, "whom") if asks_where(node) and sent is None else None
    if sent is not None:
        return told_to_sent(d, *sent)
    person: Thing | None = d.get(node, "whom")
    if (
        d.scene.thing is not None
        and d.scene.delivered == d.scene.thing.value
        and _speaks_of_it(d, node)
    ):
        return []  # "get the key from Alice and come back with it": it is here by now
    if d.answers.asked_for is not None and d.scene.thing is not None and _speaks_of_it(d, node):
        return deliver(d, replace(d.scene.thing, pronoun=True), person, None)
    if search is not None:
        return where_it_is(d, search, person)
    if asks_where(node) and (told_there := told_where(d, person)) is not None:
        return told_there
    told: list[Told] = d.get(node, "told") or [found_told(d)]
    first = [step for each in told for step in each.first]
    words = [step for each in told for step in each.words]
    fixed = node.production.fixed
    steps: Steps = list(first)
    place: Value | None = d.get(node, "at_place")
    if just_went(d) and (person is None or said_themselves(d, node, person)):
        person, place = (
            None,
            place or d.scene.at,
        )  # "go to the kitchen and tell them what each wants"
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
        d.reports = replace(d.reports, told=steps[-1])
    d.reports = replace(d.reports, news=News(words, person is None and place is None))
    return steps


def _speaks_of_it(d: Discourse, node: Node) -> bool:
    """Whether it is "it" that is brought: "ask her for the key and come back with it"."""
    told = node.parts.get("told")
    words = d.norms(told.start, told.end) if told is not None else []
    return len(words) == 1 and words[0] in d.language.speech.get("things_too", ())


@meaning("wants_to_know")
def wants_to_know(d: Discourse, node: Node) -> Steps:
    """ "Bob wants to know which labs are free, so go and tell him": told to him at last."""
    person: Thing = d.get(node, "whom")
    told: list[Told] = d.get(node, "told")
    words = [step for each in told for step in each.words]
    d.reports = replace(d.reports, news=News(words, False, waiting=True, whom=person))
    d.scene = d.scene.speaking_of_person(person)
    return [step for each in told for step in each.first]


def _shown(step: Any) -> Any:
    """What was to be said, on the screen."""
    if isinstance(step, Call) and step.method == "say":
        return Call("show", {"text": step.arguments["text"]})
    inner = {name: tuple(map(_shown, body)) for name in BODIES if (body := getattr(step, name, ()))}
    return msgspec.structs.replace(step, **inner) if inner else step


def on_screen(d: Discourse) -> Steps:
    """What was found out last, on the screen."""
    return [_shown(each) for each in found_told(d).words]


@meaning("tell_that")
def tell_that(d: Discourse, node: Node) -> Steps:
    """ "and tell Alice how many there are": what was found out before, told to somebody else."""
    if sent := searched_before(d, node):
        return told_to_sent(d, *sent)
    search = searched_last(d, node, "person_ref")
    of_answers(d, node)
    person = who_is_told(d, node)
    if search is not None and (search.person or (person is not None and not is_me(person))):
        return where_it_is(d, search, person)  # "find Alice and tell Bob"
    if node.production.fixed.get("seen") and looks_around(d):
        return found_out(d, seen_around(d), person, back=person is None or is_me(person))
    if person is not None and is_me(person):
        return coming_back(d, node, told_again(d, person))
    return told_again(d, person)


@meaning("tell_why")
def tell_why(d: Discourse, node: Node) -> Steps:
    """ "and let Bob know, so that he can go with her": what was found out; why is left as it is."""
    why = node.parts["why"]
    d.background += (d.words(why.start, why.end),)
    d.resolve(range(why.start, why.end))
    return tell_that(d, node)


@meaning("tell_me_that")
def tell_me_that(d: Discourse, node: Node) -> Steps:
    """ "and tell me": what was found out just before, brought back to the speaker."""
    if sent := searched_before(d, node):
        return told_to_sent(d, *sent)
    search = searched_last(d, node, "person_ref")
    of_answers(d, node)
    d.reports = replace(d.reports, open=False)
    if search is not None and search.person:
        return where_it_is(d, search, None)  # "find Alice and inform me"
    return coming_back(d, node, tell_speaker(d))


def coming_back(d: Discourse, node: Node, steps: Steps) -> Steps:
    """What the speaker is told; "otherwise come back to tell me" says the way back, too."""
    said = node.production.fixed.get("back") or "back" in node.parts
    if not said or not steps or BACK in steps:
        return steps
    d.came_back()
    return [BACK, *steps]


def told_again(d: Discourse, person: Thing | None) -> Steps:
    """Tell somebody what was told or answered last, or could not be told to somebody else."""
    message = undelivered(d, person)
    if message is not None:
        return message
    of_round = tell_lookout(d, person)
    if of_round is not None:
        return of_round
    if told_at_end(d, person):
        return []
    again = news_again(d, person)
    if again is not None:
        return again
    if person is None or is_me(person):
        return tell_speaker(d)
    if d.branch.claim is not None and d.branch.claim.known == d.known_by_now():
        return speak_to(d, person, [d.branch.claim.saying])
    if d.reports.last is None:
        return speak_to(d, person, known_words(d))
    return retold(d, person)


def tell_speaker(d: Discourse) -> Steps:
    of_round = tell_lookout(d, None)
    if of_round is not None:
        return of_round
    if told_at_end(d, None):
        return []
    again = news_again(d, None)
    if again is not None:
        return again
    last = d.done[-1] if d.done else None
    if last is not None and last is d.reports.told:
        return []
    if d.branch.claim is not None and d.branch.claim.known == d.known_by_now():
        return [*back_to_speaker(d), d.branch.claim.saying]
    if d.reports.last is not None and d.reports.step is last and d.scene.at is not None:
        start = d.start()
        if d.scene.at == start:
            return []
        told_there = retold(d, None)
        d.went(start)
        return [BACK, *told_there]
    if d.answers.last is None and d.answers.code is None and (come := arrival_told(d)) is not None:
        return come
    if d.answers.last is None and d.answers.code is None and d.scene.thing is not None:
        if not (isinstance(last, Call) and last.method == "find"):
            raise NotUnderstood(d.language.phrase("say_what"))
        # "find the smallest cup and tell me what it is"
        what = Ask("describe", {"thing": sought(d, d.scene.thing)})
        name = d.variable("description")
        d.went(d.start())
        return [Remember(name, what), BACK, Call("say", {"text": Recall(name)})]
    if d.answers.last is not None or d.answers.code is not None:
        words = known_words(d)
        start = d.start()
        going = d.scene.at is not None or moved([*(() if d.loops.in_loop else d.around), *d.done])
        d.went(start)
        back = Call("goto", {"place": start})
        return [back, *words] if going and last != back else words
    if isinstance(last, Call) and last.method == "say":
        return []  # it is told already
    raise NotUnderstood(d.language.phrase("say_what"))


def summed_at_end(d: Discourse) -> Steps:
    """What was counted in a round that nobody was told of: brought back to the speaker."""
    at = last_round(d)
    found: Report | None = d.reports.last
    if at is None and counted_alone(d):
        return tell_speaker(d)
    if at is None or at != len(d.done) - 1 or found is None or not d.reports.counts:
        return []
    if found.name != "count" or not any(each is d.reports.step for each in nodes(d.done[at])):
        return []
    told = summed_or_said(d, found)
    return [*told.first, *go_back(d, []), *told.words]


def news_again(d: Discourse, person: Thing | None) -> Steps | None:
    """The last news told to somebody else, too; None if there are none."""
    found: News | None = d.reports.news
    if found is None:
        return None if person is None or is_me(person) else told_where(d, person)
    if person is None or is_me(person):
        if not found.waiting and d.done[len(d.done) - len(found.words) :] == found.words:
            return []  # it is told already
        d.reports = replace(d.reports, news=replace(found, waiting=False))
        return [*go_back(d, []), *found.words]
    take_back(d, found)
    d.reports = replace(d.reports, news=replace(d.reports.news, waiting=False))
    return speak_to(d, person, found.words)


@meaning("say_it")
def say_it(d: Discourse, node: Node) -> Steps:
    """ "and say it": the answer, the code or the news of before."""
    host_told(d, node)
    person: Thing | None = d.get(node, "person_ref")
    told = node.parts.get("person_ref")
    of_whom = said_by(d, node.start if told is None else told.end, node.end)
    to_me = is_me(person) or bool(node.production.fixed.get("to_me"))
    if of_whom is not None:
        return [*go_back(d, []), *of_whom] if to_me else speak_to(d, person, of_whom)
    if to_me:
        return tell_speaker(d)
    somebody = person is not None and (person.known or person.plural or person.place is not None)
    if (
        somebody
        and (d.reports.news or d.reports.last) is not None
        and d.answers.last is None
        and d.answers.code is None
    ):
        return told_again(d, person)  # "lunch is ready; say it to Bob"
    return speak_to(d, person, known_words(d))
