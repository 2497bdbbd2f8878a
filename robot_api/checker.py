"""A checker for anybody's driver: does it do what the method table promises?

    for problem in check_driver(my_driver):
        print(problem)

It calls every method that the driver declares, so give the robot room, or leave the movements out
with `move=False`. Nothing is left moving afterwards.
"""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import msgspec

from robot_api.driver import EVENTS, Capabilities, Driver, Event, StopFlag
from robot_api.errors import (
    InvalidCall,
    NotPossible,
    NotSupported,
    RobotError,
    Stopped,
    UnknownPerson,
)
from robot_api.methods import CORE, METHODS, Method
from robot_api.schema import compiled, result_schema

STOP_WITHIN = 0.05
"""Seconds from a stop to the return of every call in flight."""
_SLACK = 0.15
"""Seconds more that a busy machine may take to notice."""
_UNDER_WAY = 0.05
"""Seconds after which a call that has not returned counts as under way."""
_GIVE_UP = 10.0
"""Seconds after which a call that does not come back is left alone."""
_STRANGE = "no such thing anywhere"
"""A name that nobody gave to anything."""


@dataclass(frozen=True)
class Problem:
    """Something that a driver does otherwise than promised."""

    method: str | None
    """The method, or None if it is about the driver as a whole."""
    message: str

    def __str__(self) -> str:
        return f"{self.method}: {self.message}" if self.method else self.message


def check_driver(
    driver: Driver, *, move: bool = True, stop_within: float = STOP_WITHIN + _SLACK
) -> list[Problem]:
    """Everything that is wrong with the driver; an empty list if nothing is.

    `move`: whether to call methods that move the body. `stop_within`: seconds that a call may take
    to come back after a stop.
    """
    check = _Check(driver, move, stop_within)
    unsubscribe = driver.subscribe(check.hear)
    try:
        check.capabilities()
        if not check.problems:  # what is declared decides how the methods are called
            check.methods()
            check.names()
            check.places()
            check.stops()
            check.one_movement_at_a_time()
            check.events()
    finally:
        driver.stop("The check is over.")
        unsubscribe()
    return check.problems


class _Check:
    def __init__(self, driver: Driver, move: bool, stop_within: float) -> None:
        self.driver = driver
        self.move = move
        self.stop_within = stop_within
        self.problems: list[Problem] = []
        self.has: Capabilities = driver.capabilities()
        self.heard: list[tuple[str, Event]] = []

    def hear(self, kind: str, data: Event) -> None:
        self.heard.append((kind, data))

    def wrong(self, method: str | None, message: str) -> None:
        self.problems.append(Problem(method, message))

    # --- what it declares ------------------------------------------------------------------------

    def capabilities(self) -> None:
        has = self.has
        for name in has.methods:
            if name not in METHODS:
                self.wrong(name, "is declared, but the method table has no such method")
        for name, method in METHODS.items():
            if method.capability == CORE and name not in has.methods:
                self.wrong(name, "is not declared, but every robot has it")
        needed: Mapping[str, tuple[str, Any]] = {
            "say": ("languages", has.languages),
            "emotion": ("emotions", has.emotions),
            "gesture": ("gestures", has.gestures),
            "joint": ("joints", has.joints),
            "do": ("skills", has.skills),
            "grab": ("hands", has.hands),
        }
        for name, (field, value) in needed.items():
            if name in has.methods and not value:
                self.wrong(name, f"is declared, but the capabilities name no {field}")
        for joint, (least, most) in has.joints.items():
            if least > most:
                self.wrong("joint", f"{joint} goes from {least} to {most}, which is backwards")
        if has.units not in ("m", "cm"):
            self.wrong(None, f"the unit of the map is {has.units!r}, not 'm' or 'cm'")
        if not has.name or not has.kind:
            self.wrong(None, "the robot has no name or no kind")

    # --- every method ----------------------------------------------------------------------------

    def methods(self) -> None:
        """Each method gives a result of its kind, or one of its errors, or is not supported."""
        for name, arguments in self.samples():
            method = METHODS[name]
            if name not in self.has.methods:
                self.expect(NotSupported, name, arguments)
            elif self.move or not method.moves:
                self.call(method, arguments)

    def samples(self) -> Iterator[tuple[str, dict[str, Any]]]:
        """A call of each method that a robot with these capabilities can take."""
        has = self.has
        known = self.try_to("places", {})
        place = known[0] if isinstance(known, list) and known else "lobby"
        contact = has.contacts[0] if has.contacts else "reception"
        joint, angles = next(iter(has.joints.items()), ("head_yaw", (0.0, 0.0)))
        arguments: dict[str, list[dict[str, Any]]] = {
            "say": [{"text": "Hello."}, {"text": "Hello.", "language": has.languages[0]}],
            "listen": [{"timeout": 1}],
            "ask": [{"question": "Is all well?", "options": ["yes", "no"]}, {"question": "Well?"}],
            "answer": [{"question": "Where is the pharmacy?"}],
            "set_volume": [{"percent": 50}],
            "set_language": [{"code": has.languages[0]}],
            "goto": [{"place": place}],
            "move": [{"metres": 0.2}, {"metres": -0.2}],
            "turn": [{"degrees": 30}],
            "drive": [{"linear": 0.1, "angular": 10, "seconds": 0.5}],
            "wait": [{"seconds": 0.1}],
            "localize": [{"place": place}],
            "places": [{}, {"kind": "office"}],
            "emotion": [{"name": name} for name in has.emotions[:2]],
            "gesture": [{"name": name} for name in has.gestures[:1]],
            "joint": [{"name": joint, "degrees": angles[0]}],
            "log": [{"lines": 5}],
            "call": [{"contact": contact}],
            "scan": [{"timeout": 1}],
            "show": [
                {"text": "Hello"},
                {"url": "https://example.org/"},
                {"html": '<p id="name">Ann</p><input id="field"><button>Go</button>'},
            ],
            "click": [{"selector": "button"}, {"selector": "#nothing"}],
            "type_text": [{"selector": "#field", "text": "Bob"}],
            "read_text": [{"selector": "#name"}],
            "touch": [{"options": ["yes", "no"]}],
            "find": [{"thing": "person", "place": place}],
            "wait_for": [{"thing": "person", "timeout": 1}],
            "follow": [{"person": "person", "to": place}],
            "guide": [{"person": "person", "place": place}],
            "do": [{"skill": skill} for skill in list(has.skills)[:1]] or [{"skill": "sit"}],
        }
        for name, method in METHODS.items():
            if name == "stop":
                continue  # has a check of its own
            one = {parameter.name: "cup" for parameter in method.forms[0] if parameter.required}
            for sample in arguments.get(name) or [one]:
                yield name, sample

    def call(self, method: Method, arguments: dict[str, Any]) -> None:
        name = method.name
        allowed = {*method.errors, *(["NotPossible"] if method.moves else [])}
        try:
            result = self.driver.call(name, arguments, StopFlag())
        except RobotError as error:
            if type(error).__name__ not in allowed:
                self.wrong(name, f"raised {type(error).__name__}, which is none of its errors")
            self.check_sentence(name, error)
        except BaseException as error:  # noqa: BLE001 - whatever it is, it is reported
            self.wrong(name, f"raised {type(error).__name__}, which is no RobotError: {error}")
        else:
            data = msgspec.to_builtins(result)
            for fault in compiled(result_schema(method)).iter_errors(data):
                self.wrong(name, f"returned {result!r}: {fault.message}")

    def expect(self, kind: type[RobotError], name: str, arguments: dict[str, Any]) -> None:
        """The call raises that error, with a sentence."""
        try:
            result = self.driver.call(name, arguments, StopFlag())
        except kind as error:
            self.check_sentence(name, error)
        except BaseException as error:  # noqa: BLE001 - whatever it is, it is reported
            self.wrong(name, f"raised {type(error).__name__} for {arguments}, not {kind.__name__}")
        else:
            self.wrong(name, f"returned {result!r} for {arguments} and raised no {kind.__name__}")

    def check_sentence(self, name: str, error: RobotError) -> None:
        text = str(error)
        if not text.strip() or text[-1] not in ".?!" or "\n" in text:
            self.wrong(name, f"the message of {type(error).__name__} is no sentence: {text!r}")

    def try_to(self, name: str, arguments: dict[str, Any]) -> Any:
        """The result, or the error."""
        try:
            return self.driver.call(name, arguments, StopFlag())
        except (RobotError, Stopped) as error:
            return error

    # --- names and places ------------------------------------------------------------------------

    def names(self) -> None:
        """A name that it does not know is refused, not taken for another."""
        strange: tuple[tuple[type[RobotError], str, dict[str, Any]], ...] = (
            (NotSupported, "emotion", {"name": _STRANGE}),
            (NotSupported, "gesture", {"name": _STRANGE}),
            (NotSupported, "joint", {"name": _STRANGE, "degrees": 0}),
            (NotSupported, "do", {"skill": _STRANGE}),
            (NotSupported, "set_language", {"code": "xx"}),
            (UnknownPerson, "call", {"contact": _STRANGE}),
            (InvalidCall, "goto", {"place": {"theta": 0}}),
        )
        for kind, name, arguments in strange:
            if name in self.has.methods and (self.move or not METHODS[name].moves):
                self.expect(kind, name, arguments)

    def places(self) -> None:
        """The places are consistent: of a kind, those of that kind; driven to, there it is."""
        known = self.try_to("places", {})
        of_kind = self.try_to("places", {"kind": "office"})
        if isinstance(known, list) and isinstance(of_kind, list):
            for name in set(of_kind) - set(known):
                self.wrong("places", f"lists {name!r} of a kind, but not among all places")
        if not self.move or "goto" not in self.has.methods or not isinstance(known, list):
            return
        for place in (*known[1:2], *known[:1]):  # so that it has to move for each
            if isinstance(self.try_to("goto", {"place": place}), RobotError):
                continue
            location = self.try_to("location", {})
            if getattr(location, "place", None) != place:
                self.wrong("goto", f"went to {place!r}, but location() says {location!r}")

    # --- stopping --------------------------------------------------------------------------------

    def stops(self) -> None:
        """A stop brings every long call back at once, and is no exception a program can catch."""
        for name, arguments in self.long_calls():
            self.check_stop(name, arguments)
        self.check_stopped_before()
        afterwards: tuple[tuple[str, dict[str, Any]], ...] = (
            ("stop", {}),
            ("wait", {"seconds": 0}),
        )
        for name, arguments in afterwards:
            result = self.try_to(name, arguments)
            if result is not None:
                self.wrong(name, f"does not work after a stop: {result!r}")

    def long_calls(self) -> Iterator[tuple[str, dict[str, Any]]]:
        known = self.try_to("places", {})
        long: dict[str, dict[str, Any]] = {
            "wait": {"seconds": 86400},
            "say": {"text": "blah " * 390},
            "listen": {"timeout": 86400},
            "scan": {"timeout": 86400},
            "wait_for": {"thing": _STRANGE},
            "drive": {"linear": 0.05, "angular": 30, "seconds": 60},
            "turn": {"degrees": 36000},
        }
        if isinstance(known, list) and known:
            long["goto"] = {"place": known[-1]}
        for name, arguments in long.items():
            if name in self.has.methods and (self.move or not METHODS[name].moves):
                yield name, arguments

    def stop(self, flag: StopFlag) -> None:
        """As the server stops: the flags of the calls in flight first, then the body."""
        flag.set("The check stops this call.")
        self.driver.stop("The check stops the robot.")

    def check_stop(self, name: str, arguments: dict[str, Any]) -> None:
        attempt = _Attempt(self.driver, name, arguments)
        if attempt.returned(_UNDER_WAY):
            return  # too short a call to be stopped
        began = time.monotonic()
        self.stop(attempt.flag)
        if not attempt.returned(_GIVE_UP):
            self.wrong(name, f"did not come back within {_GIVE_UP:g} s after a stop")
            return
        took = attempt.ended - began
        if took > self.stop_within:
            self.wrong(name, f"came back {took * 1000:.0f} ms after a stop")
        if attempt.error is not None and not isinstance(attempt.error, Stopped):
            self.wrong(name, f"raised {type(attempt.error).__name__} at a stop, not Stopped")

    def check_stopped_before(self) -> None:
        flag = StopFlag()
        flag.set()
        try:
            self.driver.call("wait", {"seconds": 0}, flag)
        except Stopped:
            return
        except BaseException as error:  # noqa: BLE001 - whatever it is, it is reported
            self.wrong("wait", f"raised {type(error).__name__} when stopped before it began")
        else:
            self.wrong("wait", "went on though it was stopped before it began")

    def one_movement_at_a_time(self) -> None:
        """A second movement is refused; speaking goes on."""
        if not self.move or not {"goto", "turn"} <= set(self.has.methods):
            return
        first = _Attempt(self.driver, "turn", {"degrees": 36000})
        if first.returned(_UNDER_WAY):
            return
        second = self.try_to("goto", {"x": 0, "y": 0})
        if not isinstance(second, NotPossible) and not first.returned(0):
            self.wrong("goto", f"was not refused while the robot turned: {second!r}")
        if "emotion" in self.has.methods and not first.returned(0):
            shown = self.try_to("emotion", {"name": self.has.emotions[0]})
            if shown is not None:
                self.wrong("emotion", f"did not work while the robot turned: {shown!r}")
        self.stop(first.flag)
        first.returned(_GIVE_UP)

    # --- events ----------------------------------------------------------------------------------

    def events(self) -> None:
        """Every event is of a known kind with its fields, and what was done was told."""
        for kind, data in list(self.heard):
            if kind not in EVENTS:
                self.wrong(None, f"sent an event of the unknown kind {kind!r}")
                continue
            missing = missing_fields(kind, data)
            if missing:
                self.wrong(None, f"sent the event {kind!r} without {missing}: {dict(data)!r}")
            try:
                msgspec.json.encode(data)
            except TypeError as error:
                self.wrong(None, f"sent the event {kind!r} with what JSON cannot carry: {error}")
        told = {kind for kind, _ in self.heard}
        for name, kind in (("say", "speech"), ("emotion", "emotion"), ("show", "screen")):
            if name in self.has.methods and kind not in told:
                self.wrong(name, f"sends no event {kind!r}")
        if "stopped" not in told:
            self.wrong(None, "sends no event 'stopped' when it is stopped")


def missing_fields(kind: str, data: Event) -> str:
    """The fields that an event of that kind lacks, as a text; empty if none. The fields are those
    that `EVENTS` names, before its first ":" or ";": parted by commas all, by "|" one of them."""
    plain = re.split("[:;]", re.sub(r"\(.*?\)", "", EVENTS[kind]))[0]
    if "|" in plain:
        choices = [field.strip() for field in plain.split("|")]
        return "" if any(field in data for field in choices) else " or ".join(choices)
    return ", ".join(field for field in map(str.strip, plain.split(",")) if field not in data)


class _Attempt:
    """A call in a thread of its own."""

    def __init__(self, driver: Driver, method: str, arguments: dict[str, Any]) -> None:
        self.flag = StopFlag()
        self.error: BaseException | None = None
        self.ended = 0.0
        self._call = (driver, method, arguments)
        self._thread = threading.Thread(target=self._run, name=f"check {method}", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        driver, method, arguments = self._call
        try:
            driver.call(method, arguments, self.flag)
        except BaseException as error:  # noqa: BLE001 - looked at by who waits for it
            self.error = error
        finally:
            self.ended = time.monotonic()

    def returned(self, within: float) -> bool:
        """Wait so many seconds for the end; whether it came."""
        self._thread.join(within)
        return not self._thread.is_alive()
