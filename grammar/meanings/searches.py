"""Searches as conditions: what was looked for in one place or several, and whether it was found.

A search stands among the steps as a call of `find`, or, over several places, as a condition whose
only consequence is to say that nothing was found. What is said next may hang on it ("if there is
one, ..."): the search is then taken out of the steps again and becomes the condition of that.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from grammar.discourse import Discourse, Steps, Thing
from grammar.meanings.finding import not_found, whether_found
from grammar.meanings.places import sought
from grammar.plan import Ask, Call, Condition, Either, Holds, If, Items, Not, Step, Text, Value
from grammar.tidy import mentions

MOST_PLACES: Final = 8
"""Places that are looked at one by one in a condition."""


def search_in(d: Discourse, thing: Thing, places: list[Value]) -> Steps:
    """Look for something in one place after the other, until it is found."""
    somewhere = replace(thing, place=Items(tuple(places)))
    return [If(Not(whether_found(d, somewhere)), (not_found(d, thing),))]


def named_places(d: Discourse, places: Value) -> list[Value] | None:
    """Some places one by one, if they are few and known by name."""
    if isinstance(places, Items):
        return list(places.items)
    if not isinstance(places, Ask) or places.method != "places":
        return None
    kind = places.arguments.get("kind")
    known = d.lexicon.place_kinds.get(kind.value, ()) if isinstance(kind, Text) else ()
    return [Text(each.name) for each in known] if 0 < len(known) <= MOST_PLACES else None


@dataclass(frozen=True)
class Search:
    """What a step looks for, if it does nothing else than that and what is done in vain."""

    found: Condition
    missing: Steps
    """What is done if it is not found."""

    def is_for(self, d: Discourse, thing: Thing) -> bool:
        """Whether it is this that is looked for, where it is said to be."""
        return all(
            each.arguments["thing"] in (thing.value, sought(d, thing))
            and (thing.pronoun or may_be_in(thing, each.arguments.get("place")))
            for each in searches(self.found)
        )


def search_of(step: Step | None) -> Search | None:
    """The search that a step is."""
    if isinstance(step, Call) and step.method == "find":
        return Search(Holds(Ask("find", step.arguments)), [])
    if not isinstance(step, If) or step.otherwise or not isinstance(step.condition, Not):
        return None
    condition = step.condition.condition
    return Search(condition, list(step.then)) if searches(condition) else None


def may_be_in(thing: Thing, place: Value | None) -> bool:
    """Whether what is said of a thing allows it to be at a place."""
    if isinstance(thing.place, Items):
        return place in thing.place.items
    return thing.place in (None, place)


def searched(step: Step | None) -> Condition | None:
    """Whether what a step looks for is found, if nothing is done in vain but to say so."""
    search = search_of(step)
    if search is None or len(search.missing) > 1:
        return None
    told = all(isinstance(each, Call) and each.method == "say" for each in search.missing)
    return search.found if told else None


def only_told_missing(step: If) -> bool:
    """Whether nothing is done where a search was in vain but to come back and say so."""
    methods = [each.method for each in step.otherwise if isinstance(each, Call)]
    told = len(methods) == len(step.otherwise) and methods[-1:] == ["say"]
    return told and set(methods) <= {"goto", "say"} and bool(searches(step.condition))


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
    if thing is not None and not Search(condition, []).is_for(d, thing):
        return None
    d.done.pop()
    return condition


def just_awaited(d: Discourse, thing: Thing) -> Condition | None:
    """Whether somebody has come in the time that the step before waits for them: "wait five minutes
    for Bob. If he has not come, ..."."""
    last = d.done[-1] if d.done else None
    if not isinstance(last, Call) or last.method != "wait_for" or "timeout" not in last.arguments:
        return None
    if last.arguments["thing"] != thing.value or thing.place not in (None, d.scene.at):
        return None
    d.done.pop()
    d.scene = replace(
        d.scene, looked_in=d.scene.at
    )  # others are not looked for just there: "if he does not come, tell Alice"
    return Holds(Ask("wait_for", last.arguments))


def searching_at(condition: Condition, place: Value | None) -> Condition:
    """What is looked at where the robot is, as a search in that place."""
    match condition:
        case Holds(value=Ask(method="sees", arguments=arguments)) if isinstance(place, Text):
            return Holds(Ask("find", {**arguments, "place": place}))
        case _:
            return condition


def in_turn(first: Condition, further: Search) -> If:
    """One search after the other, as one."""
    places = (*searches(first), *searches(further.found))
    return If(Not(Either(tuple(map(Holds, places)))), tuple(further.missing))


def either_way(d: Discourse, step: If, *, looks_on: bool) -> Steps:
    """A step for both branches. "If Alice is not in her office, look for her in the lab and tell
    her ...", "If there is one, bring it; if not, try the lab": the same wherever it is found. The
    branch may begin with looking on, or with making up for what is not there."""
    condition = step.condition
    denied = condition.condition if isinstance(condition, Not) else None
    if denied is not None and step.then and not step.otherwise:
        inner = step.then[0]
        if isinstance(inner, If) and len(step.then) == 1 and same_search(denied, inner.condition):
            return [If(Either((denied, inner.condition)), inner.then, inner.otherwise)]
        further, rest = search_of(inner), step.then[1:]
        if (
            further is not None
            and same_search(denied, further.found)
            and (not rest or (looks_on and handled(denied, rest)))
        ):
            if not further.missing:
                further = replace(further, missing=[not_found(d, thing_sought(d, denied))])
            return [in_turn(denied, further), *rest]
    further = search_of(step.otherwise[0]) if len(step.otherwise) == 1 else None
    if (
        further is not None
        and same_search(condition, further.found)
        and handled(condition, step.then)
    ):
        anywhere = in_turn(condition, further).condition
        assert isinstance(anywhere, Not)
        return [If(anywhere.condition, step.then, tuple(further.missing))]
    return [step]


def thing_sought(d: Discourse, condition: Condition) -> Thing:
    """What a condition looks for, as it was spoken of."""
    value = searches(condition)[0].arguments["thing"]
    spoken_of = (
        each for each in (d.scene.thing, d.scene.person) if each is not None and each.value == value
    )
    return next(spoken_of, Thing(value))


def handled(condition: Condition, steps: tuple[Step, ...]) -> bool:
    """Whether something is done with what a condition looks for."""
    return any(mentions(steps, each.arguments["thing"]) for each in searches(condition))


def same_search(one: Condition, other: Condition) -> bool:
    """Whether two conditions look for the same."""
    sought = [each.arguments["thing"] for each in (*searches(one), *searches(other))]
    return bool(searches(one) and searches(other)) and all(each == sought[0] for each in sought)
