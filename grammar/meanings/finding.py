"""What meanings share: going to a place, finding somebody or something, speaking to them there."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.genders import gender_of_thing, pronoun_of
from grammar.meanings.persons import is_me, together
from grammar.meanings.places import sought
from grammar.naming import person_called, the
from grammar.plan import (
    Ask,
    Call,
    Condition,
    Either,
    ForEach,
    Forever,
    Holds,
    If,
    Items,
    Not,
    Number,
    Recall,
    Repeat,
    Text,
    Value,
)

ROOM_STATES: Final = frozenset({"empty", "free", "full", "occupied"})
"""What rooms and seats are seen to be, and people are not."""
ANYBODY: Final = (ANYONE, "visitor", "patient", "customer")
"""Whoever is there."""


def go(d: Discourse, place: Value) -> Steps:
    """Drive there, unless that is where the robot is by what was said."""
    d.scene = replace(d.scene, place=place)
    if d.scene.at == place:
        return []
    d.went(place)
    return [Call("goto", {"place": place})]


def noun_of(d: Discourse, node: Node) -> Thing:
    """The thing or person of a command."""
    part = node.parts.get("thing")
    thing: Thing | list[Thing] | None = d.build(part) if part is not None else None
    if isinstance(thing, list):  # "a cup and a plate", of which a condition is true
        thing = together(thing)
    if thing is None and speaks_of_things(d, node.parts["person_ref"]):
        thing = replace(d.scene.thing, pronoun=True) if d.scene.thing is not None else None
    if thing is None:
        person = thing_after_all(d, node.parts["person_ref"]) or d.build(node.parts["person_ref"])
        thing = Thing(Text(ANYONE), person=True, here=True) if is_me(person) else person
    thing = in_state(d, node, thing)
    spot: Where | None = d.get(node, "from")
    if spot is not None:
        return replace(thing, place=spot.place, furniture=spot.furniture, pronoun=False)
    return thing


def speaks_of_things(d: Discourse, part: Leaf | Node) -> bool:
    """Whether "they" are things that were spoken of last: "the scissors"."""
    if (
        isinstance(part, Leaf)
        or part.means != "person_pronoun"
        or not d.scene.thing_last
        or d.scene.thing is None
    ):
        return False
    several = d.scene.thing.plural or d.scene.thing.several or d.scene.person is None
    said = set(d.norms(part.start, part.end))
    return several and bool(said & set(d.language.speech.get("things_too", ())))


def thing_after_all(d: Discourse, part: Leaf | Node) -> Thing | None:
    """The thing that a pronoun stands for where things are "he" and "she", too: "bring mir den
    Schlüssel. Wenn er nirgends ist, ..."; but it is Bob who is not there if he was spoken of."""
    genders: dict[str, str] = d.language.speech.get("object_genders", {})
    gender = genders.get(pronoun_of(d, part))
    while isinstance(part, Node) and part.production.means is None and len(part.parts) == 1:
        (part,) = part.parts.values()
    is_pronoun = isinstance(part, Node) and part.means == "person_pronoun"
    if not is_pronoun or gender is None or d.scene.thing is None:
        return None
    if gender_of_thing(d, d.scene.thing) not in (None, gender):
        return None
    nobody = (
        d.scene.person is None or is_me(d.scene.person) or not d.may_have(d.scene.person, gender)
    )
    return replace(d.scene.thing, pronoun=True) if nobody else None


def in_state(d: Discourse, node: Node, thing: Thing) -> Thing:
    """A thing with what is said of it behind its noun: that a bed is free is about a free bed."""
    doing = node.parts.get("doing")
    if doing is not None and node.means == "whether_seen":  # "ob Henry schläft"
        so = Text(f"{thing.text} {d.described_by(doing)}")
        return replace(thing, value=so, known=False)
    state = d.get(node, "state")
    if state is None:
        return thing
    if thing.person and state in ROOM_STATES:  # "if Bob is free"
        words, gap = d.words(node.start, node.end), (node.start, node.end)
        raise NotUnderstood(d.language.phrase("cannot_check", what=words), gap=gap)
    so = Text(d.language.phrase("in_state", state=state, thing=thing.text))
    return replace(thing, value=so)


def found(d: Discourse, thing: Thing) -> Call:
    """The call that looks for a thing or a person."""
    arguments: dict[str, Value] = {"thing": sought(d, thing)}
    if thing.place is not None:
        arguments["place"] = thing.place
    return Call("find", arguments)


def whether_found(d: Discourse, thing: Thing) -> Condition:
    """Whether a thing or a person is found where it may be: in one place after the other."""
    places = thing.place.items if isinstance(thing.place, Items) else (thing.place,)
    searches = tuple(
        Holds(Ask("find", found(d, replace(thing, place=place)).arguments)) for place in places
    )
    return searches[0] if len(searches) == 1 else Either(searches)


def look_for(d: Discourse, thing: Thing) -> Steps:
    """Look for a thing or a person; if it may be in several places, until it is found."""
    several = isinstance(thing.place, Items)
    d.scene = replace(
        d.scene, at=None if several else thing.place, away=thing.place is None or several
    )
    if thing.place is not None and not several:
        d.scene = replace(d.scene, place=thing.place)
    d.scene = replace(d.scene, with_person=thing.value if thing.person else None)
    if thing.person:
        d.scene = d.scene.speaking_of_person(thing)
    else:
        d.scene = d.scene.speaking_of(thing)
    if several:
        looking = If(Not(whether_found(d, thing)), (not_found(d, thing),))
        return [] if d.done and d.done[-1] == looking else [looking]
    once = found(d, thing)
    return [] if d.done and d.done[-1] == once else [once]  # "I lost my bag, find it"


def meet(d: Discourse, person: Thing) -> Steps:
    """Find a person, unless they are here by what was said."""
    if person.first:
        going = go(d, person.place) if person.place is not None else []
        d.scene = replace(d.scene, with_person=person.value)
        d.scene = d.scene.speaking_of_person(replace(person, first=False, place=None, here=True))
        return [*going, Call("wait_for", {"thing": person.value})]
    if person.here or d.scene.with_person == person.value:
        return []
    if not person.known and person.place is None:  # where they were left, if they were led there
        left = d.scene.left.get(person.value)
        return [] if left is None else go(d, left)
    if isinstance(person.place, Items):
        return look_for(d, person)
    d.scene = replace(d.scene, with_person=person.value, at=person.place)
    if person.place is not None:
        d.scene = replace(d.scene, place=person.place)
    return [found(d, person)]


def speak_to(d: Discourse, person: Thing | None, steps: Steps) -> Steps:
    """Say something to a person: here, or where they are found."""
    if person is not None and person.coming:
        going = go(d, person.place) if person.place is not None else []
        return [*going, Forever((Call("wait_for", {"thing": person.value}), *steps))]
    if person is not None and person.count is not None:
        going = go(d, person.place) if person.place is not None else []
        waited_for(d, person.value)
        meeting = Call("wait_for", {"thing": person.value})
        return [*going, Repeat(Number(person.count), (meeting, *steps))]
    if person is not None and isinstance(person.group, Items):
        return each_of(d, person.group, steps)
    if person is None:  # "greet the visitor and say that lunch is ready"
        return (
            steps if d.scene.person is None or d.loops.in_loop else if_met(d, d.scene.person, steps)
        )
    if person.first:
        return [*meet(d, person), *steps]
    person = where_sent(d, person)
    if is_here(d, person):
        return if_met(d, person, steps)
    if not person.known and person.place is not None and (person.plural or person.text == ANYONE):
        return [*go(d, person.place), *steps]
    d.scene = replace(
        d.scene,
        at=None if isinstance(person.place, Items) else person.place,
        with_person=person.value,
    )
    return [If(whether_found(d, person), tuple(steps), (not_found(d, person),))]


def waited_for(d: Discourse, who: Value) -> Value | None:
    """How many of them the step before has waited for, one after the other: it is taken out of the
    steps, for each of them is met in the round that is for them."""
    for steps in (d.done, *d.around[-1:]):
        match steps[-1:]:
            case [Repeat(times, (Call(method="wait_for", arguments=arguments),))]:
                if arguments == {"thing": who}:
                    steps.pop()
                    return times
            case [_]:
                return None
            case _:
                pass
    return None


def meet_several(d: Discourse, person: Thing) -> Steps:
    """ "find two visitors and ask them ...": one after the other, whoever they are."""
    going = go(d, person.place) if person.place is not None else []
    waiting = Call("wait_for", {"thing": person.value})
    return [*going, Repeat(Number(person.count or 1), (waiting,))]


def each_of(d: Discourse, group: Value, steps: Steps) -> Steps:
    """Do something with each of several people, who are looked for one by one."""
    visits_only(d, group)
    d.scene = d.scene.wandered()
    who = Recall(d.variable("person"))
    return [ForEach(who.name, group, tuple(if_found(d, who, steps)))]


def visits_only(d: Discourse, group: Value) -> None:
    """ "go to Alice and Bob and ask them": those who were gone to for nothing else are gone to
    once."""
    last = d.done[-1] if d.done else None
    if not isinstance(last, ForEach) or last.items != group:
        return
    if last.steps == tuple(if_missing(d, Recall(last.variable))):
        d.done.pop()


def if_found(d: Discourse, who: Value, steps: Steps) -> Steps:
    """Steps for which somebody has to be found first."""
    found = Holds(Ask("find", {"thing": who}))
    return [If(found, tuple(steps), (d.say("not_found", thing=who),))]


def if_met(d: Discourse, person: Thing, steps: Steps) -> Steps:
    """Steps with somebody who was looked for just before, if they were found: "tell Bob that lunch
    is ready and ask him ..."."""
    met = met_just_before(d, person)
    if met is None:
        return steps
    d.done.pop()
    return [If(met.condition, (*met.then, *steps), met.otherwise)]


def met_just_before(d: Discourse, person: Thing) -> If | None:
    """The last step, if it does something with somebody where they are found."""
    last = d.done[-1] if d.done else None
    if person.value != d.scene.with_person or not isinstance(last, If):
        return None
    condition, then, otherwise = last.condition, last.then, last.otherwise
    if isinstance(condition, Not) and not otherwise:  # looked for in several places
        condition, then, otherwise = condition.condition, (), then
    if not _is_search(condition) or otherwise != (not_found(d, person),):
        return None
    return If(condition, then, otherwise)


def _is_search(condition: Condition) -> bool:
    """Whether it is that something is found, in one place or in one of several."""
    if isinstance(condition, Either):
        return all(_is_search(each) for each in condition.conditions)
    sought_for = condition.value if isinstance(condition, Holds) else None
    return isinstance(sought_for, Ask) and sought_for.method == "find"


def if_missing(d: Discourse, who: Value) -> Steps:
    """Look for somebody, and say so if they are nowhere."""
    found = Holds(Ask("find", {"thing": who}))
    return [If(Not(found), (d.say("not_found", thing=who),))]


def where_sent(d: Discourse, person: Thing) -> Thing:
    """Somebody spoken of right after going somewhere is there: "go to the bar and follow Alex"."""
    last = d.done[-1] if d.done else None
    going = (
        isinstance(last, Call)
        and last.method == "goto"
        and last.arguments.get("place") == d.scene.at
    )
    if not going or person.place is not None or person.here or person.group is not None:
        return person
    if not isinstance(d.scene.at, Text) or not (person.known or particular(person)):
        return person
    return person if d.scene.at == d.scene.looked_in else replace(person, place=d.scene.at)


def particular(person: Thing) -> bool:
    """Whether somebody is to be told from others: "the girl", "the person waving"."""
    return not person.plural and person.text not in ANYBODY


def is_here(d: Discourse, person: Thing) -> bool:
    """Whether a person can be spoken to without looking for them."""
    if is_me(person) or person.here or person.value == d.scene.with_person:
        return True
    if person.known or person.place is not None or particular(person):
        return False
    # "go to the lobby and tell the visitors ..."
    return person.plural or (d.scene.at is not None and d.scene.at != d.scene.looked_in)


def not_found(d: Discourse, thing: Thing) -> Call:
    if thing.text == ANYONE:
        return d.say("nobody_found")
    return d.say("not_found", thing=named(d, thing))


def named(d: Discourse, thing: Thing) -> Value | str:
    """A thing as it is spoken of: "the stapler", "Alice"."""
    if not isinstance(thing.value, Text):
        return thing.value
    if thing.known and thing.person:
        return person_called(d.called(thing.value.value), d.language)
    return the(d.called(thing.value.value), d.language)
