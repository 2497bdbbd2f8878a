"""The runner: approved programs, one at a time, on the robot.

It lives at the server, so that a program goes on when the client that started it leaves, and so
that the terminal, the web console and other clients see the same run. Every robot call of a program
goes through the client `Robot` over the wire, as anybody's would.

    translate -> check -> approve -> run -> (pause, step, resume, stop) -> over

An approval is bound to the hash of exactly one program and is used up by one run.
"""

from __future__ import annotations

import contextlib
import dataclasses
import logging
import secrets
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final, Literal

import msgspec

from grammar.language import languages, load_language
from grammar.naming import naming
from nl2robot import state as happenings
from nl2robot.going_on import Recall, Unfinished, unfinished
from nl2robot.history import Record, done_calls
from nl2robot.knowledge import Knowledge
from nl2robot.pausing import (
    DRIVING,
    MEASURED,
    PAUSED,
    Odometer,
    comes_to_rest,
    pose_of,
    rest_of,
)
from nl2robot.present import Present
from nl2robot.review import Review, digest, review
from nl2robot.runlog import LogError, RunLog
from robot_api.client import Robot
from robot_api.errors import (
    AccessDenied,
    LostConnection,
    NotPossible,
    RobotError,
    StopNotConfirmed,
    Stopped,
)
from sandbox.execution import Execution, Outcome
from sim.simulation import Simulation
from sim.world import World, builtin_worlds

_log = logging.getLogger("nl2robot.runner")

State = Literal["running", "pausing", "paused", "done", "failed", "stopped", "limit"]
GOING: Final = ("running", "pausing", "paused")
"""The states of a run that is not over."""

SECONDS_TO_REST = 2.0
"""How long a paused robot may take to stand, beside what it says of a stop. Then it is stopped."""
SECONDS_TO_END = 3.0
"""How long a stopped run may take to be over, beside what the robot takes to stand."""
BREAK_OFF_EVERY = 0.02
"""Seconds between two attempts to break off a robot call of a program that was stopped."""
APPROVALS_KEPT = 100
"""An approval that was not used is forgotten when so many newer ones were given."""


BUSY = "Another program is running. Wait until it is over, or stop it first."
UNCONFIRMED = (
    "The robot has not confirmed that it stands. Press STOP until it does; then approve it again."
)
_HALTED = "The movement was halted; what is left of it is made when the program goes on."
_DOES_NOT_REST = "The robot did not come to rest when it was paused, so it was stopped."


class _BrokenOff(Exception):
    """A pause has broken off the call at hand."""


class Approval(msgspec.Struct, frozen=True, kw_only=True):
    """Somebody's word that exactly this program may run once."""

    id: str
    program: str
    sha256: str
    by: str
    at: float
    """Seconds since the epoch."""
    utterance: str | None = None
    heard: str | None = None
    language: str | None = None
    plan: str | None = None
    continues: int | None = None
    """The run that was broken off, with which it goes on; what was done there is not done again."""
    proposed: str | None = None
    """The program that was proposed, if somebody changed it by hand."""
    changed_by: str | None = None


class Status(msgspec.Struct, frozen=True, kw_only=True):
    """How a run stands; what `program.state` and `program.wait` answer."""

    run: int
    state: State
    line: int | None
    message: str | None
    """Why it is not done, if it is over and is not."""
    error: str | None
    """What it failed with, as `sandbox.execution.Outcome.error`."""
    program: str
    sha256: str
    calls: int
    robot_lost_since: float | None = None
    """Seconds since the epoch; None while the robot can be reached."""


class _Activity:
    """A run that is going on, or the last that was."""

    def __init__(self, run: int, approval: Approval) -> None:
        self.run = run
        self.approval = approval
        self.execution: Execution | None = None
        self.robot: Robot | None = None
        self.ended: State | None = None
        """How, once it is over and logged."""
        self.line: int | None = None
        self.message: str | None = None
        self.calls = 0
        self.outcome: Outcome | None = None
        """How the program ended; the run is over only when that is logged."""
        self.over = threading.Event()
        self.stop_because: str | None = None
        """Set when it is to be stopped, maybe before it has begun."""
        self.lost_because: str | None = None
        """Set when the robot is lost meanwhile."""
        self.gate = threading.Lock()
        """Around what follows, and around whether it is to pause."""
        self.drives = False
        """Whether a call is in flight that turns the wheels."""
        self.broken_off = False
        """Whether a pause has broken that off."""
        self.odometer: Odometer | None = None
        """Of the movement that is measured."""
        self.recall: Recall | None = None
        """What was done before, if it goes on with another run."""

    def status(self, state: State) -> Status:
        return Status(
            run=self.run,
            state=self.ended or state,
            line=self.line,
            message=self.message,
            error=self.outcome.error if self.outcome else None,
            program=self.approval.program,
            sha256=self.approval.sha256,
            calls=self.calls,
        )


class Runner:
    """Reviews, approves and runs programs on one robot.

    `connect` opens a client to the robot; `stage` gives a copy of the simulated world for dry runs,
    or None where there is none; `publish(kind, data)` tells those who watch.
    """

    def __init__(
        self,
        *,
        knowledge: Knowledge,
        connect: Callable[[], Robot],
        log: RunLog,
        publish: Callable[[str, Mapping[str, Any]], None],
        stage: Callable[[], Simulation] | None = None,
        seed: int | None = None,
        present: Present | None = None,
    ) -> None:
        self.knowledge = knowledge
        self.present = present or Present(lambda state: None)
        """How the robot and its program stand."""
        self.log = log
        self._connect = connect
        self._publish = publish
        self._stage = stage
        self._seed = seed
        self._lock = threading.Lock()
        self._approvals: OrderedDict[str, Approval] = OrderedDict()
        self._activity: _Activity | None = None
        self._lost_since: float | None = None
        self._lost_because = ""
        self._pose: Mapping[str, Any] | None = None

    # --- before it runs

    def check(self, program: str, language: str = "en", continues: int | None = None) -> Review:
        """Review a program, and read it in a language; nothing moves. `continues`: only what is
        left of it after that run is tried. Raises `NotPossible` if nothing is."""
        recall = self._recall(continues, program) if continues is not None else None
        return review(program, self.knowledge, self._stage, language, self._seed, recall)

    def unfinished(self, run: int | None = None) -> Unfinished | None:
        """What is left of that run, or of the last one, if it was broken off."""
        if self.present.state.run is not None:
            return None
        return unfinished(self.log, run)

    def approve(
        self,
        program: str,
        sha256: str,
        by: str,
        *,
        utterance: str | None = None,
        heard: str | None = None,
        language: str | None = None,
        plan: str | None = None,
        continues: int | None = None,
        proposed: str | None = None,
        changed_by: str | None = None,
    ) -> Approval:
        """Approve exactly this program. `proposed` is what lay before them first, where somebody
        has changed it (`changed_by`; else who approves it); kept with the run. Raises
        `AccessDenied` if the hash is that of another text, or if the review finds an error in it,
        `NotPossible` while another program runs."""
        self._check_free()
        if digest(program) != sha256:
            raise AccessDenied(
                "The program was changed after its review. Review it again, then approve it."
            )
        errors = [
            finding
            for finding in review(program, self.knowledge).findings
            if finding.severity == "error"
        ]
        if errors:
            raise AccessDenied(
                f"The program cannot be approved: line {errors[0].line}: {errors[0].message}"
            )
        if continues is not None:
            self._recall(continues, program)
        changed = proposed is not None and proposed != program
        approval = Approval(
            id=secrets.token_urlsafe(16),
            program=program,
            sha256=sha256,
            by=by,
            at=time.time(),
            utterance=utterance,
            heard=heard,
            language=language,
            plan=plan,
            continues=continues,
            proposed=proposed if changed else None,
            changed_by=(changed_by or by) if changed else None,
        )
        with self._lock:
            self._approvals[approval.id] = approval
            while len(self._approvals) > APPROVALS_KEPT:
                self._approvals.popitem(last=False)
        return approval

    # --- while it runs

    def run(self, approval_id: str) -> int:
        """Start an approved program; returns the run's number at once. Raises `AccessDenied`
        without an approval, `NotPossible` while another program runs, `LostConnection` while the
        robot is lost."""
        if self._lost_since is not None:
            raise LostConnection(f"{self._lost_because} Nothing can be run before it is found.")
        self._check_stands()
        with self._lock:
            approval = self._approvals.get(approval_id)
            if approval is None:
                raise AccessDenied(
                    "This program has no approval that is still good. Review and approve it first."
                )
            self._check_free()
            del self._approvals[approval_id]
            goes_on = approval.continues
            recall = self._recall(goes_on, approval.program) if goes_on is not None else None
            run = self._begin(approval)
            activity = self._activity = _Activity(run, approval)
            activity.recall = recall
        if self.present.happened(happenings.Began(run)).run != run:  # stopped in this very moment
            activity.stop_because = self.present.state.because or "The robot was stopped."
        threading.Thread(
            target=self._perform, args=(activity,), name=f"program {run}", daemon=True
        ).start()
        return run

    def wait(self, run: int, timeout: float | None = None) -> Status:
        """Wait until that run is over (or `timeout` seconds), then tell how it stands."""
        activity = self._of(run)
        activity.over.wait(timeout)
        return self._status(activity)

    def state(self) -> Status | None:
        """How the present or last run stands; None if there was none since the server started."""
        if self._activity is None:
            return None
        status = self._status(self._activity)
        return msgspec.structs.replace(status, robot_lost_since=self._lost_since)

    def last(self) -> Record | None:
        """The present run or the last one of the log, with what became of its calls."""
        activity = self._activity
        if activity is None:
            newest = self.log.runs(1)
            run = newest[0] if newest else None
        else:
            run = self.log.run(activity.run)
        if run is None:
            return None
        running = activity is not None and not activity.over.is_set()
        line = activity.line if activity is not None else None
        return Record(run, running, line, done_calls(self.log.calls(run.id)))

    def pause(self) -> Status:
        """Halt the robot at once, and the program with it: a movement at hand is broken off, a
        sentence may end. It is `paused` when the robot has come to rest, until then `pausing`."""
        activity = self._control(Execution.pause, happenings.PauseAsked())
        threading.Thread(target=self._halt, args=(activity,), name="halt", daemon=True).start()
        return self._status(activity)

    def step(self) -> Status:
        """Do one more robot call, or the rest of the one that was broken off, then pause again."""
        return self._status(self._control(Execution.step, happenings.Resumed()))

    def resume(self) -> Status:
        """Go on: what was broken off goes on to its goal."""
        return self._status(self._control(Execution.resume, happenings.Resumed()))

    def stop(self, because: str = "The program was stopped.") -> None:
        """Stop the program that runs, if any. `robot.stop` does this and stops the robot."""
        activity = self._activity
        if activity is None or activity.outcome is not None or activity.stop_because is not None:
            return
        activity.stop_because = because
        self.present.happened(happenings.EndAsked(because))
        if activity.execution is not None:
            activity.execution.stop(because)
        if activity.robot is not None:
            activity.robot.cancel()
        threading.Thread(target=_break_off, args=(activity,), name="break off", daemon=True).start()

    def close(self) -> None:
        """Stop the program that runs, if any, and wait until that is logged."""
        self.stop("nl2robot was closed.")
        if self._activity is not None:
            has = self.knowledge.capabilities
            self._activity.over.wait(SECONDS_TO_END + (has.stop_within if has else 0.0))

    def note_link(self, event: Mapping[str, Any]) -> None:
        """The robot was lost, or found again (the data of the event `link`). A program that runs
        ends with the loss, whatever it catches."""
        lost = event["state"] == "lost"
        self._lost_since = event["since"] if lost else None
        self._lost_because = str(event["because"])
        activity = self._activity
        if lost and activity is not None and activity.outcome is None:
            activity.lost_because = self._lost_because
            if activity.execution is not None:
                activity.execution.stop(self._lost_because)

    def note_pose(self, pose: Mapping[str, Any]) -> None:
        """Where the robot is (the data of the event `pose`)."""
        self._pose = pose
        activity = self._activity
        odometer = activity.odometer if activity is not None else None
        if odometer is not None:
            odometer.at(pose)

    def note_search(self, search: Mapping[str, Any]) -> None:
        """Where the robot has looked in vain (the data of the event `searched`): the program's
        people are told, in the language of whoever approved it."""
        activity = self._activity
        if activity is not None and activity.outcome is None and search["places"]:
            self._report(activity, "looked_in", places=search["places"])

    def _report(self, activity: _Activity, phrase: str, **about: Any) -> None:
        """Tell something that the program itself does not, in the language of whoever approved it.
        Lists are of places."""
        code = activity.approval.language or "en"
        pack = load_language(code if code in languages() else "en")
        called = naming(self.knowledge.lexicon(pack.code), pack).called
        gaps = {
            name: ", ".join(map(called, value)) if isinstance(value, list | tuple) else value
            for name, value in about.items()
        }
        text = pack.phrase(phrase, **gaps)
        with contextlib.suppress(Stopped):  # the next call finds that the log is full
            self._logged(self.log.printed, activity.run, f"{text}\n")
        self._tell(activity, "print", text=f"{text}\n")

    # --- the run itself

    def _begin(self, approval: Approval) -> int:
        try:
            return self.log.begin(
                program=approval.program,
                sha256=approval.sha256,
                approved_by=approval.by,
                approved_at=approval.at,
                utterance=approval.utterance,
                heard=approval.heard,
                language=approval.language,
                plan=approval.plan,
                proposed=approval.proposed,
                changed_by=approval.changed_by,
                world=_where_from(self.knowledge.world),
                seed=self._seed,
                robot=self.knowledge.capabilities.name if self.knowledge.capabilities else None,
                continues=approval.continues,
            )
        except LogError as error:
            raise NotPossible(str(error)) from error

    def _perform(self, activity: _Activity) -> None:
        try:
            with self._connect() as robot:
                activity.robot = robot
                activity.outcome = _as_lost(self._execute(activity, robot), activity)
                # A connection that is lost needs no stop: its server has stopped the robot, too.
                if activity.outcome.status != "done" and robot.connected:
                    robot.stop()
        except RobotError as error:  # the robot cannot be reached
            if activity.outcome is not None and isinstance(error, StopNotConfirmed):
                activity.outcome = _unconfirmed(activity.outcome, error)
            if activity.outcome is None:
                activity.outcome = Outcome("failed", str(error), error=type(error).__name__)
        except Exception:  # noqa: BLE001 - told as a fault of this software
            _log.exception("run %s ended through a fault", activity.run)
        finally:
            self._end(activity)

    def _execute(self, activity: _Activity, robot: Robot) -> Outcome:
        recall = activity.recall
        closed: list[tuple[str, str]] = []
        """The places of its rounds that could not be reached, each with the robot's sentence."""

        def on_line(line: int) -> None:
            activity.line = line
            self.present.happened(happenings.AtLine(line))
            self._tell(activity, "line")

        def call(method: str, arguments: dict[str, Any], line: int) -> Any:
            if recall is not None and recall.goes_on:
                return recall.answer(method, arguments)
            return self._call(activity, robot, method, arguments, line)

        def on_print(text: str) -> None:
            if recall is not None and recall.goes_on:
                return  # it was printed before
            self._logged(self.log.printed, activity.run, text)
            self._tell(activity, "print", text=text)

        execution = Execution(
            activity.approval.program,
            call,
            seed=self._seed,
            on_line=on_line,
            on_print=on_print,
            on_hold=lambda: self._holds(activity),
            on_closed=lambda place, why: closed.append((place, why)),
        )
        activity.execution = execution
        self._tell(activity, "state")
        if activity.stop_because is not None:  # stopped before it began
            execution.stop(activity.stop_because)
        outcome = execution.run()
        for place, why in closed:
            self._report(activity, "was_closed", place=[place], reason=why)
        if recall is not None and recall.deviation is not None:
            return dataclasses.replace(
                outcome, status="failed", message=recall.deviation, error="Deviates"
            )
        return outcome

    def _call(
        self, activity: _Activity, robot: Robot, method: str, arguments: dict[str, Any], line: int
    ) -> Any:
        """Make a robot call, in pieces if it is paused meanwhile."""
        left: dict[str, Any] | None = arguments
        while left is not None:
            self._begin_driving(activity, robot, method)
            try:
                return self._logged_call(activity, robot, method, left, line)
            except _BrokenOff:
                assert activity.execution is not None
                with activity.gate:
                    activity.drives = False  # from now on nothing else is to be broken off
                self._come_to_rest(activity, robot)
                odometer, activity.odometer = activity.odometer, None
                if odometer is not None:
                    here = self._where(robot)
                    if here is not None:
                        odometer.at(here)
                    left = rest_of(method, left, odometer)
                activity.execution.hold()
            finally:
                with activity.gate:
                    activity.drives, activity.odometer = False, None
        return None

    def _logged_call(
        self, activity: _Activity, robot: Robot, method: str, arguments: dict[str, Any], line: int
    ) -> Any:
        activity.calls += 1
        number = activity.calls
        written = msgspec.json.encode(arguments).decode()
        self._logged(self.log.call_begins, activity.run, number, line, method, written)
        about = {"number": number, "method": method, "arguments": arguments}
        self._tell(activity, "call", **about)
        began = time.perf_counter()
        try:
            if activity.stop_because is not None:
                raise Stopped(activity.stop_because)
            result = getattr(robot, method)(**arguments)
        except (RobotError, Stopped) as error:
            seconds = time.perf_counter() - began
            broken_off = isinstance(error, Stopped) and self._was_broken_off(activity)
            told = f"{PAUSED}: {_HALTED}" if broken_off else f"{type(error).__name__}: {error}"
            self._logged(self.log.call_ends, activity.run, number, seconds, error=told)
            self._tell(activity, "result", **about, error=told, seconds=seconds)
            if broken_off:
                raise _BrokenOff from None
            raise
        seconds = time.perf_counter() - began
        told = msgspec.json.encode(result).decode()
        self._logged(self.log.call_ends, activity.run, number, seconds, result=told)
        self._tell(activity, "result", **about, result=msgspec.to_builtins(result), seconds=seconds)
        if method == "stop":
            raise Stopped  # whoever stops the robot, its program is over
        return result

    def _logged(self, write: Callable[..., None], *values: Any, **more: Any) -> None:
        try:
            write(*values, **more)
        except LogError as error:
            # What is not logged is not done.
            raise Stopped(str(error)) from error

    def _end(self, activity: _Activity) -> None:
        outcome = activity.outcome or Outcome(
            status="failed", message="The run ended through a fault of this software."
        )
        message = None if outcome.status == "done" else outcome.message
        if outcome.line is not None:
            activity.line = outcome.line
        try:
            self.log.end(activity.run, outcome.status, message)
        except LogError as error:
            message = str(error)
        try:
            # Those who watch hear of the end before those who wait are told.
            self._tell(activity, "state", state=outcome.status, message=message)
        finally:
            with self._lock:  # whoever is told of the end may start the next run
                activity.ended, activity.message = outcome.status, message
                self.present.happened(happenings.Ended(activity.run, outcome.status, message))
                activity.over.set()

    # --- a pause

    def _begin_driving(self, activity: _Activity, robot: Robot, method: str) -> None:
        """Before a call that turns the wheels: not while they are to stand."""
        assert activity.execution is not None
        while True:
            with activity.gate:
                if not self._pauses(activity):
                    activity.broken_off = False
                    activity.drives = method in DRIVING
                    break
            activity.execution.hold()
        if method == "localize":
            self._pose = None  # it is elsewhere on the map than it was
        if method in MEASURED:
            activity.odometer = Odometer(self._pose or self._where(robot))

    def _halt(self, activity: _Activity) -> None:
        """Break off what turns the wheels. Whoever made that call then sees to the rest; if there
        is none, we do."""
        robot = activity.robot
        assert robot is not None
        while True:
            with activity.gate:
                if not self._pauses(activity) or self.present.state.state == "paused":
                    return
                if not activity.drives:
                    break
                activity.broken_off = True
                robot.cancel()
            if activity.over.wait(BREAK_OFF_EVERY):
                return
        # Who broke off sees to it, unless what was to be broken off ended by itself in that moment.
        if self.present.state.state == "pausing":
            with contextlib.suppress(RobotError, Stopped):
                self._come_to_rest(activity, robot)

    def _come_to_rest(self, activity: _Activity, robot: Robot) -> None:
        """Be sure that the robot stands, and say so; else stop it. Raises `Stopped`."""
        has = self.knowledge.capabilities
        if has is not None and self._knows_where:
            within = has.stop_within + SECONDS_TO_REST
            goes_on = lambda: activity.stop_because is None  # noqa: E731
            if not comes_to_rest(robot, within, goes_on):
                if activity.stop_because is None:
                    self.stop(_DOES_NOT_REST)
                raise Stopped(activity.stop_because or _DOES_NOT_REST)
        if self.present.state.state == "pausing":
            self.present.happened(happenings.Halted())
            self._tell(activity, "state")

    def _holds(self, activity: _Activity) -> None:
        """The program waits again after a step, between two calls."""
        if self.present.state.state == "running":
            self.present.happened(happenings.PauseAsked())
            self.present.happened(happenings.Halted())
            self._tell(activity, "state")

    def _pauses(self, activity: _Activity) -> bool:
        now = self.present.state
        return now.run == activity.run and now.state in ("pausing", "paused")

    def _was_broken_off(self, activity: _Activity) -> bool:
        return (
            activity.broken_off and activity.stop_because is None and activity.lost_because is None
        )

    def _where(self, robot: Robot) -> Mapping[str, Any] | None:
        """None if the robot does not know."""
        if not self._knows_where:
            return None
        with contextlib.suppress(RobotError):
            return pose_of(robot.location())
        return None

    @property
    def _knows_where(self) -> bool:
        has = self.knowledge.capabilities
        return has is not None and "location" in has.methods

    # --- helpers

    def _control(
        self, act: Callable[[Execution], None], happening: happenings.Happening
    ) -> _Activity:
        activity = self._activity
        with self._lock:
            if activity is None or activity.outcome is not None or activity.execution is None:
                raise NotPossible("No program is running.")
        with activity.gate:
            act(activity.execution)
            self.present.happened(happening)
        self._tell(activity, "state")
        return activity

    def _status(self, activity: _Activity) -> Status:
        now = self.present.state.state
        match now:
            case "running" | "pausing" | "paused":
                return activity.status(now)
        return activity.status("running")  # until it is over, whatever the robot is at

    def _recall(self, run: int, program: str) -> Recall:
        """What was done in that run of this program. Raises `NotPossible`."""
        rest = unfinished(self.log, run)
        if rest is None or rest.program != program:
            raise NotPossible(
                f"Run {run} is not one that this program could go on with."
                " Have it done from the beginning instead."
            )
        return Recall(rest.done)

    def _check_free(self) -> None:
        """Raise `NotPossible` while a program runs."""
        if self._activity is not None and not self._activity.over.is_set():
            raise NotPossible(BUSY)

    def _check_stands(self) -> None:
        """Raise `NotPossible` while the robot is being stopped."""
        has = self.knowledge.capabilities
        patience = SECONDS_TO_END + (has.stop_within if has else 0.0)
        if self.present.state.unconfirmed or not self.present.wait_until(
            lambda now: not now.stops, patience
        ):
            raise NotPossible(UNCONFIRMED)

    def _of(self, run: int) -> _Activity:
        activity = self._activity
        if activity is None or activity.run != run:
            raise NotPossible(f"Run {run} is not the present one. `nl2robot log {run}` shows it.")
        return activity

    def _tell(self, activity: _Activity, what: str, **more: Any) -> None:
        data = {
            "what": what,
            "run": activity.run,
            "state": self._status(activity).state,
            "line": activity.line,
            "message": activity.message,
        }
        self._publish("program", {**data, **more})


def _as_lost(outcome: Outcome, activity: _Activity) -> Outcome:
    """How a run ended whose robot was lost meanwhile: not by somebody's stop."""
    if activity.lost_because is None or activity.stop_because is not None:
        return outcome
    if outcome.status != "stopped":
        return outcome
    return dataclasses.replace(
        outcome,
        status="failed",
        message=activity.lost_because,
        error=LostConnection.__name__,
    )


def _unconfirmed(outcome: Outcome, error: StopNotConfirmed) -> Outcome:
    """How a run ended whose robot has not said that it stands: not "stopped"."""
    if outcome.status == "stopped":
        return dataclasses.replace(
            outcome, status="failed", message=str(error), error=type(error).__name__
        )
    return dataclasses.replace(outcome, message=f"{outcome.message} {error}")


def _break_off(activity: _Activity) -> None:
    """Break off the calls of a stopped program until it is over: one may just be on its way to the
    robot, and reach it after the stop."""
    while not activity.over.wait(BREAK_OFF_EVERY):
        if activity.robot is not None and activity.outcome is None:
            activity.robot.cancel()


def _where_from(world: World) -> str:
    """What `load_world` finds this world by again, whatever folder it is called in."""
    return world.name if world.name in builtin_worlds() else str(Path(world.file).absolute())
