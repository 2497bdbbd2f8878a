"""A robot at another server, as a driver: passed on, lost, found, stopped."""

from __future__ import annotations

import queue
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from robot_api.client import Robot
from robot_api.driver import Event, StopFlag
from robot_api.errors import LostConnection, StopNotConfirmed, Stopped
from robot_api.robots.address import parse
from robot_api.robots.opening import open_robot
from robot_api.robots.registry import kind_of
from robot_api.robots.wire import WireDriver
from robot_api.server import Server
from robot_api.values import Location
from sim.simulation import Simulation
from sim.world.loading import load_world
from tests.robots.far_robot import SOON, FarRobot
from tests.robots.test_stops_and_links import Diary, Errand

STEP = {"metres": 3.0}


@pytest.fixture
def robot() -> FarRobot:
    return FarRobot()


@pytest.fixture
def server(robot: FarRobot) -> Iterator[Server]:
    server = Server(robot, port=0)
    server.start()
    yield server
    robot.core.confirms = True
    server.close()


@pytest.fixture
def here(server: Server) -> Iterator[WireDriver]:
    driver = WireDriver(server.address)
    yield driver
    driver.close()


def until(here: WireDriver, kind: str, **data: Any) -> threading.Event:
    """Set once such an event comes."""
    came = threading.Event()

    def listen(of: str, told: Event) -> None:
        if of == kind and all(told.get(name) == value for name, value in data.items()):
            came.set()

    here.subscribe(listen)
    return came


def test_everything_is_passed_on() -> None:
    from robot_api.drivers import simulated

    driver = simulated(Simulation(load_world("ward"), seed=1))
    with Server(driver, port=0) as server:
        address = parse(f"ws://{server.address}")
        here = open_robot(address, kind_of(address))
        assert here.capabilities().methods == driver.capabilities().methods
        speech = until(here, "speech", text="Hello")
        here.call("goto", {"place": "ward a"}, StopFlag())
        where = here.call("location", {}, StopFlag())
        assert isinstance(where, Location)
        assert where.place == "ward a"
        here.call("say", {"text": "Hello", "language": None}, StopFlag())
        assert speech.wait(SOON)
        here.close()
    driver.close()


def test_a_flag_breaks_off_one_call_and_not_another(robot: FarRobot, here: WireDriver) -> None:
    roll, wait = StopFlag(), StopFlag()
    rolling = Errand(lambda: here.call("move", STEP, roll))
    assert robot.wheels.under_way.acquire(timeout=SOON)
    waiting = Errand(lambda: here.call("wait", {"seconds": 60}, wait))
    roll.set("That is far enough.")
    assert isinstance(rolling.end(), Stopped)
    with pytest.raises(queue.Empty):
        waiting._ended.get(timeout=0.05)  # it goes on
    wait.set("That is long enough.")
    assert isinstance(waiting.end(), Stopped)


def test_a_stop_is_confirmed_by_the_robot_itself(robot: FarRobot, here: WireDriver) -> None:
    confirmed = until(here, "stopped")
    here.stop("The nurse said so.")
    assert confirmed.wait(SOON)
    robot.core.confirms = False
    doubted = until(here, "stop_not_confirmed")
    with pytest.raises(StopNotConfirmed):
        here.stop("The nurse said so.")
    assert doubted.wait(SOON)


def test_a_robot_that_is_lost_there_is_lost_here(robot: FarRobot, here: WireDriver) -> None:
    rolling = Errand(lambda: here.call("move", STEP, StopFlag()))
    assert robot.wheels.under_way.acquire(timeout=SOON)
    lost, found = until(here, "link", state="lost"), until(here, "link", state="connected")
    robot.is_lost()
    assert isinstance(rolling.end(), LostConnection)
    assert lost.wait(SOON)
    with pytest.raises(LostConnection, match="does not answer any more"):
        here.call("battery", {}, StopFlag())
    robot.link.found()
    assert found.wait(SOON)
    assert here.call("battery", {}, StopFlag()) > 0


def test_a_server_that_ends_is_lost_and_found_again_when_it_is_back(robot: FarRobot) -> None:
    server = Server(robot, port=0)
    server.start()
    address = server.address
    here = WireDriver(address)
    lost, found = until(here, "link", state="lost"), until(here, "link", state="connected")
    rolling = Errand(lambda: here.call("move", STEP, StopFlag()))
    assert robot.wheels.under_way.acquire(timeout=SOON)
    server.close()
    assert isinstance(rolling.end(), LostConnection | Stopped)
    assert lost.wait(SOON)
    with pytest.raises(LostConnection, match=r"server at .* was lost"):
        here.call("battery", {}, StopFlag())
    diary = Diary()
    here.subscribe(diary.note)
    assert diary.next()[1]["state"] == "lost"  # who comes later is told
    with pytest.raises(StopNotConfirmed):
        here.stop("The nurse said so.")
    assert diary.kinds(2) == ["stopping", "stop_not_confirmed"]
    again = Server(robot, port=int(address.rpartition(":")[2]))
    with again:
        assert found.wait(SOON)
        speech = until(here, "speech", text="Here I am.")
        here.call("say", {"text": "Here I am.", "language": None}, StopFlag())
        assert speech.wait(SOON)
        here.close()


def test_a_token_is_asked_for_and_shown(robot: FarRobot) -> None:
    with Server(robot, host="0.0.0.0", port=0, token="sesame") as server:
        port = server.address.rpartition(":")[2]
        with Robot(f"127.0.0.1:{port}", token="sesame"):
            pass
        here = WireDriver(f"127.0.0.1:{port}", "sesame")
        assert here.call("battery", {}, StopFlag()) > 0
        here.close()


def test_what_is_no_robot_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    from websockets.sync.server import serve

    def say_nothing(connection: Any) -> None:
        for _ in connection:
            pass

    monkeypatch.setattr("robot_api.robots.wire.SILENT_FOR", 0.3)
    with serve(say_nothing, "127.0.0.1", 0) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        port = server.socket.getsockname()[1]
        with pytest.raises(LostConnection, match="it is no robot's"):
            WireDriver(f"127.0.0.1:{port}")
        server.shutdown()
    with pytest.raises(LostConnection, match="Is its server running"):
        WireDriver(f"127.0.0.1:{port}")
