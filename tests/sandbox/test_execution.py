"""Programs run line by line, in view, and stop at any instant."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import pytest

from robot_api.errors import Stopped, TimedOut
from robot_api.stub import stub
from robot_api.values import Location
from sandbox.check import check
from sandbox.diagnosis import CHECKER
from sandbox.execution import Execution
from sandbox.limits import Limits
from tests.sandbox.ward import Ward, children

linux = pytest.mark.skipif(not Path("/proc").exists(), reason="looks at processes in /proc")

VISITORS = textwrap.dedent("""\
    desk = robot.location()
    for visitor in range(2):
        robot.wait(1)
        place = robot.ask("Where to?", ["lab", "yes"])
        robot.guide("person", place)
        robot.goto(desk)
    robot.say("Two visitors have been shown the way.")
    """)


# --- the ordinary day ----------------------------------------------------------------------------


def test_visitors_are_shown_the_way() -> None:
    ward = Ward(answers=("lab", "yes"))
    outcome = ward.run(VISITORS)
    assert (outcome.status, outcome.line, outcome.calls) == ("done", None, 10)
    assert ward.said == ["Two visitors have been shown the way."]
    assert ward.gone_to == [{"place": Location(1.5, 2.0, 90.0, "ward")}] * 2
    assert ward.lines == [1, 3, 4, 5, 6, 3, 4, 5, 6, 7]
    assert [(record.method, record.line) for record in ward.records] == ward.calls
    assert all(record.seconds >= 0 for record in ward.records)


def test_positional_and_named_arguments_arrive_by_name_with_their_defaults() -> None:
    ward = Ward()
    ward.run('robot.goto(1, y=2)\nrobot.listen(timeout=3)\nrobot.do("sit", slowly=True)')
    assert [record.arguments for record in ward.records] == [
        {"x": 1, "y": 2, "theta": None},
        {"prompt": None, "timeout": 3},
        {"skill": "sit", "slowly": True},
    ]


def test_a_location_can_be_remembered_spoken_and_gone_to() -> None:
    ward = Ward()
    outcome = ward.run(
        textwrap.dedent("""\
        here = robot.location()
        robot.say(f"{here} {here.x} {here.place} {robot.clock().time}")
        robot.say(str(here) + " at " + str(robot.clock()))
        robot.say(f"I am at {robot.location()}.")
        robot.say("robot.location() is no call here")
        robot.say(str(here == robot.location()))
        robot.goto(here)
        robot.localize(here)
        """)
    )
    assert outcome.status == "done", outcome
    assert ward.said == [
        "ward 1.5 ward 14:05",
        "ward at 14:05",
        "I am at ward.",
        "robot.location() is no call here",
        "True",
    ]
    assert ward.gone_to == [{"place": Location(1.5, 2.0, 90.0, "ward")}]


def test_results_may_come_as_data_from_the_wire() -> None:
    def wire(method: str, arguments: dict[str, object], line: int) -> object:
        if method == "location":
            return {"x": 1.0, "y": 2.0, "theta": 0.0, "place": None}
        return ["Alice", "Bob"] if method == "people" else None

    printed: list[str] = []
    program = "print(robot.location(), robot.people())"
    assert Execution(program, wire, on_print=printed.append).run().status == "done"
    assert printed == ["1.00, 2.00 ['Alice', 'Bob']\n"]


def test_modules_that_may_be_imported() -> None:
    ward = Ward()
    outcome = ward.run(
        textwrap.dedent("""\
        import math
        import random
        import re
        if re.search("[yj]es", robot.ask("Coffee?")):
            robot.say(str(math.floor(2.5)) + random.choice(["a", "a"]))
        """)
    )
    assert outcome.status == "done", outcome
    assert ward.said == ["2a"]


def test_a_seed_makes_chance_repeat_itself() -> None:
    program = "import random\nrobot.say(str(random.random()))"
    first, second, other = Ward(), Ward(), Ward()
    first.run(program, seed=7)
    second.run(program, seed=7)
    other.run(program, seed=8)
    assert first.said == second.said != other.said


def test_sleeping_is_waiting_with_the_robot() -> None:
    ward = Ward()
    assert ward.run("import time\ntime.sleep(600)").status == "done"
    assert ward.records[0].method == "wait"
    assert ward.records[0].arguments == {"seconds": 600.0}


def test_what_is_printed_arrives_in_order() -> None:
    ward = Ward()
    ward.run('print("one", 1)\nrobot.wait(1)\nprint("two")')
    assert "".join(ward.printed) == "one 1\ntwo\n"


def test_lines_are_right_with_umlauts_and_calls_over_several_lines() -> None:
    ward = Ward()
    ward.run('robot.say("ÄÖÜ 👍")\n\ndef greet():\n    robot.say(\n        "x"\n    )\ngreet()\n')
    assert ward.lines == [1, 4]


# --- bad days ------------------------------------------------------------------------------------


def test_an_error_of_the_robot_can_be_caught_with_its_sentence() -> None:
    ward = Ward()
    program = (
        'try:\n    robot.goto("moon")\nexcept Exception as problem:\n    robot.say(str(problem))'
    )
    assert ward.run(program).status == "done"
    assert ward.said == ["There is no place called moon. Say one of its places."]


def test_an_error_that_is_not_caught_ends_the_program_at_its_line() -> None:
    ward = Ward()
    outcome = ward.run('robot.say("on my way")\n\nrobot.goto("moon")\nrobot.say("there")')
    assert (outcome.status, outcome.line, outcome.error) == ("failed", 3, "UnknownPlace")
    assert outcome.message == "There is no place called moon. Say one of its places."
    assert ward.said == ["on my way"]
    assert ward.records[-1].error == "UnknownPlace"


@pytest.mark.parametrize(
    ("program", "line", "error", "words"),
    [
        ("robot.wait(1)\nx = 1 / 0", 2, "ZeroDivisionError", "divides by zero"),
        ("robot.sey('x')", 1, "InvalidCall", "did you mean say"),
        ("robot.say()", 1, "InvalidCall", "needs a text"),
        ("robot.wait(-1)", 1, "InvalidCall", "from 0 to"),
        ("robot.wait(float('nan'))", 1, "InvalidCall", "must be"),
        ("say('hello')", 1, "NameError", "robot.say"),
        ("robot.say(answer)", 1, "NameError", "nothing called answer"),
        ("int(robot.ask('How many?'))", 1, "ValueError", "'yes' is no number"),
        ("robot.say('x'", 1, "syntax", "never closed"),
        ("robot.do('sit', how=len)", 1, "TypeError", "no text, number or list"),
        ("robot.move(10 ** 30)", 1, "TypeError", "a number that is too large"),
        ("raise ValueError('No coffee left')", 1, "ValueError", "No coffee left."),
        ("def f():\n    f()\nf()", 2, "RecursionError", "without end"),
        ("for x in robot.location:\n    pass", 1, "AttributeError", "location"),
    ],
)
def test_what_goes_wrong_is_said_kindly(program: str, line: int, error: str, words: str) -> None:
    outcome = Ward().run(program)
    assert (outcome.status, outcome.line, outcome.error) == ("failed", line, error)
    assert words in outcome.message
    assert "Traceback" not in outcome.message


def test_with_a_stub_nothing_runs_before_all_is_well() -> None:
    ward = Ward()
    outcome = ward.run('robot.say("hello")\nrobot.fly()', stub=stub())
    assert (outcome.status, outcome.line) == ("failed", 2)
    assert ward.said == []


def test_a_run_cannot_be_repeated() -> None:
    execution = Ward().execution("robot.wait(1)")
    assert execution.run().status == "done"
    with pytest.raises(RuntimeError):
        execution.run()


def test_a_fault_of_the_host_is_not_hidden_and_leaves_no_process() -> None:
    def broken(method: str, arguments: dict[str, object], line: int) -> None:
        raise ZeroDivisionError("a bug in the driver")

    before = children()
    with pytest.raises(ZeroDivisionError):
        Execution("robot.wait(1)", broken).run()
    assert children() <= before


def test_a_fault_where_the_output_goes_is_not_hidden() -> None:
    def closed(text: str) -> None:
        raise BrokenPipeError

    with pytest.raises(BrokenPipeError):
        Execution('print("x")\nwhile True:\n    pass', Ward(), on_print=closed).run()


@linux
def test_ctrl_c_in_the_terminal_reaches_the_process_too_and_is_a_stop() -> None:
    before = children()

    def terminal(method: str, arguments: dict[str, object], line: int) -> None:
        for pid in children() - before:
            os.kill(pid, signal.SIGINT)

    outcome = Execution("robot.wait(1)\nrobot.wait(2)", terminal).run()
    assert (outcome.status, outcome.line) == ("stopped", 1)


@linux
def test_a_process_that_something_else_ends_is_a_failure() -> None:
    before = children()

    def killer(method: str, arguments: dict[str, object], line: int) -> None:
        for pid in children() - before:
            os.kill(pid, signal.SIGKILL)

    outcome = Execution("robot.wait(1)\nrobot.wait(2)", killer).run()
    assert (outcome.status, outcome.error, outcome.line) == ("failed", "killed", 1)


@pytest.mark.parametrize("binary", ["/nowhere/monty", "/bin/false"])
def test_a_sandbox_that_does_not_start(binary: str, monkeypatch: pytest.MonkeyPatch) -> None:
    CHECKER.close()  # the one that checks may be running already
    monkeypatch.setenv("MONTY_BIN", binary)
    outcome = Ward().run("robot.wait(1)")
    assert outcome.status == "failed"
    assert "process" in outcome.message or "Install nl2robot anew." in outcome.message
    [finding] = check("robot.wait(1)", stub())
    assert finding.code == "unavailable"


# --- limits --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("program", "which"),
    [
        ("while True:\n    pass", "computing"),
        (
            "while True:\n    try:\n        1 / 0\n    except BaseException:\n        pass",
            "computing",
        ),
        (
            "while True:\n    try:\n        nothing\n    except BaseException:\n        pass",
            "calls",
        ),
        ("x = []\nwhile True:\n    x.append('a' * 1000)", "memory"),
        ("x = 10 ** 10 ** 10", "memory"),
        ("while True:\n    print('x' * 100)", "output"),
        ("while True:\n    robot.battery()", "calls"),
        (
            "while True:\n    try:\n        robot.goto('moon')\n"
            "    except BaseException:\n        pass",
            "calls",
        ),
    ],
)
def test_a_program_that_uses_too_much_is_ended(program: str, which: str) -> None:
    begun = time.monotonic()
    outcome = Ward().run(program)
    assert (outcome.status, outcome.error) == ("limit", which)
    assert outcome.message.count(".") >= 2
    assert time.monotonic() - begun < 5


def test_waiting_for_the_robot_is_not_computing() -> None:
    def slow(method: str, arguments: dict[str, object], line: int) -> None:
        time.sleep(0.4)

    limits = Limits(computing=0.2, total_computing=0.3)
    assert Execution("robot.wait(1)\nrobot.wait(1)", slow, limits=limits).run().status == "done"


# --- pause, step, stop ---------------------------------------------------------------------------


def until(true: object, seconds: float = 5.0) -> None:
    """Wait until `true()` holds."""
    assert callable(true)
    end = time.monotonic() + seconds
    while not true():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.001)


def test_single_steps() -> None:
    ward = Ward()
    execution = ward.execution('robot.say("a")\nrobot.say("b")\nrobot.say("c")\nrobot.say("d")')
    execution.pause()

    def operator(execution: Execution) -> None:
        until(lambda: ward.lines == [1])
        assert ward.said == []
        execution.step()
        until(lambda: ward.lines == [1, 2])
        assert ward.said == ["a"]
        execution.step()
        until(lambda: ward.lines == [1, 2, 3])
        assert ward.said == ["a", "b"]
        execution.resume()

    thread = threading.Thread(target=operator, args=(execution,))
    thread.start()
    assert execution.run().status == "done"
    thread.join()
    assert ward.said == ["a", "b", "c", "d"]


def test_a_stop_during_a_pause() -> None:
    ward = Ward()
    execution = ward.execution('robot.say("a")')
    execution.pause()

    def operator() -> None:
        until(lambda: ward.lines == [1])
        execution.stop("The nurse stopped it.")

    threading.Thread(target=operator).start()
    outcome = execution.run()
    assert (outcome.status, outcome.message, outcome.line) == (
        "stopped",
        "The nurse stopped it.",
        1,
    )
    assert ward.said == []


def test_a_stop_before_the_start() -> None:
    execution = Ward().execution("robot.wait(1)")
    execution.stop()
    assert execution.run().status == "stopped"


def test_a_stop_while_computing_takes_effect_at_once() -> None:
    stopped_at: list[float] = []

    def operator(execution: Execution) -> None:
        until(lambda: ward.calls)
        time.sleep(0.05)
        stopped_at.append(time.monotonic())
        execution.stop()

    ward = Ward()
    outcome = ward.run(
        "robot.wait(1)\nwhile True:\n    try:\n        1 / 0\n    except:\n        pass",
        Limits(),
        during=operator,
    )
    assert outcome.status == "stopped"
    assert time.monotonic() - stopped_at[0] < 0.05 * slack()


def test_a_stop_during_a_call_cannot_be_caught() -> None:
    """The runner cancels the call, which ends with `Stopped`."""
    ward = Ward()

    def operator(execution: Execution) -> None:
        assert ward.waiting.wait(5)
        execution.stop()
        ward.cancelled.set()

    outcome = ward.run(
        'while True:\n    try:\n        robot.wait_for("person")\n    except BaseException:\n'
        '        robot.say("never")\n',
        during=operator,
    )
    assert outcome.status == "stopped"
    assert outcome.line == 3
    assert ward.said == []


def test_the_robot_itself_was_stopped() -> None:
    def stopped(method: str, arguments: dict[str, object], line: int) -> None:
        raise Stopped("The emergency button was pressed.")

    program = "try:\n    robot.wait(1)\nfinally:\n    robot.say('never')"
    outcome = Execution(program, stopped).run()
    assert outcome.status == "stopped"
    assert outcome.message == "The emergency button was pressed."
    assert outcome.calls == 1


def test_an_error_that_comes_with_a_stop_is_a_stop() -> None:
    def interrupted(method: str, arguments: dict[str, object], line: int) -> None:
        execution.stop()
        raise TimedOut("Nobody said anything.")

    execution = Execution("try:\n    robot.listen()\nexcept Exception:\n    pass", interrupted)
    assert execution.run().status == "stopped"


# --- processes -----------------------------------------------------------------------------------


@linux
@pytest.mark.parametrize(
    "program",
    ["robot.wait(1)", "1 / 0", "while True:\n    pass", "print('x' * 100000)", "robot.wait("],
)
def test_no_process_is_left_behind(program: str) -> None:
    before = children()
    Ward().run(program)
    assert children() <= before


HOST = """
import sys
from sandbox.execution import Execution, Limits
Execution("print(1)\\nwhile True:\\n    pass", print, limits=Limits(computing=1.0),
          on_print=lambda text: print(text, flush=True)).run()
"""


@linux
def test_when_the_host_is_killed_the_program_does_not_burn_on() -> None:
    host = subprocess.Popen(
        [sys.executable, "-c", HOST], stdout=subprocess.PIPE, cwd=Path(__file__).parents[2]
    )
    assert host.stdout is not None
    host.stdout.readline()
    listed = Path(f"/proc/{host.pid}/task/{host.pid}/children").read_text().split()
    assert listed
    os.kill(host.pid, signal.SIGKILL)
    host.wait()
    host.stdout.close()
    until(lambda: not any(map(alive, listed)), seconds=6)


def alive(pid: str) -> bool:
    try:
        status = Path(f"/proc/{pid}/stat").read_text()
    except FileNotFoundError:
        return False
    return status.rpartition(")")[2].split()[0] not in ("Z", "X")


def slack() -> float:
    """How much longer things may take where many tests share few cores."""
    return 10.0


@pytest.mark.parametrize("newline", ["\r", "\r\n", "\n"])
@pytest.mark.parametrize("limits", [Limits(), Limits(rounds=100)])
def test_lines_may_end_as_on_any_system(newline: str, limits: Limits) -> None:
    program = 'x = 1\nfor place in robot.places("office"):\n    robot.goto(place)\n    x += 1\n'
    ward = Ward()
    assert ward.run(program.replace("\n", newline), limits=limits).status == "done"
    assert ward.calls == [("places", 2), ("goto", 3), ("goto", 3)]
