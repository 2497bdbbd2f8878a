"""Leading somebody to a place."""

from __future__ import annotations

from dataclasses import replace

from grammar.discourse import Discourse, Thing
from grammar.plan import Call, Value


def lead(d: Discourse, person: Thing, place: Value) -> Call:
    d.scene.left = {**d.scene.left, person.value: place}
    d.scene.at = d.scene.place = place
    d.scene.with_person = person.value
    d.scene.person = d.scene.led = replace(person, place=None, furniture=None, here=True)
    d.scene.thing_last = False
    return Call("guide", {"person": person.value, "place": place})
