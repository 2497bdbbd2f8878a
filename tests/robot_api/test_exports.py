"""The names that other people's programs import; they are added to, never taken away."""

import subprocess
import sys

import pytest

import robot_api
from robot_api import client, protocol, server
from robot_api.methods import METHODS

PUBLIC = {
    "EVENTS",
    "METHODS",
    "AccessDenied",
    "Blocked",
    "CannotListen",
    "Capabilities",
    "Clock",
    "Context",
    "Driver",
    "InternalError",
    "InvalidCall",
    "Location",
    "LostConnection",
    "Method",
    "NotFound",
    "NotPossible",
    "NotSupported",
    "Robot",
    "RobotError",
    "Server",
    "Service",
    "StopFlag",
    "StopNotConfirmed",
    "Stopped",
    "TimedOut",
    "UnknownPerson",
    "UnknownPlace",
}


def test_the_public_names_are_these() -> None:
    assert set(robot_api.__all__) == PUBLIC
    assert len(robot_api.__all__) == len(PUBLIC)


@pytest.mark.parametrize("name", sorted(PUBLIC))
def test_a_public_name_is_there(name: str) -> None:
    assert getattr(robot_api, name) is not None


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="Robto"):
        _ = robot_api.Robto


def test_the_client_has_every_method_of_the_table_and_these_of_its_own() -> None:
    public = {name for name in dir(client.Robot) if not name.startswith("_")}
    own = {"cancel", "capabilities", "close", "connected", "perform", "request", "subscribe"}
    assert public == set(METHODS) | own
    assert not own & set(METHODS)


def test_client_and_server_meet_at_the_same_port() -> None:
    assert client.DEFAULT_PORT == server.DEFAULT_PORT == 9090
    assert protocol.STOP == "robot.stop"


@pytest.mark.parametrize(
    "module, stays_out",
    [
        ("robot_api.methods", {"websocket", "uvicorn", "starlette", "jsonschema", "msgspec"}),
        ("robot_api.client", {"uvicorn", "starlette", "jsonschema", "sim"}),
        ("robot_api.stub", {"websocket", "uvicorn", "jsonschema"}),
    ],
)
def test_what_is_not_needed_is_not_loaded(module: str, stays_out: set[str]) -> None:
    code = f"import sys, {module}; print(*sys.modules)"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not stays_out & set(ran.stdout.split())
