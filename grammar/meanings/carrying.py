"""Picking things up, carrying them, and putting them down or handing them over."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import ANYONE, START, Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.deliveries import Delivery, for_them, kept_in_hand, meant_for, ordered_now
from grammar.meanings.finding import go, look_for, meet, where_sent
from grammar.meanings.holders import from_whoever_has_it
from grammar.meanings.persons import is_me
from grammar.meanings.places import sought
from grammar.meanings.registry import meaning
from grammar.meanings.searches import search_of
from grammar.meanings.sources import is_called, sourced, told_where, where_told
from grammar.meanings.surveys import Survey, note
from grammar.meanings.there import seen_there
from grammar.meanings.thing_lists import off_the_list
from grammar.plan import Ask, Call, Holds, If, Items, Recall, Step, Text, Value
from grammar.tidy import nodes


def pick_up(d: Discourse, thing: Thing) -> Steps:
    """Find a thing and take it; nothing if it is in the hand by what was said."""
    if thing.person:
        raise NotUnderstood(d.language.phrase("what_is_it", word=thing.text))
    if d.scene.holding == thing.value or handed_over(d, thing):
        return []
    take_back_delivery(d, thing)
    thing = where_seen(d, thing)
    if d.scene.holding == thing.value:
        return []
    last = d.done[-1] if d.done else None
    another = thing.place is not None and not thing.pronoun
    if last == Call("put", {"thing": thing.value}) and not another:
        d.done.pop()  # "take the cup to the kitchen and give it to Alex": never put down
        return []
    if thing.pronoun and thing.value in d.scene.now_at:
        thing = replace(thing, place=d.scene.now_at[thing.value], furniture=None, here=False)
    search = search_of(last)
    looked = search is not None and search.is_for(d, thing)  # "find the cup and bring it to me"
    sought_somebody = d.scene.at == d.scene.looked_in and (
        d.scene.with_person is not None or not d.scene.thing_last
    )
    for_somebody = d.loops.at_people or sought_somebody  # "if Bob is in the lobby, bring him a cup"
    lacking = (
        d.scene.missing is not None and d.scene.missing.value == thing.value
    )  # "if there is none, ..."
    nearby = d.scene.at is not None and not (for_somebody or lacking) and thing.place is None
    # What somebody asked for is anywhere, and so is what is to be brought after coming back.
    nearby = nearby and not wished_for(d, thing) and d.scene.at != Recall(START)
    nearby = nearby and not (only_delivered(d) and thing.value not in d.scene.now_at)
    is_here = thing.here or nearby or (d.scene.at is not None and thing.place == d.scene.at)
    steps: Steps = [] if looked or is_here else look_for(d, thing)
    d.scene = replace(d.scene, holding=thing.value)
    d.scene = d.scene.speaking_of(thing)
    return [*steps, Call("grab", {"thing": sought(d, thing)})]


def only_delivered(d: Discourse) -> bool:
    """Whether the robot is where it is only because it has taken something there: "bring a blanket
    to ward a and a pillow to ward b"; the pillow may be anywhere."""
    match d.done[-2:]:
        case [Call(method="goto"), Call(method="put")]:
            return True
        case _:
            return False


def wished_for(d: Discourse, thing: Thing) -> bool:
    """Whether somebody was asked for it, or if they want it: "if she needs a chair, bring one"."""
    if isinstance(thing.value, Recall):
        return True
    question = d.answers.surveys[-1].call.arguments["question"] if d.answers.surveys else None
    words = question.value.lower() if isinstance(question, Text) else ""
    return bool(thing.text) and f" {thing.text.lower()}" in words


def where_seen(d: Discourse, thing: Thing) -> Thing:
    """A thing at the place that was only looked at for it: "see whether there is a cup in the
    kitchen and bring it to me"."""
    about = d.reports.last.thing if d.reports.last is not None else None
    if not thing.pronoun or about is None or about.value != thing.value:
        return thing
    return thing if seen_there(d) is None else replace(thing, place=about.place, pronoun=False)


def handed_over(d: Discourse, thing: Thing) -> bool:
    """Whether somebody was asked for a thing that now goes elsewhere: the robot then takes it right
    behind the question."""
    survey: Survey | None = d.answers.surveys[-1] if d.answers.surveys else None
    if d.answers.asked_for is None or thing.value != d.answers.asked_for or survey is None:
        return False
    note(d, survey.call, [Call("grab", {"thing": thing.value})], [])
    d.answers = replace(d.answers, asked_for=None)
    d.scene = replace(d.scene, holding=thing.value)
    d.scene = d.scene.speaking_of(thing)
    return True


def take_back_delivery(d: Discourse, thing: Thing) -> None:
    """ "get the cup and put it on the table": "get" alone would have handed it to the speaker."""
    brought = list(d.deliveries.brought)
    if brought and d.done[-len(brought) :] == brought and _is_given(brought[-1], thing):
        # "if she needs the cup, get it from the kitchen and bring it to Bob": to him only
        del d.done[-len(brought) :]
        d.deliveries = replace(d.deliveries, brought=())
        d.scene = replace(d.scene, holding=thing.value, at=thing.place)
        return
    if d.scene.delivered != thing.value:
        return
    handed = Call("give", {"thing": thing.value})
    for steps in (d.done, *d.around[-1:]):  # before a "when", too
        at = max((at for at, step in enumerate(steps) if step == handed), default=0)
        if not at:
            continue
        last = steps is d.done and at == len(steps) - 1
        del steps[at - 1 : at + 1]
        d.scene = replace(d.scene, delivered=None, holding=thing.value)
        if last:  # but "get the box, then go to Henry and give it to him": he is where it is now
            d.scene = replace(d.scene, at=d.scene.at_pick_up)
        return


def the_same(d: Discourse, node: Node, thing: Thing) -> Thing:
    """ "get the key and wait for Bob; when he comes, give him the key": the one spoken of."""
    part = node.parts.get("thing")
    definite = isinstance(part, Node) and d.tokens[part.start].norm in d.language.speech.get(
        "definite", ()
    )
    if (
        definite
        and d.deliveries.shown is not None
        and d.deliveries.shown == d.scene.holding
        and is_kind_of(d.deliveries.shown, thing)
    ):
        return replace(
            thing, value=d.deliveries.shown, place=None, pronoun=True
        )  # "the signed form"
    if not definite or thing.value != d.scene.delivered or thing.place is not None or thing.several:
        return thing
    return replace(thing, pronoun=True)


def is_kind_of(value: Value, thing: Thing) -> bool:
    """Whether a thing is called by the noun of another: "the signed form", of a form."""
    return isinstance(value, Text) and bool(thing.noun) and value.value.split()[-1] == thing.noun


def _is_given(step: Step, thing: Thing) -> bool:
    return isinstance(step, Call) and step.arguments.get("thing") == thing.value


def deliver(d: Discourse, thing: Thing, person: Thing | None, spot: Where | None) -> Steps:
    """Pick a thing up, go where it is to be, and put it down or hand it over."""
    thing = off_the_list(d, thing)
    take_along_again(d, thing, person)
    need = ordered_now(d, thing, person)
    if need is not None:
        thing = replace(need.thing if thing.pronoun else thing, place=thing.place, pronoun=False)
        person, spot = for_them(need, spot) if person is None else (person, spot)
    scene = d.scene
    if from_whoever_has_it(d, thing, lambda: _delivered(d, thing, person, spot)):
        return []
    thing = where_told(d, thing)
    told = told_where_it_is(d, thing)
    if told is not None:
        return [carried_from_there(d, told, thing, lambda: _delivered(d, thing, person, spot))]
    steps = _delivered(d, thing, person, spot)
    d.deliveries = replace(d.deliveries, last=Delivery(thing, person, spot, tuple(steps), scene))
    return steps


def take_along_again(d: Discourse, thing: Thing, person: Thing | None) -> None:
    """ "take the form to Clara, ask her to sign it and bring it back": what somebody is to have for
    a moment only stays in the hand, and is taken along when they say that they are done."""
    delivery: Delivery | None = d.deliveries.last
    receiver = None if delivery is None else delivery.receiver
    if delivery is None or receiver is None or delivery.spot is not None or delivery.needed:
        return
    if not thing.pronoun or thing.value != delivery.thing.value:
        return
    if person is not None and person.value == receiver.value and not is_me(person):
        return
    if kept_in_hand(d, asking=False) is None:
        return
    since = [each for each in nodes(tuple(d.done)) if isinstance(each, Call)]
    if since[-1].method not in ("ask", "wait"):
        d.done.append(Call("ask", {"question": d.sentence("done_with_it")}))


def told_where_it_is(d: Discourse, thing: Thing) -> If | None:
    """The last step, if it looks for a thing, comes back and tells where it is."""
    match d.done[-1] if d.done else None:
        case If(condition=Holds(value=Ask(method="find", arguments=sought))) as told:
            same = thing.pronoun and sought.get("thing") == thing.value
            return told if same and _way_back(told) is not None else None
        case _:
            return None


def _way_back(told: If) -> int | None:
    """Where among the steps the robot leaves what it has found."""
    back = Call("goto", {"place": Recall(START)})
    return next((at for at, step in enumerate(told.then) if step == back), None)


def carried_from_there(d: Discourse, told: If, thing: Thing, make: Callable[[], Steps]) -> If:
    """ "tell me where the stapler is and bring it to me": it is taken where it is found."""
    d.done.pop()
    d.scene = replace(d.scene, holding=thing.value)
    d.went(d.start())
    at = _way_back(told)
    taking = Call("grab", {"thing": thing.value})
    return If(told.condition, (*told.then[:at], taking, *told.then[at:], *make()), told.otherwise)


def _delivered(d: Discourse, thing: Thing, person: Thing | None, spot: Where | None) -> Steps:
    before = d.scene.at
    if spot is not None and spot.place is None and thing.place not in (None, before):
        spot = replace(spot, place=before)  # "on the table" is where the robot was sent
    if person is not None:
        fetch_before_waiting(d, thing, person)
    named = thing.place is None and not thing.pronoun
    if spot is not None and spot.place is not None and spot.place == d.scene.at and named:
        d.scene = replace(
            d.scene, at=None
        )  # "go to the lab and bring the microscope there": it is elsewhere
    no_way = spot is not None and spot.place is None and thing.place is None
    if no_way and d.scene.holding != thing.value and not thing.pronoun:
        steps: Steps = [Call("grab", {"thing": sought(d, thing)})]  # both are here
    else:
        steps = pick_up(d, thing)
    d.scene = replace(d.scene, holding=None)
    d.scene = d.scene.speaking_of(thing)
    give: dict[str, Value] = {"thing": thing.value}
    if spot is not None:
        if spot.place is not None:
            steps += go(d, spot.place)
        if spot.furniture:
            give["where"] = Text(spot.furniture)
        if d.scene.at is not None and not d.loops.in_loop:
            d.scene = replace(d.scene, now_at={**d.scene.now_at, thing.value: d.scene.at})
        return [*steps, Call("put", give)]
    if person is None or is_me(person):
        start = d.start()
        if steps or d.scene.at != start:
            steps.append(Call("goto", {"place": start}))
        d.scene = replace(d.scene, at_pick_up=d.scene.at)
        d.went(start)
        d.scene = replace(d.scene, delivered=thing.value)
        return [*steps, Call("give", give)]
    left = any(isinstance(step, Call) and step.method in ("find", "goto") for step in steps)
    if left and person.here and not person.known:  # back to where they are
        place = before or d.start()
        d.went(place)
        steps.append(Call("goto", {"place": place}))
    elif left or not person.here:
        person = where_sent(d, person) if not steps else person
        steps += meet(d, replace(person, here=False)) or look_for(d, person)
    d.scene = d.scene.speaking_of(thing)
    if person.text != ANYONE:
        give["person"] = person.value
    return [*steps, Call("give", give)]


def fetch_before_waiting(d: Discourse, thing: Thing, person: Thing) -> None:
    """ "wait in the lobby for Bob and give him the folder": nobody who has come is left alone for
    it, so that it is fetched first."""
    here = d.scene.at
    at = len(d.done)
    while at and is_waiting(d.done[at - 1]):
        at -= 1
    waiting = d.done[at:]
    awaited = (
        isinstance(waiting[-1], Call) and waiting[-1].arguments.get("thing") if waiting else None
    )
    elsewhere = isinstance(thing.place, Text | Items) and thing.place != here
    if (
        awaited is None
        or awaited != person.value
        or not elsewhere
        or thing.value == d.scene.holding
    ):
        return
    del d.done[at:]
    d.scene = replace(d.scene, at=None)
    d.done.extend(pick_up(d, thing))
    if not any(isinstance(each, Call) and each.method == "goto" for each in waiting):
        d.done.append(Call("goto", {"place": d.start() if here is None else here}))
    d.done.extend(waiting)
    d.scene = replace(d.scene, at=here, with_person=person.value)


def is_waiting(step: Step) -> bool:
    """Whether a step goes somewhere or waits there for somebody."""
    return isinstance(step, Call) and step.method in ("goto", "wait_for")


@meaning("can_get")
def can_get(d: Discourse, node: Node) -> Steps:
    """ "you can take them from the lounge": no more than where they are, unless nothing else has
    been said of them."""
    spot: Where = d.get(node, "from")
    again = sourced(d, node)
    if again is not None:
        return again
    thing: Thing = d.get(node, "thing")
    before = d.deliveries.last
    there = replace(thing, place=spot.place, furniture=spot.furniture, pronoun=False)
    told_where(d, there)
    d.scene = d.scene.speaking_of(there)
    fetched = before is not None and is_called(d, there, before.thing.value)
    return [] if fetched or not thing.pronoun else deliver(d, there, *meant_for(d, there))
