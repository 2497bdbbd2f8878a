"""Whom an answer names, and where they are to be found: "frag ihn, ob er zu Bob oder zu Clara will,
und bring ihn hin" leads to the room that is called after whoever is named."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import replace
from typing import Final

import msgspec

from grammar.discourse import Discourse
from grammar.errors import NotUnderstood
from grammar.meanings.places import is_of
from grammar.meanings.surveys import Survey, exchanged
from grammar.plan import Items, Recall, Sentence, Text, Value
from grammar.tidy import nodes

SOMEBODY: Final = "person"
"""What an answer is called that tells whom somebody wants to see."""


def place_of_named(d: Discourse, survey: Survey, kind: str | None = None) -> Value | None:
    """The place called after whoever an answer names; None if it names nobody who has one."""
    owners, before, after = owners_of(d, kind)
    if survey.call.save_as is None or not owners or not set(survey.options or ()) <= set(owners):
        return None
    offer(d, survey, owners)
    around = (Text(before), Recall(survey.call.save_as), Text(after))
    return Sentence(tuple(part for part in around if part != Text("")))


def owners_of(d: Discourse, kind: str | None) -> tuple[tuple[str, ...], str, str]:
    """Those after whom places of a kind are called, and what stands before and behind their names
    in those of the places: "'s office"."""
    places = d.lexicon.place_kinds.get(kind, ()) if kind else d.lexicon.places
    called: dict[tuple[str, str], list[str]] = defaultdict(list)
    for place in places:
        for person in d.lexicon.people:
            before, name, after = place.name.partition(person.name)
            if name and is_of(d, place.name, person.name):
                called[before, after].append(person.name)
    if not called:
        return (), "", ""
    most = max(called, key=lambda each: len(called[each]))
    return tuple(called[most]), *most


def offer(d: Discourse, survey: Survey, names: tuple[str, ...]) -> None:
    """Let a question that was asked openly be answered with one of some names."""
    if survey.options:
        return
    options = Items(tuple(map(Text, names)))
    call = msgspec.structs.replace(
        survey.call, arguments={**survey.call.arguments, "options": options}
    )
    if not any(each is survey.call for each in nodes(tuple(d.done))):
        raise NotUnderstood(d.language.phrase("too_complicated"))
    d.done[:] = exchanged(d.done, survey.call, [call])
    answered = replace(survey, call=call, options=names)
    surveys = tuple(answered if each == survey else each for each in d.answers.surveys)
    d.answers = replace(d.answers, surveys=surveys)


def place_just_named(d: Discourse, kind: str | None = None) -> Value | None:
    """ "ask them who they want to see and take them there": the place of whoever the answer to the
    last question names, if nothing was done since."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if survey is None or not d.done or all(each is not survey.call for each in nodes(d.done[-1])):
        return None
    people = {each.name for each in d.lexicon.people}
    if SOMEBODY not in survey.nouns and not (survey.options and set(survey.options) <= people):
        return None
    return place_of_named(d, survey, kind)
