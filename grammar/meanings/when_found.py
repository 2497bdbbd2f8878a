"""What is done once something is found: "look for a free room. When you find one, take the visitor
there"."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node
from grammar.discourse import ANYONE, Branched, Discourse, Meeting, Steps, Thing
from grammar.meanings.branches import if_found_so
from grammar.meanings.found_places import first_of_round
from grammar.meanings.guards import in_vain
from grammar.meanings.registry import meaning
from grammar.meanings.searches import search_of
from grammar.meanings.volunteers import found_by
from grammar.meanings.waiting import wait_until
from grammar.plan import Ask, Call, Holds, If, Text


@meaning("when_found")
def when_found(d: Discourse, node: Node) -> Steps:
    """ "when you find one, ...": after a search it is done with whoever was found."""
    if d.round.stop is not None:  # at each place where it is so
        there: Steps = d.build(node.parts["then"])
        return there
    last = d.done[-1] if d.done else None
    search = search_of(last)
    if search is None and found_by(last) is None:
        if first_of_round(d):  # "check which room is free. When you have found one, ..."
            done: Steps = d.build(node.parts["then"])
            return done
        return waited_for(d, node)
    if search is not None and d.scene.thing_last and d.scene.thing is not None:
        d.scene = replace(d.scene, thing=replace(d.scene.thing, here=True, place=None))
    if search is not None and "otherwise" in node.parts:
        return if_found_so(d, node, search)
    start = d.scene
    then: Steps = d.build(node.parts["then"])
    takes = bool(then) and isinstance(then[0], Call) and then[0].method == "grab"
    if search is None or not isinstance(last, If):
        return then
    d.done.pop()
    missing = in_vain(search, then) if takes else tuple(search.missing)
    whole = If(search.found, tuple(then), missing)
    if d.scene.thing is not None and d.scene.thing_last:
        met = Meeting(replace(d.scene.thing, here=False, pronoun=False), sought=True)
        d.branch = replace(d.branch, before=Branched(whole, start, met, d.answers.last))
    return [whole]


def waited_for(d: Discourse, node: Node) -> Steps:
    """ "when you find somebody, ...": they are looked for until somebody is found."""
    looking = wait_until(Holds(Ask("find", {"thing": Text(ANYONE)})))
    d.scene = d.scene.speaking_of_person(Thing(Text(ANYONE), person=True, here=True))
    return [*looking, *d.build(node.parts["then"])]
