"""Doing things more than once: so many times, until, at every place, for everybody."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, Meeting, Steps, Thing, as_value
from grammar.errors import NotUnderstood
from grammar.meanings.asking_until import until_answered
from grammar.meanings.claims import meet_there
from grammar.meanings.conditions import FULL_HOUR, condition_of, negated
from grammar.meanings.deliveries import first_clause
from grammar.meanings.finding import go, look_for, not_found, noun_of
from grammar.meanings.going_on import about_places, brought_behind, in_round, told_last
from grammar.meanings.guards import guard_finds
from grammar.meanings.news import BACK
from grammar.meanings.place_loops import end_of_stop, goes_to_name, of_those, same_round
from grammar.meanings.places import kind_places
from grammar.meanings.registry import meaning
from grammar.meanings.round_ends import goes_round, is_sight, round_until, seeks
from grammar.meanings.several_places import until_found
from grammar.meanings.surveys import moved
from grammar.meanings.waiting import (
    A_MINUTE,
    WITH_ONE,
    at_least,
    awaited,
    for_so_long,
    looked_for_at_pace,
    looking_up,
    there_first,
    told_with,
    wait_until,
)
from grammar.meanings.whereabouts import looked_on_in
from grammar.pieces import leaves
from grammar.plan import (
    Ask,
    Call,
    Compare,
    Condition,
    End,
    ForEach,
    Forever,
    Holds,
    If,
    Items,
    Not,
    Number,
    Recall,
    Remember,
    Repeat,
    Step,
    Text,
    Truth,
    Value,
    While,
)
from grammar.planning.by_the_clock import SHOWN, outside_of
from grammar.tidy import in_each_round, mentions, nodes

HOLDS: Final = frozenset({"goto", "dock", "show", "emotion", "wait"})
"""Methods after which something goes on by itself: "stay in the lobby until noon"."""


def stays(body: Steps) -> bool:
    """Whether some steps only bring about what then goes on by itself."""
    held = [step for step in body if not (isinstance(step, Call) and step.method == "wait")]
    return len(held) < 2 and all(
        isinstance(step, Call) and step.method in HOLDS and step.save_as is None for step in body
    )


def held(body: Steps) -> Steps:
    """Such steps without the moments that "stay" and "wait" mean where no time is said."""
    return [step for step in body if not (isinstance(step, Call) and step.method == "wait")]


@meaning("until")
def until(d: Discourse, node: Node) -> Steps:
    if node.production.fixed.get("first", False):
        looking, condition = condition_of(d, node)
        body = d.build(node.parts["steps"])
    else:
        body = d.build(node.parts["steps"])
        looking, condition = condition_of(d, node)
    return done_until(d, body, looking, condition)


def done_until(d: Discourse, body: Steps, looking: Steps, condition: Condition) -> Steps:
    """Steps again and again until something is so; what goes on by itself only until then."""
    condition, body = at_least(condition), one_round(body)
    if body == wait_until(condition):  # "wait for me until I am back"
        return [*looking, *body]
    if len(body) == 1 and seeks(body[0], condition):  # "look in every office until you find it"
        return [*looking, *body]
    if body and goes_round(body[-1]) and is_sight(condition):
        return [*body[:-1], *round_until(body[-1], looking, condition)]
    if _only_seeks(body, condition):  # "keep looking for Noah until you find him"
        return [*looking, *wait_until(condition)]
    led = led_there(body, condition)
    if led is not None:
        return led
    if stays(body):
        return [*held(body), *awaited(looking, condition)]
    if d.answers.counting is None:
        body = looking_up(body)
    return there_first(until_answered(d, condition, [*body, *looking]))


def _only_seeks(body: Steps, condition: Condition) -> bool:
    """Whether a round is nothing but the search that is to succeed."""
    sought_for = condition.value if isinstance(condition, Holds) else None
    if not isinstance(sought_for, Ask) or sought_for.method not in ("find", "sees") or not body:
        return False
    called = [each for each in nodes(tuple(body)) if isinstance(each, Call | Ask)]
    found = [each for each in called if each.method == "find"]
    thing = sought_for.arguments["thing"]
    return bool(found) and all(
        each.method == "say" or each.arguments.get("thing") == thing for each in called
    )


def led_there(body: Steps, condition: Condition) -> Steps | None:
    """ "keep following her until she is in the lobby": as far as there."""
    last = body[-1] if body else None
    if not isinstance(last, Call) or last.method != "follow":
        return None
    if not isinstance(condition, Holds) or not isinstance(condition.value, Ask):
        return None
    sought_for = condition.value.arguments
    if sought_for.get("thing") != last.arguments["person"] or "place" not in sought_for:
        return None
    return [*body[:-1], Call("follow", {**last.arguments, "to": sought_for["place"]})]


# --- repeating


@meaning("repeat")
def repeat(d: Discourse, node: Node) -> Steps:
    return so_often(d, node.parts["times"], lambda: one_round(d.build(node.parts["steps"])))


def from_there(d: Discourse, body: Steps) -> Steps:
    """A round that only leads somewhere, with what was done since the robot was there before: "go
    to the pharmacy and come back three times" is there and back each time, for who is there already
    need not go. What is taken along is taken out of the sequence."""
    if len(body) != 1 or not isinstance(body[0], Call) or body[0].method not in ("goto", "dock"):
        return body
    there = max((at + 1 for at, step in enumerate(d.done) if step == body[0]), default=0)
    ends = [*d.begins[1:], len(d.done)]
    left = (
        begin
        for begin, end in zip(d.begins, ends, strict=True)
        if begin >= there and moved(d.done[begin:end])
    )
    first = next(left, len(d.done))
    way = d.done[first:]
    del d.done[first:]
    d.begins[:] = [begin for begin in d.begins if begin <= first]
    return one_round(guard_finds(d, [*way, *body]))


def so_often(d: Discourse, times: Leaf | Node, make: Callable[[], Steps]) -> Steps:
    """Steps a number of times; told by the people they are for, each time with the next of them:
    "until you have greeted five people"."""
    number = as_value(d.build(times))
    people = isinstance(times, Node) and times.production.fixed.get("people", False)
    if not people:
        return [Repeat(number, tuple(from_there(d, make())))]
    assert isinstance(times, Node)
    body = each_who_comes(d, make)
    if stays(body):  # "stay in the lobby until five visitors have come"
        who = Thing(as_value(d.get(times, "kind", ANYONE)), person=True, plural=True, here=True)
        d.scene = replace(d.scene, person=who)
        d.reports = replace(d.reports, last_counted=who)
        return [*held(body), Repeat(number, (Call("wait_for", {"thing": who.value}),))]
    return there_first([Repeat(number, tuple(body))])


@meaning("loop")
def loop(d: Discourse, node: Node) -> Steps:
    """Steps and how often they are done: "every ten minutes until five", "three times"."""
    part = node.parts["steps"]
    if "loop" in node.parts:
        behind = node.parts["loop"]
        paced = isinstance(behind, Node) and "pause" in behind.parts
        told = told_with(part, behind) if paced else None
        if told is not None:
            whole: Steps = d.build(told)
            return whole
        often: Node = d.get(node, "loop")
    else:  # "go there every hour and ..."
        assert isinstance(part, Node)
        often = d.get(part, "pace")
    ending: Node | None = d.get(node, "ending")
    if ending is not None:  # "every ten minutes ..., until five": that is no end of one round
        often = replace(often, parts={**often.parts, **ending.parts})
    return looped(d, often, lambda: d.build(part), told_when=_has(part, "tell_when"))


def _has(part: Leaf | Node, means: str) -> bool:
    """Whether a clause of this meaning is in it."""
    if isinstance(part, Leaf):
        return False
    return part.production.means == means or any(_has(each, means) for each in part.parts.values())


@meaning("watched")
def watched(d: Discourse, node: Node) -> Steps:
    """ "keep an eye on the box and tell me if it disappears": there, where it is."""
    place: Value | None = d.get(node, "place")
    if place is not None:
        going = go(d, place)
        d.scene = replace(d.scene, looked_in=place)
        d.people = replace(d.people, on_duty="guard")
        return [*going, *d.build(node.parts["steps"])]
    thing = noun_of(d, node)
    going = []
    if thing.place is not None:
        going = go(d, thing.place)
    elif thing.known and thing.person:
        going = look_for(d, thing)
    d.branch = replace(d.branch, met=None)
    meet_there(d, Meeting(replace(thing, place=None)))
    return [*going, *d.build(node.parts["steps"])]


@meaning("between_times")
def between_times(d: Discourse, node: Node) -> Steps:
    """ "between two and four, greet the visitors"."""
    first, last = (str(d.get(node, each)) for each in ("first", "last"))
    begins, ends = (Compare(SHOWN, ">=", Text(each)) for each in (first, last))
    body = each_who_comes(d, lambda: one_round(d.build(node.parts["steps"])))
    waiting = If(outside_of(first, last), tuple(wait_until(begins)))
    return [waiting, *done_until(d, body, [], ends)]


@meaning("how_often")
def how_often(d: Discourse, node: Node) -> Node:
    """At what intervals, and how many times or until when: what it means depends on what is done,
    and so is made out with that (`looped`)."""
    return node


def looped(
    d: Discourse, often: Node, build: Callable[[], Steps], *, told_when: bool = False
) -> Steps:
    """The steps, as often as that, with the pause that it names. `told_when`: what they wait for,
    to be told of it, is looked for at that pace."""

    def make() -> Steps:
        return one_round(build())

    if "while_condition" in often.parts:
        looking, condition = condition_of(d, often, "while_condition")
        meet_there(d, d.branch.met)
        body = each_who_comes(d, make, at_once="pause" in often.parts)
        return [*looking, While(condition, (*_paced(d, often, body), *looking))]
    if "condition" in often.parts:
        body = each_who_comes(d, make, at_once="pause" in often.parts)
        looking, condition = condition_of(d, often)
        return done_until(d, _paced(d, often, body), looking, condition)
    if "times" in often.parts:
        return so_often(d, often.parts["times"], lambda: _paced(d, often, make()))
    if "lasting" in often.parts:
        return _lasting(d, often, make)
    body = each_who_comes(d, make, at_once="pause" in often.parts)
    if told_when and "pause" in often.parts:
        for at, step in enumerate(body):
            awaited_here = _awaited(step)
            if awaited_here is not None:
                pause = Call("wait", {"seconds": as_value(d.get(often, "pause"))})
                return [*looked_for_at_pace(body[:at], awaited_here, pause), *body[at + 1 :]]
    return there_first([Forever(tuple(_paced(d, often, body)))])


def _awaited(step: Step) -> Condition | None:
    """What a step waits for that does nothing else."""
    if isinstance(step, Call) and step.method == "wait_for":
        return Holds(Ask("sees", {"thing": step.arguments["thing"]}))
    if isinstance(step, While) and all(
        isinstance(each, Call) and each.method == "wait" for each in step.steps
    ):
        return negated(step.condition)
    return None


def one_round(body: Steps) -> Steps:
    """The steps of one round, where they alone would go on without end: "greet everybody who comes
    in until five"."""
    steps: Steps = []
    for step in body:
        last = steps[-1] if steps else None
        if isinstance(last, Forever):  # what follows it belongs to each of its rounds
            steps[-1] = in_each_round(last, step)
        else:
            steps.append(step)
    last = steps[-1] if steps else None
    return [*steps[:-1], *last.steps] if isinstance(last, Forever) else steps


def _paced(d: Discourse, often: Node, body: Steps) -> Steps:
    """A round, with the pause behind it; at the full hour, with the wait for it before it."""
    if "hourly" in often.parts:
        body = from_there(d, body)
        return [*wait_until(FULL_HOUR), *body, Call("wait", {"seconds": Number(A_MINUTE)})]
    pause = d.get(often, "pause")
    if pause is None:
        return body
    return [*from_there(d, body), Call("wait", {"seconds": as_value(pause)})]


def _lasting(d: Discourse, often: Node, make: Callable[[], Steps]) -> Steps:
    """For some time: as many rounds as there are pauses in it, else as many as there is time
    for."""
    lasting = float(d.get(often, "lasting"))
    pause = A_MINUTE * 60 if "hourly" in often.parts else d.get(often, "pause")
    body = each_who_comes(d, make, at_once=pause is not None)
    if pause is not None:
        rounds = Number(max(1, round(lasting / float(pause))))
        return [Repeat(rounds, tuple(_paced(d, often, body)))]
    if stays(body):
        return [*held(body), Call("wait", {"seconds": as_value(lasting)})]
    if lasting < A_MINUTE:
        part = often.parts["lasting"]
        words = d.words(part.start, part.end)
        raise NotUnderstood(
            d.language.phrase("cannot_time", time=words), gap=(part.start, part.end)
        )
    return for_so_long(d, lasting, body)


def each_who_comes(d: Discourse, make: Callable[[], Steps], at_once: bool = False) -> Steps:
    """A round of "keep greeting visitors": it begins when one comes; but for those who are said to
    be somewhere, where each round has its time (`at_once`)."""
    before = d.scene.person
    body = make()
    person = d.scene.person
    if person is None or person is before or person.known or person.me or person.group is not None:
        return body
    only = body[0] if len(body) == 1 else None
    if isinstance(only, If) and only.condition == Holds(Ask("find", {"thing": person.value})):
        body = list(only.then)  # not one after the other, all over the house
    going: Steps = []
    if (
        not at_once
        and person.place is not None
        and body[0] == Call("goto", {"place": person.place})
    ):
        going, body = body[:1], body[1:]  # "greet the people in the lobby"
    if at_once and not person.plural and person.text != ANYONE:
        return body  # "ask the visitor every half hour": the same one
    once = [step for step in body if isinstance(step, Call) and step.method in WITH_ONE]
    if not once or len(once) != len(body):
        return [*going, *body]
    return [*going, Call("wait_for", {"thing": person.value}), *body]


@meaning("forever")
def forever(d: Discourse, node: Node) -> Steps:
    body = each_who_comes(d, lambda: one_round(d.build(node.parts["steps"])))
    return there_first([Forever(tuple(body))])


# --- for each


@meaning("for_each_place")
def for_each_place(d: Discourse, node: Node) -> Steps:
    """ "for every office, go there and ...", "in all wards, ..." ("in" means going there)."""
    kind = d.get(node, "kinds")
    if d.get(node, "same", kind) != kind:  # "from office to kitchen"
        raise NotUnderstood(d.language.phrase("which_places"))
    listed: list[Value] | None = d.get(node, "place_list")
    items: Value = (
        Items((d.get(node, "place"), *listed)) if listed else of_those(d, kind_places(d, kind))
    )
    goes, body = bool(node.production.fixed.get("go")), node.parts.get("steps")
    if goes and body is None and same_round(d, items):
        return []
    if goes and body is None and (looked := looked_on_in(d, items)) is not None:
        return looked  # "if he is not in his office, look in the labs"
    if goes and isinstance(body, Node) and (comes_back(body) or goes_on_to(body)):
        d.done += each_place(d, items, None, goes)
        told = told_on_return(body)
        after: Steps = in_round(d, told) if told is not None else d.build(body)
        return after
    told_at_last = told_last(body) if goes and isinstance(body, Node) else None
    if told_at_last is not None:
        kept, telling = told_at_last
        d.done += each_place(d, items, kept, goes)
        behind: Steps = in_round(d, telling)
        return behind
    return each_place(d, items, body, goes)


def comes_back(body: Node) -> bool:
    """ "visit the labs and come back and ...": what is done when all have been visited."""
    first = first_clause(body)
    return first.means == "come_back" or "back" in first.parts


def goes_on_to(body: Node) -> bool:
    """ "go to every ward, then to the pharmacy": nothing is done at any of them, and what is done
    elsewhere is done once."""
    first = first_clause(body)
    return first.means == "go" and any(leaf.slot == "place" for leaf in leaves(first))


def told_on_return(body: Node) -> Node | None:
    """What is to be told of the places that were visited, if there is nothing else to do: "visit
    the labs and come back and tell me if you see a dog"."""
    back, told = body.parts.get("first"), body.parts.get("rest")
    if not (isinstance(back, Node) and first_clause(back).means == "come_back"):
        return None
    if not isinstance(told, Node) or "rest" in told.parts:
        return None
    return told if about_places(first_clause(told)) else None


def each_place(d: Discourse, items: Value, steps: Leaf | Node | None, goes: bool) -> Steps:
    """Do some steps for each of the places; there, if that is how it was said."""
    variable = d.variable("place")
    here = Recall(variable)
    going = Call("goto", {"place": here})
    before = d.scene.at
    d.scene = replace(d.scene, place=here, at=here if goes else None)
    body: Steps = []
    if steps is not None:
        outer = d.loops
        d.loops = replace(d.loops, in_loop=True, stop=here)
        body = d.build(steps)
        d.loops = replace(d.loops, in_loop=outer.in_loop, stop=outer.stop)
    first = body[0] if body else None
    moves = isinstance(first, Call) and first.method in ("goto", "guide", "find")
    search = until_found(d, here, items, body)
    if search:  # "look for it in all wards": until it is found
        d.scene = d.scene.wandered()
        return search
    if not moves and (goes or not mentions(body, here)):
        body = [going, *body]
    d.scene = replace(d.scene, at=None if body else before, with_person=None)
    end = end_of_stop(body, here) if goes else len(body)
    return [*brought_behind(d, ForEach(variable, items, tuple(body[:end]))), *body[end:]]


@meaning("for_each_of_them")
def for_each_of_them(d: Discourse, node: Node) -> Steps:
    """ "go to the lobby and to ward 3, and in each of them ...": done at all these."""
    stops = toured(d)
    if stops:
        return at_each_stop(d, stops, node.parts["steps"])
    going: list[Call] = []
    while d.done and goes_to_name(d.done[-1]):
        last = d.done.pop()
        assert isinstance(last, Call)
        going.insert(0, last)
    if len(going) < 2:
        d.done.extend(going)
        if d.loops.in_loop and d.scene.at is not None and d.scene.at == d.scene.place:
            inside: Steps = d.build(node.parts["steps"])  # "visit the labs and ... in each"
            return inside
        raise NotUnderstood(d.language.phrase("which_places"))
    places = Items(tuple(call.arguments["place"] for call in going))
    return each_place(d, places, node.parts["steps"], goes=True)


def toured(d: Discourse) -> list[Call]:
    """The last steps that lead one person from place to place, if there are several."""
    stops: list[Call] = []
    for step in reversed(d.done):
        if not isinstance(step, Call) or step.method != "guide":
            break
        if stops and step.arguments["person"] != stops[0].arguments["person"]:
            break
        stops.insert(0, step)
    return stops if len(stops) > 1 else []


def at_each_stop(d: Discourse, stops: list[Call], steps: Leaf | Node) -> Steps:
    """ "show her the library and the lounge. At each stop say ...": with her there."""
    del d.done[-len(stops) :]
    here = Recall(d.variable("place"))
    last = d.scene.place
    d.scene = d.scene.arrived(here)
    outer = d.loops.in_loop
    d.loops = replace(d.loops, in_loop=True)
    body = d.build(steps)
    d.loops = replace(d.loops, in_loop=outer)
    d.scene = d.scene.arrived(last)
    leading = Call("guide", {**stops[0].arguments, "place": here})
    places = Items(tuple(each.arguments["place"] for each in stops))
    return [ForEach(here.name, places, (leading, *body))]


@meaning("check_each_place")
def check_each_place(d: Discourse, node: Node) -> Steps:
    """ "check every ward for visitors and tell them ...": go there, and if one is seen, do it."""
    sought_for: Thing | list[Thing] = d.get(node, "person_ref") or d.get(node, "thing")
    if isinstance(sought_for, list):  # "check every ward for Alice or Bob"
        raise NotUnderstood(d.language.phrase("one_person"))
    variable = d.variable("place")
    d.scene = d.scene.arrived(Recall(variable))
    if sought_for.person:
        d.scene = replace(
            d.scene, person=replace(sought_for, here=True), with_person=sought_for.value
        )
    outer = d.loops.in_loop
    d.loops = replace(d.loops, in_loop=True)
    body = d.build(node.parts["steps"])
    d.loops = replace(d.loops, in_loop=outer)
    d.scene = d.scene.wandered()
    seen_there = Holds(Ask("sees", {"thing": sought_for.value}))
    match body:
        case [*before, If(condition=same, then=then, otherwise=())] if same == seen_there:
            body = [*before, *then]  # "..., and stop as soon as you see it"
    only_one = sought_for.known or Call("grab", {"thing": sought_for.value}) in body
    until = bool(node.production.fixed.get("until"))
    found = Recall(d.variable("found"))
    if until:
        body = [Remember(found.name, Truth(True)), *body]
    if (only_one or until) and body[-1:] != [End()]:
        body = [*body, End()]  # there is no other one to be looked for
    seen = If(seen_there, tuple(body))
    going = Call("goto", {"place": Recall(variable)})
    loop = ForEach(variable, kind_places(d, d.get(node, "kinds")), (going, seen))
    if not until:
        return [loop]
    back = [step for step in body if step == BACK]
    missing = If(Not(Holds(found)), (*back, not_found(d, sought_for)))
    return [Remember(found.name, Truth(False)), loop, missing]


@meaning("for_each_person")
def for_each_person(d: Discourse, node: Node) -> Steps:
    """ "for each of the next three visitors, ...", "for every patient in ward a, ..." """
    times = d.get(node, "times")
    person: Thing | None = d.get(node, "person_ref")
    if times is None and person is not None and person.place is not None:
        going, one = go(d, person.place), Recall(d.variable("person"))
        d.scene = replace(
            d.scene,
            person=replace(person, value=one, known=True, here=True, place=None),
            with_person=one,
        )
        body = d.build(node.parts["steps"])
        d.scene = replace(d.scene, person=None, with_person=None)
        return [*going, ForEach(one.name, Ask("people"), tuple(body))]
    who = person.value if person is not None else Text(ANYONE)
    d.scene = replace(d.scene, person=Thing(who, person=True, here=True))
    wait = Call("wait_for", {"thing": who})
    going = go(d, person.place) if person is not None and person.place is not None else []
    body = d.build(node.parts["steps"])
    if times is None:
        return [*going, Forever((wait, *body))]
    return [*going, Repeat(as_value(times), (wait, *body))]
