"""Finding, fetching and putting things."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node, what_it_means
from grammar.discourse import ANYONE, START, Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.carrying import deliver, pick_up, take_back_delivery, the_same
from grammar.meanings.chosen import handed_already
from grammar.meanings.deliveries import (
    Delivery,
    given_last,
    is_needed,
    meant_for,
    places_gone_to,
    whereto_told,
)
from grammar.meanings.descriptions import described
from grammar.meanings.finding import (
    go,
    if_missing,
    look_for,
    meet,
    meet_several,
    noun_of,
    speak_to,
    where_sent,
)
from grammar.meanings.holders import take_from_holder
from grammar.meanings.hosting import guide_to_person, led_to
from grammar.meanings.inquiries import as_many_as_answered
from grammar.meanings.leading import lead
from grammar.meanings.nouns import thing_it
from grammar.meanings.offers import if_they_want_it
from grammar.meanings.people import brought_here, led_back, led_on
from grammar.meanings.persons import guest_for, is_me
from grammar.meanings.places import extraposed, home_of, kind_places, piece_called, sought
from grammar.meanings.places_meant import place_there
from grammar.meanings.registry import meaning
from grammar.meanings.remarks import fetched_there, known_to_be, mislaid
from grammar.meanings.reports import Report, found_out
from grammar.meanings.several_places import over_places
from grammar.meanings.sights import best_there, which_there
from grammar.meanings.sources import all_there_are, told_where
from grammar.meanings.speaking import sentence_form
from grammar.meanings.strangers import announced_one
from grammar.meanings.thing_lists import all_listed, off_the_list, told_where_all_are
from grammar.plan import Call, ForEach, Items, Recall, Step, Text, Value
from grammar.tidy import nodes
from grammar.wordforms import head_word, singular


@meaning("find")
def find(d: Discourse, node: Node) -> Steps:
    sought_for = node.parts.get("thing")
    if d.round.such is not None and isinstance(sought_for, Node) and sought_for.means == "thing_it":
        return []  # "I need an empty office. Go and find one": that is being done
    thing = noun_of(d, node)
    announced = announced_one(d, node, thing.place)
    if announced is not None:
        return announced
    if thing.first:  # "we expect a visitor. Meet her in the lobby"
        return meet(d, thing)
    if isinstance(thing.group, Items):
        who = Recall(d.variable("person"))
        d.scene = d.scene.wandered()
        return [ForEach(who.name, thing.group, tuple(if_missing(d, who)))]
    if thing.person and thing.count is not None:
        return meet_several(d, thing)
    if thing.several and not (thing.person and thing.every):
        return find_several(d, node, thing)
    if d.loops.found_already:
        return []
    visited = places_gone_to(d) if thing.place is None else []
    if len(visited) > 1 and all(
        isinstance(each, Text) for each in visited
    ):  # "go to the lobby and then to the lounge and look for it"
        del d.done[-len(visited) :]
        return look_for(d, replace(thing, place=Items(tuple(visited))))
    missed = d.scene.missing is not None and (d.scene.missing.value, d.scene.missing.place) == (
        thing.value,
        d.scene.at,
    )
    everywhere = node.production.fixed.get("everywhere", missed)
    back = thing.person and d.scene.at == Recall(START)  # they are not with the speaker
    if thing.place is None and d.scene.at is not None and not everywhere and not back:
        thing = replace(thing, place=d.scene.at)  # "go to the kitchen and find the cup"
    return look_for(d, thing)


def find_several(d: Discourse, node: Node, thing: Thing) -> Steps:
    """ "find three cups in the kitchen": a search ends with the first one, so that what is there is
    looked at and told. "..., and bring them here" is straight there."""
    if thing.place is None and not isinstance(d.scene.at, Text):
        part = node.parts.get("thing") or node.parts.get("person_ref") or node
        words = d.words(part.start, part.end)
        raise NotUnderstood(
            d.language.phrase("find_one", things=words), span=(part.start, part.end)
        )
    said = node.parts.get("thing")
    best = isinstance(said, Node) and "superlative" in said.parts
    thing = replace(thing, place=thing.place or d.scene.at)
    steps = found_out(d, best_there(d, thing) if best else which_there(d, thing), None, back=False)
    d.deliveries = replace(d.deliveries, listed_last=tuple(steps))
    if not thing.person:
        d.scene = d.scene.speaking_of(thing)
    return steps


@meaning("grab")
def grab(d: Discourse, node: Node) -> Steps:
    thing = noun_of(d, node)
    if (
        isinstance(d.deliveries.meant_for, Delivery) and not thing.pronoun
    ):  # "if there is no tea, get coffee"
        return deliver(d, thing, d.deliveries.meant_for.person, d.deliveries.meant_for.spot)
    if is_needed(d, thing) and (thing.place is not None or d.scene.at is not None):
        return brought_to_whoever_needs_it(d, thing)
    if thing.place is not None and thing.place != d.scene.at:
        fetched = node.production.fixed.get("fetched")
        return deliver(d, thing, None, None) if fetched else pick_up(d, thing)
    if isinstance(d.deliveries.meant_for, Delivery):  # "if there is none, take a banana"
        return deliver(d, thing, d.deliveries.meant_for.person, d.deliveries.meant_for.spot)
    if take_from_holder(d, thing):
        return []
    d.scene = replace(d.scene, holding=thing.value)
    d.scene = d.scene.speaking_of(thing)
    return [Call("grab", {"thing": sought(d, thing)})]


@meaning("fetch_from")
def fetch_from(d: Discourse, node: Node) -> Steps:
    """ "get the key from Alice": she is asked for it."""
    person: Thing = where_sent(d, d.get(node, "person_ref"))
    words = node.parts.get("wanted")  # with their article, where it shows the gender
    part = words.parts["noun"] if isinstance(words, Node) else node.parts["noun"]
    what = singular(d.noun_words(part.start, part.end), d.language)
    called = d.words(words.start, words.end) if words is not None else what
    question = Text(str(node.production.fixed["question"]).format(thing=called))
    asking: dict[str, Value] = {"question": question}
    if person.known:
        asking["person"] = person.value
    steps = [*meet(d, person), Call("ask", asking)]
    d.scene = replace(d.scene, person=person)
    thing = Thing(Text(what), noun=head_word(what, d.language), here=True)
    return [*steps, *deliver(d, thing, None, None)]


@meaning("put")
def put(d: Discourse, node: Node) -> Steps:
    """ "put the cup on the table", "... in the kitchen", "... down"."""
    where = node.parts.get("where")
    if (so_many := as_many_as_answered(d, node)) is not None:
        return so_many
    on_it = where_gone_to(d, node)
    thing: Thing = whereto_told(d, d.get(node, "thing") or thing_it(d, node))
    if thing.person and "thing" not in node.parts and where is not None:
        further = led_on(d, thing, d.build(where).place)
        if further is not None:
            return further
    if thing.person and node.production.fixed.get("brought"):
        return led_back(d, thing)  # "va chercher Clara et ramène-la"
    if thing.person and thing.known:  # "otherwise put it there", where only Bob was spoken of
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("cannot_do", what=words), gap=(node.start, node.end))
    there = d.scene.place  # "bring one there from the store"
    source: Where | None = d.get(node, "from")
    if source is not None:
        thing = replace(thing, place=source.place, furniture=source.furniture)
    if source is not None and node.parts["from"].start > node.parts.get("where", node).start:
        d.scene = replace(d.scene, place=there)
    spot: Where = on_it or d.get(node, "where") or Where()
    stray = extraposed(d, where) if thing.place is None else None
    if stray is not None:
        spot, thing = stray[0], located_at(thing, stray[1])
    if node.production.fixed.get("there") and (d.scene.place is not None or not d.done):
        spot = Where(place_there(d, node))
    last = d.done[-1] if d.done else None
    just_put = isinstance(last, Call) and last.method == "put"
    if node.production.fixed.get("there") and thing.pronoun and just_put:
        return []  # "the cup belongs on the shelf, put it there"
    another = thing.place is not None and not thing.pronoun
    if last == Call("put", {"thing": thing.value}) and not another:
        d.done.pop()  # "carry it to the ward and put it on the table": put down once
        d.scene = replace(d.scene, holding=thing.value)
    if node.production.fixed.get("brought") and d.scene.delivered == thing.value and given_last(d):
        return []  # "get the cup and bring it back": here
    thing = off_the_list(d, thing)
    take_back_delivery(d, thing)
    if node.production.fixed.get("brought") and thing.pronoun and not kept_elsewhere(d, thing):
        return deliver(d, thing, None, None)  # "if you find it, bring it back": to who lost it
    if node.production.fixed.get("back") and thing.pronoun and spot == Where():
        spot = Where(d.deliveries.source or d.scene.at_pick_up or thing.place)
        thing = replace(thing, place=None, here=thing.value not in d.scene.now_at)
    elsewhere = thing.place is not None and d.scene.at is not None and thing.place != d.scene.at
    if d.scene.holding != thing.value and spot == Where() and not elsewhere:
        return [Call("put", {"thing": thing.value})]
    return deliver(d, thing, None, spot)


def located_at(thing: Thing, spot: Where) -> Thing:
    """The thing, where it is said to be."""
    return replace(thing, place=spot.place, furniture=spot.furniture, preposition=spot.preposition)


def where_gone_to(d: Discourse, node: Node) -> Where | None:
    """ "go to the table and put the cup on it": where it goes. It is not there yet, so it has to be
    looked for before anybody goes there."""
    where, thing = node.parts.get("where"), node.parts.get("thing")
    last = d.done[-1] if d.done else None
    if (
        not isinstance(where, Node)
        or where.means != "where_it"
        or not (isinstance(thing, Node) and thing.means == "thing")
        or not (isinstance(last, Call) and last.method == "goto")
        or last.arguments.get("place") != d.scene.at
        or d.scene.holding is not None
    ):
        return None
    spot: Where = d.build(where)
    d.done.pop()
    d.scene = replace(d.scene, at=None, at_furniture=None)
    return spot


def kept_elsewhere(d: Discourse, thing: Thing) -> bool:
    """Whether a thing has a place to be brought back to: not what somebody was only to see."""
    given = d.deliveries.last.thing.value if isinstance(d.deliveries.last, Delivery) else None
    to_somebody = given == thing.value and d.deliveries.last.receiver is not None
    return was_moved(d, thing) and not to_somebody and d.deliveries.shown != thing.value


def was_moved(d: Discourse, thing: Thing) -> bool:
    """Whether a thing was taken from somewhere before, so that it has a place to go back to."""
    taken = any(
        isinstance(step, Call) and step.method == "grab" and step.arguments["thing"] == thing.value
        for step in nodes(tuple(d.done))
    )
    return taken or d.deliveries.source is not None or d.scene.at_pick_up is not None


@meaning("put_each")
def put_each(d: Discourse, node: Node) -> Steps:
    """ "put the cup on the table and the plate on the shelf": one after the other."""
    at, here = len(d.done), d.scene.at
    d.done.extend(put(d, node))
    if d.scene.at != here:
        d.scene = replace(
            d.scene, at=None
        )  # nobody says that the next thing is where the first one was brought to
    if "more" in node.parts:
        d.done.extend(d.build(node.parts["more"]))
    steps = d.done[at:]
    del d.done[at:]
    return steps


def means_who_is_met(d: Discourse, node: Node) -> bool:
    """Whether "them", who are brought to somebody, are who stands before the robot: "ask people
    until one agrees, then bring them to Clara"."""
    part, met = node.parts.get("thing"), d.scene.person
    if not isinstance(part, Node) or part.means != "thing_it" or not d.is_plural(part):
        return False
    to = node.parts.get("person_ref")
    if met is None or not met.here or d.scene.with_person != met.value:
        return False
    if to is None or what_it_means(to) == "person_me":
        return False
    by_name = met.known and isinstance(met.value, Text)
    things = (
        d.scene.thing is not None and singular(d.scene.thing.text, d.language) != d.scene.thing.text
    )
    return not (by_name or things or d.scene.thing_last)


def with_them(d: Discourse, node: Node) -> Steps:
    them = node.parts["thing"]
    with d.bound(them, d.scene.person):
        parts = {"person_ref": them, "other": node.parts["person_ref"]}
        return guide_to_person(d, replace(node, parts=parts))


@meaning("bring")
def bring(d: Discourse, node: Node) -> Steps:
    """Fetch a thing and hand it to a person, or put it down at a spot."""
    if means_who_is_met(d, node):
        return with_them(d, node)
    if (so_many := as_many_as_answered(d, node)) is not None:
        return so_many
    thing: Thing = d.get(node, "thing") or thing_it(d, node)  # "and deliver to Bob"
    thing = whereto_told(d, the_same(d, node, thing))
    source: Where | None = d.get(node, "from")
    if source is not None:
        thing = replace(thing, place=source.place, furniture=source.furniture)
    person: Thing | None = d.get(node, "person_ref")
    if thing.person and thing.pronoun is False and person is not None and is_me(person):
        return brought_here(d, thing)
    if thing.person and person is not None and not is_me(person):
        thing = guest_for(d, node.parts.get("thing"), thing) or thing
        part = node.parts["person_ref"]  # "fetch the visitor and take them to Clara"
        same = person.value == thing.value
        return led_to(d, thing, (d.one_called(part.start, part.end) if same else None) or person)
    if person is not None and (
        person.coming or person.group is not None or person.count is not None
    ):
        raise NotUnderstood(d.language.phrase("one_person"))
    for_things = set(d.language.speech.get("for_things", ()))
    if thing.person and for_things & set(d.norms(node.start, node.end)):
        word = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("what_is_it", word=word), gap=(node.start, node.end))
    if thing.person and (person is None or is_me(person)):  # "find Bob and bring him to me"
        target: Where | None = d.get(node, "where")
        to = d.start() if target is None or target.place is None else target.place
        steps = meet(d, thing)
        leading = lead(d, thing, to)  # "fetch him and take him to ..." is straight there
        d.deliveries = replace(d.deliveries, fetched=leading)
        return [*steps, leading]
    if node.production.fixed.get("handing") and person is not None and not thing.pronoun:
        person = handed_there(d, thing, person)
    if person is not None and thing.pronoun and d.done:
        given = Call("give", {"thing": thing.value, "person": person.value})
        if d.done[-1] == given or handed_already(d, thing, person):
            return []  # "Alice needs the cup, bring it to her"
    spot: Where | None = d.get(node, "where")
    if person is not None and spot is not None:
        person, spot = at_their_place(person, spot)
    if person is None and spot is None and node.production.fixed.get("open"):
        return if_they_want_it(d, thing, None, brought_to_whoever_needs_it(d, thing))
    steps = if_they_want_it(d, thing, person, deliver(d, thing, person, spot))
    d.deliveries = replace(
        d.deliveries, destined=d.deliveries.last if node.production.fixed.get("destined") else None
    )
    if node.production.fixed.get("why") and isinstance(d.deliveries.last, Delivery):
        d.deliveries = replace(d.deliveries, last=replace(d.deliveries.last, needed=True))
    return steps


def at_their_place(person: Thing, spot: Where) -> tuple[Thing | None, Where | None]:
    """ "bring me the tea to office 4": handed over there, or put down for them on a table."""
    if spot.place is None or spot.furniture:
        return None, spot
    if is_me(person):
        person = Thing(Text(ANYONE), person=True)  # the speaker has no name
    return replace(person, place=spot.place, here=False), None


def brought_to_whoever_needs_it(d: Discourse, thing: Thing) -> Steps:
    """Bring something without a word to whom."""
    person, spot = meant_for(d, thing)
    steps = deliver(d, thing, person, spot)
    handed = handing_over(steps) if person is not None or spot is not None else ()
    d.deliveries = replace(d.deliveries, brought=handed)
    return steps


def handing_over(steps: Steps) -> tuple[Step, ...]:
    """What comes behind taking a thing."""
    taken = [
        at for at, each in enumerate(steps) if isinstance(each, Call) and each.method == "grab"
    ]
    return tuple(steps[taken[-1] + 1 :]) if taken else ()


def handed_there(d: Discourse, thing: Thing, person: Thing) -> Thing:
    """ "go to the lounge and give the bowl to Alex": he is there; the bowl has to be looked for."""
    last = d.done[-1] if d.done else None
    going = (
        isinstance(last, Call)
        and last.method == "goto"
        and last.arguments.get("place") == d.scene.at
    )
    if (
        not going
        or not isinstance(d.scene.at, Text)
        or is_me(person)
        or thing.place
        or person.place
    ):
        return person
    place = d.scene.at
    d.done.pop()
    d.scene = replace(d.scene, at=None)
    return replace(person, place=place, here=False)


@meaning("throw_away")
def throw_away(d: Discourse, node: Node) -> Steps:
    """ "throw the sponge away": into the bin that the world has."""
    piece = piece_called(d, "bin")
    if all(each.name != piece for each in d.lexicon.furniture):
        raise NotUnderstood(d.language.phrase("no_bin"))
    return deliver(d, d.get(node, "thing"), None, Where(home_of(d, piece), piece))


@meaning("cannot_put")
def cannot_put(d: Discourse, node: Node) -> Steps:
    """ "put the bag under the bed": things are put down at a place, or on or in something."""
    how = d.words(node.parts["how"].start, node.parts["how"].end)
    raise NotUnderstood(d.language.phrase("cannot_put", how=how))


@meaning("find_to_answer")
def find_to_answer(d: Discourse, node: Node) -> Steps:
    """ "find somebody in the lobby whose question you will answer"."""
    return speak_to(d, d.get(node, "person_ref"), [Call("answer", {})])


@meaning("bring_each")
def bring_each(d: Discourse, node: Node) -> Steps:
    """ "bring every ward a blanket": one after the other."""

    def one(place: Value) -> Steps:
        return deliver(d, d.get(node, "thing"), None, Where(place))

    return over_places(d, node, kind_places(d, d.get(node, "kinds")), one)


def goes_on(d: Discourse, at: int) -> bool:
    """Whether the words before a token belong to the same clause: no mark and no "and" parts
    them."""
    while at and (d.tokens[at - 1].norm,) in d.language.fillers:  # "robot which cup is blue"
        at -= 1
    before = d.tokens[at - 1] if at else None
    joins = d.language.speech.get("joins", ())
    return before is not None and before.kind != "mark" and before.norm not in joins


@meaning("statement")
def statement(d: Discourse, node: Node) -> Steps:
    """ "there is a cup on the table": nothing to do, but now it is spoken of."""
    where_first = node.parts.get("from")
    if where_first is not None and where_first.start == node.start and goes_on(d, node.start):
        # "check whether the door | of room 3 is open" is one clause, however its words may part
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    spoken_of: Thing | list[Thing] | None = mislaid(d, node.parts.get("person_ref"))
    spoken_of = (
        spoken_of or all_listed(d, node.parts.get("thing")) or d.get(node, "thing")
    ) or d.get(node, "person_ref")
    thing = spoken_of[0] if isinstance(spoken_of, list) else spoken_of  # "it" is one of them
    spot: Where | None = d.get(node, "from")
    if thing is None:  # "he is in the kitchen"
        said_of_it = d.scene.thing if node.production.fixed.get("it") else None
        thing = said_of_it or d.scene.person or d.scene.thing or Thing(Text(ANYONE), person=True)
    posture = node.parts.get("activity")
    if posture is not None and not thing.known:
        thing = replace(thing, value=Text(f"{thing.text} {d.described_by(posture)}"))
    more = described(d, thing.text, node)  # "behind the bowl is a cup", "Bob waits at the door"
    thing = replace(thing, place=more.place or thing.place)
    thing = replace(thing, furniture=more.furniture or thing.furniture)
    if not (thing.person and thing.known):  # "a man here is waving"
        thing = replace(thing, value=more.value)
    if spot is not None:
        thing = replace(thing, place=spot.place, furniture=spot.furniture)
    thing = all_there_are(thing)
    if thing.place is None and not thing.known and isinstance(d.scene.at, Text):
        thing = replace(thing, place=d.scene.at)  # "go to the hall, there is a woman"
    if thing.place is not None:
        d.scene = replace(d.scene, place=thing.place)
        told_where(d, thing)
        told_where_all_are(d, thing)
        known_to_be(d, thing.value, thing.place)
    if thing.person:
        d.scene = replace(d.scene.speaking_of_person(thing), with_person=None)
        fetched_there(d, thing, thing.place)
    else:
        d.scene = d.scene.speaking_of(thing)
    guest = d.scene.person
    d.get(node, "for_whom")  # "the folder is for Clara": she is spoken of now, too
    if thing.person:  # but "there is a visitor for Clara": it is about the visitor
        d.scene = replace(d.scene, person=guest)
    said = sentence_form(d.words(node.start, node.end))
    d.reports = replace(d.reports, last=Report("only", Text(said), about_here=False), step=None)
    return []


@meaning("handed")
def handed(d: Discourse, node: Node) -> Steps:
    """ "here is Bob's letter": it is where the speaker is, whosever it is."""
    thing: Thing = d.get(node, "thing")
    thing = replace(thing, place=None, furniture=None, here=d.scene.at is None)
    if "person_ref" not in node.parts:
        d.scene = d.scene.speaking_of(thing)
        return []
    steps = deliver(d, thing, d.get(node, "person_ref"), None)
    d.deliveries = replace(d.deliveries, destined=d.deliveries.last)
    return steps


@meaning("scan")
def scan(d: Discourse, node: Node) -> Steps:
    """Scan a code, of a thing or on a person that is looked for first if it is not here; where
    nothing is done with the code, it is read out."""
    person: Thing | None = d.get(node, "person_ref")
    thing: Thing | None = d.get(node, "thing")
    place: Value | None = d.get(node, "at_place")
    steps = [] if place is None else go(d, place)
    if person is not None:
        steps = meet(d, person)
    elif thing is not None and not thing.here and not thing.pronoun:
        steps = look_for(d, thing)
    elif thing is not None and thing.here:  # the code is what counts, whatever it is on
        part = node.parts["thing"]
        d.resolve(range(part.start, part.end))
    d.answers = replace(d.answers, code=d.variable("code"), last=None)
    d.reports = replace(d.reports, last=None)
    return [*steps, Call("scan", {}, save_as=d.answers.code)]
