"""The robot methods as Python signatures, made from the method table.

`stub()` is the `.pyi` text that programs are type-checked against before they run: the classes
`Robot`, `Location` and `Clock`, and the one name a program is given, `robot`. `calls()` is the
source of `robot_api/calls.py`: the same signatures with bodies that make the call. The client is
built on it, so that editors and mypy know every method of `from robot_api import Robot`.

    python -m robot_api.stub            prints the stub
    python -m robot_api.stub --write    writes robot_api/calls.py anew
"""

from __future__ import annotations

import inspect
import subprocess
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from robot_api.driver import Capabilities
from robot_api.methods import METHODS, NOTHING, Method, Parameter
from robot_api.values import Clock, Location

CALLS = Path(__file__).with_name("calls.py")
"""Where the generated methods of the client live."""

_STUB_HEAD = '''\
from typing import Any, overload

class Location:
    """{location}"""
    x: float
    y: float
    theta: float
    place: str | None

class Clock:
    """{clock}"""
    time: str
    weekday: str
    date: str
    zone: str

class Robot:
'''

_CALLS_HEAD = '''\
"""The robot methods with their Python signatures: what a client's `Robot` inherits.

Made from the method table by `python -m robot_api.stub --write`; not to be edited.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, overload

from robot_api.values import Clock, Location


class Calls(ABC):
    """Every robot method as a blocking call; what a call does is up to `_call`."""

    @abstractmethod
    def _call(self, method: str, /, *arguments: Any, **named: Any) -> Any:
        """Make the call and return its result: plain data, a `Location` or a `Clock`."""

'''


def stub(capabilities: Capabilities | None = None) -> str:
    """The `.pyi` text that a program is type-checked against.

    With a robot's capabilities, only the methods that this robot has are in it, so that a program
    which needs another one is refused before it runs.
    """
    has = METHODS if capabilities is None else capabilities.methods
    lines = [
        line
        for method in METHODS.values()
        if method.name in has
        for form in method.forms
        for line in _declaration(method, form)
    ]
    head = _STUB_HEAD.format(location=_doc(Location), clock=_doc(Clock))
    return head + "\n".join([*_indented(lines or ["..."]), "", "robot: Robot", ""])


def calls() -> str:
    """The source of `robot_api/calls.py`, formatted."""
    lines = [line for method in METHODS.values() for line in _definition(method)]
    source = _CALLS_HEAD + "\n".join(_indented(lines))
    formatted = subprocess.run(
        [sys.executable, "-m", "ruff", "format", "--stdin-filename", str(CALLS), "-"],
        input=source,
        capture_output=True,
        check=True,
        text=True,
    )
    return formatted.stdout


def _declaration(method: Method, form: Iterable[Parameter]) -> Iterator[str]:
    if len(method.forms) > 1:
        yield "@overload"
    yield f"def {method.name}({_parameters(method, form)}) -> {method.returns.annotation}:"
    yield f'    """{method.doc}"""'


def _definition(method: Method) -> Iterator[str]:
    if len(method.forms) > 1:
        for form in method.forms:
            yield from list(_declaration(method, form))[:2]
            yield "    ..."
        yield f"def {method.name}(self, *arguments: Any, **named: Any) -> Any:"
        yield f'    """{method.doc}"""'
        given = "*arguments, **named"
    else:
        yield from _declaration(method, method.forms[0])
        named = [f"{parameter.name}={parameter.name}" for parameter in method.forms[0]]
        given = ", ".join([*named, "**parameters"] if method.extra else named)
    call = f'self._call("{method.name}"{", " if given else ""}{given})'
    if method.returns is NOTHING:
        yield f"    {call}"
    else:
        yield f"    result: {method.returns.annotation} = {call}"
        yield "    return result"
    yield ""


def _parameters(method: Method, form: Iterable[Parameter]) -> str:
    written = [_parameter(parameter) for parameter in form]
    # A skill's parameter may be called anything, even self.
    return ", ".join(
        ["self", "/", *written, "**parameters: Any"] if method.extra else ["self", *written]
    )


def _parameter(parameter: Parameter) -> str:
    default = "" if parameter.required else f" = {parameter.default!r}"
    return f"{parameter.name}: {parameter.kind.annotation}{default}"


def _doc(kind: type) -> str:
    return inspect.cleandoc(kind.__doc__ or "").replace("\n", " ")


def _indented(lines: Iterable[str]) -> list[str]:
    return [f"    {line}" if line else "" for line in lines]


if __name__ == "__main__":
    if "--write" in sys.argv[1:]:
        CALLS.write_text(calls(), encoding="utf-8")
    else:
        print(stub(), end="")
