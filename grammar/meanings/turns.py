"""Whose answer a condition is about, where several were asked: each one's in turn ("if they say
yes, tell them ..."), or that of all ("if they say yes, tell David ...")."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Thing
from grammar.meanings.answered import people_asked
from grammar.meanings.answers import Wanted, wanted
from grammar.meanings.deliveries import first_clause, inside
from grammar.meanings.polls import counted
from grammar.meanings.surveys import Survey, in_loop, of_one_question
from grammar.plan import Compare, Condition, Number, Recall, Text
from grammar.tidy import mentions


def in_their_turn(d: Discourse, node: Node, condition: Condition) -> Condition:
    """A condition on the last answer of each of several: what is said to be done for "them" is done
    with whose turn it is; what is told to somebody else hangs on the answers of all."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if survey is None or not isinstance(survey.who, Recall) or d.loops.in_loop:
        return condition
    if not in_loop(d, survey.call) or survey.who == survey.where:
        return condition
    if not mentions((condition,), Recall(str(survey.call.save_as))):
        return condition
    if told_to_others(d, node) and not asks_on(node):
        return of_all(d, condition)
    d.scene = replace(
        d.scene,
        person=Thing(survey.who, known=True, person=True, here=True),
        with_person=survey.who,
    )
    return condition


def of_whoever_says_so(d: Discourse, node: Node) -> Condition | None:
    """ "if somebody says no, tell them ...": what is done with them is done with whoever it is, in
    their turn; None if it hangs on the answers of all."""
    condition: Leaf | Node = node.parts["condition"]
    while isinstance(condition, Node) and condition.production.means is None:
        (condition,) = condition.parts.values()
    if not isinstance(condition, Node) or condition.production.fixed.get("how") != "some":
        return None
    if d.tokens[condition.start].norm not in d.language.words_called("any_of_them"):
        return None  # "if one of them says no, ask both ..."
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if survey is None or d.loops.in_loop or not in_loop(d, survey.call):
        return None
    then = node.parts["then"]
    them = d.language.words_called("plural_pronouns") & set(d.norms(then.start, then.end))
    if not asks_on(node) and (not them or told_to_others(d, node)):
        return None
    d.branch = replace(d.branch, met=None)
    return wanted(d, survey, d.get(condition, "said")).given(survey)


def asks_on(node: Node) -> bool:
    """Whether what hangs on the answer is one more question, for whoever gave it: "if somebody has
    one, ask whether I may borrow it"."""
    then = node.parts["then"]
    asking = first_clause(then) if isinstance(then, Node) else None
    return asking is not None and asking.means == "ask" and "person_ref" not in asking.parts


def told_to_others(d: Discourse, node: Node) -> bool:
    """Whether what hangs on the answer is for somebody who is named, and not for those asked."""
    then = node.parts["then"]
    them = set(d.language.speech.get("to_you", ())) & set(d.norms(then.start, then.end))
    named = {each.means for each in inside(then)} & {"person_name", "person_me"}
    return bool(named) and not them


def of_all(d: Discourse, condition: Condition) -> Condition:
    """That all said yes, or somebody said no."""
    surveys = of_one_question(d.answers.surveys)
    agree, refuse = d.language.phrase("yes"), d.language.phrase("no")
    match condition:
        case Compare(operator="==", right=Text(value=value)) if value == agree:
            said = counted(d, surveys, Wanted((agree,)))
            return Compare(said, "==", people_asked(d, surveys))
        case Compare(operator="==", right=Text(value=value)) if value == refuse:
            return Compare(counted(d, surveys, Wanted((refuse,))), ">=", Number(1))
        case _:
            return condition
