"""Robots in processes of their own, over Zenoh, with links that are cut."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from nl2robot.fleet.trust import Station, trust
from robot_api.errors import InvalidCall
from tests.fleet.wards import NAMES, Ward, known


@pytest.fixture
def ward(tmp_path: Path) -> Iterator[Ward]:
    ward = Ward(tmp_path)
    yield ward
    ward.close()


def states(found: dict[str, Any]) -> list[str]:
    """As far as anything was heard of them."""
    return [each["standing"]["state"] for each in found["members"] if each["standing"]]


def test_a_robot_goes_on_alone_and_is_told_of_as_not_heard_of(ward: Ward) -> None:
    for name in NAMES[:2]:
        ward.starts(name)
    ward.until("Ada", lambda found: known(found) == {"Ada", "Ben"})
    errand = ward.run("Ada", 'robot.goto("ward b")\nrobot.wait(20)\n', robot="Ben")
    ward.until("Ada", lambda found: found["errands"][0]["state"] == "begun")
    ward.until("Ada", lambda found: "running" in states(found))
    ward.links["Ben", "Ada"].cut()
    found = ward.until("Ada", lambda found: known(found) == {"Ada"})
    [ben] = [each for each in found["members"] if each["name"] == "Ben"]
    assert ben["standing"]["state"] == "running" and not ben["known"]
    with ward.robot("Ben") as robot:  # cut off, it does what was approved for it to its end
        assert robot.request("program.wait", {"run": 1})["state"] == "done"
    assert ward.ask("Ada", "list")["errands"][0]["state"] == "begun"
    [_, silent] = sorted(ward.ask("Ada", "stop"), key=lambda told: str(told["name"]))
    assert (silent["name"], silent["answered"], silent["confirmed"]) == ("Ben", False, False)
    ward.links["Ben", "Ada"].mend()
    assert ward.over("Ada", errand)["state"] == "done"


def test_two_of_one_name_are_both_told_and_nothing_is_sent_to_the_name(ward: Ward) -> None:
    ward.starts("Ada")
    ward.starts("Ben")
    ward.until("Ada", lambda found: known(found) == {"Ada", "Ben"})
    told = threading.Event()
    with ward.robot("Ben") as ben:
        sentences: list[dict[str, str]] = []
        ben.subscribe("notice", lambda kind, data: (sentences.append(data["told"]), told.set()))
        ward.starts("another", called="Ben")
        found = ward.until("Ada", lambda found: sum(each["twin"] for each in found["members"]) == 2)
        assert told.wait(ward.soon)
        kept = ben.request("schedule.notices", {})  # for whoever looks later
    assert "anderer Roboter" in sentences[0]["de"]
    assert [each["notice"]["kind"] for each in kept] == ["trouble"]
    with pytest.raises(InvalidCall, match="Several robots are called “Ben”"):
        ward.run("Ada", 'robot.say("Hello.")\n', robot="Ben")
    id = next(each["id"] for each in found["members"] if each["twin"])
    errand = ward.run("Ada", 'robot.say("Hello.")\n', robot=id)
    assert ward.over("Ada", errand)["robot"] == id


def test_who_comes_before_the_one_that_all_meet_at_waits_for_it(ward: Ward) -> None:
    ward.starts("Ben")
    assert known(ward.ask("Ben", "list")) == {"Ben"}
    ward.starts("Ada")
    ward.until("Ben", lambda found: known(found) == {"Ada", "Ben"})


def test_who_has_another_key_is_not_there(ward: Ward) -> None:
    ward.starts("Ada")
    ward.starts("Ben", key="another key of another house, nearby")
    ward.starts("Cleo")
    ward.until("Ada", lambda found: known(found) == {"Ada", "Cleo"})
    assert known(ward.ask("Ben", "list")) == {"Ben"}
    assert {each["name"] for each in ward.ask("Ada", "stop")} == {"Ada", "Cleo"}


def test_all_stand_within_a_second(ward: Ward) -> None:
    for name in NAMES[:3]:
        ward.starts(name)
    ward.until("Ben", lambda found: known(found) == set(NAMES[:3]))
    errand = ward.run("Ben", 'robot.goto("ward b")\nrobot.wait(600)\n', robot="Cleo")
    ward.until("Ben", lambda found: found["errands"][0]["state"] == "begun")
    told = ward.ask("Ben", "stop")
    assert [each["confirmed"] for each in told] == [True] * 3
    assert ward.over("Ben", errand)["state"] == "stopped"


def test_a_robot_takes_only_what_a_station_approved_that_it_trusts(
    ward: Ward, tmp_path: Path
) -> None:
    for name in NAMES[:3]:
        ward.starts(name)
    trust(tmp_path / "Ben", "Ward 3", Station(tmp_path / "Ada").public)
    for name in ("Ada", "Cleo"):
        ward.until(name, lambda found: known(found) == set(NAMES[:3]))
    program = 'robot.say("Hello.")\n'
    refused = ward.run("Cleo", program, robot="Ben")
    ward.until("Cleo", lambda found: "Ben" in found["errands"][0]["refused"])
    [errand] = ward.ask("Cleo", "list")["errands"]
    assert "It does not trust the station" in errand["refused"]["Ben"]
    assert ward.ask("Cleo", "call_off", errand=refused)["state"] == "called_off"
    taken = ward.run("Ada", program, robot="Ben")
    assert ward.over("Ada", taken)["state"] == "done"
    [(where, run)] = ward.runs()
    assert (where, run.approved_by) == ("Ben", "Nurse Kim (fleet, from Ada)")
