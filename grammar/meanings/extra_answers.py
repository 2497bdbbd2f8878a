"""What is said to a question besides the answers that it offers: that somebody is not sure, or does
not mind which."""

from __future__ import annotations

from dataclasses import replace

import msgspec

from grammar.chart import Node
from grammar.discourse import Discourse, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import Survey, exchanged
from grammar.plan import Condition, If, Items, Not, Recall, Step, Text


@meaning("answered_besides")
def answered_besides(d: Discourse, node: Node) -> Condition:
    """ "if she is not sure", "if he has no preference": said instead of an answer that was asked
    for, and offered as one from then on."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if survey is None or d.answers.last is None or survey.call.save_as != d.answers.last:
        raise NotUnderstood(d.language.phrase("no_question"))
    yes_no = {d.language.phrase("yes"), d.language.phrase("no")}
    phrase = str(node.production.fixed["phrase"])
    if phrase == "no_preference" and set(survey.options) == yes_no:
        return survey.said(d.language.phrase("yes"))  # "if she does not mind"
    besides = d.language.phrase(phrase)
    known = next((each for each in survey.options if _is_said(d, each, node)), None)
    if known is not None or not survey.options:  # "tea, coffee or maybe"
        return survey.said(known or besides)
    return with_answer(d, survey, besides).said(besides)


def _is_said(d: Discourse, option: str, node: Node) -> bool:
    words = d.language.tokens_of(option)
    return bool(words) and set(words) <= set(d.norms(node.start, node.end))


def with_answer(d: Discourse, survey: Survey, besides: str) -> Survey:
    """A question that was asked, with one more answer to choose."""
    if besides in survey.options:
        return survey
    options = (*survey.options, besides)
    arguments = {**survey.call.arguments, "options": Items(tuple(map(Text, options)))}
    call = msgspec.structs.replace(survey.call, arguments=arguments)
    for steps in (*d.around, d.done):
        steps[:] = exchanged(steps, survey.call, [call])
        steps[:] = [_no_else(d, survey, each) for each in steps]
    anew = replace(survey, call=call, options=options)
    surveys = tuple(anew if each is survey else each for each in d.answers.surveys)
    d.answers = replace(d.answers, surveys=surveys, options=options)
    return anew


def _no_else(d: Discourse, survey: Survey, step: Step) -> Step:
    """What was to be done unless somebody said yes, only if they say no."""
    yes, no = (survey.said(d.language.phrase(each)) for each in ("yes", "no"))
    match step:
        case If(condition=Not(condition=condition)) if condition == yes:
            return If(no, step.then, step.otherwise)
        case If(condition=condition, otherwise=(_, *_)) if condition == yes:
            return If(yes, step.then, (If(no, step.otherwise),))
        case _:
            return step


@meaning("person_answered")
def person_answered(d: Discourse, node: Node) -> Thing:
    """ "ask Alice who has the key and ask that person for it": whom the answer names; where nobody
    was asked for, whoever is spoken of."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    question = survey.call.arguments["question"] if survey is not None else None
    words = d.language.tokens_of(question.value) if isinstance(question, Text) else ()
    who = set(d.language.speech.get("asks_somebody", ())) & set(words[:2])
    if survey is not None and survey.call.save_as is not None and who and not survey.options:
        named = Thing(Recall(survey.call.save_as), known=True, person=True)
        d.scene = d.scene.speaking_of_person(named)
        return named
    if d.scene.person is None or d.scene.person.plural or node.end - node.start > 2:
        raise NotUnderstood(d.language.phrase("no_question"))
    return replace(d.scene.person, here=d.scene.with_person == d.scene.person.value)
