"""What is offered to somebody: they are asked whether they would like it, and get it if they say
yes, unless it is said what is done then."""

from __future__ import annotations

from dataclasses import dataclass, replace

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.asking import audience, put, remember_answer
from grammar.meanings.carrying import deliver
from grammar.meanings.registry import meaning
from grammar.meanings.sources import is_called
from grammar.meanings.surveys import noting
from grammar.meanings.whom_asked import several_of_a_kind
from grammar.naming import some
from grammar.plan import Call, Compare, If, Items, Recall, Text, Value
from grammar.tidy import nodes


@dataclass(frozen=True)
class Offer:
    """A question whether somebody would like a thing, and how they get it."""

    asking: Call
    thing: Thing
    giving: tuple[If, ...]
    receiver: Thing
    depth: int
    """How many sequences it was made in: what is in more of them is under a condition."""


@meaning("offer")
def offer(d: Discourse, node: Node) -> Steps:
    """ "offer the visitor a coffee"."""
    said: Thing = d.get(node, "person_ref")
    person = several_of_a_kind(d, node, said) or said
    thing: Thing = d.get(node, "thing")
    if thing.pronoun and person.plural:  # there is one of it, and it is not for all of them
        raise NotUnderstood(d.language.phrase("one_person"))
    if thing.pronoun:  # "get a coke and offer it to Bob": it is there already
        return deliver(d, thing, person, None)
    whom = audience(d, person)
    yes, no = d.language.phrase("yes"), d.language.phrase("no")
    question = d.sentence("would_you_like", thing=as_offered(d, node.parts["thing"], thing))
    arguments: dict[str, Value] = {
        "question": question,
        "options": Items((Text(yes), Text(no))),
    }
    answer = remember_answer(d, (yes, no), "answer")
    steps = put(d, whom, Call("ask", arguments, save_as=answer), (yes, no))
    survey = d.answers.surveys[-1]
    known = survey.who is not None
    receiver = Thing(survey.who or person.value, known=known, person=True, here=True)
    giving = If(Compare(Recall(answer), "==", Text(yes)), tuple(brought_there(d, thing, receiver)))
    offer = Offer(survey.call, thing, (giving,), receiver, d.depth)
    d.deliveries = replace(d.deliveries, offers=(*d.deliveries.offers, offer))
    return steps


def brought_there(d: Discourse, thing: Thing, receiver: Thing) -> Steps:
    """How somebody gets a thing, without a change in what is spoken of."""
    scene, outer, before = d.scene, d.loops.at_people, d.deliveries.last
    d.loops = replace(d.loops, at_people=True)
    steps = d.sequence(lambda: d.done.extend(deliver(d, thing, receiver, None)))
    d.scene = scene
    d.loops = replace(d.loops, at_people=outer)
    d.deliveries = replace(d.deliveries, last=before)
    d.scene = d.scene.speaking_of(thing)
    return steps


def if_they_want_it(d: Discourse, thing: Thing, person: Thing | None, steps: Steps) -> Steps:
    """ "offer Bob a coffee and bring it to him from the kitchen": if he says yes."""
    made = next(
        (each for each in reversed(d.deliveries.offers) if each.thing.value == thing.value), None
    )
    if made is None or not steps or d.depth > made.depth:
        return steps
    if person is not None and person.value != made.receiver.value:
        return steps
    return [If(made.giving[0].condition, tuple(steps))]


def as_offered(d: Discourse, part: Leaf | Node, thing: Thing) -> str:
    """What is offered, in the words that it was said with: "some cake", "tea"."""
    head = part.parts.get("head") if isinstance(part, Node) else None
    definite = d.tokens[part.start].norm in d.language.speech.get("definite", ())
    if head is None or definite or thing.pronoun:
        return some(d.called(thing.text), d.language)
    return d.words(part.start, head.end)


def with_offers_kept(d: Discourse, steps: Steps) -> Steps:
    """All steps of a plan: what was offered is brought to whoever wants it, unless it is brought
    to anybody anyway."""
    for made in d.deliveries.offers:
        taken = (each for each in nodes(tuple(steps)) if is_grab_of(d, each, made.thing))
        if next(taken, None) is None:
            steps = list(noting(steps, made.asking, list(made.giving)))
    return steps


def is_grab_of(d: Discourse, step: object, thing: Thing) -> bool:
    """Whether a step takes what may be a thing that was spoken of."""
    if not isinstance(step, Call) or step.method != "grab":
        return False
    value = step.arguments["thing"]
    return isinstance(value, Recall) or is_called(d, thing, value)
