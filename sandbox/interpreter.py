"""The one module that knows Monty, the interpreter that programs run in.

Monty runs a program in a process of its own that can reach nothing: every use of `robot` suspends
it and comes here as an event, and it goes on when the event has been answered.

    with Interpreter(limits, on_print) as interpreter:
        event = interpreter.start(program)
        while not isinstance(event, Ended):
            event = interpreter.answer(...)         # or .fail("ValueError", "what went wrong")

All of it belongs to one thread but `kill`, which any thread may call at any time.
"""

from __future__ import annotations

import atexit
import bisect
import json
import os
import re
import select
import signal
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
from sandbox.rounds import counted
from sandbox.source import unix_newlines, with_values

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


class Unavailable(Exception):
    """The interpreter does not start on this machine."""


@dataclass(frozen=True)
class Diagnostic:
    """What the type checker says of a program, in its own words; line and column count from 1."""

    line: int
    column: int
    code: str
    message: str


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

    def __str__(self):
        return self.time

def _robot_location(given, make=Location):
    return make(given.x, given.y, given.theta, given.place)

def _robot_clock(given, make=Clock):
    return make(given.time, given.weekday, given.date)
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
        return monty.ClassInstance(value, eager_attrs=("time", "weekday", "date"))
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
        self._pool = monty.Monty(max_processes=1)
        self._session: monty.MontySession | None = None
        self._process: _Process | None = None
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
            self._pool.__enter__()
            self._check_out()
        except (monty.MontyError, RuntimeError, OSError) as error:
            self.__exit__(None, None, None)
            raise Unavailable(cause(error)) from error
        return self

    def _check_out(self) -> None:
        limits = self._limits
        self._session = self._pool.checkout(
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
        self._session.__enter__()
        pid = self._session.worker_pid
        assert pid is not None
        with self._lock:
            self._process = _Process(pid, self._died)
            if self._killed:
                self._process.kill()

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
        if self._session is not None:
            self._session.__exit__(None, None, None)
        self._pool.__exit__(None, None, None)

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
        session = self._session
        assert session is not None, "enter the interpreter first"

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
            return Killed(text, bool(re.search(r"\(SIG(INT|TERM|HUP)\)", str(error))))
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


MOST_TOLD: Final = 2000
"""Letters of what a program's error says: it is kept in the log, and people read it."""


def shortened(text: str) -> str:
    return text if len(text) <= MOST_TOLD else f"{text[:MOST_TOLD]} …"


_INTERRUPTING: Final = (signal.SIGINT, signal.SIGTERM, getattr(signal, "SIGHUP", None))


class _Process:
    """The process of a program, held so that no other process can be hit when it is gone."""

    def __init__(self, pid: int, died: Callable[[bool], None]) -> None:
        """`died(interrupted)` is called when it has ended, where the system tells of that (on
        Linux)."""
        self._pid = pid
        self._handle = os.pidfd_open(pid) if hasattr(os, "pidfd_open") else None
        self._watch: threading.Thread | None = None
        if self._handle is not None:
            self._watch = threading.Thread(
                target=_when_readable, args=(self._handle, died), name="program", daemon=True
            )
            self._watch.start()

    def kill(self) -> None:
        try:
            if self._handle is not None:
                signal.pidfd_send_signal(self._handle, signal.SIGKILL)
            else:
                os.kill(self._pid, getattr(signal, "SIGKILL", signal.SIGTERM))
        except (ProcessLookupError, PermissionError):
            pass  # it is gone already

    def close(self) -> None:
        """After `kill`."""
        if self._handle is not None:
            if self._watch is not None and self._watch is not threading.current_thread():
                self._watch.join()
            os.close(self._handle)
            self._handle = None


def _when_readable(handle: int, died: Callable[[bool], None]) -> None:
    """A process is gone when its handle can be read."""
    waiting = select.poll()
    waiting.register(handle, select.POLLIN)
    waiting.poll()
    try:
        how = os.waitid(os.P_PIDFD, handle, os.WEXITED | os.WNOWAIT | os.WNOHANG)
    except ChildProcessError:  # somebody has asked before
        how = None
    died(how is not None and how.si_code == os.CLD_KILLED and how.si_status in _INTERRUPTING)


# --- checking ------------------------------------------------------------------------------------


def diagnose(program: str, stub: str, seconds: float = 60.0) -> list[Diagnostic]:
    """What Monty's parser and type checker say of a program; nothing of it is run. A check takes
    milliseconds; after so many `seconds` by the clock on the wall it is given up, far above what a
    busy machine needs. Raises `Unavailable`."""
    with CHECKER as kept:
        try:
            try:
                return _diagnosed(program, stub, kept.pool(seconds))
            except monty.MontyCrashedError as error:
                if error.timed_out:
                    raise
                kept.close()  # Ctrl-C ends the worker as well, wherever it was at
                return _diagnosed(program, stub, kept.pool(seconds))
        except monty.MontyCrashedError as error:
            kept.close()
            if not error.timed_out:
                raise Unavailable(cause(error)) from error
            message = "CheckError: The program is too involved to be checked. Make it simpler"
            return [Diagnostic(1, 1, "unsupported", message)]
        except (monty.MontyError, RuntimeError, OSError) as error:
            kept.close()
            raise Unavailable(cause(error)) from error


class Checker:
    """The worker that checks programs, kept for the next one: to start it takes forty times as long
    as a check."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._pool: monty.Monty | None = None
        self._of: tuple[int, float] | None = None
        """The process that it belongs to, which a fork is not, and its seconds for a check."""

    def __enter__(self) -> Self:
        self._lock.acquire()
        return self

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    def pool(self, seconds: float) -> monty.Monty:
        """The worker's pool; to be asked for under the lock."""
        of = (os.getpid(), seconds)
        if self._pool is None or self._of != of:
            if self._of is not None and self._of[0] == of[0]:
                self.close()
            self._pool, self._of = monty.Monty(max_processes=1, request_timeout=seconds), of
            self._pool.__enter__()
        return self._pool

    def close(self) -> None:
        """Let go of the worker; the next check starts another."""
        pool, self._pool = self._pool, None
        if pool is not None and self._of is not None and self._of[0] == os.getpid():
            pool.__exit__(None, None, None)


CHECKER: Final = Checker()
atexit.register(CHECKER.close)


def _diagnosed(program: str, stub: str, pool: monty.Monty) -> list[Diagnostic]:
    # The name is looked up before anything else happens, and never found.
    guard = "program_starts_here"
    with (
        pool.checkout(
            limits={"max_memory": 200_000_000},
            type_check=True,
            type_check_stubs=f"{stub}\n{guard}: int\n",
            type_check_format="json",
        ) as session,
    ):
        try:
            snapshot = session.feed_start(f"{guard}\n{program}")
            while isinstance(snapshot, monty.FunctionSnapshot) and snapshot.is_os_function:
                snapshot = snapshot.resume_not_handled()  # stubs of modules that do not exist
        except monty.MontyTypingError as error:
            return [
                Diagnostic(
                    each["location"]["row"] - 1,
                    each["location"]["column"],
                    each["code"],
                    each["message"],
                )
                for each in json.loads(error.display())
                if each["severity"] == "error"
            ]
        except monty.MontyCrashedError:
            raise
        except monty.MontyError as error:
            frames: list[monty.Frame] = getattr(error, "traceback", list)()
            line = frames[-1].line - 1 if frames else 1
            column = frames[-1].column if frames else 1
            return [Diagnostic(max(1, line), column, "unsupported", str(error))]
    return []
