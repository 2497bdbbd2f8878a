"""What a round leaves out, said behind it: "go to every office and say hello, but not to Bob's"."""

from __future__ import annotations

from msgspec.structs import replace

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.place_loops import last_round
from grammar.meanings.places import place_called_after
from grammar.meanings.registry import meaning
from grammar.plan import Ask, ForEach, Items, Text, Value


@meaning("places_left_out")
def places_left_out(d: Discourse, node: Node) -> Steps:
    """ "except Bob's office", "but not at Alice's": the last round does not go there."""
    at = last_round(d)
    loop = d.done[at] if at is not None else None
    first: Value | Thing = d.get(node, "but")
    if isinstance(first, Thing):  # "but not at Bob's"
        first = place_called_after(d, first.text, node)
    but = {first, *(d.get(node, "place_list") or ())}
    places = gone_to(d, loop.items) if isinstance(loop, ForEach) else ()
    if at is None or not isinstance(loop, ForEach) or not but <= set(places):
        raise NotUnderstood(d.language.phrase("which_places"))
    left = tuple(each for each in places if each not in but)
    d.done[at] = replace(loop, items=Items(left))
    return []


def gone_to(d: Discourse, items: Value) -> tuple[Value, ...]:
    """The places that a round goes to, by name."""
    match items:
        case Items(names):
            return names
        case Ask("places", {"kind": Text(kind)}):
            return tuple(Text(each.name) for each in d.lexicon.place_kinds[kind])
        case Ask("places"):
            return tuple(Text(each.name) for each in d.lexicon.places)
    return ()
