"""One run of an approved program on the robot: from its first call until its end is logged.

    performance = Performance(run, approval, means)
    performance.begin()                     # in a thread of its own
    performance.pause(); performance.resume(); performance.stop("Somebody stopped it.")
    performance.over.wait()

What is not logged is not done: each call is written down before it is made. A pause breaks off what
turns the wheels, and makes the rest of it when the program goes on.
"""

from __future__ import annotations

import contextlib
import dataclasses
import logging
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import msgspec

from grammar.language import languages, load_language
from grammar.naming import naming
from nl2robot.knowledge import Knowledge
from nl2robot.review.sought import Sought
from nl2robot.run import state as happenings
from nl2robot.run.going_on import Recall
from nl2robot.run.pausing import (
    DRIVING,
    MEASURED,
    Made,
    Odometer,
    comes_to_rest,
    pose_of,
    rest_of,
)
from nl2robot.run.present import Present
from nl2robot.run.runlog import LogError, RunLog
from nl2robot.run.runs import Approval, State, Status
from nl2robot.run.sightings import Sightings
from nl2robot.run.spoken_language import SpokenLanguage
from nl2robot.run.state import HELD, PAUSED
from nl2robot.run.trouble import told
from robot_api.client import Robot
from robot_api.errors import LostConnection, NotPossible, RobotError, StopNotConfirmed, Stopped
from sandbox.execution import Execution, Outcome

_log = logging.getLogger(__name__)

SECONDS_TO_REST: Final = 2.0
"""How long a paused robot may take to stand, beside what it says of a stop. Then it is stopped."""
BREAK_OFF_EVERY: Final = 0.02
"""Seconds between two attempts to break off a robot call of a program that was stopped."""

_HALTED = "The movement was halted; what is left of it is made when the program goes on."
LETTERS_LOGGED: Final = 20_000_000
"""Of the arguments and results of a run: what fills a disk is ended before."""
_TOO_MUCH_LOGGED = (
    "The program has the robot say and show more than the log of one run holds. Let it do less."
)
_DOES_NOT_REST = "The robot did not come to rest when it was paused, so it was stopped."


@dataclass(frozen=True)
class Means:
    """What a run needs: `connect` opens a client to the robot, `publish(kind, data)` tells those
    who watch."""

    knowledge: Knowledge
    connect: Callable[[], Robot]
    log: RunLog
    publish: Callable[[str, Mapping[str, Any]], None]
    present: Present
    """How the robot and its program stand."""
    spoken: SpokenLanguage
    sightings: Sightings
    """Whom and what the robot has seen just now."""
    seed: int | None


class _BrokenOff(Exception):
    """A pause has broken off the call at hand."""


class Performance:
    """A run that goes on, or that did. Any thread may use it."""

    def __init__(
        self,
        run: int,
        approval: Approval,
        means: Means,
        recall: Recall | None = None,
        pose: Mapping[str, Any] | None = None,
    ) -> None:
        """`recall` is what was done before, if it goes on with another run; `pose` is where the
        robot was last, if that is known."""
        self.run = run
        self.approval = approval
        self.line: int | None = None
        self.over = threading.Event()
        """Set when the end is logged."""
        self._means = means
        self._present = means.present
        self._recall = recall
        self._pose = pose
        self._execution: Execution | None = None
        self._robot: Robot | None = None
        self._calls = 0
        self._letters = 0
        """Of arguments and results that are in the log."""
        self._outcome: Outcome | None = None
        """How the program ended; the run is over only when that is logged."""
        self._message: str | None = None
        self._ended: State | None = None
        """How, once it is over and logged."""
        self._stop_because: str | None = None
        """Set when it is to be stopped, maybe before it has begun."""
        self._lost_because: str | None = None
        """Set when the robot is lost meanwhile."""
        self._gate = threading.Lock()
        """Around what follows, and around whether it is to pause."""
        self._drives = False
        """Whether a call is in flight that turns the wheels."""
        self._broken_off = False
        """Whether a pause has broken that off."""
        self._odometer: Odometer | None = None
        """Of the movement that is measured."""
        self._broken_movement: tuple[int, Odometer] | None = None
        """The number of the last movement that came to no good end, and how much of it is made."""
        self._states: deque[tuple[float, str, str | None]] = deque()
        """Those that are not written down yet."""
        self._noted: str | None = None
        """The last of them all."""
        self._writing_states = threading.Lock()

    # --- from outside

    @property
    def goes_on(self) -> bool:
        """Whether the program has not come to its end."""
        return self._outcome is None

    def status(self) -> Status:
        """How it stands now."""
        return Status(
            run=self.run,
            state=self._ended or self._state(),
            line=self.line,
            message=self._message,
            error=self._outcome.error if self._outcome else None,
            program=self.approval.program,
            sha256=self.approval.sha256,
            calls=self._calls,
        )

    def begin(self) -> None:
        """Perform the program, in a thread of its own."""
        if self._present.happened(happenings.Began(self.run)).run != self.run:
            # It was stopped in this very moment.
            self._stop_because = self._present.state.because or "The robot was stopped."
        name = f"program {self.run}"
        threading.Thread(target=self._perform, name=name, daemon=True).start()

    def pause(self) -> None:
        """Halt the robot at once, and the program with it: a movement at hand is broken off, a
        sentence may end. It is `paused` when the robot has come to rest, until then `pausing`.
        Raises `NotPossible` if it does not go on, as do `step` and `resume`."""
        self._control(Execution.pause, happenings.PauseAsked())
        threading.Thread(target=self._halt, name="halt", daemon=True).start()

    def step(self) -> None:
        """Do one more robot call, or the rest of the one that was broken off, then pause again."""
        self._control(Execution.step, happenings.Resumed())

    def resume(self) -> None:
        """Go on: what was broken off goes on to its goal."""
        self._control(Execution.resume, happenings.Resumed())

    def stop(self, because: str) -> None:
        """End it; returns at once."""
        if self._outcome is not None or self._stop_because is not None:
            return
        self._stop_because = because
        self._present.happened(happenings.EndAsked(because))
        if self._execution is not None:
            self._execution.stop(because)
        if self._robot is not None:
            self._robot.cancel()
        threading.Thread(target=self._break_off, name="break off", daemon=True).start()

    def lose(self, because: str) -> None:
        """The robot is lost: the program ends with that, whatever it catches."""
        if self._outcome is None:
            self._lost_because = because
            if self._execution is not None:
                self._execution.stop(because)

    def note_pose(self, pose: Mapping[str, Any]) -> None:
        """Where the robot is (the data of the event `pose`)."""
        self._pose = pose
        odometer = self._odometer
        if odometer is not None:
            odometer.at(pose)

    def note_state(self, state: happenings.State) -> None:
        """How the robot and the program stand from now on. It is written down with what is logged
        next: nobody who stops the robot waits for a disk."""
        if state.state != self._noted:
            self._noted = state.state
            self._states.append((time.time(), state.state, state.because))

    def report(self, phrase: str, **about: str | Sequence[str]) -> None:
        """Tell something that the program itself does not, in the language of whoever approved it.
        Lists are of places, texts are sentences of the robot."""
        knowledge = self._means.knowledge
        code = self.approval.language or "en"
        pack = load_language(code if code in languages() else "en")
        lexicon = knowledge.lexicon(pack.code)
        called = naming(lexicon, pack).called
        gaps = {
            name: told(None, value, pack.code, lexicon)
            if isinstance(value, str)
            else ", ".join(map(called, value))
            for name, value in about.items()
        }
        with contextlib.suppress(Stopped):  # the next call finds that the log is full
            self._print(f"{pack.phrase(phrase, **gaps)}\n")

    # --- the program

    def _perform(self) -> None:
        try:
            with self._means.connect() as robot:
                self._robot = robot
                has = self._means.knowledge.capabilities
                self._means.spoken.adopt(
                    robot, self.approval.language, has.languages if has is not None else ()
                )
                self._outcome = self._as_lost(self._execute(robot))
                # A connection that is lost needs no stop: its server has stopped the robot, too.
                if self._outcome.status != "done" and robot.connected:
                    robot.stop()
                    self._note_where_it_stands(self._where(robot))
        except Stopped as stopped:  # before its first line, or while it was seen to its end
            if self._outcome is None:
                self._outcome = Outcome("stopped", str(stopped))
        except RobotError as error:  # the robot cannot be reached
            if self._outcome is not None:
                self._note_where_it_stands(self._pose)
            if self._outcome is not None and isinstance(error, StopNotConfirmed):
                self._outcome = _unconfirmed(self._outcome, error)
            if self._outcome is None:
                self._outcome = Outcome("failed", str(error), error=type(error).__name__)
        except Exception:  # noqa: BLE001 - told as a fault of this software
            _log.exception("run %s ended through a fault", self.run)
        finally:
            self._end()

    def _execute(self, robot: Robot) -> Outcome:
        recall = self._recall
        closed: list[tuple[str, str]] = []
        """The places of its rounds that could not be reached, each with the robot's sentence."""
        sought = Sought()

        def on_line(line: int) -> None:
            self.line = line
            self._present.happened(happenings.AtLine(line))
            self._tell("line")

        def call(method: str, arguments: dict[str, Any], line: int) -> Any:
            if recall is not None and recall.goes_on:
                return recall.answer(method, arguments)
            left = arguments if recall is None else recall.left_of(method, arguments)
            return sought.call(method, arguments, lambda: self._call(robot, method, left, line))

        def on_print(text: str) -> None:
            if recall is None or not recall.goes_on:  # else it was printed before
                self._print(text)

        execution = Execution(
            self.approval.program,
            call,
            seed=self._means.seed,
            on_line=on_line,
            on_print=on_print,
            on_hold=self._holds,
            on_closed=lambda place, why: closed.append((place, why)),
            on_death=self._stand,
        )
        self._execution = execution
        self._tell("state")
        if self._stop_because is not None:  # stopped before it began
            execution.stop(self._stop_because)
        outcome = execution.run()
        for place, why in closed:
            self.report("was_closed", place=[place], reason=why)
        return recall.judged(outcome) if recall is not None else outcome

    def _stand(self) -> None:
        """Nobody is left to see to what the robot does: it stands."""
        robot = self._robot
        if robot is not None:
            with contextlib.suppress(RobotError, Stopped):  # it is stopped once more at the end
                robot.stop()

    def _as_lost(self, outcome: Outcome) -> Outcome:
        """How a run ended whose robot was lost meanwhile: not by somebody's stop."""
        if self._lost_because is None or self._stop_because is not None:
            return outcome
        if outcome.status != "stopped":
            return outcome
        return dataclasses.replace(
            outcome, status="failed", message=self._lost_because, error=LostConnection.__name__
        )

    def _end(self) -> None:
        outcome = self._outcome or Outcome(
            status="failed", message="The run ended through a fault of this software."
        )
        message = None if outcome.status == "done" else outcome.message
        if outcome.line is not None:
            self.line = outcome.line
        try:
            self._log_states()
            self._means.log.end(self.run, outcome.status, message)
        except LogError as error:
            message = str(error)
            if outcome.status == "done":  # of which nobody will ever read
                outcome = dataclasses.replace(outcome, status="failed")
        self._message = message
        try:
            # Those who watch hear of the end before those who wait are told, and may ask why.
            self._tell("state", state=outcome.status)
        finally:
            # In this order: who finds it over may begin the next run.
            self._ended = outcome.status
            self._present.happened(happenings.Ended(self.run, outcome.status, message))
            self.over.set()

    # --- its calls

    def _call(self, robot: Robot, method: str, arguments: dict[str, Any], line: int) -> Any:
        """Make a robot call, in pieces if it is paused meanwhile."""
        left: dict[str, Any] | None = arguments
        while left is not None:
            self._begin_driving(robot, method)
            try:
                return self._logged_call(robot, method, left, line)
            except _BrokenOff:
                assert self._execution is not None
                with self._gate:
                    self._drives = False  # from now on nothing else is to be broken off
                # Nothing else moves it: it comes to rest even if it is to go on by now.
                self._come_to_rest(robot, lambda: self._stop_because is None)
                self._odometer = None
                made = self._note_made(self._where(robot))
                left = rest_of(method, left, made)
                self._execution.hold()
            finally:
                with self._gate:
                    self._drives, self._odometer = False, None
        return None

    def _logged_call(self, robot: Robot, method: str, arguments: dict[str, Any], line: int) -> Any:
        self._calls += 1
        number, log = self._calls, self._means.log
        written = msgspec.json.encode(arguments).decode()
        self._letters += len(written)
        if self._letters > LETTERS_LOGGED:
            raise Stopped(_TOO_MUCH_LOGGED)
        self._logged(log.call_begins, number, line, method, written)
        about = {"number": number, "method": method, "arguments": arguments}
        self._tell("call", **about)
        began = time.perf_counter()
        try:
            if self._stop_because is not None:
                raise Stopped(self._stop_because)
            result = getattr(robot, method)(**arguments)
        except (RobotError, Stopped) as error:
            seconds = time.perf_counter() - began
            broken_off = isinstance(error, Stopped) and self._was_broken_off()
            told = f"{PAUSED}: {_HALTED}" if broken_off else f"{type(error).__name__}: {error}"
            made = None
            if self._odometer is not None:
                self._broken_movement = number, self._odometer
                made = _on_paper(self._odometer.made)
            here = {"made": made, "place": self._place}
            self._logged(log.call_ends, number, seconds, error=told, **here)
            self._tell("result", **about, error=told, seconds=seconds)
            if broken_off:
                raise _BrokenOff from None
            raise
        seconds = time.perf_counter() - began
        told = msgspec.json.encode(result).decode()
        self._letters += len(told)
        place = self._place
        self._logged(log.call_ends, number, seconds, result=told, place=place)
        self._tell("result", **about, result=msgspec.to_builtins(result), seconds=seconds)
        self._means.sightings.note(method, arguments, result, place)
        if method == "stop":
            raise Stopped  # whoever stops the robot, its program is over
        return result

    @property
    def _place(self) -> str | None:
        """Where the robot is, by the name of the place; None if that has none, or nobody knows."""
        place = self._pose.get("place") if self._pose is not None else None
        return place if isinstance(place, str) else None

    def _note_made(self, here: Mapping[str, Any] | None) -> Made | None:
        """How much of the movement that was broken off last is made, now that the robot stands
        `here`. It is written down."""
        if self._broken_movement is None:
            return None
        (number, odometer), self._broken_movement = self._broken_movement, None
        if here is not None:
            odometer.at(here)
        made = _on_paper(odometer.made)
        if made is not None:
            self._logged(self._means.log.made, number, made)
        return odometer.made

    def _note_where_it_stands(self, here: Mapping[str, Any] | None) -> None:
        """The program was ended before its end: who goes on with it has to know from where. Of a
        robot that is lost that is where it was last."""
        with contextlib.suppress(Stopped):  # the log is full, which its end tells
            if here is not None:
                stood = msgspec.json.encode({each: here[each] for each in ("x", "y", "theta")})
                self._logged(self._means.log.stands_at, stood.decode())
            self._note_made(here)

    def _print(self, text: str) -> None:
        self._logged(self._means.log.printed, text)
        self._tell("print", text=text)

    def _logged(self, write: Callable[..., None], *values: Any, **more: Any) -> None:
        try:
            self._log_states()
            write(self.run, *values, **more)
        except LogError as error:
            # What is not logged is not done.
            raise Stopped(str(error)) from error

    def _log_states(self) -> None:
        """Raises `LogError`."""
        with self._writing_states:
            while self._states:
                self._means.log.state(self.run, *self._states.popleft())

    def _break_off(self) -> None:
        """Break off the calls of a stopped program until it is over: one may just be on its way to
        the robot, and reach it after the stop."""
        while not self.over.wait(BREAK_OFF_EVERY):
            if self._robot is not None and self._outcome is None:
                self._robot.cancel()

    # --- a pause

    def _begin_driving(self, robot: Robot, method: str) -> None:
        """Before a call that turns the wheels: not while they are to stand."""
        assert self._execution is not None
        while True:
            with self._gate:
                if not self._pauses():
                    self._broken_off = False
                    self._broken_movement = None
                    self._drives = method in DRIVING
                    break
            self._execution.hold()
        if method == "localize":
            self._pose = None  # it is elsewhere on the map than it was
        if method in MEASURED:
            self._odometer = Odometer(self._pose or self._where(robot))

    def _halt(self) -> None:
        """Break off what turns the wheels. Whoever made that call then sees to the rest; if there
        is none, we do."""
        robot = self._robot
        assert robot is not None
        while True:
            with self._gate:
                if not self._pauses() or self._present.state.state == "paused":
                    return
                if not self._drives:
                    break
                self._broken_off = True
                robot.cancel()
            if self.over.wait(BREAK_OFF_EVERY):
                return
        # Who broke off sees to it, unless what was to be broken off ended by itself in that moment.
        with contextlib.suppress(RobotError, Stopped):
            self._come_to_rest(robot, self._is_to_stand)

    def _is_to_stand(self) -> bool:
        """Whether a pause waits for a robot that nobody drives. If not, it may drive again: whoever
        broke off has seen it stand, and the program went on."""
        waits = self._stop_because is None and self._present.state.state == "pausing"
        return waits and not self._drives

    def _come_to_rest(self, robot: Robot, awaited: Callable[[], bool]) -> None:
        """Be sure that the robot stands, and say so; else stop it, unless that is not `awaited` any
        longer. Raises `Stopped`."""
        has = self._means.knowledge.capabilities
        if has is not None and self._knows_where:
            within = has.stop_within + SECONDS_TO_REST
            if not comes_to_rest(robot, within, awaited) and awaited():
                self.stop(_DOES_NOT_REST)
        if self._stop_because is not None:
            raise Stopped(self._stop_because)
        if not awaited():
            return
        if self._present.state.state == "pausing":
            self._present.happened(happenings.Halted())
            self._tell("state")

    def _holds(self) -> None:
        """The program waits again after a step, between two calls."""
        if self._present.state.state == "running":
            self._present.happened(happenings.PauseAsked())
            self._present.happened(happenings.Halted())
            self._tell("state")

    def _pauses(self) -> bool:
        now = self._present.state
        return now.run == self.run and now.state in HELD

    def _was_broken_off(self) -> bool:
        return self._broken_off and self._stop_because is None and self._lost_because is None

    def _where(self, robot: Robot) -> Mapping[str, Any] | None:
        """None if the robot does not know."""
        if not self._knows_where:
            return None
        with contextlib.suppress(RobotError, Stopped):
            return pose_of(robot.location())
        return None

    @property
    def _knows_where(self) -> bool:
        has = self._means.knowledge.capabilities
        return has is not None and "location" in has.methods

    # --- helpers

    def _control(self, act: Callable[[Execution], None], happening: happenings.Happening) -> None:
        if self._outcome is not None or self._execution is None:
            raise NotPossible("No program is running.")
        with self._gate:
            act(self._execution)
            self._present.happened(happening)
        self._tell("state")

    def _state(self) -> State:
        """Until it is over it goes on, whatever the robot is at."""
        match self._present.state.state:
            case "running" | "pausing" | "paused" as now:
                return now
        return "running"

    def _tell(self, what: str, **more: Any) -> None:
        data = {
            "what": what,
            "run": self.run,
            "state": self._ended or self._state(),
            "line": self.line,
            "message": self._message,
        }
        self._means.publish("program", {**data, **more})


def _on_paper(made: Made | None) -> str | None:
    """As the log has it."""
    return msgspec.json.encode(made).decode() if made is not None else None


def _unconfirmed(outcome: Outcome, error: StopNotConfirmed) -> Outcome:
    """How a run ended whose robot has not said that it stands: not "stopped"."""
    if outcome.status == "stopped":
        return dataclasses.replace(
            outcome, status="failed", message=str(error), error=type(error).__name__
        )
    return dataclasses.replace(outcome, message=f"{outcome.message} {error}")
