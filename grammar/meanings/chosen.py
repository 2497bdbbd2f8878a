"""Alternatives of which somebody has chosen one: "ask her if she wants tea or coffee. Depending on
her answer, bring her a tea or a coffee".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.guards import guard_finds
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import Survey, uses_answer
from grammar.plan import Call, Condition, If, Recall


def chosen_of(d: Discourse, names: Sequence[str]) -> list[Condition] | None:
    """For each of some alternatives, whether it is what was answered last; None if these are not
    the answers that the last question offered."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if survey is None or d.answers.last is None or d.answers.last != survey.call.save_as:
        return None
    meant = [_option(d, survey, name) for name in names]
    if None in meant or len(set(meant)) < len(names):
        return None
    return [survey.said(option) for option in meant if option is not None]


def _option(d: Discourse, survey: Survey, name: str) -> str | None:
    words = set(d.language.tokens_of(name)) - d.language.closed
    fitting = [
        option
        for option in survey.options
        if (said := set(d.language.tokens_of(option)) - d.language.closed)
        and (said <= words or words <= said)
    ]
    return fitting[0] if len(fitting) == 1 else None


def by_choice(
    d: Discourse,
    chosen: Sequence[Condition],
    alternatives: Sequence[Any],
    one: Callable[[Any], Steps],
) -> Steps:
    """The steps for the alternative that was chosen."""
    before = d.scene
    bodies: list[Steps] = []
    for each in alternatives:
        d.scene = before
        bodies.append(guard_finds(d, d.sequence(lambda each=each: d.done.extend(one(each)))))  # type: ignore[misc]
    d.scene = d.scene.wandered()
    otherwise: Steps = []
    for condition, body in reversed(list(zip(chosen, bodies, strict=True))):
        otherwise = [If(condition, tuple(body), tuple(otherwise))]
    return otherwise


def handed_already(d: Discourse, thing: Thing, person: Thing) -> bool:
    """Whether what was chosen was just given to somebody, whichever it was: "get her a tea or a
    coffee and bring it to her"."""
    step = d.done[-1] if d.done else None
    if d.answers.last is None or thing.value != Recall(d.answers.last) or not isinstance(step, If):
        return False
    while isinstance(step, If):
        last = step.then[-1]
        if not (isinstance(last, Call) and last.method == "give"):
            return False
        if last.arguments.get("person") != person.value:
            return False
        step = step.otherwise[0] if step.otherwise else None
    return True


@meaning("depending")
def depending(d: Discourse, node: Node) -> Steps:
    """ "depending on her answer, bring her tea or coffee": something that does depend on it."""
    steps: Steps = d.build(node.parts["then"])
    if not uses_answer(d, steps):
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    return steps
