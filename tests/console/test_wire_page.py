"""The page of the wire: its session is played, and the rest is what a server says of itself."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

import jsonschema
import pytest
from websockets.sync.client import connect

from nl2robot.console.wire_page import PAGE
from nl2robot.run.runlog import RunLog
from nl2robot.station.station import simulated_station
from sim.world.loading import load_world

LINES = re.findall(r"^(->|<-) (.*)$", PAGE.read_text("utf-8"), re.M)


def test_the_page_is_what_a_server_says_of_itself() -> None:
    made = subprocess.run(
        [sys.executable, "-m", "nl2robot.console.wire_page"],
        capture_output=True,
        encoding="utf-8",
        check=True,
    )
    hint = "run: python -m nl2robot.console.wire_page --write"
    assert made.stdout == PAGE.read_text("utf-8"), hint


@pytest.fixture
def address() -> Iterator[str]:
    with simulated_station(load_world("ward"), RunLog(":memory:")) as station:
        yield station.address


def read(line: str) -> Any:
    """A line of the page; what is left out of it may be anything."""
    return json.loads(re.sub(r", \.\.\.(?=[}\]])", "", line))


def fits(told: Any, came: Any, held: dict[str, Any]) -> bool:
    """Whether this came, with more in its objects; what stands in angle brackets is held."""
    if isinstance(told, str) and re.fullmatch("<.*>", told):
        return bool(held.setdefault(told, came) == came)
    if isinstance(told, dict) and isinstance(came, dict):
        return all(name in came and fits(told[name], came[name], held) for name in told)
    return bool(told == came)


def test_the_session_of_the_page_goes_as_it_says(address: str) -> None:
    held: dict[str, Any] = {}
    asked: dict[int, str] = {}
    with connect(f"ws://{address}") as wire:
        wire.send(json.dumps({"jsonrpc": "2.0", "id": 0, "method": "rpc.discover"}))
        document = json.loads(wire.recv(20))["result"]
        results = {each["name"]: each["result"]["schema"] for each in document["methods"]}
        for way, line in LINES:
            told = read(line)
            if way == "->":
                asked[told["id"]] = told["method"]
                for name, value in held.items():
                    line = line.replace(name, value)
                wire.send(line)
                continue
            came = json.loads(wire.recv(20))
            while not fits(told, came, held):
                assert "id" not in came, f"{line}\nbut:\n{came}"
                came = json.loads(wire.recv(20))
            if "result" in came:
                jsonschema.validate(came["result"], results[asked[came["id"]]])
    assert len(asked) == 10
