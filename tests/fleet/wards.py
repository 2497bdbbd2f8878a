"""Robots of a ward in processes of their own, joined over Zenoh by cables that can be cut."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal

from nl2robot.fleet.key import VARIABLE
from nl2robot.review.review import digest
from nl2robot.run.runlog import RunLog
from robot_api.client import Robot
from tests.attacks.clock import set_clock

KEY = "the-key-of-this-ward-and-of-no-other"
NAMES = ("Ada", "Ben", "Cleo", "Dora", "Emil", "Fay", "Gus", "Hal", "Ida", "Jo")
OPEN = ("looking", "given", "begun")
Way = Literal["out", "back"]
"""Through a cable: from who calls to who is called, or the other way."""


def port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as found:
        return int(found.getsockname()[1])


class Link:
    """A cable between a robot and one that it meets the others at."""

    def __init__(self, to: int) -> None:
        self._to = to
        self._cut = threading.Event()
        self._open: dict[Way, threading.Event] = {
            "out": threading.Event(),
            "back": threading.Event(),
        }
        self._ends: list[socket.socket] = []
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port = int(self._server.getsockname()[1])
        self.mend()
        threading.Thread(target=self._accept, daemon=True).start()

    def cut(self) -> None:
        """Both ends see it at once."""
        self._cut.set()
        for each in self._ends:
            with suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
        self._ends.clear()

    def silence(self, *ways: Way) -> None:
        """Nothing comes through any more that way, and nobody is told: as in a network that loses
        all. What was said meanwhile comes when it is mended, as it does with TCP."""
        for way in ways or ("out", "back"):
            self._open[way].clear()

    def mend(self) -> None:
        self._cut.clear()
        for each in self._open.values():
            each.set()

    def close(self) -> None:
        self.cut()
        self.mend()
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
                for way, pair in (("out", (one, other)), ("back", (other, one))):
                    carry = (self._open[way], *pair)  # type: ignore[index]
                    threading.Thread(target=self._carry, args=carry, daemon=True).start()

    def _carry(self, opened: threading.Event, one: socket.socket, other: socket.socket) -> None:
        with suppress(OSError):
            while data := one.recv(65_536):
                opened.wait()
                other.sendall(data)
        for each in (one, other):
            with suppress(OSError):
                each.close()


class Ward:
    """Robots that all meet at the `hubs`: each is joined to each of those by a cable."""

    def __init__(
        self,
        folder: Path,
        hubs: Sequence[str] = NAMES[:1],
        *,
        serves: bool = False,
        soon: float = 60.0,
    ) -> None:
        """`serves`: each is a whole `nl2robot serve`; `soon`: seconds within which things come."""
        self.folder, self.serves, self.soon = folder, serves, soon
        self.ports = {each: port() for each in hubs}
        self.links: dict[tuple[str, str], Link] = {}
        """By the two robots' names, who calls first."""
        self.processes: dict[str, subprocess.Popen[str]] = {}
        self.addresses: dict[str, str] = {}

    def links_of(self, name: str) -> list[Link]:
        return [link for ends, link in self.links.items() if name in ends]

    def starts(
        self, name: str, called: str | None = None, key: str = KEY, ahead: float = 0.0
    ) -> None:
        """`ahead`: by how many seconds its clock is wrong, if it is a whole `nl2robot serve`."""
        home = self.folder / name
        home.mkdir(exist_ok=True)
        listens = f"tcp/127.0.0.1:{self.ports[name]}" if name in self.ports else ""
        calls = [f"tcp/127.0.0.1:{self._link(name, hub).port}" for hub in self._called_by(name)]
        address = called or name
        if self.serves:
            clock = self.folder / f"{name}.clock"
            set_clock(clock, ahead)
            joins = f"{address}@{','.join(calls)}" if calls else address
            arguments = [
                *("-m", "tests.attacks.clock", clock, "serve", "--port", "0", "--world", "ward"),
                *("--speed", "10", "--fleet", joins),
                *(("--fleet-listen", listens) if listens else ()),
            ]
        else:
            arguments = [
                "-m",
                "tests.fleet.station",
                home,
                address,
                listens or "-",
                ",".join(calls) or "-",
            ]
        with self.errors(name).open("a") as errors:
            process = self.processes[name] = subprocess.Popen(
                [sys.executable, *arguments],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=errors,
                text=True,
                env={
                    **os.environ,
                    "NL2ROBOT_HOME": str(home),
                    "NL2ROBOT_LANGUAGE_MODEL": "none",
                    VARIABLE: key,
                },
            )
        assert process.stdout is not None
        said = process.stdout.readline()
        found = re.search(r"127\.0\.0\.1:\d+", said)
        assert found, (name, said, self.errors(name).read_text()[-2000:])
        self.addresses[name] = found[0]

    def errors(self, name: str) -> Path:
        """What its process has written to standard error."""
        return self.folder / f"{name}.errors"

    def _called_by(self, name: str) -> list[str]:
        hubs = list(self.ports)
        return hubs[: hubs.index(name)] if name in hubs else hubs

    def _link(self, name: str, hub: str) -> Link:
        if (name, hub) not in self.links:
            self.links[name, hub] = Link(self.ports[hub])
        return self.links[name, hub]

    def killed(self, name: str) -> None:
        self.processes[name].send_signal(signal.SIGKILL)
        self.processes[name].wait(self.soon)

    def robot(self, name: str) -> Robot:
        return Robot(self.addresses[name])

    def ask(self, name: str, method: str, **given: Any) -> Any:
        with self.robot(name) as robot:
            return robot.request(f"fleet.{method}", given)

    def until(self, name: str, so: Callable[[dict[str, Any]], bool]) -> dict[str, Any]:
        """Wait for what a robot tells of its fleet."""
        ends = time.monotonic() + self.soon
        with self.robot(name) as robot:
            heard = threading.Event()
            robot.subscribe("fleet", lambda kind, data: heard.set())
            while not so(found := robot.request("fleet.list", {})):
                assert time.monotonic() < ends, found
                heard.wait(self.soon)
                heard.clear()
        return dict(found)

    def run(self, at: str, program: str, **given: Any) -> str:
        sha256 = digest(program)
        about = {"program": program, "sha256": sha256, "by": "Nurse Kim", "sentence": program}
        return str(self.ask(at, "run", **about, **given)["id"])

    def over(self, at: str, errand: str) -> dict[str, Any]:
        ends = time.monotonic() + 4 * self.soon
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
            if self.serves:
                process.terminate()
            with suppress(OSError):
                process.communicate(timeout=self.soon)
        for link in self.links.values():
            link.close()


def known(found: dict[str, Any]) -> set[str]:
    return {each["name"] for each in found["members"] if each["known"]}
