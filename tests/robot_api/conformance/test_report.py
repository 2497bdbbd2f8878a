"""What is said of a robot: a row for each capability."""

from __future__ import annotations

import json
from typing import Any

import msgspec

from robot_api.checker import Row, check_driver
from robot_api.driver import Capabilities, StopFlag
from robot_api.drivers import emulated
from robot_api.errors import NotSupported
from tests.robot_api.conformance.faulty import Faulty


def rows(driver: Any, **options: Any) -> dict[str, Row]:
    return {row.part: row for row in check_driver(driver, **options).rows}


def test_what_stands_in_for_a_face_is_said_by_the_part_that_does() -> None:
    robot = emulated(without=["face"])
    assert robot.capabilities().stand_ins == {"face": "a face on the screen"}
    assert rows(robot)["face"] == Row(
        part="face", state="stood in for", note="by a face on the screen"
    )


def test_what_a_robot_lacks_is_said_with_why() -> None:
    row = rows(emulated(without=["navigation", "dock", "guiding", "following"]))["navigation"]
    assert (row.state, row.note) == ("lacks", "it cannot find its way on a map")


def test_what_it_can_do_in_part_is_said() -> None:
    class Robot(Faulty):
        def capabilities(self) -> Capabilities:
            has = super().capabilities()
            return msgspec.structs.replace(
                has, methods=tuple(name for name in has.methods if name != "read_text")
            )

        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            if method == "read_text":
                raise NotSupported("My screen cannot be read. Look at it yourself.")
            return super().call(method, arguments, stop)

    row = rows(Robot())["screen"]
    assert (row.state, row.without, row.remarks) == (
        "works",
        ("read_text",),
        "without read_text",
    )


def test_what_would_move_is_not_tried_if_nothing_may() -> None:
    found = rows(emulated(), move=False)
    assert (found["motion"].state, found["motion"].note) == ("not tried", "it would move")
    assert found["speech"].state == found["stopping"].state == "works"


def test_the_table_goes_into_the_docs_as_it_is() -> None:
    class Robot(Faulty):
        def call(self, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
            result = super().call(method, arguments, stop)
            return "two" if method == "count" else result

    lines = check_driver(Robot(), move=False).table().splitlines()
    assert lines[0] == "|              | The emulated robot | remarks |"
    assert lines[1] == "|--------------|--------------------|---|"
    assert "| speech       | works              |  |" in lines
    assert (
        "| vision       | problems           |"
        " count: returned 'two': 'two' is not of type 'integer' |" in lines
    )


def test_a_report_as_json() -> None:
    data = json.loads(json.dumps(check_driver(emulated(without=["face"]), move=False).to_json()))
    assert data["robot"] == "The emulated robot"
    assert {
        "part": "face",
        "state": "stood in for",
        "note": "by a face on the screen",
        "without": [],
        "problems": [],
    } in data["rows"]
