"""The reference part of docs/wire.md, made from what `rpc.discover` answers; what stands above its
mark is written by hand.

python -m nl2robot.console.wire_page            prints the page
python -m nl2robot.console.wire_page --write    writes that part of docs/wire.md anew
python -m nl2robot.console.wire_page --document    prints what it is made from, as JSON
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import closing
from inspect import getdoc
from pathlib import Path
from typing import Any, Final

from nl2robot.console.app import Console
from nl2robot.fleet.address import FleetAddress
from nl2robot.run.runlog import RunLog
from nl2robot.station.accounts import Accounts
from nl2robot.station.entrance import Entrance
from nl2robot.station.station import simulated_station
from robot_api import errors
from robot_api.openrpc import openrpc
from robot_api.server import Service
from robot_api.serving.roles import OF_THE_PROTOCOL, RIGHTS
from sim.world.loading import load_world

PAGE = Path(__file__).parents[2] / "docs" / "wire.md"
"""Where the page lives in a checkout."""
MARK: Final = (
    "<!-- From here on made by `python -m nl2robot.console.wire_page --write`;"
    " not to be edited. -->\n"
)
GROUPS: Final[Mapping[str, str]] = {
    "rpc": "The protocol",
    "program": "Sentences and programs",
    "sentence": "Words",
    "station": "How it stands",
    "voice": "Talking to it",
    "desk": "The desk",
    "runs": "Past runs",
    "routines": "Routines",
    "schedule": "Appointments",
    "proposal": "Proposals",
    "fleet": "The fleet (where it has joined one)",
    "scene": "The floor",
    "places": "Places",
    "zones": "Keep-out zones",
    "location": "Where the robot is",
    "helm": "Driving by hand",
    "face": "The face",
    "call": "Video calls",
    "devices": "Devices",
}
"""What comes before the dot of a method beside the robot's own, in the order of the page."""
WIDTH: Final = 100

Document = Mapping[str, Any]


def served() -> tuple[Document, Mapping[str, Service]]:
    """What a server with a console says of itself, and its services. Once in a process."""
    with (
        tempfile.TemporaryDirectory() as folder,
        closing(Accounts(Path(folder) / "accounts.sqlite")) as accounts,
        closing(RunLog(":memory:")) as log,
        simulated_station(
            load_world("ward"),
            log,
            entrance=Entrance(accounts, None, "127.0.0.1"),
            console=Console,
            fleet=FleetAddress("ward", key=b"of this page, and of no fleet"),
        ) as station,
    ):
        server = station.server
        has = server.driver.capabilities()
        return openrpc(has, server.services, server.events), server.services


def page(head: str, document: Document, services: Mapping[str, Service]) -> str:
    """The page, in Markdown: what was written by hand, and what is made."""
    groups: dict[str, list[str]] = {name: [] for name in GROUPS}
    robots: dict[str, list[str]] = {}
    for method in document["methods"]:
        name = method["name"]
        if "x-capability" in method:
            robots.setdefault(method["x-capability"], []).append(f"`{name}`")
        elif name == "robot.capabilities":
            groups["rpc"].append(_entry(method, services))
        else:
            groups[name.partition(".")[0]].append(_entry(method, services))
    parts = [
        f"\n## {GROUPS[name]}\n\n" + "\n".join(entries)
        for name, entries in groups.items()
        if entries
    ]
    told = (f"| {name} | {', '.join(methods)} |\n" for name, methods in robots.items())
    own = f"\n{_ROBOT}{''.join(told)}"
    return "".join((head, MARK, own, *parts, _errors(document), _events(document)))


_ROBOT: Final = """\
## The robot's own methods

Operators and administrators call them while no program runs; everybody may call `robot.stop`. What
each takes and gives is in [Robot methods](methods.md).

| capability | methods |
|---|---|
"""


def _entry(method: Mapping[str, Any], services: Mapping[str, Service]) -> str:
    name = method["name"]
    params = {
        "type": "object",
        "properties": {each["name"]: each["schema"] for each in method["params"]},
        "required": [each["name"] for each in method["params"] if each["required"]],
    }
    lines = [
        f"### `{name}`\n\n{method['summary']}\n\n",
        f"```text\nparams {_told(params, len('params '))}\n",
        f"result {_told(method['result']['schema'], len('result '))}\n```\n",
        f"\nWho: {', '.join(_roles(name, services))}.\n",
    ]
    return "".join(lines)


def _roles(name: str, services: Mapping[str, Service]) -> Iterator[str]:
    """Those that may call it."""
    known = name in OF_THE_PROTOCOL or name.startswith("rpc.")
    need = "know" if known else services[name].needs
    return (role for role, rights in RIGHTS.items() if need in rights)


def _errors(document: Document) -> str:
    rows = (
        f"| {about['code']} | `{name}` | {_cell(getdoc(getattr(errors, name)) or '')} |\n"
        for name, about in document["components"]["errors"].items()
    )
    head = "\n## Errors\n\n| code | `data.error` | when |\n|---:|---|---|\n"
    return head + "".join(rows)


def _events(document: Document) -> str:
    rows = (f"| `{name}` | {_cell(data)} |\n" for name, data in document["x-events"].items())
    return "\n## Events\n\n| event | data |\n|---|---|\n" + "".join(rows)


def _cell(text: str) -> str:
    return " ".join(text.split("\n\n")[0].split()).replace("|", "\\|")


# --- schemas, as TypeScript writes types ----------------------------------------------------------


def _told(schema: Mapping[str, Any], indent: int = 0) -> str:
    """The type in short, over several lines where it is too long for one."""
    short = _short(schema)
    if indent + len(short) <= WIDTH or "properties" not in schema:
        return short
    fields = (f"  {_field(name, each, schema)}\n" for name, each in schema["properties"].items())
    return "{\n" + "".join(fields) + "}"


def _short(schema: Any) -> str:
    if not isinstance(schema, Mapping):  # true: whatever it is
        return "any"
    if "enum" in schema:
        return " | ".join("null" if each is None else f'"{each}"' for each in schema["enum"])
    if "anyOf" in schema:
        return " | ".join(dict.fromkeys(map(_short, schema["anyOf"])))
    kinds = schema.get("type")
    if isinstance(kinds, list):
        return " | ".join(_short({**schema, "type": kind}) for kind in kinds)
    if kinds == "array":
        return _list(schema)
    if kinds == "object":
        return _object(schema)
    return str(kinds) if kinds else "any"


def _list(schema: Mapping[str, Any]) -> str:
    if "prefixItems" in schema:
        return f"[{', '.join(map(_short, schema['prefixItems']))}]"
    inner = _short(schema.get("items", {}))
    return f"({inner})[]" if " | " in inner and not inner.startswith("{") else f"{inner}[]"


def _object(schema: Mapping[str, Any]) -> str:
    properties = schema.get("properties", {})
    if not properties:
        values = schema.get("additionalProperties")
        return f"{{[name]: {_short(values)}}}" if values else "{}"
    return f"{{{', '.join(_field(name, each, schema) for name, each in properties.items())}}}"


def _field(name: str, schema: Any, whole: Mapping[str, Any]) -> str:
    optional = "" if name in whole.get("required", ()) else "?"
    return f"{name}{optional}: {_short(schema)}"


if __name__ == "__main__":
    document, services = served()
    head, _, _ = PAGE.read_text("utf-8").partition(MARK)
    made = page(head, document, services)
    if "--document" in sys.argv[1:]:
        print(json.dumps(document))
    elif "--write" in sys.argv[1:]:
        PAGE.write_text(made, encoding="utf-8")
    else:
        print(made, end="")
