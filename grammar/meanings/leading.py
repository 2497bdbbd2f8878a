"""Leading somebody to a place."""

from __future__ import annotations

from dataclasses import replace

from grammar.discourse import Discourse, Thing
from grammar.plan import Call, Value


def lead(d: Discourse, person: Thing, place: Value) -> Call:
    d.left = {**d.left, person.value: place}
    d.at = d.place = place
    d.with_person = person.value
    d.person = d.led = replace(person, place=None, furniture=None, here=True)
    d.thing_last = False
    return Call("guide", {"person": person.value, "place": place})
