"""What a standing order is made of: what happens, and how often at most."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse
from grammar.errors import NotUnderstood
from grammar.meanings.registry import meaning
from grammar.meanings.requests import request
from grammar.plan import Text
from grammar.requests import Request
from grammar.standing_orders.happenings import Happening

FULL: Final = 100
"""Percent."""


@meaning("standing_order")
def standing_order(d: Discourse, node: Node) -> Request:
    happening: Happening = d.build(node.parts["event"])
    rate = node.parts.get("rate")
    happening = replace(
        happening,
        rate=d.build(rate) if rate is not None else None,
        once=bool(node.production.fixed.get("once")),
    )
    event = node.parts["event"]
    asked = request(d, node, "schedule")
    return replace(asked, part=d.words(event.start, event.end), happening=happening)


@meaning("standing_event")
def standing_event(d: Discourse, node: Node) -> Happening:
    """Raises `NotUnderstood` for what can never happen."""
    fixed = node.production.fixed
    who, place = node.parts.get("who"), node.parts.get("place")
    thing, named = d.build(who) if who is not None else ("", False)
    at = d.build(place) if place is not None else None
    percent = d.get(node, "percent")
    below = round(float(percent.value if hasattr(percent, "value") else percent or 0))
    if fixed["what"] == "battery" and not 0 < below < FULL:
        raise NotUnderstood(d.language.phrase("not_understood_at_all"))
    return Happening(
        fixed["what"],
        text=_text(d, node),
        thing=thing if fixed["what"] == "seen" else "",
        place=at.value if isinstance(at, Text) else "",
        below=below,
        named=named,
    )


@meaning("standing_who")
def standing_who(d: Discourse, node: Node) -> tuple[str, bool]:
    """Whom to look for, and whether that is a name."""
    name = node.parts.get("name")
    if isinstance(name, Leaf):
        return d.one_of(name).name, True
    kind = d.get(node, "kind", ANYONE)
    return str(kind), False


@meaning("standing_rate")
def standing_rate(d: Discourse, node: Node) -> float:
    """Seconds."""
    return float(d.build(node.parts["pace"]))


def _text(d: Discourse, node: Node) -> str:
    """The words that matter, as they were said; the name of a button with its noun."""
    part = node.parts.get("text")
    if part is None:
        return ""
    if part.end == part.start + 1 and d.tokens[part.start].kind == "quote":
        return d.tokens[part.start].inner
    said = d.words(part.start, part.end).strip(" ,.")
    label = node.production.fixed.get("label")
    if label is None:
        return said
    ending = node.production.fixed.get("as")
    if ending and said.islower():  # "den roten Knopf" is called "Roter Knopf"
        said = said.removesuffix("en").removesuffix("er").removesuffix("e") + str(ending)
    told = str(label).format(name=said)
    return told[:1].upper() + told[1:]
