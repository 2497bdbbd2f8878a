"""The robot as a few simple methods: method table, wire protocol, client, server, drivers.

    from robot_api import Robot

    with Robot("127.0.0.1:9090") as robot:
        robot.say("Hello")

What is listed here is loaded when it is first used, so that the method table alone stays light.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from robot_api.client import Robot
    from robot_api.driver import EVENTS, Capabilities, Driver, StopFlag
    from robot_api.errors import (
        AccessDenied,
        Blocked,
        InternalError,
        InvalidCall,
        LostConnection,
        NotFound,
        NotPossible,
        NotSupported,
        RobotError,
        StopNotConfirmed,
        Stopped,
        TimedOut,
        UnknownPerson,
        UnknownPlace,
    )
    from robot_api.methods import METHODS, Method
    from robot_api.server import CannotListen, Context, Server, Service
    from robot_api.values import Clock, Location

_HOME = {
    "Robot": "client",
    "EVENTS": "driver",
    "Capabilities": "driver",
    "Driver": "driver",
    "StopFlag": "driver",
    "AccessDenied": "errors",
    "Blocked": "errors",
    "InternalError": "errors",
    "InvalidCall": "errors",
    "LostConnection": "errors",
    "NotFound": "errors",
    "NotPossible": "errors",
    "NotSupported": "errors",
    "RobotError": "errors",
    "StopNotConfirmed": "errors",
    "Stopped": "errors",
    "TimedOut": "errors",
    "UnknownPerson": "errors",
    "UnknownPlace": "errors",
    "METHODS": "methods",
    "Method": "methods",
    "CannotListen": "server",
    "Context": "server",
    "Server": "server",
    "Service": "server",
    "Clock": "values",
    "Location": "values",
}

__all__ = [
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
]


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'robot_api' has no attribute {name!r}")
    return getattr(import_module(f"robot_api.{_HOME[name]}"), name)
