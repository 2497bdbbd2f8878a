"""The benchmark measures what it says; how fast is not for a test to judge."""

from __future__ import annotations

import json

import pytest

from nl2robot.bench import robots as robots_benchmark
from nl2robot.cli.main import main
from nl2robot.errors import ExitStatus
from robot_api.driver import Driver
from robot_api.drivers import emulated, simulated
from robot_api.errors import LostConnection, StopNotConfirmed
from robot_api.robots import benchmark
from robot_api.robots.address import Address
from robot_api.robots.benchmark import measure_calls, measure_losses, measure_stops
from robot_api.robots.registry import Setup
from robot_api.robots.wire import SERVER
from sim.simulation import Simulation
from sim.world.loading import load_world
from tests.robot_api.conformance.distant import DistantDriver, ward


def connect(address: Address) -> Driver:
    return SERVER.connect(Setup(address=address))


def test_calls_are_counted_and_timed() -> None:
    figures = measure_calls(emulated(), calls=20)
    assert set(figures) == {"calls_per_second", "round_trip_ms", "round_trip_p99_ms"}
    assert 0 < figures["round_trip_ms"] <= figures["round_trip_p99_ms"]


def test_a_robot_that_drives_is_stopped_until_it_stands() -> None:
    robot = simulated(Simulation(load_world("ward"), seed=1, speed=1))
    figures = measure_stops(robot, stops=3)
    robot.close()
    assert set(figures) == {
        *("confirmed_ms", "confirmed_worst_ms", "zero_speed_ms", "zero_speed_worst_ms"),
        "unconfirmed",
    }
    assert 0 < figures["zero_speed_ms"] <= figures["zero_speed_worst_ms"]
    assert figures["unconfirmed"] == 0


def test_a_robot_without_wheels_reports_no_speed() -> None:
    figures = measure_stops(emulated(without=["motion"]), stops=3)
    assert set(figures) == {"confirmed_ms", "confirmed_worst_ms", "unconfirmed"}


def test_stops_that_are_not_confirmed_are_counted_and_not_timed() -> None:
    class Silent(DistantDriver):
        def stop(self, because: str) -> None:
            super().stop(because)
            raise StopNotConfirmed

    with ward() as address:
        robot = Silent(address)
        assert measure_stops(robot, stops=3)["unconfirmed"] == 3
        robot.close()


def test_a_loss_is_timed_however_it_comes() -> None:
    with ward() as address:
        figures = measure_losses(connect, address, losses=1)
    assert set(figures) == {"cut_s", "silent_s"}
    assert all(seconds > 0 for seconds in figures.values())


def test_a_loss_that_nobody_is_told_of_has_no_time(monkeypatch: pytest.MonkeyPatch) -> None:
    class Silent(DistantDriver):
        def lost(self) -> None:
            """Nobody is told."""

    monkeypatch.setattr(benchmark, "_LOSS", 0.3)
    with ward() as address:
        assert measure_losses(Silent, address, losses=1) == {}


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Few of everything, and the emulator alone of what is here."""
    monkeypatch.setattr(robots_benchmark, "HERE", ("emulator",))
    for name, few in (("measure_calls", 20), ("measure_stops", 2), ("measure_losses", 1)):
        measure = getattr(benchmark, name)
        monkeypatch.setattr(
            robots_benchmark,
            name,
            lambda *given, measure=measure, few=few: measure(*given, few),
        )


def test_robots_stand_beside_each_other_in_one_table(
    quick: None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bench", "robots"]) == 0
    table = capsys.readouterr().out
    assert "emulator" in table and "ws" in table
    assert "until a silent robot is noticed" in table
    assert "memory of `serve` with it" in table


def test_further_robots_are_named_by_their_addresses(
    quick: None, capsys: pytest.CaptureFixture[str]
) -> None:
    with ward() as address:
        assert main(["bench", "robots", "--robot", str(address), "--json"]) == 0
    measured = json.loads(capsys.readouterr().out)
    assert set(measured) == {"emulator", str(address), "ws"}
    assert measured[str(address)]["serve_mb"] > 10
    assert measured["emulator"].keys().isdisjoint({"cut_s", "silent_s"})


def test_a_robot_that_is_not_there_is_a_sentence(
    quick: None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["bench", "robots", "--robot", "ws://127.0.0.1:1"]) == ExitStatus.NO_ROBOT
    said = capsys.readouterr().err
    assert "127.0.0.1:1" in said and len(said.splitlines()) == 1


def test_a_refused_loss() -> None:
    with pytest.raises(LostConnection):
        measure_losses(connect, Address("ws", "127.0.0.1", 1), losses=1)
