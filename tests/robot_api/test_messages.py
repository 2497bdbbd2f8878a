"""The paper's own style of client: its listing runs, and all 16 functions are there."""

import importlib.util
import inspect
import itertools
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from robot_api import Server
from robot_api.driver import Driver
from robot_api.drivers import emulated, simulated
from robot_api.errors import Blocked, LostConnection
from robot_api.messages import Robot
from robot_api.methods import METHODS
from robot_api.schema import read_arguments

LISTING = Path(__file__).parents[1] / "programs" / "paper_listing.py"


def listing() -> Callable[..., None]:
    spec = importlib.util.spec_from_file_location("paper_listing", LISTING)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    guide: Callable[..., None] = module.guide
    return guide


def times(number: int) -> Callable[[], bool]:
    """A condition that holds so many times."""
    rounds = itertools.count()
    return lambda: next(rounds) < number


@contextmanager
def connected(driver: Driver) -> Iterator[Robot]:
    with Server(driver, port=0) as server:
        robot = Robot()
        robot.connect(server.address)
        yield robot
        robot.disconnect()


def test_the_papers_listing_drives_by_the_answers() -> None:
    answers = ["to the intensive care unit", None, "the pharmacy please"]
    driver = emulated(answers=answers, units="cm")
    with Server(driver, port=0) as server:
        listing()(server.address, times(3))
    told = [(call.method, call.arguments) for call in driver.calls]
    assert [method for method, _ in told] == [
        *("show", "say", "goto", "say"),
        *("listen", "goto", "say"),
        "listen",
        *("listen", "say", "goto", "say"),
    ]
    targets = [arguments for method, arguments in told if method == "goto"]
    for arguments, x, y, theta in zip(
        targets,
        (-6.05, -1.20, 1.57),
        (-10.27, -4.90, -0.71),
        (math.degrees(-1.3), math.degrees(2.6), math.degrees(-1.3)),
        strict=True,
    ):
        assert (arguments["x"], arguments["y"]) == pytest.approx((x, y))
        assert arguments["theta"] == pytest.approx(theta)


def test_the_papers_listing_drives_through_the_simulated_lab() -> None:
    from sim.simulation import Simulation
    from sim.world.loading import load_world

    simulation = Simulation(load_world("lab-tour"), seed=1)
    driver = simulated(simulation)
    with Server(driver, port=0) as server:
        # Julia at the pharmacy answers "yes", then "the intensive care unit".
        listing()(server.address, times(2))
    said = [call.arguments["text"] for call in driver.calls if call.method == "say"]
    assert said == [
        "I'm coming",
        "We have arrived at the pharmacy.",
        "We have arrived at the intensive care unit.",
    ]
    assert (simulation.robot.x, simulation.robot.y) == pytest.approx((-1.20, -4.90), abs=0.2)
    assert simulation.robot.place == "intensive care unit"


def test_a_location_comes_back_in_the_unit_it_was_given_in() -> None:
    with connected(emulated(units="cm")) as robot:
        robot.send_message(robot.localize(-120, -490, 2.6))
        location = robot.send_message(robot.getLocation())["data"]["location"]
        assert (location["x"], location["y"]) == pytest.approx((-120, -490))
        assert location["theta"] == pytest.approx(2.6)


def test_silence_is_an_empty_text_that_can_be_searched() -> None:
    with connected(emulated(answers=[None])) as robot:
        response = robot.send_message(robot.listen(prompt="Anybody there?"))
        assert response == {"status": "timeout", "data": {"speech": ""}}


def test_a_robot_that_cannot_get_there_does_not_pretend_to() -> None:
    with (
        connected(emulated(results={"goto": Blocked("A bed blocks the way.")})) as robot,
        pytest.raises(Blocked),
    ):
        robot.send_message(robot.goto(1, 2))


def test_who_is_not_connected_is_told_what_to_do() -> None:
    robot = Robot()
    with pytest.raises(LostConnection, match=r"robot\.connect"):
        robot.send_message(robot.say("Hello"))


EXAMPLES: dict[str, Any] = {
    "text": "Hello",
    "volume": 40,
    "options": ["yes", "no"],
    "url": "https://example.org",
    "html": "<p>Hello</p>",
    "emotion": "happy",
    "gesture": "wave",
    "joint": "head_yaw",
    "contact": "reception",
    "selector": "#name",
}


def messages() -> Iterator[tuple[str, dict[str, Any]]]:
    robot = Robot()
    for name, make in inspect.getmembers(robot, inspect.ismethod):
        if name.startswith("_") or name in ("connect", "disconnect", "send_message"):
            continue
        required = [
            parameter.name
            for parameter in inspect.signature(make).parameters.values()
            if parameter.default is parameter.empty or name == "localize"
        ]
        yield name, make(**{key: EXAMPLES.get(key, 1.0) for key in [*required, *_y(name)]})


def _y(name: str) -> list[str]:
    return ["y"] if name == "goto" else []


def test_all_16_functions_of_the_paper_can_be_told_in_its_style() -> None:
    papers = {METHODS[message["method"]].paper for _, message in messages()}
    assert papers >= set(range(1, 17))


@pytest.mark.parametrize("name, message", list(messages()))
def test_a_message_is_a_call_that_the_method_table_allows(
    name: str, message: dict[str, Any]
) -> None:
    read_arguments(message["method"], named=message["params"])
    paper = METHODS[message["method"]].paper
    if paper is not None:
        doc = inspect.getdoc(getattr(Robot, name)) or ""
        assert doc.startswith(f"{paper}:")
