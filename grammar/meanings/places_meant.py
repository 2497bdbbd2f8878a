"""Places that are meant without being named: "there", "here", "his office", "the other one". Which
they are comes from what was said and done before."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import START, Discourse, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.found_places import first_of_round
from grammar.meanings.hosts import place_just_named
from grammar.meanings.places import (
    is_of,
    own_place,
    owner_of,
    place_called_after,
    source_of,
    unknown_place,
)
from grammar.meanings.registry import meaning
from grammar.plan import Call, Compare, If, Items, Recall, Remember, Text, Value


@meaning("place_of_kind")
def place_of_kind(d: Discourse, node: Node) -> Value:
    """ "the office": the only one there is, else the question which."""
    kind = d.get(node, "kind")
    places = d.lexicon.place_kinds[kind]
    if isinstance(d.scene.place, Text) and any(each.name == d.scene.place.value for each in places):
        return d.scene.place  # "go to the bathroom and count the people in the room"
    own = (
        own_place(d, d.scene.person)
        if d.scene.person is not None and d.scene.person.known
        else None
    )
    named = [each for each in d.lexicon.people if each.name.lower() in d.text.lower()]
    if own is not None and len(named) == 1 and any(each.name == own.value for each in places):
        return own  # "if Clara is not in the office": in hers, where she alone was spoken of
    if len(places) > 1:
        answered = place_just_named(d, kind)
        if answered is not None:  # "ask whom he wants to visit and lead him to the office"
            d.scene = replace(d.scene, place=answered)
            return answered
        raise d.which(node.start, node.end, tuple(place.name for place in places))
    place = Text(places[0].name)
    d.scene = replace(d.scene, place=place)
    return place


@meaning("place_own")
def place_own(d: Discourse, node: Node) -> Value:
    """ "his office", after Bob: Bob's office; of nobody by name, the only office there is."""
    kind = d.get(node, "kind")
    said: Thing | None = d.get(node, "owner")
    who = said or d.scene.person or d.one_called(node.start, node.end)
    another = who is not None and not said and not d.may_be(who, node.start, node.end)
    if who is not None and ((not who.known and who.group is None) or another):
        # a visitor has none; and Bob is no "her"
        who = d.one_called(node.start, node.end) or who
    if who is None and (host := owner_of(d)) is not None:
        who = Thing(host, known=True, person=True)
    if who is not None and isinstance(who.group, Items):  # for each of them anew
        who = replace(who, value=who.group.items[-1])
    named = place_just_named(d, kind) if who is None or not who.known else None
    if named is not None:  # "ask her whom she wants to see, and take her to their office"
        d.scene = replace(d.scene, place=named)
        return named
    owner = who.text if who is not None and who.known else None
    if kind is None:  # "her room", whatever it is called here
        if who is None or not who.known:
            raise unknown_place(d, d.words(node.start, node.end), node)
        return place_called_after(d, who.text, node)
    places = d.lexicon.place_kinds[kind]
    own = [each for each in places if owner and is_of(d, each.name, owner)]
    if owner and not own:
        words = d.words(node.start, node.end)
        raise NotUnderstood(
            d.language.phrase("unknown_place", name=f"{words} ({owner})"),
            tuple(each.name for each in places[:3]),
            (node.start, node.end),
        )
    if len(own or places) > 1:
        raise d.which(node.start, node.end, tuple(each.name for each in own or places))
    place = Text((own or places)[0].name)
    d.scene = replace(d.scene, place=place)
    return place


@meaning("place_there")
def place_there(d: Discourse, node: Node) -> Value:
    named = place_just_named(d)
    if named is not None:
        d.scene = replace(d.scene, place=named)
        return named
    if (
        d.people.host is not None and not d.done
    ):  # "he has an appointment with Clara. Take him there"
        if (theirs := own_place(d, d.people.host)) is None:
            raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))
        return theirs
    unsaid = d.scene.place in (None, Recall(START))
    if unsaid and (d.round.such is not None or first_of_round(d)):
        return Recall(str(d.round.such))  # "find an empty room, come back, and take them there"
    if d.scene.place is None:
        raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))
    there = d.scene.place
    if (
        d.command.place_before is not None
        and d.deliveries.taken_from is None
        and taken_elsewhere(d, node)
    ):
        there = d.command.place_before
    if d.scene.delivered is not None and there == Recall(START):
        there = before_fetching(d, node)
    d.scene = replace(d.scene, place=there)
    return there


def taken_elsewhere(d: Discourse, node: Node) -> bool:
    """ "take the visitor from the lobby there": whether the place that was named last is where the
    command itself takes somebody or something from, so that it is not meant by "there"."""
    end = node.end - 1 if d.tokens[node.end - 1].kind == "word" else node.end - 2
    words = " ".join(d.norms(max(end - 6, 0), end))
    called = d.scene.place.value.lower() if isinstance(d.scene.place, Text) else None
    return bool(called) and d.scene.place != d.command.place_before and words.endswith(str(called))


@meaning("place_answered")
def place_answered(d: Discourse, node: Node) -> Value:
    """ "the place they chose": what was answered last, if that was where somebody wants to go."""
    if d.answers.last is None or d.scene.place != Recall(d.answers.last):
        raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))
    return d.scene.place


def before_fetching(d: Discourse, node: Node) -> Value:
    """ "If there is none in the lab, get one from the store and bring it there": to where it was
    looked for in vain, or where the robot was sent, not to whoever speaks."""
    if d.scene.missing is not None and d.scene.missing.place is not None:
        return d.scene.missing.place
    sent = [
        step.arguments["place"]
        for step in d.done
        if isinstance(step, Call) and step.method == "goto" and "place" in step.arguments
    ]
    places = [place for place in sent if place not in (d.scene.at_pick_up, Recall(START))]
    if (
        not places and d.loops.stop is not None
    ):  # "for each lab, get a cup in the kitchen and put it there"
        return d.loops.stop
    if not places:
        raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))
    return places[-1]


@meaning("place_here")
def place_here(d: Discourse, node: Node) -> Value:
    """ "here" is where the speaker is, wherever the robot has gone meanwhile."""
    return d.start()


@meaning("place_start")
def place_start(d: Discourse, node: Node) -> Value:
    return d.start()


@meaning("place_found")
def place_found(d: Discourse, node: Node) -> Value:
    """ "where you found it"."""
    place = (
        d.scene.thing.place or source_of(d, d.scene.thing) if d.scene.thing is not None else None
    )
    if place is None:
        raise NotUnderstood(d.language.phrase("where_is_there"))
    d.scene = replace(d.scene, place=place)
    return place


@meaning("place_other")
def place_other(d: Discourse, node: Node) -> Value:
    """ "the other office", "the other one": of two, the one that was not spoken of, or was not
    chosen; else the question which."""
    other = not_chosen(d)
    if other is not None:
        return other
    places = d.lexicon.place_kinds[d.get(node, "kind") or kind_of_place(d, node)]
    others = [each.name for each in places if Text(each.name) != d.scene.place]
    if len(others) == 1:
        place = Text(others[0])
        d.scene = replace(d.scene, place=place)
        return place
    raise d.which(node.start, node.end, tuple(others))


def kind_of_place(d: Discourse, node: Node) -> str:
    """The kind of the place that was spoken of last."""
    for kind, places in d.lexicon.place_kinds.items():
        if len(places) > 1 and any(Text(each.name) == d.scene.place for each in places):
            return kind
    raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))


def not_chosen(d: Discourse) -> Value | None:
    """The place that was not chosen, if there were two to choose from."""
    known = {each.name for each in d.lexicon.places}
    if (
        d.answers.last is None
        or len(d.answers.options) != 2
        or not known.issuperset(d.answers.options)
    ):
        return None
    one, two = map(Text, d.answers.options)
    other = Recall(d.variable("other"))
    chosen = Compare(Recall(d.answers.last), "==", two)
    d.done += [Remember(other.name, two), If(chosen, (Remember(other.name, one),))]
    d.scene = replace(d.scene, place=other)
    return other
