"""A robot somewhere else, used as if it were here; and what happens when it is not there."""

import base64
import contextlib
import hashlib
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from robot_api import Location, Robot, Server, Service
from robot_api.client import websocket_url
from robot_api.drivers import EmulatedDriver, emulated
from robot_api.errors import (
    AccessDenied,
    Blocked,
    InvalidCall,
    LostConnection,
    NotFound,
    NotPossible,
    NotSupported,
    Stopped,
    UnknownPerson,
)
from robot_api.methods import METHODS

REFUSALS = (NotFound, NotPossible, NotSupported, UnknownPerson)  # by the robot, not by the wire
SOON = 20  # seconds; what is waited for comes within milliseconds


@contextmanager
def ward(driver: EmulatedDriver, **options: Any) -> Iterator[Robot]:
    with Server(driver, port=0) as server, Robot(server.address, **options) as robot:
        yield robot


@contextmanager
def logged(driver: EmulatedDriver, start: str) -> Iterator[threading.Event]:
    seen = threading.Event()

    def listen(kind: str, data: Any) -> None:
        if kind == "log" and data["message"].startswith(start):
            seen.set()

    unsubscribe = driver.subscribe(listen)
    yield seen
    unsubscribe()


def in_thread(do: Callable[[], Any]) -> Callable[[], Any]:
    """Start it; what is returned waits for its end and hands on what came out or was raised."""
    outcome: list[Any] = []

    def run() -> None:
        try:
            outcome.append(do())
        except BaseException as error:  # noqa: BLE001 - it is the outcome
            outcome.append(error)

    thread = threading.Thread(target=run, daemon=True)
    thread.start()

    def wait() -> Any:
        thread.join(SOON)
        assert outcome, "it has not ended"
        return outcome[0]

    return wait


# --- a good day


def test_a_morning_round() -> None:
    driver = emulated(answers=["To the pharmacy, please."], results={"battery": 80})
    with ward(driver) as robot:
        desk = robot.location()
        robot.wait_for("person", timeout=60)
        place = robot.ask("Where would you like to go?", ["radiology", "pharmacy"])
        robot.guide("person", place)
        robot.goto(desk)
        robot.goto(12.0, 3.5)
        robot.goto(x=1, y=2, theta=90)
        robot.do("sit", slowly=True)
        robot.do("dance", self="alone", method="waltz")
        assert place == "pharmacy"
        assert robot.location() == Location(1.0, 2.0, 90.0)
        assert robot.battery() == 80
        assert len(str(robot.clock())) == 5
    told = [(call.method, dict(call.arguments)) for call in driver.calls]
    assert ("goto", {"place": desk}) in told
    assert ("goto", {"x": 12.0, "y": 3.5, "theta": None}) in told
    assert ("do", {"skill": "sit", "slowly": True}) in told


@pytest.mark.parametrize("name", METHODS)
def test_every_method_crosses_the_wire_as_it_was_called(name: str) -> None:
    texts = {"str": "pharmacy", "list[str]": ["yes", "no"], "int": 3, "float": 1.5}
    examples = {
        "time": "06:30",
        "code": "en",
        "options": ["yes", "no"],
        "skill": "sit",
        "thing": "stapler",
    }
    given = {
        parameter.name: examples.get(
            parameter.name,
            next(iter(parameter.kind.choices), texts.get(parameter.kind.annotation, "pharmacy")),
        )
        for parameter in METHODS[name].forms[0]
        if parameter.required
    }
    driver = emulated(skills={"sit": "sit down"})
    with ward(driver) as robot, contextlib.suppress(*REFUSALS):
        getattr(robot, name)(**given)
    if name != "stop":  # which never waits behind other calls, nor is one of the driver's
        assert driver.calls[-1].method == name
        assert given.items() <= dict(driver.calls[-1].arguments).items()


def test_the_robots_errors_arrive_under_their_names() -> None:
    driver = emulated(results={"goto": Blocked("A bed blocks the way.")}, without=["manipulation"])
    with ward(driver) as robot:
        with pytest.raises(Blocked, match="A bed blocks the way"):
            robot.goto("pharmacy")
        with pytest.raises(NotSupported):
            robot.grab("stapler")
        assert "grab" not in robot.capabilities().methods


@pytest.mark.parametrize(
    "wrong, sentence",
    [
        (lambda robot: robot.goto(1, 2, 3, 4), "goto needs a place, or x and y"),
        (lambda robot: robot.goto(1, 2, float("nan")), "theta of goto must be a number"),
        (lambda robot: robot.set_volume(200), "whole number from 0 to 100"),
        (lambda robot: robot.say("x" * 3000), "3000 characters"),
        (lambda robot: robot.show(html="x" * 300_000), "too long"),
        (lambda robot: robot.say("\ud800"), "cannot be sent"),
        (lambda robot: robot.request("robot.fly"), "There is no method 'robot.fly'"),
    ],
)
def test_a_wrong_call_is_refused_in_a_sentence(
    wrong: Callable[[Robot], Any], sentence: str
) -> None:
    with ward(emulated()) as robot:
        with pytest.raises(InvalidCall, match=sentence):
            wrong(robot)
        robot.say("I am still here.")


def test_what_is_left_out_is_not_sent() -> None:
    """An older server may not know a parameter that was added since."""
    driver = emulated()
    sent = []
    with ward(driver) as robot:
        request = robot.request
        robot.request = lambda method, params=None, stop=None: (
            sent.append(params) or request(method, params)
        )  # type: ignore[method-assign, func-returns-value]
        robot.say("Hello")
        robot.listen()
        robot.listen(timeout=3)
    assert sent == [{"text": "Hello"}, {}, {"timeout": 3}]


# --- stopping


def test_a_call_is_cancelled_from_another_thread() -> None:
    driver = emulated(speed=1.0)
    with ward(driver) as robot, logged(driver, "drive(") as driving:
        end = in_thread(lambda: robot.drive(0.5, 0, 60))
        assert driving.wait(SOON)
        robot.cancel()
        assert isinstance(end(), Stopped)
        robot.wait(0)


def test_cancelling_stops_only_ones_own_calls() -> None:
    driver = emulated(speed=1.0)
    with (
        Server(driver, port=0) as server,
        Robot(server.address) as mine,
        Robot(server.address) as yours,
    ):
        with logged(driver, "wait(") as waiting:
            end = in_thread(lambda: yours.wait(0.3))
            assert waiting.wait(SOON)
        mine.cancel()
        assert end() is None


def test_a_stop_overtakes_the_call_of_another_thread() -> None:
    driver = emulated(speed=1.0)
    with ward(driver) as robot, logged(driver, "wait(") as waiting:
        end = in_thread(lambda: robot.wait(60))
        assert waiting.wait(SOON)
        robot.stop()
        assert isinstance(end(), Stopped)


def test_a_stop_is_not_swallowed_by_a_careless_program() -> None:
    driver = emulated(speed=1.0)
    reached = []

    def careless(robot: Robot) -> None:
        try:
            robot.wait(60)
        except Exception:  # noqa: BLE001 - that is the carelessness
            reached.append("after the stop")

    with ward(driver) as robot, logged(driver, "wait(") as waiting:
        end = in_thread(lambda: careless(robot))
        assert waiting.wait(SOON)
        robot.stop()
        assert isinstance(end(), Stopped)
    assert not reached


DRIVE = """
import sys
from robot_api import Robot
Robot(sys.argv[1]).drive(0.5, 0, 60)
"""


def test_ctrl_c_in_the_client_leaves_the_robot_standing() -> None:
    driver = emulated(speed=1.0)
    with (
        Server(driver, port=0) as server,
        logged(driver, "drive(") as driving,
        logged(driver, "drive: stopped") as stopped,
    ):
        process = subprocess.Popen(
            [sys.executable, "-c", DRIVE, server.address], stderr=subprocess.PIPE
        )
        assert driving.wait(SOON)
        os.kill(process.pid, signal.SIGINT)
        assert stopped.wait(SOON)
        assert b"KeyboardInterrupt" in process.communicate(timeout=SOON)[1]


def test_threads_share_one_robot() -> None:
    driver = emulated()
    with ward(driver) as robot:

        def count() -> list[int]:
            return [robot.battery() for _ in range(100)]

        ends = [in_thread(count) for _ in range(10)]
        assert [end() for end in ends] == [[100] * 100] * 10


# --- connections that come and go


def test_nobody_at_the_address_is_said_at_once() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"127.0.0.1:{free.getsockname()[1]}"
    with pytest.raises(LostConnection, match=f"There is no robot at {address}"):
        Robot(address)


@pytest.mark.parametrize("address", ["no such host.invalid", "", "127.0.0.1:99999", "::::"])
def test_an_address_that_is_none_is_said_in_a_sentence(address: str) -> None:
    with pytest.raises(LostConnection, match="There is no robot at"):
        Robot(address, timeout=1)


@pytest.mark.parametrize(
    "address, url",
    [
        ("10.0.0.1:9090", "ws://10.0.0.1:9090/"),
        ("robot.ward", "ws://robot.ward:9090/"),
        ("[::1]:8000", "ws://[::1]:8000/"),
        ("wss://robot.ward/arm", "wss://robot.ward/arm"),
    ],
)
def test_an_address_may_be_short(address: str, url: str) -> None:
    assert websocket_url(address) == url


def test_a_wrong_token_is_said_in_a_sentence() -> None:
    with Server(emulated(), host="0.0.0.0", port=0, token="sesame") as server:
        address = server.address.replace("0.0.0.0", "localhost")
        for token in (None, "open up"):
            with pytest.raises(AccessDenied, match="token is missing or wrong"):
                Robot(address, token=token)
        with Robot(address, token="sesame") as robot:
            assert robot.battery() == 100


def test_a_connection_lost_between_calls_is_made_again() -> None:
    driver = emulated()
    with Server(driver, port=0) as first:
        port = int(first.address.rpartition(":")[2])
        robot = Robot(first.address, timeout=SOON)
        robot.say("before")
    restarted = in_thread(lambda: Server(driver, port=port).start())
    robot.say("after")
    assert restarted() is None
    assert [call.arguments["text"] for call in driver.calls if call.method == "say"] == [
        "before",
        "after",
    ]
    robot.close()


def test_it_gives_up_when_the_robot_does_not_come_back() -> None:
    with Server(emulated(), port=0) as server:
        robot = Robot(server.address, timeout=1)
    with pytest.raises(LostConnection, match="There is no robot at"):
        robot.battery()


def test_a_closed_connection_stays_closed() -> None:
    with ward(emulated()) as robot:
        robot.close()
        with pytest.raises(LostConnection, match="was closed"):
            robot.battery()


SERVE = """
from robot_api import Server
from robot_api.drivers import emulated
Server(emulated(speed=1.0), port=0).serve_forever(lambda s: print(s.address, flush=True))
"""


def test_a_robot_killed_in_mid_drive_is_a_lost_connection_and_the_drive_is_not_repeated() -> None:
    process = subprocess.Popen([sys.executable, "-c", SERVE], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    address = process.stdout.readline().strip()
    robot = Robot(address, timeout=SOON)
    driving = threading.Event()
    robot.subscribe(
        "log", lambda kind, data: driving.set() if "drive(" in data["message"] else None
    )
    end = in_thread(lambda: robot.drive(0.5, 0, 60))
    assert driving.wait(SOON)
    process.kill()
    process.wait()
    assert isinstance(end(), LostConnection)
    replacement = emulated()
    with Server(replacement, port=int(address.rpartition(":")[2])):
        robot.say("I was away.")
    assert [call.method for call in replacement.calls] == ["say"]
    robot.close()


def test_a_server_that_falls_silent_counts_as_lost() -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:

        def greet() -> None:
            connection, _ = silent.accept()
            asked = connection.recv(4096).decode()
            key = asked.partition("Sec-WebSocket-Key: ")[2].partition("\r\n")[0]
            magic = f"{key}258EAFA5-E914-47DA-95CA-C5AB0DC85B11".encode()
            accept = base64.b64encode(hashlib.sha1(magic).digest()).decode()
            connection.sendall(
                "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\n"
                f"Connection: Upgrade\r\nSec-WebSocket-Accept: {accept}\r\n\r\n".encode()
            )
            kept.append(connection)

        kept: list[socket.socket] = []
        in_thread(greet)
        robot = Robot(f"127.0.0.1:{silent.getsockname()[1]}", timeout=1)
        with pytest.raises(LostConnection, match="was lost"):
            robot.goto("pharmacy")
        robot.close()
        kept[0].close()


def test_a_long_call_is_not_taken_for_silence() -> None:
    finish = threading.Event()
    patient = Service(lambda params, context: finish.wait(SOON))
    with Server(emulated(), port=0, services={"desk.wait": patient}) as server:
        robot = Robot(server.address, timeout=0.5)
        end = in_thread(lambda: robot.request("desk.wait"))
        assert not finish.wait(1.2), "longer than the server may be silent"
        finish.set()
        assert end() is True
        robot.close()


# --- events


def test_events_come_to_those_who_listen_and_end_when_they_no_longer_do() -> None:
    driver = emulated()
    with ward(driver) as robot:
        spoken: list[str] = []
        heard_all = threading.Event()

        def note(kind: str, data: dict[str, Any]) -> None:
            spoken.append(data["text"])
            robot.battery()  # a listener may use the robot
            if data["text"] == "two":
                heard_all.set()

        def fail(kind: str, data: dict[str, Any]) -> None:
            raise ValueError("a listener with a fault")

        robot.subscribe("*", fail)
        unsubscribe = robot.subscribe(["speech"], note)
        robot.say("one")
        robot.say("two")
        assert heard_all.wait(SOON)
        unsubscribe()
        unsubscribe()
        robot.say("three")
        assert spoken == ["one", "two"]


def test_an_unknown_event_is_refused() -> None:
    with ward(emulated()) as robot, pytest.raises(InvalidCall, match="did you mean pose"):
        robot.subscribe("poses", lambda kind, data: None)


def test_who_only_listens_hears_on_after_a_restart_of_the_server() -> None:
    driver = emulated()
    with Server(driver, port=0) as first:
        port = int(first.address.rpartition(":")[2])
        robot = Robot(first.address, timeout=SOON)
        heard = threading.Event()
        robot.subscribe("speech", lambda kind, data: heard.set())
    with Server(driver, port=port) as second:
        # Nothing is asked of the robot: the listener's connection comes back by itself.
        for _ in range(500):
            second.publish("speech", {"text": "Is anybody there?"})
            if heard.wait(0.01):
                break
        assert heard.is_set()
        robot.close()
