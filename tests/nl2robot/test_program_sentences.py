"""What is wrong with a program is said in the reader's language, whole."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest
import yaml

from nl2robot.knowledge import Knowledge
from nl2robot.review.policy import violations
from nl2robot.run.trouble import told
from nl2robot.sentences import DATA, in_language
from robot_api.drivers import simulated
from robot_api.errors import NotFound
from robot_api.stub import stub
from sandbox.check import check
from sandbox.execution import _LIMITS, DIED, Execution
from sandbox.sentences import UNAVAILABLE
from sim.simulation import Simulation
from sim.world.loading import load_world

HAS = simulated(Simulation(load_world("city-hospital"))).capabilities()
ROOT = Path(__file__).parents[2]

WRONG = (
    "def f(:\n",
    "x = '\ud800'\n",
    f"x = {'-' * 60}1\n",
    "def f():\n    yield 1\n",
    "async def f():\n    pass\n",
    "x = 1\ndel x\n",
    "with x:\n    pass\n",
    "x = [1] @ [2]\n",
    "@f\ndef g():\n    pass\n",
    "class A(B):\n    pass\n",
    "class A:\n    class B:\n        pass\n",
    "eval('1')\n",
    "exec('1')\n",
    "open('a')\n",
    "input()\n",
    "getattr(robot, 'say')\n",
    "delattr(robot, 'say')\n",
    "globals()\n",
    "breakpoint()\n",
    "exit()\n",
    "help()\n",
    "__import__('os')\n",
    "__name__\n",
    "import time\n",
    "import os\n",
    "from math import *\n",
    "robot = 1\n",
    "robot.say\n",
    "robot.sey\n",
    "x = robot\n",
    "def f():\n    robot.say('a')\nmap(f, [1])\n",
    "any(robot.sees('a') for x in [1])\n",
    "f = lambda: robot.say('a')\n",
    "def f(a=robot.ask('a')):\n    pass\n",
    "while True:\n    x = 1\n",
    "while True:\n    robot.battery()\n",
    "robot.fly('a')\n",
    "robot.sai('a')\n",
    "say('a')\n",
    "nobody\n",
    "x = 'a'\nx.nothing\n",
    "x = robot.battery\nx.real\n",
    "robot.say()\n",
    "robot.say(1)\n",
    "robot.battery(1, 2)\n",
    "robot.say('a', loud=True)\n",
    "x = 'a' + 1\n",
    "x = 'a'\nx()\n",
    "for x in 3:\n    pass\n",
    "robot.say('a\u202eb')\n",
    "rob\u043et = 1\n",
)
ENDING = (
    "x = 1 / 0\n",
    "[][1]\n",
    "{}['a']\n",
    "int('a')\n",
    "def f():\n    f()\nf()\n",
    "assert False\n",
)


@pytest.mark.parametrize("language", ["de", "fr"])
@pytest.mark.parametrize("program", WRONG)
def test_what_the_check_finds(program: str, language: str) -> None:
    findings = check(program, stub())
    assert findings, "nothing is wrong with it"
    for each in findings:
        if not each.message.startswith("This does not fit together"):  # the checker's own words
            assert in_language(each.message, language) is not None, each.message


@pytest.mark.parametrize("language", ["de", "fr"])
@pytest.mark.parametrize("program", ENDING)
def test_what_ends_a_program(program: str, language: str) -> None:
    outcome = Execution(program, lambda *call: None).run()
    assert outcome.status == "failed"
    assert in_language(outcome.message, language) is not None, outcome.message


@pytest.mark.parametrize("language", ["de", "fr"])
@pytest.mark.parametrize(
    "call",
    [
        "goto('farmacy')",
        "goto('nowhere at all')",
        "emotion('yellow')",
        "gesture('handstand')",
        "call('nobody')",
        "set_language('xx')",
        "set_volume(120)",
        "touch([])",
        "say('')",
        "wait(-1)",
    ],
)
def test_what_this_robot_and_this_world_do_not_have(call: str, language: str) -> None:
    findings = violations(f"robot.{call}\n", Knowledge(load_world("city-hospital"), HAS))
    assert findings
    for each in findings:
        assert in_language(each.message, language) is not None, each.message


@pytest.mark.parametrize("language", ["de", "fr"])
@pytest.mark.parametrize("sentence", [*_LIMITS.values(), DIED, UNAVAILABLE])
def test_what_no_program_can_help(sentence: str, language: str) -> None:
    assert in_language(sentence, language) is not None


def test_nothing_english_is_left_in_brackets() -> None:
    [found] = check("robot.sai('a')\n", stub())
    said = told(found.code, found.message, "de")
    assert said == "Der Roboter hat keine Methode sai. Ist say gemeint?"
    assert not re.search(r"\(The|robot has", said)
    assert told(NotFound.__name__, "Nobody knows this one.", "de").endswith("this one.)")


def test_no_sentence_is_kept_that_no_check_says_any_more() -> None:
    """They are put together from pieces, each of which is to stand somewhere."""
    files = [
        *(ROOT / "sandbox").glob("*.py"),
        *(ROOT / "nl2robot" / name for name in ("run/performance.py", "review/policy.py")),
        ROOT / "robot_api" / "schema.py",
    ]
    said = {
        " ".join(node.value.split())
        for file in files
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8")))
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }
    gone = [
        piece
        for entry in yaml.safe_load((DATA / "programs.yaml").read_text(encoding="utf-8"))
        for piece in re.split(r"[.:,?] |\{\w+\}|[.?]$| or |\(", entry["en"])
        if not any(
            each.lower() in text.lower() for text in said for each in [piece.strip(" .,:?)")]
        )
    ]
    assert gone == []
