"""What follows a search holds only if something is found: "find Bob and tell him that lunch is
ready" says nothing to nobody."""

from __future__ import annotations

from typing import Final

from grammar.discourse import START, Discourse, Steps, Thing
from grammar.meanings.finding import not_found
from grammar.meanings.searches import Search, search_of
from grammar.meanings.surveys import moved
from grammar.plan import (
    Ask,
    Call,
    Collect,
    Holds,
    If,
    Increase,
    Not,
    Recall,
    Remember,
    Step,
    Text,
    Try,
)
from grammar.tidy import mentions, nodes

NEEDS_IT: Final = frozenset({"grab", "put", "give", "guide", "follow", "describe"})
"""Methods that say themselves when what was looked for is not there."""
KEPT_WITH: Final = (Call, Remember, Collect, Increase, Try)
"""Steps that are done with who was found, if they follow."""
LED: Final = frozenset({"guide", "follow"})


def guard_finds(d: Discourse, done: Steps) -> Steps:
    """Where something is looked for, what follows holds only if it is found.

    Steps that need the thing fail by themselves and say so; speaking to somebody who was not found
    would not, so it goes under a condition."""
    result: Steps = []
    for number, step in enumerate(done):
        following = done[number + 1] if number + 1 < len(done) else None
        search = search_of(step) if isinstance(step, If) else None
        if search is not None and isinstance(following, Call) and following.method == "grab":
            handled = handling(done[number + 1 :])
            result.append(If(search.found, tuple(handled), in_vain(search, handled)))
            return [*result, *guard_finds(d, done[number + 1 + len(handled) :])]
        if not (isinstance(step, Call) and step.method == "find"):
            result.append(step)
            continue
        # One of several who is not found must not keep the others from it.
        one_of_them = isinstance(step.arguments["thing"], Recall)
        needs_it = NEEDS_IT - LED if one_of_them else NEEDS_IT
        if taken_to_them(done[number : number + 3]):
            return [*result, done[number + 1], step, *guard_finds(d, done[number + 2 :])]
        if isinstance(following, Call) and following.method in needs_it:
            result.append(step)
            continue
        found = Holds(Ask("find", step.arguments))
        missing = not_found(d, found_thing(d, step))
        body: Steps = []
        for later in done[number + 1 :]:
            if isinstance(later, Call) and later.method == "grab" and asked_last(body):
                body += handed_over(later, done[number + 1 + len(body) :])
                break  # who is not found gives nothing
            if led_away(later, step):  # whoever was not found is not led away either
                body.append(later)
                continue
            if isinstance(later, Call) and (
                later.method in ("goto", "find", "dock") or later.method in needs_it
            ):
                break
            if not isinstance(later, KEPT_WITH) and not only_speaks(later):
                break
            body.append(later)
        if body:
            result.append(If(found, tuple(body), (missing,)))
        else:
            result.append(If(Not(found), (missing,)))
        return [*result, *guard_finds(d, done[number + 1 + len(body) :])]
    return result


def taken_to_them(steps: Steps) -> bool:
    """ "find Alice and give her this letter": whether it is taken along to who is looked for."""
    calls = [each for each in steps if isinstance(each, Call)]
    return [each.method for each in calls] == ["find", "grab", "give"] and (
        calls[0].arguments["thing"] == calls[2].arguments.get("person")
        and calls[1].arguments["thing"] == calls[2].arguments["thing"]
    )


def led_away(step: Step, search: Call) -> bool:
    """Whether it leads, or follows, who is looked for."""
    if not isinstance(step, Call) or step.method not in LED:
        return False
    return step.arguments.get("person") == search.arguments["thing"]


def asked_last(steps: Steps) -> bool:
    last = steps[-1] if steps else None
    return isinstance(last, Call) and last.method == "ask"


def handed_over(taking: Call, steps: Steps) -> Steps:
    """Some steps from taking a thing up to the one that gives it away."""
    thing = taking.arguments["thing"]
    for number, step in enumerate(steps):
        let_go = isinstance(step, Call) and step.method in ("give", "put")
        if let_go and isinstance(step, Call) and step.arguments["thing"] == thing:
            return steps[: number + 1]
    return steps[:1]


def only_speaks(step: Step) -> bool:
    """Whether it says one of several things, by what the robot knows without looking."""
    calls = {each.method for each in nodes((step,)) if isinstance(each, Call)}
    asked = {each.method for each in nodes((step,)) if isinstance(each, Ask)}
    return isinstance(step, If) and calls == {"say"} and asked <= {"clock", "battery"}


def handling(steps: Steps) -> Steps:
    """What is done with a thing, from taking it to the last step with it and what is said there."""
    taken = steps[0]
    assert isinstance(taken, Call)
    thing = taken.arguments["thing"]
    last = max(at for at, step in enumerate(steps) if mentions((step,), thing))
    while last + 1 < len(steps) and not moved([steps[last + 1]]):
        last += 1
    return steps[: last + 1]


def in_vain(search: Search, instead_of: Steps) -> tuple[Step, ...]:
    """What is done if something was not found: who waits for it is told so where they wait."""
    back = Call("goto", {"place": Recall(START)})
    told = any(isinstance(each, Call) and each.method == "say" for each in search.missing)
    comes = back in instead_of and told and back not in search.missing
    return (back, *search.missing) if comes else tuple(search.missing)


def found_thing(d: Discourse, step: Call) -> Thing:
    value = step.arguments["thing"]
    named = isinstance(value, Text) and any(value.value == each.name for each in d.lexicon.people)
    return Thing(value, known=named, person=named)
