"""Where things are taken from, if that is said in a sentence of its own.

"Every meeting room needs a bottle of water. The bottles are in the kitchen." Said before, it is
kept and used where a thing is fetched and nothing else is said of where it is; said afterwards, the
command before is made anew with it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.language import Language
from grammar.meanings.deliveries import inside
from grammar.meanings.registry import meaning
from grammar.memory import Scene
from grammar.plan import Ask, Call, Items, Recall, Step, Text, Value
from grammar.tidy import nodes
from grammar.wordforms import singular


@dataclass(frozen=True)
class Fetching:
    """A command that fetches things of which nobody has said where they are."""

    again: Callable[[], Steps]
    """Makes it once more."""
    steps: Steps
    things: frozenset[Value]
    scene: Scene
    """The scene in which it began."""
    variables: frozenset[str]


def told_where(d: Discourse, thing: Thing) -> None:
    """A thing is said to be at a place: the command before looks for it there, and so do those that
    follow."""
    if thing.person or not isinstance(thing.place, Text | Items):
        return
    d.deliveries = replace(d.deliveries, said_to_be=(*d.deliveries.said_to_be, thing))
    source = Where(thing.place)
    fetching = just_fetched(d)
    if fetching is not None and any(is_called(d, thing, each) for each in fetching.things):
        of_one = d.deliveries.fetched_list is not None  # what is said of one of a list
        d.done.extend(made_anew(d, fetching, None if of_one else source))


def all_there_are(thing: Thing) -> Thing:
    """Several things that are said to be somewhere: "them" are all of them."""
    several = thing.plural and not thing.person and thing.count is None
    return replace(thing, every=True) if several else thing


def where_told(d: Discourse, thing: Thing) -> Thing:
    """A thing that is to be fetched, with the place where such a thing is said to be."""
    said_of_it = thing.place is not None or thing.furniture is not None or thing.here
    if (
        said_of_it
        or thing.pronoun
        or thing.value in d.scene.now_at
        or d.scene.holding == thing.value
    ):
        return thing
    if d.deliveries.taken_from is not None:
        return replace(
            thing, place=d.deliveries.taken_from.place, furniture=d.deliveries.taken_from.furniture
        )
    known = (each for each in reversed(d.deliveries.said_to_be) if is_called(d, each, thing.value))
    there = next(known, None)
    if there is None:
        return thing
    return replace(thing, place=there.place, furniture=there.furniture)


def is_called(d: Discourse, known: Thing, value: Value) -> bool:
    """Whether a thing may be meant by what another was called: "the bottles", "the water", for a
    bottle of water; "everything" is anything."""
    if known.value == value or (known.every and not known.noun):
        return True
    if not isinstance(value, Text) or not known.text:
        return False
    one, other = content(known.text, d.language), content(value.value, d.language)
    return one <= other or other <= one


def content(words: str, language: Language) -> frozenset[str]:
    return frozenset(singular(each, language) for each in words.split())


# --- the command before


def keep_fetching(
    d: Discourse,
    again: Callable[[], Steps],
    steps: Steps,
    scene: Scene,
    known: frozenset[str],
) -> None:
    """Keep a command that takes things from nobody knows where."""
    things = frozenset(unsourced(steps))
    if things:
        d.deliveries = replace(d.deliveries, fetching=Fetching(again, steps, things, scene, known))


def unsourced(steps: Steps) -> Iterator[Value]:
    """The things that are taken where the robot is, or wherever they are found."""
    inside = list(nodes(tuple(steps)))
    sought = {
        each.arguments["thing"]
        for each in inside
        if isinstance(each, Call | Ask) and each.method == "find" and has_place(each)
    }
    for each in inside:
        if (
            isinstance(each, Call)
            and each.method == "grab"
            and each.arguments["thing"] not in sought
        ):
            yield each.arguments["thing"]


def has_place(search: Call | Ask) -> bool:
    place = search.arguments.get("place")
    return place is not None and not (isinstance(place, Recall) and place.name.startswith("source"))


def just_fetched(d: Discourse) -> Fetching | None:
    """That command, if nothing has been done since."""
    fetching: Fetching | None = d.deliveries.fetching
    last: Step | None = d.done[-1] if d.done else None
    if fetching is None or last is None or last is not fetching.steps[-1]:
        return None
    return fetching


def made_anew(d: Discourse, fetching: Fetching, source: Where | None) -> Steps:
    """The steps of a command, with what is fetched taken from there."""
    del d.done[-len(fetching.steps) :]
    d.scene = fetching.scene
    d.variables &= fetching.variables
    outer = d.deliveries.taken_from
    d.deliveries = replace(d.deliveries, taken_from=source)
    steps = fetching.again()
    d.deliveries = replace(d.deliveries, taken_from=outer)
    return steps


def sourced(d: Discourse, node: Node) -> Steps | None:
    """The steps of the command before, if this one only says from where: "We need two chairs. Get
    them from the lounge."."""
    fetching = just_fetched(d)
    thing = node.parts.get("thing")
    if fetching is None or "from" not in node.parts or not isinstance(thing, Node):
        return None
    whereto = node.parts.get("where")
    there = whereto is None or any(each.means == "place_there" for each in inside(whereto))
    if thing.means != "thing_it" or "person_ref" in node.parts or not there:
        return None
    source: Where = d.get(node, "from")
    return made_anew(d, fetching, source) if source.place is not None else None


@meaning("all_there")
def all_there(d: Discourse, node: Node) -> Steps:
    """ "everything is in the kitchen"."""
    spot: Where = d.get(node, "from")
    if spot.place is None:
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    told_where(d, Thing(Text(""), place=spot.place, furniture=spot.furniture, every=True))
    return []
