"""A stop tells the truth, and a lost robot is known to be lost: at the driver and on the wire."""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest

from robot_api.client import Robot
from robot_api.driver import Event, StopFlag
from robot_api.errors import LostConnection, StopNotConfirmed, Stopped
from robot_api.server import Server
from tests.robots.far_robot import SOON, FarRobot

STEP = {"metres": 3.0}


class Diary:
    """What was told, in its order."""

    def __init__(self) -> None:
        self._told: queue.Queue[tuple[str, Event]] = queue.Queue()

    def note(self, kind: str, data: Event) -> None:
        if kind != "log":
            self._told.put((kind, data))

    def next(self) -> tuple[str, Event]:
        return self._told.get(timeout=SOON)

    def kinds(self, number: int) -> list[str]:
        return [self.next()[0] for _ in range(number)]


class Errand:
    """Something that is done in a thread of its own."""

    def __init__(self, do: Callable[[], Any]) -> None:
        self._ended: queue.Queue[BaseException | None] = queue.Queue()
        threading.Thread(target=self._run, args=(do,), daemon=True).start()

    def _run(self, do: Callable[[], Any]) -> None:
        try:
            do()
            self._ended.put(None)
        except BaseException as error:  # noqa: BLE001 - the test looks at it
            self._ended.put(error)

    def end(self) -> BaseException | None:
        return self._ended.get(timeout=SOON)


@pytest.fixture
def robot() -> FarRobot:
    return FarRobot()


@pytest.fixture
def diary(robot: FarRobot) -> Diary:
    diary = Diary()
    robot.subscribe(diary.note)
    return diary


@pytest.fixture
def server(robot: FarRobot) -> Iterator[Server]:
    server = Server(robot, port=0)
    server.start()
    yield server
    robot.core.confirms, robot.core.raises, robot.core.held = True, None, None
    server.close()


def rolling(robot: FarRobot, flag: StopFlag | None = None) -> Errand:
    errand = Errand(lambda: robot.call("move", STEP, flag or StopFlag()))
    assert robot.wheels.under_way.acquire(timeout=SOON)
    return errand


# --- a stop


def test_a_confirmed_stop_is_told_in_two_steps(robot: FarRobot, diary: Diary) -> None:
    ride = rolling(robot)
    robot.stop("The nurse said so.")
    assert isinstance(ride.end(), Stopped)
    assert diary.next() == ("stopping", {"because": "The nurse said so."})
    assert diary.next() == ("stopped", {"because": "The nurse said so."})


def test_a_stop_that_is_not_confirmed_is_never_called_stopped(
    robot: FarRobot, diary: Diary
) -> None:
    robot.core.confirms = False
    ride = rolling(robot)
    with pytest.raises(StopNotConfirmed, match="Use the robot's own button"):
        robot.stop("The nurse said so.")
    assert isinstance(ride.end(), Stopped)  # what it was doing has ended here all the same
    assert diary.next()[0] == "stopping"
    kind, data = diary.next()
    assert kind == "stop_not_confirmed"
    assert data["because"] == "The nurse said so."
    assert "own button" in data["message"]
    lines = robot.call("log", {"lines": 20}, StopFlag())
    assert any("stop not confirmed" in line for line in lines)
    assert not any("stopped:" in line for line in lines)


def test_a_stop_whose_software_breaks_is_not_confirmed(robot: FarRobot, diary: Diary) -> None:
    robot.core.raises = RuntimeError("Session closed")
    with pytest.raises(StopNotConfirmed) as raised:
        robot.stop("The nurse said so.")
    assert "Session closed" not in str(raised.value)
    assert diary.kinds(2) == ["stopping", "stop_not_confirmed"]


def test_a_stop_that_never_comes_back_is_not_confirmed_in_time(robot: FarRobot) -> None:
    robot.core.held = threading.Event()
    with pytest.raises(StopNotConfirmed):
        robot.stop("The nurse said so.")
    robot.core.held.set()


def test_a_listener_that_stumbles_does_not_keep_the_robot_from_stopping(robot: FarRobot) -> None:
    def stumble(kind: str, data: Event) -> None:
        if kind == "stopping":
            raise ZeroDivisionError

    robot.subscribe(stumble)
    robot.stop("The nurse said so.")
    assert robot.core.asked.acquire(blocking=False)


def test_stop_as_a_method_raises_what_the_robot_did_not_confirm(robot: FarRobot) -> None:
    robot.core.confirms = False
    with pytest.raises(StopNotConfirmed):
        robot.call("stop", {}, StopFlag())


def test_on_the_wire_a_stop_answers_with_the_truth(robot: FarRobot, server: Server) -> None:
    robot.core.confirms = False
    with Robot(server.address) as nurse:
        with pytest.raises(StopNotConfirmed, match="own button"):
            nurse.stop()
        robot.core.confirms = True
        nurse.stop()


def test_a_second_stop_does_not_wait_until_the_first_is_confirmed(
    robot: FarRobot, server: Server
) -> None:
    robot.core.held = threading.Event()
    with Robot(server.address) as nurse, Robot(server.address) as visitor:
        stops = [Errand(nurse.stop), Errand(visitor.stop)]
        for _ in stops:  # the robot hears both, though it has confirmed neither
            assert robot.core.asked.acquire(timeout=SOON)
        robot.core.held.set()
        assert [stop.end() for stop in stops] == [None, None]


def test_who_comes_later_learns_that_a_stop_was_not_confirmed(
    robot: FarRobot, server: Server
) -> None:
    robot.core.confirms = False
    with Robot(server.address) as nurse, pytest.raises(StopNotConfirmed):
        nurse.stop()
    late, later = Diary(), Diary()
    with Robot(server.address) as visitor:
        visitor.subscribe(["stop_not_confirmed"], late.note)
        assert late.next()[0] == "stop_not_confirmed"
        robot.core.confirms = True
        visitor.stop()
        visitor.subscribe(["stop_not_confirmed", "emotion"], later.note)
        robot.emulation.publish("emotion", name="happy")
        assert later.next()[0] == "emotion"  # the next stop was confirmed: it is past


def test_a_server_that_ends_says_that_the_robot_may_not_stand(robot: FarRobot) -> None:
    robot.core.confirms = False
    server = Server(robot, port=0)
    server.start()
    with pytest.raises(StopNotConfirmed):
        server.close()


# --- lost and found


def test_a_lost_robot_ends_what_is_in_flight_and_refuses_what_is_new(
    robot: FarRobot, diary: Diary
) -> None:
    ride = rolling(robot)
    robot.is_lost()
    lost = ride.end()
    assert isinstance(lost, LostConnection)
    assert "does not answer any more. See that it is switched on" in str(lost)
    with pytest.raises(LostConnection):
        robot.call("say", {"text": "Hello?"}, StopFlag())
    kind, data = diary.next()
    assert (kind, data["state"]) == ("link", "lost")
    assert data["because"] == "The far robot does not answer any more."


def test_what_its_software_says_when_it_is_cut_off_is_a_lost_connection(robot: FarRobot) -> None:
    robot.wheels.breaks = RuntimeError("Future timeout.")
    ride = rolling(robot)
    robot.is_lost()
    assert isinstance(ride.end(), LostConnection)


def test_a_call_that_was_stopped_before_it_was_lost_stays_stopped(robot: FarRobot) -> None:
    flag = StopFlag()
    robot.wheels.breaks = None
    ride = rolling(robot, flag)
    flag.set("The visitor let go.")
    assert isinstance(ride.end(), Stopped)
    robot.is_lost()


def test_a_lost_robot_can_still_be_told_to_stop(robot: FarRobot) -> None:
    robot.is_lost()
    robot.stop("The nurse said so.")  # it has a connection of its own
    assert robot.core.asked.acquire(blocking=False)
    robot.core.confirms = False
    with pytest.raises(StopNotConfirmed):
        robot.call("stop", {}, StopFlag())


def test_a_robot_that_was_lost_while_it_moved_is_stopped_when_it_is_found(
    robot: FarRobot, diary: Diary
) -> None:
    ride = rolling(robot)
    robot.is_lost()
    ride.end()
    assert not robot.core.asked.acquire(blocking=False)
    robot.link.found()
    assert robot.core.asked.acquire(timeout=SOON)
    assert sorted(diary.kinds(4)) == ["link", "link", "stopped", "stopping"]
    robot.call("say", {"text": "Here I am."}, StopFlag())


def test_a_robot_that_stood_when_it_was_lost_is_left_alone(robot: FarRobot, diary: Diary) -> None:
    robot.is_lost()
    robot.is_lost()  # found out twice, told once
    robot.link.found()
    robot.call("say", {"text": "Here I am."}, StopFlag())
    assert diary.kinds(3) == ["link", "link", "speech"]


def test_who_comes_later_learns_that_the_robot_is_lost(robot: FarRobot) -> None:
    robot.is_lost()  # before anybody serves it
    with Server(robot, port=0) as server, Robot(server.address) as nurse:
        diary = Diary()
        nurse.subscribe("link", diary.note)
        assert diary.next()[1]["state"] == "lost"
        robot.link.found()
        assert diary.next()[1]["state"] == "connected"
        with pytest.raises(LostConnection):
            robot.is_lost()
            nurse.move(1)
