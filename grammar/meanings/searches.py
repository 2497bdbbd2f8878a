"""Searches as conditions: what was looked for in one place or several, and whether it was found.

A search stands among the steps as a call of `find`, or, over several places, as a condition whose
only consequence is to say that nothing was found. What is said next may hang on it ("if there is
one, ..."): the search is then taken out of the steps again and becomes the condition of that.
"""

from __future__ import annotations

from typing import Final

from grammar.discourse import Discourse, Steps, Thing
from grammar.meanings.finding import found, not_found
from grammar.meanings.places import sought
from grammar.plan import Ask, Call, Condition, Either, Holds, If, Items, Not, Step, Text, Value

MOST_PLACES: Final = 8
"""Places that are looked at one by one in a condition."""


def search_in(d: Discourse, thing: Thing, places: list[Value]) -> Steps:
    """Look for something in one place after the other, until it is found."""
    searches = tuple(
        Holds(Ask("find", {**found(d, thing).arguments, "place": place})) for place in places
    )
    condition: Condition = searches[0] if len(searches) == 1 else Either(searches)
    return [If(Not(condition), (not_found(d, thing),))]


def named_places(d: Discourse, places: Value) -> list[Value] | None:
    """Some places one by one, if they are few and known by name."""
    if isinstance(places, Items):
        return list(places.items)
    if not isinstance(places, Ask) or places.method != "places":
        return None
    kind = places.arguments.get("kind")
    known = d.lexicon.place_kinds.get(kind.value, ()) if isinstance(kind, Text) else ()
    return [Text(each.name) for each in known] if 0 < len(known) <= MOST_PLACES else None


def searched(step: Step | None) -> Condition | None:
    """Whether what a step looks for is found, if it does nothing else than look for it."""
    if isinstance(step, Call) and step.method == "find":
        return Holds(Ask("find", step.arguments))
    if not isinstance(step, If) or step.otherwise or not isinstance(step.condition, Not):
        return None
    told = step.then[0] if len(step.then) == 1 else None
    if not isinstance(told, Call) or told.method != "say" or not searches(step.condition.condition):
        return None
    return step.condition.condition


def searches(condition: Condition) -> list[Ask]:
    """The searches that a condition consists of; none if there is anything else in it."""
    if isinstance(condition, Either):
        parts = [searches(each) for each in condition.conditions]
        return [each for part in parts for each in part] if all(parts) else []
    if isinstance(condition, Holds) and isinstance(condition.value, Ask):
        return [condition.value] if condition.value.method == "find" else []
    return []


def just_looked_for(d: Discourse, thing: Thing | None) -> Condition | None:
    """The search that the step before is, if it is for this; it is taken out of the steps:
    "look for a wheelchair. If there is one, ..."."""
    condition = searched(d.done[-1] if d.done else None)
    if condition is None:
        return None
    for each in searches(condition):
        if thing is not None and each.arguments["thing"] != sought(d, thing):
            return None
        if thing is not None and thing.place not in (None, each.arguments.get("place")):
            return None
    d.done.pop()
    return condition


def just_awaited(d: Discourse, thing: Thing) -> Condition | None:
    """Whether somebody has come in the time that the step before waits for them: "wait five minutes
    for Bob. If he has not come, ..."."""
    last = d.done[-1] if d.done else None
    if not isinstance(last, Call) or last.method != "wait_for" or "timeout" not in last.arguments:
        return None
    if last.arguments["thing"] != thing.value or thing.place not in (None, d.at):
        return None
    d.done.pop()
    return Holds(Ask("wait_for", last.arguments))
