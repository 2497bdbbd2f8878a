"""A Pepper that is not there, and what lies between it and us."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import ssl
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from robot_api.capabilities.driving import Goal
from robot_api.driver import StopFlag
from robot_api.robots.address import parse
from robot_api.robots.pepper import PepperSettings
from robot_api.robots.places import NamedPlace, Places
from robot_api.robots.registry import Setup
from robot_api.robots.robot_file import RobotFile

qi = pytest.importorskip("qi", reason="qi has no wheel for this Python")

qi.logging.setLevel(qi.logging.FATAL)

MAP = "/home/nao/.local/share/Explorer/ward.explo"
PLACES = Places(
    named={
        "lobby": NamedPlace("lobby", "lobby", Goal(0.0, 0.0, 0.0, "lobby")),
        "pharmacy": NamedPlace(
            "pharmacy", "room", Goal(3.0, 2.0, 90.0, "pharmacy"), ("drugstore",)
        ),
        "radiology": NamedPlace("radiology", "room", Goal(-3.0, 2.0, 90.0, "radiology")),
        "cellar": NamedPlace("cellar", "room"),
    }
)


class StandIn:
    """The process, and what a test does to it."""

    def __init__(self, **scene: Any) -> None:
        self.scene = scene
        self.start()

    def start(self) -> None:
        file = Path(__file__).with_name("stand_in.py")
        self.process = subprocess.Popen(
            [sys.executable, str(file), json.dumps(self.scene)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdout is not None
        lines = (line for line in self.process.stdout if line.startswith("URL "))
        url = next(lines).split()[1]
        self.port = int(url.rsplit(":", 1)[1])
        self._session = qi.Session()
        self._session.connect(url)
        self._control = self._session.service("StandIn")

    def again(self) -> None:
        """Switch it on again after it was killed, where it was."""
        self.scene["url"] = f"tcp://127.0.0.1:{self.port}"
        self._session.close()
        self.start()

    def __getattr__(self, name: str) -> Any:
        state = json.loads(self._control.state())
        if name not in state:
            raise AttributeError(name)
        return state[name]

    def set(self, **scene: Any) -> None:
        for name, value in scene.items():
            self._control.set(name, json.dumps(value))

    def restart(self, service: str) -> None:
        self._control.restart(service)

    def remove(self, service: str) -> None:
        self._control.remove(service)

    def touch(self, label: str) -> bool:
        return bool(self._control.touch(label))

    @property
    def texts(self) -> list[str]:
        return [text for text, _, _ in self.said]

    @property
    def speed(self) -> float:
        return float(max(map(abs, self.velocity)))

    def freeze(self) -> None:
        os.kill(self.process.pid, signal.SIGSTOP)
        os.waitpid(self.process.pid, os.WUNTRACED)  # until it really stands still

    def thaw(self) -> None:
        os.kill(self.process.pid, signal.SIGCONT)

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()

    def close(self) -> None:
        with contextlib.suppress(ProcessLookupError):
            self.thaw()
        self.kill()
        self._session.close()


class Proxy:
    """The network between us and the robot; it can be cut. With `certificate` it is encrypted and
    wants a login."""

    def __init__(
        self,
        port: int,
        certificate: tuple[Path, Path] | None = None,
        password: str | None = None,
    ) -> None:
        self._to = port
        self._password = password
        self._context = None
        if certificate is not None:
            self._context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
            self._context.load_cert_chain(*certificate)
        self._sockets: list[socket.socket] = []
        self._whole = True
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.port = self._listening.getsockname()[1]
        threading.Thread(target=self._accept, daemon=True).start()

    def cut(self) -> None:
        self._whole = False
        for each in self._sockets:
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)

    def mend(self) -> None:
        self._whole = True

    def close(self) -> None:
        self.cut()
        self._listening.close()

    def _accept(self) -> None:
        while True:
            try:
                near, _ = self._listening.accept()
            except OSError:
                return
            if not self._whole:
                near.close()
                continue
            threading.Thread(target=self._join, args=(near,), daemon=True).start()

    def _join(self, near: socket.socket) -> None:
        with contextlib.suppress(OSError):
            if self._context is not None:
                near = self._context.wrap_socket(near, server_side=True)
            greeting = near.recv(65536)
            if self._password is not None and self._password.encode() not in greeting:
                near.close()
                return
            far = socket.create_connection(("127.0.0.1", self._to))
            self._sockets += [near, far]
            far.sendall(greeting)
            threading.Thread(target=self._pump, args=(far, near), daemon=True).start()
            self._pump(near, far)

    @staticmethod
    def _pump(source: socket.socket, sink: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while block := source.recv(65536):
                sink.sendall(block)
        for each in (source, sink):
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)


@pytest.fixture
def standing_in() -> Iterator[Callable[..., StandIn]]:
    """Makes Peppers."""
    made: list[StandIn] = []

    def make(**scene: Any) -> StandIn:
        made.append(StandIn(**{"hurry": 8.0} | scene))
        return made[-1]

    yield make
    for each in made:
        each.close()


@pytest.fixture
def drive() -> Iterator[Callable[..., Any]]:
    """Makes drivers of them."""
    from robot_api.robots.pepper.driver import connect

    made: list[Any] = []

    def make(pepper: Any, *, address: str | None = None, **setup: Any) -> Any:
        where = parse(address or f"pepper://127.0.0.1:{pepper.port}")
        file = setup.pop("file", RobotFile())
        settings = setup.pop("settings", PepperSettings(map=MAP))
        setup = {"places": PLACES} | setup
        made.append(connect(Setup(address=where, file=file, settings=settings, **setup)))
        return made[-1]

    yield make
    for each in made:
        each.close()


@pytest.fixture
def network() -> Iterator[Callable[..., Proxy]]:
    """Makes ways to them that can be cut."""
    made: list[Proxy] = []

    def make(pepper: StandIn, **how: Any) -> Proxy:
        made.append(Proxy(pepper.port, **how))
        return made[-1]

    yield make
    for each in made:
        each.close()


class Call:
    """A call in a thread of its own."""

    def __init__(self, driver: Any, method: str, **arguments: Any) -> None:
        self.stop = StopFlag()
        self.error: BaseException | None = None
        self.result: Any = None
        self._thread = threading.Thread(
            target=self._run, args=(driver, method, arguments), daemon=True
        )
        self._thread.start()

    def _run(self, driver: Any, method: str, arguments: dict[str, Any]) -> None:
        try:
            self.result = driver.call(method, arguments, self.stop)
        except BaseException as error:  # noqa: BLE001 - the test looks at it
            self.error = error

    def over(self, within: float = 10.0) -> bool:
        self._thread.join(within)
        return not self._thread.is_alive()


def call(driver: Any, method: str, **arguments: Any) -> Any:
    return driver.call(method, arguments, StopFlag())


def until(true: Callable[[], Any], within: float = 10.0) -> bool:
    """Wait for it."""
    ends = time.monotonic() + within
    while not true():
        if time.monotonic() > ends:
            return False
        time.sleep(0.005)
    return True
