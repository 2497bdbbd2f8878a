"""Two robots over a network, a clock that is set by hand, and an appointment for whichever can."""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from nl2robot.cli import main as cli
from nl2robot.errors import ExitStatus
from nl2robot.fleet.address import FleetAddress
from nl2robot.fleet.trouble import AFTER, REACHED, Trouble
from nl2robot.review.review import digest
from nl2robot.run.runlog import RunLog
from nl2robot.schedule.service import Timing
from nl2robot.station.station import SimulatedStation, simulated_station
from robot_api.errors import InvalidCall
from sim.world.loading import load_world
from tests.fleet.wards import port
from tests.schedule.conftest import ZURICH, Clock

ROUND = 'robot.goto("ward a")\nrobot.say("Good morning.")\n'
AT_EIGHT = {"begins": "2026-11-30T08:00", "zone": ZURICH, "rule": "FREQ=DAILY"}
KEY = b"k" * 40


class Ward:
    def __init__(self, folder: Path) -> None:
        self.clock = Clock()
        self.meets = f"tcp/127.0.0.1:{port()}"
        self.folder = folder
        self.stack = ExitStack()
        self.stations: dict[str, SimulatedStation] = {}
        self.logs: dict[str, RunLog] = {}

    def starts(self, name: str, key: bytes = KEY) -> None:
        (self.folder / name).mkdir(exist_ok=True)
        log = self.logs[name] = RunLog(self.folder / name / "runs.sqlite")
        first = not self.stations
        joined = FleetAddress(
            name,
            connects=() if first else (self.meets,),
            listens=(self.meets,) if first else (),
            key=key,
        )
        self.stack.callback(log.close)
        self.stations[name] = self.stack.enter_context(
            simulated_station(
                load_world("ward"),
                log,
                fleet=joined,
                timing=Timing(clock=self.clock, every=0.05),
            )
        )

    def ask(self, name: str, method: str, **given: Any) -> Any:
        with self.stations[name].connect() as robot:
            return robot.request(method, given)

    def until(self, name: str, method: str, so: Callable[[Any], bool], **given: Any) -> Any:
        heard = threading.Event()
        with self.stations[name].connect() as robot:
            robot.subscribe(
                ("fleet", "fleet.plans", "schedule", "notice"), lambda kind, data: heard.set()
            )
            for _ in range(200):
                found = robot.request(method, given)
                if so(found):
                    return found
                heard.wait(0.5)
                heard.clear()
        raise AssertionError(found)

    def plans(self, name: str, **given: Any) -> dict[str, Any]:
        about = {"program": ROUND, "sha256": digest(ROUND), "by": "Nurse Kim"}
        said = {"sentence": "go to ward a and say good morning", "rhythm": AT_EIGHT}
        added: dict[str, Any] = self.ask(name, "schedule.add", **about, **said, **given)
        return added


@pytest.fixture
def ward(tmp_path: Path) -> Iterator[Ward]:
    ward = Ward(tmp_path)
    with ward.stack:
        yield ward


def together(ward: Ward) -> None:
    for name in ("Ada", "Ben"):
        ward.starts(name)
    for name in ("Ada", "Ben"):
        ward.until(
            name, "fleet.list", lambda found: sum(each["known"] for each in found["members"]) == 2
        )


def test_an_appointment_of_ada_is_done_by_ben_who_can_and_both_consoles_tell_it(
    ward: Ward, capsys: pytest.CaptureFixture[str]
) -> None:
    together(ward)
    kept = ward.plans("Ada", fleet=True)
    assert kept["fleet"] is not None
    [shown] = ward.until("Ben", "fleet.plans", bool, language="de")
    assert (shown["name"], shown["here"], shown["known"]) == ("Ada", False, True)
    assert shown["planned"]["when"] == "jeden Tag um 08:00"
    ward.ask("Ada", "robot.stop")  # she rests for two minutes
    ward.until(
        "Ada",
        "fleet.list",
        lambda found: found["members"][0]["standing"].get("waits") == "stopped",
    )
    ward.clock.set("2026-11-30 08:00")
    [came] = ward.until(
        "Ada", "schedule.history", lambda found: found and found[0]["occurrence"]["state"] == "done"
    )
    assert came["told"] == "done, by Ben"
    [run] = ward.logs["Ben"].runs()
    assert run.approved_by == "Nurse Kim (appointment 1) (fleet, from Ada)"
    assert ward.logs["Ada"].runs() == []
    ward.until("Ben", "fleet.plans", lambda found: found[0]["planned"]["told"] == "done, by Ben")
    capsys.readouterr()
    address = f"ws://{ward.stations['Ben'].address}"
    assert cli.main(["fleet", "--robot", address]) == ExitStatus.OK
    table = " ".join(capsys.readouterr().out.split())
    assert "every day at" in table and "Nurse Kim" in table and "Ada" in table
    assert cli.main(["fleet", "--json", "--robot", address]) == ExitStatus.OK
    [told] = json.loads(capsys.readouterr().out)["plans"]
    assert told["planned"]["plan"]["number"] == kept["id"]


def test_at_the_terminal_it_is_for_the_fleet_only_where_there_is_one(
    ward: Ward, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path))
    monkeypatch.setenv("NL2ROBOT_USER", "Nurse Kim")
    ward.starts("Ada")
    said = ("schedule", "add", "go to ward a", "--at", "08:00", "--every", "day", "--yes")
    there = ("--robot", f"ws://{ward.stations['Ada'].address}")
    assert cli.main([*said, "--fleet", *there]) == ExitStatus.OK, capsys.readouterr().out
    [kept] = ward.ask("Ada", "schedule.list")
    assert kept["appointment"]["fleet"] is not None
    capsys.readouterr()
    assert cli.main(["schedule", *there]) == ExitStatus.OK
    assert "any of the" in " ".join(capsys.readouterr().out.split())
    assert cli.main([*said, "--fleet"]) == ExitStatus.BAD_INPUT
    assert "has joined no fleet" in capsys.readouterr().err


def test_what_a_robot_notices_of_itself_is_nobody_elses_to_do(ward: Ward) -> None:
    ward.starts("Ada")
    about = {"program": ROUND, "sha256": digest(ROUND), "by": "Nurse Kim", "sentence": "charge"}
    trigger = {"what": "battery", "below": 20}
    with pytest.raises(InvalidCall, match="sees to itself"):
        ward.ask("Ada", "schedule.add", **about, trigger=trigger, fleet=True)


def test_a_robot_that_could_never_do_it_is_refused_before_anybody_reviews_it(ward: Ward) -> None:
    together(ward)
    with pytest.raises(InvalidCall, match="There is no robot “Eve”"):
        ward.ask("Ada", "fleet.fit", robot="Eve", program=ROUND)
    ben = ward.ask("Ada", "fleet.fit", robot="Ben", program=ROUND)
    assert ben == ward.ask("Ada", "fleet.fit", robot=ben, program="robot.say(")  # reviews tell


def test_a_robot_with_another_key_is_told_of(ward: Ward) -> None:
    ward.starts("Ada")
    ward.starts("Ben", key=b"o" * 40)
    found = ward.until("Ben", "fleet.list", lambda found: found["trouble"] is not None)
    assert "with another key" in found["trouble"]["en"]
    assert "anderen Schlüssel" in found["trouble"]["de"]


def test_that_the_fleet_is_not_reached_is_said_once_and_when_it_is() -> None:
    trouble = Trouble(["tcp/10.0.0.5:7447"], "ab12")
    assert trouble.look(0.0, False, False, ()) is None  # it has just been started
    said = trouble.look(AFTER, False, False, ())
    assert said is not None and "tcp/10.0.0.5:7447" in said
    assert trouble.look(AFTER + 1, False, False, ()) is None
    assert trouble.look(AFTER + 2, True, False, {"cd34"}) is None
    said = trouble.look(2 * AFTER + 2, True, False, {"cd34"})
    assert said is not None and "cd34" in said and "ab12" in said
    assert trouble.look(2 * AFTER + 3, True, True, {"cd34"}) == REACHED
    assert trouble.look(2 * AFTER + 4, True, True, {"cd34"}) is None
