"""The runner: approved programs, one at a time, on the robot.

It lives at the server, so that a program goes on when the client that started it leaves, and so
that the terminal, the web console and other clients see the same run. Every robot call of a program
goes through the client `Robot` over the wire, as anybody's would.

    translate -> check -> approve -> run -> (pause, step, resume, stop) -> over

An approval is bound to the hash of exactly one program and is used up by one run.
"""

from __future__ import annotations

import contextlib
import math
import secrets
import threading
import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path
from typing import Any, Final

import msgspec

from nl2robot.knowledge import Knowledge
from nl2robot.review.review import Review, digest, review
from nl2robot.review.reviews import Reviews, as_it_is
from nl2robot.run.going_on import Recall, Unfinished, told, unfinished
from nl2robot.run.history import Record, done_calls
from nl2robot.run.pausing import pose_of
from nl2robot.run.performance import Means, Performance
from nl2robot.run.present import Present
from nl2robot.run.runlog import LogError, RunLog
from nl2robot.run.runs import Approval, Status
from nl2robot.run.sightings import Sightings
from nl2robot.run.spoken_language import SpokenLanguage
from nl2robot.run.state import State
from nl2robot.work import Do, here
from robot_api.client import Robot
from robot_api.errors import AccessDenied, LostConnection, NotPossible, RobotError, Stopped
from sim.simulation import Simulation
from sim.world.builtin import builtin_worlds
from sim.world.model import World

SECONDS_TO_END: Final = 3.0
"""How long a stopped run may take to be over, beside what the robot takes to stand."""
APPROVALS_KEPT: Final = 100
APPROVAL_HOLDS: Final = 600.0
"""Seconds in which an approved program has to begin: later the ward may look another way."""
"""An approval that was not used is forgotten when so many newer ones were given."""

BUSY: Final = "Another program is running. Wait until it is over, or stop it first."
UNCONFIRMED: Final = (
    "The robot has not confirmed that it stands. Press STOP until it does; then approve it again."
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
        think: Do = here,
        review: Callable[..., Review] = review,
    ) -> None:
        """`think` and `review` do what computes for long: here, or in another process
        (`nl2robot.review.apart.think`, `nl2robot.review.review.review_apart`)."""
        self.think = think
        self.review = review
        self.knowledge = knowledge
        self.present = present or Present(lambda state: None)
        """How the robot and its program stand."""
        self.log = log
        self._spoken = SpokenLanguage()
        self.sightings = Sightings()
        """Whom and what the robot has seen just now."""
        self._means = Means(
            knowledge, connect, log, publish, self.present, self._spoken, self.sightings, seed
        )
        self._stage = stage
        self._seed = seed
        self._lock = threading.Lock()
        self._reviews = Reviews()
        self._approvals: OrderedDict[str, Approval] = OrderedDict()
        self._given: dict[str, tuple[float, str | None]] = {}
        """Of each approval: when it was given, by a clock that nobody sets, and over which
        connection."""
        self._performance: Performance | None = None
        """The run that goes on, or the last that did."""
        self._lost_since: float | None = None
        self._lost_because = ""
        self._pose: Mapping[str, Any] | None = None

    # --- before it runs

    def check(
        self,
        program: str,
        language: str = "en",
        continues: int | None = None,
        at: datetime | None = None,
    ) -> Review:
        """Review a program, and read it in a language; nothing moves. `continues`: only what is
        left of it after that run is tried. Raises `NotPossible` if nothing is. `at`: it is tried as
        if it began then; without a zone, by the clocks of the simulated world. An approval to run
        it now does not rest on such a review."""
        recall = self._recall(continues, program)
        simulation = self._stage() if self._stage is not None else None
        world = as_it_is(simulation) if simulation is not None else None
        made = self.review(program, self.knowledge, simulation, language, self._seed, recall, at)
        if at is None:
            self._reviews.keep(made, continues, world)
        return made

    def unfinished(self, run: int | None = None) -> Unfinished | None:
        """What is left of that run, or of the last one, if it was broken off."""
        if self.present.state.run is not None:
            return None
        return unfinished(self.log, run)

    def told_of(self, rest: Unfinished, language: str) -> list[str]:
        """What is done of it and what is left, in sentences; and whether the robot was moved since
        it stopped."""
        here = None
        if rest.stood is not None:
            with contextlib.suppress(RobotError, Stopped), self._means.connect() as robot:
                here = pose_of(robot.location())
        return told(rest, self.knowledge, language, here)

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
        insists: bool = False,
        connection: str | None = None,
    ) -> Approval:
        """Approve exactly this program, for ten minutes; if it was over a `connection`, only as
        long as that lasts. `proposed` is what lay before them first, where somebody
        has changed it (`changed_by`; else who approves it); kept with the run. `insists`: though it
        does not come to its end in the dry run, which is made now unless it was lately. Raises
        `AccessDenied` if the hash is that of another text, if the review finds an error in it, or
        if it does not come to its end and nobody insists, `NotPossible` while another program
        runs."""
        self._check_free()
        if digest(program) != sha256:
            raise AccessDenied(
                "The program was changed after its review. Review it again, then approve it."
            )
        errors = [
            finding
            for finding in self.review(program, self.knowledge).findings
            if finding.severity == "error"
        ]
        if errors:
            raise AccessDenied(
                f"The program cannot be approved: line {errors[0].line}: {errors[0].message}"
            )
        if continues is not None:
            utterance = utterance or self._rest(continues, program).utterance
        if not insists:
            self._check_comes_through(program, sha256, continues)
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
            self._given[approval.id] = (time.monotonic(), connection)
            while len(self._approvals) > APPROVALS_KEPT:
                gone, _ = self._approvals.popitem(last=False)
                del self._given[gone]
        return approval

    def left(self, connection: str) -> None:
        """Whoever has this connection has left: what they approved there and has not begun is
        approved no more."""
        with self._lock:
            for each in [each for each, (_, by) in self._given.items() if by == connection]:
                del self._approvals[each], self._given[each]

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
            given, _ = self._given.get(approval_id, (-math.inf, None))
            if approval is None or time.monotonic() - given > APPROVAL_HOLDS:
                raise AccessDenied(
                    "This program has no approval that is still good. Review and approve it first."
                )
            self._check_free()
            del self._approvals[approval_id], self._given[approval_id]
            recall = self._recall(approval.continues, approval.program)
            run = self._begin(approval)
            performance = Performance(run, approval, self._means, recall, self._pose)
            self._performance = performance
        performance.begin()
        return run

    def wait(self, run: int, timeout: float | None = None) -> Status:
        """Wait until that run is over (or `timeout` seconds), then tell how it stands."""
        performance = self._performance
        if performance is None or performance.run != run:
            raise NotPossible(f"Run {run} is not the present one. `nl2robot log {run}` shows it.")
        performance.over.wait(timeout)
        return performance.status()

    def state(self) -> Status | None:
        """How the present or last run stands; None if there was none since the server started."""
        if self._performance is None:
            return None
        status = self._performance.status()
        return msgspec.structs.replace(status, robot_lost_since=self._lost_since)

    def last(self) -> Record | None:
        """The present run or the last one of the log, with what became of its calls."""
        performance = self._performance
        if performance is None:
            newest = self.log.runs(1)
            run = newest[0] if newest else None
        else:
            run = self.log.run(performance.run)
        if run is None:
            return None
        running = performance is not None and not performance.over.is_set()
        line = performance.line if performance is not None else None
        return Record(run, running, line, done_calls(self.log.calls(run.id)))

    def pause(self) -> Status:
        """See `Performance.pause`; so are `step` and `resume`."""
        return self._control(Performance.pause)

    def step(self) -> Status:
        return self._control(Performance.step)

    def resume(self) -> Status:
        return self._control(Performance.resume)

    def stop(self, because: str = "The program was stopped.") -> None:
        """Stop the program that runs, if any. `robot.stop` does this and stops the robot."""
        if self._performance is not None:
            self._performance.stop(because)

    def close(self) -> None:
        """Stop the program that runs, if any, and wait until that is logged."""
        self.stop("nl2robot was closed.")
        if self._performance is not None:
            self._performance.over.wait(self._patience)

    # --- what is heard of the robot

    def note_link(self, event: Mapping[str, Any]) -> None:
        """The robot was lost, or found again (the data of the event `link`). A program that runs
        ends with the loss, whatever it catches."""
        lost = event["state"] == "lost"
        self._lost_since = event["since"] if lost else None
        self._lost_because = str(event["because"])
        if lost and self._performance is not None:
            self._performance.lose(self._lost_because)

    def note_pose(self, pose: Mapping[str, Any]) -> None:
        """Where the robot is (the data of the event `pose`)."""
        self._pose = pose
        if self._performance is not None:
            self._performance.note_pose(pose)

    def note_language(self, code: str) -> None:
        """The robot speaks it from now on (the data of the event `language`)."""
        self._spoken.heard_of(code)

    def note_state(self, state: State) -> None:
        """How the robot and its program stand from now on. Returns at once."""
        performance = self._performance
        if performance is not None and performance.run == state.run:
            performance.note_state(state)

    def note_search(self, search: Mapping[str, Any]) -> None:
        """Where the robot has looked in vain (the data of the event `searched`): the program's
        people are told."""
        performance = self._performance
        if performance is not None and performance.goes_on and search["places"]:
            performance.report("looked_in", places=search["places"])

    # --- inside

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

    def _control(self, act: Callable[[Performance], None]) -> Status:
        performance = self._performance
        if performance is None:
            raise NotPossible("No program is running.")
        act(performance)
        return performance.status()

    def _rest(self, run: int, program: str) -> Unfinished:
        """What is left of that run of this program. Raises `NotPossible`."""
        rest = unfinished(self.log, run)
        if rest is None or rest.program != program:
            raise NotPossible(
                f"Run {run} is not one that this program could go on with."
                " Have it done from the beginning instead."
            )
        return rest

    def _recall(self, run: int | None, program: str) -> Recall | None:
        """What was done before, if it goes on with a run. Raises `NotPossible`."""
        if run is None:
            return None
        rest = self._rest(run, program)
        return Recall(rest.done, rest.again)

    def _check_comes_through(self, program: str, sha256: str, continues: int | None) -> None:
        """Raise `AccessDenied` if it does not come to its end in the dry run."""
        if self._stage is None:
            return  # there is nothing to try it in
        last = self._reviews.of(sha256, continues, as_it_is(self._stage()))
        dry_run = (last or self.check(program, continues=continues)).dry_run
        if dry_run is None or dry_run.complete:
            return
        ends = f"line {dry_run.line}: {dry_run.message}" if dry_run.message else "it broke off"
        raise AccessDenied(
            f"The program did not come to its end when it was tried ({ends.rstrip('.')})."
            " Change it, or say that you want it run all the same (`insists`)."
        )

    def _check_free(self) -> None:
        """Raise `NotPossible` while a program runs."""
        if self._performance is not None and not self._performance.over.is_set():
            raise NotPossible(BUSY)

    def _check_stands(self) -> None:
        """Raise `NotPossible` while the robot is being stopped."""
        if self.present.state.unconfirmed or not self.present.wait_until(
            lambda now: not now.stops, self._patience
        ):
            raise NotPossible(UNCONFIRMED)

    @property
    def _patience(self) -> float:
        """Seconds in which a stop, and the program that it ends, are over."""
        has = self.knowledge.capabilities
        return SECONDS_TO_END + (has.stop_within if has else 0.0)


def _where_from(world: World) -> str:
    """What `load_world` finds this world by again, whatever folder it is called in."""
    return world.name if world.name in builtin_worlds() else str(Path(world.file).absolute())
