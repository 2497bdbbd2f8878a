"""What a draft would do is found out on paper: at once, whatever is in it, and nobody is harmed."""

from __future__ import annotations

import time
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nl2robot.deliberation import playing
from nl2robot.deliberation.paper_robot import START, Scene
from nl2robot.deliberation.playing import LIMITS, Course, played
from robot_api.methods import METHODS

WARDS = {"ward a": "ward", "ward b": "ward"}


def scene(**known: object) -> Scene:
    return Scene(places=WARDS, **known)  # type: ignore[arg-type]


def told(course: Course) -> list[str]:
    return [str(event) for event in course.events]


# --- what happens


def test_a_round_is_told_as_it_happens() -> None:
    course = played(
        'for place in robot.places("ward"):\n'
        "    robot.goto(place)\n"
        "    for person in robot.people():\n"
        '        robot.ask("Tea?", ["yes", "no"], person=person)\n',
        scene(people={"Alice": "ward a", "Henry": "ward b"}, option=0),
    )
    assert course.end == "done"
    assert told(course) == [
        "visits 'ward a' at ward a",
        "asks 'Tea?' (Alice) at ward a",
        "visits 'ward b' at ward b",
        "asks 'Tea?' (Henry) at ward b",
    ]


@pytest.mark.parametrize(
    ("option", "answer"), [(0, "tea"), (1, "coffee"), (2, "water"), (3, "tea")]
)
def test_people_choose_each_of_the_answers(option: int, answer: str) -> None:
    asks = 'robot.say(robot.ask("What would you like?", ["tea", "coffee", "water"]))'
    [_, said] = played(asks, scene(option=option)).events
    assert said.what == answer


def test_open_questions_get_an_answer_that_somebody_listens_for() -> None:
    listens = 'if "yes" in robot.ask("Tea?").lower():\n    robot.say("Right away.")\n'
    assert [
        len(played(listens, scene(option=option, replies=("yes", "no"))).events)
        for option in (0, 1)
    ] == [2, 1]
    [_, said] = played('robot.say(robot.ask("How many?"))', scene(option=3)).events
    assert said.what == "3"


def test_things_that_are_gone_cannot_be_taken() -> None:
    takes = 'robot.goto("ward a")\nrobot.grab("cup")\n'
    assert played(takes, scene(things=[("red cup", "ward a")])).end == "done"
    gone = played(takes, scene())
    assert gone.end == "failed"
    assert "cup" in gone.message


def test_a_bottle_is_a_bottle_and_no_passer_by() -> None:
    looks = 'robot.say("Yes." if robot.sees("bottle") else "No.")'
    with_somebody = scene(people={"Alice": START})
    assert played(looks, with_somebody).events[-1].what == "No."
    with_water = scene(things=[("bottle of water", START)])
    assert played(looks, with_water).events[-1].what == "Yes."
    assert played('robot.grab("water")', with_water).end == "done"


def test_somebody_is_known_by_what_they_are_like() -> None:
    looks = 'robot.say("Yes." if robot.sees("a person with glasses") else "No.")'
    known = scene(people={"Zoe": START}, traits={"Zoe": "person with Glasses"})
    assert played(looks, known).events[-1].what == "Yes."
    assert played(looks, scene(people={"Zoe": START})).events[-1].what == "No."


def test_the_robot_comes_back_to_wherever_it_was() -> None:
    for where in ("robot.goto(3, 4)", "robot.dock()", 'robot.goto("ward a")', ""):
        course = played(
            f'{where}\nhome = robot.location()\nrobot.goto("ward b")\nrobot.goto(home)\n', scene()
        )
        assert course.end == "done", where
        assert course.events[-1].at == (course.events[0].at if where else START)


def test_time_flies_while_the_robot_waits_for_an_hour() -> None:
    waits = 'while robot.clock().time < "21:00":\n    robot.wait(10)\nrobot.goto("ward a")\n'
    course = played(waits, scene(hurried=True))
    assert course.end == "done"
    assert [event.kind for event in course.events] == ["waits", "visits"]


def test_values_that_are_written_otherwise_are_the_same() -> None:
    one = played("robot.drive(0.5, 0, 2)", scene())
    other = played("robot.drive(seconds=2.0, angular=0.0, linear=0.5)", scene())
    assert one == other


# --- how it ends


@pytest.mark.parametrize(
    "program",
    [
        'while True:\n    robot.say("Tea!")\n',
        "while True:\n    robot.location()\n",
        "while True:\n    robot.wait(60)\n",
        'while True:\n    try:\n        robot.goto("?")\n    except Exception:\n        pass\n',
        "while True:\n    pass\n",
        "import time\nwhile True:\n    time.sleep(1)\n",
        '[robot.say("Tea!") for cup in range(10**9)]',
        'robot.wait_for("Godot")',
    ],
)
def test_what_goes_on_for_ever_ends(program: str) -> None:
    course = played(program, scene(hurried=True))
    assert course.end == "over"
    assert course.message == ""


HOSTILE = {
    "computes without end": "sum(range(10**12))",
    "eats memory": "tea = [1]\nwhile True:\n    tea = tea + tea\n",
    "eats memory in one bite": '"tea" * 10**10',
    "a number as large as the hospital": "10 ** 10**8",
    "calls itself": "def tea(cup):\n    return tea(cup + 1)\ntea(1)\n",
    "prints without end": 'while True:\n    print("tea" * 1000)\n',
    "reaches for the system": 'import os\nos.system("reboot")\n',
    "reaches into the robot": "robot.scene.places.clear()\n",
    "wants the robot's secrets": 'robot._answer("nurse", "?")\n',
    "wants what there is not": "robot.fly()\n",
    "leaves": "raise SystemExit\n",
    "is no Python": "robot.goto(\n",
    "has no end of brackets": "x = " + "(" * 5000 + ")" * 5000,
    "is one long sum": "x = 1" + " + 1" * 20_000,
    "is longer than any program": "# tea\n" * 20_000,
    "has a zero in it": "robot.say('\0')",
    "has half a letter in it": "robot.say('\udcff')",
    "sleeps beyond the end of time": "import time\ntime.sleep(1e18)\n",
}


@pytest.mark.parametrize("program", HOSTILE.values(), ids=HOSTILE)
def test_hostile_programs_end_within_their_limits(
    program: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    # What never stops computing would do so for half a minute.
    monkeypatch.setattr(playing, "LIMITS", replace(LIMITS, computing=2.0))
    known = scene()
    begun = time.monotonic()
    course = played(program, known)
    assert course.end in ("failed", "over")
    assert course.events == ()
    assert known.places == WARDS
    # Five times what they may compute: the computer may have other things to do.
    assert time.monotonic() - begun < 5 * LIMITS.total_computing


def test_what_fails_says_at_what() -> None:
    course = played('robot.goto("cellar")', scene())
    assert (course.end, course.message) == ("failed", "There is no place called cellar.")


_VALUES = st.one_of(
    st.sampled_from(["ward a", "cup", "", "person", "Alice", "#top", "https://example.org"]),
    st.integers(-5, 100_000),
    st.floats(allow_nan=True, allow_infinity=True, width=16),
    st.none(),
    st.lists(st.sampled_from(["yes", "no", ""]), max_size=3),
    st.booleans(),
)


@settings(max_examples=60)
@given(method=st.sampled_from(sorted(METHODS)), values=st.lists(_VALUES, max_size=4))
def test_no_call_of_any_method_is_too_much(method: str, values: list[object]) -> None:
    arguments = ", ".join(map(repr, values)).replace("inf", "1e400").replace("nan", "(1e400 * 0)")
    people = {"Alice": START, "person 1": "ward a"}
    things = [("cup", START)]
    program = f"result = robot.{method}({arguments})\nprint(result)\n"
    course = played(program, scene(people=people, things=things, option=1))
    assert course.end in ("done", "failed", "over")
