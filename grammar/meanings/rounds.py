"""Going round places and reporting: how many in each, altogether, most where, which are empty."""

from __future__ import annotations

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, NotUnderstood, Steps, Thing
from grammar.meanings.finding import speak_to
from grammar.meanings.nouns import is_me, kind_places, sought
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import go_back, note
from grammar.naming import joined_up
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
    Step,
    Text,
    Value,
)
from grammar.wordforms import plural


def places_of(d: Discourse, node: Node) -> Value:
    """The places that are gone round: all of a kind, or those listed."""
    listed: list[Value] | None = d.get(node, "place_list")
    if listed:
        return Items((d.get(node, "place"), *listed))
    return kind_places(d, d.get(node, "kinds"))


def round_of(d: Discourse, places: Value, what: Steps, place: str) -> Step:
    """Go to each place and do something there."""
    going = Call("goto", {"place": Recall(place)})
    return ForEach(place, places, (going, *what))


def brought_back(d: Discourse, node: Node, before: Steps, told: Steps) -> Steps:
    """The report, told to who asked for it, or to somebody else."""
    person: Thing | None = d.get(node, "whom")
    if person is not None and not is_me(person):
        d.at = None
        return [*before, *speak_to(d, person, told)]
    start = d.start()
    d.went(start)
    d.told = told[-1]
    return [*before, Call("goto", {"place": start}), *told]


@meaning("round_report")
def round_report(d: Discourse, node: Node) -> Steps:
    """ "go to every ward and count the patients, then tell me the total"."""
    loop = d.done[-1] if d.done else None
    found = d.report
    if found is not None and not isinstance(loop, ForEach):
        from grammar.meanings.reports import told_again

        return told_again(d, d.get(node, "whom"))
    if found is None or not isinstance(loop, ForEach) or found.name != "count":
        raise NotUnderstood(d.language.phrase("count_what"))
    assert found.value is not None
    count = d.variable("count")
    kind = str(node.production.fixed["kind"])
    here = Recall(loop.variable)
    first, notes, told = _kept(d, kind, count, here, dict(found.words)["things"])
    body = [
        each
        for step in loop.steps
        for each in ([Remember(count, found.value), *notes] if step is d.report_step else [step])
    ]
    d.done[-1:] = [ForEach(loop.variable, loop.items, tuple(body))]
    note(d, Call("", {}), [], first)
    d.report = None
    person: Thing | None = d.get(node, "whom")
    going = go_back(d) if person is None or is_me(person) else []
    return [*going, *speak_to(d, person, told)]


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
    first: Condition = better
    if kind != "most":
        first = Either((Compare(Recall(best), "==", Text("")), better))
    kept = If(first, (Remember(most, number), Remember(best, here)))
    none = d.say("nowhere", things=things)
    phrase = "most_are_at" if kind == "most" else "fewest_are_at"
    some = d.say(phrase, things=things, place=Recall(best), number=Recall(most))
    told = If(Compare(Recall(best), "==", Text("")), (none,), (some,))
    return [Remember(most, Number(0)), Remember(best, Text(""))], [kept], [told]


@meaning("round_count")
def round_count(d: Discourse, node: Node) -> Steps:
    """ "which ward has the most visitors?", "count the people in the lobby and the kitchen"."""
    thing: Thing = d.get(node, "thing")
    places = places_of(d, node)
    noun, _, rest = thing.text.partition(" ") if thing.person else (thing.text, "", "")
    things = joined_up(f"{plural(d.called(noun), d.language)} {rest}".strip(), d.language)
    place, count = d.variable("place"), d.variable("count")
    kind = str(node.production.fixed["kind"])
    first, notes, told = _kept(d, kind, count, Recall(place), things)
    counting = Remember(count, Ask("count", {"thing": sought(d, thing)}))
    return brought_back(d, node, [*first, round_of(d, places, [counting, *notes], place)], told)


@meaning("round_look")
def round_look(d: Discourse, node: Node) -> Steps:
    """ "which offices are empty?", "tell me which wards have visitors"."""
    thing: Thing | None = d.get(node, "thing") or d.get(node, "person_ref")
    looked_for = Text(ANYONE) if thing is None else thing.value
    found, place = d.variable("found"), d.variable("place")
    seen: Condition = Holds(Ask("sees", {"thing": looked_for}))
    if node.production.fixed.get("no"):
        seen = Not(seen)
    looking = If(seen, (Collect(found, Recall(place)),))
    none = d.say("no_such_places")
    some = d.say("such_places", places=Recall(found))
    told = If(Compare(Length(Recall(found)), "==", Number(0)), (none,), (some,))
    going: Steps = [Remember(found, Items(())), round_of(d, places_of(d, node), [looking], place)]
    return brought_back(d, node, going, [told])


@meaning("compared")
def compared(d: Discourse, node: Node) -> Steps:
    """ "are there more people in the lobby than in the kitchen?"."""
    thing: Thing = d.get(node, "thing")
    left, right = d.get(node, "place"), d.get(node, "other")
    counting = Ask("count", {"thing": sought(d, thing)})
    steps: Steps = []
    counts: list[Value] = []
    for each in (left, right):
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
    return brought_back(d, node, steps, [told])


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
    d.place = Text(places[number - 1 if number > 0 else number].name)
    return d.place
