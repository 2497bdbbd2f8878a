"""What a system of the house hears of the robot, and finds of it."""

from __future__ import annotations

import json
import queue
from collections.abc import Callable
from typing import Any

import pytest

from nl2robot.building.broker import BrokerAddress
from nl2robot.building.joining import House
from nl2robot.building.reporter import STATES, Reporter
from nl2robot.run.state import FOLLOWS
from robot_api.errors import StopNotConfirmed
from tests.building.conftest import SOON

ADDRESS = BrokerAddress("broker", 1883, prefix="house/robots/ward a")


class Ward:
    """A reporter, with what it said and whom it stopped."""

    def __init__(self) -> None:
        self.said: dict[str, tuple[str, bool]] = {}
        self.stops: list[str] = []
        self.reporter = Reporter(ADDRESS, "Robi", "1.0", self._publish, self.stops.append)

    def _publish(self, topic: str, text: str, *, kept: bool = False) -> None:
        self.said[topic] = (text, kept)


@pytest.fixture
def ward() -> Ward:
    return Ward()


def test_who_comes_later_hears_how_the_robot_stands(ward: Ward) -> None:
    ward.reporter.on_event("state", {"state": "running", "run": 7})
    text, kept = ward.said["house/robots/ward a/state"]
    assert kept
    assert json.loads(text) == {"state": "running", "run": 7}


def test_a_place_is_told_when_it_changes_and_not_ten_times_a_second(ward: Ward) -> None:
    told = []
    for place in ("lobby", "lobby", None, None, "pharmacy"):
        ward.said.clear()
        ward.reporter.on_event("pose", {"x": 1.0, "place": place})
        told.append(ward.said.get("house/robots/ward a/place"))
    assert told == [("lobby", True), None, ("", True), None, ("pharmacy", True)]


def test_what_the_robot_says_and_hears_stays_in_the_room(ward: Ward) -> None:
    for kind in ("speech", "heard", "program", "log", "screen", "sound"):
        ward.reporter.on_event(kind, {"text": "Frau Keller has a fever."})
    assert not ward.said


@pytest.mark.parametrize("text", ["stop", "", "go on"])
def test_whatever_is_said_at_stop_stops_it(ward: Ward, text: str) -> None:
    ward.reporter.heard("house/robots/ward a/stop", text)
    assert ward.stops == ["A system of the house has stopped it."]


def test_home_assistant_finds_it_again_when_it_begins_anew(ward: Ward) -> None:
    ward.reporter.heard("homeassistant/status", "online")
    text, kept = ward.said["homeassistant/device/house_robots_ward_a/config"]
    assert kept
    found = json.loads(text)
    assert found["device"]["name"] == "Robi"
    assert found["availability_topic"] == "house/robots/ward a/available"
    entities = found["components"].values()
    assert {each["platform"] for each in entities} == {"sensor", "event", "button"}
    assert len({each["unique_id"] for each in entities}) == len(entities)


def test_what_a_neighbour_says_is_not_its_own(ward: Ward) -> None:
    assert ward.reporter.is_own("house/robots/ward a/state")
    assert ward.reporter.is_own("homeassistant/device/house_robots_ward_a/config")
    for topic in ("house/robots/ward a2/state", "house/robots", "#", "house/+/+/state"):
        assert not ward.reporter.is_own(topic)


def test_it_is_said_to_be_in_no_state_that_home_assistant_does_not_know() -> None:
    assert set(STATES) == set(FOLLOWS)


def until(listener: Any, topic: str, text: str | None = None) -> str:
    """Until that is said there, or anything."""
    while True:
        said_at, said = listener.hears()
        if said_at == topic and text in (None, said):
            return str(said)


class Stage:
    """A station whose robot does not say that it stands."""

    def __init__(self) -> None:
        self.listeners: list[Callable[[str, Any], None]] = []
        self.stops: list[str] = []
        self.notices: queue.Queue[str] = queue.Queue()

    def publish(self, kind: str, data: Any) -> None:
        for listener in self.listeners:
            listener(kind, data)
        self.notices.put(data["told"]["en"])

    def stop(self, because: str) -> None:
        self.stops.append(because)
        for listener in self.listeners:
            listener("state", {"state": "stopping", "because": because})
        raise StopNotConfirmed("It may still be moving.")

    def subscribe(self, listener: Callable[[str, Any], None]) -> Callable[[], None]:
        self.listeners.append(listener)
        return lambda: self.listeners.remove(listener)


def test_a_button_of_the_house_stops_the_robot(house: Any, join: Any) -> None:
    port, stage = house().port, Stage()
    nurse = join(port, "nurse")
    assert nurse.is_told() == (True, "")
    nurse.broker.listen("ward-a/#")
    with House(BrokerAddress("127.0.0.1", port, prefix="ward-a"), "Robi", stage) as joined:
        assert nurse.hears() == ("ward-a/available", "online")
        joined.broker.listen("ward-a/stop")  # once more, which changes nothing
        nurse.broker.publish("ward-a/stop", "please")
        until(nurse, "ward-a/stop", "please")
        assert json.loads(until(nurse, "ward-a/state"))["state"] == "stopping"
    assert nurse.hears() == ("ward-a/available", "offline")
    assert stage.stops and not stage.listeners


def test_stop_goes_on_when_nobody_else_listens_there_any_more(house: Any, join: Any) -> None:
    """An appointment once listened at the robot's own stop, and was removed."""
    broker, stage = house(), Stage()
    nurse = join(broker.port, "nurse")
    assert nurse.is_told() == (True, "")
    nurse.broker.listen("ward-a/+")
    address = BrokerAddress("127.0.0.1", broker.port, prefix="ward-a")
    with House(address, "Robi", stage) as joined:
        joined.listen_to(frozenset({"ward-a/stop", "ward-a/#", "call"}))
        joined.listen_to(frozenset())
        until(nurse, "ward-a/available", "online")
        nurse.broker.publish("ward-a/stop", "please")
        until(nurse, "ward-a/state")
        broker.goes()
        broker.comes()
        until(nurse, "ward-a/available", "online")
        nurse.broker.publish("ward-a/stop", "once more")
        until(nurse, "ward-a/stop", "once more")
        until(nurse, "ward-a/state")
    assert len(stage.stops) == 2


def test_what_the_robot_says_itself_is_no_message_to_it(house: Any, join: Any) -> None:
    port, stage = house().port, Stage()
    heard: queue.Queue[tuple[str, str]] = queue.Queue()
    nurse = join(port, "nurse")
    assert nurse.is_told() == (True, "")
    nurse.broker.listen("ward-a/available")
    with House(
        BrokerAddress("127.0.0.1", port, prefix="ward-a"),
        "Robi",
        stage,
        lambda topic, text: heard.put((topic, text)),
    ) as joined:
        until(nurse, "ward-a/available", "online")
        joined.listen_to(frozenset({"#"}))
        stage.listeners[0]("state", {"state": "running"})
        joined.broker.publish("mine/first", "heard")  # in this order, by the same connection
        stage.listeners[0]("state", {"state": "idle"})
        joined.broker.publish("mine/last", "heard")
        said = [heard.get(timeout=SOON)]
        while said[-1] != ("mine/last", "heard"):
            said.append(heard.get(timeout=SOON))
    assert {topic.partition("/")[0] for topic, _ in said} <= {"mine", "ward"}


def test_two_servers_with_one_prefix_stay_and_say_so_once(house: Any, join: Any) -> None:
    port, first, second = house().port, Stage(), Stage()
    address = BrokerAddress("127.0.0.1", port, prefix="ward-a")
    nurse = join(port, "nurse")
    assert nurse.is_told() == (True, "")
    nurse.broker.listen("ward-a/#")
    with House(address, "Robi", first) as one:
        until(nurse, "ward-a/available", "online")
        with House(address, "Robi", second) as other:
            for stage in (first, second):
                assert "Another server goes by ward-a" in stage.notices.get(timeout=SOON)
            assert one.broker.connected and other.broker.connected
        until(nurse, "ward-a/available", "offline")
        until(nurse, "ward-a/available", "online")  # for one is still there
    until(nurse, "ward-a/available", "offline")
    with House(address, "Robi", third := Stage()):
        until(nurse, "ward-a/available", "online")
    assert first.notices.empty() and second.notices.empty() and third.notices.empty()


def test_a_wrong_password_is_told_to_the_people_here(house: Any) -> None:
    port, stage = house({"robot": "a word of ours"}).port, Stage()
    with House(BrokerAddress("127.0.0.1", port, user="robot"), "Robi", stage):
        assert "refuses this server" in stage.notices.get(timeout=SOON)
