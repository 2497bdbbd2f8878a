"""What was found out, as something that can be told: "the result", "the total", "who said yes",
"where you saw one", "how many there are in the lobby". Each gives a `grammar.meanings.news.Told`.
"""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing, as_value
from grammar.meanings.answers import Said
from grammar.meanings.lookouts import (
    Lookout,
    another_meant,
    found_before_coming_back,
    looked_on_visits,
    told_of_lookout,
    told_of_search,
    where_met,
)
from grammar.meanings.news import News, Told, in_round, not_back_yet, take_back
from grammar.meanings.place_loops import last_round, round_of_visits
from grammar.meanings.places import kind_places
from grammar.meanings.polls import polled, said_in
from grammar.meanings.questions import ask_everybody_here
from grammar.meanings.registry import meaning
from grammar.meanings.reports import Report, known_words, saying_of
from grammar.meanings.rounds import around, found_on_round, summed_up
from grammar.meanings.sights import counted_there, who_came
from grammar.meanings.surveys import asked_yet, in_loop
from grammar.plan import Call, Recall, Remember


@meaning("found_told")
def found_told(d: Discourse, node: Node | None = None) -> Told:
    """ "the result", "it", "what you found out": whatever was found out last, which is also what
    "report back" speaks of."""
    many = node is not None and bool(node.production.fixed.get("many"))
    of_round = told_of_lookout(d, many)
    if of_round is not None:
        return of_round
    told: News | None = d.reports.news
    if told is not None:
        take_back(d, told)
        return Told(told.words, [])
    if d.reports.last is not None:
        return _report_again(d)
    if d.answers.last is not None and d.answers.surveys:
        each = "many" if many else d.answers.polled_for or "each"
        return polled(d, each if in_loop(d, d.answers.surveys[-1].call) else "answers", None)
    return Told(known_words(d), [])


def _report_again(d: Discourse) -> Told:
    """The last report, which then is told only as is said now."""
    found: Report = d.reports.last
    at = next((at for at, step in enumerate(d.done) if step is d.reports.step), None)
    if at is None:
        return summed_or_said(d, found)
    if found.value is not None and not isinstance(found.value, Recall):
        name = d.variable(found.name)
        d.done[at] = Remember(name, found.value)
        found = replace(found, value=Recall(name))
    elif at == len(d.done) - 1:
        d.done.pop()
        not_back_yet(d)
    return Told([saying_of(d, found)], [])


def summed_or_said(d: Discourse, found: Report) -> Told:
    """What was counted in each place of a round; else the report as it is."""
    if found.name == "count" and last_round(d) is not None:
        return summed_up(d, "each")
    return Told([saying_of(d, found)], [])


@meaning("report_told")
def report_told(d: Discourse, node: Node) -> Told:
    """ "how many people are in the lobby", "what time it is", as one of several things to tell."""
    found: Report | Steps = d.get(node, "info")
    return Told(found, []) if isinstance(found, list) else told_report(d, found)


def told_report(d: Discourse, found: Report) -> Told:
    if (of_round := found_on_round(d, found)) is not None:
        return of_round
    first: Steps = []
    if found.place is not None and found.place != d.scene.at:
        first.append(Call("goto", {"place": found.place}))
        d.went(found.place)
    if found.about_here and found.value is not None:
        name = d.variable(found.name)
        first.append(Remember(name, found.value))
        found = replace(found, value=Recall(name))
    return Told([saying_of(d, found)], first)


@meaning("counted_too")
def counted_too(d: Discourse, node: Node) -> Told:
    """ "tell me how many people are in the kitchen and how many in the lobby"."""
    return told_report(d, counted_there(d, node))


@meaning("poll")
def poll(d: Discourse, node: Node) -> Told:
    """What was answered: of all, or of those who gave one answer."""
    kind, said = str(node.production.fixed["kind"]), said_in(d, node)
    if "it" in node.production.fixed and not asked_yet(d):
        return who_it_is(d, node)
    if kind in ("each", "answers") and (
        d.reports.last is not None or d.reports.counted is not None
    ):
        return found_told(d)  # "the numbers": what was counted
    if said is not None and kind in ("who", "many", "share") and not asked_yet(d):
        return polled_now(d, kind, said)
    return polled(d, kind, said)


def who_it_is(d: Discourse, node: Node) -> Told:
    """ "who it is", where nobody was asked anything: whoever has come."""
    return told_report(d, who_came(d, node))


def polled_now(d: Discourse, kind: str, said: Said) -> Told:
    """ "find out who wants coffee": everybody here is asked."""
    d.done += ask_everybody_here(d, said.start, said.end)
    return polled(d, kind, None)


@meaning("round_told")
def round_told(d: Discourse, node: Node) -> Told:
    """ "the total", "how many cups there are in each", "where most are"."""
    thing: Thing | None = d.get(node, "thing")
    kind = str(node.production.fixed["kind"])
    nothing_yet = d.reports.counted is None and d.reports.last is None and last_round(d) is None
    if nothing_yet and thing is not None:
        round_of_visits(d)  # "go to the lobby and the hall and tell me how many there are in all"
    if thing is not None and "kind" in node.parts and nothing_yet:
        # "tell me which ward has the fewest beds": to count them is left to do
        return around(d, kind, thing, kind_places(d, d.get(node, "kind")))
    counted_here = (
        d.reports.last is not None and d.reports.last.name == "count" and last_round(d) is None
    )
    if kind in ("total", "each") and d.reports.counted is None and counted_here:
        return found_told(d)  # "count the patients and tell me the total", in one place
    return summed_up(d, kind, thing)


@meaning("lookout_told")
def lookout_told(d: Discourse, node: Node) -> Told:
    """ "whether there is one", "where you saw one": of what was looked for."""
    lookout: Lookout | None = d.round.lookout
    tell = str(node.production.fixed["tell"])
    if lookout is not None:
        return lookout.told(d, tell)
    here = d.scene.at if in_round(d) else d.round.here
    if here is not None:  # "if one has none, tell me which one"
        return Told([d.say("such_places", places=as_value(here))], [])
    found_before_coming_back(d)
    looked = looked_on_visits(d, node)
    if looked is not None:
        return looked.told(d, tell)
    if d.reports.news is not None:
        return found_told(d)
    if d.round.such is None:
        return where_met(d, another_meant(d, node)) or told_of_search(d, tell)
    return Told([d.say("it_is_there", place=Recall(d.round.such))], [])
