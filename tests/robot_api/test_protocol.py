"""JSON-RPC 2.0 without a socket: what a frame asks for and what is answered."""

import json
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robot_api import protocol
from robot_api.errors import Blocked, InvalidCall, RobotError, Stopped
from robot_api.protocol import Action, Call, Cancel, Connection, Event, Reply, Send
from robot_api.schema import read_arguments

METHODS = ("goto", "say", "battery", "stop", "do")


def reader(name: str) -> protocol.Reader:
    def read(params: protocol.Params) -> dict[str, Any]:
        if isinstance(params, list):
            return read_arguments(name, params)
        return read_arguments(name, named=params)

    return read


def connection() -> Connection:
    return Connection({f"robot.{name}": reader(name) for name in METHODS}, ("pose", "speech"))


def ask(method: str, params: Any = None, id: Any = 1) -> str:
    message = {"jsonrpc": "2.0", "id": id, "method": method}
    return json.dumps(message if params is None else {**message, "params": params})


def error_in(actions: list[Action]) -> dict[str, Any]:
    (action,) = actions
    assert isinstance(action, Send)
    reply = json.loads(action.frame)
    assert set(reply) == {"jsonrpc", "id", "error"}
    return {"id": reply["id"], **reply["error"]}


def call_in(actions: list[Action]) -> Call:
    (action,) = actions
    assert isinstance(action, Call)
    return action


def test_a_call_is_read_done_and_answered_under_its_id() -> None:
    wire = connection()
    call = call_in(wire.receive(ask("robot.goto", {"place": "pharmacy"}, id="a")))
    assert (call.method, call.arguments) == ("robot.goto", {"place": "pharmacy"})
    assert set(wire.calls) == {call}
    frame = wire.finish(call, protocol.result_reply(call, None))
    assert json.loads(frame or "") == {"jsonrpc": "2.0", "id": "a", "result": None}
    assert not wire.calls


def test_params_may_come_by_position() -> None:
    call = call_in(connection().receive(ask("robot.goto", [1, 2])))
    assert call.arguments == {"x": 1, "y": 2, "theta": None}


def test_an_error_carries_its_class_and_its_sentence() -> None:
    wire = connection()
    call = call_in(wire.receive(ask("robot.goto", ["lab"], id=7)))
    frame = wire.finish(call, protocol.error_reply(call, Blocked("A bed is in the way.")))
    assert json.loads(frame or "")["error"] == {
        "code": -32005,
        "message": "A bed is in the way.",
        "data": {"error": "Blocked"},
    }


def test_a_notification_is_done_but_never_answered() -> None:
    wire = connection()
    frame = '{"jsonrpc": "2.0", "method": "robot.say", "params": ["Hello"]}'
    call = call_in(wire.receive(frame))
    assert wire.finish(call, protocol.result_reply(call, None)) is None
    assert wire.receive('{"jsonrpc": "2.0", "method": "robot.dance"}') == []


@pytest.mark.parametrize(
    "frame, code, id",
    [
        ("{", -32700, None),
        ("", -32700, None),
        ("nurse!", -32700, None),
        (b"\xff\xfe", -32700, None),
        (b"{}", -32700, None),
        ('{"jsonrpc": "2.0", "id": 1, "method": "robot.say", "params": [NaN]}', -32700, 1),
        ('{"jsonrpc": "2.0", "id": 1, "method": "robot.say", "params": [1e999]}', -32700, 1),
        ('"\ud800"', -32700, None),
        ("[" * 20_000 + "]" * 20_000, -32600, None),
        ('{"a": "' + "x" * protocol.MAX_FRAME + '"}', -32600, None),
        ("[]", -32600, None),
        ("3", -32600, None),
        ('{"id": 1, "method": "robot.battery"}', -32600, 1),
        ('{"jsonrpc": "1.0", "id": 1, "method": "robot.battery"}', -32600, 1),
        ('{"jsonrpc": "2.0", "id": 1, "method": 5}', -32600, 1),
        ('{"jsonrpc": "2.0", "id": 1}', -32600, 1),
        ('{"jsonrpc": "2.0", "id": [1], "method": "robot.battery"}', -32600, None),
        ('{"jsonrpc": "2.0", "id": true, "method": "robot.battery"}', -32600, None),
        ('{"jsonrpc": "2.0", "id": "' + "i" * 201 + '", "method": "robot.battery"}', -32600, None),
        ('{"jsonrpc": "2.0", "id": 1, "method": "robot.say", "params": "Hello"}', -32600, 1),
        ('{"jsonrpc": "2.0", "id": 1, "method": "robot.say", "params": null}', -32600, 1),
        ('{"jsonrpc": "2.0", "id": 1, "method": "robot.gotoo"}', -32601, 1),
        ('{"jsonrpc": "2.0", "id": 1, "method": "' + "goto" * 9999 + '"}', -32601, 1),
        ('{"jsonrpc": "2.0", "id": 1, "method": "robot.say"}', -32602, 1),
        ('{"jsonrpc": "2.0", "id": 1, "method": "rpc.cancel"}', -32602, 1),
        ('{"jsonrpc": "2.0", "id": 1, "method": "rpc.subscribe", "params": [5]}', -32602, 1),
        ('{"jsonrpc": "2.0", "id": 1, "method": "rpc.subscribe", "params": [["po"]]}', -32602, 1),
    ],
)
def test_a_broken_message_is_answered_with_the_standard_code(
    frame: str | bytes, code: int, id: Any
) -> None:
    wire = connection()
    error = error_in(wire.receive(frame))
    assert (error["code"], error["id"]) == (code, id)
    assert error["data"] == {"error": "InvalidCall"}
    assert error["message"].endswith((".", "?"))
    assert len(error["message"]) < 300
    assert not wire.calls


def test_a_misspelt_method_is_refused_with_the_nearest_name() -> None:
    error = error_in(connection().receive(ask("robot.gotoo", {})))
    assert error["message"] == "There is no method 'robot.gotoo'; did you mean robot.goto?"


def test_nesting_that_is_only_text_is_not_nesting() -> None:
    brackets = '"[[' * 100
    call = call_in(connection().receive(ask("robot.say", {"text": brackets})))
    assert call.arguments["text"] == brackets


def test_an_id_that_is_in_flight_cannot_be_used_again() -> None:
    wire = connection()
    first = call_in(wire.receive(ask("robot.goto", ["lab"], id=1)))
    error = error_in(wire.receive(ask("robot.battery", id=1.0)))
    assert error["id"] is None, "the client would take it for the answer of the first call"
    wire.finish(first, protocol.result_reply(first, None))
    assert call_in(wire.receive(ask("robot.battery", id=1)))


def test_a_call_in_flight_is_cancelled_by_its_id() -> None:
    wire = connection()
    call = call_in(wire.receive(ask("robot.goto", ["lab"], id="drive")))
    cancel, answer = wire.receive(ask("rpc.cancel", {"id": "drive"}, id=2))
    assert cancel == Cancel(call)
    assert isinstance(answer, Send)
    assert json.loads(answer.frame)["result"] is True
    wire.finish(call, protocol.error_reply(call, Stopped()))
    (answer,) = wire.receive(ask("rpc.cancel", ["drive"], id=3))
    assert isinstance(answer, Send)
    assert json.loads(answer.frame)["result"] is False


def test_only_what_was_subscribed_to_is_wanted() -> None:
    wire = connection()
    assert not wire.wants("pose")
    wire.receive(ask("rpc.subscribe", {"events": ["pose"]}))
    assert wire.wants("pose")
    assert not wire.wants("speech")
    wire.receive(ask("rpc.subscribe", {"events": ["*"]}))
    assert wire.wants("speech")
    (answer,) = wire.receive(ask("rpc.unsubscribe", {"events": ["*", "pose"]}))
    assert isinstance(answer, Send)
    assert json.loads(answer.frame)["result"] == []
    assert not wire.wants("pose")


def test_a_thousand_subscriptions_are_one() -> None:
    wire = connection()
    for id in range(1000):
        (answer,) = wire.receive(ask("rpc.subscribe", {"events": ["pose"] * 100}, id=id))
        assert isinstance(answer, Send)
        assert json.loads(answer.frame)["result"] == ["pose"]


def test_the_65th_call_in_flight_is_refused_but_never_a_stop() -> None:
    wire = connection()
    for id in range(protocol.MAX_CALLS):
        call_in(wire.receive(ask("robot.goto", ["lab"], id=id)))
    error = error_in(wire.receive(ask("robot.battery", id=64)))
    assert error["data"] == {"error": "NotPossible"}
    assert call_in(wire.receive(ask("robot.stop", id=64))).method == "robot.stop"
    assert call_in(wire.receive(ask("robot.stop", id=3))).method == "robot.stop"
    assert len(wire.calls) == protocol.MAX_CALLS


def test_a_batch_is_answered_as_one_when_its_last_call_has_ended() -> None:
    wire = connection()
    batch = [
        {"jsonrpc": "2.0", "id": 1, "method": "robot.say", "params": ["Hello"]},
        {"jsonrpc": "2.0", "method": "robot.say", "params": ["Nobody waits for this."]},
        {"jsonrpc": "2.0", "id": 2, "method": "robot.battery"},
        {"jsonrpc": "2.0", "id": 3, "method": "robot.gotoo"},
        {"jsonrpc": "2.0", "id": 4, "method": "rpc.subscribe", "params": {"events": ["pose"]}},
        17,
    ]
    say, quiet, battery = wire.receive(json.dumps(batch))
    assert isinstance(say, Call)
    assert isinstance(quiet, Call)
    assert isinstance(battery, Call)
    assert wire.finish(battery, protocol.result_reply(battery, 80)) is None
    assert wire.finish(quiet, protocol.result_reply(quiet, None)) is None
    answers = json.loads(wire.finish(say, protocol.result_reply(say, None)) or "")
    assert {answer["id"]: answer.get("result") for answer in answers} == {
        1: None,
        2: 80,
        3: None,
        4: ["pose"],
        None: None,
    }


def test_a_batch_of_mistakes_is_answered_at_once_and_one_of_notifications_never() -> None:
    (answer,) = connection().receive("[1, 2, 3]")
    assert isinstance(answer, Send)
    assert [reply["error"]["code"] for reply in json.loads(answer.frame)] == [-32600] * 3
    quiet = (
        '[{"jsonrpc": "2.0", "method": "robot.gotoo"}, {"jsonrpc": "2.0", "method": "rpc.cancel"}]'
    )
    assert connection().receive(quiet) == []


def test_a_batch_longer_than_the_calls_in_flight_is_refused() -> None:
    too_long = json.dumps([json.loads(ask("robot.battery", id=id)) for id in range(65)])
    assert error_in(connection().receive(too_long))["code"] == -32600


@pytest.mark.parametrize("result", ["\ud800", object(), {1: object()}])
def test_a_result_that_cannot_be_sent_is_the_robots_fault(result: object) -> None:
    wire = connection()
    call = call_in(wire.receive(ask("robot.battery")))
    reply = json.loads(protocol.result_reply(call, result))
    assert reply["error"]["data"] == {"error": "InternalError"}


# --- the client's side


@pytest.mark.parametrize("kind", [Blocked, Stopped, InvalidCall, RobotError])
def test_an_error_comes_back_as_the_class_that_was_sent(kind: type[RobotError]) -> None:
    call = Call("robot.goto", {}, 5, True, None)
    reply = protocol.read_message(protocol.error_reply(call, kind("It did not work.")))
    assert isinstance(reply, Reply)
    assert reply.id == 5
    assert type(reply.error) is kind
    assert str(reply.error) == "It did not work."


def test_an_error_of_a_newer_server_is_still_a_robot_error() -> None:
    frame = '{"id": 5, "error": {"code": -1, "message": "Odd.", "data": {"error": "OutOfPaint"}}}'
    reply = protocol.read_message(frame)
    assert isinstance(reply, Reply)
    assert type(reply.error) is RobotError


def test_an_event_comes_back_as_it_was_sent() -> None:
    frame = protocol.event_frame("program.line", {"line": 3})
    assert protocol.read_message(frame) == Event("program.line", {"line": 3})


@pytest.mark.parametrize("params", [{"text": object()}, ["\ud800"], {"html": "x" * 300_000}])
def test_what_cannot_be_sent_is_refused_at_the_client(params: Any) -> None:
    with pytest.raises(InvalidCall):
        protocol.request(1, "robot.show", params)


# --- any text at all

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner),
    max_leaves=8,
)
NAMES = st.sampled_from([*(f"robot.{name}" for name in METHODS), *protocol.OWN_METHODS, "x"])
MESSAGE = st.fixed_dictionaries(
    {},
    optional={
        "jsonrpc": st.sampled_from(["2.0", "2.0", "2.0", "1.0", 2]),
        "id": st.integers(0, 3) | JSON,
        "method": NAMES | JSON,
        "params": st.sampled_from([["lab"], {"text": "Hi"}, {"events": ["*"]}, {"id": 1}]) | JSON,
    },
)
FRAME = (
    st.text(max_size=30)
    | st.binary(max_size=10)
    | (MESSAGE | st.lists(MESSAGE | JSON, max_size=5) | JSON).map(json.dumps)
)


def assert_valid_reply(reply: Any) -> None:
    assert reply["jsonrpc"] == "2.0"
    assert set(reply) in ({"jsonrpc", "id", "result"}, {"jsonrpc", "id", "error"})
    if "error" in reply:
        assert isinstance(reply["error"]["code"], int)
        assert reply["error"]["message"]


@given(st.lists(FRAME, max_size=6))
@settings(max_examples=400, deadline=None)
def test_any_text_gets_nothing_or_a_valid_answer_and_each_call_ends(
    frames: list[str | bytes],
) -> None:
    wire = connection()
    sent: list[str] = []
    calls: list[Call] = []
    for frame in frames:
        for action in wire.receive(frame):
            if isinstance(action, Send):
                sent.append(action.frame)
            elif isinstance(action, Call):
                calls.append(action)
    sent += filter(None, [wire.finish(call, protocol.result_reply(call, None)) for call in calls])
    for frame in sent:
        content = json.loads(frame)
        for reply in content if isinstance(content, list) else [content]:
            assert_valid_reply(reply)
    assert not wire.calls


@given(FRAME)
@settings(max_examples=200, deadline=None)
def test_a_client_survives_any_text_from_a_server(frame: str | bytes) -> None:
    if isinstance(frame, str):
        protocol.read_message(frame)
