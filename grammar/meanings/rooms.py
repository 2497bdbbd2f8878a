"""Rooms that are spoken of by a pronoun, told to somebody who has not heard of which."""

from __future__ import annotations

from grammar.discourse import ANYONE, Discourse
from grammar.naming import place_called
from grammar.plan import Text
from grammar.wordorder import direct_clause


def room_spoken_of(d: Discourse, start: int, end: int) -> dict[int, str]:
    """ "if nobody is in meeting room 1, tell Alice that it is free": what the pronoun is to be
    said as."""
    words = d.norms(start, end)
    pronoun = words[0] in d.language.words_called("room_pronouns")
    if not pronoun or not d.language.words_called("room_states").intersection(words):
        return {}
    place = d.branch.room
    if d.branch.met is not None and d.branch.met.thing.text == ANYONE:
        place = d.branch.met.thing.place or d.scene.place
    return (
        {start: place_called(place.value, d.lexicon, d.language)} if isinstance(place, Text) else {}
    )


def in_words(d: Discourse, start: int, end: int, changed: dict[int, str]) -> str:
    """A reported clause as a direct one, with its first word put otherwise."""
    ordered = direct_clause(d, start, end, changed)
    if changed and ordered == d.words(start, end):
        return f"{changed[start]} {d.words(start + 1, end)}"
    return ordered
