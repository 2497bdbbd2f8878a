"""A small ward, a log and an operator for the stories of this folder."""

import contextlib
import fcntl
import os
import pty
import resource
import select
import signal
import subprocess
import sys
import termios
import time
from collections.abc import Sequence

import pytest

from nl2robot.cli import main as cli
from nl2robot.cli.operator import Operator
from nl2robot.run.runlog import RunLog
from nl2robot.station.station import simulated_station
from sim.world.loading import load_world


@pytest.fixture(autouse=True)
def home(tmp_path, monkeypatch):
    """Nothing of a test reaches the user's own log, and nobody is asked in an editor."""
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path / "home"))
    monkeypatch.setenv("NL2ROBOT_USER", "Nurse Kim")
    return tmp_path / "home"


@pytest.fixture
def log(tmp_path):
    log = RunLog(tmp_path / "log" / "runs.sqlite")
    yield log
    log.close()


@pytest.fixture
def station(log):
    with simulated_station(load_world("ward"), log, seed=1) as station:
        yield station


@pytest.fixture
def slow_station(log, request):
    """The same at ten times real time, or as the test says: slow enough to break into it."""
    speed = getattr(request, "param", 10)
    with simulated_station(load_world("ward"), log, seed=1, speed=speed) as station:
        yield station


@pytest.fixture
def sit_down():
    """Sit down at a station as an operator; everybody gets up at the end."""
    with contextlib.ExitStack() as leave:

        def sit_down(station) -> Operator:
            return Operator(leave.enter_context(station.connect()), "Nurse Kim")

        yield sit_down


@pytest.fixture
def operator(station, sit_down):
    return sit_down(station)


@pytest.fixture
def slow_operator(slow_station, sit_down):
    return sit_down(slow_station)


# --- the commands ----------------------------------------------------------------------------

NL2ROBOT = [sys.executable, "-m", "nl2robot.cli.main"]
SOON = 30.0
"""Seconds in which even a busy machine has done what it does at once."""


@pytest.fixture
def nl2robot(capsys):
    """Run a command in this process: `status, output, errors = nl2robot("log", "1")`."""
    before = {number: signal.getsignal(number) for number in (signal.SIGTERM, signal.SIGHUP)}

    def run(*arguments: str) -> tuple[int, str, str]:
        capsys.readouterr()
        try:
            status = cli.main(arguments)
        except SystemExit as end:  # argparse: wrong usage
            status = int(end.code or 0)
        said = capsys.readouterr()
        return int(status), said.out, said.err

    yield run
    for number, handler in before.items():
        signal.signal(number, handler)


class Command:
    """A command in a process of its own, at a terminal of its own (`at_terminal`) or with its input
    closed and its output in a pipe."""

    def __init__(
        self,
        arguments: tuple[str, ...],
        at_terminal: bool,
        largest_file: int | None,
        editor: str,
        program: Sequence[str] = NL2ROBOT,
    ) -> None:
        self.output = ""
        self._read_to = 0
        more = {"TERM": "dumb", "COLUMNS": "100", "PYTHONUNBUFFERED": "1", "EDITOR": editor}
        ours, theirs = pty.openpty() if at_terminal else os.pipe()
        self._terminal = ours

        def prepare() -> None:
            if at_terminal:
                fcntl.ioctl(0, termios.TIOCSCTTY, 0)
            if largest_file is not None:
                resource.setrlimit(resource.RLIMIT_FSIZE, (largest_file, largest_file))

        self.process = subprocess.Popen(
            [*program, *arguments],
            stdin=theirs if at_terminal else subprocess.DEVNULL,
            stdout=theirs,
            stderr=theirs,
            env={**os.environ, **more},
            start_new_session=True,
            preexec_fn=prepare,
        )
        os.close(theirs)

    def until(self, words: str) -> str:
        """Wait until it says these words; returns what it said up to them."""
        before = self._read_to
        ends = time.monotonic() + SOON
        while words not in self.output[before:]:
            assert self._read(ends), f"never said {words!r}:\n{self.output[before:]}"
        self._read_to = self.output.index(words, before) + len(words)
        return self.output[before : self._read_to]

    def type(self, keys: str) -> None:
        os.write(self._terminal, keys.encode())

    def hang_up(self) -> None:
        """Close our end: the terminal's window, or the pipe that was read from."""
        os.close(self._terminal)
        self._terminal = -1

    def kill(self, number: int) -> None:
        """To it and its children, as a terminal does with Ctrl-C."""
        os.killpg(self.process.pid, number)

    def interrupt(self, number: int = signal.SIGINT) -> None:
        """Signal it until it reacts: what comes between the writing of a question and the reading
        of the answer is noticed by Python at the next key or signal only."""
        self.kill(number)
        while not select.select([self._terminal], [], [], 1.0)[0]:
            self.kill(number)

    def end(self) -> int:
        """Wait for its end; returns the exit status."""
        ends = time.monotonic() + SOON
        while self._read(ends):
            pass
        return self.process.wait(max(0.1, ends - time.monotonic()))

    def close(self) -> None:
        with contextlib.suppress(ProcessLookupError):
            self.kill(signal.SIGKILL)
        self.process.wait()
        if self._terminal >= 0:
            self.hang_up()

    def _read(self, ends: float) -> bool:
        ready, _, _ = select.select([self._terminal], [], [], max(0.0, ends - time.monotonic()))
        assert ready, f"it hangs after:\n{self.output}"
        with contextlib.suppress(OSError):  # how a terminal says that its other end is closed
            if data := os.read(self._terminal, 65_536):
                self.output += data.decode(errors="replace").replace("\r\n", "\n")
                return True
        return False


@pytest.fixture
def start():
    """Start commands in processes of their own; none outlives the test."""
    with contextlib.ExitStack() as stop:

        def start(
            *arguments: str,
            at_terminal: bool = False,
            largest_file: int | None = None,
            editor: str = "false",
            program: Sequence[str] = NL2ROBOT,
        ) -> Command:
            command = Command(arguments, at_terminal, largest_file, editor, program)
            stop.callback(command.close)
            return command

        yield start


@pytest.fixture
def serve(start):
    """Start a robot server in the ward: `server, address = serve("--speed", "1")`."""

    def serve(*arguments: str) -> tuple[Command, str]:
        server = start("serve", "--world", "ward", "--port", "0", *arguments)
        address = server.until("ends the server").split("robot is at ")[1].split()[0]
        return server, address

    return serve
