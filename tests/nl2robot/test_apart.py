"""What computes for long is done in other processes: nobody who wants to stop waits for it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.review.apart import Helpers, think
from nl2robot.review.review import review, review_apart
from nl2robot.sentences import told
from nl2robot.translate.talk import Talk
from nl2robot.translate.translation import translate
from nl2robot.work import Died, Do, TookTooLong, here
from robot_api.drivers import simulated
from robot_api.errors import NotPossible
from sim.simulation import Simulation
from sim.world.loading import load_world

LONG = 60.0
"""Seconds."""


@pytest.fixture
def helpers() -> Iterator[Helpers]:
    made = Helpers(2)
    yield made
    made.close_for_good()


def until(condition) -> None:
    ends = time.monotonic() + LONG
    while not condition():
        assert time.monotonic() < ends, "it did not come about"
        time.sleep(0.01)


def is_alive(pid: int) -> bool:
    """Whether there is a process of this number that has not ended."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_another_process_does_it_and_stays_for_the_next(helpers) -> None:
    first = helpers.call(os.getpid, LONG)
    assert first != os.getpid()
    assert helpers.call(os.getpid, LONG) == first


def test_what_it_raises_is_raised_with_where_it_came_from(helpers) -> None:
    with pytest.raises(FileNotFoundError) as raised:
        helpers.call(partial(open, "/no/such/file"), LONG)
    assert "No such file" in "".join(raised.value.__notes__)
    assert helpers.call(os.getpid, LONG) in helpers.pids


def test_what_prints_disturbs_no_answer(helpers, capfd) -> None:
    helpers.call(partial(print, "hello", flush=True), LONG)
    assert helpers.call(partial(divmod, 7, 2), LONG) == (3, 1)


def test_what_cannot_be_sent_is_said_and_the_next_is_done(helpers) -> None:
    with pytest.raises(TypeError, match="cannot be sent"):
        helpers.call(threading.Lock, LONG)
    assert helpers.call(partial(divmod, 7, 2), LONG) == (3, 1)


def test_who_takes_too_long_is_killed(helpers) -> None:
    pid = helpers.call(os.getpid, LONG)
    with pytest.raises(TookTooLong):
        helpers.call(partial(time.sleep, LONG), 0.2)
    assert not is_alive(pid)
    assert helpers.call(os.getpid, LONG) != pid


def test_one_that_is_killed_at_its_work_is_begun_anew(helpers) -> None:
    pid = helpers.call(os.getpid, LONG)
    made = []
    working = threading.Thread(target=lambda: made.append(helpers.call(partial(sum, [1, 2]), LONG)))
    os.kill(pid, signal.SIGSTOP)  # so that it is surely at its work
    working.start()
    os.kill(pid, signal.SIGKILL)
    working.join(LONG)
    assert made == [3]


def test_one_that_dies_of_the_work_itself_is_not_begun_for_ever(helpers) -> None:
    with pytest.raises(Died):
        helpers.call(partial(os._exit, 3), LONG)
    assert helpers.call(partial(divmod, 7, 2), LONG) == (3, 1)


def test_it_ends_with_whoever_began_it_in_the_middle_of_its_work() -> None:
    program = (
        "import os, time, threading\n"
        "from functools import partial\n"
        "from nl2robot.review.apart import HELPERS\n"
        "print(HELPERS.call(os.getpid, 60), flush=True)\n"
        "HELPERS.call(partial(time.sleep, 600), 600)\n"
    )
    command = [sys.executable, "-c", program]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        assert server.stdout is not None
        pid = int(server.stdout.readline())
        assert is_alive(pid)
        server.kill()
    until(lambda: not is_alive(pid))


TEA = """
names = robot.find_all("patient", where="ward a")
for name in names:
    if robot.ask("Tea?", options=["yes", "no"], whom=name) == "yes":
        robot.say("Tea it is, " + name + ".")
robot.goto("kitchen")
"""


@pytest.mark.parametrize("program", [TEA, "robot.fly()\n", "robot.goto('nowhere')\n", "x = 1 +"])
def test_a_review_says_the_same_wherever_it_is_made(program: str) -> None:
    """Also of a robot that is on its way, with people who walk about."""
    simulation = Simulation(load_world("city-hospital"), seed=3)
    simulation.run(simulation.drive_to(12.0, 3.0), threading.Event())
    knowledge = Knowledge(simulation.world, simulated(simulation).capabilities())
    made_here = review(program, knowledge, simulation.copy(), "de", 5)
    assert review_apart(program, knowledge, simulation.copy(), "de", 5) == made_here


@pytest.mark.parametrize(
    ("language", "conversation"),
    [
        (
            "en",
            (
                "go to the pharmacy, wait for Bob, tell him that lunch is ready and come back",
                "no, to the kitchen",
                "could you perhaps knit a pullover for the patient in the third bed",
                "go to ward a and ask each patient whether they want tea or coffee",
                "and in ward b as well",
            ),
        ),
        ("de", ("geh in die Apotheke und sag dort allen, dass wir gleich schließen", "arrête")),
    ],
)
def test_a_conversation_goes_the_same_way_wherever_it_is_thought_about(
    language: str, conversation: tuple[str, ...]
) -> None:
    knowledge = Knowledge(load_world("city-hospital"))

    def told(do: Do) -> list[tuple[str, str | None, str | None]]:
        talk = Talk()
        made = [
            translate(each, knowledge, language, "grammar", talk, do=do) for each in conversation
        ]
        return [(each.status, each.program, each.message) for each in made]

    assert told(think) == told(here)


def test_a_sentence_without_end_is_asked_for_in_parts() -> None:
    def never(function, /, *args, **kwargs):
        raise TookTooLong

    knowledge = Knowledge(load_world("city-hospital"))
    long = "go to the pharmacy and then go to the kitchen and then go to the lobby"
    answer = translate(long, knowledge, "en", "grammar", do=never)
    assert answer.status == "rejected" and "shorter sentences" in (answer.message or "")
    # What is brief asks nobody else: a stop least of all.
    assert translate("stop", knowledge, "en", do=never).program == "robot.stop()\n"
    assert translate("please stop now", knowledge, "en", do=never).program == "robot.stop()\n"


def test_where_no_process_can_be_begun_that_is_said(helpers, monkeypatch) -> None:
    def no_room(*_: object, **__: object) -> None:
        raise OSError(12, "Cannot allocate memory")

    monkeypatch.setattr("nl2robot.review.apart.subprocess.Popen", no_room)
    monkeypatch.setattr("nl2robot.review.review.HELPERS", helpers)
    with pytest.raises(NotPossible, match="too little memory") as raised:
        review_apart("robot.stop()\n", Knowledge(load_world("city-hospital")))
    assert "zu wenig Speicher" in told(str(raised.value), "de")
    with pytest.raises(Died):
        helpers.call(os.getpid, LONG)
