"""What Monty is given is the program as it stands, line by line."""

from __future__ import annotations

import pytest

from sandbox.source import unix_newlines, with_values


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("here = robot.location()", "here = _robot_location(robot.location())"),
        ("[robot .\n clock( )]", "[_robot_clock(robot .\n clock( ))]"),
        ("f'{robot.clock()!r:>9}'", "f'{_robot_clock(robot.clock())!r:>9}'"),
        ("'ä', robot.clock()", "'ä', _robot_clock(robot.clock())"),
        ("f\"{'{'} {robot.clock()}\"", "f\"{'{'} {_robot_clock(robot.clock())}\""),
        ("f\"{f'{robot.clock()}'}\"", "f\"{f'{_robot_clock(robot.clock())}'}\""),
    ],
)
def test_what_a_place_is_made_of_is_asked_where_the_call_stands(
    program: str, expected: str
) -> None:
    assert with_values(program) == expected


@pytest.mark.parametrize(
    "program",
    [
        "robot.say('robot.location()')  # robot.location()",
        "robot.say(f'{{robot.location()}} robot.location()')",
        "robot.say(f\"{'robot.location()'}\")",
        "robot.say(f\"{x:'>5}' robot.location() {y}}}\")",
        "ward.robot.location()",
        "robot.location(1)",
        "'''\nrobot.clock()\n'''",
    ],
)
def test_what_is_no_call_stays_as_it_is(program: str) -> None:
    assert with_values(program) == program


def test_a_carriage_return_ends_a_line_as_python_reads_it() -> None:
    assert unix_newlines("a\r\nb\rc\n\r") == "a\nb\nc\n\n"
