"""A visitor is guided to the pharmacy: by robots with ROS 2 and ROS 1, and by the simulated one."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from typing import Any

import pytest

from robot_api.capabilities.sound import Asked, Sound
from robot_api.driver import Driver, StopFlag
from robot_api.drivers import simulated
from robot_api.errors import StopNotConfirmed
from sandbox.execution import Execution, Outcome
from sim.simulation import Simulation
from sim.world import load_world
from tests.robots.ros.stand_in import StandIn
from tests.robots.ros.ward import Heard, connected

GUIDE = """\
desk = robot.location()
robot.say("Please come with me to the pharmacy.")
robot.goto("pharmacy")
answer = robot.ask("Is there anything else?", ["yes", "no"])
robot.goto(desk)
robot.say(f"The visitor is at the pharmacy. Anything else: {answer}.")
"""
REPORT = "The visitor is at the pharmacy. Anything else: no."
WORLD = """\
name: ward
walls: [[-5, -5, 10, -5], [10, -5, 10, 8], [10, 8, -5, 8], [-5, 8, -5, -5]]
robot: {start: charger}
places:
  - {name: charger, pose: [0, 0, 0]}
  - {name: pharmacy, pose: [4, 3, 90]}
people:
  - {name: Ann, kind: visitor, at: pharmacy, answers: ["no"]}
"""


class Visitor:
    """Answers what is asked."""

    def __init__(self, words: Sequence[str]) -> None:
        self._words = list(words)

    def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> str | None:
        return self._words.pop(0) if self._words else None


def run(driver: Driver, program: str, during: Callable[[Execution], None] | None = None) -> Outcome:
    flag = StopFlag()

    def call(method: str, arguments: dict[str, Any], line: int) -> Any:
        return driver.call(method, arguments, flag)

    execution = Execution(program, call)
    if during is not None:
        threading.Thread(target=during, args=(execution,), daemon=True).start()
    return execution.run()


def told(driver: Driver) -> list[str]:
    said: list[str] = []

    def hear(kind: str, data: Any) -> None:
        if kind == "speech":
            said.append(data["text"])

    driver.subscribe(hear)
    return said


@pytest.mark.parametrize("version", [1, 2])
def test_the_visitor_comes_to_the_pharmacy_as_in_the_simulation(version: int, tmp_path) -> None:
    file = tmp_path / "ward.yaml"
    file.write_text(WORLD, encoding="utf-8")
    in_simulation = simulated(Simulation(load_world(str(file))))
    said_there = told(in_simulation)
    there = run(in_simulation, GUIDE)
    in_simulation.close()

    visitor = Sound(ears=Visitor(["no"]))
    with StandIn(version) as robot, connected(robot, sound=visitor) as driver:
        said_here = told(driver)
        here = run(driver, GUIDE)
        assert [(goal.x, goal.y) for goal in robot.goals] == [(4, 3), (0, 0)]
        assert robot.stands

    assert (here.status, here.line, here.calls) == (there.status, there.line, there.calls)
    assert here.status == "done"
    assert said_here == said_there
    assert said_here[-1] == REPORT


@pytest.mark.parametrize("version", [1, 2])
def test_stopped_half_way_it_stands_and_says_so(version: int) -> None:
    with StandIn(version, speed=1.0) as robot, connected(robot) as driver:
        heard = Heard(driver)
        flag = StopFlag()
        ended: list[BaseException] = []

        def go() -> None:
            try:
                driver.call("goto", {"place": "far end"}, flag)
            except BaseException as error:  # noqa: BLE001 - looked at below
                ended.append(error)

        thread = threading.Thread(target=go)
        thread.start()
        robot.until(lambda: robot.body.x > 0.5)
        driver.stop("The nurse said stop.")
        where = robot.body.x
        assert robot.stands
        thread.join(5)
        assert type(ended[0]).__name__ == "Stopped"
        assert robot.goal is None and robot.goals[0].cancelled
        assert heard.of("stopped") == [{"because": "The nurse said stop."}]
        assert robot.body.x == where < 5


@pytest.mark.parametrize("version", [1, 2])
def test_cut_off_half_way_the_program_ends_and_nothing_is_taken_up_again(version: int) -> None:
    with StandIn(version, speed=1.0) as robot, connected(robot) as driver:
        heard = Heard(driver)

        def cut(execution: Execution) -> None:
            robot.until(lambda: robot.body.x > 0.3)
            robot.cut()

        outcome = run(driver, 'robot.goto("far end")\nrobot.say("Here.")', cut)
        assert outcome.status == "failed"
        assert "LostConnection" in str(outcome)
        assert robot.goal is not None  # without a guard on the robot it drives on
        with pytest.raises(StopNotConfirmed, match="Use the robot's own button"):
            driver.stop("The nurse said stop.")

        robot.mend()
        heard.wait(lambda: [data["state"] for data in heard.of("link")] == ["lost", "connected"])
        robot.until(lambda: robot.stands and robot.goal is None)
        assert robot.body.x < 29
        assert len(robot.goals) == 1
        assert driver.call("location", {}, StopFlag()).x == pytest.approx(robot.body.x, abs=0.1)
