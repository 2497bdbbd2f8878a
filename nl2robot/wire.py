"""Methods on the wire, made of plain functions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Final

import msgspec

from grammar.language import UnknownLanguage
from nl2robot.errors import UserError
from robot_api.errors import InvalidCall
from robot_api.server import Context as CallContext
from robot_api.server import Service
from robot_api.serving.dispatch import Lane
from robot_api.serving.roles import Right
from sandbox.limits import MAX_PROGRAM

NUMBER: Final = {"type": "integer", "minimum": 1}
"""Of a run, an appointment, a proposal."""
LANGUAGE: Final = {"type": "string", "pattern": "^[a-z]{2}$"}
NAME: Final = {"type": "string", "minLength": 1, "maxLength": 200}
"""Of whoever does something, or of a robot."""
PROGRAM: Final = {"type": "string", "minLength": 1, "maxLength": MAX_PROGRAM}
SHA256: Final = {"type": "string", "pattern": "^[0-9a-f]{64}$"}


def service(
    handler: Callable[[Mapping[str, Any]], Any],
    doc: str,
    properties: dict[str, Any] | None = None,
    required: str = "",
    observes: bool = False,
    right: Right | None = None,
    lane: Lane = "work",
    result: Any = Any,
) -> Service:
    """A method whose params are an object of these properties; a `UserError` is the caller's.
    One that `observes` only looks; it may need another `right`. `result`: the type of what it
    returns, for those who ask what there is."""
    return service_of_call(
        lambda p, context: handler(p),
        doc,
        properties,
        required,
        observes,
        right=right,
        lane=lane,
        result=result,
    )


def service_of_call(
    handler: Callable[[Mapping[str, Any], CallContext], Any],
    doc: str,
    properties: dict[str, Any] | None = None,
    required: str = "",
    observes: bool = False,
    for_caller: bool = False,
    right: Right | None = None,
    lane: Lane = "work",
    result: Any = Any,
) -> Service:
    """The same for a handler that wants to know who called, or whether they still wait: one
    `for_caller` ends with their connection."""

    def handle(parameters: dict[str, Any], context: CallContext) -> Any:
        try:
            return msgspec.to_builtins(handler(parameters, context))
        except (UserError, UnknownLanguage) as error:
            raise InvalidCall(str(error)) from error

    return Service(
        handler=handle,
        params=an_object(properties or {}, required),
        doc=doc,
        observes=observes,
        for_caller=for_caller,
        right=right,
        lane=lane,
        result=schema_of(result),
    )


def an_object(properties: dict[str, Any], required: str) -> dict[str, Any]:
    """The JSON Schema of an object with these properties and no others."""
    return {
        "type": "object",
        "properties": properties,
        "required": required.split(),
        "additionalProperties": False,
    }


def schema_of(kind: Any) -> dict[str, Any]:
    """The JSON Schema of a type, whole in itself: the types that it is made of stand where they
    are used."""
    schema = msgspec.json.schema(kind)
    parts = schema.pop("$defs", {})

    def whole(part: Any) -> Any:
        if isinstance(part, list):
            return [whole(each) for each in part]
        if not isinstance(part, dict):
            return part
        if isinstance(named := part.get("$ref"), str):
            return whole(parts[named.removeprefix("#/$defs/")])
        return {name: whole(inner) for name, inner in part.items()}

    found: dict[str, Any] = whole(schema)
    return found
