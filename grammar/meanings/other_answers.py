"""What is done for another answer, though it goes on in the same sentence: "when they say yes,
thank them, if they say no, remind them"."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Node, what_it_means
from grammar.meanings.conditions import ABOUT_ANSWERS
from grammar.meanings.deliveries import inside

ASKING = frozenset({"ask", "ask_again", "ask_more", "ask_on", "ask_topic"})


def other_answer(node: Node) -> tuple[Node, Node] | None:
    """A branch on an answer without the further ones that it cannot have in it, and these; None
    where there are none, or where they may be on what is asked in the branch itself."""
    then = node.parts.get("then")
    if not isinstance(then, Node) or what_it_means(node.parts["condition"]) not in ABOUT_ANSWERS:
        return None
    parted = _parted(then)
    if parted is None:
        return None
    own, others = parted
    return replace(node, parts={**node.parts, "then": own}), others


def _parted(steps: Node) -> tuple[Node, Node] | None:
    """Steps up to one that hangs on an answer, and those from it on."""
    first, rest = steps.parts.get("first"), steps.parts.get("rest")
    if not isinstance(first, Node) or not isinstance(rest, Node):
        return None
    if any(each.means in ASKING for each in inside(first)):
        return None
    following = rest.parts.get("first", rest)
    on_answer = isinstance(following, Node) and what_it_means(following) == "if"
    if on_answer and isinstance(following, Node):
        condition = _condition(following)
        if condition is not None and what_it_means(condition) in ABOUT_ANSWERS:
            return replace(steps, parts={"first": first}, end=first.end), rest
        return None
    parted = _parted(rest)
    if parted is None:
        return None
    own, others = parted
    return replace(steps, parts={**steps.parts, "rest": own}, end=own.end), others


def _condition(branch: Node) -> Node | None:
    """What a branch hangs on, which may stand for another part."""
    found = next(each.parts["condition"] for each in inside(branch) if "condition" in each.parts)
    return found if isinstance(found, Node) else None
