"""The reference page of the robot methods, docs/methods.md, made from the method table.

python -m robot_api.reference            prints the page
python -m robot_api.reference --write    writes docs/methods.md anew
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from robot_api.driver import EVENTS
from robot_api.messages import Robot
from robot_api.methods import CAPABILITIES, CORE, METHODS, REQUIRED, Method, Parameter

PAGE = Path(__file__).parents[1] / "docs" / "methods.md"
"""Where the page lives in a checkout."""

_HEAD = """\
# The robot methods

<!-- Made from the method table by `python -m robot_api.reference --write`; not to be edited. -->

Every robot is told what to do by these methods, from a Python program, from the
[message style](#the-message-style-of-the-paper) of the paper, or over [the wire](#the-wire).
Lengths are metres, angles degrees (left is +), durations seconds. A call returns when the action is
done, and raises an error if it could not be done. A number in brackets is the function's number in
Table 1 of Glauser et al.

Besides the errors listed with it, a method may raise `NotSupported` (this robot cannot do that),
`InvalidCall` (wrong parameters), `LostConnection`, and `Stopped` when somebody stops the robot;
`except Exception` does not catch that one.

```python
from robot_api import Robot

with Robot("127.0.0.1:9090") as robot:
    desk = robot.location()
    robot.goto("pharmacy")
    robot.say("Here we are.")
    robot.goto(desk)
```
"""

_WIRE = """\
## The wire

JSON-RPC 2.0 over WebSocket, in text frames, at port 9090. A method is called `robot.` and its name;
its parameters go by name or by position. Whatever else a server has, and a whole session, is in
[The wire](wire.md).

```json
{"jsonrpc": "2.0", "id": 7, "method": "robot.goto", "params": {"place": "pharmacy"}}
{"jsonrpc": "2.0", "id": 7, "result": null}
{"jsonrpc": "2.0", "id": 7, "error": {"code": -32005, "message": "A bed blocks the way.",
                                      "data": {"error": "Blocked"}}}
```

| method | what it does |
|---|---|
| `robot.capabilities` | what this robot can do |
| `rpc.discover` | the OpenRPC document |
| `rpc.cancel {"id": 7}` | stops the call in flight that has this id; it ends with `Stopped` |
| `rpc.subscribe {"events": ["pose"]}` | events from now on; `"*"` is every event |
| `rpc.unsubscribe {"events": ["pose"]}` | no more of these |

Calls run side by side, those of a batch too. `robot.stop` overtakes them all: every call in flight,
of every connection, ends with `Stopped`. With `{"who": "Ruth"}` it says in whose name. It is
answered when the robot has confirmed that it stands, and with `StopNotConfirmed` if it has not in
time. The robot calls of a connection that is lost are stopped too.

A robot that cannot be reached any more is lost, as the event `link` says: every call in flight ends
with `LostConnection`, and so do new ones until it is found again. Nothing is taken up again by
itself. Of `link` and `stop_not_confirmed` the last one is sent on subscribing, if it still holds.

Events are notifications, `{"jsonrpc": "2.0", "method": "event.pose", "params": {"x": 1.5, ...}}`:

| event | data |
|---|---|
"""

_MESSAGES = """\

## The message style of the paper

```python
from robot_api.messages import Robot

robot = Robot()
robot.connect("10.0.0.1:9090")
robot.send_message(robot.say("I'm coming"))
robot.send_message(robot.goto(-605, -1027, -1.3))
response = robot.send_message(robot.listen(prompt="Where to?"))
speech = response.get("data", {}).get("speech")
```

Coordinates count in the map's own unit here, and angles in radians. Nobody having spoken in time
is no error: the speech is empty then.

| function of the paper | messages |
|---|---|
"""


def reference() -> str:
    """The page, as Markdown."""
    sections = "\n".join(_section(capability) for capability in CAPABILITIES)
    events = "".join(f"| `event.{kind}` | {_cell(data)} |\n" for kind, data in EVENTS.items())
    return f"{_HEAD}\n{sections}\n{_WIRE}{events}{_MESSAGES}{_paper_style()}"


def _section(capability: str) -> str:
    methods = [method for method in METHODS.values() if method.capability == capability]
    title = "Every robot" if capability == CORE else capability.capitalize()
    note = (
        "What every robot has."
        if capability == CORE
        else f"What a robot with the capability `{capability}` has."
    )
    return "\n".join([f"## {title}\n\n{note}\n", *map(_entry, methods)])


def _entry(method: Method) -> str:
    number = f" [{method.paper}]" if method.paper else ""
    signatures = "\n".join(_signature(method, form) for form in method.forms)
    lines = [f"### `{method.name}`{number}\n", f"{method.doc}\n", f"```python\n{signatures}\n```\n"]
    parameters = {parameter.name: parameter for form in method.forms for parameter in form}
    if parameters:
        lines.append("".join(map(_parameter, parameters.values())))
    if method.errors:
        lines.append(f"Errors: {', '.join(f'`{error}`' for error in method.errors)}.\n")
    return "\n".join(lines)


def _signature(method: Method, form: Iterable[Parameter]) -> str:
    written = [
        f"{parameter.name}: {parameter.kind.annotation}"
        + ("" if parameter.default is REQUIRED else f" = {parameter.default!r}")
        for parameter in form
    ]
    if method.extra:
        written.append("**parameters")
    return f"robot.{method.name}({', '.join(written)}) -> {method.returns.annotation}"


def _parameter(parameter: Parameter) -> str:
    return f"- `{parameter.name}`: {parameter.doc}{_limits(parameter)}\n"


def _limits(parameter: Parameter) -> str:
    """What a number may be, where the table bounds it."""
    schemas = parameter.kind.schema.get("anyOf", [parameter.kind.schema])
    for schema in schemas:
        if "minimum" in schema and "maximum" in schema:
            return f" ({schema['minimum']} to {schema['maximum']})"
    return ""


def _paper_style() -> str:
    return "".join(
        f"| {number} | {', '.join(f'`{name}`' for name in names)} |\n"
        for number, names in sorted(_messages_by_function())
    )


def _messages_by_function() -> Iterator[tuple[int, list[str]]]:
    by_number: dict[int, list[str]] = {}
    for name, make in vars(Robot).items():
        number, colon, _ = (make.__doc__ or "").partition(":")
        if colon and number.isdigit():
            by_number.setdefault(int(number), []).append(name)
    return iter(by_number.items())


def _cell(text: str) -> str:
    return text.replace("|", "\\|")


if __name__ == "__main__":
    if "--write" in sys.argv[1:]:
        PAGE.write_text(reference(), encoding="utf-8")
    else:
        print(reference(), end="")
