"""The robot at the broker of the house, which comes and goes."""

from __future__ import annotations

import threading
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nl2robot.building.broker import BadBroker, BrokerAddress, parse_broker
from nl2robot.schedule.topics import is_topic
from tests.building.conftest import SOON


def test_a_nurse_call_reaches_the_robot(house: Any, join: Any) -> None:
    port = house().port
    robot, hospital = join(port, "robot"), join(port, "hospital")
    assert robot.is_told() == hospital.is_told() == (True, "")
    robot.broker.listen("ward-3/call/+")
    hospital.broker.listen("ward/robot/heard")
    robot.broker.listen("ward/robot/heard")
    robot.broker.publish("ward/robot/heard", "listening", kept=True)  # whoever listens first
    assert robot.hears() == hospital.hears() == ("ward/robot/heard", "listening")
    hospital.broker.publish("ward-3/call/12", "pressed")
    hospital.broker.publish("elsewhere", "pressed")
    hospital.broker.publish("ward-3/call/13", "pressed")
    assert [robot.hears(), robot.hears()] == [
        ("ward-3/call/12", "pressed"),
        ("ward-3/call/13", "pressed"),
    ]


def test_who_comes_later_knows_whether_the_robot_is_there(house: Any, join: Any) -> None:
    port = house().port
    robot = join(port, "robot")
    assert robot.is_told() == (True, "")
    late = join(port, "late")
    late.broker.listen("ward/robot/available")
    assert late.hears() == ("ward/robot/available", "online")
    robot.broker.close()
    assert late.hears() == ("ward/robot/available", "offline")


def test_a_broker_that_is_away_is_told_of_once_and_found_again(house: Any, join: Any) -> None:
    broker = house()
    robot = join(broker.port, "robot")
    assert robot.is_told() == (True, "")
    robot.broker.listen("ward-3/call")
    broker.goes()
    lost, because = robot.is_told()
    assert not lost
    assert "cannot be reached" in because and str(broker.port) in because
    robot.broker.publish("ward/robot/notice", "kept until it is back")
    broker.comes()
    while robot.is_told() != (True, ""):
        pass
    hospital = join(broker.port, "hospital")
    assert hospital.is_told() == (True, "")
    hospital.broker.publish("ward-3/call", "pressed")
    assert robot.hears() == ("ward-3/call", "pressed")


def test_a_wrong_password_is_said_to_be_one(house: Any, join: Any) -> None:
    port = house({"robot": "a word of ours"}).port
    wrong = join(port, "robot", user="robot", password="another word")
    refused, because = wrong.is_told()
    assert not refused
    assert "refuses this server (Not authorized)" in because and "login" in because
    assert join(port, "robot-2", user="robot", password="a word of ours").is_told() == (True, "")


def test_a_wrong_password_is_told_once_however_often_it_is_tried(house: Any, join: Any) -> None:
    broker = house({"robot": "a word of ours"})
    wrong = join(broker.port, "robot", user="robot", password="another word")
    assert "refuses" in wrong.is_told()[1]
    refused = threading.Event()
    client = wrong.broker._client
    told = client.on_disconnect

    def again(*what: Any) -> None:
        told(*what)
        refused.set()

    client.on_disconnect = again
    assert refused.wait(SOON), "it is not tried again"
    assert wrong.links.empty()


def test_a_connection_that_the_broker_gives_up_late_does_not_take_the_robot_away(
    house: Any, join: Any
) -> None:
    port = house().port
    robot, late = join(port, "robot"), join(port, "late")
    assert robot.is_told() == late.is_told() == (True, "")
    late.broker.listen("ward/robot/available")
    assert late.hears() == ("ward/robot/available", "online")
    late.broker.publish("ward/robot/available", "offline", kept=True)
    assert [late.hears(), late.hears()] == [
        ("ward/robot/available", "offline"),
        ("ward/robot/available", "online"),
    ]


def test_what_is_no_text_or_far_too_long_is_not_heard(house: Any, join: Any) -> None:
    port = house().port
    robot, hospital = join(port, "robot"), join(port, "hospital")
    assert robot.is_told() == hospital.is_told() == (True, "")
    robot.broker.listen("call")
    robot.broker.publish("call", "I listen")
    assert robot.hears() == ("call", "I listen")
    hospital.broker._client.publish("call", b"\xff\xfe", qos=1)
    hospital.broker.publish("call", "x" * 70_000)
    hospital.broker.publish("call", "at last a word")
    assert robot.hears() == ("call", "at last a word")


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("broker", BrokerAddress("broker", 1883)),
        ("mqtt:1884/ward-a", BrokerAddress("mqtt", 1884, prefix="ward-a")),
        ("mqtt://broker:1884/ward-a", BrokerAddress("broker", 1884, prefix="ward-a")),
        (
            "mqtts://robot@broker.example/house/robots/1",
            BrokerAddress("broker.example", 8883, True, "robot", "house/robots/1"),
        ),
    ],
)
def test_addresses(text: str, address: BrokerAddress) -> None:
    assert parse_broker(text) == address


@pytest.mark.parametrize(
    ("text", "because"),
    [
        ("", "is no address"),
        ("mqtt://", "is no address"),
        ("mqtt://b/a?b", "is no address"),
        ("mqtt://[b", "is no address"),
        ("mqtt://b/" + "x" * 195, "is no address"),
        ("http://broker", "does not begin with mqtt://"),
        ("//broker", "does not begin with mqtt://"),
        ("mqtt:broker/ward-a", "does not begin with mqtt://"),
        ("mqtts:/broker/ward-a", "does not begin with mqtt://"),
        ("mqtt://b:x", "port in 'mqtt://b:x' is no number from 1 to 65535"),
        ("mqtt://b:0", "no number from 1"),
        ("mqtt://b:65536/ward-a", "no number from 1"),
        ("mqtt://b/#", "'#' has a wildcard"),
        ("mqtt://b/house/+/robot", "'house/[+]/robot' has a wildcard"),
    ],
)
def test_what_is_no_address_is_told_why(text: str, because: str) -> None:
    with pytest.raises(BadBroker, match=f"{because}.*Write it as mqtt://HOST"):
        parse_broker(text)


def test_a_password_has_no_place_in_an_address() -> None:
    with pytest.raises(BadBroker, match="NL2ROBOT_MQTT_PASSWORD"):
        parse_broker("mqtt://robot:secret@broker")


@given(st.text(max_size=300))
def test_no_address_is_a_fault(text: str) -> None:
    try:
        address = parse_broker(text)
    except BadBroker:
        return
    assert is_topic(address.topic("available"))


@pytest.mark.parametrize("topic", ["a", "ward/+/call", "ward/#", "#", "+"])
def test_where_one_can_listen(topic: str) -> None:
    assert is_topic(topic, wildcards=True)


@pytest.mark.parametrize("topic", ["", "a/#/b", "a+/b", "$SYS/x", "a\0", "x" * 201])
def test_where_one_cannot(topic: str) -> None:
    assert not is_topic(topic, wildcards=True)
