"""What is said of several: every nurse, two cups, each office, Alice and Bob, one cup or another.

A command is about one person, one thing, one place. Where a noun phrase in it speaks of several,
wherever it stands, the command is made for one of them, and a loop is put around it; two such
phrases give two loops. What is done with a crowd at once (to speak to it) and what keeps count
itself (to ask) is not taken apart: `TOGETHER`.

A robot holds one thing, so that each round fetches one. Where several are put down somewhere, they
are looked for everywhere else: a search that begins where the robot is would find again what it
has just put there.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, Final

from grammar.chart import Leaf, Node
from grammar.discourse import (
    ANYONE,
    SETTING,
    START,
    Ambiguous,
    Discourse,
    NotUnderstood,
    Steps,
    Thing,
)
from grammar.meanings.answers import wanted
from grammar.meanings.best_places import Best, Such, first_such, survey
from grammar.meanings.finding import found, go, look_for, named, not_found
from grammar.meanings.nouns import kind_in_plural
from grammar.meanings.searches import named_places, search_in, searched
from grammar.meanings.surveys import each_asked, uses_answer
from grammar.meanings.volunteers import over_willing
from grammar.naming import place_called
from grammar.plan import (
    Ask,
    Both,
    Call,
    Choice,
    Compare,
    Condition,
    End,
    ForEach,
    Forever,
    Holds,
    If,
    Increase,
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
from grammar.tidy import nodes
from grammar.wordforms import singular

HANDED: Final = frozenset({"bring", "grab", "put"})
"""Commands that change where things are."""
LIST_PARTS: Final = frozenset({"more_names", "either_names", "more_things", "either_things"})
"""Rules for the rest of a list, which is a part of the whole."""

Make = Callable[[], Steps]
"""Makes the steps of a command, for whatever its noun phrases are bound to by then."""

TOGETHER: Final = frozenset(
    {
        "answer", "answers_reached", "ask", "ask_again", "ask_to", "find", "greet", "phrase",
        "report", "said_with", "same_for", "say", "say_it", "say_that", "tell", "tell_joke",
        "tell_that", "wait_for",
    }
)  # fmt: skip
"""Commands that know themselves what to do with several people."""
ALWAYS: Final = frozenset(
    {
        "each_place", "person_either", "person_said", "person_willing", "place_any", "place_best",
        "place_either",
        "place_such",
        "place_where",
        "thing_either", "things",
    }
)  # fmt: skip
"""Noun phrases that no command knows itself what to do with."""
CLAUSES: Final = frozenset({"command", "closing", "clause", "steps", "body", "whole"})
"""Rules in which commands of their own stand."""


def distributed(d: Discourse, node: Node, make: Make) -> Steps:
    """The steps of a command, in a loop for each of its noun phrases that speak of several."""
    within = setting_of(node) or node
    several = [part for part in phrases(within) if speaks_of_several(d, node, part)]
    several.sort(key=lambda part: part.production.rule == "thing")  # things change hands inside
    outer = d.taken_from
    things = any(part.production.rule == "thing" for part in several)
    d.taken_from = d.get(node, "from") if things and "from" in node.parts else None
    steps = over(d, several, make)
    d.taken_from = outer
    return steps


def setting_of(node: Node) -> Node | None:
    """ "in any office, ...": where a command is done, if that is said before it."""
    setting = node.parts.get(SETTING)
    if not isinstance(setting, Node):
        return None
    return replace(node, parts={SETTING: setting})


def phrases(node: Node) -> Iterator[Node]:
    """The noun phrases of a command, the inner ones first: "every ward" of "everybody in every
    ward"."""
    for name, part in node.parts.items():
        if name == "wrong":  # taken back
            continue
        if isinstance(part, Node) and part.production.rule not in CLAUSES:
            yield from phrases(part)
            if part.means in OVER and part.production.rule not in LIST_PARTS:
                yield part


def speaks_of_several(d: Discourse, node: Node, part: Node) -> bool:
    """Whether a noun phrase of a command makes a loop."""
    together = node.means in TOGETHER
    if id(part) in d.bound:
        return False
    if node.means == "wait_for" and part.means == "person_either":
        return False
    by_name = node.means == "greet" and part.means in ("person_group", "person_group_kind")
    if together and part.means not in ALWAYS and "but" not in part.parts and not by_name:
        return False
    if part.means == "person_kind":
        definite = d.tokens[part.start].norm in d.language.speech.get("definite", ())
        several_of = node.means == "bring" and definite and kind_in_plural(d, part)
        return bool(part.production.fixed.get("plural")) or several_of
    if part.means == "person_pronoun" and d.thing_last:
        return d.thing is not None and d.thing.several and d.is_plural(part)
    if part.means == "person_pronoun":
        return d.person is not None and d.person.group is not None and d.is_plural(part)
    if part.means == "thing" and part.production.rule == "simple_thing":
        return False
    if part.means == "thing":
        told = {*part.parts, *part.production.fixed}
        return bool(told & {"number", "every"}) or (node.means in HANDED and all_of(d, part))
    if part.means == "thing_it":
        return d.thing is not None and d.thing.several and d.is_plural(part)
    return True


def all_of(d: Discourse, part: Node) -> bool:
    """Whether it speaks of all there are: "the boxes in the supply room"."""
    head = part.parts.get("head")
    if d.tokens[part.start].norm not in d.language.speech.get("definite", ()) or head is None:
        return False
    said = d.noun_words(head.start, head.end)
    if isinstance(head, Leaf) and head.slot == "object" and said_as_named(d, head):
        return False  # "the chips"
    if "superlative" in part.parts or singular(said, d.language) == said:
        return False
    before = d.thing, d.thing_last
    thing: Thing = d.build(part)
    d.thing, d.thing_last = before
    return not thing.here and (thing.place is not None or bool(thing.furniture))


def said_as_named(d: Discourse, head: Leaf) -> bool:
    """Whether a thing is called just what the world calls it, and not by the plural of that."""
    said = tuple(d.norms(head.start, head.end))
    return any(
        said == d.language.tokens_of(name)
        for each in d.lexicon.objects
        for name in (each.name, *each.aliases)
    )


def over(d: Discourse, several: list[Node], make: Make) -> Steps:
    if not several:
        return make()
    first, *rest = several
    d.taking_apart = True
    try:
        phrase = d.build(first)
    finally:
        d.taking_apart = False

    def one(bound: Any) -> Steps:
        """The steps for one of them."""
        d.bound[id(first)] = bound
        try:
            return over(d, rest, make)
        finally:
            del d.bound[id(first)]

    return OVER[first.means](d, first, phrase, one)


One = Callable[[Any], Steps]


def round_of_steps(d: Discourse, make: Make) -> Steps:
    """The steps of one round of a loop."""
    d.with_person = d.holding = None
    outer, d.in_loop = d.in_loop, True
    steps = d.sequence(lambda: d.done.extend(make()))
    d.in_loop = outer
    return guarded(d, steps)


def guarded(d: Discourse, steps: Steps) -> Steps:
    from grammar.meanings.control import guard_finds

    return guard_finds(d, steps)


def leaves(steps: Steps, place: Value | None) -> bool:
    """Whether some steps end elsewhere than where they begin."""
    last: Value | None = place or Recall(START)
    for each in nodes(tuple(steps)):
        if isinstance(each, Call) and each.method in ("goto", "guide"):
            last = each.arguments.get("place")
        elif isinstance(each, Call | Ask) and each.method in ("find", "follow"):
            last = each.arguments.get("place") or each.arguments.get("to")
    return last != (place or Recall(START))


# --- people


def over_people(d: Discourse, node: Node, person: Thing, one: One) -> Steps:
    group = person.group
    if isinstance(group, Items):
        return each_named(d, group, person, one)
    return each_met(d, person, one)


def each_named(d: Discourse, group: Value, person: Thing, one: One) -> Steps:
    """Each of several people whom the world knows."""
    who = Recall(d.variable("person"))
    d.at = None
    fetched = d.done[-1] if d.done and fetches(d, d.done[-1], group) else None
    body = round_of_steps(d, lambda: one(Thing(who, known=True, person=True)))
    if fetched is not None and any(leads(each) for each in nodes(tuple(body))):
        d.done.remove(fetched)  # "get Alice and Bob and take them to the lounge": not here first
    d.at = d.with_person = None
    d.person, d.thing_last = person, False
    return [ForEach(who.name, group, tuple(body))]


def fetches(d: Discourse, step: Step, group: Value) -> bool:
    """Whether a step does nothing but bring these people to the speaker."""
    round_of_them = isinstance(step, ForEach) and step.items == group
    return round_of_them and any(each is d.fetched for each in nodes(step))


def leads(step: object) -> bool:
    return isinstance(step, Call) and step.method == "guide"


def each_met(d: Discourse, person: Thing, one: One) -> Steps:
    """Each of those who are at a place, or come to it."""
    going = go(d, person.place) if person.place is not None else []
    here = d.at
    who: Value = person.value
    by_name = person.every and person.text == ANYONE
    if by_name:
        who = Recall(d.variable("person"))
    met = Thing(who, known=by_name, person=True, here=True)
    outer = d.at_people
    d.at_people = d.at_people or bool(going)
    body = round_of_steps(d, lambda: one(met))
    d.at_people = outer
    if person.but is not None:
        body = [If(Not(Compare(who, "in", person.but)), tuple(body))]
    meeting: Steps = [] if by_name else [Call("wait_for", {"thing": who})]
    if leaves(body, here):
        meeting.insert(0, Call("goto", {"place": d.start() if here is None else here}))
        d.at = d.with_person = None
    fetched = fetched_before(body, who, here) if not by_name and not person.coming else 0
    if fetched:  # whoever is met is forgotten on the way to what they get
        meeting = [*body[:fetched], meeting[-1]]
    steps = (*meeting, *body[fetched:])
    d.person = replace(person, place=None, here=True, coming=False)
    d.thing_last = False
    if person.coming:
        return [*going, Forever(steps)]
    if person.count is not None:
        return [*going, Repeat(Number(person.count), steps)]
    if by_name:
        assert isinstance(who, Recall)
        return [*going, ForEach(who.name, Ask("people"), steps)]
    return [*going, Repeat(Ask("count", {"thing": who}), steps)]


def fetched_before(body: Steps, who: Value, here: Value | None) -> int:
    """How many steps fetch something before it is handed to those who are met."""
    handed = next(
        (at for at, each in enumerate(body) if who in getattr(each, "arguments", {}).values()), 0
    )
    fetching = body[:handed]
    last = fetching[-1] if fetching else None
    plain = all(isinstance(each, Call) and each.save_as is None for each in fetching)
    brought = isinstance(last, Call) and last == Call("goto", {"place": here}) if here else False
    return handed if plain and brought else 0


def over_them(d: Discourse, node: Node, person: Thing, one: One) -> Steps:
    """ "them": people, or things that were spoken of after them."""
    if d.thing_last and d.thing is not None:
        return over_things(d, node, d.thing, one)
    asked = each_asked(d)
    if asked is not None:  # "ask Alice and Bob what they want and bring it to them": each their own
        scene = d.scene()
        d.at = None
        steps = one(asked)
        if uses_answer(d, steps):
            return steps
        d.set_scene(scene)
    return over_people(d, node, person, one)


def over_those_who(d: Discourse, node: Node, person: Thing, one: One) -> Steps:
    """ "each one who said yes": for whoever was asked, if that is what they answered."""
    survey = d.surveys[-1]
    answer: Condition = wanted(d, survey, d.get(node, "said")).given(survey)
    d.at = None
    return [If(answer, tuple(round_of_steps(d, lambda: one(person))))]


def over_either_person(d: Discourse, node: Node, people: list[Thing], one: One) -> Steps:
    """ "Alice or Bob": whoever is found first."""
    return first_found(d, people, one)


# --- places


def over_places(d: Discourse, node: Node, places: Value, one: One) -> Steps:
    place = Recall(d.variable("place"))
    d.at = None
    d.loops[place.name] = places
    body = round_of_steps(d, lambda: one(place))
    d.at = d.with_person = None
    return until_found(d, place, places, body) or [
        ForEach(place.name, places, tuple(another_one(d, body)))
    ]


def until_found(d: Discourse, place: Recall, places: Value, body: Steps) -> Steps:
    """ "search every ward for the thermometer": until it is found; nothing if that is not what is
    done at each place."""
    first = body[0] if len(body) == 1 else None
    search = searched(first)
    if search is None or not isinstance(first, If):
        return []
    known = named_places(d, places)
    thing = d.thing if d.thing_last else d.person
    if known is not None and thing is not None:
        d.thing, d.person = (
            replace(each, place=None) if each else each for each in (d.thing, d.person)
        )
        return search_in(d, replace(thing, place=None), known)
    missing = first.then
    found_it = Recall(d.variable("found"))
    success = (Remember(found_it.name, Truth(True)), End())
    return [
        Remember(found_it.name, Truth(False)),
        ForEach(place.name, places, (If(search, success),)),
        If(Not(Holds(found_it)), missing),
    ]


def over_either_place(d: Discourse, node: Node, places: list[Value], one: One) -> Steps:
    """ "look for it in the lobby or the kitchen": in the one, then in the other."""
    looked: Value | None = None
    for place in places:
        d.at = None
        search = d.sequence(lambda p=place: d.done.extend(one(p)))  # type: ignore[misc]
        first = search[0] if len(search) == 1 else None
        if not (isinstance(first, Call) and first.method == "find"):
            named_places = tuple(each.value for each in places if isinstance(each, Text))
            raise d.which(node.start, node.end, named_places)
        looked = first.arguments["thing"]
    assert looked is not None
    return search_in(d, Thing(looked), places)


def over_any_place(d: Discourse, node: Node, places: Value, one: One) -> Steps:
    """ "any office": one of them, no matter which."""
    if isinstance(places, Text):
        return one(places)
    place = Recall(d.variable("place"))
    d.place = place
    return [Remember(place.name, Choice(places)), *one(place)]


def over_place_best(d: Discourse, node: Node, best: Best, one: One) -> Steps:
    """ "the office with the fewest people": gone round for first."""
    going, place = survey(d, best)
    d.place = place
    return [*going, *one(place)]


def over_place_such(d: Discourse, node: Node, such: Such, one: One) -> Steps:
    """ "an empty office": the first that is; if none is, that is said."""
    going, place, none = first_such(d, such)
    d.place = place
    return [*going, If(none, (d.say("no_such_places"),), tuple(guarded(d, one(place))))]


def over_place_where(d: Discourse, node: Node, thing: Thing, one: One) -> Steps:
    """ "where Bob is": he is looked for, and that is the place."""
    searching = look_for(d, thing)
    place = Recall(d.variable("place"))
    d.at = d.place = place
    outer, d.at_people = d.at_people, True  # what is brought there need not be there
    body = one(place)
    d.at_people = outer
    if body == [Call("goto", {"place": place})]:
        return searching
    here: Step = Remember(place.name, Ask("location"))
    there = Holds(Ask("find", found(d, thing).arguments))
    return [If(there, (here, *guarded(d, body)), (not_found(d, thing),))]


# --- things


def over_things(d: Discourse, node: Node, thing: Thing, one: One) -> Steps:
    """ "two cups", "all the cups in the kitchen": one after the other, for the hand holds one."""
    if node.means != "thing":
        take_back(d, thing)
    if thing.place is None and d.taken_from is not None:
        thing = replace(thing, place=d.taken_from.place, furniture=d.taken_from.furniture)
    if thing.place is None and d.at is not None:
        thing = replace(thing, place=d.at)
    single = replace(thing, count=None, every=False, plural=False, pronoun=False)
    if thing.count is None:  # "them" are all of them
        thing = replace(thing, every=True)

    d.at = None if thing.count is not None else thing.place
    d.thing, d.thing_last = single, True
    body = round_of_steps(d, lambda: one(single if d.at is None else replace(single, here=True)))
    if is_grab(body):  # "collect the cups": where to is said next
        d.collected, d.thing, d.thing_last = thing, thing, True
        return []
    d.collected = None
    if moves_nothing(body):
        raise NotUnderstood(d.language.phrase("one_thing"))
    steps = rounds(d, node, thing, single, body)
    if d.delivered is not None:
        d.delivered_in = steps[-1]
    d.thing, d.thing_last = thing, True
    return steps


def rounds(d: Discourse, node: Node, thing: Thing, single: Thing, body: Steps) -> Steps:
    """The loop over several things: as many as were named, or all that are there."""
    target = put_where(body)
    if thing.place is not None or target is None:
        if thing.count is not None:
            return [Repeat(Number(thing.count), tuple(body))]
        if thing.place is not None:
            return [While(Holds(Ask("find", found(d, single).arguments)), tuple(body))]
        if not (isinstance(body[-1], Call) and body[-1].method == "give"):
            raise where_from(d, node, thing)
    source = Recall(d.variable("source"))
    search = Holds(Ask("find", {**found(d, single).arguments, "place": source}))
    if target is None:  # what is handed over is not found again
        return [ForEach(source.name, Ask("places"), (While(search, tuple(without_find(body))),))]
    body = without_find(body)
    other = is_other(d, source, target)
    if thing.count is None:
        return [ForEach(source.name, Ask("places"), (While(Both((other, search)), tuple(body)),))]
    brought = Recall(d.variable("brought"))
    few = Compare(brought, "<", Number(thing.count))
    loop = While(Both((few, other, search)), (*body, Increase(brought.name)))
    only = d.say("found_only", number=brought, things=named(d, single))
    return [
        Remember(brought.name, Number(0)),
        ForEach(source.name, Ask("places"), (loop,)),
        If(few, (only,)),
    ]


def without_find(body: Steps) -> Steps:
    """A round whose loop has already found the thing."""
    return [step for step in body if not (isinstance(step, Call) and step.method == "find")]


def another_one(d: Discourse, body: Steps) -> Steps:
    """The steps of a round that brings one to a place: from any place that is none of those."""
    target = put_where(body)
    search = next((at for at, step in enumerate(body) if is_search(step)), None)
    if target is None or search is None:
        return body
    looking = body[search]
    assert isinstance(looking, Call)
    source = Recall(d.variable("source"))
    there = Holds(Ask("find", {**looking.arguments, "place": source}))
    missing = body[search + 1 :]
    place = If(Both((is_other(d, source, target), there)), (*missing, End()))
    return [*body[:search], ForEach(source.name, Ask("places"), (place,))]


def is_search(step: Step) -> bool:
    """Whether a step looks for a thing anywhere."""
    return isinstance(step, Call) and step.method == "find" and "place" not in step.arguments


def is_other(d: Discourse, source: Recall, target: Value) -> Condition:
    """Whether a place is none of those that something is brought to."""
    targets = d.loops.get(target.name) if isinstance(target, Recall) else None
    if targets is None:
        return Compare(source, "!=", target)
    return Not(Compare(source, "in", targets))


def put_where(body: Steps) -> Value | None:
    """The place that a thing is brought to and put down; None for one that is handed over."""
    going = [step for step in body if isinstance(step, Call) and step.method == "goto"]
    last = body[-1] if body else None
    if not (going and isinstance(last, Call) and last.method == "put"):
        return None
    target = going[-1].arguments.get("place")
    return None if target == Recall(START) else target


def is_grab(body: Steps) -> bool:
    """Whether a round leaves the thing in the hand."""
    return bool(body) and isinstance(body[-1], Call) and body[-1].method == "grab"


def moves_nothing(body: Steps) -> bool:
    """Whether a round takes up what it has just put down."""
    return not any(isinstance(step, Call) and step.method in ("find", "goto") for step in body)


def take_back(d: Discourse, thing: Thing) -> None:
    """ "collect the cups in the ward and take them to the kitchen": straight there, and not first
    to who says so."""
    if d.done and d.done[-1] is d.delivered_in:
        d.done.pop()
        d.delivered_in = d.delivered = None
    if d.listed_last and d.done[-len(d.listed_last) :] == d.listed_last:
        del d.done[-len(d.listed_last) :]  # "find three cups in the ward and bring them here"
        d.listed_last = []


def where_from(d: Discourse, node: Node, thing: Thing) -> Ambiguous:
    """The question where all the cups are that are to be brought."""
    where = d.language.speech["from_place"]
    return Ambiguous(
        d.language.phrase("from_where", things=d.words(node.start, node.end)),
        node.end,
        node.end,
        tuple(
            where.format(place=place_called(place.name, d.lexicon, d.language))
            for place in d.lexicon.places
        ),
    )


def over_thing_list(d: Discourse, node: Node, things: list[Thing], one: One) -> Steps:
    """ "the cup and the book"."""
    plain = all(thing.place is None and not thing.furniture for thing in things)
    if not plain:
        return [step for thing in things for step in round_of_steps(d, lambda t=thing: one(t))]  # type: ignore[misc]
    each = Recall(d.variable("thing"))
    d.at = None
    body = round_of_steps(d, lambda: one(Thing(each)))
    d.at = d.with_person = None
    return [ForEach(each.name, Items(tuple(thing.value for thing in things)), tuple(body))]


def over_either_thing(d: Discourse, node: Node, things: list[Thing], one: One) -> Steps:
    """ "the red cup, or if there is none the blue one": the first that is found."""
    return first_found(d, things, one)


def first_found(d: Discourse, things: list[Thing], one: One) -> Steps:
    """Look for one after the other; the steps are those for the first that is found."""
    before = (d.at, d.holding, d.with_person, frozenset(d.variables))
    otherwise: Steps = [not_found(d, things[-1])]
    for thing in reversed(things):
        d.at, d.holding, d.with_person = before[:3]
        d.variables.intersection_update(before[3])  # the same names in either branch
        d.found_already = True
        body = round_of_steps(d, lambda t=thing: one(replace(t, here=True)))  # type: ignore[misc]
        d.found_already = False
        if not body:
            otherwise = [If(Not(Holds(Ask("find", found(d, thing).arguments))), tuple(otherwise))]
            continue
        otherwise = [
            If(Holds(Ask("find", found(d, thing).arguments)), tuple(body), tuple(otherwise))
        ]
    d.at = d.with_person = None
    return otherwise


OVER: Final[dict[str, Callable[[Discourse, Node, Any, One], Steps]]] = {
    "each_place": over_places,
    "place_any": over_any_place,
    "place_best": over_place_best,
    "place_such": over_place_such,
    "place_either": over_either_place,
    "place_where": over_place_where,
    "person_coming": over_people,
    "person_count": over_people,
    "person_group": over_people,
    "person_group_kind": over_people,
    "person_group_them": over_them,
    "person_kind": over_people,
    "person_pronoun": over_them,
    "person_either": over_either_person,
    "person_said": over_those_who,
    "person_willing": over_willing,
    "thing": over_things,
    "thing_it": over_things,
    "things": over_thing_list,
    "thing_either": over_either_thing,
}
"""The noun phrases that may speak of several, by their meaning: what is done with each."""
