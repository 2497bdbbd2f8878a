"""How clauses follow each other."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps
from grammar.errors import NotUnderstood
from grammar.meanings.alternatives import done_first, exclusive, for_all, itself, side_by_side
from grammar.meanings.branches import in_branch
from grammar.meanings.finding import go
from grammar.meanings.found_places import if_such
from grammar.meanings.going_on import in_round
from grammar.meanings.guards import guard_finds
from grammar.meanings.in_time import note_waiting
from grammar.meanings.inquiries import owed, wonder_told
from grammar.meanings.lookouts import told_at_last, why, why_only
from grammar.meanings.orders_to_tell import summed_at_end
from grammar.meanings.registry import meaning
from grammar.meanings.stops import gone_to, looked_at_each, said_at_each, said_on_tour
from grammar.meanings.things import goes_on
from grammar.meanings.visiting import with_each_asked
from grammar.meanings.volunteers import guard_found
from grammar.meanings.waiting import until_then
from grammar.plan import (
    Ask,
    Call,
    Items,
    Recall,
    Step,
    Value,
)
from grammar.tidy import mentions, nodes

WAYS: Final = frozenset({"goto", "find", "location"})
"""Methods that only lead to where something is done."""
SAID: Final = frozenset({"statement", "remark", "remark_name", "remark_where"})
"""Clauses that say how something is, and ask for nothing."""


@meaning("steps")
def steps(d: Discourse, node: Node) -> Steps:
    """Clauses one after the other: `first`, then `rest`."""

    def make() -> None:
        later: Steps = []
        alongside: set[int] = set()
        each: Node | None = node
        further: list[Node] = []
        joint = "stop"
        places: Items | None = None
        while each is not None:
            each = done_first(for_all(d, each))
            before = len(d.done)
            d.begins.append(before)
            scene = d.scene
            first = each.parts["first"]
            assert isinstance(first, Node)
            relative = d.tokens[first.start].norm in d.language.speech.get("relative", ())
            if relative and goes_on(
                d, first.start
            ):  # "is anyone there | who needs help": one clause
                words = d.words(first.start, first.end)
                raise NotUnderstood(d.language.phrase("not_understood", part=words))
            first = itself(first)
            if first.production.means == "reversed" and in_order(first):
                further += [part for part in (each.parts.get("rest"),) if isinstance(part, Node)]
                further.append(chained(first.parts["later"]))
                each = chained(first.parts["earlier"])
                continue
            if first.production.means == "once_done" and "later" not in first.parts:
                following = chained(each.parts["rest"])
                only_once_done(d, first)
                if done_already(d, first):
                    each = following
                else:
                    further.append(following)
                    each = chained(first.parts["earlier"])
                continue
            first, beside = side_by_side(d, first)
            looked_at_each(d, places, first)
            rest = each.parts.get("rest")
            if isinstance(rest, Node) and why_only(first, rest):
                why(d, first)
                each = rest
                continue
            d.done.extend(in_branch(d, first) or with_each_asked(d, first) or in_round(d, first))
            note_waiting(d)
            said_on_tour(d, before, scene)
            new = d.done[before:]
            places = gone_to(d, first, new) or said_at_each(d, places, new)
            if joint == "then" or first.start not in alongside:
                later += new[:1]
            joint = str(each.production.fixed.get("joint", "and"))
            rest, beyond = each.parts.get("rest"), each.parts.get("further")
            if isinstance(rest, Node) and plainly_joined(d, first.end, rest):
                alongside.add(rest.start)
            if beside is not None:
                further += [part for part in (beyond, rest) if isinstance(part, Node)]
                rest, beyond = beside, None
            if isinstance(beyond, Node):  # after the rest
                further.append(beyond)
            each = rest if isinstance(rest, Node) else further.pop() if further else None
        d.done[:] = if_such(d, until_then(d, d.done, later))
        if d.depth > 1 and not d.done and only_said(node):
            # "make sure there is a cup in each office": nothing is done there, so it was no remark.
            words = d.words(node.start, node.end)
            raise NotUnderstood(d.language.phrase("not_understood", part=words))
        if d.depth == 1:
            d.done.extend(summed_at_end(d) or owed(d))
            d.done.extend(wonder_told(d))
        d.done.extend(told_at_last(d))
        d.done[:] = exclusive(guard_finds(d, guard_found(speak_codes(d, d.done))))

    return d.sequence(make)


def plainly_joined(d: Discourse, end: int, rest: Node) -> bool:
    """Whether nothing but "and", or a mark, stands between two clauses, the first of which ends
    there, and nothing in the second says that it comes after."""
    after = {*d.language.speech.get("text_ends", ())}
    between = {token.norm for token in d.tokens[end : rest.start] if token.kind != "mark"}
    said = {token.norm for token in d.tokens[rest.start : chained(rest.parts["first"]).end]}
    return between <= d.language.words_called("joins") and after.isdisjoint(between | said)


def in_order(clause: Node) -> bool:
    """Whether what is done first was also said first: "after greeting her, ask ...", so that the
    two are as one sequence."""
    return clause.parts["earlier"].start < clause.parts["later"].start


def only_said(sequence: Node) -> bool:
    """Whether a sequence does nothing but say how something is."""
    first = itself(chained(sequence.parts["first"]))
    return "rest" not in sequence.parts and first.production.means in SAID


def chained(part: Leaf | Node) -> Node:
    """The sequence that a part is."""
    assert isinstance(part, Node)
    return part


def speak_codes(d: Discourse, done: Steps) -> Steps:
    """A code that is scanned for nothing else is read out."""
    result: Steps = []
    for number, step in enumerate(done):
        result.append(step)
        if isinstance(step, Call) and step.method == "scan" and step.save_as:
            code = Recall(step.save_as)
            if not mentions(done[number + 1 :], code):
                result.append(d.say("code_is", value=code))
    return result


def done_already(d: Discourse, node: Node) -> bool:
    """Whether what is said to come first has been said before: "Greet Bob. When you have greeted
    him, come back." is no second greeting."""
    if node.production.means != "once_done" or not d.done:
        return False
    again = d.tried(node.parts["earlier"])
    named = [each for each in nodes(tuple(again)) if isinstance(each, Call)]
    calls = [each for each in named if each.method not in WAYS] or named
    before = [_deed(each) for each in nodes(tuple(d.done)) if isinstance(each, Call)]
    return bool(calls) and all(_deed(each) in before for each in calls)


def only_once_done(d: Discourse, node: Node) -> None:
    """Refuse "when you greet her" where only "when you have greeted her" tells what is done first,
    in a language whose rules do not part the two."""
    earlier = node.parts["earlier"]
    if not node.production.fixed.get("perfect"):
        return
    begin = max(earlier.start - 1, 0)
    said = {token.norm for token in d.tokens[begin : earlier.end]}
    if said.isdisjoint(d.language.speech["perfect_words"]):
        words = d.words(earlier.start, earlier.end)
        raise NotUnderstood(d.language.phrase("cannot_check", what=words))


def _deed(call: Call) -> tuple[str, Any]:
    """What tells a call from others, whoever is asked."""
    asked = call.arguments.get("question") if call.method == "ask" else None
    return call.method, asked or call.arguments


@meaning("once_done")
@meaning("reversed")
def reversed_(d: Discourse, node: Node) -> Steps:
    """ "before you go, say goodbye" and "go after you have said goodbye"."""
    earlier, later = node.parts["earlier"], node.parts["later"]
    only_once_done(d, node)
    if (
        later.start < earlier.start and d.scene.thing is None
    ):  # "put the cup here after you wash it"
        before = d.scene
        d.sequence(lambda: d.done.extend(d.build(later)))
        d.scene = before.with_it_of(d.scene)
    at = len(d.done)
    if not done_already(d, node):
        d.done.extend(d.build(earlier))
    said = len(d.done)
    for part in clauses(later):  # each may take back what was done before it
        d.done.extend(d.build(part))
    if later.start < earlier.start:
        found_before(d, at, said)
    result = d.done[at:]
    del d.done[at:]
    return result


def found_before(d: Discourse, at: int, said: int) -> None:
    """Whoever is somewhere is found there before anything is said to them first: "take the visitor
    in the lobby to the lift, but ask her name first". `at`, `said`: where among the steps begin
    what is done first, and the rest."""
    first, rest = d.done[at:said], d.done[said:]
    search = rest[0] if rest else None
    sought = isinstance(search, Call) and search.method == "find" and "place" in search.arguments
    done = {each.method for each in nodes(tuple(first)) if isinstance(each, Call | Ask)}
    if sought and done & {"say", "ask"} and "find" not in done:
        d.done[at:] = [*rest[:1], *first, *rest[1:]]


def clauses(part: Leaf | Node) -> list[Leaf | Node]:
    """The first clause of several, and the rest."""
    if not isinstance(part, Node) or part.means != "steps":
        return [part]
    return [part.parts[name] for name in ("first", "rest") if name in part.parts]


@meaning("corrected")
def corrected(d: Discourse, node: Node) -> Steps:
    """ "go to the kitchen, no, the lobby": only what stands last counts."""
    result: Steps = d.build(node.parts["second"])
    return result


@meaning("on_the_way")
def on_the_way(d: Discourse, node: Node) -> Steps:
    """ "go to the kitchen; on the way stop at the reception": that comes first."""
    target: Value | None = d.get(node, "place")
    if node.production.fixed.get("back"):
        target = d.start()
    last = d.done[-1] if d.done else None
    if target is not None:
        going: Step = Call("goto", {"place": target})
    elif isinstance(last, Call) and last.method in ("goto", "guide"):
        going = d.done.pop()
        target = last.arguments.get("place")
    else:
        raise NotUnderstood(d.language.phrase("where_is_there"))
    d.scene = replace(d.scene, at=None)
    stops: Steps = d.build(node.parts["steps"])
    if "more" in node.parts:  # "stop by Bob's office on the way to the lobby and say hello"
        stops = [*stops, *d.build(node.parts["more"])]
    if isinstance(going, Call) and going.method == "guide":
        stops = [_guided(each, going) for each in stops]
    d.scene = d.scene.arrived(target)
    return [*stops, going]


def _guided(step: Step, guiding: Call) -> Step:
    """A stop on the way, for somebody who is led past it."""
    if isinstance(step, Call) and step.method == "goto" and "place" in step.arguments:
        place = step.arguments["place"]
        return Call("guide", {"person": guiding.arguments["person"], "place": place})
    return step


@meaning("being_there")
def being_there(d: Discourse, node: Node) -> Steps:
    """ "while you are at the pharmacy, ...": go there, unless that is where the robot is."""
    return [*go(d, d.get(node, "place")), *d.build(node.parts["steps"])]


@meaning("refused_part")
def refused_part(d: Discourse, node: Node) -> Steps:
    """A clause that no program can do as it was meant: refused with its words."""
    words = d.words(node.start, node.end)
    phrase = str(node.production.fixed["phrase"])
    raise NotUnderstood(d.language.phrase(phrase, part=words), gap=(node.start, node.end))
