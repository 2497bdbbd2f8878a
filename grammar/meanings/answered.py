"""Conditions on what was answered: yes, so, an option, how many of those who were asked."""

from __future__ import annotations

import re
from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import ANYONE, Discourse, Meeting, Thing, as_value
from grammar.errors import NotUnderstood
from grammar.meanings.agreement import same_answers
from grammar.meanings.answers import Said, Wanted, yes
from grammar.meanings.answers import wanted as wanted_answer
from grammar.meanings.checked import checked
from grammar.meanings.conditions import negated
from grammar.meanings.deliveries import delivered_last
from grammar.meanings.news import in_round
from grammar.meanings.polls import counted as counted_answers
from grammar.meanings.registry import meaning
from grammar.meanings.requested import put_as_question
from grammar.meanings.searches import just_looked_for
from grammar.meanings.surveys import (
    Survey,
    asked_so_far,
    asked_without_end,
    asked_yet,
    exchanged,
    in_loop,
    polled_before,
)
from grammar.meanings.there import just_agreed, just_branched, seen_there
from grammar.plan import (
    Ask,
    Both,
    Call,
    Compare,
    Condition,
    Either,
    ForEach,
    Holds,
    If,
    Items,
    Not,
    Number,
    Recall,
    Remember,
    Share,
    Text,
    Truth,
    Try,
    Value,
)
from grammar.tidy import nodes


@meaning("cannot_check")
def cannot_check(d: Discourse, node: Node) -> Condition:
    """What was asked before, in its own words: "if he prefers the morning", "if it is not ready".
    Else something that is neither seen nor heard nor known: "the patient feels better"."""
    asked_for = about_answer(d, node)
    if asked_for is not None:
        return asked_for
    start = node.parts["unknown"].start
    end = node.end
    while end < len(d.tokens) and d.tokens[end].kind != "mark":
        end += 1  # "if the door is | open, go in": the clause goes on to its comma
    words = d.words(start, end)
    raise NotUnderstood(d.language.phrase("cannot_check", what=words), gap=(start, end))


def about_answer(d: Discourse, node: Node) -> Condition | None:
    """The condition that some words are on the last answer; None if they say more than what was
    asked, or nothing is known of how it was answered."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if survey is None or not survey.options or d.answers.last != survey.call.save_as:
        return None
    try:
        meant = wanted_answer(d, survey, Said(node.start, node.end), strict=True)
    except NotUnderstood:
        return None
    if in_loop(d, survey.call) and not d.loops.in_loop:
        return None
    return meant.given(survey)


@meaning("answered")
def answered(d: Discourse, node: Node) -> Condition:
    """ "if they say yes", "if the answer is radiology"."""
    fixed = node.production.fixed
    put_as_question(d)
    if d.answers.last is None:
        raise NotUnderstood(d.language.phrase("no_question"))
    plain = "answer" in fixed and "text" not in node.parts
    literal = plain and d.language.phrase(str(fixed["answer"])) in d.norms(node.start, node.end)
    pair = paired(d, d.language.phrase(str(fixed["answer"]))) if literal else None
    if pair is not None:
        return pair
    before = yes_no_before(d) if literal else None
    if before is not None:
        return before.said(d.language.phrase(str(fixed["answer"])))
    several = plain and asked_which(d)
    if several:  # "if they agree", on one of several days
        same = same_answers(d, node)
        return Not(same) if fixed["answer"] == "no" else same
    if "answer" in fixed:
        wanted = d.language.phrase(str(fixed["answer"]))
    else:
        place = node.parts.get("place")
        if place is not None:
            value: Value = d.build(place)
            assert isinstance(value, Text)
            wanted = value.value
        else:
            wanted = str(d.get(node, "text"))
    if says_the_same(d, wanted):
        return same_answers(d, node)
    silent = option_left_out(d, node) if plain and not literal else None
    if silent is not None:
        return Compare(Recall(d.answers.last), "==", Text(silent))
    for option in d.answers.options:
        if option.lower() == wanted.lower():
            return Compare(Recall(d.answers.last), "==", Text(option))
    said = node.parts.get("text")
    yes_no = set(d.answers.options) == {d.language.phrase("yes"), d.language.phrase("no")}
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if said is not None and survey is not None and d.answers.options:
        if not yes_no and survey.call.save_as == d.answers.last:
            return wanted_answer(d, survey, Said(said.start, said.end)).given(survey)
        if (asked_for := about_answer(d, node)) is not None:
            return asked_for
    if yes_no:
        ask_openly(d)
    return Compare(Text(wanted), "in", Recall(d.answers.last))


def option_left_out(d: Discourse, node: Node) -> str | None:
    """The option that a word is which says nothing elsewhere: "if they say now"."""
    end = node.end
    while end < len(d.tokens) and (d.tokens[end].norm,) in d.language.fillers:
        end += 1
    said = d.norms(node.start, end)
    options = (each for each in d.answers.options if (each.lower(),) in d.language.fillers)
    return next((each for each in options if each.lower() in said), None)


def ask_openly(d: Discourse) -> None:
    """The last question without its answers yes and no: "ask if they need anything; if they want
    water, ..." waits for more than these."""
    last = next(
        (each for each in reversed(d.answers.surveys) if each.call.save_as == d.answers.last), None
    )
    if last is None or not any(each is last.call for each in nodes(tuple(d.done))):
        return
    arguments = {name: each for name, each in last.call.arguments.items() if name != "options"}
    openly = Call(last.call.method, arguments, save_as=last.call.save_as)
    d.done[:] = exchanged(d.done, last.call, [openly])
    surveys = tuple(
        replace(each, call=openly, options=()) if each is last else each
        for each in d.answers.surveys
    )
    d.answers = replace(d.answers, surveys=surveys)
    d.answers = replace(d.answers, options=())


def paired(d: Discourse, wanted: str) -> Condition | None:
    """The other answer to the question that the condition just before was on: "if she says yes, ask
    her whether ... If she says no, ..."."""
    step = d.done[-1] if d.done else None
    if d.branch.before is None or step is not d.branch.before.step or not isinstance(step, If):
        return None
    one = step.condition
    if step.otherwise or not isinstance(one, Compare) or one.operator != "==":
        return None
    answers = {d.language.phrase("yes"), d.language.phrase("no")}
    said = one.right.value if isinstance(one.right, Text) else ""
    if {said, wanted} != answers or not isinstance(one.left, Recall):
        return None
    return Compare(one.left, "==", Text(wanted))


def yes_no_before(d: Discourse, *, so: bool = False) -> Survey | None:
    """The last question that was answered with yes or no, if another one was asked since, that is
    not: "if she says yes, ask her when: at 4 or at 5. If she says no, ..."."""
    yes_no = {d.language.phrase("yes"), d.language.phrase("no")}
    surveys = [each for each in asked_so_far(d) if not in_loop(d, each.call)]
    if (
        not surveys
        or set(surveys[-1].options) == yes_no
        or surveys[-1].call.save_as != d.answers.last
    ):
        return None
    if not surveys[-1].options and d.branch.before is None and not so:
        return None  # "no" may be an answer to an open question, too; "she has not" is none
    return next((each for each in reversed(surveys) if set(each.options) == yes_no), None)


def asked_which(d: Discourse) -> bool:
    """Whether several people were asked last to choose, but not between yes and no."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    yes_no = {d.language.phrase("yes"), d.language.phrase("no")}
    if survey is None or not survey.options or yes_no & set(survey.options):
        return False
    return in_loop(d, survey.call) or len(d.answers.surveys) > 1


def says_the_same(d: Discourse, words: str) -> bool:
    """Whether words mean what somebody else has said: "the same one"."""
    low = words.lower()
    return any(
        re.search(rf"\b{re.escape(each)}\b", low) is not None
        for each in d.language.speech.get("the_same", ())
    )


def said_so(d: Discourse, no: bool, there_is_none: bool = False) -> Condition:
    """ "if so", "if he is not": what was looked for in the step before was found, or the last
    answer was yes."""
    put_as_question(d)
    agreed = just_agreed(d, no) or just_branched(d, no)
    if agreed is not None:
        return agreed
    if d.round.stop is not None and in_round(
        d
    ):  # "check every lab for a cup. If there is none, ..."
        if d.round.stop.thing is not None:
            d.branch = replace(
                d.branch, met=Meeting(d.round.stop.thing, holds=no == d.round.stop.denied)
            )
        return negated(d.round.stop.condition) if no else d.round.stop.condition
    looked = just_looked_for(d, None)
    if looked is not None:
        person = d.scene.person if not d.scene.thing_last else None
        if person is not None or d.scene.thing is not None:
            found_now = person or d.scene.thing or Thing(Text(ANYONE))
            d.branch = replace(
                d.branch, met=Meeting(found_now, holds=not no, sought=not in_round(d))
            )
        return Not(looked) if no else looked
    delivery = delivered_last(d)
    if delivery is not None and no and (d.answers.last is None or there_is_none):
        d.branch = replace(d.branch, met=Meeting(delivery.thing, holds=False, sought=True))
        return Not(Holds(Ask("find", {"thing": delivery.thing.value})))
    if d.answers.last is None:
        about = d.reports.last.thing if d.reports.last is not None else None
        looked = seen_there(d)
        known = checked(d) if looked is None else None
        if looked is not None or known is not None:
            if about is not None:
                d.branch = replace(d.branch, met=Meeting(about, holds=not no))
            result = looked or Holds(known or Truth(True))
            return Not(result) if no else result
        raise NotUnderstood(d.language.phrase("no_question"))
    wanted = d.language.phrase("no" if no else "yes")
    if (pair := paired(d, wanted)) is not None:
        return pair
    if (before := yes_no_before(d, so=True)) is not None:
        return before.said(wanted)
    for option in d.answers.options:
        if option.lower() == wanted.lower():
            return Compare(Recall(d.answers.last), "==", Text(option))
    return Compare(Text(wanted), "in", Recall(d.answers.last))


@meaning("so")
def so(d: Discourse, node: Node) -> Condition:
    fixed = node.production.fixed
    return said_so(d, no=bool(fixed.get("no")), there_is_none=bool(fixed.get("none")))


@meaning("answer_counts")
def answer_counts(d: Discourse, node: Node) -> Condition:
    """ "if it is more than seven": the answer, a number."""
    number = as_value(d.get(node, "number"))
    if d.answers.said is not None and asked_yet(d):
        surveys = polled_before(d)
        if surveys[-1].options and in_loop(d, surveys[-1].call):
            # "count the noes, and if it is more than two, ...": of all who were asked
            many = counted_answers(d, surveys, d.answers.said)
            return Compare(many, d.get(node, "operator", "=="), number)
    found = d.reports.last
    counted = found is not None and found.name == "count" and d.answers.last is None
    if counted and (isinstance(found.value, Recall) or found.place in (None, d.scene.at)):
        # "count the people, and if it is more than ten, ...": where they were counted
        return Compare(found.value, d.get(node, "operator", "=="), number)
    if d.answers.last is None:
        raise NotUnderstood(d.language.phrase("no_question"))
    return Compare(Recall(d.answers.last), d.get(node, "operator", "=="), number)


@meaning("answers_many")
def answers_many(d: Discourse, node: Node) -> Condition:
    """ "if both say yes", "if more than half of them agree", "if nobody wants any"."""
    return so_many_said(d, node, d.get(node, "said"))


def so_many_said(d: Discourse, node: Node, said: Said | None) -> Condition:
    """Whether as many as a condition says gave an answer."""
    surveys = polled_before(d)
    answer = yes(d) if said is None else wanted_answer(d, surveys[-1], said)
    d.answers = replace(d.answers, said=answer)
    how = node.production.fixed.get("how")
    not_all = bool(node.production.fixed.get("no"))
    if how == "some" and asked_without_end(d, surveys[-1]):
        return answer.given(surveys[-1])
    by_one = len(surveys) == 1 or how in ("all", "none", "some")
    if not in_loop(d, surveys[-1].call) and by_one:
        given = of_those_asked(d, surveys, answer, str(how))
        return Not(given) if not_all else given
    many = counted_answers(d, surveys, answer)
    if how == "all":
        return Compare(many, "!=" if not_all else "==", people_asked(d, surveys))
    if how == "most":
        share = Share(many, counted_answers(d, surveys, None))
        return Compare(share, ">", Number(50))
    if how == "none":
        return Compare(many, "==", Number(0))
    least = int(d.get(node, "count", 1))
    return Compare(many, d.get(node, "operator", ">="), Number(least))


def of_those_asked(d: Discourse, surveys: list[Survey], answer: Wanted, how: str) -> Condition:
    """Whether all, some or none of those who were asked one after the other gave an answer."""
    same = surveys[-1].call.arguments["question"]
    alike = [each for each in surveys if each.call.arguments["question"] == same]
    if len(alike) == 1:
        alike = [each for each in surveys if each.options == surveys[-1].options]
    given = tuple(answer.given(each) for each in alike if not in_loop(d, each.call))
    if len(given) < 2:
        return Not(given[-1]) if how == "none" else given[-1]
    if how == "all":
        return Both(given)
    return Not(Either(given)) if how == "none" else Either(given)


@meaning("answer_is")
def answer_is(d: Discourse, node: Node) -> Condition:
    """ "if it's tea", "in case of tea": if that was chosen."""
    asked_for = about_answer(d, node)  # "it is not finished"
    if asked_for is not None:
        return asked_for
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    part = node.parts["text"]
    words = [norm for norm in d.norms(part.start, part.end) if norm not in d.language.closed]
    if words and survey is not None and survey.call.save_as == d.answers.last:
        for option in survey.options:
            if [each for each in d.language.tokens_of(option) if each in words] == words:
                return survey.said(option)
    said = d.words(node.start, node.end)
    raise NotUnderstood(d.language.phrase("cannot_check", what=said), gap=(node.start, node.end))


def people_asked(d: Discourse, surveys: list[Survey]) -> Value:
    """How many were to be asked: those named, else those who were there."""
    call = surveys[-1].call
    if not any(in_loop(d, each.call) for each in surveys):
        return Number(len(surveys))
    for loop in (each for steps in (*d.around, d.done) for each in steps):
        if not isinstance(loop, ForEach) or not isinstance(loop.items, Items):
            continue
        if any(each is call for each in nodes(loop)):
            return Number(len(loop.items.items))
    return counted_answers(d, surveys, None)


@meaning("unanswered")
def unanswered(d: Discourse, node: Node) -> Condition:
    """ "if he does not answer": the question is then put so that silence is an answer, too."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if survey is None or survey.call.save_as is None:
        raise NotUnderstood(d.language.phrase("no_question"))
    said = set(d.norms(node.start, node.end))
    nothing = next((each for each in survey.options if each.lower() in said), None)
    if nothing is not None:  # "tea, coffee or nothing; if she says nothing, ..."
        return survey.said(nothing)
    name = survey.call.save_as
    if not any(each is survey.call for each in nodes(tuple(d.done))):
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    heard = Try((survey.call,), (Remember(name, Text("")),))
    d.done[:] = exchanged(d.done, survey.call, [heard])
    return Compare(Recall(name), "==", Text(""))
