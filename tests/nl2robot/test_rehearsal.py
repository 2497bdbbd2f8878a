"""The dry run: what a program would do, found out before it may."""

import pytest

from nl2robot.rehearsal import rehearse
from sim.simulation import Simulation
from sim.world import load_world


@pytest.fixture
def ward():
    return Simulation(load_world("ward"), seed=1)


def test_the_way_the_words_and_the_time_are_foreseen(ward) -> None:
    told = rehearse(
        'robot.goto("ward a")\nrobot.ask("Tea?", ["yes", "no"], person="Alice")\n'
        'robot.say("Good night.")\nrobot.show(text="Sleep well")\nrobot.grab("cup")\n',
        ward,
    )
    assert (told.status, told.message, told.line) == ("done", None, None)
    assert told.places == ("charger", "corridor", "ward a")
    assert told.asks == ("Tea?",)
    assert "Good night." in told.says
    assert "Sleep well" in told.shows
    assert told.holds == ("cup",)
    assert told.metres == pytest.approx(6, abs=2)
    assert told.seconds > 4
    assert told.calls == 5
    apart = [
        ((x2 - x1) ** 2 + (y2 - y1) ** 2) ** 0.5
        for (x1, y1), (x2, y2) in zip(told.path, told.path[1:], strict=False)
    ]
    assert min(apart) > 0.4


def test_a_failure_is_foreseen_with_its_line(ward) -> None:
    told = rehearse('robot.say("Now.")\nrobot.grab("unicorn")\n', ward)
    assert (told.status, told.line) == ("failed", 2)
    assert "unicorn" in told.message


def test_a_program_that_stops_the_robot_ends_there(ward) -> None:
    told = rehearse('robot.goto("ward a")\nrobot.stop()\nrobot.goto("ward b")\n', ward)
    assert (told.status, told.line, told.calls) == ("stopped", 2, 2)
    assert told.places[-1] == "ward a"


@pytest.mark.parametrize(
    "program",
    [
        'while True:\n    robot.goto("ward a")\n    robot.goto("ward b")\n',
        "while True:\n    robot.battery()\n",
        "robot.wait(86400)\nrobot.wait(86400)\nrobot.wait(86400)\n",
        'while True:\n    try:\n        robot.goto("ward b")\n        robot.goto("ward a")\n'
        "    except Exception:\n        pass\n",
        "while True:\n    pass\n",
    ],
)
def test_what_takes_too_long_is_cut_short(ward, program) -> None:
    told = rehearse(program, ward, real_seconds=0.5)
    assert (told.status, told.message) == ("unfinished", None)


def test_what_computes_too_much_is_foreseen(ward) -> None:
    told = rehearse('print("x" * 100)\nwhile True:\n    print("x" * 5000)\n', ward)
    assert told.status == "limit"
    assert "printed more" in told.message


def test_a_skill_of_the_real_robot_does_not_fail_for_the_simulated_one(ward) -> None:
    program = 'robot.do("sit")\nrobot.say("Hello!")\n'
    told = rehearse(program, ward, skills={"sit": "sit down"})
    assert (told.status, told.message) == ("done", None)
    assert "Hello!" in told.says


def test_a_skill_that_no_robot_has_fails(ward) -> None:
    told = rehearse('robot.do("juggle")\n', ward, skills={"sit": "sit down"})
    assert (told.status, told.line) == ("failed", 1)
    assert "juggle" in told.message
