"""Programs on a head on a desk: it cannot go anywhere, which the review says before anything
happens."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from nl2robot.cli.operator import Operator
from nl2robot.knowledge import Knowledge
from nl2robot.review.review import review
from nl2robot.run.runlog import RunLog
from nl2robot.station.station import robot_station
from robot_api.robots.address import Address
from robot_api.robots.furhat import FURHAT
from robot_api.robots.registry import Setup
from sim.world.loading import load_world
from tests.robots.furhat.stand_in import FurhatStandIn


@pytest.fixture(scope="module")
def reception() -> Iterator[Knowledge]:
    with FurhatStandIn() as furhat:
        driver = FURHAT.connect(Setup(address=Address("furhat", "127.0.0.1", furhat.port)))
        yield Knowledge(load_world("city-hospital"), driver.capabilities())
        driver.close()


@pytest.mark.parametrize(
    ("step", "cannot"),
    [
        ('robot.goto("pharmacy")', "drive to a place"),
        ("robot.move(1)", "drive straight ahead"),
        ('robot.guide("person", "pharmacy")', "lead a person"),
        ('robot.grab("cup")', "take a thing"),
        ("robot.objects()", "list the objects"),
        ('robot.find("person")', "look for such a thing or person"),
        ("robot.set_volume(50)", "set how loud the robot speaks"),
        ('robot.call("reception")', "start a video call"),
        ("robot.dock()", "drive back to the charging station"),
    ],
)
def test_what_a_furhat_lacks_is_refused(reception: Knowledge, step: str, cannot: str) -> None:
    looked_at = review(f'robot.say("Hello.")\n{step}\n', reception)
    assert not looked_at.acceptable
    [finding] = [finding for finding in looked_at.findings if finding.severity == "error"]
    assert finding.line == 2
    assert finding.message.startswith(f"The Furhat cannot do this: {cannot}")


def test_a_gesture_that_needs_arms_is_refused(reception: Knowledge) -> None:
    [finding] = review('robot.gesture("wave")\n', reception).findings
    assert finding.message == 'There is no gesture "wave" here.'


def test_what_a_furhat_can_do_is_accepted(reception: Knowledge) -> None:
    welcome = """\
robot.wait_for("person")
robot.emotion("happy")
robot.gesture("nod")
place = robot.ask("Where would you like to go?", ["radiology", "pharmacy"])
robot.say("Follow the signs to " + place + ".")
robot.do("light", color="green")
"""
    assert review(welcome, reception).findings == ()


def test_whom_one_program_met_the_next_one_meets_again(tmp_path: Path) -> None:
    program = 'robot.wait_for("person", timeout=0)\nrobot.say("Welcome!")\n'
    log = RunLog(tmp_path / "runs.sqlite")
    with FurhatStandIn(users=["user-1"]) as furhat, closing(log):
        driver = FURHAT.connect(Setup(address=Address("furhat", "127.0.0.1", furhat.port)))
        with (
            robot_station(driver, load_world("city-hospital"), log) as (station, _),
            station.connect() as robot,
        ):
            receptionist = Operator(robot, "Nurse Kim")
            for _ in range(2):
                approval = receptionist.approve(receptionist.check(program))
                receptionist.wait(receptionist.run(approval))
        met = furhat.asked("request.attend.user")
        driver.close()
    assert [message["user_id"] for message in met] == ["user-1", "user-1"]
