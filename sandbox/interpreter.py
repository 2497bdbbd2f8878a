"""A program in Monty, the interpreter that programs run in. (`worker` starts it, `diagnosis` has it
check programs; nothing else knows it.)

Monty runs a program in a process of its own that can reach nothing: every use of `robot` suspends
it and comes here as an event, and it goes on when the event has been answered.

    with Interpreter(limits, on_print) as interpreter:
        event = interpreter.start(program)
        while not isinstance(event, Ended):
            event = interpreter.answer(...)         # or .fail("ValueError", "what went wrong")

All of it belongs to one thread but `kill`, which any thread may call at any time.
"""

from __future__ import annotations

import bisect
import re
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import TracebackType
from typing import Any, Final, Literal, Self

import msgspec
import pydantic_monty as monty

from robot_api.errors import cause
from robot_api.values import Clock, Location
from sandbox.limits import Limits
from sandbox.process import Process
from sandbox.rounds import counted
from sandbox.source import unix_newlines, with_values
from sandbox.worker import FAILURES, Unavailable, Worker

# --- what comes out ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Asked:
    """The program calls a robot method, or something that does not exist (`known` is False)."""

    method: str
    positional: tuple[Any, ...]
    named: dict[str, Any]
    line: int
    known: bool = True


@dataclass(frozen=True)
class Slept:
    """The program calls `time.sleep`."""

    seconds: float
    line: int


@dataclass(frozen=True)
class Ended:
    """The program has come to its end."""


Event = Asked | Slept | Ended


class ProgramError(Exception):
    """The program raised an exception that it did not catch."""

    def __init__(self, kind: str, message: str, line: int | None) -> None:
        super().__init__(message)
        self.kind = kind
        self.message = message
        self.line = line


class LimitReached(Exception):
    """The program used up what it may use: "computing", "rounds", "memory", "calls" or "output"."""

    def __init__(self, what: Literal["computing", "rounds", "memory", "calls", "output"]) -> None:
        super().__init__(what)
        self.what = what


class Killed(Exception):
    """The process of the program is gone: by `kill`, by a fault, or (`interrupted`) by a signal
    that asks programs to end, such as the terminal sends at Ctrl-C to all that it started."""

    def __init__(self, message: str, interrupted: bool = False) -> None:
        super().__init__(message)
        self.interrupted = interrupted


# --- values that cross ---------------------------------------------------------------------------

# What robot methods return beyond plain data. Defined inside, since only objects made there have
# a `str()` of their own; `source.with_values` puts the two functions around the calls.
_PRELUDE: Final = """
from dataclasses import dataclass

@dataclass(frozen=True)
class Location:
    x: float
    y: float
    theta: float = 0.0
    place: str | None = None

    def __str__(self):
        return self.place if self.place else f"{self.x:.2f}, {self.y:.2f}"

@dataclass(frozen=True)
class Clock:
    time: str
    weekday: str
    date: str
    zone: str = ""

    def __str__(self):
        return self.time

def _robot_location(given, make=Location):
    return make(given.x, given.y, given.theta, given.place)

def _robot_clock(given, make=Clock):
    return make(given.time, given.weekday, given.date, given.zone)
"""

# What `rounds.counted` puts into a program.
_COUNTING: Final = """
_robot_rounds = 0

def _robot_tick(limit=limit):
    global _robot_rounds
    _robot_rounds += 1
    if _robot_rounds > {rounds}:
        limit.reached()
"""


class _Robot:
    """Stands for the robot inside; its methods are answered here, none is called."""


_Robot.__name__ = "Robot"


class _Limit:
    """Stands inside for whoever counts the rounds; a call ends the program."""

    def reached(self) -> None:
        """Answered here, as all calls are."""


def _inward(value: Any) -> Any:
    """A result as it is handed to the program."""
    if isinstance(value, Location):
        return monty.ClassInstance(value, eager_attrs=("x", "y", "theta", "place"))
    if isinstance(value, Clock):
        return monty.ClassInstance(value, eager_attrs=("time", "weekday", "date", "zone"))
    return msgspec.to_builtins(value)


def _outward(value: Any, depth: int = 20) -> Any:
    """An argument as plain data, a `Location` or a `Clock`. Raises `ValueError` for anything else:
    a function, an object of the program's own, a list within itself, a number beyond 64 bits."""
    if depth == 0:
        raise ValueError("a list within a list within a list, without end")
    match value:
        case None | bool() | str() | Location() | Clock():
            return value
        case int() if abs(value) < 2**63:
            return value
        case int():
            raise ValueError("a number that is too large")
        case float():
            return value
        case list() | tuple() | set() | frozenset():
            return [_outward(item, depth - 1) for item in value]
        case dict():
            return {str(key): _outward(item, depth - 1) for key, item in value.items()}
        case monty.MontyClassProxy(name="Location"):
            return Location(**value.attributes)
        case monty.MontyClassProxy(name="Clock"):
            return Clock(**value.attributes)
        case _:
            raise ValueError("something that is no text, number or list")


# --- running -------------------------------------------------------------------------------------

Answer = Mapping[str, Any]


class Interpreter:
    """A process for one program. A context manager; on leaving, the process is gone."""

    def __init__(
        self,
        limits: Limits,
        on_print: Callable[[str], None],
        seed: int | None = None,
        on_death: Callable[[bool], None] | None = None,
    ) -> None:
        """`on_death(interrupted)` is called, on a thread of its own, when something else ends the
        process; `interrupted` if that was a signal such as that of Ctrl-C."""
        self._limits = limits
        self._on_print = on_print
        self._on_death = on_death
        self._printed = 0
        self._fault: BaseException | None = None
        self._seed = seed
        self._lock = threading.Lock()
        self._worker: Worker | None = None
        self._process: Process | None = None
        self._killed = False
        self._snapshot: Any = None
        self._robot = monty.ClassInstance(_Robot(), allowed_methods="all")
        self._limit = monty.ClassInstance(_Limit(), allowed_methods="all")
        self._line_starts: list[int] = []
        self._file = ""
        """What Monty calls the program."""
        self._line = 1

    def __enter__(self) -> Self:
        try:
            self._worker = Worker(self._check_out, limits=self._limits)
        except FAILURES as error:
            raise Unavailable(cause(error)) from error
        with self._lock:
            self._process = Process(self._worker.process, self._died)
            if self._killed:
                self._process.kill()
        return self

    def _check_out(self, pool: monty.Monty) -> monty.MontySession:
        limits = self._limits
        return pool.checkout(
            limits={
                "max_turn_duration_secs": limits.computing,
                "max_feed_duration_secs": limits.total_computing,
                "max_memory": limits.memory,
                "max_recursion_depth": limits.depth,
                # Calls are counted by whoever answers them; looking up names counts here, too.
                "max_suspensions": 3 * limits.calls + 1000,
            },
            os_policy={
                "sleep": "call_host",
                **({} if self._seed is None else {"random_start": {"seed": self._seed}}),
            },
        )

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        # A program that was left in the middle must not go on: no leaving before it is dead.
        self.kill()
        with self._lock:
            process, self._process = self._process, None
        if process is not None:
            process.close()  # which waits for whoever is told of its end
        self._snapshot = None
        if self._worker is not None:
            self._worker.close()

    @property
    def layers(self) -> frozenset[str]:
        """The layers of the wall around the process (`sandbox.confinement`) that hold."""
        return self._worker.layers if self._worker is not None else frozenset()

    def kill(self) -> None:
        """End the program's process now, whatever it does; from any thread."""
        with self._lock:
            self._killed = True
            if self._process is not None:
                self._process.kill()

    def _died(self, interrupted: bool) -> None:
        with self._lock:
            unasked = not self._killed
        if unasked and self._on_death is not None:
            self._on_death(interrupted)

    def start(self, program: str) -> Event:
        """Run the program to its first event. Raises as `answer` does, and `SyntaxError`."""
        source = with_values(unix_newlines(program))
        rounds = self._limits.rounds
        if rounds is not None:
            source = counted(source)
        encoded = source.encode()
        self._line_starts = [0, *(place + 1 for place, byte in enumerate(encoded) if byte == 10)]
        assert self._worker is not None, "enter the interpreter first"
        session = self._worker.session

        def start() -> Any:
            session.feed_run(_PRELUDE, print_callback=self._printed_text)
            self._file = "<python-input-1>"
            if rounds is not None:
                counting = _COUNTING.format(rounds=rounds)
                session.feed_run(counting, inputs={"limit": self._limit})
                self._file = "<python-input-2>"
            return session.feed_start(
                source, inputs={"robot": self._robot}, print_callback=self._printed_text
            )

        return self._turn(start)

    def answer(self, value: Any) -> Event:
        """Hand the program the result of what it asked for and run it to its next event.

        Raises `ProgramError`, `LimitReached` or `Killed`; the program is over then.
        """
        return self._resume({"return_value": _inward(value)})

    def fail(self, kind: str, message: str) -> Event:
        """Raise an exception (a built-in one's name) in the program instead."""
        return self._resume({"exc_type": kind, "message": message})

    def _resume(self, answer: Answer) -> Event:
        return self._turn(lambda: self._snapshot.resume(answer))

    def _turn(self, go: Callable[[], Any]) -> Event:
        try:
            self._snapshot = go()
            while (event := self._event()) is None:
                pass
        except monty.MontyError as error:
            raise self._told(error) from None
        return event

    def _event(self) -> Event | None:
        """What the program stopped for; None if that was answered here."""
        match self._snapshot:
            case monty.MontyComplete():
                return Ended()
            case monty.FunctionSnapshot(is_os_function=True) as asked:
                self._line = self._line_of(asked.position)
                if asked.function_name == "time.sleep":
                    return Slept(float(asked.args[0]), self._line)
                self._snapshot = asked.resume_not_handled()
                return None
            case monty.FunctionSnapshot() as asked:
                if asked.object_id == self._limit.id:
                    raise LimitReached("rounds")
                self._line = self._line_of(asked.position)
                known = asked.object_id == self._robot.id
                try:
                    positional = tuple(_outward(each) for each in asked.args)
                    named = {name: _outward(each) for name, each in asked.kwargs.items()}
                except (ValueError, TypeError) as error:
                    message = f"robot.{asked.function_name} was given {error}."
                    self._snapshot = asked.resume({"exc_type": "TypeError", "message": message})
                    return None
                return Asked(str(asked.function_name), positional, named, self._line, known)
            case unknown:
                # A name, or an attribute of the robot, that does not exist.
                self._snapshot = unknown.resume()
                return None

    def _line_of(self, position: monty.SourceRange) -> int:
        if position.filename == self._file:
            return bisect.bisect_right(self._line_starts, position.start)
        return self._line  # within an eval()

    def _printed_text(self, stream: str, text: str) -> None:
        self._printed += len(text.encode())
        if self._printed > self._limits.output:
            self._fault = self._fault or LimitReached("output")
        try:
            if self._fault is None:
                self._on_print(text)
        except BaseException as error:  # noqa: BLE001 - it is raised again where it can be caught
            self._fault = error
        if self._fault is not None:
            self.kill()

    def _told(self, error: monty.MontyError) -> BaseException:
        """The error in our own terms."""
        if self._fault is not None:
            return self._fault
        if self._killed:
            return Killed("The program was ended.")
        inner = error.exception()
        text = shortened(str(inner))
        if isinstance(error, monty.MontyCrashedError):
            if error.timed_out:
                return LimitReached("computing")
            return _broken(str(error)) or Killed(text, bool(_INTERRUPTED.search(str(error))))
        if "time limit exceeded" in text and isinstance(inner, TimeoutError):
            return LimitReached("computing")
        if isinstance(inner, MemoryError):
            return LimitReached("memory")
        if text.startswith("suspension limit "):
            return LimitReached("calls")
        if isinstance(error, monty.MontySyntaxError):
            return ProgramError("SyntaxError", text, self._last_line(error.traceback()))
        frames = error.traceback() if isinstance(error, monty.MontyRuntimeError) else []
        # "KeyError: 'x'" is how Monty shows it; only the name of the class is needed of that.
        kind = str(error).partition(":")[0]
        return ProgramError(kind, text, self._last_line(frames))

    def _last_line(self, frames: list[monty.Frame]) -> int | None:
        lines = [frame.line for frame in frames if frame.filename == self._file]
        return lines[-1] if lines else None


_INTERRUPTED: Final = re.compile(r"\(SIG(INT|TERM|HUP)\)")
_TOO_LONG: Final = re.compile(r"\(SIGXCPU\)")
_BROKEN: Final = re.compile(r"\(SIG(ABRT|SEGV|BUS|ILL|TRAP)\)")


def _broken(how: str) -> LimitReached | None:
    """If a process ended by itself: the limit of the system that it came up against, beyond the
    interpreter's own. One that is given no more memory breaks down."""
    if _TOO_LONG.search(how):
        return LimitReached("computing")
    return LimitReached("memory") if _BROKEN.search(how) else None


MOST_TOLD: Final = 2000
"""Letters of what a program's error says: it is kept in the log, and people read it."""


def shortened(text: str) -> str:
    return text if len(text) <= MOST_TOLD else f"{text[:MOST_TOLD]} …"
