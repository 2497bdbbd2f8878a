"""Rounds of places on which one finding is enough: "if you find one, bring it here; if not, tell
Bob", "if one of them is empty, tell Alice that she can use it".

What is done if it is found ends the round, and what is done otherwise is done when it was found
nowhere; neither is done at each place again.
"""

from __future__ import annotations

from typing import Final

from msgspec.structs import replace

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, Steps
from grammar.meanings.alternatives import CONDITIONAL, exclusive
from grammar.meanings.claims import TELL
from grammar.meanings.conditions import negated
from grammar.meanings.deliveries import first_clause, inside
from grammar.meanings.news import BACK
from grammar.meanings.persons import is_me
from grammar.meanings.searches import named_places
from grammar.plan import (
    Ask,
    Call,
    Condition,
    Either,
    End,
    ForEach,
    Holds,
    If,
    Not,
    Recall,
    Remember,
    Step,
    Text,
    Truth,
    Value,
)
from grammar.tidy import mentions, nodes

OTHER: Final = "otherwise"
"""What the parts of a condition begin with that say what is done in the other case."""


def found_once(d: Discourse, loop: ForEach, clause: Node) -> Steps | None:
    """The steps of a round that ends where something is so for the first time, with what is done if
    it is so nowhere; None if what the clause says is done at every place."""
    if clause.production.means not in CONDITIONAL:
        return None
    none = says(clause, "none")
    *before, last = turned_round(loop.steps) if none else exclusive(list(loop.steps))
    if not isinstance(last, If):
        return None
    other = next((clause.parts[name] for name in clause.parts if name.startswith(OTHER)), None)
    if len(before) + 1 < len(loop.steps):  # the clause says what is done in the other case
        back = back_to_tell(d, clause, last.otherwise)
        last = replace(last, otherwise=(*back, *last.otherwise))
    elif other is not None and tells_me(other) and all(map(is_said, last.otherwise)):
        d.start()
        last = replace(last, otherwise=(BACK, *last.otherwise))
    if not none and not is_enough(last, clause, Recall(loop.variable)):
        return None
    if BACK not in last.otherwise:
        last = replace(last, then=(*back_to_tell(d, clause, last.then), *last.then))
    search = searching(d, loop, last) if len(before) == 1 else None
    if search is not None:
        turned = If(Not(search), last.otherwise)
        return [If(search, last.then, last.otherwise) if last.then else turned]
    if not last.otherwise:
        ending = replace(last, then=(*last.then, End()))
        return [replace(loop, steps=(*before, ending))]
    found = d.variable("found")
    noted = (Remember(found, Truth(True)), *last.then, End())
    body = (*before, If(last.condition, noted))
    nowhere = If(Not(Holds(Recall(found))), last.otherwise)
    return [Remember(found, Truth(False)), replace(loop, steps=body), nowhere]


def tells_me(part: Leaf | Node) -> bool:
    """ "if not, come and tell me": whether nothing but that is done."""
    only = first_clause(part) if isinstance(part, Node) else None
    if only is None or only.means not in ("tell_me_that", "tell_that"):
        return False
    return any(each.means == "person_me" for each in inside(part)) or only.means == "tell_me_that"


def is_said(step: Step) -> bool:
    return isinstance(step, Call) and step.method == "say"


def back_to_tell(d: Discourse, clause: Node, steps: tuple[Step, ...]) -> Steps:
    """The way back to the speaker, who is told that something was found: the round is over then."""
    told = clause.production.means == TELL and is_me(d.get(clause, "person_ref"))
    if not told or BACK in steps:
        return []
    d.came_back()
    return [BACK]


def turned_round(steps: tuple[Step, ...]) -> Steps:
    """What is done at each stop, with what is done if it is so at none of them as what is done
    otherwise, as where it is so was said just before or is not spoken of."""
    *before, last = steps
    if not isinstance(last, If):
        return [*steps]
    condition, then = negated(last.condition), last.otherwise
    match before[-1:]:
        case [If(condition=same, otherwise=()) as found] if same == condition:
            ends = found.then[-1:] == (End(),)
            before, then = before[:-1], (found.then[:-1] if ends else found.then)
    return [*before, If(condition, then, last.then)]


def is_enough(step: If, clause: Node, here: Value) -> bool:
    """Whether what is done at a stop where something is so is done at none but the first."""
    if step.otherwise:
        return leads_away(step.otherwise, here) and is_of_one(step.condition, clause)
    led = any(isinstance(each, Call) and each.method == "guide" for each in step.then)
    return says(clause, "one") and (led or leads_away(step.then, here))


def leads_away(steps: tuple[Step, ...], here: Value) -> bool:
    """Whether some steps are done elsewhere: nothing in them is for the place where they begin."""
    first = steps[0]
    if mentions(steps, here):
        return False
    if isinstance(first, If):
        called = [each for each in nodes(first.condition) if isinstance(each, Ask)]
        return bool(called) and all(each.method == "find" for each in called)
    return first == BACK or (isinstance(first, Call) and first.method in ("find", "goto", "dock"))


def is_of_one(condition: Condition, clause: Node) -> bool:
    """Whether a condition is that something is there of which one is enough: a thing, or somebody
    by name."""
    match condition:
        case Holds(value=Ask(method="sees", arguments={"thing": Text(value=thing)})):
            return thing != ANYONE
        case _:
            return says(clause, "one")


def says(clause: Node, number: str) -> bool:
    """ "if one of them is empty", "if either has a fan", "if none of them has one"."""
    return any(
        each.production.fixed.get("of_round") == number
        for each in inside(clause.parts["condition"])
    )


def searching(d: Discourse, loop: ForEach, step: If) -> Condition | None:
    """What a round looks for, as a search of one place after the other; None if it is no such
    thing, or what is done then needs the place."""
    places = named_places(d, loop.items)
    match step.condition:
        case Holds(value=Ask(method="sees", arguments={"thing": thing})) if places:
            if mentions((step.then, step.otherwise), Recall(loop.variable)):
                return None
            found = (Ask("find", {"thing": thing, "place": each}) for each in places)
            return Either(tuple(map(Holds, found)))
        case _:
            return None
