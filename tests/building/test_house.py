"""What a house says to its robot begins what somebody approved for it, and nothing else."""

from __future__ import annotations

import json
import queue
import socket
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest

from nl2robot.building.broker import PASSWORD, BrokerAddress
from nl2robot.cli import main as cli
from nl2robot.errors import ExitStatus
from nl2robot.review.review import digest
from nl2robot.run.runlog import RunLog
from nl2robot.schedule.service import Timing
from nl2robot.station.station import simulated_station
from robot_api.client import Robot
from robot_api.errors import InvalidCall
from sim.world.loading import load_world
from tests.building.conftest import SOON
from tests.nl2robot.conftest import Command

GREETING = 'robot.say("I am coming.")\n'


@contextmanager
def living_in(port: int, folder: Path) -> Iterator[Robot]:
    log = RunLog(folder / "runs.sqlite")
    address = BrokerAddress("127.0.0.1", port, prefix="ward-a")
    station = simulated_station(load_world("ward"), log, timing=Timing(every=0.05), broker=address)
    with station as there, there.connect() as robot:
        yield robot
    log.close()


def test_a_nurse_call_begins_what_was_approved_for_it(
    house: Any, join: Any, tmp_path: Path
) -> None:
    port = house().port
    nurse = join(port, "nurse")
    assert nurse.is_told() == (True, "")
    nurse.broker.listen("ward-a/#")
    with living_in(port, tmp_path) as robot:
        ended: queue.Queue[Any] = queue.Queue()
        robot.subscribe(("program",), lambda kind, data: ended.put(data))
        given = {
            "program": GREETING,
            "sha256": digest(GREETING),
            "by": "Nurse Kim",
            "sentence": "say that you are coming",
            "trigger": {"what": "message", "topic": "calls/+", "text": "pressed"},
        }
        robot.request("schedule.add", given)
        # Until the robot listens: it is begun once a minute at most, however often they press.
        run = None
        for attempt in range(200):
            nurse.broker.publish(f"calls/{attempt}", "pressed")
            try:
                run = ended.get(timeout=0.1)
                break
            except queue.Empty:
                continue
        assert run is not None
        while run["what"] != "state" or run["state"] != "done":
            run = ended.get(timeout=SOON)
        [begun] = robot.request("schedule.history", {})
        assert begun["occurrence"]["state"] in ("running", "done")
        states = set()
        while "running" not in states:
            topic, text = nurse.hears()
            if topic == "ward-a/state":
                states.add(json.loads(text)["state"])


def test_the_house_hears_how_it_stands_and_what_was_not_done(
    house: Any, join: Any, tmp_path: Path
) -> None:
    """Whoever looks at the house's own system, not at the robot."""
    port = house().port
    failing = 'robot.goto("ward a")\nrobot.grab("piano")\n'
    with living_in(port, tmp_path) as robot:
        nurse = join(port, "nurse")
        assert nurse.is_told() == (True, "")
        nurse.broker.listen("ward-a/+")
        nurse.broker.listen("homeassistant/device/ward-a/config")
        kept = {f"ward-a/{each}" for each in ("available", "state", "battery", "place")}
        heard: dict[str, str] = {}
        while not kept | {"homeassistant/device/ward-a/config"} <= heard.keys():
            heard |= dict([nurse.hears()])
        assert json.loads(heard["ward-a/battery"])["percent"] > 0
        assert heard["ward-a/place"] == "charger"
        assert json.loads(heard["homeassistant/device/ward-a/config"])["device"]["name"] == "ward-a"
        assert heard["ward-a/available"] == "online"
        assert json.loads(heard["ward-a/state"])["state"] in ("idle", "charging")
        given = {
            "program": failing,
            "sha256": digest(failing),
            "by": "Nurse Kim",
            "sentence": "bring the piano",
            "insists": True,
            "trigger": {"what": "pressed", "text": "Piano"},
        }
        robot.request("schedule.add", given)
        while robot.request("schedule.buttons", {}) != ["Piano"]:
            pass
        robot.request("schedule.press", {"button": "Piano"})
        topic, text = nurse.hears()
        while topic != "ward-a/notice":
            topic, text = nurse.hears()
        assert "bring the piano" in json.loads(text)["told"]["de"]


def test_what_was_said_before_the_robot_came_is_over(house: Any, join: Any, tmp_path: Path) -> None:
    port = house().port
    nurse = join(port, "nurse")
    assert nurse.is_told() == (True, "")
    nurse.broker.publish("ward-a/stop", "stop", kept=True)
    nurse.broker.listen("ward-a/#")
    assert nurse.hears() == ("ward-a/stop", "stop")
    with living_in(port, tmp_path):
        topic, text = nurse.hears()
        while topic != "ward-a/state":
            topic, text = nurse.hears()
        nurse.broker.publish("ward-a/stop", "now")
        states = [json.loads(text)["because"]]
        while states[-1] is None:
            topic, text = nurse.hears()
            if topic == "ward-a/state":
                states.append(json.loads(text)["because"])
    assert states[-1] == "A system of the house has stopped it."


def test_a_message_can_stop_the_robot_and_begin_nothing_of_itself(
    house: Any, join: Any, tmp_path: Path
) -> None:
    port = house().port
    nurse = join(port, "nurse")
    assert nurse.is_told() == (True, "")
    nurse.broker.listen("ward-a/state")
    with living_in(port, tmp_path) as robot:
        nurse.hears()  # it has joined, and listens
        nurse.broker.publish("ward-a/program", GREETING)
        nurse.broker.publish("ward-a/stop", "")
        while json.loads(nurse.hears()[1])["state"] != "stopped":
            pass
        assert robot.request("program.list", {}) == []


@pytest.mark.parametrize("topic", ["ward-a", "ward-a/state", "ward-a/stop", "ward-a/#"])
def test_what_it_says_itself_cannot_begin_what_it_does(
    topic: str, house: Any, tmp_path: Path
) -> None:
    with living_in(house().port, tmp_path) as robot:
        trigger = {"what": "message", "topic": topic}
        with pytest.raises(InvalidCall, match="does not begin with ward-a"):
            robot.request("schedule.event", {"trigger": trigger})
        for others in ("ward-ab/state", "+/state", "#"):
            robot.request("schedule.event", {"trigger": {**trigger, "topic": others}})


@pytest.mark.parametrize("address", ["http://broker", "mqtt://robot:secret@broker"])
def test_serve_says_what_is_wrong_with_an_address(
    address: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert cli.main(["serve", "--port", "0", "--mqtt", address]) == ExitStatus.BAD_INPUT
    assert "mqtt://HOST" in (said := capsys.readouterr().err) or "NL2ROBOT_MQTT_PASSWORD" in said


def test_serve_tells_at_its_terminal_that_the_broker_refuses_the_password(
    house: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path / "home"))
    monkeypatch.setenv(PASSWORD, "another word")
    port = house({"robot": "a word of ours"}).port
    address = f"mqtt://robot@127.0.0.1:{port}/ward-a"
    typed = ("serve", "--world", "ward", "--port", "0", "--mqtt", address)
    with closing(Command(typed, False, None, "false")) as server:
        server.until("refuses this server (Not authorized)")


def test_a_broker_that_is_away_is_told_of_as_any_other_notice(tmp_path: Path) -> None:
    """With a number, for those who look later and to tell one from the next."""
    with socket.socket() as nobody:
        nobody.bind(("127.0.0.1", 0))
        port = nobody.getsockname()[1]
    with living_in(port, tmp_path) as robot:
        found: list[Any] = []
        while not found:
            found = robot.request("schedule.notices", {"language": "de"})
    [told] = found
    about = told["notice"]
    assert (about["id"], about["kind"], about["appointment"]) == (1, "trouble", 0)
    assert f"127.0.0.1:{port}" in about["parts"]["sentence"]
    assert "nicht zu erreichen" in told["told"] or "nicht erreichbar" in told["told"], told["told"]
