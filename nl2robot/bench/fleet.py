"""How fast a fleet of ten robots is, in ten processes on this machine. What a thousand would need
is computed from that. `nl2robot bench fleet` prints it.

python -m nl2robot.bench.fleet FOLDER NAME LISTENS CONNECTS    one of the robots ("-": nowhere)
"""

from __future__ import annotations

import os
import re
import secrets
import socket
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any, Final

from nl2robot.bench.figures import Figure, megabytes, percentile
from nl2robot.fleet.address import parse_fleet
from nl2robot.fleet.key import VARIABLE
from nl2robot.review.review import digest
from nl2robot.run.runlog import RunLog
from nl2robot.station.station import simulated_station
from robot_api.client import Robot
from sim.world.loading import load_world

ROBOTS: Final = 10
MANY: Final = 1_000
STATES: Final = 60
DISPATCHES: Final = 15
STOPS: Final = 15
LISTENS: Final = 8.0
"""Seconds in which bytes are counted."""
SOON: Final = 60.0
WALK: Final = 'robot.goto("ward a")\nrobot.goto("ward b")\nrobot.goto("ward a")\n'
_SENT: Final = re.compile(r"bytes_(?:sent|received):(\d+)")


def measure(
    robots: int = ROBOTS, told: Callable[[str], None] = lambda what: None
) -> Iterator[Figure]:
    """The figures, as they come."""
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        port = _free_port()
        where = f"tcp/127.0.0.1:{port}"
        key = {**os.environ, VARIABLE: secrets.token_urlsafe(32)}
        told("Starting them")
        alone = stack.enter_context(_process(folder, "alone", "-", "-", key, joins=False))
        started = [stack.enter_context(_process(folder, "1", where, "-", key))]
        for number in range(2, robots + 1):
            started.append(stack.enter_context(_process(folder, str(number), "-", where, key)))
        clients = [stack.enter_context(Robot(address)) for _, address in started]
        _until(lambda: _known(clients[0]) == robots)
        told("Seeing states change")
        seen = sorted(_states(clients))
        yield _figure("state of a robot to another's console, p50", 1000 * seen[len(seen) // 2])
        yield _figure("the same, p99", 1000 * percentile(seen, 99))
        told("Handing on programs")
        given = [_dispatched(clients[0]) for _ in range(DISPATCHES)]
        yield _figure("approval to the run's beginning, median", 1000 * statistics.median(given))
        yield _figure("the same, the longest", 1000 * max(given))
        told("Counting bytes")
        idle = _bytes(port) / (robots - 1)
        yield Figure("fleet", "bytes a second of a robot's link, at rest", idle, "B/s")
        lonely = stack.enter_context(Robot(alone[1]))
        for each in (*clients, lonely):  # a robot that has driven has loaded more
            _walk(each)
        moving = _bytes(port) / (robots - 1)
        yield Figure("fleet", "the same, while all drive", moving, "B/s")
        told("Stopping all")
        stops = [_stopped(clients[0]) for _ in range(STOPS)]
        yield _figure(
            "stop of all to its last confirmation, median", 1000 * statistics.median(stops)
        )
        yield _figure("the same, the longest", 1000 * max(stops))
        lonely.stop()
        told("Weighing")
        more = statistics.mean(megabytes(process.pid) for process, _ in started)
        yield Figure("fleet", "memory of a robot's process in the fleet", more, "MB")
        less = megabytes(alone[0].pid)
        yield Figure("fleet", "of that, for the fleet", more - less, "MB")
        yield from grown(moving / robots, MANY)


def grown(word: float, robots: int) -> Iterator[Figure]:
    """What so many robots would need, computed: `word` is the bytes a second that one robot's
    words cost on one link. A link carries what its robot says, and what all others say."""
    links = robots * (robots - 1) // 2
    link = word * robots
    about = f"{robots:,} robots"
    yield Figure("paper", f"{about}: in and out of each, N·s", link / 1e3, "kB/s")
    yield Figure("paper", f"{about}, all joined to all: links, N·(N-1)/2", links, "")
    whole = word * robots * (robots - 1) / 1e6
    yield Figure("paper", f"{about}, all joined to all: in all, N·(N-1)·s", whole, "MB/s")
    yield Figure("paper", f"{about}, one router: links, N", robots, "")
    yield Figure("paper", f"{about}, one router: out of it, N·(N-1)·s", whole, "MB/s")
    split = word * robots * (robots / 20) / 1e6
    yield Figure("paper", f"{about} in 20 fleets (floors), one router: N·(N/20)·s", split, "MB/s")


def _figure(what: str, milliseconds: float) -> Figure:
    return Figure("fleet", what, milliseconds, "ms")


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as found:
        return int(found.getsockname()[1])


@contextmanager
def _process(
    folder: str,
    name: str,
    listens: str,
    connects: str,
    environment: Mapping[str, str],
    joins: bool = True,
) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """One of the robots, and its address."""
    home = Path(folder) / name
    home.mkdir()
    process = subprocess.Popen(
        [
            *(sys.executable, "-m", "nl2robot.bench.fleet"),
            *(str(home), name if joins else "-", listens, connects),
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env={**environment, "NL2ROBOT_HOME": str(home)},
    )
    assert process.stdout is not None
    try:
        yield process, process.stdout.readline().strip()
    finally:
        process.communicate()


def _until(so: Callable[[], bool]) -> None:
    ends = time.monotonic() + SOON
    while not so():
        if time.monotonic() > ends:
            raise TimeoutError("The robots do not hear of each other.")
        time.sleep(0.002)


def _known(robot: Robot) -> int:
    return sum(each["known"] for each in robot.request("fleet.list", {})["members"])


def _states(clients: list[Robot]) -> Iterator[float]:
    """Seconds from a robot's change of state until the first one's console is told."""
    awaited: dict[str, Any] = {}
    seen = threading.Event()

    def note(kind: str, data: Mapping[str, Any]) -> None:
        for each in data["members"]:
            if each["id"] == awaited.get("id") and each["standing"]["state"] == awaited["state"]:
                seen.set()

    clients[0].subscribe("fleet", note)
    for number in range(STATES):
        robot = clients[1 + number // 2 % (len(clients) - 1)]
        [mine] = [each for each in robot.request("fleet.list", {})["members"] if each["here"]]
        lies = number % 2 == 0
        seen.clear()
        awaited.update(id=mine["id"], state="reviewing" if lies else "none yet")
        began = time.monotonic()
        robot.request("program.reviewing", {"lies": lies})
        if not lies:
            awaited["state"] = robot.request("station.state", {})["state"]
        if not seen.wait(SOON):
            raise TimeoutError("A state is not told.")
        yield time.monotonic() - began


def _dispatched(robot: Robot) -> float:
    """Seconds from the approval of a program until a robot has begun it."""
    program = f'robot.say("{secrets.token_hex(4)}")\n'
    given = {"program": program, "sha256": digest(program), "by": "nobody", "sentence": program}
    began = time.monotonic()
    robot.request("fleet.run", given)

    def begun() -> bool:
        [errand, *_] = robot.request("fleet.list", {})["errands"]
        return errand["state"] not in ("looking", "given")

    _until(begun)
    took = time.monotonic() - began
    _until(lambda: robot.request("fleet.list", {})["errands"][0]["state"] == "done")
    return took


def _walk(robot: Robot) -> None:
    approval = robot.request(
        "program.approve",
        {"program": WALK, "sha256": digest(WALK), "by": "nobody", "insists": True},
    )
    robot.request("program.run", {"approval": approval["id"]})


def _stopped(robot: Robot) -> float:
    began = time.monotonic()
    if not all(each["confirmed"] for each in robot.request("fleet.stop", {})):
        raise TimeoutError("A robot has not confirmed that it stands.")
    return time.monotonic() - began


def _bytes(port: int) -> float:
    """Bytes a second over all connections to that port, there and back; not a number where the
    system does not tell (`ss` of Linux)."""
    before, began = _carried(port), time.monotonic()
    time.sleep(LISTENS)
    return (_carried(port) - before) / (time.monotonic() - began)


def _carried(port: int) -> float:
    try:
        said = subprocess.run(
            ["ss", "-tinH", f"sport = :{port}"], capture_output=True, text=True, check=True
        ).stdout
    except (OSError, subprocess.CalledProcessError):
        return float("nan")
    return float(sum(int(each) for each in _SENT.findall(said)))


def _serve(folder: str, name: str, listens: str, connects: str) -> None:
    text = name if connects == "-" else f"{name}@{connects}"
    address = parse_fleet(text, () if listens == "-" else (listens,)) if name != "-" else None
    log = RunLog(Path(folder) / "runs.sqlite")
    with simulated_station(load_world("ward"), log, speed=1.0, fleet=address) as station:
        print(station.address, flush=True)
        sys.stdin.read()
    log.close()


if __name__ == "__main__":
    _serve(*sys.argv[1:])
