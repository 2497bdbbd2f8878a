"""The services and events that the console adds to the wire, as tables for its docs page.

python -m nl2robot.console.reference 127.0.0.1:9090
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

from nl2robot.station.services import EVENTS
from robot_api.client import Robot
from robot_api.driver import EVENTS as ROBOT_EVENTS

ELSEWHERE = ("robot", "rpc", "program", "voice")
"""What comes before the dot in methods that other pages tell of."""


def reference(discovered: Mapping[str, Any]) -> str:
    """Markdown, from what `rpc.discover` answers."""
    methods = {
        each["name"]: each["summary"]
        for each in discovered["methods"]
        if each["name"].partition(".")[0] not in ELSEWHERE
    }
    known = {f"event.{kind}" for kind in (*ROBOT_EVENTS, *EVENTS)}
    events = {name: about for name, about in discovered["x-events"].items() if name not in known}
    return "\n".join([*_table("method", methods), "", *_table("event", events)])


def _table(heading: str, rows: Mapping[str, str]) -> list[str]:
    told = [
        "| `{}` | {} |".format(name, about.replace("|", r"\|"))
        for name, about in sorted(rows.items())
    ]
    return [f"| {heading} | |", "|---|---|", *told]


if __name__ == "__main__":
    with Robot(sys.argv[1]) as robot:
        print(reference(robot.request("rpc.discover", {})))
