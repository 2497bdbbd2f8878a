"""The driver that is looked at: calling it, hearing its events, noting what is wrong."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable, Mapping
from typing import Any

from robot_api.conformance.report import PARTS, Problem, Report, Row, State
from robot_api.driver import Driver, Event, StopFlag
from robot_api.errors import LostConnection, RobotError, StopNotConfirmed
from robot_api.interfaces import INTERFACES
from robot_api.methods import CAPABILITIES, METHODS

ON_THE_WAY = 0.05
"""Seconds that a stop or an answer may take besides what the driver states."""
UNDER_WAY = 0.05
"""Seconds after which a call that has not returned counts as under way."""
GIVE_UP = 10.0
"""Seconds after which a call that does not come back is left alone."""
_LONGEST = 300.0
"""Seconds that a call of the suite may take that is left to end by itself."""
_WATCHED = 0.2
"""Seconds for which a robot that should stand is watched."""
_MOVED = (0.03, 3.0)
"""Metres and degrees that a robot that stands may differ by, as its map and its odometry do."""
_LOSES, _FOUND_AGAIN = 2, 1.0
"""How often it may be lost in a call that is to be refused, and for how many seconds."""
_CREEPS = 0.02
"""Metres per second at which a robot counts as moving."""


class DidNotReturn(RobotError):
    """A call that came to no end in time; it was given up."""


class Findings:
    """What is wrong with a driver, part by part."""

    def __init__(self) -> None:
        self.problems: list[Problem] = []
        self.notes: dict[str, str] = {}
        """For a part, why it was not looked at."""
        self.tried: set[str] = set()
        """The parts that were looked at, besides the capabilities."""

    def wrong(self, part: str, method: str | None, message: str) -> None:
        problem = Problem(method, message, part)
        if problem not in self.problems:
            self.problems.append(problem)

    def check_sentence(self, part: str, method: str | None, error: RobotError) -> None:
        text = str(error)
        if not text.strip() or text[-1] not in ".?!" or "\n" in text:
            self.wrong(
                part, method, f"the message of {type(error).__name__} is no sentence: {text!r}"
            )


class Attempt:
    """Something that may not come back, such as a call, in a thread of its own."""

    def __init__(self, do: Callable[[StopFlag], Any]) -> None:
        self.flag = StopFlag()
        self.result: Any = None
        self.error: BaseException | None = None
        self.began = time.monotonic()
        self.ended = self.began
        self._do = do
        self._thread = threading.Thread(target=self._run, name="conformance", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        try:
            self.result = self._do(self.flag)
        except BaseException as error:  # noqa: BLE001 - looked at by who waits for it
            self.error = error
        finally:
            self.ended = time.monotonic()

    def returned(self, within: float | None = None) -> bool:
        """Wait so many seconds for the end, `GIVE_UP` at most; whether it came."""
        self._thread.join(GIVE_UP if within is None else within)
        return not self._thread.is_alive()

    @property
    def outcome(self) -> str:
        """What came of it, in words."""
        if self.error is not None:
            return f"raised {type(self.error).__name__}"
        return f"returned {self.result!r}"


class Heard:
    """The events of a driver, in the order in which they came."""

    def __init__(self) -> None:
        self._events: list[tuple[str, Event]] = []
        self._news = threading.Condition()  # guards the above

    def __call__(self, kind: str, data: Event) -> None:
        with self._news:
            self._events.append((kind, data))
            self._news.notify_all()

    def __len__(self) -> int:
        return len(self._events)

    def since(self, start: int = 0) -> list[tuple[str, Event]]:
        """From the event of that number on."""
        with self._news:
            return self._events[start:]

    def wait_for(self, kind: str, start: int, within: float, **fields: Any) -> bool:
        """Whether such an event comes, from that number on, within so many seconds."""
        with self._news:
            return self._news.wait_for(
                lambda: any(
                    heard == kind and fields.items() <= dict(data).items()
                    for heard, data in self._events[start:]
                ),
                within,
            )


class Subject:
    """A driver, with what it says of itself. `move`: whether it may be set in motion."""

    def __init__(self, driver: Driver, move: bool, findings: Findings) -> None:
        self.driver = driver
        self.move = move
        self.findings = findings
        self.has = driver.capabilities()
        self.been: list[str] = []
        """The places that it has been sent to, and arrived at."""
        self.heard = Heard()
        self._unsubscribe = driver.subscribe(self.heard)

    def let_go(self) -> None:
        """Stop the robot and hear no more of it."""
        self.stop("The check is over.").returned()
        self._unsubscribe()

    def can(self, *methods: str) -> bool:
        """Whether it declares them all, and may be made to do them."""
        return all(
            name in self.has.methods and (self.move or not METHODS[name].moves) for name in methods
        )

    # --- calling it ------------------------------------------------------------------------------

    def begin(self, name: str, arguments: Mapping[str, Any]) -> Attempt:
        """The call, in a thread of its own."""
        return Attempt(lambda flag: self.driver.call(name, dict(arguments), flag))

    def begin_one(
        self, calls: Iterable[tuple[str, Mapping[str, Any]]]
    ) -> tuple[str, Attempt] | None:
        """Begin the first of the calls that does not return at once; its name, and the call."""
        for name, arguments in calls:
            call = self.begin(name, arguments)
            if not call.returned(UNDER_WAY):
                return name, call
        return None

    def stop(self, because: str, *calls: Attempt) -> Attempt:
        """As the server stops: the flags of the calls in flight first, then the body."""
        for call in calls:
            call.flag.set(because)
        return Attempt(lambda flag: self.driver.stop(because))

    def call(self, name: str, arguments: Mapping[str, Any], within: float = _LONGEST) -> Any:
        """The result. Raises whatever the driver raises, and `DidNotReturn`."""
        call = self.begin(name, arguments)
        if not call.returned(within):
            self.stop("The check gives this call up.", call).returned()
            raise DidNotReturn(f"It did not come back within {within:g} s.")
        if call.error is not None:
            raise call.error
        return call.result

    def try_to(self, method: str, /, **arguments: Any) -> Any:
        """The result, or the error."""
        try:
            return self.call(method, arguments)
        except BaseException as error:  # noqa: BLE001 - looked at by who asked for it
            return error

    def _call_when_found(self, name: str, arguments: Mapping[str, Any]) -> Any:
        """As `call`, of a robot that a busy machine may just have lost: it is found again."""
        for _ in range(_LOSES):
            try:
                return self.call(name, arguments, GIVE_UP)
            except LostConnection:
                time.sleep(_FOUND_AGAIN)
        return self.call(name, arguments, GIVE_UP)

    def places(self) -> list[str]:
        known = self.try_to("places")
        return known if isinstance(known, list) else []

    def expect(
        self, part: str, kind: type[RobotError], name: str, arguments: Mapping[str, Any]
    ) -> None:
        """The call raises that error, with a sentence."""
        try:
            result = self._call_when_found(name, arguments)
        except kind as error:
            self.findings.check_sentence(part, name, error)
        except BaseException as error:  # noqa: BLE001 - whatever it is, it is reported
            self.findings.wrong(
                part,
                name,
                f"raised {type(error).__name__} for {dict(arguments)}, not {kind.__name__}",
            )
        else:
            self.findings.wrong(
                part,
                name,
                f"returned {result!r} for {dict(arguments)} and raised no {kind.__name__}",
            )

    # --- whether it stands -----------------------------------------------------------------------

    def moves_on(self) -> str:
        """Watch a robot that should stand: how it moves, in words; empty if it stands."""
        before = self._location()
        time.sleep(_WATCHED / 2)
        start = len(self.heard)  # what was sent before it stood has come by now
        time.sleep(_WATCHED / 2)
        after = self._location()
        if before is not None and after is not None:
            metres = ((after.x - before.x) ** 2 + (after.y - before.y) ** 2) ** 0.5
            degrees = abs((after.theta - before.theta + 180) % 360 - 180)
            if metres > _MOVED[0] or degrees > _MOVED[1]:
                return f"moved on by {metres:.2f} m and {degrees:.0f} degrees"
        poses = [data for kind, data in self.heard.since(start) if kind == "pose"]
        speeds = [abs(pose.get("speed", 0.0)) for pose in poses]
        if speeds and max(speeds) > _CREEPS:
            return f"moved on at {max(speeds):.2f} m/s"
        return ""

    def _location(self) -> Any:
        location = self.try_to("location") if "location" in self.has.methods else None
        return location if hasattr(location, "theta") else None


def confirmed(stop: Attempt) -> bool:
    """Whether the stop has returned, and says that the robot stands."""
    return stop.error is None


def honest(stop: Attempt) -> bool:
    """Whether it says that the robot has not confirmed it."""
    return isinstance(stop.error, StopNotConfirmed)


def report(subject: Subject) -> Report:
    """A row for each capability, and for what else was looked at."""
    findings, has = subject.findings, subject.has
    rows = [_capability(subject, name) for name in CAPABILITIES]
    for part in PARTS:
        problems = tuple(problem for problem in findings.problems if problem.part == part)
        note = findings.notes.get(part, "")
        if problems:
            rows.append(Row(part=part, state="problems", note=note, problems=problems))
        elif part in findings.tried:
            rows.append(Row(part=part, state="works", note=note))
        elif part in findings.notes:
            rows.append(Row(part=part, state="not tried", note=note))
    return Report(has.name, rows)


def _capability(subject: Subject, name: str) -> Row:
    has = subject.has
    methods = [method.name for method in METHODS.values() if method.capability == name]
    own = [method for method in methods if method in has.methods]
    problems = tuple(problem for problem in subject.findings.problems if problem.part == name)
    stand_in = has.stand_ins.get(name)
    note = f"by {stand_in}" if stand_in else ""
    without = tuple(method for method in methods if method not in own) if own else ()
    if problems:
        return Row(part=name, state="problems", note=note, without=without, problems=problems)
    if not own:
        return Row(part=name, state="lacks", note=f"it {INTERFACES[name].lacking}")
    if not any(subject.can(method) for method in own):
        return Row(part=name, state="not tried", note="it would move", without=without)
    state: State = "stood in for" if stand_in else "works"
    return Row(part=name, state=state, note=note, without=without)
