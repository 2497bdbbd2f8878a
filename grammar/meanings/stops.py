"""Places gone to for what is said next: "go to the kitchen and the lobby and announce ...".

To drive somewhere and do nothing there makes no sense: what is only said is said at each of them.
"""

from __future__ import annotations

from collections.abc import Set
from typing import Final

from grammar.chart import Node
from grammar.discourse import ANYONE, Discourse, Steps
from grammar.errors import NotUnderstood
from grammar.meanings.alternatives import itself
from grammar.meanings.deliveries import first_clause
from grammar.meanings.going_on import about_places, conditional, depends_on_stop
from grammar.meanings.place_loops import round_of_visits
from grammar.meanings.registry import meaning
from grammar.memory import Scene
from grammar.plan import Ask, Call, End, ForEach, Holds, If, Items, Recall, Step, Text, Value
from grammar.tidy import nodes

SAID: Final = frozenset({"say", "ask", "show", "gesture", "emotion", "people"})
"""What is done wherever the robot is."""
_PASSED: Final = frozenset({"from", "by"})
"""What a rule for several places is marked with if the first ones are only on the way."""


def gone_to(d: Discourse, clause: Node, steps: Steps) -> Items | None:
    """The places that a clause goes to one after the other, if it does nothing else; not those from
    which, or by which, it only goes to another."""
    command = itself(clause)
    if command.means != "go_places" or not _PASSED.isdisjoint(command.production.fixed):
        return None
    going = [step for step in steps if isinstance(step, Call) and step.method == "goto"]
    return Items(tuple(step.arguments["place"] for step in going)) if going == steps else None


def looked_at_each(d: Discourse, places: Items | None, clause: Node) -> None:
    """ "go to the kitchen and the library and count the people": the places gone to before are a
    round, for what is then to be seen there is to be seen at each of them."""
    first = first_clause(clause)
    there = depends_on_stop(d, first) if conditional(first) else about_places(first)
    if places is not None and len(places.items) > 1 and there:
        round_of_visits(d)


def said_at_each(d: Discourse, places: Items | None, steps: Steps) -> Items | None:
    """Move steps that only speak into a round of the places gone to before, which they stand
    behind; the places, if what follows may be said there, too."""
    called = [each.method for each in nodes(tuple(steps)) if isinstance(each, Call | Ask)]
    if places is None or not called or not SAID.issuperset(called):
        return None
    del d.done[len(d.done) - len(steps) :]
    last = d.done[-1]
    if isinstance(last, ForEach) and last.items == places:
        d.done[-1] = ForEach(last.variable, places, (*last.steps, *steps))
        return places
    del d.done[len(d.done) - len(places.items) :]
    place = Recall(d.variable("place"))
    going = Call("goto", {"place": place})
    d.done.append(ForEach(place.name, places, (going, *steps)))
    return places


def said_on_tour(d: Discourse, before: int, scene: Scene) -> None:
    """Move what is said at a place behind the step that leads somebody there: "show them the
    library and the lounge. In the library say ..., and in the lounge ..."."""
    going, *words = d.done[before:] or [End()]
    if not words or not is_call(going, {"goto"}) or not all(is_call(each, SAID) for each in words):
        return
    if not before or not is_call(d.done[before - 1], {"guide", *SAID}):
        return
    stops = [at for at in range(before) if is_call(d.done[at], {"guide"})]
    here = [at for at in stops if place_of(d.done[at]) == place_of(going)]
    if not here:
        return
    at = next((each for each in stops if each > here[-1]), before)
    del d.done[before:]
    d.done[at:at] = words
    d.scene = scene


def is_call(step: Step, methods: Set[str]) -> bool:
    return isinstance(step, Call) and step.method in methods


def place_of(step: Step) -> Value | None:
    """Where a step goes."""
    return step.arguments.get("place") if isinstance(step, Call) else None


@meaning("skip_empty")
def skip_empty(d: Discourse, node: Node) -> Steps:
    """ "skip the empty ones": what the last round does at each place is done only if somebody is
    there."""
    somebody = Holds(Ask("sees", {"thing": Text(ANYONE)}))
    loop = d.done[-1] if d.done else None
    if d.loops.in_loop and not isinstance(loop, ForEach):  # in the round itself
        body = tuple(d.done)
        d.done.clear()
        return [If(somebody, body)]
    first = loop.steps[0] if isinstance(loop, ForEach) and loop.steps else None
    if not isinstance(loop, ForEach) or not isinstance(first, Call) or first.method != "goto":
        words = d.words(node.start, node.end)
        raise NotUnderstood(
            d.language.phrase("not_understood", part=words), gap=(node.start, node.end)
        )
    d.done.pop()
    steps = loop.steps[1:]
    if not (len(steps) == 1 and isinstance(steps[0], If) and steps[0].condition == somebody):
        steps = (If(somebody, steps),)
    return [ForEach(loop.variable, loop.items, (first, *steps))]
