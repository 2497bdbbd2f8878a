"""What somebody approves is what runs: programs that look other than they are are refused."""

from __future__ import annotations

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from robot_api.stub import stub
from sandbox.check import check
from sandbox.disguise import hidden_signs, strange_letters, without_comments

SAY = 'robot.say("Hello.")\n'


def codes(program: str) -> set[str]:
    return {each.code for each in check(program, stub()) if each.severity == "error"}


@pytest.mark.parametrize(
    "program",
    [
        'robot.say("abc\N{RIGHT-TO-LEFT OVERRIDE}def")\n',
        f"{SAY}# harmless \N{RIGHT-TO-LEFT ISOLATE} \n",
        'robot.say("a\N{ZERO WIDTH SPACE}b")\n',
        'robot.say("a\x0bb")\n',
        "rob\N{CYRILLIC SMALL LETTER O}t = 1\n",
        "\N{FULLWIDTH LATIN SMALL LETTER R}obot.say('Hello.')\n",
        "\N{GREEK SMALL LETTER ALPHA} = 1\n",
    ],
)
def test_signs_that_nobody_sees_and_letters_of_other_alphabets(program: str) -> None:
    assert "disguised" in codes(program)


@pytest.mark.parametrize(
    "program",
    [
        'größe = 2\nrobot.say(f"{größe} Zentimeter, s\'il vous plaît.")\n',
        'robot.say("\N{MAN}\N{ZERO WIDTH JOINER}\N{WOMAN}, \u0645\u0631\u062d\u0628\u0627!")\n',
        f"\t\n{SAY}",
    ],
)
def test_what_people_write_in_their_languages_is_taken(program: str) -> None:
    assert codes(program) == set()


@pytest.mark.parametrize(
    "program",
    [
        "def greet(name=robot.ask('Who?')):\n    robot.say(name)\ngreet()\n",
        "def greet(*, name=robot.ask('Who?')):\n    robot.say(name)\ngreet()\n",
        "def greet(name: robot.ask('Who?')):\n    robot.say('a')\ngreet('b')\n",
        "def greet() -> robot.ask('Who?'):\n    robot.say('a')\ngreet()\n",
        "f = lambda name=robot.ask('Who?'): name\nf()\n",
    ],
)
def test_no_robot_call_hides_where_a_function_is_defined(program: str) -> None:
    assert "callback" in codes(program)


@pytest.mark.parametrize(
    "comment", ["type: ignore", "type:ignore[all]", "pyright: ignore", "ty: ignore", "noqa"]
)
def test_no_comment_silences_the_check(comment: str) -> None:
    assert codes(f"robot.fly('away')  # {comment}\n") == {"unresolved-attribute"}
    assert codes(f"# {comment}\nrobot.fly('away')\n") == {"unresolved-attribute"}


def test_what_looks_like_a_comment_in_a_text_is_none() -> None:
    program = 'robot.say("# type: ignore")  # a comment\n'
    assert without_comments(program).rstrip() == 'robot.say("# type: ignore")'
    assert codes(program) == set()


@example("\r\x80")
@given(st.text())
def test_whatever_is_written_is_looked_at(program: str) -> None:
    list(hidden_signs(program))
    list(strange_letters(program))
    assert without_comments(program).count("\n") == program.count("\n")
