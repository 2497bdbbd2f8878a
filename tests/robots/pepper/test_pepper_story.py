"""One errand, on the simulator and on a Pepper: the same program, and the same comes of it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from nl2robot.speech.aloud import ears_at
from robot_api.capabilities.sound import Asked, Sound
from robot_api.driver import StopFlag
from robot_api.drivers import ComposedDriver, simulated
from robot_api.values import Location
from sandbox.execution import Execution, Outcome
from sim.simulation import Simulation
from sim.world import load_world
from tests.fetched import fetched
from tests.robots.pepper.conftest import until

RECORDINGS = Path(__file__).parents[2] / "speech" / "recordings"

ERRAND = """\
desk = robot.location()
place = robot.ask("Shall we go to radiology or to the pharmacy?", ["radiology", "pharmacy"])
robot.guide("person", place)
right = robot.ask("Is this where you wanted to go?", ["yes", "no"])
robot.goto(desk)
robot.say(f"A visitor is at the {place}. Was it right? The answer was {right}.")
"""

WARD = """\
name: ward
robot: {start: lobby}
walls: [[-6, -3, 6, -3], [6, -3, 6, 5], [6, 5, -6, 5], [-6, 5, -6, -3]]
places:
  - {name: lobby, pose: [0, 0, 0]}
  - {name: pharmacy, kind: room, pose: [3, 2, 90]}
  - {name: radiology, kind: room, pose: [-3, 2, 90]}
people:
  - {name: Ann, kind: visitor, at: lobby, answers: ["to the pharmacy please", "yes please"]}
"""


class Answers:
    """Ears that hear what a visitor says, one answer after the other."""

    def __init__(self, *words: str) -> None:
        self._words = list(words)

    def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> str | None:
        return self._words.pop(0) if self._words else None


def execution_on(driver: ComposedDriver, program: str = ERRAND) -> Execution:
    def call(method: str, arguments: dict[str, Any], line: int) -> Any:
        return driver.call(method, arguments, StopFlag())

    return Execution(program, call)


def outcome_on(driver: ComposedDriver) -> tuple[Outcome, list[tuple[str, Any]], str]:
    """How it ended, what each call gave, and what was said last. Where the desk is on the robot's
    map is the robot's own affair."""
    outcome = execution_on(driver).run()
    results = [
        (made.method, None if isinstance(made.result, Location) else made.result)
        for made in driver.calls
    ]
    return outcome, results, str(driver.calls[-1].arguments["text"])


@pytest.fixture
def ward(tmp_path: Path) -> Any:
    file = tmp_path / "ward.yaml"
    file.write_text(WARD, encoding="utf-8")
    return load_world(str(file))


def test_a_visitor_is_shown_the_way_by_pepper_as_in_the_simulator(
    ward: Any, standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """Pepper hears the visitor by its own microphone and our recogniser."""
    fetched("en")
    voices = ("to-the-pharmacy-please.wav", "yes-please.wav")
    pepper = standing_in(voices=[str(RECORDINGS / voice) for voice in voices])
    on_pepper = drive(pepper, sound=Sound(ears_at=ears_at(ward)))
    with_pepper = outcome_on(on_pepper)
    in_the_simulator = outcome_on(simulated(Simulation(ward)))
    assert with_pepper == in_the_simulator
    assert with_pepper[0].status == "done"
    assert pepper.texts[-1] == with_pepper[2]
    assert "Please follow me." in pepper.texts
    assert [deed for deed in pepper.done if deed.startswith("navigate")] == [
        "navigate 3.00 2.00",
        "navigate 0.00 0.00",
    ]
    assert pepper.pose == pytest.approx([0, 0, 0], abs=0.05)


def test_stopped_in_the_middle_it_stands_and_the_program_is_over(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(hurry=2.0)
    driver = drive(pepper, sound=Sound(ears_at=lambda _: Answers("pharmacy")))
    execution = execution_on(driver)
    outcomes: list[Outcome] = []
    running = threading.Thread(target=lambda: outcomes.append(execution.run()))
    running.start()
    assert until(lambda: pepper.speed > 0.2)
    execution.stop("Nurse Kim pressed stop.")
    driver.stop("Nurse Kim pressed stop.")
    assert pepper.speed < 0.001
    running.join(5)
    assert [outcome.status for outcome in outcomes] == ["stopped"]
    assert "navigate 0.00 0.00" not in pepper.done


def test_cut_in_the_middle_the_program_ends_and_is_not_taken_up_again(
    standing_in: Callable[..., Any], drive: Callable[..., Any], network: Callable[..., Any]
) -> None:
    """Pepper drives on while nobody reaches it; found again, the first thing that it hears is to
    stop."""
    pepper = standing_in(hurry=0.5)
    way = network(pepper)
    driver = drive(way, sound=Sound(ears_at=lambda _: Answers("pharmacy")))
    links: list[str] = []
    driver.subscribe(lambda kind, data: links.append(data["state"]) if kind == "link" else None)
    outcomes: list[Outcome] = []
    running = threading.Thread(target=lambda: outcomes.append(execution_on(driver).run()))
    running.start()
    assert until(lambda: pepper.speed > 0.1)
    way.cut()
    running.join(5)
    [outcome] = outcomes
    assert (outcome.status, outcome.error) == ("failed", "LostConnection")
    assert "in the network" in outcome.message
    assert pepper.speed > 0
    way.mend()
    assert until(lambda: "connected" in links)
    assert links == ["lost", "connected"]
    assert pepper.speed < 0.001
    assert pepper.pose[0] < 2.9
    assert "navigate 0.00 0.00" not in pepper.done
