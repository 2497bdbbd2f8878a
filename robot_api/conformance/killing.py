"""Whether a robot comes to rest when the server that drives it is killed.

The check starts a process that drives the robot as a server does, with the guardian that a server
has (`robot_api.robots.guardian`), kills it in the middle of a movement, and looks at the robot over
another connection.
"""

from __future__ import annotations

import contextlib
import os
import queue
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from typing import Final

import msgspec

from robot_api.conformance.losing import Connect, Losing
from robot_api.conformance.samples import long_movements
from robot_api.conformance.subject import Findings, Subject
from robot_api.errors import RobotError
from robot_api.robots.address import Address
from robot_api.robots.guardian import Guardian, Order

PART: Final = "killed server"
COMMAND: Final = (
    sys.executable,
    "-c",
    f"import sys; from {__name__} import main; sys.exit(main())",
)
_GUARDED_WITHIN: Final = 10.0
_BEGINS_WITHIN: Final = 60.0
_MOVES_WITHIN: Final = 5.0


def check_killed(
    connect: Connect,
    address: Address,
    order: Order,
    findings: Findings,
    command: Sequence[str] = COMMAND,
) -> None:
    """The robot must be there, and standing."""
    process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, bufsize=0)
    assert process.stdin is not None and process.stdout is not None
    said: queue.Queue[str] = queue.Queue()
    output = process.stdout
    threading.Thread(target=lambda: said.put(output.readline().decode()), daemon=True).start()
    try:
        process.stdin.write(msgspec.json.encode(order) + b"\n")
        word, _, more = said.get(timeout=_BEGINS_WITHIN).strip().partition(" ")
    except (OSError, queue.Empty):
        word, more = "", "the process that was to drive it did not begin"
    finally:
        process.kill()
        began = time.monotonic()
        process.wait()
        process.stdin.close()
    if word != "moving":
        findings.notes[PART] = more or "the robot was not seen to move"
        return
    findings.tried.add(PART)
    losing = Losing(connect, address, True, findings)
    losing.robot_stands(began, f"its server was killed in the middle of {more}", PART)


def main() -> int:
    """Drive the robot of the order on standard input until this process is killed."""
    order = msgspec.json.decode(sys.stdin.buffer.readline(), type=Order)
    kind, setup = order.setup()
    try:
        driver = kind.connect(setup)
    except RobotError as error:
        _say(f"not {error}")
        return 0
    with contextlib.closing(driver):
        guardian = Guardian(order) if kind.brake is not None else None
        if guardian is not None:
            guardian.watches(_GUARDED_WITHIN)  # else the robot drives on, which is then seen
        subject = Subject(driver, True, Findings())
        moving = _under_way(subject)
        _say(f"moving {moving}" if moving is not None else "not")
        while os.read(0, 1):
            pass
        subject.let_go()
        if guardian is not None:
            guardian.close()
    return 0


def _under_way(subject: Subject) -> str | None:
    """The method by which the robot is seen to move."""
    for name, arguments in long_movements(subject):
        call = subject.begin(name, arguments)
        until = time.monotonic() + _MOVES_WITHIN
        while not call.returned(0) and time.monotonic() < until:
            if subject.moves_on():
                return name
    return None


def _say(words: str) -> None:
    print(words, flush=True)
