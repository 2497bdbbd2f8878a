"""What is done if something is so, and what otherwise; the two may be sentences of their own.

Both branches begin with the same scene, but for what the condition says: where somebody has been
found they are here, and where they have not they still have to be looked for.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import Claim, Discourse, Meeting, NotUnderstood, Steps, Thing
from grammar.meanings.conditions import condition_of, negated, said_so
from grammar.meanings.finding import go, not_found, speak_to
from grammar.meanings.news import polled
from grammar.meanings.nouns import is_me
from grammar.meanings.registry import meaning
from grammar.meanings.reports import known_words, tell_speaker
from grammar.meanings.sights import named_some
from grammar.meanings.speaking import put_for, sentence_form
from grammar.plan import (
    Ask,
    Call,
    Compare,
    Condition,
    Either,
    Holds,
    If,
    Not,
    Recall,
    Remember,
    Step,
    Text,
)
from grammar.tidy import mentions
from grammar.wordforms import plural
from grammar.wordorder import direct_clause

COUNT: Final = "count"
"""The variable that a number is kept in which a condition is about."""


@meaning("if")
def if_(d: Discourse, node: Node) -> Steps:
    before_it, condition = condition_of(d, node)
    met = d.met
    if node.production.fixed.get("unless"):
        condition, met = negated(condition), turned(met)
    start = d.scene()
    known = d.answer
    then = branch(d, node.parts["then"], met, claim_of(d, node, condition, met))
    after = d.scene()
    d.set_scene(start)
    asked = d.answer is not None and d.answer != known
    denied = node.parts.get("otherwise_denied")
    part = other_branch(d, node, condition) or denied
    if asked and denied is not None:
        # "if Bob is there, ask him whether he has time. If he does not, ...": that is his answer.
        scene = d.scene()
        d.set_scene(after)
        said_no = said_so(d, no=True)
        then = [*then, If(said_no, tuple(branch(d, denied, None, None)))]
        d.set_scene(scene)
    otherwise: Steps = []
    if part is not None and not (asked and part is denied):
        otherwise = branch(d, part, turned(met), found_claim(d, condition, turned(met)))
    else:
        meet_there(d, turned(met))
    leave_off(d, after)
    counted, condition = counted_first(condition, [*then, *otherwise])
    return [*before_it, *counted, *either_way(condition, then, otherwise)]


def other_branch(d: Discourse, node: Node, condition: Condition) -> Leaf | Node | None:
    """What is said to be done otherwise; "but if there are some, ..." is that only where there are
    none at first."""
    part = node.parts.get("otherwise_so")
    if part is None:
        return node.parts.get("otherwise") or node.parts.get("otherwise_not")
    if not isinstance(condition, Not):
        words = d.words(part.start, part.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    return part


def branch(d: Discourse, part: Leaf | Node, met: Meeting | None, claim: Step | None) -> Steps:
    """The steps of one branch; `claim` says what is so in it."""
    meet_there(d, met)
    outer = d.claim
    d.claim = None if claim is None else Claim(claim, d.known_by_now())
    steps: Steps = d.build(part)
    d.claim = outer
    return steps


def claim_of(d: Discourse, node: Node, condition: Condition, met: Meeting | None) -> Step | None:
    """What a condition says, as a sentence of its own: "if there is a cup, tell me"."""
    part = node.parts["condition"]
    if what_it_means(part) in ("so", "answered"):
        return None
    if what_it_means(part) == "answers_many":  # "if anyone says yes, tell Alice": how many did
        return polled(d, "many", None).words[0]
    if node.production.fixed.get("turned") or node.production.fixed.get("unless"):
        return found_claim(d, condition, met)
    end = part.end
    while d.tokens[end - 1].kind == "mark":
        end -= 1
    clause = as_fact(d, direct_clause(d, part.start, end))
    return Call("say", {"text": Text(sentence_form(clause))})


def as_fact(d: Discourse, clause: str) -> str:
    """What was waited for, in the words for what is so: "soit sorti" -> "est sorti", and of the
    robot as it speaks of itself: "you see a cup" -> "I see a cup"."""
    facts: dict[str, str] = d.language.speech.get("indicative", {})
    clause = " ".join(facts.get(word, word) for word in clause.split(" "))
    return put_for(d, "of_robot", clause)


def what_it_means(part: Leaf | Node) -> str:
    """The meaning of a part that may stand for another one."""
    while isinstance(part, Node) and part.production.means is None and len(part.parts) == 1:
        (part,) = part.parts.values()
    return part.means if isinstance(part, Node) else part.slot


def found_claim(d: Discourse, condition: Condition, met: Meeting | None) -> Step | None:
    """What has been found, or how many were counted."""
    if met is not None and met.holds:
        return d.say("yes_seen", thing=named_some(d, met.thing))
    if met is not None:
        return not_found(d, met.thing)
    if isinstance(condition, Compare) and isinstance(condition.left, Ask):
        thing = condition.left.arguments.get("thing")
        if condition.left.method == "count" and isinstance(thing, Text):
            things = plural(d.called(thing.value), d.language)
            return d.say("counted", things=things, value=Recall(COUNT))
    return None


def counted_first(condition: Condition, branches: Steps) -> tuple[Steps, Condition]:
    """A number that is told in a branch is counted before, for it may be told elsewhere."""
    counts = isinstance(condition, Compare) and isinstance(condition.left, Ask)
    if not counts or not mentions(tuple(branches), Recall(COUNT)):
        return [], condition
    assert isinstance(condition, Compare)
    kept = Compare(Recall(COUNT), condition.operator, condition.right)
    return [Remember(COUNT, condition.left)], kept


def turned(met: Meeting | None) -> Meeting | None:
    """The same if the condition is turned round."""
    return None if met is None else replace(met, holds=not met.holds)


def meet_there(d: Discourse, met: Meeting | None) -> None:
    """The scene where a condition holds that is about somebody or something."""
    if met is None:
        return
    thing = replace(met.thing, here=met.holds, pronoun=False)
    d.missing = None if met.holds else replace(met.thing, place=met.thing.place or d.at)
    if thing.place is not None:  # it was looked for there
        d.went(thing.place)
        d.looked_in = thing.place
    if not met.holds:
        thing = replace(thing, place=None, furniture=None)
    if thing.person:
        d.person, d.thing_last = thing, False
        d.with_person = thing.value if met.holds else None
    else:
        d.thing, d.thing_last = thing, True


def leave_off(d: Discourse, after: dict[str, object]) -> None:
    """The scene behind both branches: where the robot is only if it is there either way, and who
    was spoken of in the first."""
    at, with_person = d.at, d.with_person
    d.set_scene(after)
    if d.at != at:
        d.at = None
    if d.with_person != with_person:
        d.with_person = None
        if d.person is not None and d.person.known:
            d.person = replace(d.person, here=False)


def either_way(condition: Condition, then: Steps, otherwise: Steps) -> Steps:
    """A step for both branches. "If Alice is not in her office, look for her in the lab and tell
    her ...": she is told wherever she is found."""
    inner = then[0] if len(then) == 1 else None
    if (
        isinstance(condition, Not)
        and not otherwise
        and isinstance(inner, If)
        and _looks_for(inner.condition) is not None
        and _looks_for(inner.condition) == _looks_for(condition.condition)
    ):
        anywhere = Either((condition.condition, inner.condition))
        return [If(anywhere, inner.then, inner.otherwise)]
    return [If(condition, tuple(then), tuple(otherwise))]


def _looks_for(condition: Condition) -> object:
    """Whom or what a condition looks for; None if it does something else."""
    if (
        isinstance(condition, Holds)
        and isinstance(condition.value, Ask)
        and condition.value.method == "find"
    ):
        return condition.value.arguments["thing"]
    return None


@meaning("tell_condition")
def tell_condition(d: Discourse, node: Node) -> Steps:
    """ "if there are more than three people, tell Alice": that there are more than three people."""
    before_it, condition = condition_of(d, node)
    met = turned(d.met) if node.production.fixed.get("unless") else d.met
    claim = claim_of(d, node, condition, met)
    start = d.scene()
    meet_there(d, met)
    person: Thing | None = d.get(node, "person_ref")
    if "at_place" in node.parts:  # "tell the kitchen": whoever is there
        then = [*go(d, d.get(node, "at_place")), *(known_words(d) if claim is None else [claim])]
    elif is_me(person):
        d.claim = None if claim is None else Claim(claim, d.known_by_now())
        then = tell_speaker(d)
        d.claim = None
    else:
        then = speak_to(d, person, known_words(d) if claim is None else [claim])
    after = d.scene()
    d.set_scene(start)
    part = other_branch(d, node, condition)
    otherwise: Steps = []
    if part is not None:
        otherwise = branch(d, part, turned(met), found_claim(d, condition, turned(met)))
    else:
        meet_there(d, turned(met))
    leave_off(d, after)
    counted, condition = counted_first(condition, [*then, *otherwise])
    return [*before_it, *counted, If(condition, tuple(then), tuple(otherwise))]
