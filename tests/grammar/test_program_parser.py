"""A program is read as the plan that says the same, or refused with a sentence that says why."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings

from grammar import plan as p
from grammar.normal import normal
from grammar.program import write_program
from grammar.program_parser import NotAPlan, parse_program
from tests.grammar import random_plans, sensible_plans

MODEST = settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))


# --- there and back ------------------------------------------------------------------------------


def check_there_and_back(plan: p.Plan) -> None:
    program = write_program(plan)
    assert parse_program(program, plan.language) == normal(plan), program


@MODEST
@given(random_plans.plans)
def test_what_is_written_is_read_as_the_same_plan(plan: p.Plan) -> None:
    check_there_and_back(plan)


@MODEST
@given(sensible_plans.plans)
def test_what_makes_sense_is_read_as_the_same_plan_in_every_language(plan: p.Plan) -> None:
    check_there_and_back(plan)


# --- the same in other words ---------------------------------------------------------------------

ASKED = 'answer = robot.ask("Coffee?")\n'
COUNTED = "count = 0\nnames = []\nvotes = {}\n"

THE_SAME = {
    "a comparison denied": (
        ASKED + 'if not answer == "yes":\n    robot.dock()',
        ASKED + 'if answer != "YES":\n    robot.dock()',
        ASKED + 'if answer.lower() != "yes":\n    robot.dock()',
        ASKED + "if answer.strip().lower() == 'yes':\n    pass\nelse:\n    robot.dock()",
        ASKED + 'if "yes" != answer: robot.dock()',
    ),
    "one of several": (
        ASKED + 'if answer in ["yes", "sure"]:\n    robot.dock()',
        ASKED + 'if answer.lower() in ("Yes", "Sure"):\n    robot.dock()',
        ASKED + 'if not answer not in {"yes", "sure"}:\n    robot.dock()',
    ),
    "otherwise if": (
        ASKED + 'if answer == "a":\n    robot.dock()\nelif answer == "b":\n    robot.stop()',
        ASKED
        + 'if answer == "a":\n    robot.dock()\nelse:\n    if answer == "b":\n        robot.stop()',
    ),
    "three times": (
        'for i in range(3):\n    robot.say("Hello")',
        'for _ in range(0, 3):\n    robot.say(text="Hello")',
    ),
    "by name or by place": (
        'robot.ask("Tea?", ["yes", "no"], person="Bob")',
        'robot.ask(question="Tea?", person="Bob", options=("yes", "no"))',
        'robot.ask("Tea?", ["yes", "no"], "Bob")',
    ),
    "what is not given": ('robot.say("Hi")', 'robot.say("Hi", language=None)'),
    "one more": (
        COUNTED + "count += 1",
        COUNTED + "count = count + 1",
        COUNTED + "count -= -1",
    ),
    "fewer": (COUNTED + "count -= 2", COUNTED + "count = count - 2", COUNTED + "count += -2"),
    "a tally": (
        COUNTED + 'votes["tea"] += 1',
        COUNTED + 'votes["tea"] = votes["tea"] + 1',
        COUNTED + 'votes["tea"] = votes.get("tea", 0) + 1',
    ),
    "an empty list": (
        COUNTED + "if names:\n    robot.dock()",
        COUNTED + "if len(names) > 0:\n    robot.dock()",
        COUNTED + "if len(names) != 0:\n    robot.dock()",
        COUNTED + "if names != []:\n    robot.dock()",
        COUNTED + "if not names == []:\n    robot.dock()",
        COUNTED + "if 0 < len(names):\n    robot.dock()",
        COUNTED + "if not (len(names) == 0):\n    robot.dock()",
        COUNTED + "if bool(names):\n    robot.dock()",
    ),
    "between two numbers": (
        COUNTED + "if 9 <= count < 12:\n    robot.dock()",
        COUNTED + "if count >= 9 and count < 12:\n    robot.dock()",
        COUNTED + "if count >= 9 and not count >= 12:\n    robot.dock()",
    ),
    "three conditions": (
        COUNTED + 'if count and names and robot.sees("cup"):\n    robot.dock()',
        COUNTED + 'if count != 0 and (len(names) > 0 and robot.sees("cup")):\n    robot.dock()',
    ),
    "a text with values": (
        ASKED + 'robot.say(f"You said {answer}.")',
        ASKED + 'robot.say("You said " + answer + ".")',
        ASKED + 'robot.say("You said " + str(answer) + f".")',
        ASKED + 'robot.say("You " f"said {answer}" ".")',
    ),
    "two texts": (
        ASKED + 'more = robot.ask("And?")\nrobot.say(answer + more)',
        ASKED + 'more = robot.ask("And?")\nrobot.say(f"{answer}{more}")',
    ),
    "a number spoken": (
        "n = robot.battery()\nrobot.say(str(n))",
        'n = robot.battery()\nrobot.say(f"{n}")',
        'n = robot.battery()\nrobot.say("" + str(n))',
    ),
    "a list spoken": (
        'robot.say(", ".join(robot.people()))',
        "robot.say(f\"{', '.join(robot.people())}\")",
    ),
    "numbers put together": (
        'robot.say("; ".join(str(n) for n in [1, 2]))',
        'robot.say("; ".join([str(n) for n in [1, 2]]))',
        'robot.say("; ".join(map(str, [1, 2])))',
    ),
    "a number heard": (
        ASKED + "robot.wait(int(answer))",
        ASKED + "robot.wait(float(answer))",
        ASKED + "robot.wait(number_in(answer))",
    ),
    "divided without remainder": ("n = 7 // 2", "n = int(7 / 2)"),
    "rounded in a text": (
        'robot.say(f"At {robot.location().x:.1f}.")',
        'robot.say(f"At {round(robot.location().x, 1)}.")',
    ),
    "a list of others": (
        COUNTED + "names += robot.people()",
        COUNTED + "names.extend(robot.people())",
        COUNTED + "names = names + robot.people()",
    ),
    "in order": (
        COUNTED + "names.sort(reverse=True)",
        COUNTED + "names = sorted(names, reverse=True)",
    ),
    "each once": (
        COUNTED + "names = list(dict.fromkeys(names))",
        COUNTED + "names = list(set(names))",
    ),
    "keys": (
        COUNTED + "for name in votes:\n    robot.say(name)",
        COUNTED + "for name in votes.keys():\n    robot.say(name)",
    ),
    "the highest value": (
        COUNTED + "best = max(votes, key=votes.get)",
        COUNTED + "best = key_of_max(votes)",
    ),
    "a die": (
        "import random\nn = random.randint(1, 6)",
        "import random\nn = random.choice(range(1, 7))",
    ),
    "until it is so": (
        'while True:\n    robot.say("Hello")\n    if robot.sees("cup"):\n        break',
        'while not False:\n    robot.say("Hello")\n    if robot.sees("cup"): break',
    ),
    "as long as it is so": (
        'while robot.sees("cup"):\n    robot.say("A cup")',
        'while True:\n    if not robot.sees("cup"):\n        break\n    robot.say("A cup")',
        'while True:\n    if robot.sees("cup"):\n        robot.say("A cup")\n    else: break',
    ),
    "waiting": (
        'while not robot.sees("cup"):\n    robot.wait(1)',
        'while not robot.sees("cup"):\n    pass',
        'while True:\n    if robot.sees("cup"):\n        break\n    robot.wait(1)',
    ),
    "one or the other": (
        'drink = "tea" if robot.sees("cup") else "water"',
        'if robot.sees("cup"):\n    drink = "tea"\nelse:\n    drink = "water"',
    ),
    "nothing known yet": (
        "best = None\nif best is None:\n    robot.dock()",
        'best = ""\nif not best:\n    robot.dock()',
        'best: str = ""\nif best == "":\n    robot.dock()',
    ),
    "true or not": (
        'found = robot.sees("cup")\nif found:\n    robot.dock()',
        'found = robot.sees("cup")\nif found == True:\n    robot.dock()',
        'found = robot.sees("cup")\nif found is not False:\n    robot.dock()',
    ),
    "several names": ("a = b = 0", "a, b = 0, 0", "a = 0\nb = 0"),
    "where it is": (
        "robot.say(str(robot.location()))",
        "robot.say(robot.location().place)",
        'robot.say(f"{robot.location()}")',
    ),
    "trying": (
        "try:\n    robot.dock()\nexcept Exception:\n    robot.stop()",
        "try:\n    robot.dock()\nexcept:\n    robot.stop()",
        "try:\n    robot.dock()\nexcept Exception as problem:\n    robot.stop()",
    ),
}


@pytest.mark.parametrize("name", THE_SAME)
def test_the_same_in_other_words_is_the_same_plan(name: str) -> None:
    first, *others = map(parse_program, THE_SAME[name])
    for source, other in zip(THE_SAME[name][1:], others, strict=True):
        assert other == first, source


DIFFERENT = (
    ("for i in range(3):\n    robot.say(f'{i}')", "for i in range(3):\n    robot.say('Hello')"),
    ('robot.say("Yes")', 'robot.say("yes")'),
    (
        'while True:\n    if robot.sees("a"):\n        break\n    robot.wait(1)',
        'while True:\n    robot.wait(1)\n    if robot.sees("a"):\n        break',
    ),
    (
        "while True:\n    robot.stop()\n    if robot.sees('a'): break\n    robot.wait(1)",
        "while True:\n    robot.stop()\n    robot.wait(1)\n    if robot.sees('a'): break",
    ),
    ("names = ['a']\nother = names", "names = ['a']\nother = list(names)"),
    ("for i in range(3):\n    robot.dock()\nn = i", "for i in range(3):\n    robot.dock()\nn = 0"),
)


@pytest.mark.parametrize(("one", "other"), DIFFERENT)
def test_what_is_not_the_same_is_another_plan(one: str, other: str) -> None:
    assert parse_program(one) != parse_program(other)


def test_what_was_said_besides_stands_at_the_top() -> None:
    plan = parse_program("# I do not hear well\n#!\n# I am Bob\nrobot.dock()\n# never mind\n")
    assert plan.background == ("I do not hear well", "!", "I am Bob")
    assert write_program(plan).splitlines()[:3] == ["# I do not hear well", "# !", "# I am Bob"]


def test_the_language_is_that_of_whoever_asks() -> None:
    plan = p.Plan(
        (p.Call("wait", {"seconds": p.NumberIn(p.Ask("ask", {"question": p.Text("?")}))}),), "de"
    )
    assert "fünf" in write_program(plan)
    assert parse_program(write_program(plan), "de") == plan


# --- what no plan can say ------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("source", "line", "word"),
    [
        ("robot.dock()\ndef greet():\n    robot.say('Hi')\ngreet()", 2, "functions"),
        ("class Visitor:\n    pass", 1, "classes"),
        ("x = [robot.count(each) for each in ['cup']]", 1, "loop"),
        ("n = 1\nx = sum(each for each in [1])", 2, "loop"),
        ("robot.dock()\n\nprint('Hello')", 3, "robot.say"),
        ("for i, name in enumerate(['a']):\n    robot.say(name)", 1, "range"),
        ("robot.say('Hello'[1:])", 1, "one by one"),
        ("robot.fly()", 1, "no method 'fly'"),
        ("robot.goto('lab', 1, 2, 3)", 1, "cannot be called"),
        ("robot.say()", 1, "cannot be called"),
        ("x = robot.clock().hour", 1, "hour"),
        ("import os", 1, "random"),
        ("say = robot.say", 1, "say"),
        ("if 1 < robot.count('cup') < 3:\n    robot.dock()", 1, "name"),
        ("n = 2.5\nm = int(n)", 2, "round"),
        ("names = robot.people()\nfirst = min(names)", 2, "numbers"),
        ("first = max(robot.ask('a'), robot.ask('b'))", 1, "numbers"),
        ("n = 'ha' * 3", 1, "simpler"),
        ("while robot.sees('a'):\n    pass\nelse:\n    robot.dock()", 1, "without else"),
        ("try:\n    robot.dock()\nfinally:\n    robot.stop()", 1, "except"),
        ("try:\n    robot.dock()\nexcept ValueError:\n    robot.stop()", 1, "except"),
        ("len = 3\nn = len([1])", 2, "len"),
        ("def percent(part, whole):\n    return 0\nn = percent(1, 2)", 1, "functions"),
        ("x = 10 ** 20", 1, "simpler"),
        ("x = 1e400", 1, "simpler"),
        ("robot.dock()\nbreak", 2, "loop"),
        ("best = None\nbest = robot.battery()", 1, "None"),
        ("if robot.do('sit') is None:\n    robot.dock()", 1, "None"),
        ("if robot.battery() is 3:\n    robot.dock()", 1, "=="),
        ("robot.dock(", 1, "Python"),
        ("robot.say('\x00')", 1, "null"),
    ],
)
def test_what_no_plan_can_say_is_told_with_its_line(source: str, line: int, word: str) -> None:
    with pytest.raises(NotAPlan, match=f"(?s)^Line {line}: .*{word}") as refused:
        parse_program(source)
    assert refused.value.line == line
    assert refused.value.sentence in str(refused.value)


def test_what_is_nested_too_deeply_is_refused() -> None:
    with pytest.raises(NotAPlan):
        parse_program(f"x = {'(' * 300}1{')' * 300}")
    with pytest.raises(NotAPlan):
        parse_program(f"x = {'-' * 5000}1")
