"""A visitor is guided to the pharmacy: by robots with ROS 2 and ROS 1, and by the simulated one."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

import pytest

from robot_api.capabilities.sound import Sound
from robot_api.driver import Driver, StopFlag
from robot_api.errors import StopNotConfirmed
from sandbox.execution import Execution, Outcome
from tests.robots import errand
from tests.robots.errand import Visitor, outcome_on
from tests.robots.ros.stand_in import StandIn
from tests.robots.ros.ward import Heard, connected


def run(driver: Driver, program: str, during: Callable[[Execution], None] | None = None) -> Outcome:
    flag = StopFlag()

    def call(method: str, arguments: dict[str, Any], line: int) -> Any:
        return driver.call(method, arguments, flag)

    execution = Execution(program, call)
    if during is not None:
        threading.Thread(target=during, args=(execution,), daemon=True).start()
    return execution.run()


@pytest.mark.parametrize("version", [1, 2])
def test_the_visitor_comes_to_the_pharmacy_as_in_the_simulation(version: int, tmp_path) -> None:
    visitor = Sound(ears=Visitor("to the pharmacy please", "yes please"))
    with (
        StandIn(version) as robot,
        connected(robot, sound=visitor, places=errand.PLACES) as driver,
    ):
        here = outcome_on(driver)
        assert [(goal.x, goal.y) for goal in robot.goals] == [(3, 2), (0, 0)]
        assert robot.stands
    assert here == errand.in_the_simulator(tmp_path)
    assert (here[0].status, here[2]) == ("done", errand.REPORT)


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
