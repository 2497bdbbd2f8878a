"""A program is read before it runs, and everything that is wrong with it is said at once."""

from __future__ import annotations

import ast
import os
import random
import signal
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from grammar.program import write_program
from robot_api.driver import Capabilities
from robot_api.stub import stub
from sandbox import diagnosis
from sandbox.check import Finding, check
from sandbox.limits import MAX_PROGRAM
from tests.grammar.random_plans import plans

STUB = stub()
MODEST = settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))

GOOD = """\
import math
import random

desk = robot.location()
names = []
for office in robot.places("office"):
    try:
        robot.goto(office)
        if robot.sees("person") and robot.count("cup") > 2:
            names.append(office)
        elif not robot.find("stapler", place=office):
            robot.say(random.choice(["Nothing here.", "Empty."]))
    except Exception as problem:
        robot.say(f"I could not get there: {problem}")
answer = robot.ask("Coffee?", ["yes", "no"])
while "yes" not in answer.lower():
    answer = robot.listen("Please.", timeout=5)


def greet(name):
    robot.say("Hello " + name)


greet("Alice")
if any(name == "Alice" for name in robot.people()):
    robot.wait(math.floor(2.5))
robot.goto(desk)
robot.say(f"{desk} {desk.x:.1f} {robot.clock().time} {', '.join(names)}")
robot.do("sit", slowly=True)
"""


def found(program: str) -> list[tuple[int, str, str]]:
    return [(each.line, each.severity, each.code) for each in check(program, STUB)]


def test_a_good_program_has_no_findings() -> None:
    assert check(GOOD, STUB) == []


def test_everything_is_said_at_once_with_line_and_column() -> None:
    findings = check(
        'robot.sey("x")\nrobot.say(5)\nimport os\nrobot.goto()\nfor x in robot.people():\n'
        "    y = any(robot.sees(x) for x in [1])\nrobot.say(unknown)\n",
        STUB,
    )
    assert [(each.line, each.column) for each in findings] == [
        (1, 1),
        (2, 11),
        (3, 1),
        (4, 1),
        (6, 12),
        (7, 11),
    ]
    assert all(each.severity == "error" for each in findings)


def test_columns_count_characters() -> None:
    [finding] = check('robot.say("ÄÖÜ👍" + unknown)', STUB)
    assert finding.column == 20


@pytest.mark.parametrize(
    ("program", "message"),
    [
        ("robot.sey('x')", "The robot has no method sey. Did you mean say?"),
        ("say('x')", "There is nothing called say. Did you mean robot.say(...)?"),
        ("robot.say()", "robot.say needs its text. Write it between the brackets."),
        (
            "robot.say(5)",
            "say wants a text here, not 5. Change what stands between the brackets.",
        ),
        (
            "robot.say(robot.location().place)",
            "say wants a text here, and this may be nothing. Put str(...) around it.",
        ),
        (
            "if robot.battery < 20:\n    robot.dock()",
            "A robot method has to be called where it stands. Write robot.battery(...).",
        ),
        (
            "import time",
            "There is no module time here. Use robot.wait(...) and robot.clock() instead.",
        ),
        (
            "robot = 3",
            "The name robot belongs to the robot. Choose another name.",
        ),
        (
            "while robot.sees('x')\n    pass",
            "Python does not understand this: expected ':'. Correct it here or just before.",
        ),
        (
            "if robot.listen() > 3:\n    robot.dock()",
            "> does not work between a text and 3. Convert one, as in int(...).",
        ),
        (
            "robot.say('x', loud=True)",
            "say knows no loud. Leave it out, or correct its name.",
        ),
    ],
)
def test_messages_are_for_people(program: str, message: str) -> None:
    assert [each.message for each in check(program, STUB)] == [message]


def test_what_this_robot_lacks_is_found_before_it_moves() -> None:
    can = Capabilities(name="Dog", kind="dog", methods=("goto", "do", "wait"))
    [finding] = check('robot.goto("lab")\nrobot.say("wuff")', stub(can))
    assert (finding.line, finding.severity) == (2, "error")
    assert "cannot" in finding.message


@pytest.mark.parametrize(
    "program",
    [
        "def f():\n    yield robot.battery()",
        "class Cat(dict):\n    pass",
        "class Cat:\n    @property\n    def name(self):\n        return 1",
        "x = 1\ndel x",
        "with open('x') as file:\n    pass",
        "async def f():\n    pass",
        "x = 1 @ 2",
        "from math import *",
        "from . import x",
        "import os",
        "getattr(robot, 'say')('x')",
        "eval('robot.say(1)')",
        "x = ().__class__",
        # every way to give `robot` another meaning, or another name
        "for robot in [1]:\n    pass",
        "def robot():\n    pass",
        "def f(robot):\n    pass",
        "import math as robot",
        "[robot for robot in [1]]",
        "try:\n    pass\nexcept Exception as robot:\n    pass",
        "robot.say = 3",
        "if (robot := 3):\n    pass",
        "match 1:\n    case robot:\n        pass",
        "r = robot\nr.say('x')",
        "f = robot.say\nf('x')",
        "[robot][0].say('x')",
        "print(robot)",
        # robot calls that Python would make on its own
        "any(robot.sees(x) for x in ['a'])",
        "sorted(['a'], key=lambda x: robot.count(x))",
        "list(map(robot.count, ['a']))",
        "def f(x):\n    return robot.count(x)\nlist(filter(f, ['a']))",
        "def f(x):\n    return robot.count(x)\ndef g(x):\n    return f(x)\nmax(['a'], key=g)",
        "class A:\n    def __str__(self):\n        return robot.listen()",
    ],
)
def test_what_is_refused(program: str) -> None:
    assert any(severity == "error" for _, severity, _ in found(program)), found(program)


def test_loops_are_looked_at() -> None:
    assert found("while True:\n    robot.say('x')") == [(1, "warning", "endless-loop")]
    assert found("while True:\n    x = 1") == [(1, "warning", "busy-loop")]
    assert found("while not robot.sees('x'):\n    robot.emotion('sad')") == [
        (1, "warning", "busy-loop")
    ]
    assert found("while not robot.sees('x'):\n    robot.wait(1)") == []
    assert found("while True:\n    robot.wait(1)\n    if robot.sees('x'):\n        break") == []
    inner = "while True:\n    robot.wait(1)\n    for x in [1]:\n        break"
    assert found(inner) == [(1, "warning", "endless-loop")]


def test_a_loop_that_never_goes_round_is_no_busy_one() -> None:
    once = "while True:\n    try:\n        robot.battery()\n        break\n    except Exception:\n"
    assert found(f"{once}        break") == []
    assert found(f"{once}        pass") == [(1, "warning", "busy-loop")]
    asked = "while True:\n    if robot.sees('x'):\n        break\n    else:\n"
    assert found(f"{asked}        raise ValueError") == []
    assert found(f"{asked}        continue\n    break") == [(1, "warning", "busy-loop")]


@pytest.mark.parametrize(
    ("program", "code"),
    [
        ("x = 1\n" * MAX_PROGRAM, "too-long"),
        ("x = " + "[" * 150 + "]" * 150, "too-deep"),
        ("x = " + "-" * 20000 + "1", "too-deep"),
        ("x = " + "(" * 5000 + ")" * 5000, "syntax"),
        ("x = " + "1 + " * 15000 + "1", "too-deep"),
        ("".join(" " * i + "if 1:\n" for i in range(90)) + " " * 90 + "pass", "too-deep"),
        ("x = '\x00'", "syntax"),
        ("x = '\ud800'", "syntax"),
        ("break", "syntax"),
        ("return 1", "syntax"),
        ("'\\N{nothing}'", "syntax"),
    ],
)
def test_what_cannot_be_a_program(program: str, code: str) -> None:
    [finding] = check(program, STUB)
    assert (finding.severity, finding.code) == ("error", code)


def test_an_empty_program_is_one() -> None:
    assert check("", STUB) == []
    assert check("# nothing\n", STUB) == []


@MODEST
@given(st.text())
def test_no_text_confuses_the_check(text: str) -> None:
    assert all(isinstance(finding, Finding) for finding in check(text, STUB))


PIECES = [
    *"()[]{}:,.=+-*/%@&|^~<>!\"'\\\n\r\t #",
    *("robot", "say", "goto", " if ", " else ", " for ", " in ", "while ", "lambda x:", "def f():"),
    *("yield ", "await ", "class A:", "import ", "from ", "\n    ", "\n  ", "f'{", "}'", "None"),
    *(
        "0",
        "1.5",
        "'x'",
        "x",
        "é",
        "__x__",
        "match x:\n    case ",
        "try:\n",
        "except:\n",
        "del ",
        "return ",
    ),
]


@MODEST
@given(st.lists(st.sampled_from(PIECES), max_size=30).map("".join))
def test_no_broken_program_confuses_the_check(text: str) -> None:
    check(text, STUB)


def random_tree(seed: int) -> str:
    """A random program made of any nodes that Python has."""
    chance = random.Random(seed)
    # By the grammar's own classes: `vars(ast)` still names some that Python is about to drop.
    kinds = [*ast.expr.__subclasses__(), *ast.stmt.__subclasses__()]
    expressions = [kind for kind in kinds if issubclass(kind, ast.expr) and kind is not ast.expr]
    statements = [kind for kind in kinds if issubclass(kind, ast.stmt) and kind is not ast.stmt]

    def node(kinds: list[type[Any]], depth: int) -> Any:
        if depth <= 0 and kinds is expressions:
            return ast.Name(chance.choice(["robot", "x", "len"]), ast.Load())
        if depth <= 0:
            return ast.Pass()
        kind = chance.choice(kinds)
        return kind(**{field: value(field, depth - 1) for field in kind._fields})

    def value(field: str, depth: int) -> Any:
        one = node(expressions, depth)
        match field:
            case "body" | "orelse" | "finalbody":
                return [node(statements, depth)]
            case "targets" | "values" | "elts" | "keys" | "args" | "comparators" | "bases":
                return [one]
            case "ops":
                return [ast.Lt()]
            case "op":
                return ast.Add()
            case "ctx":
                return ast.Load()
            case "generators":
                return [ast.comprehension(ast.Name("x", ast.Store()), one, [one], 0)]
            case "name" | "id" | "attr" | "arg" | "module":
                return chance.choice(["robot", "x", "say"])
            case "names":
                return [ast.alias("os")]
            case "decorator_list" | "keywords" | "handlers" | "items" | "cases" | "type_params":
                return []
            case "level" | "simple" | "is_async" | "conversion":
                return 0
            case "kind" | "type_comment" | "returns" | "format_spec" | "lower" | "upper" | "step":
                return None
            case _:
                return one

    tree = ast.Module([node(statements, 4) for _ in range(3)], [])
    try:
        return ast.unparse(ast.fix_missing_locations(tree))
    except (AttributeError, KeyError, ValueError, TypeError, RecursionError):
        return "x = 1"


@MODEST
@given(st.integers(0, 10**9).map(random_tree))
def test_no_tree_confuses_the_check(program: str) -> None:
    check(program, STUB)


@settings(MODEST, max_examples=25)
@given(plans)
def test_what_the_grammar_writes_keeps_the_rules(plan: Any) -> None:
    """Random plans put wrong values everywhere; that is for the types to say, not for the rules."""
    ours = {"syntax", "unsupported", "import", "robot", "callback", "generator", "busy-loop"}
    ours |= {"forbidden", "too-long"}
    assert [each for each in check(write_program(plan), STUB) if each.code in ours] == []


@pytest.mark.parametrize(
    ("program", "code"),
    [
        # Each makes a robot call that cannot be seen where it is made.
        ("def now(f):\n    f()\n\n\n@now\ndef g():\n    robot.say('x')", "unsupported"),
        ("def _robot_location(x):\n    robot.stop()\n\n\nrobot.location()", "robot"),
        ("_robot_clock = print", "robot"),
        (
            "class Nurse:\n    def there(self):\n        return robot.sees('nurse')\n\n\n"
            "nurse = Nurse()\nany(nurse.there() for i in range(3))",
            "generator",
        ),
        (
            "class Nurse:\n    def there(self):\n        return robot.sees('nurse')\n\n\n"
            "list(map(Nurse().there, [1]))",
            "callback",
        ),
        (
            "class Nurse:\n    def __init__(self):\n        robot.say('x')\n\n\n"
            "max([1], key=lambda one: Nurse())",
            "callback",
        ),
    ],
)
def test_robot_calls_that_cannot_be_seen(program: str, code: str) -> None:
    assert code in [code for _, _, code in found(program)]


def test_methods_of_ones_own_may_call_the_robot() -> None:
    program = (
        "class Tour:\n    def show(self, place):\n        robot.goto(place)\n\n\n"
        "tour = Tour()\nfor place in robot.places():\n    tour.show(place)\n"
    )
    assert found(program) == []


def test_lines_are_counted_as_python_counts_them() -> None:
    assert found("x = 1\r__y__") == [(2, "error", "forbidden")]


def test_half_a_sign_cannot_be_spoken() -> None:
    assert found("robot.say('\\ud83d')") == [(1, "error", "half-a-sign")]
    assert found("robot.say('\\U0001f44d')") == []


def test_checks_of_several_threads_wait_for_each_other() -> None:
    with ThreadPoolExecutor(4) as threads:
        found = list(threads.map(lambda _: check("robot.dance()", stub()), range(8)))
    assert all(len(each) == 1 and each[0].severity == "error" for each in found)


def test_a_checker_that_ctrl_c_has_ended_is_started_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """The terminal interrupts all that it has started, whatever the checker is at."""
    assert found("robot.wait(1)") == []
    real, interrupted = diagnosis._diagnosed, []

    def interrupting(program: str, *more: Any) -> list[diagnosis.Diagnostic]:
        if not interrupted:
            interrupted.extend(workers())
            for worker in interrupted:
                os.kill(worker, signal.SIGINT)
        return real(program, *more)

    monkeypatch.setattr(diagnosis, "_diagnosed", interrupting)
    assert found("robot.wait(1)") == []
    assert interrupted


def workers() -> list[int]:
    """Those that this process has started to check programs."""
    tasks = Path("/proc/self/task").glob("*/children")
    children = [int(child) for task in tasks for child in task.read_text().split()]
    return [child for child in children if b"monty" in Path(f"/proc/{child}/cmdline").read_bytes()]
