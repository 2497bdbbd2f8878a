"""What is done if somebody does not come in time, said after what is done when they come.

"Wait for David and give him the key. If he does not come within ten minutes, bring it to me."
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from grammar.discourse import ANYONE, Discourse, Meeting, Steps
from grammar.meanings.claims import leave_off, meet_there
from grammar.memory import Scene
from grammar.plan import Ask, Call, Condition, Holds, If, Not, Text


@dataclass(frozen=True)
class Awaited:
    """A step that waits for somebody, and the scene when they have come."""

    step: Call
    scene: Scene


def note_waiting(d: Discourse) -> None:
    """Keep the scene behind a step that has just waited for somebody."""
    last = d.done[-1] if d.done else None
    if isinstance(last, Call) and last.method == "wait_for":
        d.people = replace(d.people, awaited=Awaited(last, d.scene))


def too_late(
    d: Discourse, condition: Condition, met: Meeting | None, make: Callable[[], Steps]
) -> If | None:
    """Waiting for somebody and what was done then, with what `make` does in the other case; None
    if the condition is not that they have not come."""
    awaited: Awaited | None = d.people.awaited
    match condition:
        case Not(condition=Holds(value=Ask(method="wait_for" | "sees" as looked, arguments=asked))):
            pass
        case _:
            return None
    if awaited is None or asked["thing"] not in (awaited.step.arguments["thing"], Text(ANYONE)):
        return None
    at = next((at for at, step in enumerate(d.done) if step is awaited.step), None)
    limits = (awaited.step.arguments, asked) if looked == "wait_for" else (awaited.step.arguments,)
    timed = [each for each in limits if "timeout" in each]
    if at is None or at == len(d.done) - 1 or len(timed) != 1:
        return None  # waited for without end, or said just before
    then: Steps = d.done[at + 1 :]
    del d.done[at:]
    after = d.scene
    d.scene = awaited.scene
    d.scene = replace(d.scene, looked_in=d.scene.at)  # others are not looked for just there
    meet_there(d, met)
    otherwise = make()
    leave_off(d, after)
    return If(Holds(Ask("wait_for", timed[0])), tuple(then), tuple(otherwise))
