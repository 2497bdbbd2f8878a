"""The other case of a condition, where it was read as the last clause of the first.

"If you find it, bring it, if not, tell me"; "if she comes, greet her, but if she does not, look for
her".
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse
from grammar.meanings.claims import TELL
from grammar.meanings.deliveries import inside

PRESENCE: Final = frozenset({"is_seen", "is_found", "is_awaited"})
"""Conditions that somebody or something is there, or with `no` that they are not."""
PRONOUNS: Final = frozenset({"person_pronoun", "thing_it"})
LEAVING: Final = frozenset({"go", "come_back", "guide", "wait", "follow", "dock"})
"""After these it is another moment or place of which it is asked whether somebody is there."""


def with_else(d: Discourse, node: Node) -> Node:
    """A condition with the clause that says its opposite as its other branch. After a question in
    between, "if not" would be about the answer."""
    chain: list[Node] = []
    each: Leaf | Node | None = node.parts["then"]
    while isinstance(each, Node) and each.means == "steps":
        chain.append(each)
        each = each.parts.get("rest")
    if len(chain) < 2 or any(name.startswith("otherwise") for name in node.parts):
        return node
    *kept, last = chain
    clause = unwrapped(last.parts["first"])
    condition = unwrapped(clause.parts.get("condition")) if clause is not None else None
    if clause is None or condition is None or clause.production.means not in ("if", TELL, "when"):
        return node
    meant = {part.production.means for one in kept for part in inside(one.parts["first"])} - {None}
    asked = any(str(means).startswith("ask") for means in meant)
    denied = condition.means == "so" and condition.production.fixed.get("no") and not asked
    opposed = not meant & LEAVING and opposite(d, unwrapped(node.parts["condition"]), condition)
    if not denied and not opposed:
        return node
    then: Node | None = None
    for one in reversed(kept):
        parts = {name: part for name, part in one.parts.items() if name != "rest"}
        then = replace(one, parts=parts if then is None else {**parts, "rest": then})
    said = {name: part for name, part in clause.parts.items() if name != "condition"}
    other = replace(clause, parts=said) if clause.production.means == TELL else said.pop("then")
    further = {name: part for name, part in said.items() if name.startswith("otherwise")}
    if then is None or further:
        return node
    return replace(node, parts={**node.parts, "then": then, "otherwise": other})


def opposite(d: Discourse, one: Node | None, other: Node) -> bool:
    """Whether of two conditions one says that somebody is there, and the other that they are not:
    "if she comes ..., if she has not come by then ..."."""
    if one is None or {one.means, other.means} - PRESENCE:
        return False
    if bool(one.production.fixed.get("no")) == bool(other.production.fixed.get("no")):
        return False
    first, second = (each.parts.get("person_ref", each.parts.get("thing")) for each in (one, other))
    if not isinstance(first, Node) or not isinstance(second, Node):
        return False
    same = d.norms(first.start, first.end) == d.norms(second.start, second.end)
    return same or bool({each.production.means for each in inside(second)} & PRONOUNS)


def unwrapped(part: Leaf | Node | None) -> Node | None:
    """The node that a part stands for; None for a slot."""
    while isinstance(part, Node) and part.production.means is None and len(part.parts) == 1:
        (part,) = part.parts.values()
    return part if isinstance(part, Node) else None
