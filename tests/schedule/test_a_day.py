"""Twenty-four hours of a ward, from one breakfast to the next, on a clock that is set by hand."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import msgspec
import pytest

from nl2robot.review.review import digest
from nl2robot.run.runlog import RunLog
from robot_api.capabilities.screen import SimulatedScreen
from sim.world.loading import load_world
from tests.schedule.conftest import ZURICH, Clock, Ward, at, keeping_time
from tests.schedule.test_reminders import program

ONCE = {"zone": ZURICH, "rule": None}
LONG = 'while True:\n    robot.goto("ward a")\n    robot.goto("ward b")\n'


@pytest.fixture
def ward(log: RunLog, clock: Clock, monkeypatch: pytest.MonkeyPatch) -> Iterator[Ward]:
    """Alice has drunk in the morning, and has not in the afternoon."""
    monkeypatch.setattr(SimulatedScreen, "touchable", False)
    # It goes by a clock that nobody sets.
    monkeypatch.setattr("nl2robot.schedule.service.RESTS_AFTER_STOP", 0.0)
    small = load_world("ward")
    alice, henry = small.people
    alice = msgspec.structs.replace(alice, answers=("yes", "no"))
    with keeping_time(log, clock, msgspec.structs.replace(small, people=(alice, henry))) as ward:
        yield ward


def says(text: str) -> dict[str, Any]:
    return {"program": f'robot.say("{text}")\n', "sentence": text}


def test_twenty_four_hours(ward: Ward) -> None:
    clock = ward.clock
    ward.add(sentence="the round")
    ten_and_four = {"begins": "2026-11-30T10:00", "zone": ZURICH, "rule": "FREQ=DAILY;BYHOUR=10,16"}
    ward.add(program(), sentence="remind Alice to drink", rhythm=ten_and_four)
    noon = {**ONCE, "begins": "2026-11-30T12:00"}
    ward.add(**says("Lunch is ready."), rhythm=noon, priority=3)
    ward.add(**says("Visitors, please leave."), rhythm=noon, priority=8)
    ward.add(**says("The shift begins."), rhythm={**ONCE, "begins": "2026-11-30T14:00"})
    ward.add(**says("Who is awake?"), rhythm={**ONCE, "begins": "2026-11-30T23:00"})
    pressed = {"what": "pressed", "text": "Help", "every": 300}
    ward.add(**says("Help is on its way."), rhythm=None, trigger=pressed)

    clock.set("2026-11-30 08:00")
    ward.until(["done"])
    clock.set("2026-11-30 09:30")
    ward.until_true(lambda: ward.ask("buttons") == ["Help"])
    ward.ask("press", button="Help")
    ward.until(["done"] * 2)
    clock.set("2026-11-30 10:00")
    ward.until(["done"] * 3)
    clock.set("2026-11-30 12:00")
    ward.until(["done"] * 5)

    def told(kinds: list[str]) -> None:
        ward.until_true(lambda: [each["notice"]["kind"] for each in ward.ask("notices")] == kinds)

    # Somebody has it go to and fro until ten past two; what is due at two waits for that.
    clock.set("2026-11-30 13:50")
    about = {"program": LONG, "sha256": digest(LONG), "by": "Ben", "insists": True}
    approval = ward.robot.request("program.approve", about)
    by_hand = ward.robot.request("program.run", {"approval": approval["id"]})
    clock.set("2026-11-30 14:00")
    told(["waits"])
    clock.set("2026-11-30 14:10")
    ward.robot.stop()
    ward.robot.request("program.wait", {"run": by_hand})
    clock.set("2026-11-30 14:13")
    ward.until(["done"] * 6)

    clock.set("2026-11-30 16:00")
    assert ward.notice("reminder_no")["told"]["en"].startswith("Alice")
    ward.until(["done"] * 7)

    # At night nothing begins, and in the morning nobody is asked who is awake.
    clock.set("2026-11-30 23:00")
    told(["waits", "reminder_no", "waits"])
    clock.set("2026-11-30 23:31")
    ward.until(["done"] * 7 + ["missed"])
    clock.set("2026-12-01 05:59")
    ward.ask("press", button="Help")
    told(["waits", "reminder_no", "waits", "missed", "waits"])
    clock.set("2026-12-01 06:00")
    ward.until(["done"] * 7 + ["missed", "done"])
    clock.set("2026-12-01 08:00")
    ward.until(["done"] * 7 + ["missed", "done", "done"])

    # What the robot said all day, as the log has it, and what the ward was told.
    runs = list(reversed(ward.log.runs()))
    said = [
        msgspec.json.decode(call.arguments)["text"]
        for run in runs
        for call in ward.log.calls(run.id)
        if call.method == "say"
    ]
    assert said == [
        "Good morning.",
        "Help is on its way.",
        *("Please drink.", "Thank you."),
        *("Visitors, please leave.", "Lunch is ready."),
        "The shift begins.",
        *("Please drink.", "All right. Thank you for telling me."),
        "Help is on its way.",
        "Good morning.",
    ]
    assert [run.approved_by for run in runs if run.approved_by == "Ben"] == ["Ben"]
    record = [(each["due"], each["result"]) for each in reversed(ward.ask("reminders"))]
    assert record == [(at("2026-11-30 10:00"), "yes"), (at("2026-11-30 16:00"), "no")]
