"""Questions that are put first and asked then ("What does Alice want? Ask her."), and answers that
say how much is to be brought.
"""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import ANYONE, Discourse, NotUnderstood, Steps, Thing, Where
from grammar.meanings.questions import ask_one
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import Survey
from grammar.meanings.things import deliver
from grammar.plan import Recall, Repeat, Text, Value


@meaning("ask_topic")
def ask_topic(d: Discourse, node: Node) -> Steps:
    """ "What does Alice want for dinner? Go and ask her.", "Which of them want tea? Ask them."."""
    question = node.parts["question"]
    assert isinstance(question, Node)
    person: Thing | None = d.get(question, "person_ref")
    place: Value | None = d.get(question, "asked_at")
    if person is None:  # "how many people in the lobby want coffee?"
        person = Thing(Text(ANYONE), person=True, plural=True)
    steps = ask_one(d, node, replace(person, place=place or person.place))
    d.polled_for = question.production.fixed.get("kind")
    return steps


@meaning("bring_many")
def bring_many(d: Discourse, node: Node) -> Steps:
    """ "and bring that many": as many as was answered, to whoever was asked."""
    if d.answer is None or not d.surveys:
        raise NotUnderstood(d.language.phrase("no_question"))
    survey: Survey = d.surveys[-1]
    if survey.options and not all(each.isdigit() for each in survey.options):
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    thing: Thing | None = d.get(node, "thing") or d.thing
    if thing is None:
        raise NotUnderstood(d.language.phrase("what_is_it", word=d.words(node.start, node.end)))
    source: Where | None = d.get(node, "from")
    if source is not None:
        thing = replace(thing, place=source.place, furniture=source.furniture)
    person: Thing | None = d.get(node, "person_ref")
    if person is None and survey.who is not None and survey.where is None:
        person = Thing(survey.who, known=True, person=True)
    d.at = d.with_person = None
    fetching = deliver(d, replace(thing, pronoun=False), person, d.get(node, "where"))
    return [Repeat(Recall(d.answer), tuple(fetching))]
