"""Leading somebody to a place."""

from __future__ import annotations

from dataclasses import replace

from grammar.discourse import Discourse, Thing
from grammar.plan import Call, Value


def lead(d: Discourse, person: Thing, place: Value) -> Call:
    d.scene = replace(d.scene, left={**d.scene.left, person.value: place})
    d.scene = d.scene.arrived(place)
    there = replace(person, place=None, furniture=None, here=True)
    d.scene = replace(d.scene.speaking_of_person(there), with_person=person.value, led=there)
    return Call("guide", {"person": person.value, "place": place})
