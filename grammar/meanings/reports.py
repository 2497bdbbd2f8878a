"""Telling what the robot finds out: the time, the place, what it sees, how many there are."""

from __future__ import annotations

from grammar.chart import Node
from grammar.discourse import (
    ANYONE,
    Ambiguous,
    Discourse,
    NotUnderstood,
    Steps,
    Thing,
    Where,
    as_value,
)
from grammar.meanings.actions import look_for, not_found, noun_of, speak_to
from grammar.meanings.registry import meaning
from grammar.plan import Ask, Call, Compare, Holds, If, Number, Text, Value
from grammar.wordforms import plural


@meaning("tell")
def tell(d: Discourse, node: Node) -> Steps:
    """Say a phrase with the result of a robot method in it."""
    fixed = node.production.fixed
    value = Ask(str(fixed["method"]), dict(_arguments(d, node)), fixed.get("field"))
    steps = [d.say(str(fixed["phrase"]), value=value)]
    return speak_to(d, d.get(node, "person_ref"), [*steps])


def _arguments(d: Discourse, node: Node) -> list[tuple[str, Value]]:
    names = ("kind", "lines", "selector")
    return [(name, as_value(d.get(node, name))) for name in names if d.get(node, name) is not None]


def go_and_look(d: Discourse, thing: Thing) -> Steps:
    """Drive to where a question is about, if it is about somewhere else."""
    if thing.place is None or thing.place == d.at:
        return []
    d.went(thing.place)
    return [Call("goto", {"place": thing.place})]


@meaning("tell_count")
def tell_count(d: Discourse, node: Node) -> Steps:
    """ "how many cups are in the kitchen?"."""
    thing = noun_of(d, node)
    thing = _at(d, node, thing)
    steps = go_and_look(d, thing)
    noun = plural(thing.text, d.language) if not thing.person else None
    if noun is None:
        noun = (
            d.language.phrase("people") if thing.text == ANYONE else plural(thing.text, d.language)
        )
    count = Ask("count", {"thing": thing.value})
    return [*steps, *_back(d, node), d.say("counted", count=count, things=noun)]


def _at(d: Discourse, node: Node, thing: Thing) -> Thing:
    spot: Where | None = d.get(node, "spot")
    if spot is None:
        return thing
    value = thing.value
    if spot.furniture and isinstance(value, Text):
        value = Text(f"{value.value} {d.language.phrase('on_furniture', furniture=spot.furniture)}")
    return Thing(value, spot.place, spot.furniture, thing.known, thing.plural, thing.person)


def _back(d: Discourse, node: Node) -> Steps:
    """ "... and come back to tell me" is not asked for here."""
    return []


@meaning("tell_seen")
def tell_seen(d: Discourse, node: Node) -> Steps:
    """ "what do you see?", "who is in the lobby?", "what is on the table?"."""
    spot: Where | None = d.get(node, "spot")
    steps: Steps = []
    if spot is not None and spot.place is not None:
        steps = go_and_look(d, Thing(Text(""), spot.place))
    method = str(node.production.fixed["method"])
    phrase = "people_seen" if method == "people" else "objects_seen"
    return [*steps, d.say(phrase, value=Ask(method))]


@meaning("tell_whether")
def tell_whether(d: Discourse, node: Node) -> Steps:
    """ "is there anybody in the waiting room?": look, and say yes or no."""
    thing = _at(d, node, noun_of(d, node))
    steps = go_and_look(d, thing)
    seen = Holds(Ask("sees", {"thing": thing.value}))
    return [
        *steps,
        If(
            seen,
            (d.say("yes_seen", thing=_named(d, thing)),),
            (d.say("no_seen", thing=_named(d, thing)),),
        ),
    ]


def _named(d: Discourse, thing: Thing) -> str:
    if thing.person and thing.text == ANYONE:
        return d.language.phrase("somebody")
    return thing.text if thing.known and thing.person else d.language.phrase("a", noun=thing.text)


@meaning("describe")
def describe(d: Discourse, node: Node) -> Steps:
    thing = _at(d, node, noun_of(d, node))
    steps = look_for(d, thing) if thing.place is not None else []
    return [*steps, Call("say", {"text": Ask("describe", {"thing": thing.value})})]


@meaning("scan")
def scan(d: Discourse, node: Node) -> Steps:
    """Scan a code; said aloud where nothing else is done with it."""
    d.code = d.variable("code")
    d.answer = None
    steps: Steps = [Call("scan", {}, save_as=d.code)]
    return steps


@meaning("tell_log")
def tell_log(d: Discourse, node: Node) -> Steps:
    lines = d.get(node, "lines")
    arguments: dict[str, Value] = {} if lines is None else {"lines": as_value(lines)}
    return [d.say("log_says", value=Ask("log", arguments))]


@meaning("battery_low")
def battery_low(d: Discourse, node: Node) -> Compare:
    fixed = node.production.fixed
    return Compare(Ask("battery"), str(fixed["operator"]), Number(int(fixed["percent"])))


@meaning("where_thing")
def where_thing(d: Discourse, node: Node) -> Steps:
    """ "where is the stapler?": look for it and say where it is."""
    thing = noun_of(d, node)
    found = d.say("it_is_at", thing=_the(d, thing), place=Ask("location"))
    arguments: dict[str, Value] = {"thing": thing.value}
    if thing.place is not None:
        arguments["place"] = thing.place
    d.at = None
    return [If(Holds(Ask("find", arguments)), (found,), (not_found(d, thing),))]


def _the(d: Discourse, thing: Thing) -> str:
    return thing.text if thing.known and thing.person else d.language.phrase("the", noun=thing.text)


@meaning("offer_guide")
def offer_guide(d: Discourse, node: Node) -> Steps:
    """ "where is the lift?": the robot can show the way, if that is wanted."""
    place = d.get(node, "place")
    if not isinstance(place, Text):
        raise NotUnderstood(d.language.phrase("where_is_there"))
    question = d.language.phrase("offer_guide", place=place.value)
    raise Ambiguous(
        question, 0, len(d.tokens), (d.language.phrase("take_me_to", place=place.value),)
    )
