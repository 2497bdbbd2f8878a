"""Scenes in which drafts are tried: made from what is spoken of, so that they differ where drafts
may.

Who is spoken of is at home or nowhere, things are where they are looked for or gone, people choose
one answer or another, it is early or late, and visitors come or do not. What the scenes hold is
read from the drafts and from the names of the world; nothing has to be known of the real house.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

from grammar.lexicon import Lexicon, Name, kind_of
from nl2robot.deliberation.paper_robot import START, Scene
from robot_api.methods import METHODS

VISITORS: Final = 8
_LOOKING: Final = frozenset({"find", "sees", "count", "grab", "wait_for", "describe"})


@dataclass(frozen=True)
class _Variation:
    """How one scene differs from another."""

    people: bool = True
    """Whether those who are spoken of are there."""
    things: bool = True
    option: int = 0
    """Which answer people give."""
    clock: str = "10:00"
    battery: int = 80
    everywhere: bool = False
    """Whether things and people are in each place that is gone to, or in every second."""


VARIATIONS: Final = (
    _Variation(everywhere=True),
    _Variation(option=1, clock="16:40", battery=30),
    _Variation(people=False, things=False, option=1),
    _Variation(things=False, option=2, clock="20:15", battery=12),
    _Variation(people=False, option=3, everywhere=True),
)


def scenes(lexicon: Lexicon, programs: Iterable[str], people: Collection[str] = ()) -> list[Scene]:
    """A few scenes that tell these programs apart, as far as such scenes can; `people` are whom the
    sentence speaks of, by name or by what they are like."""
    calls = [call for program in programs for call in _calls(program)]
    return [_scene(lexicon, calls, people, variation) for variation in VARIATIONS]


_Call = tuple[str, dict[str, Any]]


def _calls(program: str) -> Iterator[_Call]:
    """The robot calls of a program with those of their arguments that are texts, in order."""
    for node in ast.walk(ast.parse(program)):
        match node:
            case ast.Call(func=ast.Attribute(value=ast.Name(id="robot"), attr=name)) if (
                name in METHODS
            ):
                form = METHODS[name].forms[0]
                given = {p.name: a for p, a in zip(form, node.args, strict=False)}
                given |= {each.arg: each.value for each in node.keywords if each.arg}
                yield name, {key: _fixed(value) for key, value in given.items()}
            case _:
                pass


def _fixed(node: ast.expr) -> Any:
    try:
        return ast.literal_eval(node)
    except ValueError:
        return None


def _scene(
    lexicon: Lexicon, calls: list[_Call], described: Collection[str], how: _Variation
) -> Scene:
    places = {place.name: kind_of(place) or "" for place in lexicon.places}
    gone_to = list(dict.fromkeys(_places(calls, places)))
    people = _people(lexicon, gone_to, how)
    known = {*described} | {each.name for each in lexicon.people}
    known |= {each.kind for each in lexicon.people if each.kind}
    things = _things(calls, known, gone_to, how)
    stops = [START, *gone_to] if how.people else []
    arrivals = {
        place: [f"visitor {at * VISITORS + number}" for number in range(1, VISITORS + 1)]
        for at, place in enumerate(stops)
    }
    coming = [who for row in arrivals.values() for who in row]
    sought = " ".join(sorted({*_words(calls)}))
    traits = dict.fromkeys(people, f"person {sought}")
    traits |= {each.name: _traits(each) for each in lexicon.people}
    return Scene(
        places=places,
        people=people,
        things=things,
        option=how.option,
        arrivals=arrivals,
        traits=traits | dict.fromkeys(coming, f"person visitor guest patient {sought}"),
        clock=how.clock,
        battery=how.battery,
    )


def _places(calls: list[_Call], places: Mapping[str, str]) -> Iterator[str]:
    """The places that drafts go to, by name or by kind."""
    for method, given in calls:
        for parameter in ("place", "to"):
            if given.get(parameter) in places:
                yield given[parameter]
        if method == "places":
            yield from (name for name, kind in places.items() if given.get("kind") in (kind, None))


def _people(lexicon: Lexicon, gone_to: list[str], how: _Variation) -> dict[str, str]:
    """Where everybody is: at home, if a place is called after them, else somewhere."""
    if not how.people:
        return {}
    at: dict[str, str] = {}
    somewhere = [place.name for place in lexicon.places] or [START]
    for number, person in enumerate(lexicon.people):
        home = next((p.name for p in lexicon.places if person.name.lower() in _called(p)), None)
        at[person.name] = home or somewhere[(7 * number + 3) % len(somewhere)]
    for number, place in enumerate(gone_to):
        if how.everywhere or number % 2 == 0:
            at[f"person {number + 1}"] = place
    return at


def _called(place: Name) -> str:
    return " ".join((place.name, *place.aliases)).lower()


def _things(
    calls: list[_Call], persons: Collection[str], gone_to: list[str], how: _Variation
) -> list[tuple[str, str]]:
    """Things that drafts look for, where they look for them."""
    if not how.things:
        return []
    sought = dict.fromkeys(
        given["thing"]
        for method, given in calls
        if method in _LOOKING and isinstance(given.get("thing"), str)
    )
    stops = [START, *gone_to]
    return [
        (thing, place)
        for thing in sought
        if thing not in persons
        for number, place in enumerate(stops)
        if how.everywhere or number % 2 == 1 or len(stops) == 1
    ]


def _traits(person: Name) -> str:
    return " ".join(("person", person.kind or "", *person.attributes))


def _words(calls: list[_Call]) -> Iterator[str]:
    """Words by which drafts ask for somebody."""
    for method, given in calls:
        for parameter in ("person", "thing"):
            if method in _LOOKING | {"ask", "guide", "follow", "give"}:
                text = given.get(parameter)
                yield from text.split() if isinstance(text, str) else ()
