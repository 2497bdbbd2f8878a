"""What is said after a round of places and belongs to it: what is done at each place where
something is so ("Go to every office. If somebody is there, ..."), and what is told in the end."""

from __future__ import annotations

import dataclasses
from dataclasses import replace
from typing import Final

from msgspec.structs import replace as structs_replace

from grammar.chart import Leaf, Node, what_it_means
from grammar.discourse import ANYONE, Discourse, Steps, Thing
from grammar.meanings.alternatives import CONDITIONAL
from grammar.meanings.claims import claim_of
from grammar.meanings.conditions import condition_of
from grammar.meanings.deliveries import first_clause, hands_it_over, inside
from grammar.meanings.finding import speak_to
from grammar.meanings.first_match import found_once, says
from grammar.meanings.lookouts import ABOUT_IT, looks_out
from grammar.meanings.news import BACK, News, go_back
from grammar.meanings.news import in_round as in_a_round
from grammar.meanings.persons import is_me
from grammar.meanings.place_loops import goes_to
from grammar.meanings.rounds import told_after_round
from grammar.meanings.surveys import Survey, is_in
from grammar.meanings.there import counts_answers
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
from grammar.tidy import nodes

SEEN: Final = frozenset(
    {"names_here", "whether_seen", "counted_info", "seen_here", "kind_seen", "looks_of"}
)
"""What is told of a place by who or what is seen there."""
SPOKEN: Final = frozenset({"say", "ask", "gesture", "wait_for", "emotion"})
"""What is done with people."""

STAYS_OUTSIDE: Final = frozenset(
    {
        *("news", "round_count", "compared"),
        *(
            "come_back",
            "go",
            "go_places",
            "go_person",
            "go_find",
            "dock",
            "stop",
            "bring_too",
            "bring_as_many",
        ),
        *("for_each_place", "for_each_place_such", "check_each_place"),
        *("do_that_times", "do_that_again"),
        *("skip_empty", "ended", "tour", "tour_goes_on", "look_now", "round_check"),
        *("same_for", "tell_that", "tell_me_that", "say_it", "reversed", "delayed", "bring_each"),
        *("when", "repeat", "until", "forever", "corrected", "guide_list"),
    }
)
"""Clauses that do not belong to a round in the sentence before."""
ANSWERED: Final = frozenset({"so", "answered"})
"""Conditions on an answer."""
OF_THE_ROUND: Final = frozenset({"is_seen", "is_found", "so", "answered", "trait_holds", "counted"})
"""Conditions on what is found at each place."""


def in_round(d: Discourse, clause: Node) -> Steps:
    """The steps of a clause. "Go to every office. If somebody is there, ...": they belong to the
    round in the sentence before, which may consist of nothing but going there."""
    first = first_clause(clause)
    if d.round.lookout is not None and (about_all(d, first) or fetches_it(d, first)):
        d.round.lookout.until_found(d)
    found_there_too(d, first)
    if alone(clause, first) and looks_out(d, first):
        return []
    loop = d.done[-1] if d.done else None
    if not isinstance(loop, ForEach) or not goes_on(d, loop, first):
        return in_company(d, first, d.build(clause))
    d.done.pop()
    means = first.production.means
    told_only = told_if_so(first)
    if told_only is not None:
        return told_behind(d, loop, told_only)
    here = Recall(loop.variable)
    outer, d.done = d.done, list(loop.steps)
    d.round = replace(d.round, here=here)
    d.scene = d.scene.arrived(here)
    lookout = d.round.lookout if means not in (*ABOUT_IT, "if", "when") else None
    d.round = replace(
        d.round, stop=None if d.round.lookout is None else d.round.lookout.trait, lookout=None
    )
    if lookout is not None:
        lookout.meet(d)
    in_loop = d.loops.in_loop
    d.loops = replace(d.loops, in_loop=True)
    clause, behind = told_of_all(clause, first)
    try:
        more = in_company(d, first, d.build(clause))
        inner = [*d.done, *(more if lookout is None else lookout.acted_on(more))]
    finally:
        d.done = outer
        d.loops = replace(d.loops, in_loop=in_loop)
    d.round = replace(d.round, stop=None, here=None)
    d.scene = d.scene.wandered()
    loop = structs_replace(loop, steps=tuple(inner))
    if behind is not None:
        d.done.append(loop)
        told: Steps = d.build(behind)
        return told
    return found_once(d, loop, first) or brought_behind(d, loop)


def alone(clause: Node, first: Node) -> bool:
    """Whether a clause is nothing but this one."""
    return (clause.start, clause.end) == (first.start, first.end)


def found_there_too(d: Discourse, first: Node) -> None:
    """ "visit the labs, come back and tell me who is there": found out before coming back."""
    loop = d.done[-2] if len(d.done) > 1 and d.done[-1] == BACK else None
    if isinstance(loop, ForEach) and goes_on(d, loop, first) and about_places(first):
        d.done.pop()
        d.scene = replace(d.scene, at=None)


def about_places(first: Node) -> bool:
    """Whether a clause tells of what is at a place."""
    info = first.parts.get("info")
    seen = isinstance(info, Node) and what_it_means(info) in SEEN
    return first.means == "tell_condition" or (first.means == "report" and seen)


def told_of_all(clause: Node, first: Node) -> tuple[Node, Node | None]:
    """What is done at each place, and what is told when that is done everywhere: "if somebody is
    there, ask them whether they want tea, and tell me how many said yes"."""
    then = first.parts.get("then")
    if first.means != "if" or clause is not first or not isinstance(then, Node):
        return clause, None
    kept, behind = without_news(then)
    if kept is None or behind is None:
        return clause, None
    return dataclasses.replace(clause, parts={**clause.parts, "then": kept}), behind


def without_news(part: Node) -> tuple[Node | None, Node | None]:
    """A sequence up to where it is told what was answered, and that."""
    if part.production.means is None and len(part.parts) == 1:
        ((name, only),) = part.parts.items()
        kept, behind = without_news(only) if isinstance(only, Node) else (part, None)
        whole = None if kept is None else dataclasses.replace(part, parts={name: kept})
        return whole, behind
    if part.means != "steps":
        return part, None
    rest = part.parts.get("rest")
    first = part.parts["first"]
    news = first_clause(first) if isinstance(first, Node) else None
    if news is not None and news.means in ("news", "come_back"):
        polled = any(each.means == "poll" for each in inside(part))
        return (None, part) if polled else (part, None)
    if not isinstance(rest, Node):
        return part, None
    kept, behind = without_news(rest)
    parts = {name: each for name, each in part.parts.items() if name != "rest"}
    if kept is not None:
        parts["rest"] = kept
    return dataclasses.replace(part, parts=parts), behind


def in_company(d: Discourse, first: Node, steps: Steps) -> Steps:
    """At a stop of a round, what is said to whoever is there is said only if somebody is."""
    spoken = all(isinstance(each, Call) and each.method in SPOKEN for each in steps)
    if not steps or not spoken or not in_a_round(d) or d.reports.step in steps:
        return steps
    if not any(each.means in ("person_kind", "person_first") for each in inside(first)):
        return steps
    who: Value = Text(ANYONE)
    waiting = steps[0]
    if isinstance(waiting, Call) and waiting.method == "wait_for":
        who, steps = waiting.arguments["thing"], steps[1:]
    return [If(Holds(Ask("sees", {"thing": who})), tuple(steps))] if steps else steps


def fetches_it(d: Discourse, first: Node) -> bool:
    """ "if you find it, bring it here": whether a clause says what becomes of the one thing that is
    looked for, so that the search ends where it is."""
    if not d.round.lookout.definite:
        return False
    return hands_it_over(first.parts.get("then", first))


def about_all(d: Discourse, first: Node) -> bool:
    """ "if there is none anywhere": whether a clause speaks of all the places together."""
    said = f" {' '.join(d.norms(first.start, first.end))} "
    anywhere = d.language.speech.get("anywhere", ())
    return first.production.means in CONDITIONAL and any(f" {each} " in said for each in anywhere)


def told_behind(d: Discourse, loop: ForEach, clause: Node) -> Steps:
    """ "go through all rooms and tell me if you see a dog": told when the round is done."""
    here = Recall(loop.variable)
    outer, d.done = d.done, list(loop.steps)
    d.scene = d.scene.arrived(here)
    d.branch = replace(d.branch, met=None)
    lookout = d.round.lookout
    d.round = replace(d.round, lookout=None, stop=None if lookout is None else lookout.trait)
    in_loop = d.loops.in_loop
    d.loops = replace(d.loops, in_loop=True)
    before, condition = condition_of(d, clause)
    d.round = replace(d.round, stop=None)
    d.loops = replace(d.loops, in_loop=in_loop)
    of_any = any(each.means == "trait_holds" for each in inside(clause.parts["condition"]))
    claim = None if of_any else claim_of(d, clause, condition, d.branch.met)
    inner, d.done = d.done, outer
    d.scene = d.scene.wandered()
    person: Thing | None = d.get(clause, "person_ref")
    loop, words = noted_of(d, structs_replace(loop, steps=(*inner, *before)), condition, claim)
    d.reports = replace(d.reports, last=None, news=News(words, person is None), told=words[-1])
    if person is None or is_me(person):
        return [loop, *go_back(d, [loop]), *words]
    return [loop, *speak_to(d, person, words)]


def told_if_so(first: Node) -> Node | None:
    """A clause that only tells somebody where something is so: "if there is none, tell me", "if you
    find one without it, let me know which"; None if more is done there, or if it is so nowhere."""
    if first.production.means in CONDITIONAL and says(first, "none"):
        return None
    if first.means == "tell_condition":
        alternative = any(name.startswith("otherwise") for name in first.parts)
        return None if alternative else first
    then = first.parts.get("then")
    if first.means != "if" or not isinstance(then, Node) or len(first.parts) > 2:
        return None
    told = first_clause(then)
    listed = any(each.means == "lookout_told" for each in inside(told))
    if told.means != "news" or (told.start, told.end) != (then.start, then.end) or not listed:
        return None
    parts = {"condition": first.parts["condition"]}
    if "whom" in told.parts:
        parts["person_ref"] = told.parts["whom"]
    return dataclasses.replace(first, parts=parts)


def told_last(body: Node) -> tuple[Node | None, Node] | None:
    """What is done at each place of a round, and what is told if something is so there, which is
    told when all have been seen: "go to every lab and if there is no fan, tell me"."""
    if body.production.means is None and len(body.parts) == 1:
        ((name, only),) = body.parts.items()
        found = told_last(only) if isinstance(only, Node) else None
        if found is None or found[0] is None:
            return found
        return dataclasses.replace(body, parts={name: found[0]}), found[1]
    if body.means != "steps":
        return (None, body) if told_if_so(body) is not None else None
    first, rest = body.parts["first"], body.parts.get("rest")
    last = first if rest is None else rest
    found = told_last(last) if isinstance(last, Node) else None
    if found is None or rest is None:
        return found
    kept, told = found
    parts = {"first": first} if kept is None else {**body.parts, "rest": kept}
    return dataclasses.replace(body, parts=parts), told


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
    if claim is None:
        none, some = d.say("no_none"), d.say("yes_these", places=Recall(found))
    words: Steps = [If(Compare(Length(Recall(found)), "==", Number(0)), (none,), (some,))]
    return structs_replace(loop, steps=(*loop.steps, noted)), words


def brought_behind(d: Discourse, loop: ForEach) -> Steps:
    """A round at each stop of which the robot would come back to tell something: told at last."""
    *before, last = loop.steps
    if not isinstance(last, If) or last.otherwise or BACK not in last.then:
        return told_after_round(d, loop)
    at = last.then.index(BACK)
    told = last.then[at + 1 :]
    if not told or not all(isinstance(each, Call) and each.method == "say" for each in told):
        return [loop]
    inner = [*before, structs_replace(last, then=last.then[:at])] if at else before
    loop, words = noted_of(d, structs_replace(loop, steps=tuple(inner)), last.condition, told[0])
    d.went(d.start())
    d.reports = replace(d.reports, news=News(words, True), told=words[-1])
    return [loop, BACK, *words]


def conditional(first: Node) -> bool:
    """Whether a clause is done only if something is so, each time anew."""
    always = first.production.means == "when" and first.production.fixed.get("always")
    return bool(always) or first.production.means in ("if", "tell_condition", "on_sight")


def depends_on_stop(d: Discourse, first: Node) -> bool:
    """Whether the condition of a clause is about what is found wherever the robot is."""
    condition = [*inside(first.parts["condition"])]
    about = {
        each.production.means
        for each in condition
        if each.means != "counted" or not counts_answers(d, each)
    }
    named = any(isinstance(each.parts.get("place"), Leaf) for each in condition)
    return bool(about & OF_THE_ROUND) and not named


def on_answer_of_each(d: Discourse, first: Node) -> bool:
    """Whether a condition is on what each of those has answered who are at a place of a round: "if
    they say yes" is then said of them in turn, and not of the place."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    about = {each.production.means for each in inside(first.parts["condition"])}
    if survey is None or survey.call.save_as != d.answers.last or not about & ANSWERED:
        return False
    return any(
        isinstance(each, ForEach)
        and Recall(each.variable) == survey.who
        and is_in(each, survey.call)
        for each in nodes(tuple(d.done))
    )


def goes_on(d: Discourse, loop: ForEach, first: Node) -> bool:
    """Whether a clause belongs to the round before it."""
    if not (loop.steps and goes_to(loop.steps[0], loop.variable)):
        return False
    if first.production.means == "for_each_of_them":
        return True  # "go to all wards. In each of them, ..."
    if conditional(first):
        return depends_on_stop(d, first) and not on_answer_of_each(d, first)
    if len(loop.steps) > 1 or first.production.means in STAYS_OUTSIDE:
        return False
    if d.round.lookout is not None and any(each.means == "thing_it" for each in inside(first)):
        return True  # "search all labs for a stapler and bring it to Bob"
    return not any(
        each.production.means == "person_name"
        for each in first.parts.values()
        if isinstance(each, Node)
    )
