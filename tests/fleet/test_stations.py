"""Robots in processes of their own, over Zenoh, with links that are cut."""

from __future__ import annotations

import os
import random
import signal
import socket
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest

from nl2robot.fleet.key import VARIABLE
from nl2robot.review.review import digest
from nl2robot.run.runlog import RunLog
from robot_api.client import Robot
from robot_api.errors import InvalidCall

KEY = "the-key-of-this-ward-and-of-no-other"
SOON = 60.0
NAMES = ("Ada", "Ben", "Cleo", "Dora", "Emil", "Fay", "Gus", "Hal", "Ida", "Jo")
OPEN = ("looking", "given", "begun")


def port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as found:
        return int(found.getsockname()[1])


class Link:
    """A cable between a robot and where it meets the others."""

    def __init__(self, to: int) -> None:
        self._to = to
        self._cut = threading.Event()
        self._ends: list[socket.socket] = []
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._server.getsockname()[1])
        threading.Thread(target=self._accept, daemon=True).start()

    def cut(self) -> None:
        self._cut.set()
        for each in self._ends:
            with suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
        self._ends.clear()

    def mend(self) -> None:
        self._cut.clear()

    def close(self) -> None:
        self.cut()
        self._server.close()

    def _accept(self) -> None:
        with suppress(OSError):
            while True:
                one, _ = self._server.accept()
                if self._cut.is_set():
                    one.close()
                    continue
                try:
                    other = socket.create_connection(("127.0.0.1", self._to))
                except OSError:
                    one.close()
                    continue
                self._ends += [one, other]
                for pair in ((one, other), (other, one)):
                    threading.Thread(target=self._carry, args=pair, daemon=True).start()

    def _carry(self, one: socket.socket, other: socket.socket) -> None:
        with suppress(OSError):
            while data := one.recv(65_536):
                other.sendall(data)
        for each in (one, other):
            with suppress(OSError):
                each.close()


class Ward:
    """Robots that all meet at the first one."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.port = port()
        self.links: dict[str, Link] = {}
        self.processes: dict[str, subprocess.Popen[str]] = {}
        self.addresses: dict[str, str] = {}

    def starts(self, name: str, called: str | None = None, key: str = KEY) -> None:
        home = self.folder / name
        home.mkdir(exist_ok=True)
        listens, connects = f"tcp/127.0.0.1:{self.port}", "-"
        if name != NAMES[0]:
            link = self.links.setdefault(name, Link(self.port))
            listens, connects = "-", f"tcp/127.0.0.1:{link.port}"
        process = self.processes[name] = subprocess.Popen(
            [sys.executable, "-m", "tests.fleet.station", home, called or name, listens, connects],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "NL2ROBOT_HOME": str(home), VARIABLE: key},
        )
        assert process.stdout is not None
        self.addresses[name] = process.stdout.readline().strip()
        assert self.addresses[name], name

    def killed(self, name: str) -> None:
        self.processes[name].send_signal(signal.SIGKILL)
        self.processes[name].wait(SOON)

    def robot(self, name: str) -> Robot:
        return Robot(self.addresses[name])

    def ask(self, name: str, method: str, **given: Any) -> Any:
        with self.robot(name) as robot:
            return robot.request(f"fleet.{method}", given)

    def until(self, name: str, so: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """Wait for what a robot tells of its fleet."""
        ends = time.monotonic() + SOON
        with self.robot(name) as robot:
            heard = threading.Event()
            robot.subscribe("fleet", lambda kind, data: heard.set())
            while not so(found := robot.request("fleet.list", {})):
                assert time.monotonic() < ends, found
                heard.wait(SOON)
                heard.clear()
        return dict(found)

    def run(self, at: str, program: str, **given: Any) -> str:
        sha256 = digest(program)
        about = {"program": program, "sha256": sha256, "by": "Nurse Kim", "sentence": program}
        return str(self.ask(at, "run", **about, **given)["id"])

    def over(self, at: str, errand: str) -> dict[str, Any]:
        ends = time.monotonic() + 4 * SOON
        with self.robot(at) as robot:
            while True:
                found = robot.request("fleet.wait", {"errand": errand})
                if found["state"] not in OPEN:
                    return dict(found)
                assert time.monotonic() < ends, found

    def runs(self) -> Iterator[tuple[str, Any]]:
        """All that was ever begun, from the logs."""
        for name in self.processes:
            log = RunLog(self.folder / name / "runs.sqlite")
            for run in log.runs(1000):
                yield name, run
            log.close()

    def close(self) -> None:
        for process in self.processes.values():
            with suppress(OSError):
                process.communicate(timeout=SOON)
        for link in self.links.values():
            link.close()


@pytest.fixture
def ward(tmp_path: Path) -> Iterator[Ward]:
    ward = Ward(tmp_path)
    yield ward
    ward.close()


def states(found: dict[str, Any]) -> list[str]:
    """As far as anything was heard of them."""
    return [each["standing"]["state"] for each in found["members"] if each["standing"]]


def known(found: dict[str, Any]) -> set[str]:
    return {each["name"] for each in found["members"] if each["known"]}


@pytest.mark.timeout(600)
def test_links_are_cut_and_a_robot_is_killed_and_nothing_is_done_twice(
    ward: Ward, soak: bool
) -> None:
    chance = random.Random(None if soak else 7)
    names = NAMES[: 10 if soak else 3]
    for name in names:
        ward.starts(name)
    ward.until("Ada", lambda found: known(found) == set(names))
    others = names[1:]
    errands = []
    for number in range(30 if soak else 5):
        place = chance.choice(("ward a", "ward b"))
        program = f'robot.goto("{place}")\nrobot.say("{number}")\n'
        errands.append(ward.run("Ada", program))
        what, whom = chance.choice(("cut", "mend", "kill", "wait")), chance.choice(others)
        if what == "cut":
            ward.links[whom].cut()
        elif what == "kill" and number % 3 == 1:
            ward.killed(whom)
            ward.starts(whom)
        else:
            for link in ward.links.values():
                link.mend()
        ward.ask("Ada", "wait", errand=errands[-1], timeout=chance.uniform(0.0, 3.0))
    for link in ward.links.values():
        link.mend()
    ended = [ward.over("Ada", errand) for errand in errands]
    begun = Counter(run.sha256 for _, run in ward.runs())
    assert all(times == 1 for times in begun.values()), begun
    for each in ended:
        assert each["state"] in ("done", "broken_off", "failed", "nobody"), each
        assert begun[each["sha256"]] == (each["run"] is not None), each
    assert any(each["state"] == "done" for each in ended)
    for _, run in ward.runs():
        assert run.approved_by == "Nurse Kim (fleet, from Ada)"


def test_a_robot_goes_on_alone_and_is_told_of_as_not_heard_of(ward: Ward) -> None:
    for name in NAMES[:2]:
        ward.starts(name)
    ward.until("Ada", lambda found: known(found) == {"Ada", "Ben"})
    errand = ward.run("Ada", 'robot.goto("ward b")\nrobot.wait(20)\n', robot="Ben")
    ward.until("Ada", lambda found: found["errands"][0]["state"] == "begun")
    ward.until("Ada", lambda found: "running" in states(found))
    ward.links["Ben"].cut()
    found = ward.until("Ada", lambda found: known(found) == {"Ada"})
    [ben] = [each for each in found["members"] if each["name"] == "Ben"]
    assert ben["standing"]["state"] == "running" and not ben["known"]
    with ward.robot("Ben") as robot:  # cut off, it does what was approved for it to its end
        assert robot.request("program.wait", {"run": 1})["state"] == "done"
    assert ward.ask("Ada", "list")["errands"][0]["state"] == "begun"
    [_, silent] = sorted(ward.ask("Ada", "stop"), key=lambda told: str(told["name"]))
    assert (silent["name"], silent["answered"], silent["confirmed"]) == ("Ben", False, False)
    ward.links["Ben"].mend()
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
        assert told.wait(SOON)
    assert "anderer Roboter" in sentences[0]["de"]
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
