"""The timekeeper of a station: has the clerk look every second, and runs what he says begins.

Each run is one as any other: reviewed again, approved at the runner in the name of who approved
the appointment, in view, stopped by a stop. What came of it is taken from the run log, so that a
process which takes the place of one that was killed can tell it, too.
"""

from __future__ import annotations

import logging
import math
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from typing import Any, Final

import msgspec

from grammar.language import languages
from nl2robot.errors import UserError
from nl2robot.run.process import lives, own_process, process_number
from nl2robot.run.runlog import Run
from nl2robot.run.runner import Runner
from nl2robot.run.state import GOING, State
from nl2robot.schedule.appointments import Appointment, Occurrence
from nl2robot.schedule.book import Book
from nl2robot.schedule.clerk import Begin, Clerk, Settings, Waits
from nl2robot.schedule.findings import decoded, findings_of, news
from nl2robot.schedule.handing import Handing
from nl2robot.schedule.lookout import Ask, Lookout
from nl2robot.schedule.outcomes import Outcome, asking_of, outcomes
from nl2robot.schedule.rhythm import shown_at
from nl2robot.schedule.schedule import FILE, Checks, Schedule
from nl2robot.schedule.telling import told, trouble
from nl2robot.schedule.triggers import Trigger, checked, of_others, possible
from nl2robot.texts import texts_in
from robot_api.errors import AccessDenied, LostConnection, NotPossible, RobotError, cause
from robot_api.local_time import local_zone

RESTS_AFTER_STOP: Final = 120.0
"""Seconds after somebody has stopped the robot in which nothing begins by itself."""
CHARGED: Final = 30.0
"""Percent below which a robot that charges goes on charging."""
PRESSED_EVERY: Final = 1.0
"""Seconds in which one press of a button counts, however often it is pressed."""
TRIES_AGAIN: Final = 30.0
"""Seconds after which it is tried again where something was not free after all."""
FORGETS_EVERY: Final = 3600.0
LATEST_RUNS: Final = 200

EVENTS: Final[Mapping[str, str]] = {
    "schedule": "open (what waits, begins or runs now, as schedule.history tells it): something in"
    " the book of appointments has changed; schedule.list tells all of it",
    "schedule.buttons": "buttons: those that the robot's face shows now, as the method of this name"
    " lists them",
    "notice": "id (null if the book of appointments cannot be written), time, kind (missed |"
    " missed_many | overtaken | waits | ends_soon | ended |"
    " changed | refused | failed | broken_off | moved | reminder_no | reminder_unclear |"
    " reminder_silent | reminder_away | reminder_gone | trouble), appointment (0: of a reminder"
    " that somebody had"
    " said at once, and of trouble), occurrence, parts, told (the sentence by language): what"
    " somebody has to know who was not looking",
}

_log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class Timing:
    """How a station keeps time: what the house decides, and the clock, in seconds since the
    epoch."""

    settings: Settings = field(default_factory=Settings)
    clock: Callable[[], float] = time.time
    every: float = 1.0
    """Seconds between two looks at it."""


def schedule_of(runner: Runner, timing: Timing | None, prefix: str | None = None) -> Schedule:
    """The appointments of a runner's robot, in the folder of its log. `prefix`: with what its own
    topics begin at the house's broker, if it is there."""
    log = runner.log.path

    def robot() -> str:
        capabilities = runner.knowledge.capabilities
        return capabilities.name if capabilities is not None else ""

    def noticed(trigger: Trigger) -> Trigger:
        knowledge = runner.knowledge
        has = knowledge.capabilities.methods if knowledge.capabilities is not None else ()
        if prefix is not None:
            of_others(trigger, prefix)
        return possible(checked(trigger), has, [place.name for place in knowledge.world.places])

    return Schedule(
        log.with_name(FILE) if str(log) != ":memory:" else None,
        robot,
        runner.check,
        timing.clock if timing is not None else time.time,
        noticed,
    )


class Timekeeper:
    """Has appointments done while it is entered."""

    def __init__(
        self,
        schedule: Schedule,
        runner: Runner,
        timing: Timing,
        publish: Callable[[str, Mapping[str, Any]], None],
        ask: Ask,
        listen: Callable[[frozenset[str]], None] = lambda topics: None,
    ) -> None:
        """`ask` calls a method of the robot that only looks; `listen`: have these topics of the
        house's broker told to `note`, as `message`."""
        self._schedule = schedule
        self._runner = runner
        self._timing = timing
        self._publish = publish
        self._clerk: Clerk | None = None
        self._handing: Handing | None = None
        self._over = threading.Event()
        self._soon = threading.Event()
        self._lookout = Lookout(ask, timing.clock, listen, self._soon.set)
        self._thread = threading.Thread(target=self._keep_time, name="schedule", daemon=True)
        self._battery: float | None = None
        self._not_before = 0.0
        """By the monotonic clock."""
        self._version: object = None
        self._trouble = ""
        self._buttons: list[str] = []
        """Those that were told of last."""
        self._pressed: dict[str, float] = {}
        """When each was pressed last."""
        self._forgot: float | None = None
        self._last_run: int | None = None
        """The run that was looked at when it had ended."""

    def __enter__(self) -> Timekeeper:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._soon.set()
        self._thread.join()
        book, robot = self._schedule.book(), self._schedule.robot
        if book is not None and robot is not None:
            with suppress(UserError):
                book.leave(robot)

    def note(self, kind: str, data: Mapping[str, Any]) -> None:
        """An event of the robot or of its runs, or one of `nl2robot.schedule.triggers`."""
        self._lookout.note(kind, data)
        if kind == "battery" and isinstance(data.get("percent"), int | float):
            self._battery = float(data["percent"])

    @property
    def buttons(self) -> list[str]:
        """Those that the robot's face shows, each of which is a trigger."""
        return self._lookout.buttons

    def press(self, button: str) -> bool:
        """Somebody presses one of them. Whether that counts: not if it was pressed lately."""
        now = self._timing.clock()
        if 0 <= now - self._pressed.get(button, -math.inf) < PRESSED_EVERY:
            return False
        self._pressed[button] = now
        if self._lookout.rests(button):
            return False
        self.note("pressed", {"button": button})
        return True

    def look(self) -> None:
        """Look once: tell what came of what was begun, and begin what is due. Raises
        `UserError` where another server does so for a robot of this name."""
        reminded = self._ended_at_once()
        book = self._schedule.book() if reminded is None else self._schedule.opened()
        robot = self._schedule.robot
        if book is None or robot is None:
            return
        if self._clerk is None or self._handing is None:
            self._clerk = Clerk(book, robot, self._timing.settings)
            self._handing = Handing(book, robot, self._clerk, self._schedule.company)
        if reminded is not None and not book.has_run(reminded[0].id):
            run, found = reminded
            self._clerk.reminded(run.id, run.started, run.utterance or "", found)
        keeper = book.kept_by(robot)
        if keeper != own_process():
            raise UserError(
                f"Another server (process {process_number(keeper)}) looks after the appointments"
                f" of {robot!r} in this data folder, so this one begins none. End one of the two,"
                " or give this one a data folder of its own with NL2ROBOT_HOME."
            )
        going = self._handing.look()
        for occurrence, appointment in book.begun(robot):
            if appointment.fleet is None:
                self._follow(self._clerk, book, occurrence, appointment)
        free, charging = self._waits() is None, self._runner.present.state.charging
        self._lookout.look(book, book.appointments(robot), free, charging)
        if self._lookout.buttons != self._buttons:
            self._buttons = self._lookout.buttons
            self._pressed = {
                each: at for each, at in self._pressed.items() if each in self._buttons
            }
            self._publish("schedule.buttons", {"buttons": self._buttons})
        waits = self._handing.waits
        begin = self._clerk.look(self._timing.clock(), self._waits(), waits, going)
        self._tell(book)
        if begin is not None:
            if begin.appointment.fleet is not None:
                self._hand_out(self._clerk, self._handing, begin)
            else:
                self._perform(self._clerk, begin)
            self._tell(book)
        self._forget(book)

    # --- inside

    def _keep_time(self) -> None:
        while True:
            self._soon.wait(self._timing.every)
            self._soon.clear()
            if self._over.is_set():
                return
            try:
                self.look()
                self._trouble = ""
            except UserError as error:  # a full disk: what is not in the book is not done
                self._tell_trouble(str(error))
            except Exception as error:  # noqa: BLE001 - the clock goes on
                _log.exception("appointments are not looked after")
                self._tell_trouble(f"Appointments are not looked after ({cause(error)}).")

    def _waits(self) -> Waits | None:
        if time.monotonic() < self._not_before:
            return "busy"
        return waits_for(self._runner.present.state, time.time(), self._battery)

    def _perform(self, clerk: Clerk, begin: Begin) -> None:
        """Review it again, and begin it if that finds what was approved."""
        kept = begin.appointment
        try:
            if self._changed(clerk, begin, self._runner.check):
                return
            if self._waits() is not None or self._over.is_set():  # somebody was quicker, or stopped
                clerk.not_begun(begin)
                return
            approval = self._runner.approve(
                kept.program,
                kept.sha256,
                in_the_name_of(kept),
                utterance=kept.sentence,
                language=kept.language,
                plan=kept.plan,
                insists=True,  # the review just now found what was approved
            )
            if self._waits() is not None:
                clerk.not_begun(begin)
                return
            clerk.runs(begin.occurrence, self._runner.run(approval.id))
        except (NotPossible, LostConnection) as error:
            _log.info("appointment %s waits: %s", kept.id, error)
            self._not_before = time.monotonic() + TRIES_AGAIN
            clerk.not_begun(begin)
        except (AccessDenied, RobotError) as error:
            clerk.refused(begin, str(error))

    def _hand_out(self, clerk: Clerk, handing: Handing, begin: Begin) -> None:
        """Review it again, and have the fleet do it if that finds what was approved."""
        company = self._schedule.company
        assert company is not None
        try:
            if not self._changed(clerk, begin, company.check):
                handing.hand_out(begin)
        except (NotPossible, LostConnection) as error:
            _log.info("appointment %s waits: %s", begin.appointment.id, error)
            clerk.not_begun(begin)
        except (AccessDenied, RobotError) as error:
            clerk.refused(begin, str(error))

    def _changed(self, clerk: Clerk, begin: Begin, check: Checks) -> bool:
        """Whether its review finds something that was not there when it was approved. Both are as
        of the time that the appointments go by: a simulated robot's own may run ahead of it."""
        kept = begin.appointment
        at = shown_at(self._timing.clock(), kept.rhythm)
        found = findings_of(check(kept.program, kept.language, at=at))
        new = news(decoded(kept.reviewed), found)
        if new:
            clerk.changed(begin, new)
        return bool(new)

    def _follow(
        self, clerk: Clerk, book: Book, occurrence: Occurrence, appointment: Appointment
    ) -> None:
        """Note what came of something that was begun, here or by a process that is gone."""
        mine = occurrence.process == own_process()
        if not mine and occurrence.process is not None and lives(occurrence.process):
            return
        run = self._run_of(book, occurrence, appointment)
        if run is not None and occurrence.run is None:
            clerk.runs(occurrence, run.id)
            occurrence = msgspec.structs.replace(occurrence, run=run.id)
        if run is not None and run.status is not None:
            came = self._reminded(run)
            clerk.ended(occurrence, appointment, run.status, run.message, came)
            return
        present = self._runner.state()
        if mine and run is not None and present is not None and present.run == run.id:
            if present.state not in GOING:  # its end could not be logged
                clerk.ended(occurrence, appointment, present.state, present.message)
            return
        clerk.ended(occurrence, appointment, None, None, self._reminded(run))

    def _reminded(self, run: Run | None) -> list[Outcome]:
        """What came of it, if that run reminded somebody."""
        if run is None or asking_of(run.program) is None:
            return []
        return outcomes(run.program, self._runner.log.calls(run.id))

    def _ended_at_once(self) -> tuple[Run, list[Outcome]] | None:
        """The run that has just ended and reminded somebody, told once; an appointment's too."""
        present = self._runner.state()
        if present is None or present.state in GOING or present.run == self._last_run:
            return None
        self._last_run = present.run
        run = self._runner.log.run(present.run) if present.run is not None else None
        found = self._reminded(run)
        return (run, found) if run is not None and found else None

    def _run_of(self, book: Book, occurrence: Occurrence, appointment: Appointment) -> Run | None:
        """Its run in the log; also of a process that ended before it could note which that is."""
        log = self._runner.log
        if occurrence.run is not None:
            return log.run(occurrence.run)
        known = book.runs_of(appointment.id)
        candidates = (
            run
            for run in log.runs(LATEST_RUNS)
            if run.process == occurrence.process
            and run.sha256 == appointment.sha256
            and run.approved_by == in_the_name_of(appointment)
            and run.id not in known
        )
        return next(candidates, None)

    def _tell(self, book: Book) -> None:
        """Publish what is new in the book."""
        assert self._clerk is not None
        for notice in self._clerk.notices():
            said = {code: told(notice, code, local_zone()) for code in languages()}
            self._publish("notice", {**msgspec.to_builtins(notice), "told": said})
        version = book.version()
        if version != self._version:
            self._version = version
            going = [
                msgspec.to_builtins(each)
                for each in self._schedule.history()
                if each.occurrence.state in ("due", "claimed", "running")
            ]
            self._publish("schedule", {"open": going})
            if self._handing is not None:
                self._handing.tell(self._timing.clock())

    def _tell_trouble(self, sentence: str) -> None:
        """Once, until it is over."""
        if sentence == self._trouble:
            return
        self._trouble = sentence
        _log.warning("%s", sentence)
        self._publish("notice", trouble(sentence))

    def _forget(self, book: Book) -> None:
        now = time.monotonic()
        if self._forgot is None or now - self._forgot > FORGETS_EVERY:
            self._forgot = now
            book.forget(self._timing.clock() - self._timing.settings.kept)


def waits_for(state: State, now: float, battery: float | None) -> Waits | None:
    """Why a robot that stands like that begins nothing by itself; None if it is free. `now` is in
    seconds since the epoch, `battery` in percent if it is known."""
    if state.lost_since is not None:
        return "lost"
    if state.unconfirmed or state.state == "stopping":
        return "stopped"
    if state.state in GOING or state.run is not None:
        return "busy"
    if state.state == "stopped" and now - state.since < RESTS_AFTER_STOP:
        return "stopped"
    if state.driven_by is not None:
        return "driven"
    if state.charging and battery is not None and battery < CHARGED:
        return "charging"
    return None


def in_the_name_of(appointment: Appointment) -> str:
    """How the run log calls who approved it."""
    words = texts_in(appointment.language, "schedules")["in_the_name_of"]
    return str(words).format(by=appointment.approved_by, number=appointment.id)
