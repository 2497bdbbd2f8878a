"""Whether something is true of a place, as a condition: "if the kitchen is empty", "if it has no
stapler"."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import ANYONE, START, Discourse, Meeting, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.answered import about_answer, so_many_said
from grammar.meanings.answers import Said
from grammar.meanings.conditions import negated
from grammar.meanings.news import in_round
from grammar.meanings.persons import is_me
from grammar.meanings.registry import meaning
from grammar.meanings.searches import just_looked_for
from grammar.meanings.some_places import at_none
from grammar.meanings.surveys import asked_yet
from grammar.meanings.there import just_checked
from grammar.meanings.traits import Trait
from grammar.plan import Call, Condition, Not, Recall, Text, Value


@meaning("trait_holds")
def trait_holds(d: Discourse, node: Node) -> Condition:
    """ "if the kitchen is empty", "if it has no stapler": found out there; "if none of them is
    empty": on the whole round (`grammar.meanings.first_match`)."""
    place: Value | None = d.get(node, "trait_place")
    none = node.production.fixed.get("of_round") == "none"
    asked_for = about_answer(d, node) if place is None and not none else None
    if asked_for is not None:  # "ask him whether he has a pain. If he has a pain, ..."
        return asked_for
    if none and not asked_yet(d) and (of_kind := at_none(d, node)) is not None:
        return of_kind
    if none and asked_yet(d) and not in_round(d):
        part = node.parts["place_trait"]
        return so_many_said(d, node, Said(part.start, part.end))
    of_them = d.scene.person is not None and d.gender(node.start, node.start + 1) is not None
    known = d.scene.at is not None or d.scene.place is not None
    if place is None and (not known or (of_them and may_be_them(d, node))):  # "if she has a minute"
        words = d.words(node.start, node.end)
        gap = (node.start, node.end)
        raise NotUnderstood(d.language.phrase("cannot_check", what=words), gap=gap)
    if place is None and d.scene.at == Recall(START) and isinstance(d.scene.place, Text):
        place = d.scene.place  # "is the library free? If it is, ...": told where it was asked
    if place is not None and place != d.scene.at:
        d.went(place)
        d.need_first(Call("goto", {"place": place}))
    d.branch = replace(d.branch, room=place or d.scene.at or d.scene.place)
    trait: Trait = d.get(node, "place_trait")
    checked = checked_just_now(d, trait) if place is None else None
    if checked is not None:
        return checked
    if place is None and trait.thing is not None and (looked := just_looked_for(d, trait.thing)):
        d.branch = replace(
            d.branch, met=Meeting(trait.thing, holds=not trait.denied, sought=not in_round(d))
        )
        return Not(looked) if trait.denied else looked
    d.need_first(*trait.first)
    if trait.thing is not None and in_round(d):
        d.branch = replace(d.branch, met=Meeting(trait.thing, holds=not trait.denied))
    return negated(trait.condition) if none else trait.condition


def may_be_them(d: Discourse, node: Node) -> bool:
    """Whether the pronoun that a condition begins with may be somebody: "if she is free"."""
    who = d.scene.person
    if who is None or is_me(who) or who.text == ANYONE:
        return False
    return d.may_be(who, node.start, node.start + 1)


def checked_just_now(d: Discourse, trait: Trait) -> Condition | None:
    """ "check if anybody is in the hall. If it is empty, ...": what the step before looked at."""
    if d.reports.last is None:
        return None
    about: Thing | None = d.reports.last.thing
    known = just_checked(d, trait.thing or Thing(Text(ANYONE), person=True))
    if known is None or about is None:
        return None
    # Those who are in a room may be several, so that "her" is somebody else.
    d.branch = replace(
        d.branch,
        met=Meeting(replace(about, plural=about.person or about.plural), holds=not trait.denied),
    )
    return Not(known) if trait.denied else known
