"""What happens begins what somebody has approved: at a station, with a simulated robot."""

from __future__ import annotations

from typing import Any

import pytest
from msgspec.structs import replace

from nl2robot.review.review import digest
from nl2robot.run.runlog import RunLog
from nl2robot.schedule.clerk import WAITS_FOR_ROBOT
from nl2robot.schedule.triggers import WRITTEN, BadTrigger, Trigger, written
from robot_api.errors import InvalidCall
from sim.world.loading import load_world
from tests.schedule.conftest import Clock, Ward, at, keeping_time

GREETING = 'robot.say("Good morning.")\n'
FIVE_PAST = "2026-11-30 09:05"


def on(ward: Ward, what: str, program: str = GREETING, **trigger: Any) -> int:
    added = ward.add(
        program=program,
        sha256=digest(program),
        sentence="say good morning",
        rhythm=None,
        trigger={"what": what, **trigger},
    )
    return int(added["id"])


def test_a_button_of_the_face_begins_it_but_not_too_often(ward: Ward) -> None:
    on(ward, "pressed", text="Say hello", every=300)
    ward.until_true(lambda: ward.ask("buttons") == ["Say hello"])
    ward.clock.set("2026-11-30 09:00")
    ward.ask("press", button="Say hello")
    ward.until(["done"])
    ward.clock.set("2026-11-30 09:04")
    ward.ask("press", button="Say hello")
    ward.clock.set(FIVE_PAST)
    ward.ask("press", button="Say hello")
    ward.until(["done", "done"])
    assert [each["occurrence"]["due"] for each in ward.ask("history")] == [
        at(FIVE_PAST),
        at("2026-11-30 09:00"),
    ]


def test_a_button_that_nobody_made_is_none(ward: Ward) -> None:
    with pytest.raises(InvalidCall, match="no such button"):
        ward.ask("press", button="Open the door")


def test_what_it_would_never_notice_is_refused(ward: Ward) -> None:
    with pytest.raises(InvalidCall, match="no place “garden” here"):
        on(ward, "seen", thing="person", place="garden")
    with pytest.raises(InvalidCall, match="no topic of MQTT"):
        on(ward, "message", topic="ward/#/call")
    on(ward, "place", place="Ward A")
    [listed] = ward.ask("list")
    assert listed["appointment"]["trigger"]["place"] == "ward a"


@pytest.mark.parametrize("lately", [True, False], ids=["just come", "there for a while"])
def test_somebody_who_is_there_is_greeted(ward: Ward, lately: bool) -> None:
    """There is a nurse where the robot goes."""
    people = ward.station.simulation.world.people
    place = next(each.at for each in people if each.at)
    ward.robot.goto(place)
    if not lately:  # a button is there, so the station has looked since
        on(ward, "pressed", text="Say hello")
        ward.until_true(lambda: ward.ask("buttons") == ["Say hello"])
    on(ward, "seen", thing="person", place=place)
    ward.until(["done"])
    *_, listed = ward.ask("list", language="de")
    assert place in listed["when"]
    assert ward.log.runs()[0].approved_by.startswith("Nurse Kim")


def test_a_battery_that_is_low_sends_it_to_charge(log: RunLog, clock: Clock) -> None:
    world = load_world("ward")
    tired = replace(world, robot=replace(world.robot, battery=15.0))
    with keeping_time(log, clock, tired) as ward:
        ward.robot.goto("ward a")
        on(ward, "battery", "robot.dock()\n", below=20)
        ward.until(["done"])
        assert ward.station.simulation.robot.charging


def test_it_comes_to_a_place(ward: Ward) -> None:
    on(ward, "place", place="ward a")
    ward.robot.goto("ward a")
    ward.until(["done"])


def test_what_is_paused_does_not_happen(ward: Ward) -> None:
    number = on(ward, "pressed", text="Say hello")
    ward.until_true(lambda: ward.ask("buttons") == ["Say hello"])
    ward.ask("pause", id=number)
    ward.until_true(lambda: ward.ask("buttons") == [])
    ward.ask("resume", id=number)
    ward.until_true(lambda: ward.ask("buttons") == ["Say hello"])


def test_nobody_is_greeted_who_has_gone_on(ward: Ward) -> None:
    """In quiet hours nothing begins; what happened then is no reason to drive at six."""
    on(ward, "pressed", text="Say hello")
    ward.until_true(lambda: ward.ask("buttons") == ["Say hello"])
    night = ward.clock.set("2026-11-30 23:00")
    ward.ask("press", button="Say hello")
    ward.until(["due"])
    ward.clock.now = night + WAITS_FOR_ROBOT + 1
    ward.until(["missed"])


@pytest.mark.parametrize(
    ("text", "trigger"),
    [
        ("battery:20", Trigger(what="battery", below=20)),
        ("battery: 20 %", Trigger(what="battery", below=20)),
        ("seen:person@lobby", Trigger(what="seen", thing="person", place="lobby")),
        ("seen:Alice", Trigger(what="seen", thing="Alice")),
        ("place:lobby", Trigger(what="place", place="lobby")),
        ("heard:help me", Trigger(what="heard", text="help me")),
        ("scanned:", Trigger(what="scanned")),
        ("pressed:call", Trigger(what="pressed", text="call")),
        ("message:ward-3/+=on", Trigger(what="message", topic="ward-3/+", text="on")),
    ],
)
def test_how_people_write_them(text: str, trigger: Trigger) -> None:
    assert written(text) == trigger


@pytest.mark.parametrize("text", ["", "battery", "battery:x", "fire:now", "lobby"])
def test_what_is_written_otherwise_is_asked_back(text: str) -> None:
    with pytest.raises(BadTrigger, match="There are: "):
        written(text)
    assert all(written(each.strip()) for each in WRITTEN.split(", "))
