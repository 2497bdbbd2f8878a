"""A real broker (Debian's mosquitto), for as long as a story lasts."""

from __future__ import annotations

import os
import queue
import shutil
import socket
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from nl2robot.building.broker import Broker, BrokerAddress

SOON = 20.0
MOSQUITTO = shutil.which("mosquitto", path=f"{os.environ.get('PATH', '')}:/usr/sbin")


class House:
    """A broker that can go and come back on its port."""

    def __init__(self, folder: Path, users: dict[str, str]) -> None:
        with socket.create_server(("127.0.0.1", 0)) as found:
            self.port = found.getsockname()[1]
        self._settings = folder / "mosquitto.conf"
        lines = [f"listener {self.port} 127.0.0.1", f"allow_anonymous {str(not users).lower()}"]
        if users:
            passwords = folder / "passwords"
            passwords.write_text("".join(f"{name}:{word}\n" for name, word in users.items()))
            subprocess.run(["mosquitto_passwd", "-U", passwords], check=True)
            passwords.chmod(0o644)
            folder.chmod(0o755)
            lines += [f"password_file {passwords}", f"user {os.environ.get('USER', 'root')}"]
        self._settings.write_text("\n".join(lines) + "\n")
        self._broker: subprocess.Popen[str] | None = None

    def comes(self) -> None:
        assert MOSQUITTO is not None
        self._broker = subprocess.Popen(
            [MOSQUITTO, "-c", self._settings], stderr=subprocess.PIPE, text=True
        )
        assert self._broker.stderr is not None
        assert any("running" in line for line in self._broker.stderr), "the broker does not come"
        # Some versions say so before they listen.
        ends = time.monotonic() + SOON
        while True:
            try:
                socket.create_connection(("127.0.0.1", self.port), timeout=SOON).close()
                return
            except ConnectionRefusedError:
                assert time.monotonic() < ends, "the broker does not listen"

    def goes(self) -> None:
        if self._broker is not None:
            self._broker.kill()
            self._broker.wait()
            assert self._broker.stderr is not None
            self._broker.stderr.close()
            self._broker = None


@pytest.fixture
def house(tmp_path: Path) -> Iterator[Callable[..., House]]:
    if MOSQUITTO is None:
        if os.environ.get("CI"):
            pytest.fail("There is no mosquitto here: apt-get install mosquitto")
        pytest.skip("There is no mosquitto here: apt-get install mosquitto")
    made: list[House] = []

    def make(users: dict[str, str] | None = None) -> House:
        made.append(House(tmp_path, users or {}))
        made[-1].comes()
        return made[-1]

    yield make
    for each in made:
        each.goes()


class Listener:
    """Who connects, and what it is told."""

    def __init__(self, port: int, name: str, user: str | None = None, password: str = "") -> None:
        self.heard: queue.Queue[tuple[str, str]] = queue.Queue()
        self.links: queue.Queue[tuple[bool, str]] = queue.Queue()
        self.broker = Broker(
            BrokerAddress("127.0.0.1", port, user=user, prefix=f"ward/{name}"),
            name,
            lambda topic, text, before: self.heard.put((topic, text)),
            lambda connected, because: self.links.put((connected, because)),
            password,
        )

    def hears(self) -> tuple[str, str]:
        return self.heard.get(timeout=SOON)

    def is_told(self) -> tuple[bool, str]:
        return self.links.get(timeout=SOON)


@pytest.fixture
def join() -> Iterator[Callable[..., Listener]]:
    there: list[Listener] = []

    def make(*words: Any, **more: Any) -> Listener:
        there.append(Listener(*words, **more))
        there[-1].broker.open()
        return there[-1]

    yield make
    for each in there:
        each.broker.close()
