"""The runner: approved programs, one at a time, on the robot.

It lives at the server, so that a program goes on when the client that started it leaves, and so
that the terminal, the web console and other clients see the same run. Every robot call of a program
goes through the client `Robot` over the wire, as anybody's would.

    translate -> check -> approve -> run -> (pause, step, resume, stop) -> over

An approval is bound to the hash of exactly one program and is used up by one run.
"""

from __future__ import annotations

import dataclasses
import logging
import secrets
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Literal

import msgspec

from nl2robot.history import Record, done_calls
from nl2robot.knowledge import Knowledge
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

State = Literal["running", "paused", "done", "failed", "stopped", "limit"]

SECONDS_TO_END = 3.0
"""How long a stopped run may take to be over, beside what the robot takes to stand."""
BREAK_OFF_EVERY = 0.02
"""Seconds between two attempts to break off a robot call of a program that was stopped."""
APPROVALS_KEPT = 100
"""An approval that was not used is forgotten when so many newer ones were given."""


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
        self.state: State = "running"
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

    def status(self) -> Status:
        return Status(
            run=self.run,
            state=self.state,
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
    ) -> None:
        self.knowledge = knowledge
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

    # --- before it runs

    def check(self, program: str, language: str = "en") -> Review:
        """Review a program, and read it in a language; nothing moves."""
        return review(program, self.knowledge, self._stage, language, self._seed)

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
    ) -> Approval:
        """Approve exactly this program. Raises `AccessDenied` if the hash is that of another text,
        or if the review finds an error in it."""
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
        with self._lock:
            approval = self._approvals.get(approval_id)
            if approval is None:
                raise AccessDenied(
                    "This program has no approval that is still good. Review and approve it first."
                )
            if self._activity is not None and not self._activity.over.is_set():
                raise NotPossible(
                    "Another program is running. Wait until it is over, or stop it first."
                )
            del self._approvals[approval_id]
            run = self._begin(approval)
            activity = self._activity = _Activity(run, approval)
        threading.Thread(
            target=self._perform, args=(activity,), name=f"program {run}", daemon=True
        ).start()
        return run

    def wait(self, run: int, timeout: float | None = None) -> Status:
        """Wait until that run is over (or `timeout` seconds), then tell how it stands."""
        activity = self._of(run)
        activity.over.wait(timeout)
        return activity.status()

    def state(self) -> Status | None:
        """How the present or last run stands; None if there was none since the server started."""
        if self._activity is None:
            return None
        status = self._activity.status()
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
        return self._control("paused", Execution.pause)

    def step(self) -> Status:
        """Do one more robot call, then pause again."""
        return self._control("paused", Execution.step)

    def resume(self) -> Status:
        return self._control("running", Execution.resume)

    def stop(self, because: str = "The program was stopped.") -> None:
        """Stop the program that runs, if any. `robot.stop` does this and stops the robot."""
        activity = self._activity
        if activity is None or activity.outcome is not None or activity.stop_because is not None:
            return
        activity.stop_because = because
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
                world=_where_from(self.knowledge.world),
                seed=self._seed,
                robot=self.knowledge.capabilities.name if self.knowledge.capabilities else None,
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
        def on_line(line: int) -> None:
            activity.line = line
            self._tell(activity, "line")

        def call(method: str, arguments: dict[str, Any], line: int) -> Any:
            activity.calls += 1
            return self._logged_call(activity, robot, method, arguments, line)

        def on_print(text: str) -> None:
            self._logged(self.log.printed, activity.run, text)
            self._tell(activity, "print", text=text)

        execution = Execution(
            activity.approval.program,
            call,
            seed=self._seed,
            on_line=on_line,
            on_print=on_print,
        )
        activity.execution = execution
        self._tell(activity, "state")
        if activity.stop_because is not None:  # stopped before it began
            execution.stop(activity.stop_because)
        return execution.run()

    def _logged_call(
        self, activity: _Activity, robot: Robot, method: str, arguments: dict[str, Any], line: int
    ) -> Any:
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
            told = f"{type(error).__name__}: {error}"
            self._logged(self.log.call_ends, activity.run, number, seconds, error=told)
            self._tell(activity, "result", **about, error=told, seconds=seconds)
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
                activity.state, activity.message = outcome.status, message
                activity.over.set()

    # --- helpers

    def _control(self, state: State, act: Callable[[Execution], None]) -> Status:
        activity = self._activity
        with self._lock:
            if activity is None or activity.outcome is not None or activity.execution is None:
                raise NotPossible("No program is running.")
            activity.state = state
        act(activity.execution)
        self._tell(activity, "state")
        return activity.status()

    def _of(self, run: int) -> _Activity:
        activity = self._activity
        if activity is None or activity.run != run:
            raise NotPossible(f"Run {run} is not the present one. `nl2robot log {run}` shows it.")
        return activity

    def _tell(self, activity: _Activity, what: str, **more: Any) -> None:
        data = {
            "what": what,
            "run": activity.run,
            "state": activity.state,
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
