"""The fleet at a terminal, and what is said where there is none."""

from __future__ import annotations

import json
import signal
import stat
from pathlib import Path
from typing import Any

import msgspec
import pytest

from nl2robot.cli import main as cli
from nl2robot.cli.commands.fleet import command
from nl2robot.cli.operator import Operator
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus
from nl2robot.fleet.address import BadFleet, FleetAddress, parse_fleet
from nl2robot.fleet.book import Errand
from nl2robot.fleet.key import VARIABLE
from nl2robot.review.review import digest
from nl2robot.run.runlog import RunLog
from nl2robot.station.station import simulated_station
from robot_api.client import Robot
from sim.world.loading import load_world

Said = pytest.CaptureFixture[str]


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path))
    monkeypatch.setenv("NL2ROBOT_USER", "Nurse Kim")
    monkeypatch.delenv(VARIABLE, raising=False)
    return tmp_path


@pytest.mark.parametrize(
    ("text", "connects"),
    [
        ("Ada", ()),
        ("Ada@tcp/10.0.0.5:7447", ("tcp/10.0.0.5:7447",)),
        ("Ada@tls/hub.example:7447, tcp/[::1]:7447", ("tls/hub.example:7447", "tcp/[::1]:7447")),
    ],
)
def test_where_a_robot_meets_its_fleet(text: str, connects: tuple[str, ...]) -> None:
    assert parse_fleet(text) == FleetAddress("Ada", connects)


@pytest.mark.parametrize(
    "text", ["", "@tcp/10.0.0.5:7447", "Ada@10.0.0.5", "Ada@tcp/x:70000", "A\nb", "x" * 61]
)
def test_what_says_nowhere_to_meet_is_refused(text: str) -> None:
    with pytest.raises(BadFleet, match="tcp/HOST:PORT"):
        parse_fleet(text)


def test_a_key_is_for_its_user_alone_and_is_made_once(home: Path, capsys: Said) -> None:
    assert cli.main(["fleet", "key"]) == ExitStatus.OK
    file = home / "fleet.key"
    key, said = file.read_text(), capsys.readouterr().out
    assert stat.S_IMODE(file.stat().st_mode) == 0o600 and str(file) in said.replace("\n", "")
    assert key.strip() not in said
    assert cli.main(["fleet", "key", "--lang", "de"]) == ExitStatus.OK
    assert file.read_text() == key and "Fingerabdruck" in capsys.readouterr().out
    file.chmod(0o644)
    assert cli.main(["serve", "--port", "0", "--fleet", "Ada"]) == ExitStatus.BAD_INPUT
    assert "can be read by others" in capsys.readouterr().err


def test_serve_says_what_is_missing(
    home: Path, capsys: Said, monkeypatch: pytest.MonkeyPatch
) -> None:
    def serve(*more: str) -> str:
        assert cli.main(["serve", "--port", "0", *more]) == ExitStatus.BAD_INPUT
        return capsys.readouterr().err

    assert "nl2robot fleet key" in serve("--fleet", "Ada")
    assert "add --fleet NAME" in serve("--fleet-listen", "tcp/127.0.0.1:7447")
    monkeypatch.setenv(VARIABLE, "short")
    assert VARIABLE in serve("--fleet", "Ada")
    monkeypatch.setenv(VARIABLE, "k" * 40)
    config = home / "zenoh.json5"
    config.write_text("{mode: 'nobody'}")
    assert str(config) in serve("--fleet", "Ada", "--fleet-config", str(config)).replace("\n", "")


def test_a_robot_without_a_fleet_says_so(home: Path, capsys: Said) -> None:
    log = RunLog(":memory:")
    with simulated_station(load_world("ward"), log) as station:
        assert cli.main(["fleet", "--robot", f"ws://{station.address}"]) == ExitStatus.BAD_INPUT
    assert "has joined no fleet" in capsys.readouterr().err


def test_a_fleet_of_one_lists_runs_and_stops(home: Path, capsys: Said) -> None:
    log = RunLog(home / "runs.sqlite")
    fleet = FleetAddress("Ada", key=b"k" * 40)
    program = home / "hello.py"
    program.write_text('robot.say("Hello.")\n')
    with simulated_station(load_world("ward"), log, fleet=fleet) as station:
        here = ("--robot", f"ws://{station.address}")
        with station.connect() as robot:
            while not all(each["known"] for each in robot.request("fleet.list", {})["members"]):
                pass
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("builtins.input", lambda *_: "approv")
            ran = cli.main(["fleet", "run", "--program", str(program), *here])
            assert ran == ExitStatus.NOT_APPROVED
            assert "“approv” decides nothing here, so nothing was run" in capsys.readouterr().err
            patch.setattr("builtins.input", lambda *_: "approve")
            ran = cli.main(["fleet", "run", "--program", str(program), *here])
        said = capsys.readouterr().out
        assert ran == ExitStatus.OK, said
        assert "Ada does it." in said and "Done" in said
        assert "tried on Ada, where it stands" in " ".join(said.split())
        assert cli.main(["fleet", "--json", *here]) == ExitStatus.OK
        found = json.loads(capsys.readouterr().out)
        assert [each["name"] for each in found["members"]] == ["Ada"]
        [errand] = found["errands"]
        assert (errand["by"], errand["run"]) == ("Nurse Kim (fleet, from Ada)", 1)
        assert cli.main(["fleet", "stop", *here]) == ExitStatus.OK
        assert "it stands" in capsys.readouterr().out
        assert cli.main(["fleet", "stop", "Eve", *here]) == ExitStatus.BAD_INPUT
        assert "There is no robot “Eve”" in capsys.readouterr().err
    log.close()


def waits(robot: Robot) -> str | None:
    """Why the only robot of its fleet begins nothing."""
    [ada] = robot.request("fleet.list", {})["members"]
    told: str | None = (ada["standing"] or {}).get("waits")
    return told


@pytest.mark.parametrize("begun", [True, False], ids=["begun", "looked for"])
def test_ctrl_c_calls_off_what_was_sent_or_stops_who_does_it(
    home: Path, capsys: Said, monkeypatch: pytest.MonkeyPatch, begun: bool
) -> None:
    def interrupted(operator: Operator, terminal: Terminal, errand: Errand) -> None:
        while begun and errand.state != "begun":
            waits = {"errand": errand.id, "timeout": 1}
            errand = msgspec.convert(operator.robot.request("fleet.wait", waits), Errand)
        raise KeyboardInterrupt

    def pressed_again(*given: Any) -> str:
        signal.raise_signal(signal.SIGINT)
        return called_back(*given)

    called_back = command._called_back
    monkeypatch.setattr(command, "_watched", interrupted)
    monkeypatch.setattr(command, "_called_back", pressed_again)
    monkeypatch.setattr("builtins.input", lambda *_: "approve")
    log = RunLog(home / "runs.sqlite")
    program = home / "patrol.py"
    program.write_text('while True:\n    robot.goto("ward a")\n    robot.goto("ward b")\n')
    fleet = FleetAddress("Ada", key=b"k" * 40)
    with (
        simulated_station(load_world("ward"), log, fleet=fleet) as station,
        station.connect() as robot,
    ):
        while not all(each["known"] for each in robot.request("fleet.list", {})["members"]):
            pass
        if not begun:  # whoever was just stopped is given nothing
            robot.stop()
            while waits(robot) is None:
                pass
        here = ("--robot", f"ws://{station.address}")
        ran = cli.main(["fleet", "run", "--program", str(program), *here])
        assert ran == ExitStatus.INTERRUPTED
        assert ("Stopped" if begun else "Called off") in capsys.readouterr().out
        [errand] = robot.request("fleet.list", {})["errands"]
        over = robot.request("fleet.wait", {"errand": errand["id"], "timeout": 60})
        assert over["state"] == ("stopped" if begun else "called_off")
        assert [run.status for run in log.runs()] == (["stopped"] if begun else [])
    log.close()


def test_when_all_are_stopped_nothing_waits_and_who_was_stopped_rests_when_started_anew(
    home: Path,
) -> None:
    log = RunLog(home / "runs.sqlite")
    fleet, ward = FleetAddress("Ada", key=b"k" * 40), load_world("ward")

    with (
        simulated_station(ward, log, fleet=fleet) as station,
        station.connect() as robot,
    ):
        robot.stop()
        while waits(robot) != "stopped":
            pass
        program = 'robot.say("Hello.")\n'
        given = {"program": program, "sha256": digest(program), "by": "Nurse Kim"}
        errand = robot.request("fleet.run", given)["id"]
        robot.request("fleet.stop", {})
        over = robot.request("fleet.wait", {"errand": errand, "timeout": 60})
        assert over["state"] == "called_off"
    with (
        simulated_station(ward, log, fleet=fleet) as station,
        station.connect() as robot,
    ):
        while waits(robot) is None:
            pass
        assert waits(robot) == "stopped" and log.runs() == []
    log.close()


def test_words_for_another_program_are_refused(home: Path, capsys: Said) -> None:
    program = home / "say.py"
    program.write_text('robot.say("Hello.")\n')
    with simulated_station(
        load_world("ward"), RunLog(":memory:"), fleet=FleetAddress("Ada", key=b"k" * 40)
    ) as station:
        here = ("--robot", f"ws://{station.address}")
        ran = cli.main(["fleet", "run", "go to the lobby", "--program", str(program), *here])
    assert ran != ExitStatus.OK and "either words or a --program" in capsys.readouterr().err
