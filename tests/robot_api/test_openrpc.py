"""What a server says of itself to somebody who only knows JSON-RPC."""

from collections.abc import Iterator
from typing import Any

import jsonschema
import pytest

from robot_api import Robot, Server, Service
from robot_api.driver import EVENTS
from robot_api.drivers import emulated
from robot_api.methods import METHODS
from robot_api.openrpc import openrpc

METHOD_OBJECT = {
    "type": "object",
    "required": ["name", "params", "result"],
    "properties": {
        "name": {"type": "string"},
        "summary": {"type": "string", "minLength": 1},
        "params": {
            "type": "array",
            "items": {
                "type": "object",
                "required": ["name", "schema"],
                "properties": {
                    "name": {"type": "string"},
                    "required": {"type": "boolean"},
                    "schema": {"type": "object"},
                },
            },
        },
        "paramStructure": {"enum": ["by-name", "by-position", "either"]},
        "result": {"type": "object", "required": ["name", "schema"]},
        "errors": {"type": "array"},
    },
}
"""What the OpenRPC specification asks of a method."""


@pytest.fixture(scope="module")
def document() -> Any:
    service = Service(
        lambda params, context: None,
        params={"type": "object", "properties": {"text": {"type": "string"}}},
        doc="Translate a sentence.",
    )
    with (
        Server(
            emulated(without=["skills"]), port=0, services={"program.translate": service}
        ) as server,
        Robot(server.address) as robot,
    ):
        return robot.request("rpc.discover")


def test_the_document_is_one_that_openrpc_tools_read(document: Any) -> None:
    assert document["openrpc"].startswith("1.")
    assert {"title", "version"} <= set(document["info"])
    for method in document["methods"]:
        jsonschema.validate(method, METHOD_OBJECT)
        jsonschema.Draft202012Validator.check_schema(method["result"]["schema"])
        for parameter in method["params"]:
            jsonschema.Draft202012Validator.check_schema(parameter["schema"])
        for error in method.get("errors", []):
            name = error["$ref"].removeprefix("#/components/errors/")
            assert document["components"]["errors"][name]["data"] == {"error": name}
    names = [method["name"] for method in document["methods"]]
    assert len(names) == len(set(names))


def test_it_lists_what_this_robot_has_and_no_more(document: Any) -> None:
    names = {method["name"] for method in document["methods"]}
    assert names == {f"robot.{name}" for name in METHODS if name != "do"} | {
        "robot.capabilities",
        "rpc.discover",
        "rpc.cancel",
        "rpc.subscribe",
        "rpc.unsubscribe",
        "program.translate",
    }


def test_everything_it_lists_can_be_called_and_nothing_else() -> None:
    with Server(emulated(), port=0) as server:
        listed = {method["name"] for method in openrpc(server.driver.capabilities())["methods"]}
        assert listed == set(server.methods) | {"rpc.cancel", "rpc.subscribe", "rpc.unsubscribe"}


def test_it_says_which_events_there_are(document: Any) -> None:
    assert set(document["x-events"]) == {f"event.{kind}" for kind in EVENTS}


def test_a_method_with_several_forms_is_called_by_name(document: Any) -> None:
    methods = {method["name"]: method for method in document["methods"]}
    goto = methods["robot.goto"]
    assert goto["paramStructure"] == "by-name"
    assert [parameter["name"] for parameter in goto["params"]] == ["place", "x", "y", "theta"]
    assert not any(parameter["required"] for parameter in goto["params"])
    assert methods["robot.say"]["params"][0]["required"]
    assert goto["x-paper-function"] == 4


def test_every_reference_leads_somewhere(document: Any) -> None:
    def references(part: Any) -> Iterator[str]:
        if isinstance(part, dict):
            yield from [part["$ref"]] if isinstance(part.get("$ref"), str) else []
        for inner in part.values() if isinstance(part, dict) else part:
            if isinstance(inner, dict | list):
                yield from references(inner)

    for reference in references(document):
        target = document
        for step in reference.removeprefix("#/").split("/"):
            target = target[step]
