"""Things that somebody has: "ask Alice and Bob who has my pen and bring it back". It is taken from
whoever says so."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Final

from grammar.chart import Node, what_it_means
from grammar.discourse import Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.deliveries import hands_it_over
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import Survey, exchanged, note
from grammar.plan import Call, End, ForEach, If, Recall, Repeat, Step, Text, Value
from grammar.tidy import nodes

ROUNDS: Final = (ForEach, Repeat)


def asks_who_has(d: Discourse, question: Node, thing: Text) -> None:
    """A question that asks whether somebody has a thing makes it one to be had from them."""
    part = question.parts.get("verb") or question.parts.get("rest")
    held = thing if part is not None and says_having(d, part.start) else None
    d.answers = replace(d.answers, held=held)


def says_having(d: Discourse, at: int) -> bool:
    """Whether a word says that somebody has something: "got"."""
    return d.tokens[at].norm in d.language.speech.get("having", ())


@dataclass(frozen=True)
class Taking:
    """A thing that is taken from whoever says that they have it, right behind the question."""

    thing: Value
    step: If


def take_from_holder(d: Discourse, thing: Thing) -> bool:
    """Take a thing from the one who says that they have it, if that was asked and nothing has been
    said yet of what is done then."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if (
        d.answers.held is None
        or survey is None
        or thing.value != d.answers.held
        or thing.place is not None
    ):
        return False
    within = (*d.around, d.done) if d.answers.says_so else (d.done,)
    asked = next((step for done in within for step in done if is_in(step, survey.call)), None)
    if asked is None:
        return False
    d.answers = replace(d.answers, held=None, polled_for=None)
    several = any(isinstance(each, ROUNDS) for each in nodes((asked,)))
    taking = Call("grab", {"thing": thing.value})
    yes = survey.said(d.language.phrase("yes"))
    d.answers = replace(
        d.answers, taking=Taking(thing.value, If(yes, (taking, End()) if several else (taking,)))
    )
    note(d, survey.call, [d.answers.taking.step], [])
    d.scene = replace(d.scene, holding=thing.value, at=None, away=True)
    d.scene = d.scene.speaking_of(thing)
    return True


def from_whoever_has_it(d: Discourse, thing: Thing, delivered: Callable[[], Steps]) -> bool:
    """Bring a thing from the one who says that they have it."""
    take_from_holder(d, thing)
    taking: Taking | None = d.answers.taking
    if taking is None or taking.thing != thing.value:
        return False
    d.answers = replace(d.answers, taking=None)
    d.scene = replace(d.scene.wandered(), holding=thing.value)
    bringing = d.sequence(lambda: d.done.extend(delivered()))
    taken, *end = taking.step.then
    brought = If(taking.step.condition, (taken, *bringing, *end))
    for done in (*d.around, d.done):
        done[:] = exchanged(done, taking.step, [brought])
    d.scene = replace(d.scene, at=None, away=True)
    return True


def the_one_who_says_so(d: Discourse, node: Node) -> Steps | None:
    """ "if one of them says yes, bring it to me", of a thing that several were asked about: from
    that one, before the others are asked."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    then, condition = node.parts["then"], node.parts["condition"]
    if d.answers.held is None or survey is None or not isinstance(survey.who, Recall):
        return None
    about = what_it_means(condition)
    said_yes = about in ("answered", "answers_reached") and not hands_on(node)
    no = set(d.norms(condition.start, condition.end)) & set(d.language.words_called("negations"))
    if not said_yes or no or not hands_it_over(then):
        return None
    d.answers = replace(d.answers, says_so=True)
    steps: Steps = d.build(then)
    d.answers = replace(d.answers, says_so=False)
    return steps


def hands_on(node: Node) -> bool:
    """Whether it is said what is done otherwise."""
    return any(name.startswith("otherwise") for name in node.parts)


def is_in(step: Step, call: Call) -> bool:
    return any(each is call for each in nodes((step,)))


@meaning("fetch_held")
def fetch_held(d: Discourse, node: Node) -> Steps:
    """ "get it from whoever has it": where it goes is said next."""
    if d.scene.thing is None or not take_from_holder(d, d.scene.thing):
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    return []
