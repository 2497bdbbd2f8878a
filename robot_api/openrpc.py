"""The OpenRPC document of a robot's server: what `rpc.discover` answers.

It follows the OpenRPC 1.3 specification; what that does not know stands beside it: events in
`x-events`, the bytes that a frame has at most in `x-longest-frame`, and of a method its capability,
whether it moves the body, its number in the paper, and the JSON Schema of its params as a whole,
which says what of them goes together.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, version
from typing import Any, Protocol

import msgspec

from robot_api import errors, protocol
from robot_api.driver import EVENTS, Capabilities
from robot_api.frame import MAX_FRAME
from robot_api.methods import METHODS, TEXT, Method, Parameter
from robot_api.schema import parameter_schema, params_schema, result_schema

ERRORS_OF_EVERY_METHOD = ("NotSupported", "InvalidCall", "Stopped", "InternalError")
_WHO = Parameter("who", TEXT, "in whose name, for those who look on", default="")
"""What a stop takes on the wire alone: a program has nobody to name."""


class Documented(Protocol):
    """What the document says of a service (`robot_api.server.Service`)."""

    @property
    def params(self) -> Mapping[str, Any]: ...
    @property
    def doc(self) -> str: ...
    @property
    def result(self) -> Mapping[str, Any]: ...


def openrpc(
    capabilities: Capabilities | None = None,
    services: Mapping[str, Documented] | None = None,
    events: Mapping[str, str] = EVENTS,
) -> dict[str, Any]:
    """The document, as JSON data; with a robot's capabilities only the methods that it has."""
    has = METHODS if capabilities is None else capabilities.methods
    return {
        "openrpc": "1.3.2",
        "info": {
            "title": "A robot" if capabilities is None else capabilities.name,
            "version": _version(),
            "description": "JSON-RPC 2.0 over WebSocket, in text frames. Lengths are metres, "
            "angles degrees (left is +), durations seconds. Calls run side by side; robot.stop "
            "overtakes them all.",
            "license": {"name": "Apache-2.0"},
        },
        "methods": [
            *(_robot_method(method) for method in METHODS.values() if method.name in has),
            *_methods_of_every_server(),
            *(
                _method(name, service.doc, service.params, service.result)
                for name, service in (services or {}).items()
            ),
        ],
        "components": {"errors": {kind.__name__: _error(kind) for kind in _error_kinds()}},
        "x-longest-frame": MAX_FRAME,
        "x-events": {f"event.{kind}": data for kind, data in events.items()},
    }


def _robot_method(method: Method) -> dict[str, Any]:
    if f"robot.{method.name}" == protocol.STOP:
        method = replace(method, forms=((_WHO,),))
    parameters = {parameter.name: parameter for form in method.forms for parameter in form}
    always = [
        name
        for name, parameter in parameters.items()
        if parameter.required and all(parameter in form for form in method.forms)
    ]
    described = {
        "name": f"robot.{method.name}",
        "summary": method.doc,
        "tags": [{"name": method.capability}],
        "params": [
            {
                "name": name,
                "summary": parameter.doc,
                "required": name in always,
                "schema": parameter_schema(parameter),
            }
            for name, parameter in parameters.items()
        ],
        # By position, one list of parameters cannot say that there are several forms.
        "paramStructure": "either" if len(method.forms) == 1 else "by-name",
        "result": {"name": "result", "schema": result_schema(method)},
        "errors": [
            {"$ref": f"#/components/errors/{name}"}
            for name in dict.fromkeys((*method.errors, *ERRORS_OF_EVERY_METHOD))
        ],
        "x-capability": method.capability,
        "x-moves": method.moves,
        "x-params-schema": params_schema(method),
    }
    return described if method.paper is None else {**described, "x-paper-function": method.paper}


def _methods_of_every_server() -> Iterable[dict[str, Any]]:
    names = {"type": "array", "items": {"type": "string"}}
    which = {"type": "object", "properties": {"events": names}, "required": ["events"]}
    call = {"type": "object", "properties": {"id": {}}, "required": ["id"]}
    capabilities = msgspec.json.schema(Capabilities)["$defs"][Capabilities.__name__]
    yield _method("robot.capabilities", "Tell what this robot can do.", {}, capabilities)
    yield _method("rpc.discover", "Return this document.", {}, {"type": "object"})
    yield _method(
        protocol.CANCEL,
        "Stop the call in flight that has this id; true if there was one.",
        call,
        {"type": "boolean"},
    )
    yield _method(
        protocol.SUBSCRIBE,
        'Receive these events from now on ("*" is every event). Of "link" and "stop_not_confirmed"'
        " the last one is sent at once, if it still holds.",
        which,
        names,
    )
    yield _method(protocol.UNSUBSCRIBE, "Receive these events no more.", which, names)


def _method(
    name: str, doc: str, params: Mapping[str, Any], result: Mapping[str, Any]
) -> dict[str, Any]:
    required = params.get("required", ())
    return {
        "name": name,
        "summary": doc,
        "params": [
            {"name": parameter, "required": parameter in required, "schema": schema}
            for parameter, schema in params.get("properties", {}).items()
        ],
        "paramStructure": "either",
        "result": {"name": "result", "schema": result},
    }


def _error_kinds() -> Iterable[type[errors.RobotError] | type[errors.Stopped]]:
    for kind in vars(errors).values():
        if isinstance(kind, type) and issubclass(kind, errors.RobotError | errors.Stopped):
            yield kind


def _error(kind: type[errors.RobotError] | type[errors.Stopped]) -> dict[str, Any]:
    return {"code": kind.code, "message": kind.__name__, "data": {"error": kind.__name__}}


def _version() -> str:
    try:
        return version("nl2robot")
    except PackageNotFoundError:
        return "0"
