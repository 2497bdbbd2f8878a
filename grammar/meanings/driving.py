"""Going places, moving and turning, waiting."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import SETTING, Discourse, Steps, Thing, Where, as_value
from grammar.errors import NotUnderstood
from grammar.meanings.finding import go, look_for, noun_of, where_sent
from grammar.meanings.leading import lead
from grammar.meanings.loops import for_each_of_them, looped
from grammar.meanings.orders_to_tell import tell_speaker
from grammar.meanings.persons import is_me
from grammar.meanings.places import sought
from grammar.meanings.registry import meaning
from grammar.meanings.reports import counted_alone
from grammar.meanings.searches import searched
from grammar.meanings.strangers import announced_one
from grammar.meanings.waiting import wait_until
from grammar.meanings.whereabouts import looked_further
from grammar.plan import (
    Ask,
    Both,
    Call,
    Condition,
    Either,
    Holds,
    If,
    Items,
    Number,
    Recall,
    Remember,
    Repeat,
    Step,
    Text,
    Value,
)
from grammar.tidy import nodes
from grammar.wordforms import singular


@meaning("go")
def go_to(d: Discourse, node: Node) -> Steps:
    """Drive to a place; to a piece of furniture, that is to where it stands."""
    spot: Where = d.get(node, "spot") or Where(d.get(node, "place"))
    if spot.place is None:
        return look_for(d, Thing(Text(str(spot.furniture))))
    place = spot.place
    if node.production.fixed.get("bare") and searched(d.done[-1] if d.done else None) is not None:
        # "look for Clara in the kitchen, then in the library": that is where to look
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    if "place" in node.parts and place == d.scene.at and d.done:
        if not d.language.words_called("returning").intersection(d.norms(node.start, node.end)):
            return []  # "knock at office 1, go in"
        place = place_before(d)  # "take them there, then go back there": to where you were
    with_them = goes_on_with_somebody(d, node) or (bare_way(node) and just_led(d))
    if with_them and d.scene.person is not None:
        return [lead(d, d.scene.person, place)]
    d.went(place)
    d.scene = replace(d.scene, at_furniture=spot.furniture)
    d.people = replace(d.people, on_duty=str(node.production.fixed.get("duty", "")))
    return [Call("goto", {"place": place})]


def goes_on_with_somebody(d: Discourse, node: Node) -> bool:
    """Whether a tour goes on: "take them to the library ..., then go on to the lounge"."""
    words = d.norms(node.start, node.end)
    ways = map(d.language.tokens_of, d.language.speech.get("going_on", ()))
    on = any(tuple(words[: len(way)]) == way for way in ways)
    guest = d.scene.person.value if d.scene.person is not None else None
    return (
        on
        and guest is not None
        and d.scene.with_person == guest
        and guest in d.scene.left
        and d.scene.left[guest] == d.scene.at
    )


def bare_way(node: Node) -> bool:
    """Whether a command is nothing but a place: "to the lounge"."""
    return bool(node.production.fixed.get("way"))


def just_led(d: Discourse) -> bool:
    """Whether the step before, in its branch too, leads somebody somewhere: "take her to room 1 if
    it is Alice, and to room 2 if it is Bob"; whatever is said there on a tour."""
    before = next((steps for steps in (d.done, *d.around[-1:]) if steps), [])
    silent = (each for each in reversed(before) if getattr(each, "method", "") != "say")
    last: Step | None = next(silent, None)
    while isinstance(last, If) and last.then:
        last = last.then[-1]
    return isinstance(last, Call) and last.method == "guide"


def place_before(d: Discourse) -> Value:
    """Where the robot was before it came to where it is."""
    places = [
        each.arguments["place"]
        for each in nodes(tuple(d.done))
        if isinstance(each, Call) and each.method in ("goto", "guide") and "place" in each.arguments
    ]
    return next((place for place in reversed(places) if place != d.scene.at), None) or d.start()


@meaning("find_furniture")
def find_furniture(d: Discourse, node: Node) -> Steps:
    """ "find the wardrobe": where the world says that it stands, else it has to be looked for."""
    spot: Where = d.get(node, "spot")
    if spot.place is not None:
        return go_to(d, node)
    steps = look_for(d, Thing(Text(str(spot.furniture)), d.scene.at))
    return [*steps]


@meaning("look_in")
def look_in(d: Discourse, node: Node) -> Steps:
    """ "look in the kitchen": go there; for what was looked for in vain, where there is such."""
    spot: Where = d.get(node, "spot")
    more: list[Value] = d.get(node, "place_list") or []
    if spot.place is None:
        return go_to(d, node)
    if spot.furniture is not None and d.scene.missing is not None and not more:
        return look_for(d, replace(d.scene.missing, place=spot.place, furniture=spot.furniture))
    looked = looked_further(d, [spot.place, *more])
    if looked is None and more:
        raise NotUnderstood(d.language.phrase("look_for_what"))
    return go_to(d, node) if looked is None else looked


@meaning("go_find")
def go_find(d: Discourse, node: Node) -> Steps:
    """ "go to the kitchen to find the cup"."""
    return there_to(d, node, go_to(d, node))


def there_to(d: Discourse, node: Node, going: Steps) -> Steps:
    """The way to somewhere or to somebody, and what is done there."""
    d.done.extend(going)  # what is done there may look at where it was gone to
    then: Steps = d.build(node.parts["then"])
    if d.done[-len(going) :] != going:
        return then
    del d.done[-len(going) :]
    return [*going, *then]


@meaning("go_places")
def go_places(d: Discourse, node: Node) -> Steps:
    """ "go to the lobby, the pharmacy and the kitchen"."""
    steps: Steps = []
    places = [d.get(node, "place"), *d.get(node, "place_list")]
    if node.production.fixed.get("from") and are_a_row(d, places):
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    if node.production.fixed.get("back"):  # "from the lobby to the kitchen and back"
        places.append(places[0])
    for place in places:
        d.went(place)
        steps.append(Call("goto", {"place": place}))
    return steps


def are_a_row(d: Discourse, places: list[Value]) -> bool:
    """Whether places are of a kind, so that those between them are meant, too: "from office 1 to
    office 4"."""
    names = {place.value for place in places if isinstance(place, Text)}
    return any(
        len(names & {each.name for each in alike}) > 1 for alike in d.lexicon.place_kinds.values()
    )


@meaning("go_point")
def go_point(d: Discourse, node: Node) -> Steps:
    arguments = {name: as_value(d.get(node, name)) for name in ("x", "y", "theta")}
    d.scene = replace(d.scene, at=None)
    return [
        Call("goto", {name: value for name, value in arguments.items() if node.parts.get(name)})
    ]


@meaning("in_place")
def in_place(d: Discourse, node: Node) -> Steps:
    """ "in the kitchen, count the cups": go there first."""
    return done_there(d, d.get(node, "spot"), node.parts["then"])


def bare_of(node: Node) -> Node:
    """A command without the part that says where or when."""
    parts = {name: part for name, part in node.parts.items() if name != SETTING}
    return replace(node, parts=parts)


@dataclass(frozen=True)
class Settings:
    """Both how often and where."""

    often: Node
    where: Node


@meaning("settings")
def settings(d: Discourse, node: Node) -> Settings:
    """ "alle zehn Minuten im Wartezimmer", between a verb and its object."""
    often, where = node.parts["often"], node.parts["where"]
    assert isinstance(often, Node)
    assert isinstance(where, Node)
    return Settings(often, where)


ANYWHERE: Final = frozenset(
    {
        *("say", "say_that", "said_with", "say_it", "phrase", "greet", "report", "ask", "listen"),
        *("gesture", "emotion", "skill", "joint_turn", "turn", "wait"),
        *("show", "touch", "scan", "set_volume", "set_language"),
    }
)
"""Commands that are done wherever the robot is; others say themselves what a place is to them."""


@meaning("done_in_place")
def done_in_place(d: Discourse, node: Node) -> Steps:
    """ "wave in the lobby", "say good night in ward b": the place is said last."""
    command, spot = node.parts["then"], node.parts["spot"]
    if not isinstance(command, Node) or command.means not in ANYWHERE:
        words = d.words(spot.start, spot.end)
        raise NotUnderstood(
            d.language.phrase("not_understood", part=words), gap=(spot.start, spot.end)
        )
    return in_place(d, node)


@meaning("setting")
def setting(d: Discourse, node: Node) -> Steps:
    """A command with a part that says where, when or how often: "say in the kitchen that lunch is
    ready"."""
    told = node.parts[SETTING]
    if isinstance(told, Node) and told.means == "in_each_of_them":
        return for_each_of_them(d, replace(node, parts={"steps": bare_of(node)}))
    where_or_when: Where | Steps | Node | Settings = d.build(told)
    bare = bare_of(node)
    if isinstance(where_or_when, Where):
        return done_there(d, where_or_when, bare)
    if isinstance(where_or_when, Node):
        return looped(d, where_or_when, lambda: d.build(bare))
    if isinstance(where_or_when, Settings):
        outer = replace(bare, parts={**bare.parts, SETTING: where_or_when.where})
        return looped(d, where_or_when.often, lambda: setting(d, outer))
    return [*where_or_when, *d.build(bare)]


@meaning("in_each_of_them")
def in_each_of_them(d: Discourse, node: Node) -> Steps:
    """Where a `setting` is, taken apart by it; of nothing else does it tell the places."""
    raise NotUnderstood(d.language.phrase("which_places"))


def done_there(d: Discourse, spot: Where, part: Leaf | Node) -> Steps:
    """Go to a spot and do something there."""
    if (
        isinstance(part, Node)
        and part.means == "report"
        and d.command.at_place is None
        and d.scene.at is None
    ):
        d.command = replace(d.command, at_place=spot.place)
        d.scene = replace(d.scene, at_furniture=spot.furniture)
        told: Steps = d.build(part)
        d.command = replace(d.command, at_place=None)
        d.scene = replace(d.scene, at_furniture=None)
        return told
    going = go(d, spot.place) if spot.place is not None else []
    d.scene = replace(d.scene, at_furniture=spot.furniture)
    inner: Steps = d.build(part)
    d.scene = replace(d.scene, at_furniture=None)
    if spot.furniture and not going and not speaks_of(inner, spot.furniture):
        raise NotUnderstood(d.language.phrase("where_is_thing", thing=spot.furniture))
    return [*going, *inner]


def speaks_of(steps: Steps, name: str) -> bool:
    """Whether some steps use a name."""
    return any(isinstance(each, Text) and name in each.value for each in nodes(steps))


@meaning("come_back")
def come_back(d: Discourse, node: Node) -> Steps:
    """Back to where the command was given; if the robot went somewhere in the one before, to where
    it was before that."""
    if d.command.origin is not None and d.scene.at is None and not d.done and not d.loops.in_loop:
        d.went(Text(d.command.origin))
        return [Call("goto", {"place": Text(d.command.origin)})]
    if counted_alone(d):
        return tell_speaker(d)
    told = d.done and (d.done[-1] is d.reports.told or d.done[-1] is d.reports.step)
    if told and d.scene.at == d.start():
        return []  # "Are there any cups in the lab? Go and look, come back and tell me."
    d.came_back()
    return [Call("goto", {"place": d.start()})]


@meaning("and_back")
def and_back(d: Discourse, node: Node) -> Steps:
    """ "take Henry to the pharmacy and back": whoever was guided there is guided back, too."""
    before = d.done or (d.around[-1] if d.around else [])  # "... and back three times"
    last = before[-1] if before else None
    if not isinstance(last, Call) or last.method in ("call", "ask", "say"):
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    if last.method == "guide":
        start = d.start()
        d.came_back()
        return [Call("guide", {**last.arguments, "place": start})]
    return come_back(d, node)


@meaning("go_person")
def go_person(d: Discourse, node: Node) -> Steps:
    person: Thing = d.get(node, "person_ref")
    if is_me(person):
        return come_back(d, node)
    going = look_for(d, where_sent(d, person))
    return there_to(d, node, going) if "then" in node.parts else going


@meaning("move")
def move(d: Discourse, node: Node) -> Steps:
    metres = float(d.get(node, "metres"))
    if node.production.fixed.get("back"):
        metres = -metres
    d.scene = replace(d.scene, at=None)
    return [Call("move", {"metres": as_value(metres)})]


@meaning("turn")
def turn(d: Discourse, node: Node) -> Steps:
    degrees = float(d.get(node, "degrees"))
    side = d.get(node, "side", "left")
    return [Call("turn", {"degrees": as_value(-degrees if side == "right" else degrees)})]


@meaning("move_aside")
def move_aside(d: Discourse, node: Node) -> Steps:
    """To one side, looking ahead as before: a robot on wheels has to turn for that."""
    metres = float(d.get(node, "metres"))
    degrees = -90.0 if d.get(node, "side") == "right" else 90.0
    d.scene = replace(d.scene, at=None)
    return [
        Call("turn", {"degrees": as_value(degrees)}),
        Call("move", {"metres": as_value(metres)}),
        Call("turn", {"degrees": as_value(-degrees)}),
    ]


@meaning("drive")
def drive(d: Discourse, node: Node) -> Steps:
    linear = float(d.get(node, "linear", 0))
    if node.production.fixed.get("back"):
        linear = -linear
    angular = float(d.get(node, "angular", 0))
    if d.get(node, "side", "left") == "right":
        angular = -angular
    seconds = as_value(d.get(node, "seconds"))
    d.scene = replace(d.scene, at=None)
    return [
        Call(
            "drive", {"linear": as_value(linear), "angular": as_value(angular), "seconds": seconds}
        )
    ]


@meaning("dock")
def dock(d: Discourse, node: Node) -> Steps:
    d.scene = replace(d.scene, at=None)
    return [Call("dock")]


@meaning("wait")
def wait(d: Discourse, node: Node) -> Steps:
    return [Call("wait", {"seconds": as_value(d.get(node, "seconds"))})]


@meaning("wait_for")
def wait_for(d: Discourse, node: Node) -> Steps:
    d.get(node, "from")  # "wait in Bob's office until he comes"
    thing = noun_of(d, node)
    times = d.language.numbers.get("units_of_time", {})
    if any(singular(each, d.language) in times for each in d.language.tokens_of(thing.text)):
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    timeout = d.get(node, "seconds")
    announced = announced_one(d, node, thing.place) if timeout is None else None
    if announced is not None:
        return announced
    steps = go(d, thing.place) if thing.place is not None else []
    if isinstance(thing.group, Items):  # "Alice or Bob"
        seen = tuple(Holds(Ask("sees", {"thing": name})) for name in thing.group.items)
        if is_either(node):
            return [*steps, *wait_until(Either(seen)), *whoever_came(d, thing.group, seen)]
        return [*steps, *wait_until(Both(seen))]
    arguments: dict[str, Value] = {"thing": sought(d, thing)}
    if timeout is not None:
        arguments["timeout"] = as_value(timeout)
    if thing.person:
        d.scene = replace(
            d.scene, person=come(d.scene.person or thing, thing), with_person=thing.value
        )
        d.people = replace(d.people, visitor=d.people.visitor if thing.known else thing)
    if thing.count is not None:
        if thing.person:  # they are all here then
            here = replace(thing, count=None, place=None, here=True)
            d.scene = replace(d.scene, person=here)
            d.reports = replace(d.reports, last_counted=here)
        return [*steps, Repeat(Number(thing.count), (Call("wait_for", arguments),))]
    return [*steps, Call("wait_for", arguments)]


def come(person: Thing, awaited: Thing) -> Thing:
    """Somebody spoken of, who was expected if it is they who were waited for."""
    if not person.first or person.value != awaited.value:
        return person
    return replace(person, first=False, place=None, here=True)


def whoever_came(d: Discourse, group: Items, seen: tuple[Condition, ...]) -> Steps:
    """Which of several has come, as far as that is asked for: "wait for Alice or Bob and take them
    to the library"."""
    who = Recall(d.variable("who"))
    came = Thing(who, known=True, person=True, here=True)
    d.people = replace(d.people, came=came)
    d.scene = replace(d.scene, person=came, with_person=who, group=None)
    *others, last = group.items
    noted = [
        If(here, (Remember(who.name, name),)) for here, name in zip(seen, others, strict=False)
    ]
    return [Remember(who.name, last), *reversed(noted)]


def is_either(node: Node) -> bool:
    """Whether a command is about one person or another: "Alice or Bob"."""
    part = node.parts.get("person_ref")
    return isinstance(part, Node) and part.means == "person_either"


@meaning("patrol")
def patrol(d: Discourse, node: Node) -> Steps:
    """ "drive back and forth between the lobby and the kitchen", "patrol the corridor": there and
    back."""
    places: list[Value] = [d.get(node, "place"), *(d.get(node, "place_list") or [d.start()])]
    d.scene = replace(d.scene, at=None)
    return [Call("goto", {"place": place}) for place in places]
