"""What the methods of the console answer is what the server's document says of it: clients in other
languages are made from that."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import pytest
from jsonschema import Draft202012Validator

from nl2robot.review.review import digest
from robot_api.client import Robot
from tests.console.conftest import serving

OPEN = {"robot.do", "helm.call"}
"""Those whose result is whatever the robot answers."""
HELLO = 'robot.say("Hello!")\n'
CORNERS = [[2.0, 2.0], [2.6, 2.0], [2.6, 2.6]]
ROUND = {"name": "evening round", "language": "en"}

ASKED: list[tuple[str, dict[str, Any]]] = [
    ("station.state", {}),
    ("program.unfinished", {}),
    ("devices.list", {}),
    ("face.state", {}),
    ("helm.state", {}),
    ("helm.take", {"who": "Kim"}),
    ("helm.body", {}),
    ("helm.log", {}),
    ("helm.give", {}),
    ("location.set", {"place": "ward a", "who": "Kim"}),
    ("location.history", {}),
    ("scene.floor", {}),
    ("places.list", {}),
    ("places.aim", {"x": 3.0, "y": 3.0}),
    ("places.set", {"name": "tea corner", "x": 3.0, "y": 3.0, "aliases": {"de": ["Tee-Ecke"]}}),
    ("places.export", {}),
    ("places.remove", {"name": "tea corner"}),
    ("zones.set", {"name": "wet floor", "polygon": CORNERS, "who": "Kim"}),
    ("zones.list", {}),
    ("zones.history", {}),
    ("zones.remove", {"name": "wet floor"}),
    ("desk.check", {"program": HELLO}),
    ("desk.check", {"program": "robot.fly()\n"}),
    ("desk.run", {}),
    ("runs.list", {}),
    ("runs.show", {"run": 1}),
    ("routines.check", {"language": "en", "program": HELLO}),
    ("routines.keep", {**ROUND, "program": HELLO, "by": "Kim"}),
    ("routines.list", {}),
    ("routines.show", ROUND),
    ("routines.test", ROUND),
    ("routines.export", {}),
    ("routines.rename", {**ROUND, "new": "morning round"}),
    ("routines.remove", {"name": "morning round", "language": "en"}),
    ("routines.restore", {"number": 1}),
    ("proposal.list", {}),
    ("schedule.list", {}),
    ("schedule.notices", {}),
]


def strict(schema: Any) -> Any:
    """Objects have what is said of them, and no more."""
    if isinstance(schema, list):
        return [strict(each) for each in schema]
    if not isinstance(schema, dict):
        return schema
    more = {"additionalProperties": False} if isinstance(schema.get("properties"), dict) else {}
    return {**more, **{name: strict(part) for name, part in schema.items()}}


@pytest.fixture(scope="module")
def ward(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Robot]:
    home = tmp_path_factory.mktemp("ward")
    with serving(home, "--world", "ward") as served, served.robot() as robot:
        about = {"program": HELLO, "sha256": digest(HELLO), "by": "Kim"}
        approval = robot.request("program.approve", about)
        run = robot.request("program.run", {"approval": approval["id"]})
        robot.request("program.wait", {"run": run})
        yield robot


def test_what_is_answered_is_what_the_document_says(ward: Robot) -> None:
    methods = ward.request("rpc.discover")["methods"]
    said = {each["name"]: each["result"]["schema"] for each in methods}
    wrong = [
        f"{method}: {error.json_path}: {error.message[:200]}"
        for method, params in ASKED
        for error in Draft202012Validator(strict(said[method])).iter_errors(
            ward.request(method, params)
        )
    ]
    assert wrong == []


def test_of_every_method_it_is_said_what_it_answers(ward: Robot) -> None:
    methods = ward.request("rpc.discover")["methods"]
    unsaid = {each["name"] for each in methods if not each["result"]["schema"]}
    assert unsaid <= OPEN
