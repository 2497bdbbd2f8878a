"""Telling where somebody or something is that was looked for: "find Bob and let me know", "find out
where Alice is and tell Bob"."""

from __future__ import annotations

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.meanings.news import BACK
from grammar.meanings.reports import found_for
from grammar.meanings.sights import located
from grammar.plan import Ask, Call, If, Remember


def asks_where(node: Node) -> bool:
    """Whether nothing is to be told but where something is: "find Bob and tell me where he is"; or
    nothing is said of what is to be told: "find Bob and let me know"."""
    told = node.parts.get("told")
    if told is None:
        return "back" not in node.parts
    first = told.parts.get("first") if isinstance(told, Node) else None
    only = isinstance(told, Node) and told.parts.keys() == {"first"}
    return (
        only
        and isinstance(first, Node)
        and first.means == "lookout_told"
        and (first.production.fixed["tell"] == "which")
    )


def searched_last(d: Discourse, node: Node, whom: str) -> Thing | None:
    """What the last step looks for, if nothing else was found out: "find Bob and let me know", but
    not "and tell me the answer"."""
    last = d.done[-1] if d.done else None
    told_to = node.parts.get(whom)
    told = node.parts.get("told")
    if told is None and told_to is not None and told_to.end < node.end - 1:
        return None
    known = (d.reports.last, d.answers.last, d.answers.code, d.branch.claim, d.reports.news)
    if not (isinstance(last, Call) and last.method == "find") or any(each for each in known):
        return None
    return d.scene.thing if d.scene.thing_last else d.scene.person


def where_it_is(d: Discourse, sought: Thing, person: Thing | None) -> Steps:
    return found_for(d, person, located(d, sought))


def told_to_sent(d: Discourse, sought: Thing, person: Thing) -> Steps:
    """ "find Alice, then go to Bob and tell him": where she is."""
    return told_where(d, person) or where_it_is(d, sought, person)


def told_where(d: Discourse, person: Thing | None) -> Steps | None:
    """ "find out where Alice is and tell Bob": the end of a search that would have told the speaker
    (`grammar.meanings.sights.located`); None if the last step is no such search."""
    match d.done[-1:]:
        case [If(then=(Remember(value=Ask(method="location")), back, Call(method="say")))]:
            return found_for(d, person, [d.done.pop()]) if back == BACK else None
        case _:
            return None
