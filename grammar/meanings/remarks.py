"""What people say besides: where somebody is, how somebody is called, why something is wanted.

A remark asks for nothing. What it tells of places and names is used by the commands around it; the
rest is kept in the plan as background, where it is shown and not acted on.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterable
from dataclasses import replace
from typing import Final, TypeVar

import msgspec

from grammar.chart import Leaf, Node, what_it_means
from grammar.discourse import Discourse, Steps, Thing, Where, as_value
from grammar.errors import NotUnderstood
from grammar.meanings.genders import gender_of_thing
from grammar.meanings.options import people_named
from grammar.meanings.persons import is_me
from grammar.meanings.registry import meaning
from grammar.meanings.reports import Report
from grammar.meanings.sources import all_there_are, told_where
from grammar.meanings.speaking import sentence_form
from grammar.plan import Ask, Call, Items, Text, Value
from grammar.texts.words import words_for
from grammar.tidy import replaced

SUBJECTS: Final = ("person_ref", "place", "thing")
"""Parts that a remark can be about."""

_Node = TypeVar("_Node", bound=msgspec.Struct)


@meaning("remark")
def remark(d: Discourse, node: Node) -> Steps:
    """ "the coffee machine is broken", "because I do not hear well". Of whom or what it speaks can
    be spoken of as "her" or "it" from now on, and what it says can be told to somebody."""
    if d.tokens[node.start].norm in d.language.speech.get("no_remark", ()):
        words = d.words(node.start, node.end)  # "wherever there are none, ...": a condition
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    refuse_order(d, node)
    for name, part in node.parts.items():
        if name in SUBJECTS:
            verb = d.tokens[part.end].spelled if part.end < node.end else ""
            if verb in d.language.speech.get("no_verbs", ()):  # "donner à Bob" is no "Bob has"
                words = d.words(node.start, node.end)
                raise NotUnderstood(d.language.phrase("not_understood", part=words))
            with contextlib.suppress(NotUnderstood):  # it may speak of what nobody knows
                d.build(part)
                if node.production.fixed.get("coming") and d.scene.person is not None:
                    d.scene = replace(d.scene, person=expected(d.scene.person))
    named = people_named(d, node.start, node.end)
    if len(named) == 1:  # "a letter came for Bob"
        d.scene = d.scene.speaking_of_person(Thing(Text(named[0]), person=True, known=True))
    if not node.production.fixed.get("own"):
        told = Report("only", Text(sentence_form(_said(d, node))), about_here=False)
        d.reports = replace(d.reports, last=told, step=None)
    return aside(d, node)


def refuse_order(d: Discourse, node: Node) -> None:
    """Where nouns have articles, "va à l'accueil et attends Julie" tells of nobody called "va"."""
    first = d.tokens[node.start].norm
    orders = words_for(d.language).verbs - words_for(d.language).nouns_too
    if d.language.speech.get("head_first") and first in orders:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))


def expected(person: Thing) -> Thing:
    """Somebody who is still to come, and so has to be waited for."""
    someone = not person.known and person.count is None and not person.plural
    return replace(person, first=someone, here=False)


def aside(d: Discourse, node: Node) -> Steps:
    """Nothing to do, but something to show; what is asked is no remark."""
    asked = d.text[d.tokens[node.end - 1].end :].lstrip().startswith("?")
    if asked and not node.production.fixed.get("own"):
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    d.background += (_said(d, node),)
    return []


def _said(d: Discourse, node: Node) -> str:
    """The words of a remark, with those at its end that say nothing."""
    end = node.end
    while (
        end < len(d.tokens)
        and d.tokens[end].kind == "word"
        and ((d.tokens[end].norm,) in d.language.fillers)
    ):
        end += 1
    return d.words(node.start, end)


@meaning("remark_name")
def remark_name(d: Discourse, node: Node) -> Steps:
    """ "her name is Grace": "her" and "my wife" are Grace from now on."""
    before = d.scene.person
    person: Thing = d.get(node, "person_ref")
    if before is not None and not before.known and person.known:
        d.done[:] = [replaced(step, before.value, person.value) for step in d.done]
    return aside(d, node)


@meaning("remark_thing")
def remark_thing(d: Discourse, node: Node) -> Steps:
    """ "somebody lost a scarf": what, and who, is spoken of then."""
    d.get(node, "person_ref")
    thing: Thing = d.get(node, "thing")
    d.scene = d.scene.speaking_of(thing)
    d.deliveries = replace(d.deliveries, mislaid=thing.value)
    return aside(d, node)


@meaning("remark_where")
def remark_where(d: Discourse, node: Node) -> Steps:
    """ "bring it to Alice, she is in ward a", "I forgot my bag in the cafeteria": where to look."""
    who_is = node.parts.get("person_ref")
    person: Thing | list[Thing] | None = d.build(who_is) if who_is is not None else None
    crowd = d.scene.person is not None and d.scene.person.plural and d.scene.person.group is None
    if person is None and crowd and d.gender(node.start, node.start + 2) and d.people.last_named:
        d.scene = replace(
            d.scene, person=d.people.last_named
        )  # "tell Ada how many visitors are in the lobby, she is in ..."
    spot: Where = d.get(node, "where")  # "Alice is in her office": after her
    place = spot.place
    thing: Thing | None = d.get(node, "thing")
    if isinstance(person, list):  # "Alice or Bob is in the lobby": nobody knows which
        return aside(d, node)
    if mislaid(d, who_is) is not None:
        person = None
    it = node.production.fixed.get("it") or (person is None and may_be_it(d, node))
    it = it or mislaid(d, who_is) is not None
    either = (
        isinstance(place, Items) and d.scene.thing is not None
    )  # things are in one place or another
    if either or (is_me(d.scene.person) and d.gender(node.start, node.start + 2)):
        it = True  # "hol mir meine Brille, sie ist im Büro": no word for whoever says so
    who = person or (d.scene.person if thing is None and not it else None)
    if thing is None and who is not None:
        d.scene = d.scene.speaking_of_person(replace(who, place=place, furniture=spot.furniture))
        d.scene = replace(d.scene, with_person=None)
        known_to_be(d, who.value, place)
        fetched_there(d, who, place)
    else:
        what = thing or d.scene.thing
        if isinstance(what, Thing):  # of several, each is where it is
            there = all_there_are(replace(what, place=place, furniture=spot.furniture))
            d.scene = d.scene.speaking_of(there)
            told_where(d, there)
            known_to_be(d, what.value, place)
    if place is not None:
        d.whereabouts += ((_said(d, node), place),)
    return aside(d, node)


@meaning("remark_lacking")
def remark_lacking(d: Discourse, node: Node) -> Steps:
    """ "there is no whiteboard in lecture hall 2": one that is brought then goes there."""
    thing: Thing = d.get(node, "thing")
    spot: Where = d.get(node, "where") or Where(d.get(node, "place"))
    d.scene = d.scene.speaking_of(replace(thing, place=None, furniture=None))
    d.scene = replace(d.scene, lacking=replace(thing, place=spot.place, furniture=spot.furniture))
    d.scene = replace(d.scene, place=spot.place)
    return aside(d, node)


def mislaid(d: Discourse, part: Leaf | Node | None) -> Thing | None:
    """What "il" and "elle" speak of where somebody was said to wait or to look for something: "le
    docteur attend son dossier, il est à l'accueil"."""
    pronoun = part is not None and what_it_means(part) == "person_pronoun"
    known = (
        d.scene.thing_last
        and d.scene.thing is not None
        and d.scene.thing.value == d.deliveries.mislaid
    )
    return d.scene.thing if pronoun and known else None


def may_be_it(d: Discourse, node: Node) -> bool:
    """Whether the pronoun here may stand for the thing that was spoken of last: "er liegt auf dem
    Tisch", said of a scarf."""
    gender = d.gender(node.start, node.start + 2)
    if gender is not None and d.scene.thing is not None and d.scene.person is not None:
        thing = gender_of_thing(d, d.scene.thing) in (None, gender)
        return thing and not d.may_have(d.scene.person, gender)
    things = set(d.language.speech.get("things_too", ()))
    return d.scene.thing_last and bool(things & set(d.norms(node.start, node.start + 2)))


def fetched_there(d: Discourse, who: Thing, place: Value | None) -> None:
    """ "take my father to radiology, he is in the lobby": nobody is led who is elsewhere."""
    if place is None or any(
        isinstance(step, Call)
        and step.method == "find"
        and step.arguments.get("thing") == who.value
        for step in d.done
    ):
        return
    for at, step in enumerate(d.done):
        if not (isinstance(step, Call) and step.method in ("guide", "follow")):
            continue
        if step.arguments.get("person") == who.value:
            d.done.insert(at, Call("find", {"thing": who.value, "place": place}))
            return


def known_to_be(d: Discourse, value: Value, place: Value | None) -> None:
    """Let the steps so far look for somebody or something where they are said to be."""
    if place is not None and not isinstance(place, Items):  # one of several is looked through
        d.done[:] = [_looking_at(step, value, place) for step in d.done]


def _looking_at(part: _Node, value: Value, place: Value) -> _Node:
    changes: dict[str, object] = {}
    for name in part.__struct_fields__:
        inside = getattr(part, name)
        if isinstance(inside, msgspec.Struct):
            changes[name] = _looking_at(inside, value, place)
        elif isinstance(inside, tuple):
            changes[name] = tuple(_each_looking_at(inside, value, place))
    changed = msgspec.structs.replace(part, **changes) if changes else part
    if (
        isinstance(changed, Call | Ask)
        and changed.method == "find"
        and changed.arguments == {"thing": as_value(value)}
    ):
        arguments = {**changed.arguments, "place": place}
        return msgspec.structs.replace(changed, arguments=arguments)
    return changed


def _each_looking_at(parts: Iterable[object], value: Value, place: Value) -> Iterable[object]:
    for part in parts:
        yield _looking_at(part, value, place) if isinstance(part, msgspec.Struct) else part
