"""An answer that says how often something is done: only a number will do, so that numbers are what
the question offers."""

from __future__ import annotations

from typing import Any, Final

import msgspec

from grammar.plan import Call, Items, Node, Plan, Recall, Repeat, Text
from grammar.tidy import nodes

MOST: Final = 19
"""Up to this number there are as many options as a question may have; nobody has more carried."""
NUMBERS: Final = Items(tuple(Text(str(number)) for number in range(MOST + 1)))


def with_numbers(plan: Plan) -> Plan:
    """The plan with numbers to choose from where an answer is counted by."""
    counted = {
        each.times.name
        for each in nodes(plan.steps)
        if isinstance(each, Repeat) and isinstance(each.times, Recall)
    }
    return msgspec.structs.replace(plan, steps=_offered(plan.steps, counted))


def _offered(node: Any, counted: set[str]) -> Any:
    if isinstance(node, tuple):
        return tuple(_offered(each, counted) for each in node)
    if not isinstance(node, Node):
        return node
    if isinstance(node, Call):
        if node.method == "ask" and node.save_as in counted and "options" not in node.arguments:
            arguments = {**node.arguments, "options": NUMBERS}
            return msgspec.structs.replace(node, arguments=arguments)
        return node
    inner = {name: _offered(getattr(node, name), counted) for name in node.__struct_fields__}
    return msgspec.structs.replace(node, **inner)
