"""Methods on the wire, made of plain functions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import msgspec

from grammar.language import UnknownLanguage
from nl2robot.errors import UserError
from robot_api.errors import InvalidCall
from robot_api.server import Context as CallContext
from robot_api.server import Service
from robot_api.serving.dispatch import Lane
from robot_api.serving.roles import Right


def service(
    handler: Callable[[Mapping[str, Any]], Any],
    doc: str,
    properties: dict[str, Any] | None = None,
    required: str = "",
    observes: bool = False,
    right: Right | None = None,
    lane: Lane = "work",
) -> Service:
    """A method whose params are an object of these properties; a `UserError` is the caller's.
    One that `observes` only looks; it may need another `right`."""
    return service_of_call(
        lambda p, context: handler(p), doc, properties, required, observes, right=right, lane=lane
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
    )


def an_object(properties: dict[str, Any], required: str) -> dict[str, Any]:
    """The JSON Schema of an object with these properties and no others."""
    return {
        "type": "object",
        "properties": properties,
        "required": required.split(),
        "additionalProperties": False,
    }
