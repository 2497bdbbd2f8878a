"""Whether a driver tells the truth about a robot that it cannot reach, and takes nothing up again.

Each check connects a driver of its own through a `Proxy` and does something to the link.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace

from robot_api.conformance.behaviour import check_call, check_event
from robot_api.conformance.link import Proxy
from robot_api.conformance.samples import long_movements
from robot_api.conformance.subject import (
    ON_THE_WAY,
    Attempt,
    Findings,
    Subject,
    confirmed,
    honest,
)
from robot_api.driver import Driver
from robot_api.errors import AccessDenied, LostConnection, NotSupported, RobotError, Stopped
from robot_api.robots.address import Address

Connect = Callable[[Address], Driver]
"""Makes a driver for the robot at that address; raises `RobotError`s, as `RobotKind.connect`."""

LOST_WITHIN = 10.0
"""Seconds in which a driver must notice that the robot cannot be reached."""
FOUND_WITHIN = 15.0
"""Seconds in which it must notice that it can be again."""
STANDS_WITHIN = 3.0
"""Seconds in which the robot must stand by itself when nobody can reach it any more."""
_SLOW = 0.2
"""Seconds that a slow link takes, each way."""
_TRIES = 6
_PAUSE = 0.1
"""Seconds between two attempts of the same."""
_NEWS = 1.0
"""Seconds in which an event must have come."""
_ASKED = "battery"
"""A method that every robot has and that asks the robot itself."""


def check_link(connect: Connect, address: Address, move: bool, findings: Findings) -> None:
    """Everything about the link and about two clients; the robot must be there."""
    losing = Losing(connect, address, move, findings)
    findings.tried.add("two clients")
    losing.two_clients()
    if not losing.goes_by_the_link():
        return
    findings.tried.add("link")
    losing.nobody_there()
    losing.answers_nothing()
    losing.answers_nonsense()
    losing.slow()
    losing.lost("was cut", Proxy.cut)
    losing.lost("froze", Proxy.freeze)
    losing.garbled()


class Losing:
    """The robot at an address, reached by a link that fails in one way after the other."""

    def __init__(self, connect: Connect, address: Address, move: bool, findings: Findings) -> None:
        self.connect = connect
        self.address = address
        self.move = move
        self.findings = findings

    def wrong(self, message: str, part: str = "link") -> None:
        self.findings.wrong(part, None, message)

    def goes_by_the_link(self) -> bool:
        """Whether the driver can be reached by a link that fails; else there is a note of why."""
        if self.address.port is None:
            self.findings.notes["link"] = "its address names no port, so it was never cut"
            return False
        with self.proxy() as link:
            try:
                with self.subject(link):
                    pass  # it is stopped in the end, which nobody does without asking the robot
            except RobotError as error:
                self.findings.notes["link"] = f"it cannot be reached through a proxy: {error}"
                return False
        if not link.passed:
            self.findings.notes["link"] = "the driver goes past the address, so it was never cut"
        return link.passed > 0

    # --- connecting ------------------------------------------------------------------------------

    def nobody_there(self) -> None:
        with self.proxy() as link:
            link.cut()
            self.refused(link, "where nobody is")

    def answers_nothing(self) -> None:
        with self.proxy() as link:
            link.freeze()
            self.refused(link, "to what never answers")

    def answers_nonsense(self) -> None:
        with self.proxy() as link:
            link.garble()
            # That may as well be a robot of another kind, or one that wants another login.
            known = (LostConnection, NotSupported, AccessDenied)
            self.refused(link, "to what answers nonsense", *known)

    def refused(self, link: Proxy, where: str, *errors: type[RobotError]) -> None:
        """Connecting raises one of the errors in time, `LostConnection` if none are given."""
        attempt = Attempt(lambda flag: self.connect(self.through(link)))
        if not attempt.returned(FOUND_WITHIN):
            self.wrong(f"connecting {where} takes more than {FOUND_WITHIN:g} s")
        elif isinstance(attempt.error, errors or LostConnection):
            self.findings.check_sentence("link", None, attempt.error)
        else:
            self.wrong(f"connecting {where} {attempt.outcome}, and raised no LostConnection")
            if attempt.error is None:
                attempt.result.close()

    # --- a slow link -----------------------------------------------------------------------------

    def slow(self) -> None:
        """Late answers are answers; a stop is not confirmed before it can have come there."""
        with self.proxy() as link, self.subject(link) as subject:
            start = len(subject.heard)
            link.delay(_SLOW)
            check_call(subject, "link", _ASKED, {})
            stop = subject.stop("The check stops the robot over a slow link.")
            self.stop_in_time(subject, stop, "over a slow link")
            if confirmed(stop) and stop.ended - stop.began < _SLOW:
                self.wrong(
                    "a stop was confirmed before it can have reached the robot over a slow link"
                )
            if subject.heard.wait_for("link", start, 0, state="lost"):
                self.wrong("a slow link counts as a lost one")
            link.mend()

    def stop_in_time(self, subject: Subject, stop: Attempt, when: str) -> bool:
        """Whether it returned; it must within the time that the driver states."""
        if not stop.returned():
            self.wrong(f"a stop did not return {when}")
            return False
        tries = 1
        while stop.ended - stop.began > subject.has.stop_within + ON_THE_WAY and tries < _TRIES:
            stop = subject.stop("The check stops the robot.")
            stop.returned()
            tries += 1
        took = stop.ended - stop.began
        if took > subject.has.stop_within + ON_THE_WAY:
            self.wrong(f"a stop took {took * 1000:.0f} ms {when}")
        return True

    # --- a lost robot ----------------------------------------------------------------------------

    def lost(self, what: str, lose: Callable[[Proxy], None]) -> None:
        """Everybody is told, nobody waits, the robot stands, and nothing is resumed."""
        when = f"when the link {what}"
        with self.proxy() as link, self.subject(link) as subject:
            waiting = subject.begin_one([("wait", {"seconds": 86400})])
            moving = subject.begin_one(long_movements(subject))
            start = len(subject.heard)
            lose(link)
            began = time.monotonic()
            self.told(subject, start, "lost", LOST_WITHIN, when)
            for name, call in filter(None, (waiting, moving)):
                left = LOST_WITHIN - (time.monotonic() - began)
                self.ended(name, call, max(left, _NEWS), when)
            if moving is not None:
                self.robot_stands(began, f"the link {what}")
            self.asked_in_vain(subject, when)
            self.stop_is_honest(subject, when)
            start = len(subject.heard)
            link.mend()
            self.found_again(subject, start, f"after the link {what}")

    def told(self, subject: Subject, start: int, state: str, within: float, when: str) -> None:
        if not subject.heard.wait_for("link", start, within, state=state):
            self.wrong(f"sent no event 'link' with the state {state!r} {when}")
        for kind, data in subject.heard.since(start):
            if kind == "link":
                check_event(subject, kind, data)

    def ended(self, name: str, call: Attempt, within: float, when: str) -> None:
        if not call.returned(within):
            self.findings.wrong("link", name, f"did not come back within {LOST_WITHIN:g} s {when}")
        elif not isinstance(call.error, LostConnection):
            self.findings.wrong(
                "link", name, f"{call.outcome} {when}, and raised no LostConnection"
            )
        else:
            self.findings.check_sentence("link", name, call.error)

    def asked_in_vain(self, subject: Subject, when: str) -> None:
        """New calls are refused, in time."""
        self.ended(_ASKED, subject.begin(_ASKED, {}), LOST_WITHIN, when)

    def stop_is_honest(self, subject: Subject, when: str) -> None:
        start = len(subject.heard)
        stop = subject.stop("The check stops a robot that cannot be reached.")
        if not self.stop_in_time(subject, stop, when):
            return
        if not honest(stop):
            self.wrong(f"a stop {stop.outcome} {when}, and raised no StopNotConfirmed")
        if not subject.heard.wait_for("stop_not_confirmed", start, _NEWS):
            self.wrong(f"a stop sent no event 'stop_not_confirmed' {when}")
        if subject.heard.wait_for("stopped", start, 0):
            self.wrong(f"a stop sent the event 'stopped' {when}")

    def robot_stands(self, began: float, what: str, part: str = "link") -> None:
        """The robot itself comes to rest when nobody drives it; seen over another link."""
        try:
            witness = self.connect(self.address)
        except RobotError as error:
            self.findings.notes[part] = f"whether it stands alone was not seen: {error}"
            return
        with self.looking_at(witness) as subject:
            moves = subject.moves_on()
            while moves and time.monotonic() - began < STANDS_WITHIN:
                moves = subject.moves_on()
            if moves:
                self.wrong(f"the robot {moves} {STANDS_WITHIN:g} s after {what}", part)

    def found_again(self, subject: Subject, start: int, when: str) -> None:
        """It is found by itself, works as before, and goes on with nothing."""
        self.told(subject, start, "connected", FOUND_WITHIN, when)
        until = time.monotonic() + FOUND_WITHIN
        result = subject.try_to(_ASKED)
        while isinstance(result, BaseException) and time.monotonic() < until:
            time.sleep(_PAUSE)
            result = subject.try_to(_ASKED)
        if isinstance(result, BaseException):
            self.wrong(f"{_ASKED} does not work again {when}: {result}")
            return
        moves = subject.moves_on() if self.move else ""
        if moves:
            self.wrong(f"the robot {moves} {when} was mended, without being asked")

    # --- nonsense --------------------------------------------------------------------------------

    def garbled(self) -> None:
        """Nonsense is a named error, no stop is believed, and afterwards all is well again."""
        when = "when the robot answers nonsense"
        with self.proxy() as link, self.subject(link) as subject:
            link.garble()
            call = subject.begin(_ASKED, {})
            if not call.returned(LOST_WITHIN):
                wrong = f"did not come back within {LOST_WITHIN:g} s {when}"
                self.findings.wrong("link", _ASKED, wrong)
            elif isinstance(call.error, RobotError):
                self.findings.check_sentence("link", _ASKED, call.error)
            elif call.error is not None:
                self.findings.wrong("link", _ASKED, f"{call.outcome} {when}")
            self.stop_is_honest(subject, when)
            start = len(subject.heard)
            link.mend()
            if subject.heard.wait_for("link", 0, 0, state="lost"):
                self.found_again(subject, start, "after nonsense")

    # --- two clients -----------------------------------------------------------------------------

    def two_clients(self) -> None:
        """Both may ask; either stops the robot. A robot may also refuse the second, in words."""
        with self.looking_at(self.connect(self.address)) as first:
            try:
                other = self.connect(self.address)
            except RobotError as error:
                self.findings.check_sentence("two clients", None, error)
                self.findings.notes["two clients"] = f"the second is refused: {error}"
                return
            with self.looking_at(other) as second:
                for subject in (first, second):
                    check_call(subject, "two clients", _ASKED, {})
                self.stopped_by_another(first, second)

    def stopped_by_another(self, first: Subject, second: Subject) -> None:
        moving = first.begin_one(long_movements(first))
        if moving is None:
            return
        name, call = moving
        start = len(second.heard)
        stop = second.stop("The second client stops the robot.")
        if not stop.returned() or not confirmed(stop):
            self.wrong(f"a stop by another client {stop.outcome}", "two clients")
        if not second.heard.wait_for("stopped", start, _NEWS):
            self.wrong("a stop by another client sent no event 'stopped'", "two clients")
        moves = second.moves_on()
        if moves:
            self.wrong(f"the robot {moves} after another client stopped it", "two clients")
        if not call.returned():
            note = f"{name} does not learn that another client stopped the robot"
            self.findings.notes["two clients"] = note
            first.stop("The check stops the robot.", call).returned()
        elif not isinstance(call.error, RobotError | Stopped):
            message = f"{call.outcome} when another client stopped the robot"
            self.findings.wrong("two clients", name, message)

    # --- the robot and the link ------------------------------------------------------------------

    def proxy(self) -> Proxy:
        assert self.address.port is not None
        return Proxy(self.address.host, self.address.port)

    def through(self, link: Proxy) -> Address:
        return replace(self.address, host=link.host, port=link.port)

    @contextmanager
    def subject(self, link: Proxy) -> Iterator[Subject]:
        """A driver that reaches the robot by that link."""
        with self.looking_at(self.connect(self.through(link))) as subject:
            yield subject

    @contextmanager
    def looking_at(self, driver: Driver) -> Iterator[Subject]:
        subject = Subject(driver, self.move, self.findings)
        try:
            yield subject
        finally:
            subject.let_go()
            with contextlib.suppress(RobotError):
                driver.close()
