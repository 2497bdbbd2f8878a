"""What is brought, and what hangs on a delivery: for whom a thing is that nobody was named for, and
what is done if the thing or who is to get it is not there.

"Bring me a coffee. If there is none, bring tea": said afterwards, decided before. The delivery goes
under the condition that what it needs is found; what is said for the other case is the other
branch.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, Meeting, Steps, Thing, Where
from grammar.meanings.persons import is_me
from grammar.meanings.places import own_place
from grammar.meanings.searches import search_of, searches
from grammar.meanings.surveys import Survey
from grammar.memory import Scene
from grammar.plan import Ask, Call, Condition, Holds, If, Items, Recall, Step, Text, Value
from grammar.tidy import nodes


@dataclass(frozen=True)
class Delivery:
    """Something that was brought to somebody or put somewhere."""

    thing: Thing
    person: Thing | None
    spot: Where | None
    steps: tuple[Step, ...]
    before: Scene
    """The scene in which it began."""
    needed: bool = False
    """Whether it was only said that somebody needs it."""

    @property
    def receiver(self) -> Thing | None:
        """Whom it is for, unless that is the speaker."""
        return None if is_me(self.person) else self.person


@dataclass(frozen=True)
class Taken:
    """What a delivery needs, as a condition, and the steps that then make it."""

    condition: Condition
    steps: Steps
    delivery: Delivery


def delivered_last(d: Discourse) -> Delivery | None:
    """The delivery that the last step ends."""
    delivery: Delivery | None = d.deliveries.last
    last = d.done[-1] if d.done else None
    if delivery is None or not delivery.steps or last is not delivery.steps[-1]:
        return None
    return delivery


def ordered_now(d: Discourse, thing: Thing, person: Thing | None) -> Delivery | None:
    """What was only said to be needed, taken out of the steps, for now it is said what to do: "Bob
    needs bandages. Go to the lab and take him a bandage from there"."""
    need: Delivery | None = d.deliveries.last
    if need is None or not is_needed(d, thing):
        return None
    receiver = need.receiver
    same = is_me(person) if receiver is None else person is None or person.value == receiver.value
    if person is not None and not same:
        return None
    gone = places_gone_to(d)
    end = len(d.done) - len(gone)
    start = end - len(need.steps)
    if not need.steps or d.done[start:end] != list(need.steps):
        return None
    del d.done[start:end]
    d.scene = need.before
    for place in gone:
        d.went(place)
    return need


def places_gone_to(d: Discourse) -> list[Value]:
    """The places that the last steps go to, one after the other, with nothing done there."""
    visited: list[Value] = []
    for step in reversed(d.done):
        if not (isinstance(step, Call) and step.method == "goto" and "place" in step.arguments):
            break
        visited.insert(0, step.arguments["place"])
    return visited


def is_needed(d: Discourse, thing: Thing) -> bool:
    """Whether somebody was said to need such a thing."""
    need: Delivery | None = d.deliveries.last
    return need is not None and need.needed and (need.thing.pronoun or _alike(thing, need.thing))


def for_them(need: Delivery, spot: Where | None) -> tuple[Thing | None, Where | None]:
    """Whom what is needed is for, who is where it is to be brought."""
    receiver = need.receiver
    if receiver is None or spot is None:
        return receiver, spot
    return (None, spot) if spot.furniture else (replace(receiver, place=spot.place), None)


def lacks(delivery: Delivery | None, met: Meeting | None) -> bool:
    """Whether a condition says that what a delivery needs is missing."""
    if delivery is None or met is None or met.holds:
        return False
    return _same(met.thing, delivery.thing) or _same(met.thing, delivery.receiver)


def _same(one: Thing, other: Thing | None) -> bool:
    """Whether one is the other, or what it is called for short: "tea" for a cup of tea."""
    return other is not None and (
        one.value == other.value or f" {other.text}".endswith(f" {one.text}")
    )


def taken_back(d: Discourse, delivery: Delivery, met: Meeting) -> Taken | None:
    """The last delivery, taken out of the steps as far as it needs what is missing; the scene is
    then as it was before that."""
    missing = delivery.thing if _same(met.thing, delivery.thing) else met.thing
    methods = ("find",) if missing.person else ("find", "grab")
    at = next(
        (
            at
            for at in range(len(d.done) - 1, -1, -1)
            if _is_about(d.done[at], methods, missing, delivery)
        ),
        None,
    )
    if at is None:
        return None
    if at and _is_about(d.done[at - 1], ("find",), missing, delivery):
        at -= 1
    first = d.done[at]
    search = search_of(first)
    steps = d.done[at:]
    del d.done[at:]
    d.scene = delivery.before
    if search is not None:
        steps = steps[1:]
        there = met.thing.place
        if there is None and missing.person and not met.sought:
            there = own_place(d, missing)  # where they are missed
        condition = _looking_there(search.found, there)
    else:
        assert isinstance(first, Call)
        arguments: dict[str, Value] = {"thing": first.arguments["thing"]}
        place = met.thing.place
        elsewhere = place is not None and place != d.scene.at
        if place is not None and elsewhere:
            arguments["place"] = place
        condition = Holds(Ask("find" if elsewhere else "sees", arguments))
    if missing.person:
        d.scene = replace(d.scene, holding=delivery.thing.value)
        d.scene = replace(
            d.scene.speaking_of(replace(delivery.thing, pronoun=True)), person=met.thing
        )
    return Taken(condition, steps, delivery)


def _looking_there(condition: Condition, place: Value | None) -> Condition:
    """A search in the place where it is said afterwards that it would be."""
    if not isinstance(condition, Holds) or not isinstance(condition.value, Ask):
        return condition
    if place is None or isinstance(place, Items):
        return condition
    return Holds(Ask("find", {**condition.value.arguments, "place": place}))


def _is_about(step: Step, methods: tuple[str, ...], missing: Thing, delivery: Delivery) -> bool:
    """Whether a step looks for what is missing, or takes it."""
    search = search_of(step)
    if search is not None and isinstance(step, If):
        sought = [each.arguments["thing"] for each in searches(search.found)]
        return missing.value in sought or (not missing.person and step is delivery.steps[0])
    if not isinstance(step, Call) or step.method not in methods:
        return False
    said = step.arguments["thing"]
    if said == missing.value:
        return True
    mine = next((each for each in delivery.steps if isinstance(each, Call)), None)
    return not missing.person and mine is step  # "cup on the table"


# --- whom a thing is for


def meant_for(d: Discourse, thing: Thing) -> tuple[Thing | None, Where | None]:
    """Who gets a thing that is to be brought without a word to whom: whoever was to get what there
    was none of, the place that has none, who was asked about it; else the speaker."""
    if isinstance(d.deliveries.meant_for, Delivery):
        return d.deliveries.meant_for.person, d.deliveries.meant_for.spot
    lacking = d.scene.lacking
    if lacking is not None and lacking.place is not None and _alike(thing, lacking):
        return None, Where(lacking.place, lacking.furniture)
    return who_asked_for(d, thing), None


def who_asked_for(d: Discourse, thing: Thing) -> Thing | None:
    """Who was asked whether they need something, or what they want: it is for them."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if survey is None or d.answers.last is None or survey.call.save_as != d.answers.last:
        return None
    if thing.value != Recall(d.answers.last):
        question = survey.call.arguments["question"]
        asked = set(d.language.tokens_of(question.value)) if isinstance(question, Text) else set()
        spoken_of = thing.pronoun or thing.value == (d.scene.thing.value if d.scene.thing else None)
        about = spoken_of or set(d.language.tokens_of(thing.text)) & asked
        wished = set(d.language.speech.get("wishes", ())) & asked
        if not isinstance(thing.value, Text) or not wished or not about:
            return None
    if survey.who is not None and survey.where is None and survey.who != d.scene.place:
        return Thing(survey.who, known=True, person=True)
    return Thing(Text(ANYONE), person=True, here=True)


def _alike(one: Thing, other: Thing) -> bool:
    return _same(one, other) or bool(one.noun and one.noun == other.noun)


def whereto_told(d: Discourse, thing: Thing) -> Thing:
    """ "The letter is for Bob. Take it to his office": what was only said to be for somebody is
    brought as is said then, and not twice."""
    delivery: Delivery | None = d.deliveries.destined
    if delivery is None or not thing.pronoun or thing.value != delivery.thing.value:
        return thing
    if not d.done or d.done[-1] is not delivery.steps[-1]:
        return thing
    del d.done[-len(delivery.steps) :]
    d.scene = delivery.before
    d.deliveries = replace(d.deliveries, destined=None)
    d.scene = replace(d.scene, person=delivery.person)
    d.scene = d.scene.speaking_of(delivery.thing)
    return delivery.thing


# --- a delivery whose end is decided then


def hands_it_over(part: Leaf | Node | None) -> bool:
    """Whether a branch says what becomes of a thing that was spoken of: "give it to Bob"."""
    return any(
        each.production.means in ("bring", "put")
        and ("thing" not in each.parts or _is_it(each.parts["thing"]))
        for each in inside(part)
    )


def gives_it(part: Leaf | Node) -> bool:
    """Whether a branch hands it to somebody."""
    return any(each.production.means == "bring" for each in inside(part))


def _is_it(part: Leaf | Node) -> bool:
    return isinstance(part, Node) and part.production.means == "thing_it"


def inside(part: Leaf | Node | None) -> Iterator[Node]:
    """A node of the parse and all in it."""
    if isinstance(part, Node):
        yield part
        for each in part.parts.values():
            yield from inside(each)


def first_clause(clause: Node) -> Node:
    """The first clause of what may be a sequence of them."""
    first = clause
    while first.production.means in (None, "steps") and first.parts:
        first = next((each for each in first.parts.values() if isinstance(each, Node)), first)
        if not any(isinstance(each, Node) for each in first.parts.values()):
            break
    return first


def still_in_hand(d: Discourse, delivery: Delivery) -> Step | None:
    """The last step of a delivery, taken back, for what is said next may change it: "take it to the
    lab; if somebody is there, give it to them"."""
    last = d.done[-1]
    whereto = delivery.spot is not None and not delivery.spot.furniture
    if not isinstance(last, Call) or not (whereto or delivery.receiver is not None):
        return None
    d.done.pop()
    d.scene = replace(d.scene, delivered=None, holding=delivery.thing.value)
    d.scene = d.scene.speaking_of(replace(delivery.thing, pronoun=True))
    return last


def kept_in_hand(d: Discourse, *, asking: bool = True) -> Steps | None:
    """How a thing was handed over before something was asked, taken back: "take her a sandwich and
    ask whether she wants it. If not, bring it back"; or before nothing but words, if not `asking`:
    "take her the form, tell her to sign it and bring it back"."""
    delivery: Delivery | None = d.deliveries.last
    if delivery is None or not delivery.steps or delivery.spot is not None:
        return None
    at = next((at for at, step in enumerate(d.done) if step is delivery.steps[-1]), None)
    if at is None:
        return None
    unsaid = delivery.person is None and leaves_things(d.done[at + 1 :])
    since = d.done[at + 1 :]
    words_only = only_asks(since) if asking else not since or leaves_things(since)
    if not unsaid and not words_only:
        return None
    first = at
    if delivery.receiver is None and at and d.done[at - 1] == Call("goto", {"place": d.start()}):
        first = at - 1  # nobody goes back with it in between
    handing = d.done[first : at + 1]
    del d.done[first : at + 1]
    d.scene = replace(d.scene, delivered=None, holding=delivery.thing.value)
    d.scene = d.scene.speaking_of(replace(delivery.thing, pronoun=True, place=None))
    return handing


def only_asks(steps: Steps) -> bool:
    """Whether some steps go to somebody to ask them something, and leave things where they are."""
    calls = [each for each in nodes(tuple(steps)) if isinstance(each, Call)]
    return leaves_things(steps) and any(each.method == "ask" for each in calls)


def leaves_things(steps: Steps) -> bool:
    """Whether some steps only go somewhere, wait and speak."""
    calls = [each for each in nodes(tuple(steps)) if isinstance(each, Call)]
    return bool(calls) and all(
        each.method in ("ask", "find", "goto", "say", "wait", "wait_for") for each in calls
    )


def missed_at_home(d: Discourse, delivery: Delivery | None, met: Meeting | None) -> Meeting | None:
    """ "if his office is empty", "if nobody is there": who is to get something is not there."""
    receiver = None if delivery is None else delivery.receiver
    if receiver is None or met is None or met.holds or met.thing.text != ANYONE:
        return met
    home = own_place(d, receiver)
    if met.thing.place is None:
        return replace(met, thing=receiver)
    if home is None or met.thing.place != home:
        return met
    return replace(met, thing=replace(receiver, place=home))


def given_last(d: Discourse) -> bool:
    """Whether the last step was to hand something to the speaker, or to do so with several."""
    last = d.done[-1] if d.done else None
    return last is not None and (
        last == d.deliveries.delivered_in or (isinstance(last, Call) and last.method == "give")
    )
