"""Telling somebody that something is so, if it is so."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node, what_it_means
from grammar.discourse import (
    Branched,
    Discourse,
    Steps,
    Thing,
)
from grammar.meanings.absences import addressed_before
from grammar.meanings.alternatives import itself
from grammar.meanings.branches import absent, as_before, branch, failing, other_branch
from grammar.meanings.claims import (
    TELL,
    claim_of,
    counted_first,
    found_claim,
    leave_off,
    meet_there,
    told_so,
    turned,
)
from grammar.meanings.conditions import condition_of
from grammar.meanings.deliveries import (
    delivered_last,
    lacks,
    taken_back,
)
from grammar.meanings.finding import speak_to
from grammar.meanings.in_time import too_late
from grammar.meanings.news import go_back
from grammar.meanings.orders_to_tell import coming_back, told_again
from grammar.meanings.persons import is_me
from grammar.meanings.registry import meaning
from grammar.meanings.speaking import clause_of
from grammar.meanings.surveys import in_loop
from grammar.plan import (
    Condition,
    If,
)


@meaning(TELL)
def tell_condition(d: Discourse, node: Node) -> Steps:
    """ "if there are more than three people, tell Alice": that there are more than three people."""
    if "condition" not in node.parts:  # "..., if not, let me know"
        return told_so(d, node, d.branch.claim.saying if d.branch.claim is not None else None)
    node = of_all_asked(d, node)
    before_it, condition = condition_of(d, node)
    met = turned(d.branch.met) if node.production.fixed.get("unless") else d.branch.met
    kept = addressed_before(d, met) if not before_it else None
    if kept is not None and met is not None:
        return absent(
            d,
            node,
            kept,
            met,
            lambda: coming_back(d, node, told_again(d, d.get(node, "person_ref"))),
        )
    person_said = node.parts.get("person_ref")
    asked_whether = person_said and person_said.end <= node.parts["condition"].start
    if asked_whether and is_me(d.get(node, "person_ref")) and is_so(d, node):
        return told_again(d, d.get(node, "person_ref"))
    if asked_whether and what_it_means(node.parts["condition"]) == "answers_same":
        return [*before_it, *told_either_way(d, node, condition)]
    delivery = delivered_last(d)
    if delivery is not None and met is not None and lacks(delivery, met):
        taken = taken_back(d, delivery, met)
        if taken is not None:  # "bring me a coffee; if there is none, let me know"
            return [*before_it, *failing(d, node, taken, met)]
    claim = claim_of(d, node, condition, met)
    late = before_it or too_late(d, condition, met, lambda: told_so(d, node, claim))
    if isinstance(late, If):
        return [late]
    if met is None and not before_it:
        as_before(d, condition)
    start = d.scene
    meet_there(d, met)
    then = told_so(d, node, claim)
    after = d.scene
    d.scene = start
    part = other_branch(d, node, condition)
    otherwise: Steps = []
    if part is not None:
        otherwise = branch(d, part, turned(met), found_claim(d, condition, turned(met)))
    else:
        meet_there(d, turned(met))
    leave_off(d, after)
    counted, condition = counted_first(condition, [*then, *otherwise])
    whole = If(condition, tuple(then), tuple(otherwise))
    d.branch = replace(d.branch, before=Branched(whole, start, met, d.answers.last))
    return [*before_it, *counted, whole]


def of_all_asked(d: Discourse, node: Node) -> Node:
    """ "ask everyone whether they need help. If so, tell David": he is told once, if any of them
    does, and not of each."""
    condition = node.parts["condition"]
    so = itself(condition) if isinstance(condition, Node) else None
    several = (
        bool(d.answers.surveys)
        and d.answers.last is not None
        and in_loop(d, d.answers.surveys[-1].call)
    )
    if so is None or so.means != "so" or so.production.fixed or not several:
        return node
    if d.language.phrase("yes") not in d.answers.surveys[-1].options:
        return node
    means = replace(so.production, means="answers_many", fixed={"how": "some"})
    return replace(node, parts={**node.parts, "condition": replace(so, production=means)})


def is_so(d: Discourse, node: Node) -> bool:
    """Whether the speaker wants to know what somebody has answered: "let me know if he is", which
    is also told if he is not."""
    so = what_it_means(node.parts["condition"]) == "so"
    return so and d.answers.last is not None and "otherwise" not in node.parts


def told_either_way(d: Discourse, node: Node, condition: Condition) -> Steps:
    """ "tell me if it is the same": also if it is not."""
    person: Thing = d.get(node, "person_ref")
    part = node.parts["condition"]
    clause = clause_of(d, part)
    told = If(condition, (d.say("so_it_is", clause=clause),), (d.say("not_so", clause=clause),))
    return [*go_back(d, []), told] if is_me(person) else speak_to(d, person, [told])
