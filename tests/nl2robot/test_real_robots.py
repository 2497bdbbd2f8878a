"""Commands for robots that are not simulated: reached by their address, lost, found, stopped."""

from __future__ import annotations

import json
import queue
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from nl2robot.errors import ExitStatus
from nl2robot.run.runlog import RunLog
from robot_api.client import Robot
from robot_api.errors import StopNotConfirmed
from tests.robots.far_robot import SOON, FarPackage
from tests.robots.packages import install

ROLL = ("run", "--world", "ward", "--yes", "move forward three meters", "--robot", "far://porter")


@pytest.fixture
def far(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[FarPackage]:
    """The far robot is installed, for commands in processes of their own and in this one."""
    far = FarPackage(tmp_path)
    for name, value in far.environment.items():
        monkeypatch.setenv(name, value)
    monkeypatch.syspath_prepend(str(far.site))
    yield far
    far.close()


@pytest.fixture
def last_run(home: Path) -> Callable[[], Any]:
    def last_run() -> Any:
        log = RunLog(home / "runs.sqlite")
        [row] = log.runs(1)
        log.close()
        return row

    return last_run


# --- which there are, and what is wrong with an address or a file


def test_the_robots_are_listed_with_what_they_need(nl2robot, far) -> None:
    status, out, _ = nl2robot("robots")
    assert status == ExitStatus.OK
    for line in ("sim       A robot in a simulated hospital", "far       A far robot"):
        assert line in out
    listed = {
        each["scheme"]: each for each in json.loads(nl2robot("robots", "--json")[1])["robots"]
    }
    assert listed["far"]["example"] == "far://HOST"
    assert listed["far"]["missing"] == []


def test_a_package_that_is_broken_is_said_at_the_end_of_the_list(
    nl2robot, tmp_path, monkeypatch
) -> None:
    monkeypatch.syspath_prepend(str(install(tmp_path / "owl", "robot-owl", "owl = no_owl:OWL")))
    status, out, _ = nl2robot("robots")
    assert status == ExitStatus.OK
    assert "The driver 'owl' of the package robot-owl cannot be loaded" in out.splitlines()[-1]


@pytest.mark.parametrize("command", [("run", "wave"), ("chat",), ("serve",), ("robots", "check")])
@pytest.mark.parametrize(
    ("address", "status", "sentence"),
    [
        ("frob://host", ExitStatus.BAD_INPUT, "no kind of robot called 'frob'"),
        ("far://", ExitStatus.BAD_INPUT, "is no address of a robot"),
        ("far", ExitStatus.BAD_INPUT, "Write its address as far://HOST."),
        ("far://a:secret@host", ExitStatus.BAD_INPUT, "NL2ROBOT_ROBOT_PASSWORD"),
        ("far://nowhere", ExitStatus.NO_ROBOT, "does not answer. See that it is switched on."),
        ("far://locked", ExitStatus.NO_ROBOT, "wants a password"),
    ],
)
def test_a_wrong_address_is_a_sentence_for_every_command(
    nl2robot, far, command: tuple[str, ...], address: str, status: int, sentence: str
) -> None:
    name = () if command[0] == "robots" else ("--robot",)
    said = nl2robot(*command, *name, address)
    assert said[0] == status
    assert sentence in said[2]
    assert len(said[2].splitlines()) == 1


def test_a_password_comes_from_the_environment(nl2robot, far, monkeypatch) -> None:
    monkeypatch.setenv("NL2ROBOT_ROBOT_PASSWORD", "sesame")
    status, out, _ = nl2robot(
        "run", "--world", "ward", "--yes", "say hello", "--robot", "far://locked"
    )
    assert status == ExitStatus.OK
    assert out.rstrip().endswith("Hello!")


def test_a_wrong_robot_file_is_said_line_by_line(nl2robot, far, tmp_path) -> None:
    file = tmp_path / "porter.yaml"
    file.write_text("name: x\nlimits: {sped: 1}\njoints: {tail: [0, 10]}\n")
    for command in (("run", "wave", "--robot"), ("serve", "--robot"), ("robots", "check")):
        status, _, err = nl2robot(*command, "far://porter", "--robot-file", str(file))
        assert status == ExitStatus.BAD_INPUT
        assert f"{file}:2: The entry limits has no field" in err
    file.write_text("name: x\n\njoints: {tail: [0, 10]}\n")
    for robot in ("far://porter", "sim"):
        status, _, err = nl2robot("run", "-y", "wave", "--robot", robot, "--robot-file", str(file))
        assert status == ExitStatus.BAD_INPUT
        assert f"{file}:3: The robot has no joint 'tail'" in err


def test_a_robot_file_belongs_to_the_server(nl2robot, serve, tmp_path) -> None:
    _, address = serve()
    file = tmp_path / "porter.yaml"
    file.write_text("limits: {speed: 1}\n")
    status, _, err = nl2robot("run", "wave", "--robot", address, "--robot-file", str(file))
    assert status == ExitStatus.BAD_INPUT
    assert "A robot file belongs to the server" in err
    status, _, err = nl2robot("robots", "check", address, "--robot-file", str(file), "--still")
    assert status == ExitStatus.BAD_INPUT
    assert "does not keep to a robot file from here" in err


# --- the check


def test_a_robot_is_checked_capability_by_capability(nl2robot, far) -> None:
    status, out, _ = nl2robot("robots", "check", "far://porter", "--still")
    assert "The far robot" in out.splitlines()[0]
    assert "| navigation   | lacks" in out
    assert "cannot find its way on a map" in out
    report = json.loads(nl2robot("robots", "check", "far://porter", "--still", "--json")[1])
    assert {row["part"]: row["state"] for row in report["rows"]}["speech"] == "works"
    assert status == ExitStatus.OK


# --- runs


def test_a_program_runs_on_it_with_a_dry_run_in_the_world(nl2robot, far, last_run) -> None:
    status, out, _ = nl2robot(
        "run", "--world", "ward", "--yes", "say hello", "--robot", "far://porter"
    )
    assert status == ExitStatus.OK
    assert "Dry run: It would take" in out
    assert out.rstrip().endswith("Hello!")
    assert (last_run().status, last_run().robot) == ("done", "The far robot")


def test_what_it_lacks_is_refused_before_it_starts(nl2robot, far) -> None:
    status, out, _ = nl2robot(
        "run", "--world", "ward", "--yes", "go to ward a", "--robot", "far://porter"
    )
    assert status == ExitStatus.NOT_APPROVED
    assert "The far robot cannot do this" in out


def test_a_robot_that_is_lost_ends_the_run(start, far, last_run) -> None:
    nurse = start(*ROLL)
    nurse.until("move(metres=3")
    far.tell("be lost")
    assert nurse.end() == ExitStatus.NO_ROBOT
    said = " ".join(nurse.output.split())
    assert "The robot cannot be reached since " in said
    assert "The far robot does not answer any more." in said
    assert "The robot could not finish." in said
    assert "Traceback" not in said
    row = last_run()
    assert row.status == "failed"
    assert "does not answer any more" in row.message


STUBBORN = """
while True:
    try:
        robot.move(3)
    except Exception:
        pass
"""


def test_a_program_that_catches_everything_ends_with_the_loss_all_the_same(
    start, far, last_run, tmp_path
) -> None:
    (tmp_path / "stubborn.py").write_text(STUBBORN)
    program = ("--program", str(tmp_path / "stubborn.py"))
    nurse = start("run", "--world", "ward", "--yes", *program, "--robot", "far://porter")
    nurse.until("move(metres=3")
    far.tell("be lost")
    assert nurse.end() == ExitStatus.NO_ROBOT
    assert last_run().status == "failed"
    assert "does not answer any more" in last_run().message


def test_a_stop_that_is_not_confirmed_is_not_called_stopped(start, far, last_run) -> None:
    far_robot = start(*ROLL)
    far_robot.until("move(metres=3")
    far.tell("confirm nothing")
    far_robot.kill(signal.SIGINT)
    status = far_robot.end()
    said = " ".join(far_robot.output.split())
    assert "has not confirmed that it stands. Use the button on the robot itself!" in said
    assert "Stopped." not in said
    assert status in (ExitStatus.INTERRUPTED, ExitStatus.NO_ROBOT)
    assert last_run().status == "failed"
    assert "not confirmed" in last_run().message


@pytest.mark.parametrize(
    ("language", "words", "said", "button"),
    [
        ("en", "stop", "has not confirmed that it stands.", "the button on the robot itself!"),
        ("de", "stopp", "hat nicht bestätigt, dass er steht.", "Knopf am Roboter"),
        ("fr", "stop", "n'a pas confirmé qu'il est à l'arrêt.", "le bouton du robot"),
    ],
)
def test_whoever_says_stop_is_told_the_truth(nl2robot, far, language, words, said, button) -> None:
    status, out, err = nl2robot("run", "-y", words, "--lang", language, "--robot", "far://deaf")
    assert status == ExitStatus.NO_ROBOT
    assert said in " ".join(out.split()) and button in " ".join(out.split())
    assert "Stopped." not in out
    assert said in " ".join(err.split())  # nor has it when it was let go of


@pytest.fixture
def served(start, far) -> tuple[Any, str]:
    server = start("serve", "--world", "ward", "--port", "0", "--robot", "far://porter")
    return server, server.until("ends the server").split("ws://")[1].split()[0]


def test_serve_serves_a_real_robot_and_tells_the_truth_of_it(served, far, nl2robot) -> None:
    _, address = served
    links: queue.Queue[Any] = queue.Queue()
    with Robot(address) as robot:
        assert robot.capabilities().name == "The far robot"
        robot.subscribe("link", lambda kind, data: links.put(data["state"]))
        status, out, _ = nl2robot("run", "-y", "say hello", "--robot", address)
        assert status == ExitStatus.OK, out
        far.tell("be lost")
        assert links.get(timeout=SOON) == "lost"
        assert robot.request("program.state")["robot_lost_since"] > 0
        status, out, _ = nl2robot("run", "-y", "say hello", "--robot", address)
        assert status == ExitStatus.NO_ROBOT
        assert "The robot cannot be reached since" in out  # who comes later is told, too
        far.tell("be found")
        assert links.get(timeout=SOON) == "connected"
        assert robot.request("program.state")["robot_lost_since"] is None
        far.tell("confirm nothing")
        with pytest.raises(StopNotConfirmed):
            robot.stop()


def test_a_second_server_on_the_same_robot_is_a_sentence(served, nl2robot) -> None:
    status, _, err = nl2robot("run", "-y", "say hello", "--robot", "far://PORTER:7")
    assert status == ExitStatus.NO_ROBOT
    assert "already being driven from this machine. End the other server first" in err


def test_a_server_that_ends_without_a_confirmed_stop_says_so(far, served) -> None:
    server, _ = served
    far.tell("confirm nothing")
    server.kill(signal.SIGTERM)
    assert server.end() == ExitStatus.NO_ROBOT
    assert "has not confirmed that it stands. Use the robot's own button." in server.output
    assert "Traceback" not in server.output


def test_a_simulated_robot_keeps_to_its_file(nl2robot, tmp_path) -> None:
    file = tmp_path / "slow.yaml"
    file.write_text("name: The snail\nlimits: {speed: 0.2}\n")
    program = tmp_path / "fast.py"
    program.write_text("robot.drive(0.5, 0, 1)\n")
    status, out, _ = nl2robot(
        *("run", "--world", "ward", "-y", "--program", str(program), "--robot-file", str(file))
    )
    assert status == ExitStatus.NOT_APPROVED
    assert "drives at 0.2 metres a second at most, not at 0.5" in " ".join(out.split())


def test_an_emulator_can_be_served(nl2robot) -> None:
    status, out, _ = nl2robot("run", "--world", "ward", "-y", "go to ward a", "--robot", "emulator")
    assert status == ExitStatus.OK
    assert "Done." in out


def test_no_heavy_library_is_loaded_to_list_the_robots() -> None:
    program = (
        "import sys\nfrom nl2robot.cli.main import main\nmain(['robots'])\n"
        "print(sorted(set(sys.modules) & {'pymunk', 'shapely', 'numpy', 'starlette', 'qi'}))\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stdout.endswith("[]\n"), done.stdout + done.stderr
