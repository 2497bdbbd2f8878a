"""What is wrong is said in a sentence, and nothing moves."""

from __future__ import annotations

import socket
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from nl2robot.cli.main import main
from robot_api.errors import (
    AccessDenied,
    InternalError,
    LostConnection,
    NotPossible,
    NotSupported,
    StopNotConfirmed,
)
from robot_api.robots.address import parse
from robot_api.robots.pepper import PEPPER, line
from robot_api.robots.registry import Setup
from robot_api.robots.robot_file import RobotFile
from tests.robots.pepper.conftest import MAP, call


def reach(address: str, password: str | None = None) -> None:
    PEPPER.connect(Setup(address=parse(address), password=password)).close()


@pytest.fixture
def listening() -> Iterator[socket.socket]:
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server


def test_there_is_no_such_host() -> None:
    with pytest.raises(LostConnection, match=r"There is no pepper\.invalid in this network"):
        reach("pepper://pepper.invalid")


def test_nothing_listens_there(listening: socket.socket) -> None:
    port = listening.getsockname()[1]
    listening.close()
    with pytest.raises(LostConnection, match=f"No Pepper answers at 127.0.0.1, port {port}"):
        reach(f"pepper://127.0.0.1:{port}")


def test_something_listens_and_says_nothing(
    listening: socket.socket, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(line, "CONNECTS_WITHIN", 0.3)
    with pytest.raises(LostConnection, match=r"has answered as a Pepper does for 0\.3 seconds"):
        reach(f"pepper://127.0.0.1:{listening.getsockname()[1]}")


def test_what_answers_is_no_pepper(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    with pytest.raises(NotSupported, match="is no Pepper: it has no ALMotion"):
        drive(standing_in(without=["ALMotion"]))


def test_a_pepper_that_wants_a_login(
    standing_in: Callable[..., Any], drive: Callable[..., Any], network: Callable[..., Any]
) -> None:
    way = network(standing_in(), password="cherry")
    with pytest.raises(AccessDenied, match=r"wants a login, write pepper://USER@127\.0\.0\.1"):
        drive(way)


def test_the_password_is_missing() -> None:
    with pytest.raises(AccessDenied, match="NL2ROBOT_ROBOT_PASSWORD"):
        reach("pepper://nao@127.0.0.1")


@pytest.fixture
def certificate(tmp_path: Path) -> tuple[Path, Path]:
    """As every Pepper has one, signed by itself."""
    files = tmp_path / "certificate.pem", tmp_path / "key.pem"
    made = "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=pepper -out {} -keyout {}"
    subprocess.run(made.format(*files).split(), check=True, capture_output=True)
    return files


def test_newer_software_is_reached_encrypted_and_with_a_login(
    standing_in: Callable[..., Any],
    drive: Callable[..., Any],
    network: Callable[..., Any],
    certificate: tuple[Path, Path],
) -> None:
    """As NAOqi 2.9 wants it: `tcps`, a user's name in the address, the password beside it."""
    pepper = standing_in()
    way = network(pepper, certificate=certificate, password="cherry")
    address = f"pepper://nao@127.0.0.1:{way.port}"
    with pytest.raises(AccessDenied, match="let nobody in as nao"):
        drive(way, address=address, password="plum")
    driver = drive(way, address=address, password="cherry")
    call(driver, "move", metres=0.2)
    assert pepper.pose[0] == pytest.approx(0.2, abs=0.01)


def test_where_it_is_looked_for_unless_told() -> None:
    assert line.url_of(parse("pepper://ward-pepper")) == "tcp://ward-pepper:9559"
    assert line.url_of(parse("pepper://nao@ward-pepper")) == "tcps://ward-pepper:9503"
    assert line.url_of(parse("pepper://nao@[fe80::1]:99")) == "tcps://[fe80::1]:99"


@pytest.mark.parametrize(
    ("file", "told"),
    [
        (RobotFile(gestures={"bow": "animations/Bow"}), "gesture 'bow' is animations/Bow"),
        (RobotFile(skills={"fly": "fly away"}), "skill 'fly' is no behaviour"),
        (RobotFile(emotions={"happy": "green"}), "emotion 'happy' is green"),
    ],
)
def test_a_robot_file_with_what_pepper_lacks(
    standing_in: Callable[..., Any], drive: Callable[..., Any], file: RobotFile, told: str
) -> None:
    pepper = standing_in(life="solitary", awake=False)
    with pytest.raises(NotSupported, match=told):
        drive(pepper, file=file)
    assert (pepper.life, pepper.awake, pepper.done) == ("solitary", False, [])


def test_no_voice_that_we_speak(standing_in: Callable[..., Any], drive: Callable[..., Any]) -> None:
    with pytest.raises(NotSupported, match="no voice for English, German or French"):
        drive(standing_in(languages=["Japanese"]))


def test_an_error_of_the_robots_own_is_a_sentence(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    pepper.set(languages=["English"])  # somebody uninstalls the others
    with pytest.raises(NotPossible, match=r"Pepper refused .*: German is not installed\. See"):
        call(driver, "say", text="Guten Tag.", language="de")


def test_a_service_that_goes_away(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    pepper.remove("ALBattery")
    with pytest.raises(NotSupported, match="has no ALBattery"):
        call(driver, "battery")


def test_a_service_that_is_started_again_is_found_again(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    assert call(driver, "battery") == 87
    pepper.restart("ALBattery")
    with pytest.raises(NotPossible, match="ALBattery has gone away"):
        call(driver, "battery")
    assert call(driver, "battery") == 87


def test_a_pepper_that_answers_with_nonsense(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    pepper.set(nonsense=True)
    with pytest.raises(InternalError, match="its log has the details"):
        call(driver, "battery")
    with pytest.raises(StopNotConfirmed):
        driver.stop("The nurse pressed stop.")
    pepper.set(nonsense=False)
    with pytest.raises(NotSupported, match="does not answer as a Pepper does"):
        drive(standing_in(nonsense=True))


# --- as an engineer meets it ---------------------------------------------------------------------


def check(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, str]:
    """`nl2robot robots check` of an address, and what it says."""
    status = main(["robots", "check", "--still", *arguments])
    told = capsys.readouterr()
    return status, told.out + told.err


def test_a_robot_file_with_a_joint_that_pepper_lacks(
    standing_in: Callable[..., Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pepper = standing_in(life="solitary")
    file = tmp_path / "robot.yaml"
    file.write_text("name: Pia\njoints:\n  HeadYaw: [-20, 20]\n  Tail: [-5, 5]\n", "utf-8")
    address = f"pepper://127.0.0.1:{pepper.port}"
    status, told = check(capsys, address, "--robot-file", str(file))
    assert status == 2
    assert "robot.yaml:4" in told
    assert "Tail" in told
    assert (pepper.life, pepper.done) == ("solitary", ["stopMove", "killAll", "stopAll"])


def test_a_robot_file_with_a_wrong_word(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text("pepper:\n  mapp: ward.explo\n", "utf-8")
    status, told = check(capsys, "pepper://127.0.0.1", "--robot-file", str(file))
    assert status == 2
    assert "robot.yaml:2" in told


def test_nobody_at_the_address(
    listening: socket.socket, capsys: pytest.CaptureFixture[str]
) -> None:
    port = listening.getsockname()[1]
    listening.close()
    status, told = check(capsys, f"pepper://127.0.0.1:{port}")
    assert status == 5
    assert "No Pepper answers" in told


def test_a_pepper_that_is_well_is_told_so(
    standing_in: Callable[..., Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pepper = standing_in(without=["ALAudioDevice", "ALTabletService"])  # nobody is waited for
    file = tmp_path / "robot.yaml"
    file.write_text(f"name: Pia\npepper: {{map: {MAP}}}\n", "utf-8")
    address = f"pepper://127.0.0.1:{pepper.port}"
    status, told = check(capsys, address, "--robot-file", str(file))
    assert status == 0, told
    assert "| Pia" in told
