"""Who told the robot where it is, and taking it back."""

import time
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import pytest

from nl2robot.console.floor.localising import localise, part
from nl2robot.station.part import Backstage
from robot_api.driver import StopFlag
from robot_api.drivers import SimulatedDriver, simulated
from robot_api.errors import InvalidCall, NotPossible
from robot_api.server import Context
from sim.simulation import Simulation
from sim.world.loading import load_world


class Console:
    """The part by itself, with a simulated robot."""

    def __init__(self) -> None:
        self.simulation = Simulation(load_world("city-hospital"))
        self.driver: SimulatedDriver = simulated(self.simulation)
        self.published: list[tuple[str, Any]] = []
        runner: Any = SimpleNamespace()
        self.backstage = Backstage(
            driver=self.driver,
            runner=runner,
            talks=None,  # type: ignore[arg-type]
            proposals=None,  # type: ignore[arg-type]
            simulation=self.simulation,
            publish=lambda kind, data, to=None: self.published.append((kind, data)),
            wanted=lambda kind: True,
            stop=self.driver.stop,
        )
        self.part = part(self.backstage)

    def __call__(self, method: str, **params: Any) -> list[dict[str, Any]]:
        context = Context("tester", StopFlag(), lambda kind, data, to=None: None)
        told: list[dict[str, Any]] = self.part.services[method].handler(params, context)
        return told

    @property
    def pose(self) -> tuple[float, float, float]:
        robot = self.simulation.robot
        return round(robot.x, 2), round(robot.y, 2), round(robot.theta) % 360


@pytest.fixture
def console() -> Iterator[Console]:
    console = Console()
    yield console
    console.part.close()
    console.driver.close()


def test_a_correction_is_taken_back_and_the_taking_back_as_well(console: Console) -> None:
    console("location.set", place="lobby", who="Ruth")
    before = console.pose
    (told, _) = console("location.set", x=10, y=7.7, theta=90, who="Karim")
    assert console.pose == (10, 7.7, 90)
    assert (told["who"], told["before"]["place"], told["after"]["place"]) == (
        "Karim",
        "lobby",
        "main corridor",
    )
    assert abs(told["when"] - time.time()) < 60
    assert console.published[-1] == ("location", {"history": console("location.history")})

    back, *_ = console("location.undo", correction=told["number"], who="Ruth")
    assert console.pose == before and (back["who"], back["undoes"]) == ("Ruth", told["number"])
    console("location.undo", correction=back["number"])
    assert console.pose == (10, 7.7, 90)


def test_what_the_robot_drove_since_is_heeded(console: Console) -> None:
    """It was 5 m and a quarter turn wrong, and still is that much wrong after a metre."""
    console("location.set", x=10, y=7.7, theta=0)
    told, *_ = console("location.set", x=15, y=7.7, theta=90)
    console.driver.call("localize", {"x": 15, "y": 8.2, "theta": 90}, StopFlag())  # half a metre on
    console("location.undo", correction=told["number"])
    assert console.pose == (10.5, 7.7, 0)


def test_only_the_last_correction_is_taken_back(console: Console) -> None:
    first, *_ = console("location.set", place="lobby")
    console("location.set", place="pharmacy")
    assert [each["undoable"] for each in console("location.history")] == [True, False]
    with pytest.raises(InvalidCall, match="told since where it is"):
        console("location.undo", correction=first["number"])
    with pytest.raises(NotPossible):
        console("location.set", x=0.05, y=0.05, theta=0)
    assert len(console("location.history")) == 2, "what was refused is no correction"


def test_who_drives_by_hand_is_in_the_history_too(console: Console) -> None:
    localise(console.backstage, {"place": "lobby"}, "Ruth", StopFlag())
    assert [each["who"] for each in console("location.history")] == ["Ruth"]
