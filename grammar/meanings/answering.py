"""Answering the questions of people, and listening to them."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, Steps, Thing, Where
from grammar.meanings.descriptions import described
from grammar.meanings.finding import speak_to
from grammar.meanings.orders_to_tell import tell_speaker
from grammar.meanings.persons import is_me
from grammar.meanings.registry import meaning
from grammar.plan import Call, Text, Value
from grammar.tidy import nodes


@meaning("answer")
def answer(d: Discourse, node: Node) -> Steps:
    """Answer somebody's question from the predefined ones."""
    person: Thing | None = d.get(node, "person_ref")
    if person is not None and person.plural and person.text != ANYONE:
        person = replace(person, plural=False)  # "the girls question" is the girl's
    known = node.parts.get("question_known")
    if is_me(person) and known is None and d.answers.last is not None:
        return tell_speaker(d)  # "come back and give me the answer"
    arguments: dict[str, Value] = {}
    if isinstance(known, Leaf):
        arguments["question"] = Text(known.value[0].question)
    steps = [Call("answer", arguments)]
    bare = node.production.fixed.get("it") or not node.parts
    if bare and any(each == steps[0] for each in nodes(tuple(d.done[-1:]))):
        return []  # "the girl has a question, answer it"
    if answered_already(d, node, person):
        return []
    spot: Where | None = d.get(node, "from") or d.get(node, "where")
    if person is None and spot is None and known is None and d.scene.person is not None:
        elsewhere = (
            d.scene.person.place is not None
            and d.scene.person.place != d.scene.at
            and not d.scene.person.plural
        )
        if elsewhere and not d.scene.person.here and d.scene.with_person != d.scene.person.value:
            person = d.scene.person  # "the girl in the study has a question, please respond"
    if person is not None and spot is not None:
        person = replace(person, place=spot.place, here=False)
    if person is not None and "mods" in node.parts:  # "the man's question who is waving"
        more = described(d, person.text, node)
        value = person.value if person.known else more.value
        person = replace(person, value=value, place=more.place or person.place)
    if person is None or is_me(person):
        if spot is not None and spot.place is not None:
            d.went(spot.place)
            return [Call("goto", {"place": spot.place}), *steps]
        return [*steps]
    speaking = speak_to(d, person, [*steps])
    d.answers = replace(
        d.answers, claimed_question=speaking[-1] if node.production.fixed.get("claimed") else None
    )
    return speaking


def answered_already(d: Discourse, node: Node, person: Thing | None) -> bool:
    """ "the girl has a question, answer whatever she asks": it is the same."""
    claimed = d.answers.claimed_question
    just = claimed is not None and bool(d.done) and d.done[-1] is claimed
    same = (
        person is None
        or person.pronoun
        or (d.scene.person and person.value == d.scene.person.value)
    )
    return just and not node.production.fixed.get("claimed") and bool(same)


@meaning("listen")
def listen(d: Discourse, node: Node) -> Steps:
    d.answers = replace(d.answers, heard=d.variable("heard"))
    d.answers = replace(d.answers, last=d.answers.heard, options=())
    return [Call("listen", {}, save_as=d.answers.heard)]
