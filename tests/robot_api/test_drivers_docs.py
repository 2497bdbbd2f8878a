"""What docs/drivers.md says, done: its examples run, its robot dog is a package that is found."""

from __future__ import annotations

import json
import os
import re
import socket
import subprocess
import sys
import time
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from robot_api.checker import check_driver
from robot_api.driver import StopFlag
from robot_api.errors import LostConnection, StopNotConfirmed
from robot_api.interfaces import INTERFACES
from robot_api.methods import METHODS
from robot_api.robots.address import parse
from robot_api.robots.opening import open_robot
from robot_api.robots.registry import kind_of
from tests.robots.packages import install
from tests.robots.test_stops_and_links import SOON, Diary, Errand

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "drivers.md").read_text(encoding="utf-8")


def file_of(name: str) -> str:
    """A file of the robot dog, as it stands on the page."""
    [code] = re.findall(rf"`{re.escape(name)}`\n```\w+\n(.*?)```", PAGE, re.S)
    return str(code)


@pytest.fixture
def site(tmp_path: Path) -> Path:
    """The dog's package, as `pip install` leaves it."""
    project = tomllib.loads(file_of("pyproject.toml"))["project"]
    points = "\n".join(
        f"{name} = {value}" for name, value in project["entry-points"]["nl2robot.robots"].items()
    )
    site = install(tmp_path / "site", project["name"], points, robot_dog=file_of("robot_dog.py"))
    (tmp_path / "pretend_dog.py").write_text(file_of("pretend_dog.py"), encoding="utf-8")
    return site


@contextmanager
def awake(tmp_path: Path, port: int) -> Iterator[subprocess.Popen[bytes]]:
    """The dog, as the page wakes it."""
    dog = subprocess.Popen([sys.executable, str(tmp_path / "pretend_dog.py"), str(port)])
    try:
        ends = time.monotonic() + SOON
        while True:
            try:
                socket.create_connection(("127.0.0.1", port), timeout=1).close()
                break
            except OSError:
                assert dog.poll() is None and time.monotonic() < ends, "the dog does not wake up"
                time.sleep(0.02)
        yield dog
    finally:
        dog.kill()
        dog.wait()


@pytest.fixture
def port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as free:
        number: int = free.getsockname()[1]
    return number


def nl2robot(site: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join((str(site), str(ROOT))),
        "NL2ROBOT_HOME": str(site.parent / "home"),
    }
    return subprocess.run(
        [sys.executable, "-m", "nl2robot.cli.main", *arguments],
        capture_output=True,
        text=True,
        env=environment,
        timeout=90,
        stdin=subprocess.DEVNULL,
    )


def connected(site: Path, port: int, monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(site))
    monkeypatch.delitem(sys.modules, "robot_dog", raising=False)
    address = parse(f"dog://127.0.0.1:{port}")
    return open_robot(address, kind_of(address))


def test_the_example_of_a_robot_that_is_not_there_runs() -> None:
    [example] = re.findall(r"```python\n(from robot_api.driver .*?)```", PAGE, re.S)
    exec(compile(example, "docs/drivers.md", "exec"), {"__name__": "example"})


def test_the_table_of_the_page_has_each_capability_with_its_methods() -> None:
    """Those that came later are at least in the reference, which is generated."""
    rows = re.findall(r"^\| `(\w+)\.py` \| (.*?) \|", PAGE, re.MULTILINE)
    listed = {name: file for file, names in rows for name in re.findall(r"`(\w+)`", names)}
    assert len(listed) > 30
    for name, file in listed.items():
        interface = INTERFACES[METHODS[name].capability]
        assert interface.__module__ == f"robot_api.capabilities.{file}", name


def test_the_dog_keeps_to_what_is_promised(
    site: Path, tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    with awake(tmp_path, port):
        dog = connected(site, port, monkeypatch)
        assert [str(problem) for problem in check_driver(dog)] == []
        dog.close()


def test_the_dog_is_found_and_checked_by_the_commands_of_the_page(
    site: Path, tmp_path: Path, port: int
) -> None:
    listed = nl2robot(site, "robots")
    assert "The robot dog" in listed.stdout
    assert "dog://HOST:7000" in listed.stdout
    asleep = nl2robot(site, "robots", "check", f"dog://127.0.0.1:{port}")
    assert asleep.returncode == 5
    assert "There is no dog at" in asleep.stderr
    with awake(tmp_path, port):
        checked = nl2robot(site, "robots", "check", f"dog://127.0.0.1:{port}", "--json")
        assert checked.returncode == 0, checked.stdout + checked.stderr
        states = {row["part"]: row["state"] for row in json.loads(checked.stdout)["rows"]}
        assert (states["skills"], states["motion"], states["speech"]) == ("works", "works", "lacks")
        ran = nl2robot(site, "run", "-y", "sit down", "--robot", f"dog://127.0.0.1:{port}")
        assert ran.returncode == 0, ran.stdout + ran.stderr
        assert "Done." in ran.stdout


def test_a_dog_that_runs_away_is_lost_and_found(
    site: Path, tmp_path: Path, port: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    diary = Diary()
    with awake(tmp_path, port):
        dog = connected(site, port, monkeypatch)
        dog.subscribe(diary.note)
        walk = Errand(lambda: dog.call("move", {"metres": 50}, StopFlag()))
    assert isinstance(walk.end(), LostConnection)
    with pytest.raises(StopNotConfirmed):
        dog.stop("Stay!")
    with awake(tmp_path, port):
        link, data = diary.next()
        while (link, data.get("state")) != ("link", "connected"):
            link, data = diary.next()
        dog.stop("Stay!")
        dog.close()
