"""Scenes in which drafts are tried: made from what is spoken of, so that they differ where drafts
may.

Who is spoken of is at home or nowhere, things are where they are looked for or gone, people choose
one answer or another, it is early or late, and visitors come or do not. What the scenes hold is
read from the drafts and from the names of the world; nothing has to be known of the real house.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Final

from grammar.lexicon import Lexicon, Name, kind_of
from nl2robot.deliberation.paper_robot import PERSON, START, Scene, words_of
from robot_api.methods import METHODS

VISITORS: Final = 8
DAYS: Final = ("Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", "Sunday")
_COMING: Final = ("visitor", "guest", "patient")
"""What people may be who come by."""
_TIME: Final = re.compile(r"([01]\d|2[0-3]):[0-5]\d")
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
    around: int = 0
    """Minutes before the first or behind the last of the times that drafts look for; `clock` if
    they look for none."""
    another_day: bool = False
    """Whether it is the last of the days that drafts look for, and not the first."""
    battery: int = 80
    everywhere: bool = False
    """Whether things and people are in each place that is gone to, or in every second."""


VARIATIONS: Final = (
    _Variation(everywhere=True),
    _Variation(option=1, clock="16:40", battery=30, another_day=True),
    _Variation(people=False, things=False, option=1, around=-10),
    _Variation(things=False, option=2, clock="20:15", battery=4),
    _Variation(people=False, option=3, everywhere=True, around=10, another_day=True),
)


def scenes(lexicon: Lexicon, programs: Iterable[str], people: Collection[str] = ()) -> list[Scene]:
    """A few scenes that tell these programs apart, as far as such scenes can; `people` are whom the
    sentence speaks of, by name or by what they are like."""
    trees = [ast.parse(program) for program in programs]
    calls = [call for tree in trees for call in _calls(tree)]
    compared = [*dict.fromkeys(text for tree in trees for text in _compared(tree))]
    return [_scene(lexicon, calls, compared, people, variation) for variation in VARIATIONS]


_Call = tuple[str, dict[str, Any]]


def _compared(tree: ast.AST) -> Iterator[str]:
    """The texts with which a program compares something."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Compare):
            for side in (node.left, *node.comparators):
                value = _fixed(side)
                texts = value if isinstance(value, list | tuple) else (value,)
                yield from (text for text in texts if isinstance(text, str) and text)


def _calls(tree: ast.AST) -> Iterator[_Call]:
    """The robot calls of a program with those of their arguments that are fixed, in order."""
    for node in _in_order(tree):
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


def _in_order(node: ast.AST) -> Iterator[ast.AST]:
    """As it is written: what is in a loop before what follows the loop."""
    yield node
    for child in ast.iter_child_nodes(node):
        yield from _in_order(child)


def _fixed(node: ast.expr) -> Any:
    try:
        return ast.literal_eval(node)
    except (ValueError, TypeError):
        return None


def _scene(
    lexicon: Lexicon,
    calls: list[_Call],
    compared: list[str],
    described: Collection[str],
    how: _Variation,
) -> Scene:
    places = {place.name: kind_of(place) or "" for place in lexicon.places}
    gone_to = list(dict.fromkeys(_places(calls, places)))
    awaited = [*_awaited(lexicon, calls)]
    people = _people(lexicon, awaited, gone_to, how)
    names = {each.name for each in lexicon.people}
    known = {*described, *_COMING} | names | {each.kind for each in lexicon.people if each.kind}
    things = _things(calls, known, gone_to, how)
    stops = [START, *gone_to] if how.people else []
    visitors = {
        place: [f"visitor {at * VISITORS + number}" for number in range(1, VISITORS + 1)]
        for at, place in enumerate(stops)
    }
    arrivals = {place: [*awaited, *row] for place, row in visitors.items()}
    coming = [who for row in visitors.values() for who in row]
    sought = " ".join(sorted({*_words(calls, names)}))
    traits = dict.fromkeys(people, f"person {sought}")
    traits |= {each.name: _traits(each) for each in lexicon.people}
    return Scene(
        places=places,
        people=people,
        things=things,
        option=how.option,
        replies=_replies(compared),
        arrivals=arrivals,
        traits=traits | dict.fromkeys(coming, f"person {' '.join(_COMING)} {sought}"),
        clock=_clock(compared, how),
        weekday=_weekday(compared, how),
        battery=how.battery,
        hurried=True,
    )


def _awaited(lexicon: Lexicon, calls: list[_Call]) -> Iterator[str]:
    """Who is waited for by name: they are not there yet."""
    names = {given.get("thing") for method, given in calls if method == "wait_for"}
    yield from (each.name for each in lexicon.people if each.name in names)


def _replies(compared: list[str]) -> tuple[str, ...]:
    """What people may say to an open question: what drafts listen for, and something else."""
    listened = tuple(
        each for each in compared if not _TIME.fullmatch(each) and each.capitalize() not in DAYS
    )
    return (*listened, "3") if listened else ()


def _clock(compared: list[str], how: _Variation) -> str:
    times = sorted(each for each in compared if _TIME.fullmatch(each))
    if not times or not how.around:
        return how.clock
    hour, minute = map(int, times[0 if how.around < 0 else -1].split(":"))
    now = min(max(hour * 60 + minute + how.around, 0), 24 * 60 - 1)
    return f"{now // 60:02d}:{now % 60:02d}"


def _weekday(compared: list[str], how: _Variation) -> str:
    days = [each.capitalize() for each in compared if each.capitalize() in DAYS]
    if not days:
        return "Tuesday"
    if how.another_day and len({*days}) == 1:
        return DAYS[(DAYS.index(days[0]) + 1) % len(DAYS)]
    return days[-1 if how.another_day else 0]


def _places(calls: list[_Call], places: Mapping[str, str]) -> Iterator[str]:
    """The places that drafts go to, by name or by kind."""
    for method, given in calls:
        for parameter in ("place", "to"):
            name = given.get(parameter)
            if isinstance(name, str) and name in places:
                yield name
        if method == "places":
            yield from (name for name, kind in places.items() if given.get("kind") in (kind, None))


def _people(
    lexicon: Lexicon, awaited: Collection[str], gone_to: list[str], how: _Variation
) -> dict[str, str]:
    """Where everybody is who need not be waited for: at home, if a place is called after them, else
    somewhere."""
    if not how.people:
        return {}
    at: dict[str, str] = {}
    somewhere = [place.name for place in lexicon.places] or [START]
    for number, person in enumerate(lexicon.people):
        if person.name not in awaited:
            name = re.compile(rf"\b{re.escape(person.name)}\b", re.IGNORECASE)
            home = next((p.name for p in lexicon.places if name.search(_called(p))), None)
            at[person.name] = home or somewhere[(7 * number + 3) % len(somewhere)]
    for number, place in enumerate([START, *gone_to]):
        if how.everywhere or number % 2 == 1:
            at[f"person {number + 1}"] = place
    return at


def _called(place: Name) -> str:
    return " / ".join((place.name, *place.aliases))


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
        if thing not in persons and not words_of(thing) & PERSON
        for number, place in enumerate(stops)
        if how.everywhere or number % 2 == 1 or len(stops) == 1
    ]


def _traits(person: Name) -> str:
    return " ".join(("person", person.kind or "", *person.attributes))


def _words(calls: list[_Call], names: Collection[str]) -> Iterator[str]:
    """Words by which drafts ask for somebody, but for those whom the world knows."""
    for method, given in calls:
        for parameter in ("person", "thing"):
            if method in _LOOKING | {"ask", "guide", "follow", "give"}:
                text = given.get(parameter)
                if isinstance(text, str) and text not in names:
                    yield from words_of(text)
