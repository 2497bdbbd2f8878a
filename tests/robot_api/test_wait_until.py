"""A robot waits for a time of day: at night for the morning, over a weekend, until a stop."""

from __future__ import annotations

import threading
from datetime import datetime, timedelta
from zoneinfo import ZoneInfo

import pytest

from robot_api.capabilities.base import Hub
from robot_api.capabilities.core import Core, LogBook
from robot_api.driver import StopFlag
from robot_api.drivers import emulated, simulated
from robot_api.errors import InvalidCall, NotPossible, Stopped
from robot_api.values import Clock
from sim.simulation import Simulation
from sim.world.loading import load_world

ZURICH = ZoneInfo("Europe/Zurich")
EVENING = datetime(2026, 11, 20, 22, 30, tzinfo=ZURICH)  # a Friday


def test_the_night_shift_waits_for_the_morning() -> None:
    robot = emulated(start=EVENING)
    robot.call("wait_until", {"time": "06:00"}, StopFlag())
    clock = robot.call("clock", {}, StopFlag())
    assert clock == Clock("06:00", "Saturday", "2026-11-21", "Europe/Zurich")
    robot.call("wait_until", {"time": "07:45", "weekday": "Monday"}, StopFlag())
    assert robot.call("clock", {}, StopFlag()).date == "2026-11-23"
    robot.call("wait_until", {"time": "18:00", "date": "2026-12-24"}, StopFlag())
    assert robot.call("clock", {}, StopFlag()).weekday == "Thursday"


def test_a_simulated_one_goes_by_the_simulated_clock() -> None:
    simulation = Simulation(load_world("ward"), start=EVENING.replace(second=30))
    robot = simulated(simulation)
    robot.call("wait_until", {"time": "22:31"}, StopFlag())
    assert simulation.time == pytest.approx(30)
    assert f"{simulation.clock():%H:%M:%S}" == "22:31:00"


def test_in_a_dry_run_a_week_is_over_at_once() -> None:
    copy = Simulation(load_world("ward"), start=EVENING).copy()
    robot = simulated(copy)
    robot.call("wait_until", {"time": "22:00", "weekday": "Friday"}, StopFlag())
    assert f"{copy.clock():%A %Y-%m-%d %H:%M}" == "Friday 2026-11-27 22:00"
    assert copy.stepped < 120


@pytest.mark.parametrize(
    "arguments, error, sentence",
    [
        ({"time": "6 o'clock"}, InvalidCall, "06:00"),
        ({"time": "24:00"}, InvalidCall, "06:00"),
        ({"time": "06:00", "weekday": "Montag"}, InvalidCall, "Monday"),
        ({"time": "06:00", "date": "24.12."}, InvalidCall, "2026-12-24"),
        ({"time": "06:00", "date": "2026-11-20"}, NotPossible, "is past"),
    ],
)
def test_what_never_comes_is_refused(
    arguments: dict[str, str], error: type[Exception], sentence: str
) -> None:
    with pytest.raises(error, match=sentence):
        emulated(start=EVENING).call("wait_until", arguments, StopFlag())


def test_a_stop_ends_it_at_once() -> None:
    robot, flag = emulated(start=EVENING, speed=1.0), StopFlag()
    threading.Timer(0.05, flag.set).start()
    with pytest.raises(Stopped):
        robot.call("wait_until", {"time": "06:00"}, flag)
    with pytest.raises(Stopped):
        emulated(start=EVENING).call("wait_until", {"time": "06:00"}, flag)


class ByTheMachine(Core):
    """A robot that goes by the clock of its machine, which somebody may set."""

    def __init__(self, *jumps: timedelta) -> None:
        super().__init__(LogBook(self.now, Hub()))
        self.clock_shows = EVENING
        self.jumps = list(jumps)
        self.waited: list[float] = []

    def wait(self, stop: StopFlag, seconds: float) -> None:
        stop.check()
        self.waited.append(seconds)
        self.clock_shows += timedelta(seconds=seconds)
        if self.jumps:
            self.clock_shows += self.jumps.pop()

    def now(self) -> datetime:
        return self.clock_shows

    def place_kinds(self) -> dict[str, str]:
        return {}

    def charge(self) -> float:
        return 100.0

    def rest(self) -> None:
        """It has no body."""


@pytest.mark.parametrize(
    "jump, waits", [(timedelta(minutes=29), 60), (timedelta(hours=9), 1), (timedelta(0), 1800)]
)
def test_a_clock_that_is_set_meanwhile_is_seen_within_a_second(jump: timedelta, waits: int) -> None:
    robot = ByTheMachine(jump)
    robot.wait_until(StopFlag(), "23:00", None, None)
    assert max(robot.waited) <= 1.0
    assert sum(robot.waited) == pytest.approx(waits, abs=1.1)
    assert robot.now() >= EVENING.replace(hour=23, minute=0)
