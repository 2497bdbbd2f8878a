"""What is done if somebody to whom the robot was sent is not there, said after what they were to be
asked or told: "go to Alice's office and ask her ... If she isn't there, ask Bob instead."

What was to be done with them goes under the condition that they are there, and what is said for the
other case is the other branch. In that branch a message or a question without words of its own
("tell Bob", "try Bob") is the one that could not be delivered.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from grammar.chart import Node
from grammar.discourse import ANYONE, Discourse, Meeting, Steps, Thing
from grammar.meanings.persons import is_me
from grammar.meanings.searches import searches
from grammar.plan import Ask, Call, Condition, Holds, If, Value

SPEAKING = ("say", "ask", "give", "answer")


@dataclass(frozen=True)
class Addressed:
    """Steps with somebody, and the condition that they are there."""

    condition: Condition
    steps: Steps
    around: tuple[If, ...] = ()
    """Where they were looked for before, each the other case of the one before it."""

    def or_else(self, then: Steps, otherwise: Steps) -> If:
        """What is done if they are there, and if not, as the last of the other cases."""
        whole = If(self.condition, tuple(then), tuple(otherwise))
        for outer in reversed(self.around):
            whole = If(outer.condition, outer.then, (*outer.otherwise[:-1], whole))
        return whole


def addressed_before(d: Discourse, met: Meeting | None) -> Addressed | None:
    """What was last done with somebody who is said not to be there, taken out of the steps."""
    if met is None or met.holds or not met.thing.person:
        return None
    who = met.thing
    for at in range(len(d.done) - 1, -1, -1):
        step = d.done[at]
        if isinstance(step, If):
            tried = [step]  # "if she is not there either": the last of the places
            while tried[-1].otherwise and isinstance(tried[-1].otherwise[-1], If):
                tried.append(tried[-1].otherwise[-1])
            found = [search for each in tried for search in searches(each.condition)[:1]]
            if not found:
                continue  # what hangs on an answer
            if not any(_is_meant(each, who) for each in found) or at != len(d.done) - 1:
                return None
            *around, last = tried
            condition = last.condition if around else _there(step.condition, who)
            d.done.pop()
            return Addressed(condition, list(last.then), tuple(around))
        if not isinstance(step, Call) or step.method not in ("find", "goto"):
            continue
        spoken = any(_speaks(each) for each in d.done[at + 1 :])
        searching = step.method == "find"
        if not spoken or (searching and not _is_meant(Ask("find", step.arguments), who)):
            return None
        if not searching and who.place not in (None, step.arguments.get("place")):
            return None
        first = at if searching else at + 1
        steps = d.done[first + 1 if searching else first :]
        del d.done[first:]
        looked = Ask("find", step.arguments) if searching else _seen(steps, who)
        return Addressed(_there(Holds(looked), who), steps)
    return None


def _there(found: Condition, who: Thing) -> Condition:
    """A search, in the one place where it is said that somebody may not be: "tell Clara ... If she
    is not in her office, tell David"."""
    match found:
        case Holds(Ask("find", arguments)) if who.place is not None:
            return Holds(Ask("find", {**arguments, "place": who.place}))
        case _:
            return found


def _is_meant(search: Ask, who: Thing) -> bool:
    """Whether a search is for somebody; whoever is nowhere to be seen is also "nobody"."""
    place = search.arguments.get("place")
    return (search.arguments["thing"] == who.value or who.text == ANYONE) and (
        who.place is None or place is None or who.place == place
    )


def _seen(steps: Steps, who: Thing) -> Ask:
    """Whether whoever is spoken to is there."""
    asked = (each.arguments.get("person") for each in steps if isinstance(each, Call))
    named: Value | None = next((each for each in asked if each is not None), None)
    return Ask("sees", {"thing": named if who.text == ANYONE and named else who.value})


def _speaks(step: object) -> bool:
    return isinstance(step, Call) and step.method in SPEAKING


def undelivered(d: Discourse, person: Thing | None) -> Steps | None:
    """The message or question for whoever was not there, put to somebody else; None if there is
    none, or something was found out since."""
    if d.answers.undelivered is None or person is None or is_me(person) or person.group is not None:
        return None
    node, known = d.answers.undelivered
    if known != d.known_by_now():
        return None
    part = node.parts.get("person_ref")
    if not isinstance(part, Node):
        return None
    d.answers = replace(d.answers, undelivered=None)
    with d.bound(part, person):
        steps: Steps = d.build(node)
        d.branch = replace(d.branch, claim=None)
    return steps


def answer_variable(d: Discourse, options: tuple[str, ...]) -> str | None:
    """The name for an answer that somebody gives instead of another person: the same."""
    if d.answers.instead_of is None or d.answers.options != options:
        return None
    name = d.answers.instead_of
    d.answers = replace(d.answers, instead_of=None)
    return name
