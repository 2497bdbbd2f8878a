"""Meeting people: guiding, following, greeting."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from grammar.chart import Node, what_it_means
from grammar.discourse import ANYONE, Discourse, Steps, Thing, Where, as_value
from grammar.errors import Ambiguous, NotUnderstood
from grammar.meanings.carrying import deliver
from grammar.meanings.conditions import condition_of
from grammar.meanings.deliveries import given_last, inside
from grammar.meanings.finding import look_for, meet, named, speak_to, where_sent
from grammar.meanings.genders import means_thing
from grammar.meanings.hosts import place_just_named, place_of_named
from grammar.meanings.inquiries import as_many_as_answered
from grammar.meanings.leading import lead
from grammar.meanings.news import BACK
from grammar.meanings.persons import is_me
from grammar.meanings.places import kind_places, own_place
from grammar.meanings.registry import meaning
from grammar.meanings.several_places import over_places
from grammar.meanings.speaking import ready_made, spoken
from grammar.meanings.strangers import announced_one
from grammar.meanings.waiting import awaited
from grammar.naming import place_called
from grammar.plan import Call, Forever, Items, Recall, Text, Value
from grammar.tidy import nodes

WAYS_OUT: Final = frozenset({"entrance", "exit"})
"""Kinds of places where a house ends."""


GUESTS: Final = frozenset({"visitor", "patient", "guest", "child"})
"""Kinds of people who are led, even where somebody only goes with them."""


@meaning("guide")
def guide(d: Discourse, node: Node) -> Steps:
    """Lead a person to a place; go and find them first if they are somebody by name."""
    if node.production.fixed.get("along") and knows_the_way(d, d.get(node, "person_ref")):
        return follow(d, node)
    pronoun = node.parts.get("person_ref")
    carried = not leads_people_only(d, node)
    if pronoun is not None and carried and means_thing(d, pronoun):
        return carry_it(d, node)
    thing = led(d, node)
    there: Value | None = d.get(node, "place")  # as it was spoken of before "from his office"
    room = node.parts.get("spot")
    if isinstance(room, Node) and any(each.means == "place_there" for each in inside(room)):
        there = d.build(room).place
    source: Where | None = d.get(node, "source")
    in_turn = id(pronoun) in d.loops.bound  # met there already
    if source is not None and source.place is not None and not in_turn:
        thing = replace(thing, place=source.place, here=False)
    if thing.value == d.scene.with_person:
        leave_out_fetching(d)
    steps = left_behind(d, node, thing) or meet(d, thing)
    spot: Where = (there is None and d.get(node, "spot")) or Where(there)
    named_one = (
        place_of_named(d, d.answers.surveys[-1])
        if d.answers.surveys and d.answers.surveys[-1].options
        else None
    )
    if "place" in node.parts and named_one is not None and spot.place in (None, d.scene.at):
        spot = Where(named_one)  # "ask whether they want to see Bob or Clara and take them there"
    if spot.place is None:
        raise NotUnderstood(d.language.phrase("guide_needs_place"))
    to_me = "place" in node.parts and what_it_means(node.parts["place"]) == "place_here"
    if "place" in node.parts and not to_me and spot.place == d.scene.at and d.done:
        # "ask the visitors whom they want to see and take them there": no place was spoken of
        raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))
    further: list[Value] = d.get(node, "place_list") or []
    return [*steps, *(lead(d, thing, place) for place in (spot.place, *further))]


def knows_the_way(d: Discourse, person: Thing | None) -> bool:
    """Whether somebody who is gone with leads: the speaker, and whoever is at home here by name,
    but no visitor, nobody who has just come, and no stranger."""
    if person is None or is_me(person):
        return person is not None
    if d.people.visitor is not None:
        return False
    kinds = {each.kind for each in d.lexicon.people if Text(each.name) == person.value}
    return bool(kinds) and kinds.isdisjoint(GUESTS)


def left_behind(d: Discourse, node: Node, person: Thing) -> Steps:
    """The way back to somebody from where the robot went only to see whether a place is free."""
    part = node.parts.get("person_ref")
    only_looked = d.scene.looked_in is not None and d.scene.at in (None, d.scene.looked_in)
    spoken_of = isinstance(part, Node) and part.means in ("person_kind", "person_me")
    met = person.value in d.scene.left or person.value == d.scene.with_person
    if not (only_looked and spoken_of) or person.place is not None or met:
        return []
    d.start()
    d.came_back()
    return [BACK]


def led_on(d: Discourse, person: Thing, place: Value | None) -> Steps | None:
    """ "Emma abholen und zum Röntgen bringen": whoever was just fetched is led straight there."""
    fetched = d.done[-1] if d.done else None
    if place is None or fetched is None or fetched is not d.deliveries.fetched:
        return None
    leave_out_fetching(d)
    return [lead(d, person, place)]


def leave_out_fetching(d: Discourse) -> None:
    """Who is fetched and then led somewhere is not brought here first, nor to be asked where to."""
    at = next((at for at, step in enumerate(d.done) if step is d.deliveries.fetched), None)
    if at is None:
        return
    between = d.done[at + 1 :]
    if all(isinstance(each, Call) and each.method in ("say", "ask") for each in between):
        del d.done[at]


@meaning("guide_where_wanted")
def guide_where_wanted(d: Discourse, node: Node) -> Steps:
    """ "take him where he wants to go": where he has answered, else he is asked."""
    thing = led(d, node)
    if d.answers.last is not None and d.scene.place == Recall(d.answers.last):
        return [*meet(d, thing), lead(d, thing, d.scene.place)]
    steps = meet(d, thing)
    answer = d.variable("place")
    place = Recall(answer)
    d.answers = replace(d.answers, last=answer, options=())
    d.scene = replace(d.scene, place=place)
    arguments: dict[str, Value] = {"question": Text(d.language.phrase("where_to"))}
    if thing.known:
        arguments["person"] = thing.value
    return [*steps, Call("ask", arguments, save_as=answer), lead(d, thing, place)]


def led(d: Discourse, node: Node) -> Thing:
    """Who is to be led: "me" is whoever is here."""
    person: Thing | None = d.get(node, "person_ref")
    if person is None or is_me(person):
        return Thing(Text(ANYONE), person=True, here=True)
    if person.coming or person.group is not None or person.count is not None:
        raise NotUnderstood(d.language.phrase("one_person"))
    guest = d.scene.led
    absent = (
        guest is not None and d.scene.missing is not None and d.scene.missing.value == person.value
    )
    part = node.parts.get("person_ref")
    of_guest = isinstance(part, Node) and what_it_means(part) == "person_pronoun"
    missing = d.scene.missing is not None and d.scene.missing.value == person.value and person.known
    if guest is None and missing and isinstance(part, Node) and of_guest and d.is_plural(part):
        host = named(d, person)  # "if Bob is not in, take them to the lounge"
        words = host if isinstance(host, str) else d.language.phrase("somebody")
        raise NotUnderstood(d.language.phrase("where_is_person", person=words))
    if guest is not None and absent and of_guest:
        return guest  # "take her to Bob's office; if he is not in, take her to the lounge"
    return where_sent(d, person)


@meaning("guide_back")
def guide_back(d: Discourse, node: Node) -> Steps:
    """ "bring her back": to where the command was given."""
    pronoun = node.parts.get("person_ref")
    if pronoun is not None and not leads_people_only(d, node) and means_thing(d, pronoun):
        return fetch_it(d)
    return led_back(d, led(d, node))


def led_back(d: Discourse, person: Thing) -> Steps:
    if d.done and d.done[-1] is d.deliveries.fetched and person.value == d.scene.with_person:
        return []  # "fetch Clara and bring her here"
    steps = meet(d, person)
    return [*steps, lead(d, person, d.start())]


@meaning("fetch_person")
def fetch_person(d: Discourse, node: Node) -> Steps:
    """ "fetch Dr Weber": bring them here; "..., and take them to radiology" is straight there."""
    pronoun = node.parts.get("person_ref")
    if pronoun is not None and means_thing(d, pronoun):
        return fetch_it(d)
    place = d.scene.place
    thing = led(d, node)
    source: Where | None = d.get(node, "source")
    if source is not None and source.place is not None:
        thing = replace(thing, place=source.place, here=False)
    announced = announced_one(d, node, thing.place)
    if announced is not None:
        return announced
    also = led_before(d) if node.production.fixed.get("too") else None
    steps = meet(d, replace(thing, here=False)) or look_for(d, thing)
    d.people = replace(d.people, visitor=d.people.visitor if thing.known else thing)
    if also is not None:
        return [*steps, lead(d, thing, also)]
    leading = lead(d, replace(thing, here=False), d.start())
    d.deliveries = replace(d.deliveries, fetched=leading)
    d.scene = replace(
        d.scene, place=place
    )  # "take Alice to room 3, then get Bob and bring him there, too"
    return [*steps, leading]


def led_before(d: Discourse) -> Value | None:
    """Where somebody was led last: "take Alice to room 3, then fetch Bob, too"."""
    led = [
        each
        for each in nodes(tuple(d.done))
        if isinstance(each, Call)
        and each.method == "guide"
        and each.arguments["place"] != d.start()
    ]
    return led[-1].arguments["place"] if led else None


@meaning("guide_out")
def guide_out(d: Discourse, node: Node) -> Steps:
    """ "lead Bob out": to the entrance, if there is one only; else asks back where to."""
    ways = [place.name for place in d.lexicon.places if place.kind in WAYS_OUT]
    if len(ways) != 1:
        return guide_nowhere(d, node)
    person = led(d, node)
    return [*meet(d, person), lead(d, person, Text(ways[0]))]


@meaning("guide_nowhere")
def guide_nowhere(d: Discourse, node: Node) -> Steps:
    """ "guide Bob": asks back where to."""
    last = d.done[-1] if d.done else None
    if isinstance(last, Call) and last.method == "guide":
        return []  # "Bob wants to go to the kitchen, show him the way"
    if last is not None and Call("answer", {}) in nodes((last,)):
        return []  # "Bob has a question, help him"
    if (asked := place_just_named(d)) is not None:  # "... Bob or Clara, and take him"
        person = led(d, node)
        return [*meet(d, person), lead(d, person, asked)]
    if (
        d.people.host is not None
        and not d.done
        and (theirs := own_place(d, d.people.host)) is not None
    ):
        person = led(d, node)  # "he has an appointment with Clara, take him"
        return [*meet(d, person), lead(d, person, theirs)]
    if d.answers.last is not None and d.scene.place == Recall(d.answers.last):
        return guide_where_wanted(d, node)  # "ask where she wants to go and accompany her"
    who = named(d, led(d, node))
    words = who if isinstance(who, str) else d.language.phrase("somebody")
    to_place = d.language.speech["to_place"]
    raise Ambiguous(
        d.language.phrase("guide_where", person=words),
        node.end,
        node.end,
        tuple(
            to_place.format(place=place_called(place.name, d.lexicon, d.language))
            for place in d.lexicon.places
        ),
    )


def leads_people_only(d: Discourse, node: Node) -> bool:
    """Whether the verb is one that things are no object of: "begleite ihn"."""
    stems = tuple(d.language.speech.get("leads_people", ()))
    return bool(stems) and any(norm.startswith(stems) for norm in d.norms(node.start, node.end))


def carry_it(d: Discourse, node: Node) -> Steps:
    """ "take them to the kitchen", where "they" are cups."""
    assert d.scene.thing is not None
    names = (("person_ref", "thing"), ("source", "from"), ("spot", "where"))
    parts = {new: node.parts[old] for old, new in names if old in node.parts}
    so_many = as_many_as_answered(d, replace(node, parts=parts))
    if so_many is not None:
        return so_many
    spot: Where = d.get(node, "spot") or Where(d.get(node, "place"))
    source: Where | None = d.get(node, "source")
    thing = replace(d.scene.thing, pronoun=True)
    if source is not None:
        thing = replace(thing, place=source.place, furniture=source.furniture)
    return deliver(d, thing, None, spot)


def brought_here(d: Discourse, person: Thing) -> Steps:
    """ "get the visitor and bring them to me": once."""
    if d.deliveries.fetched is not None and d.done[-1:] == [d.deliveries.fetched]:
        d.deliveries = replace(
            d.deliveries, fetched=None
        )  # that is not all the same as to be fetched
        return []
    return [*meet(d, person), lead(d, person, d.start())]


def fetch_it(d: Discourse) -> Steps:
    """ "I want the cups from the kitchen, can you get them?": for the speaker, once."""
    assert d.scene.thing is not None
    if d.scene.delivered is not None and given_last(d):
        return []
    return deliver(d, replace(d.scene.thing, pronoun=True), None, None)


@meaning("guide_list")
def guide_list(d: Discourse, node: Node) -> Steps:
    """ "guide the visitors through all labs"."""
    person = led(d, node)
    return [
        *meet(d, person),
        *over_places(
            d, node, kind_places(d, d.get(node, "kinds")), lambda place: [lead(d, person, place)]
        ),
    ]


@meaning("wait_with")
def wait_with(d: Discourse, node: Node) -> Steps:
    """ "stay with Henry for ten minutes", "until Alice comes"."""
    steps = meet(d, led(d, node))
    if "condition" in node.parts:
        looking, condition = condition_of(d, node)
        return [*steps, *awaited(looking, condition)]
    return [*steps, Call("wait", {"seconds": as_value(d.get(node, "seconds"))})]


@meaning("follow")
def follow(d: Discourse, node: Node) -> Steps:
    person = led(d, node)
    spot: Where | None = d.get(node, "spot")
    place: Value | None = d.get(node, "place") if spot is None else spot.place
    return [*meet(d, person), followed(d, person, place)]


def followed(d: Discourse, person: Thing, place: Value | None) -> Call:
    """Go after somebody, as far as a place if one is named."""
    arguments: dict[str, Value] = {"person": person.value}
    d.scene = replace(d.scene, at=None)
    if place is not None:
        arguments["to"] = place
        d.scene = d.scene.arrived(place)
    d.scene = replace(
        d.scene,
        with_person=person.value,
        person=replace(person, place=None, furniture=None, here=True),
        thing_last=False,
    )
    return Call("follow", arguments)


@meaning("greet")
def greet(d: Discourse, node: Node) -> Steps:
    person: Thing | None = d.get(node, "person_ref")
    name: Value | str = person.value if person is not None and person.known else ""
    if not name and node.production.fixed.get("by_name"):
        if d.answers.last is None:
            raise NotUnderstood(d.language.phrase("whose_name"))
        name = Recall(d.answers.last)
    words = ready_made(d, "hello_name", name=name) if name else ready_made(d, "hello")
    return speak_to(d, person, [words])


@meaning("call_person")
def call_person(d: Discourse, node: Node) -> Steps:
    """ "call her", "call all the nurses": those whom the robot has among its contacts."""
    person: Thing = d.get(node, "person_ref")
    everybody = (person.value,) if isinstance(person.value, Text) else group_of(d)
    if all(isinstance(each, Text) and each.value in d.lexicon.contacts for each in everybody):
        return [Call("call", {"contact": person.value})]
    words = d.words(node.parts["person_ref"].start, node.parts["person_ref"].end)
    raise NotUnderstood(d.language.phrase("unknown_contact", name=words))


def group_of(d: Discourse) -> tuple[Value, ...]:
    """The people spoken of together."""
    return d.scene.group.items if isinstance(d.scene.group, Items) else ()


@meaning("greet_all")
def greet_all(d: Discourse, node: Node) -> Steps:
    """ "greet everybody who comes in": again and again; maybe with words of one's own."""
    worded = "quote" in node.parts or "text" in node.parts
    greeting = Call("say", {"text": spoken(d, node)}) if worded else d.say("hello")
    return [Forever((Call("wait_for", {"thing": Text(ANYONE)}), greeting))]
