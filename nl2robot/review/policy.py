"""What a program must not do on this robot in this world, told before it runs.

The type check (`sandbox.check`) knows the methods; this module knows the robot and the hospital:
names of places and contacts, the emotions and joints this robot has, and what it lacks. It looks at
the calls that are written with fixed values; what a program works out while it runs, the driver
checks then.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from typing import Any

from nl2robot.knowledge import Knowledge
from robot_api.limits import complaint
from robot_api.methods import METHODS, Method
from robot_api.schema import compiled, wrong_value
from sandbox.check import Finding


def violations(program: str, knowledge: Knowledge) -> list[Finding]:
    """What this robot cannot do or this world does not have, in order of lines.

    A program that is no Python gives none: the check says that.
    """
    try:
        tree = ast.parse(program)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return []
    found: list[Finding] = []
    for call, method, arguments in robot_calls(tree):
        for code, message in _complaints(method, arguments, knowledge):
            found.append(
                Finding(
                    line=call.lineno,
                    column=call.col_offset + 1,
                    severity="error",
                    code=code,
                    message=message,
                )
            )
    return sorted(found, key=lambda finding: (finding.line, finding.column))


def robot_calls(tree: ast.AST) -> Iterator[tuple[ast.Call, Method, dict[str, Any]]]:
    """Each call of a known robot method, with those of its arguments that are fixed values."""
    for node in ast.walk(tree):
        if (
            isinstance(node, ast.Call)
            and isinstance(node.func, ast.Attribute)
            and isinstance(node.func.value, ast.Name)
            and node.func.value.id == "robot"
            and node.func.attr in METHODS
        ):
            method = METHODS[node.func.attr]
            names = [parameter.name for parameter in _form(method, len(node.args))]
            given = dict(zip(names, node.args, strict=False))
            given |= {keyword.arg: keyword.value for keyword in node.keywords if keyword.arg}
            yield (
                node,
                method,
                {name: v for name, n in given.items() if (v := _fixed(n)) is not ...},
            )


def _form(method: Method, positional: int) -> tuple[Any, ...]:
    fitting = [form for form in method.forms if positional <= len(form)]
    return fitting[0] if fitting else method.forms[0]


def _fixed(node: ast.expr) -> Any:
    try:
        return ast.literal_eval(node)
    except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
        return ...


def _complaints(
    method: Method, arguments: dict[str, Any], knowledge: Knowledge
) -> Iterator[tuple[str, str]]:
    robot = knowledge.capabilities
    if robot is not None and method.name not in robot.methods:
        yield (
            "not-supported",
            f"{robot.name} cannot do this: {_lower(method.doc)} Leave it out or use another robot.",
        )
        return
    yield from _values_out_of_range(method, arguments)
    if robot is not None and method.name in _NAMED:
        what, parameter, known = _NAMED[method.name]
        name, names = arguments.get(parameter), list(getattr(robot, known))
        if isinstance(name, str) and name not in names:
            yield f"unknown-{what}", _unknown(what, name, names)
    for parameter in ("place", "to"):
        name = arguments.get(parameter)
        if isinstance(name, str) and knowledge.world.place(name) is None:
            yield "unknown-place", _unknown("place", name, [p.name for p in knowledge.world.places])
    beyond = complaint(method.name, arguments, robot) if robot is not None else None
    if beyond is not None:
        yield "out-of-range", beyond


_NAMED = {
    "emotion": ("emotion", "name", "emotions"),
    "gesture": ("gesture", "name", "gestures"),
    "joint": ("joint", "name", "joints"),
    "call": ("contact", "contact", "contacts"),
    "do": ("skill", "skill", "skills"),
    "set_language": ("language", "code", "languages"),
}
"""Methods with a parameter that must be one of a list that the robot declares: what it is called,
the parameter, and the field of `Capabilities`."""


def _values_out_of_range(method: Method, arguments: dict[str, Any]) -> Iterator[tuple[str, str]]:
    for parameter in {p.name: p for form in method.forms for p in form}.values():
        if parameter.name in arguments:
            value = arguments[parameter.name]
            if not compiled(parameter.kind.schema).is_valid(value):
                yield "bad-value", wrong_value(method, parameter, value)


def _lower(doc: str) -> str:
    return doc[0].lower() + doc[1:]


def _unknown(what: str, name: str, known: list[str]) -> str:
    from rapidfuzz import process, utils

    near = process.extract(name, known, processor=utils.default_process, limit=3, score_cutoff=60)
    if near:
        return f'There is no {what} "{name}". Did you mean {_or([text for text, *_ in near])}?'
    if known and len(known) <= 12:
        return f'There is no {what} "{name}". It can be {_or(known)}.'
    return f'There is no {what} "{name}" here.'


def _or(names: list[str]) -> str:
    return " or ".join([", ".join(names[:-1]), names[-1]] if len(names) > 1 else names)
