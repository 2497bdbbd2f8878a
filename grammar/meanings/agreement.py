"""Whether people have given the same answer, and which: "if both say the same, tell Alice so"."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import Discourse
from grammar.errors import NotUnderstood
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import Survey, asked_before, in_loop, note
from grammar.plan import (
    Both,
    Call,
    Compare,
    Condition,
    ForEach,
    Holds,
    If,
    Increase,
    Items,
    Not,
    Number,
    Recall,
    Remember,
    Step,
    Text,
    Truth,
    Value,
)
from grammar.tidy import nodes


@meaning("answers_same")
def answers_same(d: Discourse, node: Node) -> Condition:
    """ "if both say the same", "if they disagree", "if it is the same"."""
    condition = same_answers(d, node)
    if node.production.fixed.get("consent") and d.answers.agreed is not None:
        condition = _consent(d, condition, *d.answers.agreed)
    return Not(condition) if node.production.fixed.get("no") else condition


def _consent(d: Discourse, alike: Condition, asked: Call, answer: Value) -> Condition:
    """ "if both agree": they say the same, and where that may be yes or no, they say yes."""
    yes, no = (Text(d.language.phrase(each)) for each in ("yes", "no"))
    if asked.arguments.get("options") != Items((yes, no)):
        return alike
    return Both((alike, Compare(answer, "==", yes)))


def same_answers(d: Discourse, node: Node) -> Condition:
    """Whether all who were asked have answered alike; what they said is then `d.agreed`."""
    surveys = asked_before(d)
    last = surveys[-1]
    if in_loop(d, last.call):
        return _all_alike(d, last)
    names = list(dict.fromkeys(each.call.save_as for each in surveys if each.call.save_as))
    if len(surveys) != 2 or len(names) != 2:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    d.answers = replace(d.answers, agreed=(last.call, Recall(names[0])))
    return Compare(Recall(names[0]), "==", Recall(names[1]))


def _all_alike(d: Discourse, survey: Survey) -> Condition:
    """Of a question that was put to one after the other. Somebody of those named who was not found
    has not agreed."""
    assert survey.call.save_as is not None
    answer = Recall(survey.call.save_as)
    common, alike = Recall(d.variable("common")), Recall(d.variable("alike"))
    first = Compare(common, "==", Text(""))
    other = If(Compare(answer, "!=", common), (Remember(alike.name, Truth(False)),))
    notes: list[Step] = [If(first, (Remember(common.name, answer),), (other,))]
    before: list[Step] = [Remember(common.name, Text("")), Remember(alike.name, Truth(True))]
    d.answers = replace(d.answers, agreed=(survey.call, common))
    if d.scene.thing is not None and d.scene.thing.value == answer:
        d.scene = replace(
            d.scene, thing=replace(d.scene.thing, value=common)
        )  # "if they want the same, bring it"
    d.answers = replace(d.answers, last=common.name)
    named = _named(d, survey)
    condition: Condition = Holds(alike)
    if named is not None:
        answered = Recall(d.variable("answered"))
        notes.append(Increase(answered.name))
        before.append(Remember(answered.name, Number(0)))
        condition = Both((condition, Compare(answered, "==", Number(named))))
    note(d, survey.call, notes, before)
    return condition


def _named(d: Discourse, survey: Survey) -> int | None:
    """How many people were named who were to be asked; None if it was whoever was there."""
    return next(
        (
            len(loop.items.items)
            for loop in nodes(tuple(d.done))
            if isinstance(loop, ForEach)
            and isinstance(loop.items, Items)
            and any(each is survey.call for each in nodes(loop))
        ),
        None,
    )
