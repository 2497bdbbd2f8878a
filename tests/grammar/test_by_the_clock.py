"""Times of day are moments: a night shift that greets until six, run over midnight."""

from __future__ import annotations

from datetime import datetime

import pytest

from grammar.plan import Plan
from grammar.planning.by_the_clock import by_the_clock
from grammar.program import write_program
from grammar.program_parser import parse_program
from grammar.understand import understand
from robot_api.driver import StopFlag
from robot_api.drivers import emulated
from sandbox.execution import Execution
from tests.grammar.hospitals import hospital


def ends(program: str, begins: datetime) -> str:
    """When a robot that begins then is through with it."""
    robot = emulated(start=begins, results={"wait_for": False})

    def call(method: str, arguments: dict[str, object], line: int) -> object:
        if method == "wait_for":
            robot.call("wait", {"seconds": 600}, StopFlag())  # nobody comes for ten minutes
        return robot.call(method, arguments, StopFlag())

    outcome = Execution(program, call).run()
    assert outcome.status == "done", outcome.message
    clock = robot.call("clock", {}, StopFlag())
    return f"{clock.weekday} {clock.time}"


def program_of(sentence: str) -> str:
    plan = understand(sentence, hospital("en"), "en").plan
    assert plan is not None, sentence
    return write_program(plan)


@pytest.mark.parametrize(
    "sentence, begins, is_through",
    [
        ("greet the visitors until six in the morning", (20, 22, 5), "Saturday 06:05"),
        ("greet the visitors until six in the morning", (21, 0, 5), "Saturday 06:05"),
        ("greet the visitors until midnight", (20, 22, 5), "Saturday 00:05"),
        ("at midnight go to the lobby", (20, 22, 5), "Saturday 00:00"),
        ("at six in the morning go to the lobby", (20, 6, 5), "Saturday 06:00"),
        ("tomorrow at eight go to the lobby", (20, 6, 5), "Saturday 08:00"),
        ("on Monday at eight go to the lobby", (20, 6, 5), "Monday 08:00"),
        ("between two and four greet the visitors", (20, 9, 0), "Friday 16:00"),
        ("between two and four greet the visitors", (20, 15, 5), "Friday 16:05"),
        ("between two and four greet the visitors", (20, 17, 0), "Saturday 16:00"),
        ("between ten pm and six am greet the visitors", (21, 1, 5), "Saturday 06:05"),
    ],
)
def test_it_is_done_at_the_next_such_moment(
    sentence: str, begins: tuple[int, int, int], is_through: str
) -> None:
    day, hour, minute = begins  # the twentieth is a Friday
    start = datetime(2026, 11, day, hour, minute)
    assert ends(program_of(sentence), start) == is_through


def plan_of(source: str) -> Plan:
    return parse_program(source, "en")


def test_whoever_writes_until_as_a_comparison_is_understood() -> None:
    """As the language model does."""
    written = plan_of(
        'while robot.clock().time < "06:00":\n    robot.wait(10)\n'
        'while robot.clock().time < "07:00":\n    robot.say("Good morning.")\n'
    )
    source = write_program(by_the_clock(written, whiles=True))
    assert 'robot.wait_until("06:00")' in source
    assert 'while not has_come("07:00", begin):' in source
    assert parse_program(source, "en") == parse_program(write_program(plan_of(source)), "en")


def test_how_late_it_is_stays_a_question() -> None:
    for source in (
        'if robot.clock().time >= "18:00":\n    robot.say("Good evening.")\n',
        'while robot.clock().time < "12:00":\n    robot.say("Good morning.")\n',
    ):
        assert by_the_clock(plan_of(source)) == plan_of(source)
