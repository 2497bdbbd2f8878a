"""A small ward, a log and an operator for the stories of this folder."""

import contextlib

import pytest

from nl2robot.operator import Operator
from nl2robot.runlog import RunLog
from nl2robot.station import simulated_station
from sim.world import load_world


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    """Nothing of a test reaches the user's own log, and nobody is asked in an editor."""
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path / "home"))
    monkeypatch.setenv("NL2ROBOT_USER", "Nurse Kim")
    return tmp_path / "home"


@pytest.fixture
def log(tmp_path):
    log = RunLog(tmp_path / "log" / "runs.sqlite")
    yield log
    log.close()


@pytest.fixture
def station(log):
    with simulated_station(load_world("ward"), log, seed=1) as station:
        yield station


@pytest.fixture
def slow_station(log):
    """The same at ten times real time: slow enough to break into what it does."""
    with simulated_station(load_world("ward"), log, seed=1, speed=10) as station:
        yield station


@pytest.fixture
def sit_down():
    """Sit down at a station as an operator; everybody gets up at the end."""
    with contextlib.ExitStack() as leave:

        def sit_down(station) -> Operator:
            return Operator(leave.enter_context(station.connect()), "Nurse Kim")

        yield sit_down


@pytest.fixture
def operator(station, sit_down):
    return sit_down(station)


@pytest.fixture
def slow_operator(slow_station, sit_down):
    return sit_down(slow_station)
