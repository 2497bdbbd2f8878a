"""What does not come to its end when it is tried is run only if somebody insists, whoever asks."""

import time

import pytest

from nl2robot.cli.session import Session
from nl2robot.cli.terminal import Terminal
from nl2robot.console.desk.dialogue import Dialogue
from nl2robot.review import review
from nl2robot.station.station import simulated_station
from robot_api.errors import AccessDenied
from sim.world.loading import load_world

FAILS = 'robot.say("Now.")\nrobot.grab("unicorn")\n'
WAITS = 'while not robot.sees("unicorn"):\n    robot.goto("ward a")\n    robot.goto("ward b")\n'
AHEAD = "robot.move(3)\n"
"""There is a wall behind the robot."""


@pytest.fixture
def tries(monkeypatch) -> list[str]:
    """The programs that were tried in a dry run."""
    programs: list[str] = []
    watched = review.watched

    def watch(program, *arguments, **more):
        programs.append(program)
        return watched(program, *arguments, **more)

    monkeypatch.setattr(review, "watched", watch)
    return programs


def about(operator, program: str) -> dict[str, str]:
    """As any client of the wire has it who knows how a hash is made."""
    return {"program": program, "sha256": review.digest(program), "by": "A script"}


@pytest.mark.parametrize(
    ("program", "why"), [(FAILS, r"\(line 2: .*unicorn"), (WAITS, "it broke off")]
)
def test_no_client_runs_what_did_not_come_to_its_end_without_insisting(
    operator, station, log, program, why
) -> None:
    request, before = operator.robot.request, station.simulation.robot
    with pytest.raises(AccessDenied, match=why) as refused:
        request("program.approve", about(operator, program))
    assert "Change it, or say that you want it run all the same" in str(refused.value)
    assert station.simulation.robot == before and log.runs() == []
    request("program.approve", {**about(operator, program), "insists": True})


def test_an_approval_is_not_tried_twice_in_the_same_world(operator, tries) -> None:
    checked = operator.check(AHEAD)
    operator.approve(checked)
    operator.approve(checked)
    assert tries == [AHEAD]
    other = 'robot.say("Never looked at.")\n'
    operator.robot.request("program.approve", about(operator, other))
    assert tries == [AHEAD, other], "nobody had it reviewed: the server tries it itself"
    operator.robot.request("program.approve", {**about(operator, FAILS), "insists": True})
    assert tries == [AHEAD, other], "who insists need not wait for it"


def test_what_came_through_elsewhere_is_tried_again_here(operator, tries) -> None:
    checked = operator.check(AHEAD)
    operator.robot.turn(180)
    with pytest.raises(AccessDenied, match="in the way"):
        operator.approve(checked)
    assert tries == [AHEAD, AHEAD]


def test_a_review_from_long_ago_holds_no_more(operator, tries, monkeypatch) -> None:
    checked = operator.check(AHEAD)
    now = time.monotonic()
    monkeypatch.setattr("nl2robot.review.reviews.time.monotonic", lambda: now + 3600)
    operator.approve(checked)
    assert tries == [AHEAD, AHEAD]


class Nurse(Terminal):
    """Says yes; before that somebody turns the robot."""

    def __init__(self, operator) -> None:
        super().__init__()
        self.operator = operator
        self.asked = []

    def decide(self, review):
        self.asked.append(review.came_through)
        if len(self.asked) == 1:
            self.operator.robot.turn(180)
            return "approve", "a"
        return "reject", ""


def test_in_the_terminal_it_is_laid_before_them_once_more(operator, log, capsys) -> None:
    nurse = Nurse(operator)
    Session(operator, nurse).perform_program(AHEAD)
    assert nurse.asked == [True, False]
    assert "Something has changed here since you looked at it." in capsys.readouterr().out
    assert log.runs() == []


def test_at_the_desk_it_is_laid_before_them_once_more(log, sit_down) -> None:
    behind_the_scenes = []
    console = behind_the_scenes.append
    with simulated_station(load_world("ward"), log, seed=1, console=console) as station:
        dialogue = Dialogue(behind_the_scenes[0], "test")
        dialogue.propose(AHEAD, "en", "Nurse Kim")
        shown = dialogue.draft.review
        assert shown.came_through
        sit_down(station).robot.turn(180)
        dialogue.approve(AHEAD, "Nurse Kim", "en", shown.sha256)
        assert "Run it all the same" in dialogue.lines[-1].text
        assert not dialogue.draft.review.came_through
        assert log.runs() == []
        dialogue.approve(AHEAD, "Nurse Kim", "en", shown.sha256, insists=True)
        assert len(log.runs()) == 1
