"""Where somebody or something is likely to be: a person's own room, the place where the robot saw
it last, the places where such things usually are (`likely.yaml`). Where it really is plays no part.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from pathlib import Path

import yaml

from sim.hospital import Hospital
from sim.people.crowd import Human
from sim.people.perception import Sight, fitting, names_in
from sim.physics.placing import Item
from sim.world.model import Place

OWN, SEEN, USUAL, ANYWHERE = range(4)


def likeliness(hospital: Hospital, thing: str) -> Callable[[Place], tuple[int, int]]:
    """How likely it is in a place: the lower, the likelier; the second number is among the usual
    ones."""
    sights = fitting(hospital, thing)
    seen = {hospital.last_seen.get(_called(sight)) for sight in sights}
    kinds = [kind for sight in sights for kind in _usual(sight)]
    people = {name for person in hospital.world.people for name in names_in(person.name)}
    owners = names_in(thing) & people

    def rank(place: Place) -> tuple[int, int]:
        if owners & names_in(place.name):
            return OWN, 0
        if place.name in seen:
            return SEEN, 0
        if place.kind in kinds:
            return USUAL, kinds.index(place.kind)
        return ANYWHERE, 0

    return rank


def remember(hospital: Hospital, thing: str, seen: list[Sight]) -> None:
    """The robot has looked for it where it is, and has seen these."""
    here = hospital.place
    if here is None:
        return
    for sight in fitting(hospital, thing):
        if hospital.last_seen.get(_called(sight)) == here.name:
            del hospital.last_seen[_called(sight)]
    for sight in seen:
        hospital.last_seen[_called(sight)] = here.name


def _called(sight: Sight) -> str:
    if isinstance(sight, Item):
        return sight.thing.name
    return sight.name


def _usual(sight: Sight) -> list[str]:
    if isinstance(sight, Human):
        return _table()["people"].get(sight.person.kind, [])
    return _table()["things"].get(sight.thing.kind, []) if isinstance(sight, Item) else []


@functools.cache
def _table() -> Mapping[str, Mapping[str, list[str]]]:
    table: Mapping[str, Mapping[str, list[str]]] = yaml.safe_load(
        Path(__file__).with_name("likely.yaml").read_text(encoding="utf-8")
    )
    return table
