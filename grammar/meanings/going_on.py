"""What is said after a round of places and belongs to it: what is done at each place where
something is so ("Go to every office. If somebody is there, ..."), and what is told in the end."""

from __future__ import annotations

from typing import Final

from msgspec.structs import replace

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, Steps, Thing
from grammar.meanings.branches import claim_of
from grammar.meanings.conditions import condition_of
from grammar.meanings.deliveries import first_clause, inside
from grammar.meanings.finding import speak_to
from grammar.meanings.lookouts import ABOUT_IT
from grammar.meanings.news import BACK, News, go_back
from grammar.meanings.news import in_round as in_a_round
from grammar.meanings.nouns import is_me
from grammar.meanings.rounds import goes_to, told_after_round
from grammar.plan import (
    Ask,
    Call,
    Collect,
    Compare,
    Condition,
    ForEach,
    Holds,
    If,
    Items,
    Length,
    Number,
    Recall,
    Remember,
    Sentence,
    Step,
    Text,
    Value,
)

SPOKEN: Final = frozenset({"say", "ask", "gesture", "wait_for", "emotion"})
"""What is done with people."""

STAYS_OUTSIDE: Final = frozenset(
    {
        *("news", "round_count", "compared"),
        *("come_back", "go", "go_places", "go_person", "go_find", "dock", "stop", "bring_too"),
        *("for_each_place", "for_each_place_such", "for_each_of_them", "check_each_place"),
        *("do_that_times", "do_that_again", "do_that_until", "do_that_while", "do_that_forever"),
        *("skip_empty", "ended", "tour", "tour_goes_on"),
        *("same_for", "tell_that", "tell_me_that", "say_it", "reversed", "delayed", "bring_each"),
        *("when", "repeat", "until", "while", "forever", "at_intervals", "corrected", "guide_list"),
    }
)
"""Clauses that do not belong to a round in the sentence before."""
OF_THE_ROUND: Final = frozenset({"is_seen", "is_found", "so", "answered", "trait_holds", "counted"})
"""Conditions on what is found at each place."""


def in_round(d: Discourse, clause: Node) -> Steps:
    """The steps of a clause. "Go to every office. If somebody is there, ...": they belong to the
    round in the sentence before, which may consist of nothing but going there."""
    first = first_clause(clause)
    if d.lookout is not None and about_all(d, first):
        d.lookout.until_found(d)
    loop = d.done[-1] if d.done else None
    if not isinstance(loop, ForEach) or not goes_on(d, loop, first):
        return in_company(d, first, d.build(clause))
    d.done.pop()
    means = first.production.means
    if means == "tell_condition" and "otherwise" not in first.parts:
        d.lookout = None
        return told_behind(d, loop, first)
    here = Recall(loop.variable)
    outer, d.done = d.done, list(loop.steps)
    d.at = d.place = here
    lookout = d.lookout if means not in (*ABOUT_IT, "if", "when") else None
    d.lookout = None
    if lookout is not None:
        lookout.meet(d)
    in_loop, d.in_loop = d.in_loop, True
    try:
        more = in_company(d, first, d.build(clause))
        inner = [*d.done, *(more if lookout is None else lookout.acted_on(more))]
    finally:
        d.done, d.in_loop = outer, in_loop
    d.at = d.with_person = None
    return brought_behind(d, replace(loop, steps=tuple(inner)))


def in_company(d: Discourse, first: Node, steps: Steps) -> Steps:
    """At a stop of a round, what is said to whoever is there is said only if somebody is."""
    spoken = all(isinstance(each, Call) and each.method in SPOKEN for each in steps)
    if not steps or not spoken or not in_a_round(d) or d.report_step in steps:
        return steps
    if not any(each.means in ("person_kind", "person_first") for each in inside(first)):
        return steps
    who: Value = Text(ANYONE)
    waiting = steps[0]
    if isinstance(waiting, Call) and waiting.method == "wait_for":
        who, steps = waiting.arguments["thing"], steps[1:]
    return [If(Holds(Ask("sees", {"thing": who})), tuple(steps))] if steps else steps


def about_all(d: Discourse, first: Node) -> bool:
    """ "if there is none anywhere": whether a clause speaks of all the places together."""
    words = d.language.speech.get("anywhere", ())
    return first.production.means == "if" and any(
        norm in words for norm in d.norms(first.start, first.end)
    )


def told_behind(d: Discourse, loop: ForEach, clause: Node) -> Steps:
    """ "go through all rooms and tell me if you see a dog": told when the round is done."""
    here = Recall(loop.variable)
    outer, d.done = d.done, list(loop.steps)
    d.at = d.place = here
    d.met = None
    before, condition = condition_of(d, clause)
    claim = claim_of(d, clause, condition, d.met)
    inner, d.done = d.done, outer
    d.at = d.with_person = None
    person: Thing | None = d.get(clause, "person_ref")
    loop, words = noted_of(d, replace(loop, steps=(*inner, *before)), condition, claim)
    d.report, d.news, d.told = None, News(words, person is None), words[-1]
    if person is None or is_me(person):
        return [loop, *go_back(d, [loop]), *words]
    return [loop, *speak_to(d, person, words)]


def noted_of(
    d: Discourse, loop: ForEach, condition: Condition, claim: Step | None
) -> tuple[ForEach, Steps]:
    """A round that notes where something is so, and what tells of it."""
    found = d.variable("found")
    d.done.insert(0, Remember(found, Items(())))
    noted = If(condition, (Collect(found, Recall(loop.variable)),))
    some = d.say("such_places", places=Recall(found))
    said = claim.arguments.get("text") if isinstance(claim, Call) else None
    if isinstance(said, Text):
        what = Text(f"{said.value.rstrip('.')}: ")
        some = Call("say", {"text": Sentence((what, Recall(found), Text(".")))})
    none = d.say("no_such_places")
    words: Steps = [If(Compare(Length(Recall(found)), "==", Number(0)), (none,), (some,))]
    return replace(loop, steps=(*loop.steps, noted)), words


def brought_behind(d: Discourse, loop: ForEach) -> Steps:
    """A round at each stop of which the robot would come back to tell something: told at last."""
    *before, last = loop.steps
    if not isinstance(last, If) or last.otherwise or BACK not in last.then:
        return told_after_round(d, loop)
    at = last.then.index(BACK)
    told = last.then[at + 1 :]
    if not told or not all(isinstance(each, Call) and each.method == "say" for each in told):
        return [loop]
    inner = [*before, replace(last, then=last.then[:at])] if at else before
    loop, words = noted_of(d, replace(loop, steps=tuple(inner)), last.condition, told[0])
    d.went(d.start())
    d.news, d.told = News(words, True), words[-1]
    return [loop, BACK, *words]


def goes_on(d: Discourse, loop: ForEach, first: Node) -> bool:
    """Whether a clause belongs to the round before it."""
    if not (loop.steps and goes_to(loop.steps[0], loop.variable)):
        return False
    always = first.production.means == "when" and first.production.fixed.get("always")
    if always or first.production.means in ("if", "tell_condition"):
        about = {each.production.means for each in inside(first.parts["condition"])}
        return bool(about & OF_THE_ROUND) and not any(
            isinstance(each.parts.get("place"), Leaf) for each in inside(first.parts["condition"])
        )
    if len(loop.steps) > 1 or first.production.means in STAYS_OUTSIDE:
        return False
    if d.lookout is not None and any(each.means == "thing_it" for each in inside(first)):
        return True  # "search all labs for a stapler and bring it to Bob"
    return not any(
        each.production.means == "person_name"
        for each in first.parts.values()
        if isinstance(each, Node)
    )
