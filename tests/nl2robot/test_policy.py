"""What this robot or this hospital does not have is told at review, on its line."""

import msgspec
import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.review.policy import violations
from robot_api.driver import Capabilities
from robot_api.methods import METHODS
from sim.world.loading import load_world

ROBOT = Capabilities(
    name="Otto",
    kind="emulator",
    methods=tuple(METHODS),
    emotions=("happy", "sad"),
    gestures=("wave",),
    joints={"head_yaw": (-60, 60)},
    skills={"sit": "Sits down."},
    contacts=("Ward office",),
)


@pytest.fixture(scope="module")
def world():
    return load_world("city-hospital")


def found(program: str, world, robot: Capabilities | None = ROBOT) -> list[tuple[int, str]]:
    return [(f.line, f.code) for f in violations(program, Knowledge(world, robot))]


def test_a_round_through_known_places_has_nothing_against_it(world) -> None:
    program = 'robot.goto("pharmacy")\nrobot.gesture("wave")\nrobot.joint("head_yaw", 45)\n'
    assert found(program, world) == []


@pytest.mark.parametrize(
    ("line", "code"),
    [
        ('robot.goto("moon base")', "unknown-place"),
        ('robot.guide("visitor", place="moon base")', "unknown-place"),
        ('robot.follow("Alice", to="moon base")', "unknown-place"),
        ('robot.emotion("jealous")', "unknown-emotion"),
        ('robot.gesture(name="somersault")', "unknown-gesture"),
        ('robot.call("Elvis")', "unknown-contact"),
        ('robot.do("fly")', "unknown-skill"),
        ('robot.joint("tail", 10)', "unknown-joint"),
        ('robot.joint("head_yaw", 90)', "out-of-range"),
        ("robot.set_volume(150)", "bad-value"),
        ('robot.set_language("klingon")', "unknown-language"),
        ('robot.say("")', "bad-value"),
    ],
)
def test_a_line_that_cannot_work_is_named(line, code, world) -> None:
    findings = found(f"robot.stop()\nif True:\n    {line}\n", world)
    assert (3, code) in findings, findings


def test_the_nearest_place_is_offered(world) -> None:
    [finding] = violations('robot.goto("farmacy")', Knowledge(world, ROBOT))
    assert "Did you mean pharmacy" in finding.message


def test_a_value_that_cannot_be_is_told_with_what_can(world) -> None:
    [finding] = violations("robot.goto(3)", Knowledge(world, ROBOT))
    assert "must be a text of 1 to 200 characters or a location" in finding.message
    assert "got 3" in finding.message


def test_a_robot_without_arms_is_not_sent_to_fetch(world) -> None:
    armless = msgspec.structs.replace(
        ROBOT, methods=tuple(name for name in METHODS if name not in ("grab", "put", "give"))
    )
    [(line, code)] = found('robot.goto("pharmacy")\nrobot.grab("cup")\n', world, armless)
    assert (line, code) == (2, "not-supported")


def test_names_worked_out_at_run_time_are_left_to_the_robot(world) -> None:
    assert found('for office in robot.places("office"):\n    robot.goto(office)\n', world) == []


@pytest.mark.parametrize(
    "text", ["", "robot.goto(", "\0", "(" * 500, "é = robot.goto('x'", "a" * 9]
)
def test_what_is_no_program_has_no_violations(text, world) -> None:
    assert found(text, world) == []
