"""Going round places and reporting: how many in each, altogether, most where, which are empty."""

from __future__ import annotations

from dataclasses import replace

from msgspec.structs import replace as structs_replace

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.answers import Said
from grammar.meanings.conditions import negated
from grammar.meanings.finding import speak_to
from grammar.meanings.news import News, Told, go_back, take_back
from grammar.meanings.persons import is_me
from grammar.meanings.place_loops import (
    goes_to,
    last_round,
    looked_over,
    places_of,
    round_of,
    round_of_visits,
    visits_alone,
)
from grammar.meanings.places import sought
from grammar.meanings.polls import ASKED_WHERE, asked_there, polled
from grammar.meanings.registry import meaning
from grammar.meanings.reports import Report, saying_of
from grammar.meanings.sights import told_where
from grammar.meanings.surveys import asked_yet, note, replacing
from grammar.meanings.traits import Trait
from grammar.naming import joined_up, some
from grammar.plan import (
    Ask,
    Call,
    Collect,
    Compare,
    Condition,
    Either,
    ForEach,
    Holds,
    If,
    Increase,
    Items,
    Length,
    Not,
    Number,
    Recall,
    Remember,
    Sentence,
    Share,
    Step,
    Text,
    Value,
)
from grammar.tidy import nodes
from grammar.wordforms import plural


def brought_back(d: Discourse, node: Node, told: Told) -> Steps:
    """The report, told to who asked for it, or to somebody else."""
    person: Thing | None = d.get(node, "whom")
    d.done.extend(told.first)
    d.scene = replace(d.scene, at=None)
    d.reports = replace(d.reports, news=News(told.words, person is None))
    if person is not None and not is_me(person):
        return speak_to(d, person, told.words)
    start = d.start()
    d.went(start)
    d.reports = replace(d.reports, told=told.words[-1])
    return [Call("goto", {"place": start}), *told.words]


def summed_up(d: Discourse, kind: str, thing: Thing | None = None) -> Told:
    """What was counted in each place, put together."""
    if (
        d.reports.counted is None
        and thing is None
        and kind == "total"
        and d.answers.polled_for is not None
    ):
        return polled(d, "many", None)  # "ask who wants coffee, and tell me how many it is"
    if kind == "total" and d.reports.counted is None and numbers_asked(d):
        return polled(d, "sum", None)  # "ask them how many they need, and tell me the total"
    if d.reports.counted is None:
        d.reports = replace(d.reports, counted=_counting(d, thing))
    elif d.reports.news is not None:
        take_back(
            d, d.reports.news
        )  # "count them in the lobby and the hall and tell me where most are"
    counting, place, things = d.reports.counted
    first, notes, told = _kept(d, kind, counting.name, place, things)
    note(d, counting, notes, first)
    d.reports = replace(d.reports, last=None)
    return Told(told, [])


def numbers_asked(d: Discourse) -> bool:
    """Whether the last that was found out are answers, and nothing was counted."""
    if not asked_yet(d) or d.reports.last is not None or last_round(d) is not None:
        return False
    return d.language.phrase("yes") not in d.answers.surveys[-1].options


def _counting(d: Discourse, thing: Thing | None) -> tuple[Remember, Recall, str]:
    """The step in the last round that counts, now with a name for the number; where the round is;
    what is counted."""
    found = d.reports.last
    for at in range(len(d.done) - 1, -1, -1):
        loop = d.done[at]
        if not isinstance(loop, ForEach):
            continue
        here = Recall(loop.variable)
        if found is not None and found.name == "count" and _holds(loop, d.reports.step):
            assert found.value is not None
            counting = Remember(d.variable("count"), found.value)
            d.done[at] = replacing(loop, d.reports.step, [counting])
            return counting, here, dict(found.words)["things"]
        if thing is not None and loop.steps and goes_to(loop.steps[0], loop.variable):
            counting = Remember(d.variable("count"), Ask("count", {"thing": sought(d, thing)}))
            d.done[at] = structs_replace(loop, steps=(*loop.steps, counting))
            return counting, here, things_called(d, thing)
    raise NotUnderstood(d.language.phrase("count_what"))


def told_after_round(d: Discourse, loop: ForEach) -> Steps:
    """A round, and what was found out in it told behind it."""
    if d.reports.after_round is None:
        return [loop]
    (person, kind) = d.reports.after_round
    d.reports = replace(d.reports, after_round=None)
    if not _holds(
        loop, d.reports.step
    ):  # "..., and if it is missing, bring one": that is done instead
        return [loop]
    if d.reports.last.name == "count":
        d.done.append(loop)
        words, steps = summed_up(d, kind).words, [d.done.pop()]
    else:
        words, steps = _lines(d, loop)
    d.reports = replace(d.reports, last=None, news=News(words, person is None), told=words[-1])
    if person is None or is_me(person):
        return [*steps, *go_back(d, steps), *words]
    return [*steps, *speak_to(d, person, words)]


def found_on_round(d: Discourse, found: Report) -> Told | None:
    """ "go round the labs and tell me if anybody is there": found out at each place of a round that
    does nothing else, and told behind it; None after other steps, and of what is elsewhere."""
    loop = visits_alone(d)
    seen = isinstance(found.value, Ask) and found.about_here and found.place is None
    if loop is None or not seen or found.before:
        return None
    saying = saying_of(d, found)
    d.reports = replace(d.reports, last=found, step=saying)
    loop = structs_replace(loop, steps=(*loop.steps, saying))
    d.done.pop()
    if found.name == "count":
        d.done.append(loop)
        return summed_up(d, "each")
    words, steps = _lines(d, loop)
    d.reports = replace(d.reports, last=None)
    d.done += steps
    return Told(words, [])


def _lines(d: Discourse, loop: ForEach) -> tuple[Steps, Steps]:
    """What was seen at each place of a round: how it is told, and the round with notes of it."""
    found, here = d.reports.last, Recall(loop.variable)
    noted = d.variable("found")
    if found.otherwise is not None:  # "see whether anybody is there": where there is somebody
        notes: Steps = [If(Holds(found.value), (Collect(noted, here),))]
        words = found_places(d, "which", noted, so=Holds(found.value))
    else:
        seen = d.variable(found.name)
        line = Sentence((here, Text(": "), Recall(seen)))
        notes = [Remember(seen, found.value), Collect(noted, line)]
        if found.value in (Ask("people"), Ask("objects")):
            any_there = Compare(Length(Recall(seen)), ">", Number(0))
            notes = [notes[0], If(any_there, (Collect(noted, line),))]
        words = [d.say(found.phrase, **dict(found.words), value=Recall(noted))]
        if found.value in (Ask("people"), Ask("objects")):
            none = d.say("nobody_there" if found.value == Ask("people") else "no_such_places")
            words = [If(Compare(Length(Recall(noted)), "==", Number(0)), (none,), tuple(words))]
    return words, [Remember(noted, Items(())), replacing(loop, d.reports.step, notes)]


def _holds(step: Step, inner: Step | None) -> bool:
    return any(each is inner for each in nodes(step))


def things_called(d: Discourse, thing: Thing) -> str:
    """Several such things, as they are spoken of."""
    noun, _, rest = thing.text.partition(" ") if thing.person else (thing.text, "", "")
    return joined_up(f"{plural(d.called(noun), d.language)} {rest}".strip(), d.language)


def _kept(
    d: Discourse, kind: str, count: str, here: Value, things: str
) -> tuple[Steps, Steps, Steps]:
    """How a round is summed up: what stands before it, what is noted in it, what is told."""
    number = Recall(count)
    if kind == "total":
        total = d.variable("total")
        said = d.say("counted", things=things, value=Recall(total))
        return [Remember(total, Number(0))], [Increase(total, number)], [said]
    if kind == "each":
        counts = d.variable("counts")
        line = Sentence((here, Text(": "), number))
        said = d.say("counted", things=things, value=Recall(counts))
        return [Remember(counts, Items(()))], [Collect(counts, line)], [said]
    best, most = d.variable("best"), d.variable(kind)
    better = Compare(number, ">" if kind == "most" else "<", Recall(most))
    first = Either((Compare(Recall(best), "==", Text("")), better))
    kept = If(first, (Remember(most, number), Remember(best, here)))
    none = d.say("nowhere", things=things)
    phrase = "most_are_at" if kind == "most" else "fewest_are_at"
    some = d.say(phrase, things=things, place=Recall(best), number=Recall(most))
    none_there = Compare(Recall(best), "==", Text(""))
    if kind == "most":
        none_there = Compare(Recall(most), "==", Number(0))
    told = If(none_there, (none,), (some,))
    d.scene = replace(d.scene, place=Recall(best))
    return [Remember(most, Number(0)), Remember(best, Text(""))], [kept], [told]


def best_counted(d: Discourse, most: bool) -> Recall:
    """ "count the people in each lab and go to the one with the most": of the last round."""
    if d.reports.counted is None:
        d.reports = replace(d.reports, counted=_counting(d, None))
    elif d.reports.news is not None:
        take_back(d, d.reports.news)
    counting, place, things = d.reports.counted
    first, notes, _ = _kept(d, "most" if most else "fewest", counting.name, place, things)
    note(d, counting, notes, first)
    d.reports = replace(d.reports, last=None)
    assert isinstance(d.scene.place, Recall)
    return d.scene.place


@meaning("round_count")
def round_count(d: Discourse, node: Node) -> Steps:
    """ "which ward has the most visitors?", "count the people in the lobby and the kitchen"."""
    found, best = counted_around(d, node), d.scene.place
    steps = brought_back(d, node, found)
    if str(node.production.fixed["kind"]) in ("most", "fewest"):  # "go there"
        d.scene = replace(d.scene, place=best)
    return steps


def counted_around(d: Discourse, node: Node) -> Told:
    """Going round for nothing but to count."""
    thing: Thing = d.get(node, "thing")
    return around(d, str(node.production.fixed["kind"]), thing, places_of(d, node))


def around(d: Discourse, kind: str, thing: Thing, places: Value) -> Told:
    place, count = d.variable("place"), d.variable("count")
    first, notes, told = _kept(d, kind, count, Recall(place), things_called(d, thing))
    counting = Remember(count, Ask("count", {"thing": sought(d, thing)}))
    d.reports = replace(d.reports, counted=(counting, Recall(place), things_called(d, thing)))
    d.done += [*first, round_of(d, places, [counting, *notes], place)]
    if thing.person and kind in ("most", "fewest"):  # "which lab has most people? Tell them ..."
        d.scene = replace(
            d.scene,
            person=replace(thing, place=d.scene.place, plural=True, here=False),
            with_person=None,
            thing_last=False,
        )
    return Told(told, [])


# --- which places


@meaning("places_told")
def places_told(d: Discourse, node: Node) -> Told:
    """ "which labs have no stapler", "how many offices are empty", "which of them are"."""
    named = any(name in node.parts for name in ("kinds", "place_list"))
    named = named or bool(node.production.fixed.get("all"))
    if d.round.such is not None and not named and last_round(d) is not None:
        return Told([d.say("it_is_there", place=Recall(d.round.such))], [])
    trait_part = node.parts["place_trait"]
    tell = str(node.production.fixed.get("tell", "which"))
    of_them = "many" if tell == "many" else "who"
    if (
        not named
        and isinstance(trait_part, Node)
        and trait_part.means == "trait_asked"
        and asked_yet(d)
    ):
        # "ask them whether they want coffee and tell me how many of them want coffee"
        return polled(d, of_them, None)
    if tell in ASKED_WHERE and asked_there(d, trait_part):
        return polled(d, ASKED_WHERE[tell], Said(trait_part.start, trait_part.end))
    of_people = tell == "all" or last_round(d) is None
    if not named and of_people and asked_yet(d):
        # "ask them whether they have a key and tell me which ones have none"
        return polled(d, of_them, Said(trait_part.start, trait_part.end))
    if d.reports.news is not None:  # what was checked on the round is told only as is said now
        take_back(d, d.reports.news)
    d.round = replace(d.round, lookout=None)
    at = last_round(d)
    if named and at is None and same_places(d, node, looked_over(d)):
        at = round_of_visits(d)
    elif named and (at is None or not same_places(d, node, d.done[at])):
        at = None
    elif at is None:
        at = round_of_visits(d)
    if not named and at is None:
        sought_for: Trait = d.get(node, "place_trait")
        return told_where(d, None if sought_for.denied else sought_for.thing)
    loop = None if at is None else d.done[at]
    place = loop.variable if isinstance(loop, ForEach) else d.variable("place")
    before = d.scene.at
    d.scene = replace(d.scene, at=Recall(place))
    trait: Trait = d.get(node, "place_trait")
    d.scene = replace(d.scene, at=before)
    found = d.variable("found")
    told_of = trait.condition
    if node.production.fixed.get("as_it_is"):  # "are all labs empty?": where they are not is told
        told_of = negated(told_of)
    others = d.variable("others") if tell == "both" else ""
    rest = (Collect(others, Recall(place)),) if tell == "both" else ()
    noted: Step = If(told_of, (Collect(found, Recall(place)),), rest)
    going: Steps = [Remember(found, Items(()))]
    if at is not None and isinstance(loop, ForEach):
        loop = without_check(d, loop)
        d.done[at] = structs_replace(loop, steps=(*loop.steps, *trait.first, noted))
        d.done.insert(0, going.pop())
        if rest:
            d.done.insert(0, Remember(others, Items(())))
    else:
        if rest:
            going.append(Remember(others, Items(())))
        going.append(round_of(d, places_of(d, node), [*trait.first, noted], place))
    gone_round = loop.items if isinstance(loop, ForEach) else places_of(d, node)
    words = found_places(d, tell, found, gone_round, told_of)
    if rest:
        left = Compare(Length(Recall(others)), ">", Number(0))
        words.append(If(left, (d.say("not_such_places", places=Recall(others)),)))
    return Told(words, going)


def without_check(d: Discourse, loop: ForEach) -> ForEach:
    """A round whose check nobody is told of at each place, for it is told behind the round: "see
    whether there is a stapler in each of them, and tell me where there is none"."""
    found = d.reports.last
    if found is None or found.otherwise is None or not _holds(loop, d.reports.step):
        return loop
    less: ForEach = replacing(loop, d.reports.step, [])
    d.reports = replace(d.reports, last=None)
    return less


def same_places(d: Discourse, node: Node, loop: Step | None) -> bool:
    """Whether the places that are asked about are those that a round went to."""
    if not isinstance(loop, ForEach):
        return False
    if node.production.fixed.get("all") or loop.items == places_of(d, node):
        return True
    kind = d.get(node, "kinds")
    if not isinstance(kind, str) or not isinstance(loop.items, Items):
        return False  # "go to offices 1 to 4 and tell me which offices are empty": of those
    known = [Text(each.name) for each in d.lexicon.place_kinds[kind]]
    return all(each in known for each in loop.items.items)


def found_places(
    d: Discourse,
    tell: str,
    found: str,
    places: Value | None = None,
    so: Condition | None = None,
) -> Steps:
    """What is told of the places that were found, of which it is `so`: "Without a stapler: ..."."""
    number = Length(Recall(found))
    if tell == "share" and places is not None:
        return [d.say("share_of_places", share=Share(number, how_many(places)))]
    if tell == "many":
        return [d.say("so_many_places", number=number)]
    none, told = d.say("no_such_places"), d.say("such_places", places=Recall(found))
    what = found_with(d, so)
    if what is not None:
        none = d.say("no_places_with", what=what)
        told = d.say("places_with", what=what, places=Recall(found))
    if tell == "any":
        none, told = d.say("no_none"), d.say("yes_these", places=Recall(found))
    elif tell == "all":
        none, told = d.say("yes_all"), d.say("no_not_these", places=Recall(found))
    return [If(Compare(number, "==", Number(0)), (none,), (told,))]


def found_with(d: Discourse, so: Condition | None) -> str | None:
    """What was looked for, as a heading: "Without a stapler"; None if that is more than a thing."""
    without = isinstance(so, Not)
    match so.condition if isinstance(so, Not) else so:
        case Holds(value=Ask(method="sees", arguments={"thing": Text(value=thing)})):
            if thing == ANYONE:
                return d.language.phrase("with_nobody" if without else "with_people")
            if thing.startswith(f"{ANYONE} "):
                return None  # "somebody asleep" is no heading
            called = d.called(thing)
            name = "without_thing" if without else "with_thing"
            articles = d.language.speech.get("headed_with_articles")
            return d.language.phrase(name, thing=some(called, d.language) if articles else called)
    return None


def how_many(places: Value) -> Value:
    return Number(len(places.items)) if isinstance(places, Items) else Length(places)


@meaning("compared")
def compared(d: Discourse, node: Node) -> Steps:
    """ "are there more people in the lobby than in the kitchen?"."""
    thing: Thing = d.get(node, "thing")
    left, right = d.get(node, "place"), d.get(node, "other")
    counting = Ask("count", {"thing": sought(d, thing)})
    steps: Steps = []
    counts: list[Value] = []
    for each in (left, right):
        if not isinstance(each, Text | Recall):
            raise NotUnderstood(d.language.phrase("which_places"))
        name = d.variable("count")
        steps += [Call("goto", {"place": each}), Remember(name, counting)]
        counts.append(Recall(name))
    operator = str(node.production.fixed.get("operator") or d.get(node, "operator"))
    called = [d.called(each.value) if isinstance(each, Text) else each for each in (left, right)]
    number = d.sentence(
        "two_counts", left=called[0], right=called[1], first=counts[0], second=counts[1]
    )
    yes, no = (d.say(phrase, counts=number) for phrase in ("yes_so", "no_so"))
    told = If(Compare(counts[0], operator, counts[1]), (yes,), (no,))
    return brought_back(d, node, Told([told], steps))


@meaning("nth_place")
def nth_place(d: Discourse, node: Node) -> Value:
    """ "the first lab", "the last office": in the order in which the world lists them."""
    places = d.lexicon.place_kinds[d.get(node, "kind")]
    number = int(d.get(node, "number"))
    leaf = node.parts["number"]
    assert isinstance(leaf, Leaf)
    if abs(number) > len(places):
        words = d.words(node.start, node.end)
        raise NotUnderstood(
            d.language.phrase("unknown_place", name=words),
            tuple(each.name for each in places[:3]),
            (node.start, node.end),
        )
    place = Text(places[number - 1 if number > 0 else number].name)
    d.scene = replace(d.scene, place=place)
    return place
