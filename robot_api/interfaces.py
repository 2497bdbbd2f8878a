"""The capabilities there are: every module in `robot_api/capabilities/` is looked through for them.

A capability is an interface, the class that says what a robot without it is `lacking`. Beside it
stand the implementations; of those for a robot that is not there, the emulator and the simulator
take what they find.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
from collections.abc import Iterator, Mapping
from typing import Any, Final, TypeVar

from robot_api import capabilities
from robot_api.capabilities.base import Capability

_Kind = TypeVar("_Kind", bound=Capability)


def _classes() -> Iterator[type[Any]]:
    for found in pkgutil.iter_modules(capabilities.__path__, f"{capabilities.__name__}."):
        module = importlib.import_module(found.name)
        for each in vars(module).values():
            if inspect.isclass(each) and each.__module__ == module.__name__:
                yield each


_CLASSES: Final = tuple(each for each in _classes() if issubclass(each, Capability))

INTERFACES: Mapping[str, type[Capability]] = {
    each.name: each for each in _CLASSES if "lacking" in vars(each)
}
"""The interface of each capability in the method table."""


def implementations(kind: type[_Kind]) -> Mapping[str, type[_Kind]]:
    """The capabilities of a robot of this kind, `InEmulation` or `InSimulation`, by name."""
    return {
        each.name: each
        for each in _CLASSES
        if issubclass(each, kind) and not inspect.isabstract(each) and each is not kind
    }
