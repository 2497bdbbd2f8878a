"""Whom the robot is sent to so that they hear something: "go to Bob and tell him where Alice is".
What they are told is found out first, and then the robot goes to them."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node, what_it_means
from grammar.discourse import Discourse, Thing
from grammar.meanings.persons import is_me
from grammar.meanings.places import own_place
from grammar.plan import Ask, Call, If, Remember, Step, Text


def sent_to(d: Discourse, person: Thing | None) -> Thing | None:
    """Whoever the last step goes to, as somebody who is gone to later: that step is taken back;
    None if it goes to nobody, or to somebody else."""
    if person is None or is_me(person) or not person.known or not d.done:
        return None
    own = own_place(d, person)
    if d.done[-1] == Call("find", {"thing": person.value}):
        own = None
    elif own is None or d.done[-1] != Call("goto", {"place": own}):
        return None
    d.done.pop()
    d.scene = d.scene.wandered()
    later = replace(person, here=False, pronoun=False, place=own)
    d.scene = d.scene.speaking_of_person(later)
    return later


def searched_before(d: Discourse, node: Node) -> tuple[Thing, Thing] | None:
    """ "find Alice, then go to Bob and tell him where she is": who was looked for, and who hears
    it."""
    part = node.parts.get("whom") or node.parts.get("person_ref")
    if any(
        each is not None
        for each in (d.reports.last, d.answers.last, d.answers.code, d.branch.claim, d.reports.news)
    ):
        return None
    if part is None or what_it_means(part) != "person_pronoun" or d.scene.person is None:
        return None
    looked = named_in(d, d.done[-2]) if len(d.done) > 1 else None
    if looked is None or looked.value == d.scene.person.value:
        return None
    receiver = sent_to(d, d.scene.person)
    if receiver is None:
        return None
    d.scene = replace(d.scene, thing_last=not looked.person)
    return looked, receiver


def named_in(d: Discourse, step: Step) -> Thing | None:
    """Who or what a step looks for, also one that would tell the speaker where they are."""
    match step:
        case Call("find", {"thing": Text() as sought}):
            found = sought
        case If(then=(Remember(value=Ask(method="location")), *_)):
            asked = getattr(step.condition, "value", None)
            named = asked.arguments.get("thing") if isinstance(asked, Ask) else None
            if not isinstance(named, Text):
                return None
            found = named
        case _:
            return None
    known = any(each.name == found.value for each in d.lexicon.people)
    return Thing(found, known=known, person=known)
