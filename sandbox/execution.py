"""One run of a program: started, watched line by line, paused, stepped, stopped.

    execution = Execution(program, call, on_line=show)
    outcome = execution.run()                    # blocks; `pause`, `stop` ... from other threads

Every `robot.method(...)` of the program becomes `call(method, arguments, line)` on the thread of
`run`: what it returns is the result inside, what it raises is raised inside. The program can catch
a robot's error (`except Exception as problem`), as a RuntimeError with the robot's sentence as its
text; of the error's class only the `Outcome` knows. A stop it cannot catch.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final, Literal

from robot_api.errors import InvalidCall, RobotError, Stopped
from robot_api.methods import METHODS
from robot_api.schema import read_arguments, read_result
from sandbox.check import check, syntax_finding
from sandbox.interpreter import (
    Asked,
    Ended,
    Event,
    Interpreter,
    Killed,
    LimitReached,
    ProgramError,
    Slept,
)
from sandbox.limits import MAX_PROGRAM, Limits
from sandbox.sentences import UNAVAILABLE, problem
from sandbox.visits import CLOSED, METHOD, going_on
from sandbox.worker import Unavailable

__all__ = ["CallRecord", "Execution", "Limits", "Outcome"]

RobotCall = Callable[[str, dict[str, Any], int], Any]
"""call(method, arguments, line) -> plain data, a `Location` or a `Clock`."""


@dataclass(frozen=True)
class Outcome:
    """How a run ended."""

    status: Literal["done", "stopped", "failed", "limit"]
    message: str
    """One or two sentences for the user."""
    line: int | None = None
    """The line that the program was at; None if it came to its end, or before it began."""
    error: str | None = None
    """Of a failure its name: of a robot's error ("Blocked") or of Python's ("NameError"); of a
    limit which one: "computing", "rounds", "memory", "calls", "output"."""
    calls: int = 0
    """How many robot calls were made."""


@dataclass(frozen=True)
class CallRecord:
    """A robot call that has ended."""

    method: str
    arguments: dict[str, Any]
    line: int
    seconds: float
    """How long it took, in real time."""
    result: Any = None
    error: str | None = None
    """The name of the error it raised."""
    message: str | None = None


_LIMITS: Final = {
    "computing": "The program computed for longer than a robot should wait. "
    "Put a robot call, such as robot.wait(1), into its loops.",
    "rounds": "The program computed more than it may without coming to its end. "
    "Let its loops go round less often.",
    "memory": "The program needs more memory than it may use. Let it keep fewer or shorter things.",
    "calls": "The program made more robot calls than it may. Put robot.wait(1) into its loops.",
    "output": "The program printed more than it may. Let it print less.",
}


DIED: Final = "The program's process was ended by something else. Run it once more."


class Execution:
    """One run of one program. `run` can be called once; all else from any thread, at any time."""

    def __init__(
        self,
        program: str,
        call: RobotCall,
        *,
        limits: Limits | None = None,
        stub: str | None = None,
        seed: int | None = None,
        on_line: Callable[[int], None] | None = None,
        on_print: Callable[[str], None] | None = None,
        on_call: Callable[[CallRecord], None] | None = None,
        on_hold: Callable[[], None] | None = None,
        on_closed: Callable[[str, str], None] | None = None,
        on_death: Callable[[], None] | None = None,
    ) -> None:
        """`on_line(line)` is called before each robot call and before a pause at it, `on_call`
        after it, `on_hold()` when the program waits again after a step, `on_print` with what the
        program prints, `on_closed(place, why)` when a place of a round is left out (see
        `sandbox.visits`); all on the thread of `run`. `on_death()` is called on a thread of its own
        when something else ends the program's process: whoever makes a robot call for it then has
        to break that off, and `run` ends with "failed". With a `stub`, a program that does not pass
        `sandbox.check` against it fails before it begins.
        With a `seed`, `random` gives the same numbers in every run.
        """
        self._program = program
        self._call = call
        self._limits = limits or Limits()
        self._stub = stub
        self._on_line = on_line
        self._on_call = on_call
        self._on_hold = on_hold
        self._on_closed = on_closed
        self._visits: frozenset[int] = frozenset()
        self._closed: tuple[str, str, int] | None = None
        self._visited = False
        self._on_death = on_death
        self._dead = False
        self._interpreter = Interpreter(self._limits, on_print or _ignore, seed, self._died)
        self._changed = threading.Condition()
        self._started = False
        self._paused = False
        self._steps = 0
        self._stepped = False
        self._stopped: str | None = None
        self._calls = 0
        self._line: int | None = None
        self._raised: tuple[str, str] | None = None

    # --- from any thread -------------------------------------------------------------------------

    def pause(self) -> None:
        """Hold the program before its next robot call. The call at hand is not broken off."""
        with self._changed:
            self._paused = True
            self._changed.notify_all()

    def hold(self) -> None:
        """Wait as long as the program is paused, but for a step; for whoever makes a robot call
        and was asked to break it off. Raises `Stopped`."""
        self._wait_while_paused()

    def step(self) -> None:
        """Make one robot call, then hold again."""
        with self._changed:
            self._paused = True
            self._steps += 1
            self._changed.notify_all()

    def resume(self) -> None:
        """Go on after a pause."""
        with self._changed:
            self._paused = self._stepped = False
            self._steps = 0
            self._changed.notify_all()

    def stop(self, because: str = "The program was stopped.") -> None:
        """End the program now; it cannot catch that. A robot call at hand has to be broken off by
        whoever makes it (`Robot.cancel`, a driver's stop flag): `run` returns as soon as it has
        ended."""
        with self._changed:
            if self._stopped is None:
                self._stopped = because
            self._changed.notify_all()
        self._interpreter.kill()

    def _died(self, interrupted: bool) -> None:
        self._dead = not interrupted  # somebody pressed Ctrl-C, and is heard elsewhere too
        if self._stopped is None and self._on_death is not None:
            self._on_death()

    # --- running ---------------------------------------------------------------------------------

    def run(self) -> Outcome:
        """Run the program to its end, and say how it ended. Raises nothing but what `on_line` and
        the other callbacks raise, or `call` beyond `RobotError` and `Stopped`."""
        if self._started:
            raise RuntimeError("An Execution runs once; make a new one.")
        self._started = True
        unfit = self._unfit()
        if unfit is not None:
            return unfit
        try:
            with self._interpreter as interpreter:
                program, self._visits = going_on(self._program)
                event = interpreter.start(program)
                while not isinstance(event, Ended):
                    event = self._handle(interpreter, event)
        except Stopped as error:
            if self._dead:  # what stopped it came of that
                return self._ended("failed", DIED, self._line, "killed")
            return self._ended("stopped", self._stopped or error.because, self._line)
        except Killed as error:
            if error.interrupted or (self._stopped is not None and not self._dead):
                because = self._stopped or "The program was interrupted."
                return self._ended("stopped", because, self._line)
            return self._ended("failed", DIED, self._line, "killed")
        except Unavailable:
            return self._ended("failed", UNAVAILABLE, None, "unavailable")
        except LimitReached as error:
            return self._ended("limit", _LIMITS[error.what], self._line, error.what)
        except ProgramError as error:
            if self._stopped is not None:
                return self._ended("stopped", self._stopped, self._line)
            return self._failed(error)
        if self._closed is not None and not self._visited:  # there was no round
            name, message, line = self._closed
            return self._ended("failed", message, line, name)
        return self._ended("done", "The program has come to its end.", None)

    def _unfit(self) -> Outcome | None:
        """Why the program cannot even begin."""
        if self._stopped is not None:
            return self._ended("stopped", self._stopped, None)
        if len(self._program.encode(errors="replace")) > MAX_PROGRAM:
            message = f"The program is longer than {MAX_PROGRAM // 1000} kB. Make it shorter."
            return self._ended("limit", message, None, "memory")
        if self._stub is None:
            syntax = syntax_finding(self._program)
            findings = [syntax] if syntax else []
        else:
            findings = check(self._program, self._stub)
        for finding in findings:
            if finding.severity == "error":
                return self._ended("failed", finding.message, finding.line, finding.code)
        return None

    def _handle(self, interpreter: Interpreter, event: Event) -> Event:
        """Do what the program asks for, and run it to what it asks for next."""
        match event:
            case Asked(known=False) as asked:
                message = f"There is nothing called {asked.method}."
                return interpreter.fail("NameError", message)
            case Asked() as asked:
                return self._robot_call(interpreter, asked)
            case Slept(seconds, line):
                arguments = (max(0.0, seconds),)
                return self._robot_call(interpreter, Asked("wait", arguments, {}, line))
            case Ended():
                return event

    def _robot_call(self, interpreter: Interpreter, asked: Asked) -> Event:
        self._line = asked.line
        if self._on_line is not None:
            self._on_line(asked.line)
        self._wait_while_paused()
        self._calls += 1
        if self._calls > self._limits.calls:
            raise LimitReached("calls")
        arguments: dict[str, Any] = {}
        begun = time.monotonic()
        try:
            arguments = read_arguments(asked.method, asked.positional, asked.named)
            result = self._call(asked.method, arguments, asked.line)
            result = read_result(METHODS[asked.method], result)
        except RobotError as error:
            name, message = type(error).__name__, str(error)
            self._record(asked, arguments, begun, error=name, message=message)
            self._check_stopped()
            if asked.line in self._visits and asked.method == METHOD and type(error) in CLOSED:
                self._closed = self._closed or (name, message, asked.line)
                if self._on_closed is not None:
                    self._on_closed(str(arguments.get("place")), message)
                return interpreter.answer(False)
            self._raised = (name, message)
            return interpreter.fail(_python_error(error, asked.method), message)
        except Stopped as error:
            self._record(asked, arguments, begun, error="Stopped", message=error.because)
            raise
        self._record(asked, arguments, begun, result=result)
        self._check_stopped()
        self._visited = self._visited or (asked.line in self._visits and asked.method == METHOD)
        return interpreter.answer(result)

    def _wait_while_paused(self) -> None:
        with self._changed:
            if self._stepped and self._paused and not self._steps:
                self._stepped = False
                if self._on_hold is not None:
                    self._on_hold()
            self._changed.wait_for(
                lambda: not self._paused or self._steps > 0 or self._stopped is not None
            )
            if self._paused and self._steps > 0:
                self._steps -= 1
                self._stepped = True
        self._check_stopped()

    def _check_stopped(self) -> None:
        if self._stopped is not None:
            raise Stopped(self._stopped)

    def _record(
        self,
        asked: Asked,
        arguments: dict[str, Any],
        begun: float,
        result: Any = None,
        error: str | None = None,
        message: str | None = None,
    ) -> None:
        if self._on_call is not None:
            seconds = time.monotonic() - begun
            self._on_call(
                CallRecord(asked.method, arguments, asked.line, seconds, result, error, message)
            )

    # --- the end ---------------------------------------------------------------------------------

    def _ended(
        self,
        status: Literal["done", "stopped", "failed", "limit"],
        message: str,
        line: int | None,
        error: str | None = None,
    ) -> Outcome:
        return Outcome(status, message, line, error, self._calls)

    def _failed(self, error: ProgramError) -> Outcome:
        line = error.line or self._line
        if self._raised is not None and error.message == self._raised[1]:
            name, message = self._raised
        else:
            name, message = error.kind, problem(error.kind, error.message)
        return self._ended("failed", message, line, name)


def _python_error(error: RobotError, method: str) -> str:
    """The name of the built-in exception that a program sees."""
    if method not in METHODS:
        return "AttributeError"
    return "TypeError" if isinstance(error, InvalidCall) else "RuntimeError"


def _ignore(text: str) -> None:
    """Nobody wants to know."""
