"""Two counts of one place, told together: "how many men and how many women are in the lobby"."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import Discourse, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.descriptions import described
from grammar.meanings.places import sought
from grammar.meanings.registry import meaning
from grammar.meanings.reports import Report
from grammar.meanings.sights import count_report
from grammar.plan import Ask, Recall, Remember


@meaning("counted_both")
def counted_both(d: Discourse, node: Node) -> Report:
    """What is said of where the ones are holds for the others; of the same kind, "how many of them
    are lying" has no noun."""
    said: Thing = d.get(node, "first")
    other: Thing = d.get(node, "second") or said
    own = {"second": {"mods_after"}, "first": {"mods"} if other is said else set()}
    one, two = (
        with_mods(d, node, thing, own[part]) for part, thing in (("first", said), ("second", other))
    )
    where = one if one.place is not None else two
    one, two = (replace(each, place=where.place, furniture=where.furniture) for each in (one, two))
    names = d.variable("count"), d.variable("count")
    things, others = (dict(count_report(d, each).words)["things"] for each in (one, two))
    looks = tuple(
        Remember(name, Ask("count", {"thing": sought(d, each)}))
        for name, each in zip(names, (one, two), strict=True)
    )
    d.reports = replace(d.reports, last_counted=two)
    words = (("things", things), ("others", others), ("other", Recall(names[1])))
    return Report("counted_both", Recall(names[0]), where.place, words, name="counts", before=looks)


@meaning("those_spoken_of")
def those_spoken_of(d: Discourse, node: Node) -> Thing:
    """ "is anybody sitting in the cafeteria? Count them": people or things, where they were said to
    be."""
    those = d.scene.thing if d.scene.thing_last or d.scene.person is None else d.scene.person
    if those is None or (those.person and (those.known or those.me)):
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    return replace(those, pronoun=False, count=None, plural=True)


def with_mods(d: Discourse, node: Node, thing: Thing, own: set[str]) -> Thing:
    """A thing with what is said of it behind the verb."""
    parts = {name: part for name, part in node.parts.items() if name in own}
    more = described(d, thing.text, replace(node, parts=parts))
    return replace(
        thing,
        value=more.value,
        place=thing.place or more.place,
        furniture=thing.furniture or more.furniture,
    )
