"""A robot's server on good days and on bad ones, over real sockets."""

import http.client
import json
import os
import queue
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

import pytest
import websocket
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse
from starlette.routing import Route

from robot_api import Context, InvalidCall, Robot, Server, Service
from robot_api.driver import StopFlag
from robot_api.drivers import EmulatedDriver, emulated
from robot_api.errors import InternalError, LostConnection, NotPossible, Stopped
from robot_api.server import CannotListen

SOON = 20  # seconds; what is waited for comes within milliseconds


@pytest.fixture
def driver() -> EmulatedDriver:
    """A robot for which time passes as for us, so that it can be stopped half-way."""
    return emulated(speed=1.0)


@pytest.fixture
def server(driver: EmulatedDriver) -> Iterator[Server]:
    with Server(driver, port=0) as server:
        yield server


@contextmanager
def logged(driver: EmulatedDriver, start: str, times: int = 1) -> Iterator[threading.Event]:
    """An event that is set once the robot has logged so many lines that begin so."""
    seen = threading.Event()
    left = threading.Semaphore(times - 1)

    def listen(kind: str, data: Any) -> None:
        if kind == "log" and data["message"].startswith(start) and not left.acquire(blocking=False):
            seen.set()

    unsubscribe = driver.subscribe(listen)
    yield seen
    unsubscribe()


class Wire:
    """A client that says exactly what a test wants it to say."""

    def __init__(self, address: str, **options: Any) -> None:
        host, _, query = address.partition("?")
        self.socket = websocket.create_connection(
            f"ws://{host}/?{query}", timeout=SOON, skip_utf8_validation=True, **options
        )

    def send(self, method: str, params: Any = None, id: Any = None) -> None:
        message = {"jsonrpc": "2.0", "method": method, "params": params or {}}
        self.socket.send(json.dumps(message if id is None else {**message, "id": id}))

    def receive(self) -> Any:
        return json.loads(self.socket.recv())

    def ask(self, method: str, params: Any = None, id: Any = "ask") -> Any:
        self.send(method, params, id)
        return self.receive()


def get(address: str, path: str, **headers: str) -> tuple[int, str, http.client.HTTPMessage]:
    connection = http.client.HTTPConnection(address, timeout=SOON)
    connection.request("GET", path, headers=headers)
    answer = connection.getresponse()
    return answer.status, answer.read().decode(), answer.headers


def in_thread(do: Callable[[], Any]) -> Callable[[], Any]:
    """Start it; what is returned waits for its end and hands on what it raised."""
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


# --- stop


def test_a_stop_ends_the_calls_of_every_connection(driver: EmulatedDriver, server: Server) -> None:
    with (
        Robot(server.address) as nurse,
        Robot(server.address) as student,
        Robot(server.address) as receptionist,
        logged(driver, "wait(", 2) as waiting,
    ):
        ends = [in_thread(lambda: nurse.wait(60)), in_thread(lambda: student.wait(60))]
        assert waiting.wait(SOON)
        receptionist.stop()
        assert [type(end()) for end in ends] == [Stopped, Stopped]
        student.say("I can go on.")


@pytest.mark.parametrize(
    ("params", "because"),
    [
        ({"who": " Ruth "}, "Ruth stopped the robot."),
        ({"who": "R" * 100}, f"{'R' * 60} stopped the robot."),
        *(({"who": who}, "The robot was stopped.") for who in ("", "  ", 7, None, "a\nb", ["x"])),
        (None, "The robot was stopped."),
    ],
)
def test_whose_call_is_stopped_learns_by_whom(
    driver: EmulatedDriver, server: Server, params: Any, because: str
) -> None:
    with Robot(server.address) as nurse, logged(driver, "wait(", 1) as waiting:
        end = in_thread(lambda: nurse.wait(60))
        assert waiting.wait(SOON)
        wire = Wire(server.address)
        wire.send("robot.stop", params, id="stop")
        assert wire.receive()["id"] == "stop"
        assert str(end()) == because


@pytest.mark.parametrize(
    ("method", "params"),
    [
        ("robot.ask", {"question": "?", "options": ["a"] * 2000}),
        ("robot.ask", {"question": "?", "options": [["a"]] * 2000}),
        ("robot.say", {"text": "a" * 200_000}),
        ("robot.wait", {f"a{i}": i for i in range(2000)}),
    ],
)
def test_too_much_is_refused_before_it_is_looked_at(
    server: Server, method: str, params: Any, monkeypatch: Any
) -> None:
    def looked_at(*_: Any) -> bool:
        raise AssertionError("each item was looked at")

    monkeypatch.setattr("jsonschema.Draft202012Validator.is_valid", looked_at)
    refused = Wire(server.address).ask(method, params, id=1)
    assert refused["error"]["data"]["error"] == "InvalidCall"


def test_a_stop_overtakes_64_calls_that_wait(driver: EmulatedDriver, server: Server) -> None:
    wires = [Wire(server.address) for _ in range(3)]
    with logged(driver, "wait(", 64) as all_at_it:
        for wire in wires:
            for id in range(64):
                wire.send("robot.wait", [60], id)
        assert all_at_it.wait(SOON)
    for wire in wires:
        # What a stop overtakes has come in before it: one more is refused once 64 are there.
        assert "error" in wire.ask("robot.battery", id="one too many")
    wires[0].send("robot.stop", id="stop")
    for wire in wires:
        answers = {answer["id"]: answer for answer in (wire.receive() for _ in range(64))}
        answers.pop("stop", None)
        assert all(a["error"]["data"]["error"] == "Stopped" for a in answers.values())
        assert len(answers) >= 63


def test_a_65th_call_is_refused_and_a_stop_is_not(server: Server) -> None:
    wire = Wire(server.address)
    for id in range(64):
        wire.send("robot.wait", [60], id)
    refused = wire.ask("robot.battery", id="one too many")
    assert refused["error"]["data"]["error"] == "NotPossible"
    wire.send("robot.stop", {"whatever": "it says"}, id="stop")
    answers = [wire.receive()["id"] for _ in range(65)]
    assert "stop" in answers


def test_the_body_is_stopped_after_the_calls_have_been_told(driver: EmulatedDriver) -> None:
    order: list[str] = []

    at_it = threading.Event()

    def call(method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        stop.on_set(lambda: order.append("flag"))
        at_it.set()
        stop.wait(SOON)
        stop.check()

    def stop(because: str) -> None:
        order.append("body")

    driver.call = call  # type: ignore[method-assign]
    driver.stop = stop  # type: ignore[method-assign]
    with Server(driver, port=0) as server, Robot(server.address) as robot:
        end = in_thread(lambda: robot.goto("pharmacy"))
        assert at_it.wait(SOON)
        robot.stop()
        assert isinstance(end(), Stopped)
        assert order == ["flag", "body"]


def test_a_driver_that_cannot_stop_says_so(driver: EmulatedDriver) -> None:
    def stop(because: str) -> None:
        raise OSError("motor bus down")

    driver.stop = stop  # type: ignore[method-assign]
    with Server(driver, port=0) as server, Robot(server.address) as robot:
        with pytest.raises(InternalError, match="may not have stopped"):
            robot.stop()
        assert robot.battery() == 100


# --- connections that end


def test_a_robot_is_left_standing_when_its_connection_dies(
    driver: EmulatedDriver, server: Server
) -> None:
    wire = Wire(server.address)
    with logged(driver, "drive(") as driving, logged(driver, "drive: stopped") as stopped:
        wire.send("robot.drive", [0.5, 0, 60], 1)
        assert driving.wait(SOON)
        wire.socket.sock.close()
        assert stopped.wait(SOON)


def test_another_clients_calls_go_on_when_a_connection_dies(
    driver: EmulatedDriver, server: Server
) -> None:
    with Robot(server.address) as other, logged(driver, "wait(") as waiting:
        end = in_thread(lambda: other.wait(0.6))
        assert waiting.wait(SOON)
        wire = Wire(server.address)
        with logged(driver, "drive(") as driving, logged(driver, "drive: stopped") as stopped:
            wire.send("robot.drive", [0.5, 0, 60], 1)
            assert driving.wait(SOON)
            wire.socket.sock.close()
            assert stopped.wait(SOON)
        assert end() is None


def test_a_connection_that_is_half_open_is_noticed(driver: EmulatedDriver) -> None:
    with Server(driver, port=0, ping_seconds=0.1) as server:
        silent = Wire(server.address)  # it reads nothing, so it answers no ping
        with logged(driver, "drive(") as driving, logged(driver, "drive: stopped") as stopped:
            silent.send("robot.drive", [0.5, 0, 60], 1)
            assert driving.wait(SOON)
            assert stopped.wait(SOON)


def test_a_service_goes_on_when_its_client_leaves(driver: EmulatedDriver) -> None:
    started, finish, ended = threading.Event(), threading.Event(), threading.Event()

    def run(params: dict[str, Any], context: Context) -> None:
        started.set()
        finish.wait(SOON)
        if not context.stop.is_set():
            ended.set()

    with Server(driver, port=0, services={"program.run": Service(run)}) as server:
        wire = Wire(server.address)
        wire.send("program.run", id=1)
        assert started.wait(SOON)
        wire.socket.sock.close()
        with Robot(server.address) as other:
            other.battery()
        finish.set()
        assert ended.wait(SOON)


def test_a_service_for_its_caller_alone_ends_when_they_leave(driver: EmulatedDriver) -> None:
    started, ended = threading.Event(), threading.Event()

    def think(params: dict[str, Any], context: Context) -> None:
        started.set()
        if context.stop.wait(SOON):
            ended.set()

    services = {"program.translate": Service(think, for_caller=True)}
    with Server(driver, port=0, services=services) as server, Robot(server.address) as other:
        wire = Wire(server.address)
        wire.send("program.translate", id=1)
        assert started.wait(SOON)
        wire.socket.sock.close()
        assert ended.wait(SOON)
        assert other.battery() > 0


# --- services and events

GREET = Service(
    lambda params, context: f"Hello {params['name']}",
    params={
        "type": "object",
        "properties": {"name": {"type": "string"}},
        "required": ["name"],
        "additionalProperties": False,
    },
    doc="Greet somebody.",
)


def test_a_service_is_one_more_method(driver: EmulatedDriver) -> None:
    with (
        Server(driver, port=0, services={"desk.greet": GREET}) as server,
        Robot(server.address) as robot,
    ):
        assert robot.request("desk.greet", {"name": "Alice"}) == "Hello Alice"
        assert robot.request("desk.greet", ["Alice"]) == "Hello Alice"
        with pytest.raises(InvalidCall, match=r"name of desk.greet"):
            robot.request("desk.greet", {"name": 5})
        with pytest.raises(InvalidCall, match="required"):
            robot.request("desk.greet")
        with pytest.raises(InvalidCall, match="1 params at most"):
            robot.request("desk.greet", ["Alice", "Bob"])
        with pytest.raises(InvalidCall, match=r"did you mean desk\.greet"):
            robot.request("desk.gret")


@pytest.mark.parametrize("name", ["robot.fly", "rpc.restart", "event.pose"])
def test_a_service_cannot_take_a_name_that_is_not_its_own(
    name: str, driver: EmulatedDriver
) -> None:
    with pytest.raises(ValueError, match=name):
        Server(driver, services={name: GREET})


def test_a_service_can_be_cancelled_and_a_stop_ends_it(driver: EmulatedDriver) -> None:
    started = threading.Semaphore(0)

    def run(params: dict[str, Any], context: Context) -> None:
        started.release()
        context.stop.wait(SOON)
        context.stop.check()

    services = {"program.run": Service(run)}
    with Server(driver, port=0, services=services) as server, Robot(server.address) as robot:
        for end_it in (robot.cancel, robot.stop):
            end = in_thread(lambda: robot.request("program.run"))
            assert started.acquire(timeout=SOON)
            end_it()
            assert isinstance(end(), Stopped)


def test_services_can_use_the_robot_however_many_run(driver: EmulatedDriver) -> None:
    address: list[str] = []

    def run(params: dict[str, Any], context: Context) -> int:
        with Robot(address[0]) as robot:
            return robot.battery()

    with Server(driver, port=0, services={"program.run": Service(run)}) as server:
        address.append(server.address)
        wire = Wire(server.address)
        for id in range(40):
            wire.send("program.run", id=id)
        assert [wire.receive()["result"] for _ in range(40)] == [100] * 40


def test_events_reach_those_who_subscribed(driver: EmulatedDriver) -> None:
    with Server(driver, port=0, events={"program.line": "line"}) as server:
        wire, deaf = Wire(server.address), Wire(server.address)
        wire.ask("rpc.subscribe", {"events": ["speech", "program.line"]})
        wire.send("robot.say", ["Hi"], 1)
        answers = [wire.receive(), wire.receive()]
        assert [answer.get("method") for answer in answers] == ["event.speech", None]
        server.publish("program.line", {"line": 3})
        assert wire.receive() == {
            "jsonrpc": "2.0",
            "method": "event.program.line",
            "params": {"line": 3},
        }
        assert deaf.ask("robot.battery", id=9)["id"] == 9, "it hears no events"


def test_a_thousand_subscriptions_and_ten_clients_at_once(server: Server) -> None:
    def visit(number: int) -> int:
        with Robot(server.address) as robot:
            for _ in range(100):
                robot.request("rpc.subscribe", {"events": ["pose", "speech"]})
            return sum(robot.battery() for _ in range(50))

    ends = [in_thread(lambda number=number: visit(number)) for number in range(10)]
    assert [end() for end in ends] == [5000] * 10


def test_a_slow_subscriber_holds_up_nobody(driver: EmulatedDriver) -> None:
    with Server(driver, port=0, ping_seconds=60) as server:
        slow, quick = Wire(server.address), Wire(server.address)
        for wire in (slow, quick):
            wire.ask("rpc.subscribe", {"events": ["*"]})
        long_text = "x" * 60_000
        for number in range(1000):  # far more than fits into the buffers of a socket
            server.publish("pose", {"x": number, "y": 0, "place": long_text})
            if number % 100 == 0:
                server.publish("speech", {"text": str(number)})
            if number % 20 == 0:
                while quick.receive()["params"].get("x") != number:
                    pass
        server.publish("stopped", {"because": "the end"})
        received = []
        while not received or received[-1]["method"] != "event.stopped":
            received.append(slow.receive())
        spoken = [
            event["params"]["text"] for event in received if event["method"] == "event.speech"
        ]
        poses = [event["params"]["x"] for event in received if event["method"] == "event.pose"]
        assert spoken == [str(number) for number in range(0, 1000, 100)], "nothing said is lost"
        assert len(poses) < 1000
        assert poses == sorted(poses)
        assert poses[-1] == 999, "the newest pose is there"


def test_who_never_reads_replies_is_let_go(driver: EmulatedDriver) -> None:
    page = "x" * 90_000
    big = Service(lambda params, context: page)
    with Server(driver, port=0, services={"big.page": big}) as server:
        greedy = Wire(server.address)
        with pytest.raises((websocket.WebSocketException, OSError)):  # maybe while it still sends
            for id in range(5000):
                greedy.send("big.page", id=id)
            for _ in range(5000):
                greedy.receive()
        with Robot(server.address) as robot:
            assert robot.battery() == 100


# --- nonsense


def test_nonsense_is_answered_and_the_connection_lives(server: Server) -> None:
    wire = Wire(server.address)
    for nonsense in ("{", "[]", "hello", '{"jsonrpc": "2.0", "id": NaN}', "[" * 100_000):
        wire.socket.send(nonsense)
        assert wire.receive()["error"]["data"]["error"] == "InvalidCall"
    wire.socket.send_binary(b"\x00\xff")
    assert wire.receive()["error"]["code"] == -32700
    assert wire.ask("robot.battery")["result"] == 100


@pytest.mark.parametrize("content", [b"\xff\xfe", b"x" * 300_000], ids=["not UTF-8", "too long"])
def test_what_no_frame_may_hold_ends_that_connection_only(
    content: bytes, server: Server, caplog: pytest.LogCaptureFixture
) -> None:
    wire = Wire(server.address)
    try:
        wire.socket.send(content, websocket.ABNF.OPCODE_TEXT)
        opcode, _ = wire.socket.recv_data()
    except OSError:  # it was closed before all had been sent
        opcode = websocket.ABNF.OPCODE_CLOSE
    assert opcode == websocket.ABNF.OPCODE_CLOSE
    with Robot(server.address) as robot:
        assert robot.battery() == 100
    assert not caplog.records, "whoever runs the server would see a traceback"


def test_a_fault_of_the_driver_is_a_sentence_not_a_traceback(driver: EmulatedDriver) -> None:
    def call(method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        raise ZeroDivisionError("wheel radius")

    driver.call = call  # type: ignore[method-assign]
    with Server(driver, port=0) as server, Robot(server.address) as robot:
        with pytest.raises(InternalError) as fault:
            robot.move(1)
        assert "Traceback" not in str(fault.value)
        assert "wheel radius" not in str(fault.value)


def test_an_event_that_cannot_be_sent_disturbs_nobody(server: Server) -> None:
    wire = Wire(server.address)
    wire.ask("rpc.subscribe", {"events": ["*"]})
    server.publish("pose", {"x": object()})
    server.publish("speech", {"text": "Still here."})
    assert wire.receive()["params"] == {"text": "Still here."}


# --- who may


def test_a_web_page_from_the_internet_cannot_reach_the_robot(server: Server) -> None:
    with pytest.raises(websocket.WebSocketBadStatusException) as refused:
        Wire(server.address, origin="https://evil.example")
    assert refused.value.status_code == 403
    with pytest.raises(websocket.WebSocketBadStatusException) as refused:
        Wire(server.address, host="evil.example")
    assert refused.value.status_code == 403
    assert get(server.address, "/", Host="evil.example")[0] == 403
    port = server.address.rpartition(":")[2]
    assert Wire(server.address, host=f"localhost:{port}", origin=f"http://localhost:{port}")


def test_another_host_asks_for_a_token_of_its_own_making(driver: EmulatedDriver) -> None:
    with Server(driver, host="0.0.0.0", port=0) as server:
        assert server.token
        here = server.address.replace("0.0.0.0", "127.0.0.1")
        with pytest.raises(websocket.WebSocketBadStatusException) as refused:
            Wire(here)
        assert refused.value.status_code == 401
        assert get(here, "/")[0] == 401
        assert get(here, f"/?token={server.token}")[0] == 200
        assert get(here, "/healthz")[0] == 200
        with Robot(here, token=server.token) as robot:
            assert robot.battery() == 100
        assert Wire(f"{here}?token={server.token}").ask("robot.battery")["result"] == 100


# --- pages


def test_the_status_page_says_what_there_is_and_asks_for_nothing_elsewhere(
    driver: EmulatedDriver, server: Server
) -> None:
    driver.call("localize", {"place": "pharmacy"}, StopFlag())
    wire = Wire(server.address)
    wire.ask("robot.battery")
    status, page, headers = get(server.address, "/")
    assert status == 200
    assert driver.capabilities().name in page
    assert f'Robot("{server.address}")' in page
    assert "pharmacy" in page
    assert "<dd>1</dd>" in page, "one connection"
    assert "goto" in page
    assert "http://" not in page and "https://" not in page and "//" not in page.split("<body>")[1]
    assert "prefers-color-scheme" in page or "color-scheme: light dark" in page
    assert headers["Content-Security-Policy"].startswith("default-src 'none'")


def test_a_page_of_ones_own_can_take_its_place(driver: EmulatedDriver) -> None:
    with Server(driver, port=0, status_page=lambda status: f"<b>{status.address}</b>") as server:
        assert get(server.address, "/")[1] == f"<b>{server.address}</b>"
        assert get(server.address, "/nothing")[0] == 404


@pytest.fixture
def pages() -> Starlette:
    """An application of ones own."""

    async def floor(request: Request) -> PlainTextResponse:
        return PlainTextResponse(f"The floor, for an {request.scope['state']['guest'].role}")

    return Starlette(routes=[Route("/floor", floor)])


def test_pages_of_ones_own_share_the_port_with_the_wire(
    driver: EmulatedDriver, pages: Starlette
) -> None:
    with Server(driver, port=0, pages=pages) as server:
        assert get(server.address, "/floor")[1] == "The floor, for an administrator"
        assert get(server.address, "/floor", Host="evil.example")[0] == 403
        assert get(server.address, "/floor")[2]["X-Frame-Options"] == "SAMEORIGIN"
        assert Wire(server.address).ask("robot.battery")["result"] == 100


def test_a_token_in_a_link_is_kept_in_a_cookie_and_taken_out_of_the_address(
    driver: EmulatedDriver, pages: Starlette
) -> None:
    with Server(driver, host="0.0.0.0", port=0, pages=pages) as server:
        here = server.address.replace("0.0.0.0", "127.0.0.1")
        assert get(here, "/floor")[0] == 401
        status, _, headers = get(here, f"/floor?token={server.token}&at=2")
        assert (status, headers["Location"]) == (303, "/floor?at=2")
        kept = headers["Set-Cookie"]
        assert "HttpOnly" in kept and "samesite=strict" in kept.lower()
        assert get(here, "/floor", Cookie=kept.partition(";")[0])[0] == 200
        looking = get(here, f"//evil.example?token={server.observer_token}")
        assert looking[2]["Location"] == "/evil.example", "it stays on this server"
        cookie = looking[2]["Set-Cookie"].partition(";")[0]
        assert get(here, "/floor", Cookie=cookie)[1] == "The floor, for an observer"


def test_an_observer_looks_on_and_may_stop_the_robot(driver: EmulatedDriver) -> None:
    services = {
        "ward.look": Service(lambda p, context: context.role, observes=True),
        "ward.change": Service(lambda p, context: context.role),
    }
    with Server(driver, port=0, services=services) as server:
        looks_on = Wire(f"{server.address}?token={server.observer_token}")
        assert looks_on.ask("ward.look")["result"] == "observer"
        assert looks_on.ask("ward.change")["error"]["data"]["error"] == "AccessDenied"
        assert looks_on.ask("robot.move", {"metres": 1})["error"]["data"]["error"] == "AccessDenied"
        assert "result" in looks_on.ask("robot.stop")
        assert Wire(server.address).ask("ward.change")["result"] == "administrator"


def test_who_only_looks_on_takes_nobody_s_room_to_work(
    driver: EmulatedDriver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robot_api.server.MAX_LOOKING", 2)
    monkeypatch.setattr("robot_api.server.MAX_CLIENTS", 4)
    with Server(driver, port=0) as server, ExitStack() as stack:

        def comes(token: str | None) -> Robot:
            return stack.enter_context(Robot(server.address, token=token))

        first, _ = comes(server.observer_token), comes(server.observer_token)
        with pytest.raises(LostConnection, match="no room for another connection"):
            comes(server.observer_token)
        comes(None), comes(None)
        with pytest.raises(LostConnection, match="no room for another connection"):
            comes(None)
        first.close()  # and there is room again
        while len(server.clients) > 3:
            time.sleep(0.01)
        assert comes(None).battery() == 100


def test_who_left_is_told_and_what_is_wanted_known(driver: EmulatedDriver) -> None:
    left: queue.SimpleQueue[str] = queue.SimpleQueue()
    services = {"ward.who": Service(lambda p, context: context.connection)}
    with Server(driver, port=0, services=services, on_left=left.put) as server:
        wire = Wire(server.address)
        name = wire.ask("ward.who")["result"]
        assert not server.wanted("pose")
        wire.ask("rpc.subscribe", {"events": ["pose"]})
        assert server.wanted("pose")
        wire.socket.close()
        assert left.get(timeout=SOON) == name


def test_an_event_for_one_connection_reaches_no_other(driver: EmulatedDriver) -> None:
    def whisper(params: dict[str, Any], context: Context) -> None:
        context.publish("log", {"level": "info", "message": "psst", "time": 0}, context.connection)
        context.publish("log", {"level": "info", "message": "all", "time": 0})

    with Server(driver, port=0, services={"ward.whisper": Service(whisper)}) as server:
        one, other = Wire(server.address), Wire(server.address)
        for wire in (one, other):
            wire.ask("rpc.subscribe", {"events": ["log"]})
        one.send("ward.whisper")
        assert other.receive()["params"]["message"] == "all"
        assert one.receive()["params"]["message"] == "psst"


# --- starting and ending


def test_a_port_in_use_is_said_in_a_sentence(driver: EmulatedDriver, server: Server) -> None:
    port = int(server.address.rpartition(":")[2])
    with pytest.raises(CannotListen, match=f"Port {port} is in use") as refused:
        Server(driver, port=port).start()
    assert "--port" in str(refused.value)


@pytest.mark.parametrize("host", ["no such host.invalid", "203.0.113.1"])
def test_an_address_that_is_not_ours_is_said_in_a_sentence(
    host: str, driver: EmulatedDriver
) -> None:
    with pytest.raises(CannotListen, match="no address of this machine"):
        Server(driver, host=host, port=0).start()


def test_the_robot_stands_when_the_server_ends(driver: EmulatedDriver) -> None:
    with logged(driver, "drive(") as driving, logged(driver, "stopped: The robot's server") as end:
        with Server(driver, port=0) as server:
            Wire(server.address).send("robot.drive", [0.5, 0, 60], 1)
            assert driving.wait(SOON)
        assert end.is_set()
    assert isinstance(driver.calls[-1].error, Stopped)


def test_the_port_is_free_again_when_the_server_has_ended(driver: EmulatedDriver) -> None:
    with Server(driver, port=0) as first, Robot(first.address) as robot:
        robot.battery()
        port = int(first.address.rpartition(":")[2])
    with Server(driver, port=port) as second, Robot(second.address) as robot:
        assert robot.battery() == 100


SERVE = """
from robot_api import Server
from robot_api.drivers import emulated
driver = emulated(speed=1.0)
Server(driver, port=0).serve_forever(lambda server: print(server.address, flush=True))
print(driver.calls[-1].error, flush=True)
"""


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_stops_the_robot_and_leaves_quietly(number: signal.Signals) -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", SERVE], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    wire = Wire(process.stdout.readline().strip())
    wire.ask("rpc.subscribe", {"events": ["log"]})
    wire.send("robot.drive", [0.5, 0, 60], 1)
    while not wire.receive()["params"]["message"].startswith("drive("):
        pass
    os.kill(process.pid, number)
    out, err = process.communicate(timeout=SOON)
    assert out.strip() == "The robot's server was ended."
    assert (process.returncode, err) == (0, "")


def test_no_second_server_shares_the_port_silently(server: Server) -> None:
    host, _, port = server.address.rpartition(":")
    with socket.socket() as intruder, pytest.raises(OSError):
        intruder.bind((host, int(port)))


def test_a_server_reports_what_a_call_may_not_do_now(
    driver: EmulatedDriver, server: Server
) -> None:
    with Robot(server.address) as robot, logged(driver, "drive(") as driving:
        end = in_thread(lambda: robot.drive(0.5, 0, 60))
        assert driving.wait(SOON)
        with pytest.raises(NotPossible, match="already moving"):
            robot.dock()
        robot.stop()
        assert isinstance(end(), Stopped)
