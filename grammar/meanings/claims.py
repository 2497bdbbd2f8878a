"""What is so in a branch of a condition: said as a sentence, and the scene that it gives."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node, what_it_means
from grammar.discourse import (
    ANYONE,
    Claim,
    Discourse,
    Meeting,
    Steps,
    Thing,
)
from grammar.meanings.finding import go, not_found, speak_to
from grammar.meanings.orders_to_tell import coming_back, tell_speaker
from grammar.meanings.persons import is_me
from grammar.meanings.polls import polled
from grammar.meanings.reports import known_words
from grammar.meanings.rooms import in_words, room_spoken_of
from grammar.meanings.sights import named_some
from grammar.meanings.speaking import put_for, sentence_form
from grammar.memory import Scene
from grammar.plan import (
    Ask,
    Call,
    Compare,
    Condition,
    Items,
    Recall,
    Remember,
    Step,
    Text,
)
from grammar.tidy import mentions
from grammar.wordforms import plural

COUNT: Final = "count"
"""The variable that a number is kept in which a condition is about."""


def claim_of(d: Discourse, node: Node, condition: Condition, met: Meeting | None) -> Step | None:
    """What a condition says, as a sentence of its own: "if there is a cup, tell me"."""
    part = node.parts["condition"]
    if what_it_means(part) in ("some_places", "present_so_many") and d.round.claims is not None:
        claims = d.round.claims
        said: Step = claims.yes if condition == claims.condition else claims.no
        return said
    if what_it_means(part) in ("so", "answered"):
        # Of a round it would be told at each place, and never that it is nowhere.
        return found_claim(d, condition, met) if met is not None and not d.loops.in_loop else None
    if what_it_means(part) == "answers_many":  # "if anyone says yes, tell Alice": how many did
        return polled(d, "many", None).words[0]
    if (
        (_is_of_them(part) and found_claim(d, condition, met) is not None)
        or node.production.fixed.get("turned")
        or node.production.fixed.get("unless")
    ):
        return found_claim(d, condition, met)
    end = part.end
    while d.tokens[end - 1].kind == "mark":
        end -= 1
    room = room_spoken_of(d, part.start, end)
    clause = as_fact(d, in_words(d, part.start, end, room))
    return Call("say", {"text": Text(sentence_form(clause))})


NAMELESS: Final = frozenset({"one_of_them", "person_pronoun"})


def _is_of_them(part: Leaf | Node) -> bool:
    """Whether what a condition is about has no name in it: "keiner ist mehr da", "he is not there",
    which says nothing to somebody who has not heard of whom."""
    if isinstance(part, Leaf):
        return False
    return part.production.means in NAMELESS or any(map(_is_of_them, part.parts.values()))


def as_fact(d: Discourse, clause: str) -> str:
    """What was waited for, in the words for what is so: "soit sorti" -> "est sorti", and of the
    robot as it speaks of itself: "you see a cup" -> "I see a cup"."""
    facts: dict[str, str] = d.language.speech.get("indicative", {})
    clause = " ".join(facts.get(word, word) for word in clause.split(" "))
    return put_for(d, "of_robot", clause)


def found_claim(d: Discourse, condition: Condition, met: Meeting | None) -> Step | None:
    """What has been found, or how many were counted."""
    if met is not None and met.holds:
        return d.say("yes_seen", thing=named_some(d, met.thing))
    if met is not None and met.thing.text == ANYONE:
        return d.say("nobody_seen")
    if met is not None:
        return not_found(d, met.thing)
    if d.round.claims is not None and d.round.claims.condition == condition:
        missing: Step = d.round.claims.no
        return missing
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
    thing = replace(met.thing, here=met.holds, pronoun=False, first=False)
    d.scene = replace(
        d.scene,
        missing=None if met.holds else replace(met.thing, place=met.thing.place or d.scene.at),
    )
    d.scene = replace(d.scene, lacking=None if met.holds or met.sought else d.scene.missing)
    if isinstance(thing.place, Items):  # wherever it was found
        d.scene = replace(d.scene.wandered(), away=True)
    elif thing.place is not None:  # it was looked for there
        d.went(thing.place)
        d.scene = replace(d.scene, looked_in=thing.place)
    if not met.holds:
        thing = replace(thing, place=None, furniture=None)
    if thing.person:
        d.scene = d.scene.speaking_of_person(thing)
        d.scene = replace(d.scene, with_person=thing.value if met.holds else None)
        if met.holds and not thing.known:
            d.people = replace(d.people, visitor=thing)
    else:
        if met.holds and thing.plural:  # "if there are cups, bring them here"
            thing = replace(thing, every=True)
        d.scene = d.scene.speaking_of(thing)


def leave_off(d: Discourse, after: Scene) -> None:
    """The scene behind both branches: where the robot is only if it is there either way, and who
    was spoken of in the first."""
    at, with_person = d.scene.at, d.scene.with_person
    d.scene = after
    if d.scene.at != at:
        d.scene = replace(d.scene, at=None)
    if d.scene.with_person != with_person:
        d.scene = replace(d.scene, with_person=None)
        if d.scene.person is not None and d.scene.person.known:
            d.scene = replace(d.scene, person=replace(d.scene.person, here=False))


TELL: Final = "tell_condition"


def told_so(d: Discourse, node: Node, claim: Step | None) -> Steps:
    """Tell whoever is to be told that something is so."""
    person: Thing | None = d.get(node, "person_ref")
    if "at_place" in node.parts:  # "tell the kitchen": whoever is there
        return [*go(d, d.get(node, "at_place")), *(known_words(d) if claim is None else [claim])]
    if is_me(person):
        outer = d.branch.claim
        d.branch = replace(
            d.branch, claim=None if claim is None else Claim(claim, d.known_by_now())
        )
        told = coming_back(d, node, tell_speaker(d))
        d.branch = replace(d.branch, claim=outer)
        return told
    words = known_words(d) if claim is None else [claim]
    # "Go to the lobby. If nobody is there, tell Bob": he need not be where the robot was sent.
    return d.sequence(lambda: d.done.extend(speak_to(d, person, words)))
