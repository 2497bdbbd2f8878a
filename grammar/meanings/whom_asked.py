"""Who is asked where a question names nobody, or all of a kind."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, Steps, Thing
from grammar.meanings.finding import met_just_before, visits_only
from grammar.meanings.one_round import round_of_steps
from grammar.meanings.persons import known_by_name
from grammar.plan import Call, ForEach, Items, Recall, Text
from grammar.wordforms import singular

MET_AND_TOLD: Final = 2
"""Steps of a round in which people are gone to and told something."""


def all_meant(d: Discourse, node: Node) -> Thing | None:
    """Everybody who is there, if they are meant: "ask who wants tea", "let them vote"."""
    question = node.parts.get("question")
    each = isinstance(question, Node) and "each" in question.production.fixed
    voting = node.production.fixed.get("vote", False)
    if voting and d.scene.person is not None and d.scene.person.group is not None:
        return d.scene.person
    if not (each or voting or asks_anybody(d, question)):
        return None
    return Thing(Text(ANYONE), person=True, plural=True, here=True)


def asks_anybody(d: Discourse, question: Leaf | Node | None) -> bool:
    """Whether nobody was named and whoever is there is meant: "frag in der Küche, ob jemand Tee
    will"."""
    asked = question.parts.get("asked") if isinstance(question, Node) else None
    anybody = set(d.language.speech.get("somebody_else", ()))
    said = set() if asked is None else set(d.norms(asked.start, asked.end))
    return bool(anybody & said) and d.scene.with_person is None


def just_visited(d: Discourse) -> Thing | None:
    """Those who were gone to one by one for nothing else: "go to Alice and Bob and ask if ..."."""
    last = d.done[-1] if d.done else None
    if not isinstance(last, ForEach) or not isinstance(last.items, Items):
        return None
    visits_only(d, last.items)
    if d.done and d.done[-1] is last:
        return None
    return Thing(Text(ANYONE), person=True, plural=True, known=True, group=last.items)


def gone_to(d: Discourse) -> Thing | None:
    """Those to whom the robot was sent, whoever they are: "go to everybody in the library and ask
    whether ..."."""
    person: Thing | None = d.scene.person
    last = d.done[-1] if d.done else None
    if person is None or not (person.plural and person.here) or person.known:
        return None
    return person if isinstance(last, Call) and last.arguments.get("place") == d.scene.at else None


def spoken_of(d: Discourse) -> Thing | None:
    """Whoever was met just before, or is said to be where the robot is to go: "greet the man in the
    lobby and ask ...", "somebody is waving in the kitchen, go and ask ..."."""
    person: Thing | None = d.scene.person
    if (
        person is None
        or person.plural
        or person.count
        or person.group is not None
        or d.loops.in_loop
    ):
        return None
    if d.scene.with_person == person.value:
        return person if met_just_before(d, person) is not None else None
    elsewhere = person.place is not None and not person.here
    return person if elsewhere and not d.done and d.scene.with_person is None else None


def several_of_a_kind(d: Discourse, node: Node, person: Thing | None) -> Thing | None:
    """ "the visitors in the lobby": each of them."""
    part = node.parts.get("person_ref")
    if person is None or not isinstance(part, Node) or person.group or person.count:
        return person
    if part.means == "person_coming":  # one after the other
        return person
    kind = part.parts.get("kind_of_person")
    if not isinstance(kind, Leaf) or person.value != Text(str(kind.value[0])):
        return person
    said = " ".join(d.norms(kind.start, kind.end))
    if singular(said, d.language) == said:
        return person
    named = known_by_name(d, person, person.text)
    if named:
        d.scene = replace(d.scene, group=Items(named))
        return replace(person, known=True, plural=True, group=d.scene.group)
    return replace(person, value=Text(ANYONE), plural=True)


def told_in_each(d: Discourse, node: Node, person: Thing | None) -> ForEach | None:
    """The round in which people were told something, who are then asked: "tell everybody in the
    meeting rooms that it begins at three and ask whether they have questions"."""
    last = d.done[-1] if d.done else None
    part = node.parts.get("person_ref")
    if isinstance(part, Node):
        them = part.means == "person_pronoun" and d.is_plural(part)
    else:
        them = person is None
    if not isinstance(last, ForEach) or not them or len(last.steps) < MET_AND_TOLD:
        return None
    goes = last.steps[0] == Call("goto", {"place": Recall(last.variable)})
    told = last.steps[-1]
    spoken = isinstance(told, Call) and told.method == "say"
    return (
        last if goes and spoken and d.scene.person is not None and d.scene.person.plural else None
    )


def asked_in_each(d: Discourse, told: ForEach, ask: Callable[[Thing], Steps]) -> Steps:
    """What asks everybody in each of the places where they were told something."""
    d.done.pop()
    d.scene = d.scene.arrived(Recall(told.variable))
    everybody = Thing(Text(ANYONE), person=True, plural=True, here=True)
    steps = round_of_steps(d, lambda: ask(everybody))
    d.scene = d.scene.wandered()
    d.scene = d.scene.speaking_of_person(everybody)
    return [ForEach(told.variable, told.items, (*told.steps, *steps))]
