"""A round goes on when one of its places cannot be reached."""

import pytest

from robot_api.errors import Blocked, LostConnection
from sandbox.execution import Execution
from sandbox.visits import going_on

ROUND = """\
seen = []
for place in ["ward a", "ward b", "ward c"]:
    robot.goto(place)
    robot.say(place)
    seen.append(place)
print(len(seen))
"""


def run(program: str, closed: str = "ward b", error=Blocked):
    calls, told, printed = [], [], []

    def call(method, arguments, line):
        calls.append((method, *[value for value in arguments.values() if value is not None]))
        if method == "goto" and arguments["place"] == closed:
            raise error("A bed is in the way.")

    execution = Execution(
        program, call, on_print=printed.append, on_closed=lambda *place: told.append(place)
    )
    return execution.run(), calls, told, "".join(printed)


def test_the_visit_is_left_out_and_told() -> None:
    outcome, calls, told, printed = run(ROUND)
    assert outcome.status == "done"
    assert [call for call in calls if call[0] == "say"] == [("say", "ward a"), ("say", "ward c")]
    assert told == [("ward b", "A bed is in the way.")]
    assert printed == "2\n"


def test_nothing_is_different_where_nothing_is_closed() -> None:
    outcome, calls, told, printed = run(ROUND, closed="nowhere")
    assert (outcome.status, len(calls), told, printed) == ("done", 6, [], "3\n")


def test_another_trouble_still_ends_the_program() -> None:
    outcome, _, told, _ = run(ROUND, error=LostConnection)
    assert (outcome.status, outcome.error, outcome.line) == ("failed", "LostConnection", 3)
    assert told == []


@pytest.mark.parametrize(
    "program",
    [
        'robot.goto("ward b")\n',
        'for place in ["ward b"]:\n    robot.goto(place)\n',
        'for name in ["a", "b"]:\n    robot.goto("ward b")\n',
        'for place in ["ward a", "ward b"]:\n    robot.say("On my way.")\n    robot.goto(place)\n',
    ],
)
def test_what_is_no_round_fails_as_ever(program) -> None:
    outcome, _, told, _ = run(program)
    assert (outcome.status, outcome.error) == ("failed", "Blocked")
    assert told == []


def test_a_program_that_sees_to_it_by_itself_is_left_alone() -> None:
    program = (
        'try:\n    for place in ["ward a", "ward b"]:\n        robot.goto(place)\n'
        'except Exception:\n    robot.say("No.")\n'
    )
    outcome, calls, told, _ = run(program)
    assert (outcome.status, calls[-1], told) == ("done", ("say", "No."), [])
    assert going_on(program) == (program, frozenset())


def test_the_lines_stay_where_they_are() -> None:
    written, lines = going_on(ROUND)
    assert lines == {3}
    assert len(written.splitlines()) == len(ROUND.splitlines())
    assert [a for a, b in zip(written.splitlines(), ROUND.splitlines(), strict=True) if a != b] == [
        "    if robot.goto(place) == False: continue"
    ]


def test_a_program_that_came_nowhere_has_failed() -> None:
    program = 'for place in ["ward b", "ward b"]:\n    robot.goto(place)\nprint("over")\n'
    outcome, _, told, printed = run(program)
    assert (outcome.status, outcome.error, outcome.line) == ("failed", "Blocked", 2)
    assert (len(told), printed) == (2, "over\n")
