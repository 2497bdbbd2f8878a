"""Programs that somebody proposes who may not approve them: an assistant, another system.

A proposal is reviewed as it comes in, waits for a person, and is approved (and then runs),
declined, withdrawn or out of date. It is kept in memory alone: it does not outlive the server, for
nobody should find at noon what an assistant thought in the morning. The main path: `make`, then a
person's `approve` or `decline`; whoever proposed it waits with `wait`.

An assistant can be talked into anything by what it reads. So it can do nothing here but ask, only
so often, and only so many things at a time.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final, Literal, NamedTuple

import msgspec

from nl2robot.errors import UserError
from nl2robot.review.review import Review, digest
from nl2robot.run.runner import Runner
from robot_api.errors import AccessDenied

HOLDS: Final = 600.0
"""Seconds for which a proposal waits for a decision; as long as an approval holds."""
MOST_WAITING: Final = 3
"""Of one proposer at a time: more is more than a person reads."""
MOST_WAITING_IN_ALL: Final = 12
MOST_A_MINUTE: Final = 6
"""Of one proposer: each is tried in the simulator."""
MOST_A_MINUTE_IN_ALL: Final = 24
FOR_ACCOUNTS: Final = 4
"""The part of all that, one in so many, that only proposers with an account can have: who has none
is known by a connection and a name that they chose, and may come again and again as another."""
KEPT: Final = 200
"""Proposals that are over and can still be asked about."""
LOOKS_EVERY: Final = 0.5
"""Seconds between two looks whether something is out of date."""

KIND: Final = "proposal"
EVENTS: Final[Mapping[str, str]] = {
    KIND: "id, state (waiting | approved | declined | withdrawn | expired), by, sentence, why,"
    " at, and once it is decided decided_by, reason, run: a program was proposed, or one that"
    " waited is decided"
}
"""The events that proposals publish; without the program."""

_PROPOSED_BY: Final = " (proposed by "
"""In the log, behind whoever approved it."""

State = Literal["waiting", "approved", "declined", "withdrawn", "expired"]


class Proposal(msgspec.Struct, frozen=True, kw_only=True):
    """A program that somebody proposes, and what came of it."""

    id: int
    program: str
    sha256: str
    sentence: str
    """What it is to do, in the proposer's words."""
    why: str = ""
    """What somebody should know who decides, in the proposer's words."""
    by: str
    account: str = ""
    """What they came in by; empty for all that have no account of their own."""
    connection: str = ""
    """The one that it was made over."""
    language: str
    at: float
    """Seconds since the epoch, as all times here."""
    until: float
    state: State = "waiting"
    decided_at: float | None = None
    decided_by: str | None = None
    reason: str | None = None
    run: int | None = None
    """The run that it became."""
    ran: str | None = None
    """The program that was approved instead, if somebody changed it by hand."""


def check_waits(found: Proposal) -> None:
    """Raises `UserError` if nobody can decide on it any more."""
    match found.state:
        case "withdrawn":
            raise UserError(
                f"{found.by} has withdrawn proposal {found.id}. There is nothing to do."
            )
        case "expired":
            raise UserError(
                f"Proposal {found.id} has waited too long and does not hold any more. Whoever made"
                " it may make it again."
            )
        case "approved":
            raise UserError(f"Proposal {found.id} was approved by {found.decided_by} already.")
        case "declined":
            raise UserError(f"Proposal {found.id} was declined by {found.decided_by} already.")


def approved_and_proposed(who: str) -> tuple[str, str]:
    """Whoever approved a run and whoever proposed it, of what the log has; "" if nobody did."""
    approved, _, proposed = who.partition(_PROPOSED_BY)
    return approved, proposed.removesuffix(")")


class Proposer(NamedTuple):
    """For whom limits hold: an account, whatever it calls itself; without one a name at a
    connection, for several assistants may come over the same."""

    account: str
    connection: str = ""
    name: str = ""


class Made(msgspec.Struct, frozen=True, kw_only=True):
    """A proposal that waits, with what its review says to whoever made it."""

    proposal: Proposal
    review: Review


class Proposals:
    """Those of one robot. Any thread may use it."""

    def __init__(
        self,
        runner: Runner,
        publish: Callable[[str, Mapping[str, Any]], None],
        clock: Callable[[], float] = time.time,
    ) -> None:
        self._runner = runner
        self._publish = publish
        self._clock = clock
        self._changed = threading.Condition()
        self._known: dict[int, Proposal] = {}
        """By number, the oldest first."""
        self._tries: deque[tuple[float, Proposer]] = deque()
        """When which proposer tried, within the last minute."""

    # --- whoever proposes

    def make(
        self,
        program: str,
        sentence: str,
        by: str,
        why: str = "",
        language: str = "en",
        account: str = "",
        connection: str = "",
    ) -> Made:
        """Review a program, and lay it before the people who decide. `account`: what they came in
        by. Raises `UserError` if it has an error, or if this proposer, or all of them, ask too
        much."""
        proposer = _proposer(account, connection, by)
        self._check_pace(proposer)
        review = self._runner.check(program, language)
        error = next((each for each in review.findings if each.severity == "error"), None)
        if error is not None:
            raise UserError(
                f"Nobody is asked to approve a program with an error: line {error.line}:"
                f" {error.message}"
            )
        now = self._clock()
        with self._changed:
            # Once more: several may have been reviewed at the same time.
            self._check_room(proposer)
            made = Proposal(
                id=self._runner.log.next_proposal(),
                program=program,
                sha256=digest(program),
                sentence=sentence,
                why=why,
                by=by,
                account=account,
                connection=connection,
                language=language,
                at=now,
                until=now + HOLDS,
            )
            self._known[made.id] = made
            self._forget()
        self._tell(made)
        return Made(proposal=made, review=review)

    def withdraw(self, number: int, account: str = "", connection: str = "") -> Proposal:
        """Whoever proposed it does not want it any more: the same account, or without one the same
        connection. Raises `UserError`."""
        self._expire()
        with self._changed:
            found = self._one(number)
            mine = found.account == account and (account or found.connection == connection)
            if not mine:
                raise UserError(f"Proposal {number} is somebody else's. Leave it to them.")
            decided = self._decide(number, "withdrawn", found.by)
        self._tell(decided)
        return decided

    def wait(self, number: int, seconds: float, over: Callable[[], bool]) -> Proposal:
        """Until it is decided, the time is up, or it is `over` for whoever waits."""
        ends = time.monotonic() + seconds
        while True:
            found = self.one(number)
            left = ends - time.monotonic()
            if found.state != "waiting" or left <= 0 or over():
                return found
            with self._changed:
                self._changed.wait(min(left, LOOKS_EVERY))

    # --- everybody

    def one(self, number: int) -> Proposal:
        """Raises `UserError` if there is none."""
        self._expire()
        with self._changed:
            return self._one(number)

    def all(self) -> list[Proposal]:
        """The newest last."""
        self._expire()
        with self._changed:
            return list(self._known.values())

    def waiting(self) -> list[Proposal]:
        """The one that waits longest first."""
        return [each for each in self.all() if each.state == "waiting"]

    # --- whoever decides

    def approve(
        self,
        number: int,
        sha256: str,
        by: str,
        *,
        program: str | None = None,
        insists: bool = False,
    ) -> Proposal:
        """Approve exactly the program with this SHA-256, and begin it. `program`: as somebody who
        decides has changed it by hand. Raises `AccessDenied`, `NotPossible` or `UserError`; then it
        waits on."""
        self._expire()
        with self._changed:
            asked = self._waiting(number)
        text = asked.program if program is None else program
        if digest(text) != sha256:
            raise AccessDenied(
                "The program was changed after its review. Review it again, then approve it."
            )
        # Which may take as long as a dry run: meanwhile it can be withdrawn, or declined.
        approval = self._runner.approve(
            text,
            sha256,
            f"{by}{_PROPOSED_BY}{asked.by})",
            utterance=f"{asked.by}: {asked.sentence}",
            language=asked.language,
            proposed=asked.program,
            changed_by=by,
            insists=insists,
        )
        with self._changed:
            self._waiting(number)
            run = self._runner.run(approval.id)
            decided = self._note_run(number, by, run, text)
        self._tell(decided)
        return decided

    def approved(self, number: int, by: str, run: int, program: str) -> None:
        """It was approved where it was laid before somebody, and runs there."""
        with self._changed:
            if self._known[number].state != "waiting":
                return
            decided = self._note_run(number, by, run, program)
        self._tell(decided)

    def decline(self, number: int, by: str, reason: str | None = None) -> Proposal:
        """Say no to it. Raises `UserError` if it is decided."""
        self._expire()
        with self._changed:
            self._waiting(number)
            decided = self._decide(number, "declined", by, reason=reason)
        self._tell(decided)
        return decided

    # --- inside

    def _one(self, number: int) -> Proposal:
        """With the lock. Raises `UserError` if there is none."""
        found = self._known.get(number)
        if found is None:
            raise UserError(
                f"There is no proposal {number} (any more). `nl2robot proposals` lists those that"
                " wait."
            )
        return found

    def _waiting(self, number: int) -> Proposal:
        """That one, which nobody has decided; with the lock. Raises `UserError`."""
        found = self._one(number)
        check_waits(found)
        return found

    def _decide(self, number: int, state: State, by: str | None, **more: Any) -> Proposal:
        """With the lock."""
        if state != "expired":
            self._waiting(number)
        decided = msgspec.structs.replace(
            self._known[number], state=state, decided_at=self._clock(), decided_by=by, **more
        )
        self._known[number] = decided
        self._changed.notify_all()
        return decided

    def _note_run(self, number: int, by: str, run: int, program: str) -> Proposal:
        """With the lock."""
        changed = program != self._known[number].program
        return self._decide(number, "approved", by, run=run, ran=program if changed else None)

    def _expire(self) -> None:
        now = self._clock()
        with self._changed:
            late = [
                each.id
                for each in self._known.values()
                if each.state == "waiting" and each.until <= now
            ]
            decided = [self._decide(number, "expired", None) for number in late]
        for each in decided:
            self._tell(each)

    def _check_pace(self, proposer: Proposer) -> None:
        """Raises `UserError` if this proposer, or all of them, have tried too often."""
        self._expire()
        now = time.monotonic()
        with self._changed:
            self._check_room(proposer)
            while self._tries and self._tries[0][0] <= now - 60.0:
                self._tries.popleft()
            own = [when for when, by in self._tries if by == proposer]
            if wait := _wait(own, MOST_A_MINUTE, now):
                raise UserError(
                    f"{MOST_A_MINUTE} proposals a minute are the most. Wait {wait:.0f} seconds."
                )
            everybody = [when for when, _ in self._tries]
            strangers = [when for when, by in self._tries if not by.account]
            wait = _wait(everybody, MOST_A_MINUTE_IN_ALL, now)
            if not proposer.account:
                wait = max(wait, _wait(strangers, _of_strangers(MOST_A_MINUTE_IN_ALL), now))
            if wait:
                raise UserError(
                    "All assistants together have proposed too much in the last minute. Wait"
                    f" {wait:.0f} seconds."
                )
            self._tries.append((now, proposer))

    def _check_room(self, proposer: Proposer) -> None:
        """With the lock. Raises `UserError` if too much waits already."""
        waiting = [
            _proposer(each.account, each.connection, each.by)
            for each in self._known.values()
            if each.state == "waiting"
        ]
        if waiting.count(proposer) >= MOST_WAITING:
            raise UserError(
                f"{MOST_WAITING} proposals by you wait for a person already. Wait until one is"
                " decided, or withdraw one."
            )
        if len(waiting) >= MOST_WAITING_IN_ALL:
            raise UserError(
                f"{MOST_WAITING_IN_ALL} proposals wait for a person already. Try again later."
            )
        most = _of_strangers(MOST_WAITING_IN_ALL)
        if not proposer.account and sum(not each.account for each in waiting) >= most:
            raise UserError(
                f"{most} proposals of assistants without a token of their own wait for a person"
                " already. Try again later, or ask for a token (`nl2robot accounts token NAME`)."
            )

    def _forget(self) -> None:
        """What is over longest; with the lock."""
        over = [each.id for each in self._known.values() if each.state != "waiting"]
        for number in over[: max(0, len(over) - KEPT)]:
            del self._known[number]

    def _tell(self, proposal: Proposal) -> None:
        """Everybody who looks on. Not with the lock, for the listener may ask."""
        told: dict[str, Any] = msgspec.to_builtins(proposal)
        for left_out in ("program", "ran", "account", "connection"):
            del told[left_out]
        self._publish(KIND, told)


def _proposer(account: str, connection: str, name: str) -> Proposer:
    return Proposer(account) if account else Proposer("", connection, name)


def _of_strangers(most: int) -> int:
    """What is left of a limit to those without an account."""
    return most - most // FOR_ACCOUNTS


def _wait(tries: Sequence[float], most: int, now: float) -> float:
    """Seconds until one more is within so many a minute; 0 if it is."""
    return max(1.0, 60.0 - (now - tries[-most])) if len(tries) >= most else 0.0
