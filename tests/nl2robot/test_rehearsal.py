"""The dry run: what a program would do, found out before it may."""

import threading
import time
from collections.abc import Callable
from datetime import datetime
from textwrap import indent

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar.language import languages
from grammar.program import write_program
from grammar.sampler import sensible
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.review import rehearsal
from nl2robot.review.rehearsal import Budget, rehearse, watched
from nl2robot.review.review import review
from robot_api.driver import StopFlag
from robot_api.drivers import simulated
from sim.simulation import Simulation
from sim.world.loading import load_world

WORLD = load_world(DEFAULT_WORLD)


@pytest.fixture
def ward():
    return Simulation(load_world("ward"), seed=1)


def test_the_way_the_words_and_the_time_are_foreseen(ward) -> None:
    told = rehearse(
        'robot.goto("ward a")\nrobot.ask("Tea?", ["yes", "no"], person="Alice")\n'
        'robot.say("Good night.")\nrobot.show(text="Sleep well")\nrobot.grab("cup")\n',
        ward,
    )
    assert (told.status, told.message, told.line) == ("done", None, None)
    assert told.places == ("charger", "corridor", "ward a")
    assert told.asks == ("Tea?",)
    assert "Good night." in told.says
    assert "Sleep well" in told.shows
    assert told.holds == ("cup",)
    assert told.metres == pytest.approx(6, abs=2)
    assert told.seconds > 4
    assert told.calls == 5
    apart = [
        ((x2 - x1) ** 2 + (y2 - y1) ** 2) ** 0.5
        for (x1, y1), (x2, y2) in zip(told.path, told.path[1:], strict=False)
    ]
    assert min(apart) > 0.4


def test_what_is_said_at_once_is_foreseen_whenever_it_is_looked_at(ward) -> None:
    driver = simulated(ward)
    for _ in range(6):
        assert rehearse('robot.say("Good night.")\n', ward.copy()).says == ("Good night.",)
        driver.call("wait", {"seconds": 0.01}, StopFlag())  # a step of the simulation


def test_a_failure_is_foreseen_with_its_line(ward) -> None:
    told = rehearse('robot.say("Now.")\nrobot.grab("unicorn")\n', ward)
    assert (told.status, told.line) == ("failed", 2)
    assert "unicorn" in told.message


def test_a_program_that_stops_the_robot_ends_there(ward) -> None:
    told = rehearse('robot.goto("ward a")\nrobot.stop()\nrobot.goto("ward b")\n', ward)
    assert (told.status, told.line, told.calls) == ("stopped", 2, 2)
    assert told.places[-1] == "ward a"


PATROL = 'while True:\n    robot.goto("ward a")\n    robot.goto("ward b")\n'
SWALLOWS = (
    'while True:\n    try:\n        robot.goto("ward b")\n        robot.goto("ward a")\n'
    "    except Exception:\n        pass\n"
)
RECEPTION = 'while True:\n    robot.wait_for("person")\n    robot.say("Welcome!")\n'
AFTER = '    robot.say("Now.")\n'
LOOKS = '    while not robot.sees("unicorn"):\n        robot.wait(5)\n'


@pytest.mark.parametrize(
    ("program", "why", "goes_on"),
    [
        (PATROL, "time", True),
        (RECEPTION, "time", True),
        ('while True:\n    robot.wait_for("unicorn")\n', "time", True),
        (SWALLOWS, "time", True),
        ("while True:\n    robot.battery()\n", "calls", True),
        (f"if robot.battery() > 5:\n{indent(RECEPTION, '    ')}", "time", True),
        ('robot.wait_for("unicorn")\nwhile True:\n    robot.wait(1)\n', "time", False),
        (f"while True:\n{LOOKS}{AFTER}", "time", False),
        (f"while True:\n    robot.say('Who?')\n{LOOKS}{AFTER}", "time", False),
        (f"for bed in range(3):\n{indent(PATROL, '    ')}", "time", False),
        (
            'while robot.battery() > 1:\n    robot.goto("ward b")\n    robot.goto("ward a")',
            "time",
            False,
        ),
        (f"{PATROL}    if robot.battery() < 2:\n        break\n", "time", False),
        ("while True:\n    pass\n", "computing", False),
        (
            "def again(n):\n    return 1 if n < 2 else again(n - 1) + again(n - 2)\nagain(90)",
            "computing",
            False,
        ),
        ("sum(1 for a in range(10**6) for b in range(10**6) if a > b)", "computing", False),
    ],
)
def test_what_takes_too_long_breaks_off_and_says_at_what(ward, program, why, goes_on) -> None:
    """What has no end, as a reception, has not failed for that it does not come to one."""
    told = rehearse(program, ward, Budget(seconds=60, calls=50, rounds=5_000))
    assert (told.status, told.message, told.broke_off) == ("unfinished", None, why)
    assert (told.goes_on, told.complete) == (goes_on, goes_on)


def test_a_loop_that_ended_before_may_be_where_it_breaks_off(ward) -> None:
    """Each of several rounds waits, until nobody comes."""
    polite = (
        'while True:\n    while robot.wait_for("person", timeout=5):\n'
        '        robot.say("Hello.")\n    robot.say("Nobody.")\n'
    )
    assert rehearse(polite, ward, Budget(seconds=30)).goes_on


def test_waiting_for_the_evening_is_leapt_over(ward) -> None:
    told = rehearse(
        'while robot.clock().time < "20:00":\n    robot.wait(10)\nrobot.goto("ward a")\n',
        ward.copy(),
    )
    assert (told.status, told.broke_off) == ("done", None)
    assert told.seconds > 12 * 3600
    assert told.places[-1] == "ward a"


def test_waiting_without_end_breaks_off(ward) -> None:
    told = rehearse("while True:\n    robot.wait(1)\n", ward.copy(), Budget(waits=500))
    assert (told.status, told.broke_off) == ("unfinished", "calls")


def test_a_long_wait_is_leapt_over(ward) -> None:
    told = rehearse(
        'robot.goto("ward a")\nrobot.wait(3 * 3600)\n'
        'robot.ask("Tea?", ["yes", "no"], person="Alice")\n',
        ward.copy(),
    )
    assert (told.status, told.broke_off) == ("done", None)
    assert told.seconds > 3 * 3600
    assert told.asks == ("Tea?",)


def of_a_ward(seed: int) -> Simulation:
    return Simulation(load_world("ward"), seed=seed).copy()


class Slow(Simulation):
    """A simulation on a machine that has much else to do."""

    def _deliver(self) -> None:
        began = time.perf_counter()
        while time.perf_counter() - began < 1e-3:
            pass
        super()._deliver()


ROUND = """
import random
while True:
    robot.goto(random.choice(["ward a", "ward b", "corridor"]))
    robot.wait_for("person", timeout=5)
    robot.say("Hello.")
"""


def test_a_busy_machine_gives_the_same_dry_run(monkeypatch) -> None:
    """It would have broken off elsewhere while seconds on the wall were counted."""
    budget = Budget(seconds=60)
    quick = watched(ROUND, of_a_ward(3), budget)
    monkeypatch.setattr(rehearsal.threading, "Timer", _NeverDue)
    slow = Slow(load_world("ward"), seed=3)
    twin = slow.copy()
    twin.__class__ = Slow
    assert watched(ROUND, twin, budget) == quick
    assert quick[0].broke_off == "time"


class _NeverDue(threading.Timer):
    """Who would measure seconds: it is to be far away."""

    def __init__(self, interval: float, act: Callable[[], None]) -> None:
        assert interval >= 120
        super().__init__(interval, act)


@pytest.mark.parametrize("program", [ROUND, "print(list({'a', 'bc', 'd', 'e'}))\n" + ROUND])
def test_the_budget_alone_decides_where_it_breaks_off(program) -> None:
    short = rehearse(program, of_a_ward(1), Budget(seconds=30))
    assert 30 <= short.seconds < 31
    long = rehearse(program, of_a_ward(1), Budget(seconds=50))
    assert long.course[: len(short.course) - 1] == short.course[:-1]


@pytest.mark.parametrize("language", languages())
@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10**9))
def test_what_can_be_said_is_tried_twice_alike(language: str, seed: int) -> None:
    program = write_program(sensible(Knowledge(WORLD).lexicon(language), language, seed).plan)
    stage = Simulation(WORLD, seed=seed)
    budget = Budget(seconds=40, calls=100)
    assert watched(program, stage.copy(), budget) == watched(program, stage.copy(), budget)


def test_a_machine_in_trouble_says_so(ward) -> None:
    told = rehearse("sum(range(10**12))", ward, Budget(real_seconds=0.2))
    assert (told.status, told.broke_off) == ("unfinished", "machine")


def test_what_computes_too_much_is_foreseen(ward) -> None:
    told = rehearse('print("x" * 100)\nwhile True:\n    print("x" * 5000)\n', ward)
    assert told.status == "limit"
    assert "printed more" in told.message


def test_a_skill_of_the_real_robot_does_not_fail_for_the_simulated_one(ward) -> None:
    program = 'robot.do("sit")\nrobot.say("Hello!")\n'
    told = rehearse(program, ward, skills={"sit": "sit down"})
    assert (told.status, told.message) == ("done", None)
    assert "Hello!" in told.says


def test_a_skill_that_no_robot_has_fails(ward) -> None:
    told = rehearse('robot.do("juggle")\n', ward, skills={"sit": "sit down"})
    assert (told.status, told.line) == ("failed", 1)
    assert "juggle" in told.message


# --- at another time


def test_it_is_tried_when_it_will_happen(ward) -> None:
    later = ward.copy()
    later.set_clock(datetime(2026, 12, 24, 17, 59, 30))
    told = rehearse(
        'robot.wait_until("06:00")\nclock = robot.clock()\n'
        'robot.say(f"It is {clock.weekday}, {clock.date}, {clock.time}.")\n',
        later,
    )
    assert told.says == ("It is Friday, 2026-12-25, 06:00.",)
    assert told.seconds == pytest.approx(12 * 3600 + 30, abs=10)


def test_a_review_may_be_of_christmas_eve(ward) -> None:
    knowledge, program = Knowledge(WORLD), "robot.set_volume(80)\nrobot.say(str(robot.clock()))\n"
    eve = datetime(2026, 12, 24, 23, 0)
    reviewed = review(program, knowledge, ward.copy(), at=eve)
    assert reviewed.dry_run.says == ("23:00",)
    assert "volume" in [risk.kind for risk in reviewed.risks]  # people sleep then
    now = review(program, knowledge, ward.copy())
    assert now.dry_run.says == ("08:00",)
    assert "volume" not in [risk.kind for risk in now.risks]
