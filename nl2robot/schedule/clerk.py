"""The clerk: looks at the book and the clock, and decides what begins, what waits, what was missed.

    begin = clerk.look(now, standing)

Without threads and without a robot: what the time is and how the robot stands goes in, at most one
occurrence to begin comes out, claimed already. All else that was decided is in the book, with a
notice of what somebody has to know.

| a time that came       | becomes                                                               |
|------------------------|-----------------------------------------------------------------------|
| and nothing stands in  | begun; of several the one with the highest priority, then the oldest  |
| the way                |                                                                       |
| the robot is not free, | waits; missed when that took `waits` (or `makes_up` of the            |
| or in quiet hours      | appointment, if longer)                                               |
| while nobody looked    | waits, if it is not older than `makes_up`; else missed                |
| again while it waits   | only the latest is done, those before are missed                      |
| of a paused one        | skipped                                                               |
| without an approval    | asked: somebody has to approve it anew                                |
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Final, Literal

import msgspec

from nl2robot.schedule.appointments import (
    DAY,
    ENDS_SOON,
    NONE,
    Appointment,
    Notice,
    NoticeKind,
    Occurrence,
    Why,
)
from nl2robot.schedule.book import Book
from nl2robot.schedule.findings import News
from nl2robot.schedule.outcomes import ACTED_ON, Outcome, Result, worst
from nl2robot.schedule.quiet import QuietHours
from nl2robot.schedule.rhythm import next_time, times

Waits = Literal[
    "busy",
    "driven",
    "charging",
    "stopped",
    "lost",
    "quiet",
    "turn",
    "going",
    "fleet",
    "doubled",
]
"""What something waits for: a program runs; somebody drives by hand; it has to charge; it was
stopped just now, or stops; it cannot be reached; quiet hours; another one begins first.

Of what any robot of the fleet may do: it is still being done; the robot that keeps it has joined no
fleet; another robot goes by that robot's id."""

ON_TIME: Final = 60.0
"""Seconds after its time until which it is no matter that nobody looked."""
WAITS_FOR_ROBOT: Final = 60.0
"""Seconds that what something happened for may wait: nobody is greeted who has gone on. `makes_up`
gives it longer."""
MISSED_AT_ONCE: Final = 50
"""Times of an appointment that were missed in one go and are in the book one by one; of more only
the latest are, and how many there were."""


_REMINDER_KINDS: Final[Mapping[Result, NoticeKind]] = {
    "no": "reminder_no",
    "unclear": "reminder_unclear",
    "silent": "reminder_silent",
    "away": "reminder_away",
    "gone": "reminder_gone",
}


class Settings(msgspec.Struct, frozen=True, kw_only=True):
    """What a house decides. Times are in seconds."""

    waits: float = 30 * 60.0
    """How long something waits for the robot at most."""
    quiet: QuietHours | None = None
    kept: float = 90 * DAY
    """How long what was done and told is kept."""


class Begin(msgspec.Struct, frozen=True):
    """What is to be reviewed and begun now; it is claimed."""

    occurrence: Occurrence
    appointment: Appointment


class Clerk:
    """Of one robot. One thread at a time may use it."""

    def __init__(self, book: Book, robot: str, settings: Settings | None = None) -> None:
        self._book = book
        self._robot = robot
        self._settings = settings or Settings()
        self._next: dict[int, tuple[float, float | None]] = {}
        """By appointment: until when it was looked at, and when it is due after that."""
        self._ends: dict[int, float] = {}
        """By appointment: of which end of its approval it is known that it was told before."""
        self._told = self._newest_notice()

    def look(
        self,
        now: float,
        waits_for: Waits | None = None,
        fleet_waits: Waits | None = "fleet",
        going: Collection[int] = (),
    ) -> Begin | None:
        """Write down what came since the last look, and what came of it; returns what to begin.
        `waits_for`: why the robot begins nothing now, None if it is free. `fleet_waits`: why
        nothing is handed out to its fleet. `going`: the numbers of the appointments that the fleet
        is busy with."""
        appointments = self._book.appointments(self._robot)
        for each in appointments:
            self._look_at_approval(each, now)
            if each.rhythm is not None:
                self._look_at_times(each, now)
        gone = self._next.keys() - {each.id for each in appointments}
        for number in gone:
            del self._next[number]
            self._ends.pop(number, None)

        def stands(appointment: Appointment) -> Waits | None:
            if appointment.fleet is None:
                return waits_for
            return fleet_waits or ("going" if appointment.id in going else None)

        return self._choose(now, stands)

    def next_look(self, now: float) -> float | None:
        """When the next time comes, in seconds since the epoch, as far as is known from the last
        look; None if none does. What waits is looked at sooner."""
        known = [moment for _, moment in self._next.values() if moment is not None]
        return min(known, default=None)

    def latest(self, occurrence: Occurrence, appointment: Appointment) -> float:
        """Until when it may be begun, in seconds since the epoch."""
        waits = self._settings.waits if appointment.trigger is None else WAITS_FOR_ROBOT
        return occurrence.due + max(waits, appointment.makes_up * 60.0)

    # --- what became of what was begun

    def not_begun(self, begin: Begin) -> None:
        """The robot was not free after all: it waits again."""
        self._book.release(begin.occurrence.id)

    def refused(self, begin: Begin, because: str) -> None:
        """It cannot be done at all, as a sentence says."""
        with self._book.at_once():
            if self._book.end(begin.occurrence.id, "failed", because):
                self._tell("refused", begin.appointment, begin.occurrence, because=because)

    def changed(self, begin: Begin, news: tuple[News, ...]) -> None:
        """Its review came out another way than the one that was approved: somebody has to approve
        it anew."""
        with self._book.at_once():
            if self._book.end(begin.occurrence.id, "asked", "changed"):
                self._book.ask(begin.appointment.id, "changed")
                parts = msgspec.to_builtins(news)
                self._tell("changed", begin.appointment, begin.occurrence, news=parts)

    def nobody(
        self, occurrence: Occurrence, appointment: Appointment, refused: Mapping[str, str]
    ) -> None:
        """No robot of the fleet took it in time, as those say that were asked, by name."""
        self._miss("missed", occurrence, appointment, "nobody", refused=dict(refused))

    def called_off(self, occurrence: Occurrence, appointment: Appointment, why: str | None) -> None:
        """No robot of the fleet was told to begin it, and none will be; None: somebody called it
        off."""
        if why == "overtaken":
            self._miss("overtaken", occurrence, appointment, why)
        elif why == "doubled":
            self._miss("missed", occurrence, appointment, why)
        elif why is not None and why == appointment.asked:
            self._book.end(occurrence.id, "asked", why)
        else:
            self._book.end(occurrence.id, "skipped", why or "unwanted")

    def moved(self, appointment: Appointment) -> None:
        """It is one of a fleet that another robot kept: not this one's to hand out, before somebody
        approves it for that."""
        with self._book.at_once():
            self._book.ask(appointment.id, "moved")
            self._tell("moved", appointment)

    def runs(self, occurrence: Occurrence, run: int) -> None:
        self._book.runs(occurrence.id, run)

    def ended(
        self,
        occurrence: Occurrence,
        appointment: Appointment,
        status: str | None,
        message: str | None,
        reminded: Sequence[Outcome] = (),
    ) -> None:
        """Its run is over: `status` and `message` as the run log has them; None for a run, or a
        beginning, that was broken off with its process. `reminded`: what came of it, if it
        reminded somebody."""
        with self._book.at_once():
            result = worst(reminded)
            if status == "done":
                note = f"reminder_{result}" if result is not None else None
                if self._book.end(occurrence.id, "done", note):
                    self._tell_reminders(reminded, appointment, occurrence)
            elif status is None:
                if self._book.end(occurrence.id, "failed", "broken_off"):
                    self._tell("broken_off", appointment, occurrence, run=occurrence.run)
                    self._tell_reminders(reminded, appointment, occurrence)
            elif self._book.end(occurrence.id, "failed", message or status):
                self._tell("failed", appointment, occurrence, status=status, because=message)
                self._tell_reminders(reminded, appointment, occurrence)

    def reminded(self, run: int, began: float, sentence: str, found: Sequence[Outcome]) -> None:
        """What came of a reminder that somebody had said at once."""
        about = {"sentence": sentence, "due": began, "run": run, "robot": self._robot}
        with self._book.at_once():
            for kind, parts in _to_act_on(found):
                self._book.tell(kind, NONE, None, {**about, **parts})

    # --- what was told

    def notices(self) -> list[Notice]:
        """Those that were written since the last call, by any process, in order; without trouble,
        which whoever had it has told already."""
        found = self._book.notices(self._told)
        if found:
            self._told = found[-1].id
        return [each for each in found if each.kind != "trouble"]

    # --- inside

    def _newest_notice(self) -> int:
        newest = self._book.notices(last=1)
        return newest[-1].id if newest else 0

    def _look_at_approval(self, appointment: Appointment, now: float) -> None:
        if appointment.asked is not None:
            return
        ends, rhythm = appointment.approved_until, appointment.rhythm
        if ends <= now:
            if rhythm is not None and next_time(rhythm, appointment.looked) is None:
                return  # nothing more would come
            with self._book.at_once():
                self._book.ask(appointment.id, "ended")
                self._tell("ended", appointment, by=appointment.approved_by)
        elif ends - now <= ENDS_SOON < ends - appointment.approved_at:
            self._look_ahead(appointment)

    def _look_ahead(self, appointment: Appointment) -> None:
        """Tell once that its approval ends, if it would come again after that."""
        ends, rhythm = appointment.approved_until, appointment.rhythm
        if self._ends.get(appointment.id) == ends:
            return
        self._ends[appointment.id] = ends
        if rhythm is not None and next_time(rhythm, ends) is None:
            return
        with self._book.at_once():
            if not self._book.was_told("ends_soon", appointment.id, appointment.approved_at):
                self._tell("ends_soon", appointment, by=appointment.approved_by, ends=ends)

    def _look_at_times(self, appointment: Appointment, now: float) -> None:
        assert appointment.rhythm is not None
        # The clock may have been set back; what is in the book by then is not noted again.
        since = min(appointment.looked, now)
        known = self._next.get(appointment.id)
        if known is None or known[0] != since:
            known = (since, next_time(appointment.rhythm, since))
            self._next[appointment.id] = known
        if known[1] is None:
            self._book.finish(appointment.id)
            return
        if known[1] > now:
            return
        came = list(itertools.takewhile(lambda due: due <= now, times(appointment.rhythm, since)))
        with self._book.at_once():
            # Another process may have removed it, or looked already.
            fresh = self._fresh(appointment)
            if fresh is not None and fresh.looked == appointment.looked:
                self._note(fresh, came, now)
                self._book.look_until(appointment.id, now)
                self._next[appointment.id] = (now, next_time(appointment.rhythm, now))

    def _fresh(self, appointment: Appointment) -> Appointment | None:
        each = (each for each in self._book.appointments(self._robot) if each.id == appointment.id)
        return next(each, None)

    def _note(self, appointment: Appointment, came: list[float], now: float) -> None:
        """Write down times that came."""
        if appointment.paused:
            for due in came[-MISSED_AT_ONCE:]:
                self._book.come(appointment.id, due, "skipped", "paused")
            return
        late = max(ON_TIME, appointment.makes_up * 60.0)
        missed = [due for due in came if now - due > late]
        self._note_missed(appointment, missed)
        for due in came[len(missed) :]:
            why = self._unapproved(appointment, due)
            if why is not None:
                self._book.come(appointment.id, due, "asked", why)
            else:
                self._book.come(appointment.id, due)

    def _note_missed(self, appointment: Appointment, missed: list[float]) -> None:
        noted = []
        for due in missed[-MISSED_AT_ONCE:]:
            why = self._unapproved(appointment, due)
            state: Literal["asked", "missed"] = "missed" if why is None else "asked"
            occurrence = self._book.come(appointment.id, due, state, why or "nobody_looked")
            if occurrence is not None and state == "missed":
                noted.append(occurrence)
        if len(noted) == 1:
            self._tell("missed", appointment, noted[0], why="nobody_looked")
        elif noted:
            count = len(noted) + max(0, len(missed) - MISSED_AT_ONCE)
            first = missed[0]
            self._tell("missed_many", appointment, noted[-1], count=count, first=first)

    def _unapproved(self, appointment: Appointment, due: float) -> Why | None:
        """Why it had no approval at that time."""
        if appointment.asked == "ended" and due < appointment.approved_until:
            return None
        return appointment.asked

    def _choose(self, now: float, stands: Callable[[Appointment], Waits | None]) -> Begin | None:
        waiting = list(self._not_too_late(now, stands))
        quiet = self._settings.quiet is not None and self._settings.quiet.cover(now)
        begin = None
        for occurrence, appointment in waiting:
            waits_for = stands(appointment) or ("quiet" if quiet else None)
            if begin is None and waits_for is None:
                if self._book.claim(occurrence.id):
                    begin = Begin(self._book.occurrence(occurrence.id), appointment)
                continue
            self._wait(occurrence, appointment, waits_for or "turn")
        return begin

    def _not_too_late(
        self, now: float, stands: Callable[[Appointment], Waits | None]
    ) -> Iterator[tuple[Occurrence, Appointment]]:
        """What waits, and may still: by priority, then by time."""
        latest: dict[int, float] = defaultdict(float)
        waiting = self._book.waiting(self._robot)
        for occurrence, appointment in waiting:
            latest[appointment.id] = max(latest[appointment.id], occurrence.due)
        for occurrence, appointment in waiting:
            if appointment.paused:
                self._book.end(occurrence.id, "skipped", "paused")
            elif appointment.asked is not None:
                self._book.end(occurrence.id, "asked", appointment.asked)
            elif occurrence.due < latest[appointment.id]:
                self._miss("overtaken", occurrence, appointment, "overtaken")
            elif now > self.latest(occurrence, appointment):
                why = occurrence.waited_for or stands(appointment) or "nobody_looked"
                self._miss("missed", occurrence, appointment, why)
            else:
                yield occurrence, appointment

    def _miss(
        self,
        kind: Literal["missed", "overtaken"],
        occurrence: Occurrence,
        appointment: Appointment,
        why: str,
        **parts: object,
    ) -> None:
        with self._book.at_once():
            if self._book.end(occurrence.id, "missed", why):
                self._tell(kind, appointment, occurrence, why=why, **parts)

    def _tell_reminders(
        self, found: Sequence[Outcome], appointment: Appointment, occurrence: Occurrence
    ) -> None:
        for kind, parts in _to_act_on(found):
            self._tell(kind, appointment, occurrence, run=occurrence.run, **parts)

    def _wait(self, occurrence: Occurrence, appointment: Appointment, why: Waits) -> None:
        """Note what it waits for, and tell it the first time."""
        if occurrence.waited_for == why:
            return
        with self._book.at_once():
            self._book.wait_for(occurrence.id, why)
            if occurrence.waited_for is None and why != "turn":
                self._tell("waits", appointment, occurrence, why=why)

    def _tell(
        self,
        kind: NoticeKind,
        appointment: Appointment,
        occurrence: Occurrence | None = None,
        **parts: object,
    ) -> None:
        known: dict[str, object] = {"sentence": appointment.sentence}
        if appointment.rhythm is not None:
            known["zone"] = appointment.rhythm.zone
        if occurrence is not None:
            known["due"] = occurrence.due
        self._book.tell(
            kind, appointment.id, occurrence.id if occurrence else None, {**known, **parts}
        )


def _to_act_on(found: Sequence[Outcome]) -> Iterator[tuple[NoticeKind, dict[str, object]]]:
    """What of a reminder somebody has to see to, and what the notice is about."""
    for each in found:
        if each.result in ACTED_ON:
            about: dict[str, object] = {
                "person": each.person,
                "what": each.what,
                "question": each.question,
            }
            yield _REMINDER_KINDS[each.result], about
