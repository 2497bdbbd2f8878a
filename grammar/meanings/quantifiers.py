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
from itertools import takewhile
from typing import Any, Final

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, EACH, SETTING, Discourse, Steps, Thing
from grammar.meanings.answers import wanted
from grammar.meanings.deliveries import inside
from grammar.meanings.finding import found, go, not_found, waited_for
from grammar.meanings.one_round import Make, One, leaves, round_of_steps
from grammar.meanings.persons import kind_in_plural
from grammar.meanings.registry import meaning
from grammar.meanings.several_places import (
    over_any_place,
    over_either_place,
    over_place_best,
    over_place_such,
    over_place_where,
    over_places,
)
from grammar.meanings.several_things import (
    HANDED,
    as_many,
    begun_before,
    first_found,
    over_either_thing,
    over_things,
    put_more_exactly,
)
from grammar.meanings.sources import keep_fetching, sourced
from grammar.meanings.surveys import Survey, each_asked, uses_answer
from grammar.meanings.thing_lists import list_before, over_list_before, over_thing_list
from grammar.meanings.volunteers import over_willing
from grammar.meanings.who_agreed import for_who_agreed, who_agreed
from grammar.plan import (
    Ask,
    Call,
    Compare,
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
    Step,
    Text,
    Value,
    While,
)
from grammar.tidy import nodes
from grammar.wordforms import head_word, singular

LIST_PARTS: Final = frozenset({"more_names", "either_names", "more_things"})
"""Rules for the rest of a list, which is a part of the whole."""

TOGETHER: Final = frozenset(
    {
        "answer", "answers_reached", "ask", "ask_again", "ask_to", "ask_topic", "find", "greet",
        "offer", "phrase", "report", "said_with", "same_for", "say", "say_it", "say_that",
        "shared_with", "shares", "statement", "swap", "swap_owned", "tell", "tell_joke",
        "tell_that", "wait_for",
    }
)  # fmt: skip
"""Commands that know themselves what to do with several people."""
PEOPLE: Final = frozenset({"person_ref", "somebody", "willing"})
"""Rules for those who get something."""
FETCHES: Final = HANDED | {"shared_with", "shares"}
"""Commands that take things from somewhere."""
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
KNOWN_TO: Final = frozenset({("wait_for", "person_either"), ("statement", "things")})
"""Noun phrases that a command knows itself what to do with, and no other."""
CLAUSES: Final = frozenset({"command", "closing", "clause", "steps", "body", "whole"})
"""Rules in which commands of their own stand."""


@meaning(EACH)
def each_spoken_of(d: Discourse, node: Node) -> Steps:
    """A command that a rule names, for each of those that it speaks of."""
    return distributed(d, node, lambda: d.one_command(node))


def distributed(d: Discourse, node: Node, make: Make) -> Steps:
    """The steps of a command, in a loop for each of its noun phrases that speak of several."""
    again = [] if put_more_exactly(d, node) else sourced(d, node)
    if again is not None:
        return again
    scene, known = d.scene, frozenset(d.variables)
    within = setting_of(node) or node
    several = [part for part in phrases(within) if speaks_of_several(d, node, part)]
    several.sort(key=lambda part: part.production.rule == "thing")  # things change hands inside
    agreed = next((part for part in several if who_agreed(d, node, part)), None)
    if agreed is not None:
        several.remove(agreed)
        make = for_who_agreed(d, agreed, make)
    if hands_one_of_several(d, node):
        begun_before(d)
    several = one_each(d, node, several)
    if node.means == "go_person" and len(several) == 1 and "then" not in node.parts:
        among = gone_among(d, several[0])
        if among is not None:
            return among
    within_source = {id(part) for part in inside(node.parts.get("from"))}
    sources = [part for part in several if id(part) in within_source]  # "out of all offices"
    several = [part for part in several if id(part) not in within_source]
    outer = d.deliveries.only_fetches
    bare = only_fetches(node)
    d.deliveries = replace(d.deliveries, only_fetches=bare)
    steps = over(d, sources, lambda: taken_from_there(d, node, several, make))
    d.deliveries = replace(d.deliveries, only_fetches=outer)
    if node.means in FETCHES:
        keep_fetching(d, lambda: distributed(d, node, make), steps, scene, known)
    return steps


def gone_among(d: Discourse, part: Node) -> Steps | None:
    """ "go to every patient in ward a and ask them ...": to where they are, for nobody knows who
    they are; what is asked or said next is for each of them. None of people who have names."""
    scene = d.scene
    people = d.build(part)
    if part.means not in ("person_kind", "person_group_kind") or isinstance(people.group, Items):
        people = None
    if people is None or people.place is None:
        d.scene = scene
        return None
    going = go(d, people.place)
    d.scene = d.scene.speaking_of_person(replace(people, place=None, here=True))
    return going


def only_fetches(node: Node) -> bool:
    """Whether a command fetches things without a word to whom or where to."""
    fixed = node.production.fixed
    return node.means == "grab" or bool(fixed.get("open") or fixed.get("why"))


def taken_from_there(d: Discourse, node: Node, several: list[Node], make: Make) -> Steps:
    """The steps of a command for several things, of which is said where they are taken from."""
    outer, place = d.deliveries.taken_from, d.scene.place
    things = any(OVER[part.means] in OF_THINGS for part in several)
    source = d.get(node, "from") if things and "from" in node.parts else outer
    d.deliveries = replace(d.deliveries, taken_from=source)
    if "source" in node.parts and any(OVER[part.means] is over_people for part in several):
        source = d.get(node, "source")  # "take everybody from the lounge to the exit"
        d.deliveries = replace(d.deliveries, taken_from=source)
    d.scene = replace(d.scene, place=place)  # "there" is not where they are taken from
    steps = over(d, several, make)
    d.deliveries = replace(d.deliveries, taken_from=outer)
    return steps


def hands_one_of_several(d: Discourse, node: Node) -> bool:
    """ "get the flyers and give one to everybody", "... put one in each office": straight there."""
    part = node.parts.get("thing")
    if d.scene.thing is None or not d.scene.thing.several or not isinstance(part, Node):
        return False
    hands = node.means == "bring" or (node.means == "put" and not d.is_plural(part))
    return hands and part.means == "thing_it"


def one_each(d: Discourse, node: Node, several: list[Node]) -> list[Node]:
    """ "hand out the flyers to everybody", "three to the three of them": one to each."""
    people = [part for part in several if part.production.rule in PEOPLE]
    things = [part for part in several if OVER[part.means] in (over_it, over_things)]
    if not people or len(things) != 1:
        return several
    scene = d.scene
    thing: Thing = d.build(things[0])
    enough = thing.count is None or as_many(d, node, d.build(people[0]), thing.count)
    d.scene = scene
    if not enough or "every" in things[0].production.fixed:
        return several
    d.bind(things[0], replace(thing, every=False, plural=False, pronoun=False, count=None))
    return people


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
    if id(part) in d.loops.bound:
        return False
    if (node.means, part.means) in KNOWN_TO:
        return False
    if who_agreed(d, node, part):
        return True
    by_name = node.means == "greet" and part.means in ("person_group", "person_group_kind")
    if together and part.means not in ALWAYS and "but" not in part.parts and not by_name:
        return False
    if part.means == "person_kind":
        definite = d.tokens[part.start].norm in d.language.speech.get("definite", ()) or (
            d.tokens[part.start - 1].norm in d.language.speech.get("definite_before", ())
        )
        several_of = node.means == "bring" and definite and kind_in_plural(d, part)
        return bool(part.production.fixed.get("plural")) or several_of
    if part.means == "person_pronoun" and d.scene.thing_last:
        several = d.scene.thing is not None and (d.scene.thing.several or d.scene.thing.listed)
        return bool(several) and d.is_plural(part)
    if part.means == "person_pronoun":
        each = node.means in HANDED and each_asked(d) is not None
        last = d.scene.person
        group = last is not None and (last.group is not None or last.count is not None)
        return (group or each) and d.is_plural(part)
    if part.means == "thing" and part.production.rule == "simple_thing":
        return False
    if part.means == "thing":
        told = {*part.parts, *part.production.fixed}
        return bool(told & {"number", "every"}) or (node.means in HANDED and all_of(d, node, part))
    if part.means == "thing_it":
        several = d.scene.thing is not None and d.scene.thing.several and d.is_plural(part)
        return several or (node.means in HANDED and bool(list_before(d, part)))
    return True


def all_of(d: Discourse, node: Node, part: Node) -> bool:
    """Whether it speaks of all there are: "bring the cups to the kitchen"."""
    head = part.parts.get("head")
    if d.tokens[part.start].norm not in d.language.speech.get("definite", ()) or head is None:
        return False
    said = d.noun_words(head.start, head.end)
    if isinstance(head, Leaf) and head.slot == "object" and said_as_named(d, head):
        return False  # "the chips"
    one = singular(said, d.language)
    if "superlative" in part.parts or one == said or one in d.language.speech.get("bunches", ()):
        return False
    if "from" in node.parts or any(each.means == "each_place" for each in inside(part)):
        return True  # "the cups in the meeting rooms"
    before = d.scene
    thing: Thing = d.build(part)
    d.scene = d.scene.with_it_of(before)
    in_round = d.loops.in_loop and isinstance(d.scene.at, Recall)
    somewhere = in_round or thing.place is not None or bool(thing.furniture)
    # Where the world knows no such thing, its plural may be the name of one: "the pickles".
    return not thing.here and (somewhere or (isinstance(head, Leaf) and head.slot == "object"))


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
    d.loops = replace(d.loops, taking_apart=True)
    try:
        phrase = d.build(first)
    finally:
        d.loops = replace(d.loops, taking_apart=False)

    def one(bound: Any) -> Steps:
        """The steps for one of them."""
        with d.bound(first, bound):
            return over(d, rest, make)

    return OVER[first.means](d, first, phrase, one)


def over_people(d: Discourse, node: Node, person: Thing, one: One) -> Steps:
    if person.plural and person.text == ANYONE and person.place is None:
        steps = each_their_own(d, one)  # "bring everyone what they asked for"
        if steps is not None:
            return steps
    if person.place is None and d.deliveries.taken_from is not None:
        person = replace(person, place=d.deliveries.taken_from.place)
    group = person.group
    if isinstance(group, Items):
        return each_named(d, group, person, one)
    return each_met(d, person, one)


def each_named(d: Discourse, group: Value, person: Thing, one: One) -> Steps:
    """Each of several people whom the world knows."""
    who = Recall(d.variable("person"))
    d.scene = replace(d.scene, at=None)
    fetched = d.done[-1] if d.done and fetches(d, d.done[-1], group) else None
    body = round_of_steps(d, lambda: one(Thing(who, known=True, person=True)))
    if fetched is not None and any(leads(each) for each in nodes(tuple(body))):
        d.done.remove(fetched)  # "get Alice and Bob and take them to the lounge": not here first
    d.scene = d.scene.wandered()
    d.scene = d.scene.speaking_of_person(person)
    return [ForEach(who.name, group, tuple(body))]


def fetches(d: Discourse, step: Step, group: Value) -> bool:
    """Whether a step does nothing but bring these people to the speaker."""
    round_of_them = isinstance(step, ForEach) and step.items == group
    return round_of_them and any(each is d.deliveries.fetched for each in nodes(step))


def leads(step: object) -> bool:
    return isinstance(step, Call) and step.method == "guide"


def each_met(d: Discourse, person: Thing, one: One) -> Steps:
    """Each of those who are at a place, or come to it."""
    going = go(d, person.place) if person.place is not None else []
    here = d.scene.at
    who: Value = person.value
    by_name = person.every and person.text == ANYONE
    if by_name:
        who = Recall(d.variable("person"))
    met = Thing(who, known=by_name, person=True, here=True)
    outer = d.loops.at_people
    d.loops = replace(d.loops, at_people=d.loops.at_people or bool(going))
    body = round_of_steps(d, lambda: one(met))
    d.loops = replace(d.loops, at_people=outer)
    moment = [*takewhile(_is_moment, body)] if not person.coming and person.count is None else []
    if len(moment) < len(body):  # "remind everyone at five": that is one time for all of them
        going, body = [*going, *moment], body[len(moment) :]
    if person.but is not None:
        body = [If(Not(Compare(who, "in", person.but)), tuple(body))]
    meeting: Steps = [] if by_name else [Call("wait_for", {"thing": who})]
    if leaves(body, here):
        meeting.insert(0, Call("goto", {"place": d.start() if here is None else here}))
        d.scene = d.scene.wandered()
    waited = None if by_name or person.coming else waited_for(d, who)
    if waited is not None:  # "wait for two visitors and take each of them to the lounge"
        d.scene = d.scene.speaking_of_person(replace(person, place=None, here=True, count=None))
        return [Repeat(waited, (Call("wait_for", {"thing": who}), *body))]
    fetched = fetched_before(body, who, here) if not by_name and not person.coming else 0
    if fetched:  # whoever is met is forgotten on the way to what they get
        meeting = [*body[:fetched], meeting[-1]]
    steps = (*meeting, *body[fetched:])
    d.scene = replace(
        d.scene, person=replace(person, place=None, here=True, coming=False), thing_last=False
    )
    if person.coming:
        return [*going, Forever(steps)]
    if person.count is not None:
        return [*going, Repeat(Number(person.count), steps)]
    if by_name:
        assert isinstance(who, Recall)
        return [*going, ForEach(who.name, Ask("people"), steps)]
    return [*going, Repeat(Ask("count", {"thing": who}), steps)]


def _is_moment(step: Step) -> bool:
    """Whether a step only waits for its time."""
    if isinstance(step, While):
        return all(map(_is_moment, step.steps))
    return isinstance(step, Call) and step.method == "wait"


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
    if d.scene.thing_last and d.scene.thing is not None:
        return over_it(d, node, d.scene.thing, one)
    steps = each_their_own(d, one)
    return over_people(d, node, person, one) if steps is None else steps


def over_it(d: Discourse, node: Node, thing: Thing, one: One) -> Steps:
    """ "them", of things: those of a list, or several of a kind."""
    before = list_before(d, node)
    return over_list_before(d, node, before, one) if before else over_things(d, node, thing, one)


def each_their_own(d: Discourse, one: One) -> Steps | None:
    """ "ask Alice and Bob what they want and bring it to them": to whose turn it is, if it is what
    they have answered."""
    asked = each_asked(d)
    if asked is None:
        return None
    scene = d.scene
    d.scene = replace(d.scene, at=None)
    steps = one(asked)
    if uses_answer(d, steps):
        return steps
    wished = if_wished(d, steps)
    if wished is None:
        d.scene = scene
    return wished


def if_wished(d: Discourse, steps: Steps) -> Steps | None:
    """ "ask the people whether they would like tea and bring it to them": to those who would."""
    survey: Survey = d.answers.surveys[-1]
    question = survey.call.arguments["question"]
    agree = d.language.phrase("yes")
    if agree not in survey.options or not isinstance(question, Text) or not survey.call.save_as:
        return None
    words = set(d.language.tokens_of(question.value))
    brought = [
        head_word(each.arguments["thing"].value, d.language)
        for each in nodes(tuple(steps))
        if isinstance(each, Call)
        and each.method == "grab"
        and isinstance(each.arguments["thing"], Text)
    ]
    wishes = set(d.language.speech.get("wishes", ()))
    if not brought or not wishes & words or any(each not in words for each in brought):
        return None
    return [If(Compare(Recall(survey.call.save_as), "==", Text(agree)), tuple(steps))]


def over_those_who(d: Discourse, node: Node, person: Thing, one: One) -> Steps:
    """ "each one who said yes": for whoever was asked, if that is what they answered."""
    survey = d.answers.surveys[-1]
    answer: Condition = wanted(d, survey, d.get(node, "said")).given(survey)
    d.scene = replace(d.scene, at=None)
    return [If(answer, tuple(round_of_steps(d, lambda: one(person))))]


def over_either_person(d: Discourse, node: Node, people: list[Thing], one: One) -> Steps:
    """ "Alice or Bob": whoever is found first. If they are only looked for, it is that one who is
    spoken of then: "... and tell them that the car is here"."""
    looked_for = first_found(d, people, one)
    if not isinstance(looked_for[-1], If) or not isinstance(looked_for[-1].condition, Not):
        return looked_for
    whoever = Thing(Text(ANYONE), person=True, here=True)
    d.scene = replace(d.scene, person=whoever, with_person=whoever.value, thing_last=False)
    anybody = Either(tuple(Holds(Ask("find", found(d, each).arguments)) for each in people))
    return [If(Not(anybody), (not_found(d, whoever),))]


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
    "several_of": over_things,
    "thing": over_things,
    "thing_it": over_it,
    "things": over_thing_list,
    "thing_either": over_either_thing,
}
"""The noun phrases that may speak of several, by their meaning: what is done with each."""

OF_THINGS: Final = frozenset({over_either_thing, over_it, over_things, over_thing_list})
