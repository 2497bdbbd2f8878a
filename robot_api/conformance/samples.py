"""Calls to try a robot with: good ones, strange ones, ones beyond its limits, long ones."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from robot_api.conformance.subject import Subject
from robot_api.driver import Capabilities
from robot_api.errors import InvalidCall, NotSupported, RobotError, UnknownPerson
from robot_api.methods import METHODS
from robot_api.values import Location

Sample = tuple[str, dict[str, Any]]
"""A method and the arguments to call it with."""

STRANGE = "no such thing anywhere"
"""A name that nobody gave to anything."""
_SLOW, _TURNING = 0.3, 30.0
"""Metres and degrees a second to drive with, if the robot may: enough to be seen."""
_PLACES = 4
"""How many places are tried to be driven to."""
_BEYOND = 1.0
"""Degrees, or degrees a second, more than a limit."""
_FASTER = 0.05
"""Metres a second more than a limit."""


def samples(subject: Subject) -> Iterator[Sample]:
    """A call of each method, such as a robot with these capabilities can take."""
    has = subject.has
    known = subject.places()
    place = known[0] if known else "lobby"
    contact = has.contacts[0] if has.contacts else "reception"
    joint, angles = next(iter(has.joints.items()), ("head_yaw", (0.0, 0.0)))
    linear, angular = _pace(has)
    arguments: dict[str, list[dict[str, Any]]] = {
        "say": [{"text": "Hello."}, {"text": "Hello.", "language": has.languages[0]}],
        "listen": [{"timeout": 1}],
        "ask": [{"question": "Is all well?", "options": ["yes", "no"]}, {"question": "Well?"}],
        "answer": [{"question": "Where is the pharmacy?"}],
        "set_volume": [{"percent": int(min(50, has.limits.get("volume", 100)))}],
        "set_language": [{"code": has.languages[0]}],
        "goto": [{"place": place}],
        "move": [{"metres": 0.2}, {"metres": -0.2}],
        "turn": [{"degrees": 30}],
        "drive": [{"linear": linear / 2, "angular": angular / 2, "seconds": 0.5}],
        "wait": [{"seconds": 0.1}],
        "wait_until": [{"time": "12:00", "date": "2000-01-01"}],  # a time to come would last
        "localize": _where_it_is(subject),
        "places": [{}, {"kind": "office"}],
        "emotion": [{"name": name} for name in has.emotions[:2] or ("happy",)],
        "gesture": [{"name": name} for name in has.gestures[:1] or ("wave",)],
        "joint": [{"name": joint, "degrees": angles[0]}, {"name": joint, "degrees": angles[1]}],
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
        # A robot that sees anything sees people.
        "sees": [{"thing": "person"}],
        "count": [{"thing": "people"}],
        "find": [{"thing": "person", "place": place}],
        "wait_for": [{"thing": "person", "timeout": 1}],
        "follow": [{"person": "person", "to": place}],
        "guide": [{"person": "person", "place": place}],
        "do": [{"skill": next(iter(has.skills), "sit")}],
    }
    for name, method in METHODS.items():
        if name == "stop":
            continue  # has checks of its own
        one = {each.name: _some(each.kind.schema) for each in method.forms[0] if each.required}
        for sample in arguments.get(name, [one]):
            yield name, sample


def _some(schema: Mapping[str, Any]) -> Any:
    """A value of which the table knows no more than its schema."""
    match schema:
        case {"enum": [first, *_]}:
            return first
        case {"type": "number" | "integer", "minimum": least, "maximum": most}:
            return max(least, min(1, most))
        case {"type": "boolean"}:
            return True
        case {"type": "array", "items": items, "minItems": least}:
            return [_some(items)] * least
        case {"anyOf": [one, *_]}:
            return _some(one)
        case _:
            return "cup"


def _where_it_is(subject: Subject) -> list[dict[str, Any]]:
    """A robot that is made to believe itself elsewhere drives into walls."""
    here = subject.try_to("location")
    if isinstance(here, Location):
        return [{"x": here.x, "y": here.y, "theta": here.theta}]
    return [] if "localize" in subject.has.methods else [{"x": 0, "y": 0, "theta": 0}]


def strange_names() -> Iterator[tuple[type[RobotError], str, dict[str, Any]]]:
    """Calls with names that no robot knows, each with the error that it answers."""
    yield NotSupported, "emotion", {"name": STRANGE}
    yield NotSupported, "gesture", {"name": STRANGE}
    yield NotSupported, "joint", {"name": STRANGE, "degrees": 0}
    yield NotSupported, "do", {"skill": STRANGE}
    yield NotSupported, "set_language", {"code": "xx"}
    yield UnknownPerson, "call", {"contact": STRANGE}
    yield InvalidCall, "goto", {"place": {"theta": 0}}


def beyond_limits(has: Capabilities) -> Iterator[Sample]:
    """Calls that must be refused: each is a little more than the robot may do, or no number."""
    speed, turn_rate = has.limits.get("speed"), has.limits.get("turn_rate")
    for sign in (1, -1):
        if speed is not None:
            yield "drive", {"linear": sign * (speed + _FASTER), "angular": 0, "seconds": 0.2}
        if turn_rate is not None:
            yield "drive", {"linear": 0, "angular": sign * (turn_rate + _BEYOND), "seconds": 0.2}
    for joint, (least, most) in has.joints.items():
        yield "joint", {"name": joint, "degrees": least - _BEYOND}
        yield "joint", {"name": joint, "degrees": most + _BEYOND}
    yield "set_volume", {"percent": 101}
    yield "drive", {"linear": 99, "angular": 0, "seconds": 0.2}
    yield "move", {"metres": math.nan}
    yield "turn", {"degrees": math.inf}
    yield "goto", {"x": math.nan, "y": 0}


def within_limits(has: Capabilities) -> Iterator[Sample]:
    """Calls that use a limit up, and are not beyond it."""
    speed, turn_rate = has.limits.get("speed"), has.limits.get("turn_rate")
    if speed is not None:
        yield "drive", {"linear": min(2.0, speed), "angular": 0, "seconds": 0.1}
    if turn_rate is not None:
        yield "drive", {"linear": 0, "angular": min(180.0, turn_rate), "seconds": 0.1}
    if "volume" in has.limits:
        yield "set_volume", {"percent": math.floor(has.limits["volume"])}


def long_calls(subject: Subject) -> Iterator[Sample]:
    """Calls that take long enough to be stopped, of those that it can be asked for now."""
    has = subject.has
    linear, angular = _pace(has)
    person = "person"
    long: dict[str, dict[str, Any]] = {
        "wait": {"seconds": 86400},
        "wait_until": {"time": "12:00", "date": "2999-12-31"},
        "say": {"text": "blah " * 390},
        "listen": {"timeout": 86400},
        "ask": {"question": "blah " * 390},
        "answer": {"question": "Where is the pharmacy?"},
        "scan": {"timeout": 86400},
        "touch": {"options": ["yes", "no"]},
        "wait_for": {"thing": STRANGE},
        "call": {"contact": has.contacts[0] if has.contacts else person},
        "find": {"thing": STRANGE},
        "drive": {"linear": linear, "angular": angular, "seconds": 60},
        "turn": {"degrees": 36000},
        "move": {"metres": 20},
        "goto": {"place": "lobby"},
        "follow": {"person": person},
        "guide": {"person": person, "place": "lobby"},
        "dock": {},
        "gesture": {"name": has.gestures[0] if has.gestures else "wave"},
        "do": {"skill": next(iter(has.skills), "sit")},
    }
    for name, arguments in long.items():
        if not subject.can(name):
            continue
        if arguments.get("place"):
            far = _far_place(subject)
            if far is None:
                continue
            arguments["place"] = far
        yield name, arguments


def long_movements(subject: Subject) -> Iterator[Sample]:
    """Some that may take long, the likeliest first: not every place can be driven to."""
    linear, angular = _pace(subject.has)
    if subject.can("goto"):
        for place in _elsewhere(subject)[-_PLACES:][::-1]:
            yield "goto", {"place": place}
    if subject.can("turn"):
        yield "turn", {"degrees": 36000}
    if subject.can("drive"):
        yield "drive", {"linear": linear, "angular": angular, "seconds": 60}


def _far_place(subject: Subject) -> str | None:
    """A place where the robot is not now, one that it has arrived at before if there is any."""
    others = _elsewhere(subject)
    been = [place for place in others if place in subject.been]
    return next(reversed(been or others), None)


def _elsewhere(subject: Subject) -> list[str]:
    here = getattr(subject.try_to("location"), "place", None)
    return [place for place in subject.places() if place != here]


def _pace(has: Capabilities) -> tuple[float, float]:
    """Metres and degrees a second that it may drive with."""
    return (
        min(_SLOW, has.limits.get("speed", _SLOW)),
        min(_TURNING, has.limits.get("turn_rate", _TURNING)),
    )
