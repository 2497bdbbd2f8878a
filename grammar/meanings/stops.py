"""Places gone to for what is said next: "go to the kitchen and the lobby and announce ...".

To drive somewhere and do nothing there makes no sense: what is only said is said at each of them.
"""

from __future__ import annotations

from typing import Final

from grammar.chart import Node
from grammar.discourse import Discourse, Steps
from grammar.meanings.alternatives import itself
from grammar.plan import Ask, Call, ForEach, Items, Recall
from grammar.tidy import nodes

SAID: Final = frozenset({"say", "ask", "show", "gesture", "emotion", "people"})
"""What is done wherever the robot is."""


def gone_to(d: Discourse, clause: Node, steps: Steps) -> Items | None:
    """The places that a clause goes to one after the other, if it does nothing else."""
    if itself(clause).means != "go_places":
        return None
    going = [step for step in steps if isinstance(step, Call) and step.method == "goto"]
    return Items(tuple(step.arguments["place"] for step in going)) if going == steps else None


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
