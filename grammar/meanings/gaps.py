"""What is brought elsewhere without the verb again: "the cup to Alice and the blanket to Bob", "two
apples to Alice and one to Bob"."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.carrying import deliver
from grammar.meanings.places import source_of
from grammar.meanings.registry import meaning
from grammar.meanings.several_things import last_deed, over_things
from grammar.meanings.things import bring
from grammar.slips import command_words
from grammar.texts.words import words_for


@meaning("bring_too")
def bring_too(d: Discourse, node: Node) -> Steps:
    """ "take the cup to Alice and the blanket to Bob": the second, too."""
    last = last_deed(d)
    if last is None and not whole(d, node):
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    if last is not None and last.method == "put":
        d.scene = replace(
            d.scene, at=None
        )  # what goes elsewhere is not where the first one was put
    return bring(d, node)


@meaning("bring_as_many")
def bring_as_many(d: Discourse, node: Node) -> Steps:
    """ "two apples to Alice and one to Bob": others of the same, from the same place."""
    last, before = last_deed(d), d.scene.thing
    if last is None or before is None or not before.noun:
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    number = int(d.get(node, "number"))
    others = replace(
        before, count=number if number > 1 else None, plural=number > 1, pronoun=False, here=False
    )
    if others.place is None:
        others = replace(others, place=source_of(d, before))
    person: Thing | None = d.get(node, "person_ref")
    spot: Where | None = d.get(node, "where")
    d.scene = replace(d.scene, at=None, holding=None)

    def one(thing: Thing) -> Steps:
        return deliver(d, thing, person, spot)

    return over_things(d, node, others, one) if number > 1 else one(others)


def whole(d: Discourse, node: Node) -> bool:
    """Whether a command without a verb says from where and where to: "cup from here to there"."""
    orders = command_words(d.language) | words_for(d.language).verbs
    if d.tokens[node.start].norm in orders:  # "go from here to there"
        return False
    thing: Thing = d.get(node, "thing")
    return not d.done and (thing.place is not None or thing.furniture is not None)
