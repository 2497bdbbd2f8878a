"""What only looks or tells is done without a question; nothing that moves or reaches people is."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nl2robot.errors import ExitStatus
from nl2robot.run.runlog import RunLog
from nl2robot.station.harmless import HARMLESS, only_looks_or_tells
from robot_api.methods import METHODS

REACHING = {"hearing", "screen", "telepresence", "manipulation", "guiding", "following", "scanner"}
"""What takes people's time, or their hands."""


def test_what_is_harmless_moves_nothing_and_reaches_nobody() -> None:
    for name in HARMLESS:
        method = METHODS[name]
        assert not method.moves
        assert method.capability not in REACHING or name == "answer"
    assert not HARMLESS & {"ask", "listen", "touch", "call", "show", "set_volume", "wait_for"}


@given(
    st.sampled_from(sorted(METHODS)),
    st.sampled_from(
        [
            "robot.{}()",
            "robot.say(f'{{robot.{}()}}')",
            "go = robot.{}\ngo()",
            "r = robot\nr.{}()",
            "getattr(robot, '{}')()",
            "if robot.sees('person'):\n    robot.{}()",
            "x = [robot.{}() for _ in [1]]",
            "while True:\n    robot.{}()",
            "def f(r):\n    r.{}()\nf(robot)",
        ]
    ),
)
def test_no_way_leads_past_the_table(method: str, program: str) -> None:
    if method not in HARMLESS:
        assert not only_looks_or_tells(program.format(method))


def test_who_listens_is_not_harmless() -> None:
    assert only_looks_or_tells('robot.answer("When is lunch?")')
    assert not only_looks_or_tells("robot.answer()")


@pytest.fixture
def approved_by(home):
    def approved_by() -> list[str]:
        log = RunLog(home / "runs.sqlite")
        found = [run.approved_by for run in reversed(log.runs())]
        log.close()
        return found

    return approved_by


def test_the_time_is_told_without_a_question(nl2robot, approved_by) -> None:
    status, out, _ = nl2robot("run", "--world", "ward", "what time is it?")
    assert status == ExitStatus.OK
    assert out.rstrip().endswith("It is 08:00.")
    assert approved_by() == ["Nurse Kim, needed no question (it only looks or tells)"]


def test_whoever_wants_to_be_asked_is(start, approved_by, monkeypatch) -> None:
    command = start("run", "--world", "ward", "--ask-always", "what time is it?", at_terminal=True)
    command.until("eject? ")
    command.type("a\n")
    command.until("It is 08:00.")
    assert command.end() == ExitStatus.OK
    assert approved_by() == ["Nurse Kim"]
    monkeypatch.setenv("NL2ROBOT_ASK_ALWAYS", "1")
    command = start("run", "--world", "ward", "what time is it?", at_terminal=True)
    command.until("eject? ")
    command.type("r\n")
    assert command.end() == ExitStatus.NOT_APPROVED


def test_what_moves_is_asked_about(start) -> None:
    command = start("run", "--world", "ward", "go to ward a", at_terminal=True)
    command.until("eject? ")
    command.type("r\n")
    assert command.end() == ExitStatus.NOT_APPROVED
