"""Conditions on who and what is there: seen, found, counted."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Final

from grammar.chart import Node
from grammar.discourse import ANYONE, START, Discourse, Meeting, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.answers import Wanted, yes
from grammar.meanings.checked import checked
from grammar.meanings.conditions import negated
from grammar.meanings.deliveries import delivered_last
from grammar.meanings.finding import noun_of, whether_found
from grammar.meanings.news import BACK, in_round
from grammar.meanings.places import at_own_place, own_place, owner_of, sought
from grammar.meanings.polls import counted as counted_answers
from grammar.meanings.registry import meaning
from grammar.meanings.reports import Report
from grammar.meanings.searches import (
    just_awaited,
    just_looked_for,
    only_told_missing,
    searches,
)
from grammar.meanings.surveys import Survey, asked_before, asked_yet, of_one_question
from grammar.meanings.volunteers import just_found
from grammar.plan import (
    Ask,
    Both,
    Call,
    Compare,
    Condition,
    Either,
    Holds,
    If,
    Items,
    Not,
    Number,
    Recall,
    Remember,
    Text,
    Value,
)

COUNTED: Final = frozenset({"thing", "person_ref"})
"""The parts of a condition that say what is counted."""


@meaning("is_seen")
def is_seen(d: Discourse, node: Node) -> Condition:
    """ "you see a cup", "Alice is there", "nobody is in the lobby", "a visitor is waving"."""
    return looked_for(d, node, search=False)


@meaning("is_found")
def is_found(d: Discourse, node: Node) -> Condition:
    """ "you find a cup": the robot drives about to look for it, but not on a round."""
    return looked_for(d, node, search=not in_round(d))


def looked_for(d: Discourse, node: Node, search: bool) -> Condition:
    thing = noun_of(d, node)
    if node.production.fixed.get("at_place") and d.scene.at is None:  # "si Paul y est": where?
        raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))
    host = host_of_visit(d, thing)
    if host is not None:  # "take him to Clara's office. If she is not there, ..."
        d.has_named(host.text)
        thing = host
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if not node.production.fixed.get("it"):
        survey = None
    if survey is not None and survey.call.save_as == d.answers.last:
        return survey.said(thing.text)
    if thing.every and not thing.person:  # "if all the beds are taken": one is seen or not
        words = d.words(node.start, node.end)
        gap = (node.start, node.end)
        raise NotUnderstood(d.language.phrase("cannot_check", what=words), gap=gap)
    said_there = d.tokens[node.end - 1].norm in d.language.speech.get("there", ())
    if said_there and thing.place is None and d.scene.at == Recall(START):
        there = d.scene.at_pick_up if d.scene.place == d.scene.at else d.scene.place
        thing = replace(thing, place=there)  # the robot has come back from there meanwhile
    if thing.person and thing.count is not None:  # "five people are there"
        many = _so_many(d, thing, thing.count, ">=")
        return negated(many) if node.production.fixed.get("no") else many
    if node.production.fixed.get("own") and thing.place is None:
        thing = at_own_place(d, thing)
    brought = delivered_last(d)
    if said_there and brought is not None and thing.person and thing.place is None:
        thing = replace(thing, place=own_place(d, thing))
    if thing.pronoun and node.production.fixed.get("no") and met_before(d, thing):
        again = just_branched(d, no=True)  # "if you find it, bring it. If it is not there, ..."
        if again is not None:
            return again
    other = other_case_of(d, node)
    if other is not None:
        return other
    if isinstance(thing.group, Items):
        result = _each_of_them(d, node, thing.group.items, search)
    else:
        result = _is_doing(d, node, thing) or is_there(d, thing, search)
    if search and d.branch.met is not None:
        d.branch = replace(d.branch, met=replace(d.branch.met, sought=True))
    if node.production.fixed.get("no"):
        d.branch = replace(
            d.branch, met=replace(d.branch.met, holds=False) if d.branch.met is not None else None
        )
        result = Not(result)
        if "state" in node.parts:  # "the cup is not clean": there is one, but none that is so
            plain = {name: part for name, part in node.parts.items() if name != "state"}
            result = Both((is_there(d, noun_of(d, replace(node, parts=plain)), search), result))
    return result


def other_case_of(d: Discourse, node: Node) -> Condition | None:
    """ "see if Bob is in. If not, tell the visitor so. If he is there, ...": he is Bob."""
    before, part = d.branch.before, node.parts.get("person_ref")
    if before is None or before.met is None or not isinstance(part, Node):
        return None
    who, gender = before.met.thing, d.gender(part.start, part.end)
    if part.means != "person_pronoun" or gender is None or not (who.person and who.known):
        return None
    return just_branched(d, no="no" in node.production.fixed) if d.may_have(who, gender) else None


def host_of_visit(d: Discourse, who: Thing) -> Thing | None:
    """Whoever's place somebody was led to, where it is asked whether anybody is there: "take the
    visitor to Bob's office. If he is not in, ..." is not about the visitor."""
    host = (
        owner_of(d)
        if d.scene.led is not None and d.scene.at is not None and d.scene.place == d.scene.at
        else None
    )
    if d.scene.led is None or host is None or not who.person or who.known or who.place is not None:
        return None
    if who.value not in (d.scene.led.value, Text(ANYONE)) or host == d.scene.led.value:
        return None
    return Thing(host, known=True, person=True)


def _is_doing(d: Discourse, node: Node, thing: Thing) -> Condition | None:
    """Whether somebody is seen who does something: "visitor waving"; who goes by a name is looked
    for first."""
    doing = node.parts.get("doing")
    if doing is None:
        return None
    so = Text(f"{thing.text} {d.described_by(doing)}")
    if not thing.known:
        return is_there(d, replace(thing, value=so))
    seen = Holds(Ask("sees", {"thing": so}))
    if thing.here or d.scene.with_person == thing.value:
        return seen
    there = is_there(d, thing, search=True)
    d.branch = replace(d.branch, met=None)
    return Both((there, seen))


def met_before(d: Discourse, thing: Thing) -> bool:
    """Whether the condition before was about the same."""
    before = d.branch.before
    return before is not None and before.met is not None and before.met.thing.value == thing.value


def just_branched(d: Discourse, no: bool) -> Condition | None:
    """ "If she isn't there, come back. If she is, ask her ...": the other case of that."""
    before = d.branch.before
    step = before.step if before is not None else None
    if before is None or before.met is None or not isinstance(step, If):
        return None
    if step.otherwise and not only_told_missing(step):
        return None
    if before.answer != d.answers.last or not d.done or d.done[-1] is not step:
        return None
    if before.met.holds is not no:  # the same case again says something else
        return None
    d.scene = before.scene
    d.branch = replace(d.branch, met=replace(before.met, holds=not no))
    return negated(step.condition)


def is_there(d: Discourse, thing: Thing, search: bool = False) -> Condition:
    """Whether somebody or something is seen here, or found where it is said to be."""
    if thing.person and thing.text == ANYONE and thing.place is None:
        agreed = just_agreed(d)
        if agreed is not None:
            return agreed
    known = just_looked_for(d, thing) or just_awaited(d, thing) or just_checked(d, thing)
    if known is None:
        if search and thing.place is None and isinstance(d.scene.at, Text):
            thing = replace(
                thing, place=d.scene.at
            )  # "go to the kitchen and if you find a cup, ..."
        elsewhere = thing.place is not None and thing.place != d.scene.at
        if search or elsewhere:
            known = whether_found(d, thing)
        else:
            known = Holds(Ask("sees", {"thing": sought(d, thing)}))
    if thing.person:
        d.scene = d.scene.speaking_of_person(thing)
        looked = {each.arguments.get("place") for each in searches(known)}
        if thing.known and thing.place is None and len(looked) == 1:
            thing = replace(thing, place=looked.pop())  # "see if Bob is in his office. If he is"
    d.branch = replace(d.branch, met=Meeting(thing))
    return known


def just_agreed(d: Discourse, no: bool = False) -> Condition | None:
    """Whether the search that the step before is has found somebody who says yes."""
    known = just_found(d)
    if known is None:
        return None
    condition, person = known
    d.branch = replace(d.branch, met=Meeting(person, holds=not no))
    return negated(condition) if no else condition


def just_checked(d: Discourse, thing: Thing) -> Condition | None:
    """The check before, if it was for this: "see if there is a cup. If there is a cup, ..."."""
    report: Report | None = d.reports.last
    about = report.thing if report is not None else None
    if about is None or thing.place not in (None, about.place):
        return None
    nobody = about.person and thing.person and thing.text == ANYONE  # of one who was looked for
    if about.value != thing.value and not nobody:
        return None
    return seen_there(d) or (Holds(known) if (known := checked(d)) is not None else None)


def seen_there(d: Discourse) -> Condition | None:
    """What was checked in a place that was gone to only for that, as a search in that place."""
    report: Report | None = d.reports.last
    about = report.thing if report is not None else None
    if about is None or about.place is None or checked(d) is None:
        return None
    first = Call("goto", {"place": about.place})
    last = d.done[-1] if d.done else None
    if len(d.done) < 2 or d.done[-2] != first or not isinstance(last, Remember):
        return None
    if last.value != Ask("sees", {"thing": sought(d, about)}):
        return None
    del d.done[-2:]
    d.reports = replace(d.reports, last=None)
    return Holds(Ask("find", {"thing": sought(d, about), "place": about.place}))


def _each_of_them(d: Discourse, node: Node, people: tuple[Value, ...], search: bool) -> Condition:
    """ "Alice and Bob are in their offices", "Alice or Bob is there"."""
    found: list[Condition] = []
    for value in people:
        person = Thing(value, known=True, person=True)
        d.scene = replace(d.scene, person=person)
        spot: Where | None = d.get(node, "from")
        if spot is not None:
            person = replace(person, place=spot.place, furniture=spot.furniture)
        found.append(is_there(d, person, search))
    d.branch = replace(d.branch, met=None)
    part = node.parts.get("person_ref") or node.parts["thing"]
    either = node.production.fixed.get("any") or set(d.language.speech.get("or", ())) & set(
        d.norms(part.start, part.end)
    )
    if either and d.scene.person is not None and d.scene.person.person:  # whoever of them it is
        d.scene = replace(d.scene, person=Thing(Text(ANYONE), person=True, plural=True, here=True))
    return Either(tuple(found)) if either else Both(tuple(found))


@meaning("place_empty")
def place_empty(d: Discourse, node: Node) -> Condition:
    """ "the lobby is empty": nobody is there."""
    anybody = Thing(Text(ANYONE), d.get(node, "place"), person=True)
    there = is_there(d, anybody)
    d.branch = replace(
        d.branch, met=Meeting(anybody, holds=bool(node.production.fixed.get("occupied")))
    )
    return there if node.production.fixed.get("occupied") else Not(there)


@meaning("counted")
def counted(d: Discourse, node: Node) -> Condition:
    """ "there are more than three people"; of those who were asked before, who said yes."""
    if counts_answers(d, node):
        return so_many_agreed(d, int(d.get(node, "count")), d.get(node, "operator", "=="))
    thing = counted_thing(d, node)
    spot: Where | None = d.get(node, "where")
    if spot is not None:
        thing = replace(thing, place=spot.place, furniture=spot.furniture)
    operator = d.get(node, "operator", "==")
    if operator in ("<", "<=") and not thing.person:  # "..., bring one": for where they are short
        d.scene = replace(d.scene, lacking=replace(thing, place=thing.place or d.scene.at))
    return _so_many(d, thing, int(d.get(node, "count")), operator)


def _so_many(d: Discourse, thing: Thing, number: int, operator: str) -> Compare:
    """Whether there are so many of somebody or something, where the robot has to go for that; what
    has just been counted, and told, is not counted once more."""
    known = _just_counted(d, thing)
    if known is not None:
        return Compare(known, operator, Number(number))
    if thing.place is not None and thing.place != d.scene.at:
        d.went(thing.place)
        d.need_first(Call("goto", {"place": thing.place}))
    if thing.person:
        thing = replace(thing, count=None)
        d.scene = replace(d.scene, person=replace(thing, plural=True, place=None, here=True))
        d.reports = replace(d.reports, last_counted=d.scene.person)
    return Compare(Ask("count", {"thing": sought(d, thing)}), operator, Number(number))


def _just_counted(d: Discourse, thing: Thing) -> Recall | None:
    """The number of things that were counted last, if nothing but telling it has been done since.
    People are met again, for something may be said to them."""
    since = itertools.takewhile(lambda step: not isinstance(step, Remember), reversed(d.done))
    if thing.person or not all(
        step == BACK or (isinstance(step, Call) and step.method == "say") for step in since
    ):
        return None
    kept = next((step for step in reversed(d.done) if isinstance(step, Remember)), None)
    same = (
        thing.place is None
        or d.reports.last_counted is None
        or thing.place == d.reports.last_counted.place
    )
    if kept is None or not same:
        return None
    counted = kept.value == Ask("count", {"thing": sought(d, thing)})
    return Recall(kept.name) if counted else None


def counts_answers(d: Discourse, node: Node) -> bool:
    """Whether a condition that does not say what is counted is on the answers of those asked."""
    return not node.parts.keys() & COUNTED and d.reports.last_counted is None and asked_yet(d)


def so_many_agreed(d: Discourse, number: int, operator: str) -> Compare:
    """Whether so many of those who were asked have said yes, or what was told of last."""
    surveys = of_one_question(asked_before(d))
    agree: Wanted = d.answers.said or yes(d)
    if not set(agree.options) <= set(surveys[-1].options):
        raise NotUnderstood(d.language.phrase("count_what"))
    return Compare(counted_answers(d, surveys, agree), operator, Number(number))


def counted_thing(d: Discourse, node: Node) -> Thing:
    """What a condition counts: what was counted before, where it does not say; "people", too, are
    those who were counted, if that has just been told elsewhere."""
    before = d.reports.last_counted
    if node.parts.keys() & COUNTED:
        thing = noun_of(d, node)
        same = before is not None and thing.text == before.text and thing.place is None
        return before if before is not None and same and d.scene.at == Recall(START) else thing
    if before is None:
        raise NotUnderstood(d.language.phrase("count_what"))
    return before


@meaning("counted_between")
def counted_between(d: Discourse, node: Node) -> Condition:
    """ "there are between three and ten people"."""
    count = Ask("count", {"thing": sought(d, counted_thing(d, node))})
    least, most = (Number(int(d.get(node, each))) for each in ("least", "most"))
    return Both((Compare(count, ">=", least), Compare(count, "<=", most)))
