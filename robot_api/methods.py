"""The robot methods: the one table from which everything else about them is made.

From this table come the JSON Schemas that calls on the wire are validated with, the `.pyi` stub
that programs are type-checked against, the OpenRPC document, the reference page in the docs and the
check that every action of the grammar exists (`robot_api.schema`, `robot_api.stub`,
`robot_api.reference`). How to add a method says docs/drivers.md: a row here, a capability, its
words in each language.

Lengths are metres, angles degrees (left is +), durations seconds. The paper's function numbers
(Glauser et al., Table 1) stand in `paper`.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass
from typing import Any, Final

WEEKDAYS: Final = (
    "Monday",
    "Tuesday",
    "Wednesday",
    "Thursday",
    "Friday",
    "Saturday",
    "Sunday",
)
"""As the clock names them; the place of each is Python's `weekday()`."""
MAX_TEXT: Final = 2000
"""Longest text, in characters, that any parameter takes."""


@dataclass(frozen=True)
class Kind:
    """A kind of value: how Python programs write it and what the wire accepts."""

    annotation: str
    schema: dict[str, Any]

    @property
    def choices(self) -> tuple[str, ...]:
        """The values there are, where a schema lists them all (`enum`)."""
        schemas = self.schema.get("anyOf", [self.schema])
        return tuple(value for schema in schemas for value in schema.get("enum", ()))


class _Required(enum.Enum):
    REQUIRED = "required"


REQUIRED: Final = _Required.REQUIRED


@dataclass(frozen=True)
class Parameter:
    name: str
    kind: Kind
    doc: str
    default: Any = REQUIRED

    @property
    def required(self) -> bool:
        return self.default is REQUIRED


@dataclass(frozen=True)
class Method:
    """One robot method. `forms` are its ways of being called: most have one, `goto` has three."""

    name: str
    doc: str
    """One line, in the imperative."""
    forms: tuple[tuple[Parameter, ...], ...]
    returns: Kind
    capability: str
    """What a robot must have to do it; `CORE` ones every robot has."""
    errors: tuple[str, ...] = ()
    """Class names from `robot_api.errors` that it raises besides NotSupported, InvalidCall,
    LostConnection, and, if it moves the body, NotPossible while another movement goes on."""
    paper: int | None = None
    moves: bool = False
    """Whether it can set the body in motion."""
    extra: bool = False
    """Whether it takes further named parameters of its own (`do`)."""
    looks_or_tells: bool = False
    """Whether it only looks or tells where the robot is: nothing moves, nobody is asked, called or
    waited for, and the robot's screen and settings stay as they are."""
    tells: str | None = None
    """The kind of event that tells everybody that it was done; one that `robot_api.driver` does
    not know otherwise has the parameters for its data."""


# --- kinds of values -----------------------------------------------------------------------------


def _text(pattern: str | None = None, longest: int = MAX_TEXT) -> Kind:
    schema: dict[str, Any] = {"type": "string", "minLength": 1, "maxLength": longest}
    if pattern:
        schema["pattern"] = pattern
    return Kind("str", schema)


def _number(low: float, high: float) -> Kind:
    return Kind("float", {"type": "number", "minimum": low, "maximum": high})


def _integer(low: int, high: int) -> Kind:
    return Kind("int", {"type": "integer", "minimum": low, "maximum": high})


def _list(of: Kind, longest: int, shortest: int = 0) -> Kind:
    return Kind(
        f"list[{of.annotation}]",
        {"type": "array", "items": of.schema, "minItems": shortest, "maxItems": longest},
    )


def _optional(kind: Kind) -> Kind:
    return Kind(f"{kind.annotation} | None", {"anyOf": [kind.schema, {"type": "null"}]})


NOTHING = Kind("None", {"type": "null"})
TEXT = _text()
ANY_TEXT = Kind("str", {"type": "string", "maxLength": MAX_TEXT})
MARKUP = _text(longest=100_000)
NAME = _text(longest=200)
LANGUAGE = _text(r"^[a-z]{2}(-[A-Z]{2})?$", 5)
METRES = _number(-1000, 1000)
DEGREES = _number(-36000, 36000)
SECONDS = _number(0, 86400)
TIME_OF_DAY = _text(r"^([01][0-9]|2[0-3]):[0-5][0-9]$", 5)
WEEKDAY = Kind("str", {"type": "string", "enum": list(WEEKDAYS)})
DATE = _text(r"^2[0-9]{3}-[0-9]{2}-[0-9]{2}$", 10)
SPEED = _number(-2, 2)
TURN_RATE = _number(-180, 180)
PERCENT = _integer(0, 100)
COUNT = Kind("int", {"type": "integer", "minimum": 0})
YES_NO = Kind("bool", {"type": "boolean"})
NAMES = _list(NAME, 1000)
OPTIONS = _list(NAME, 20, 1)
LINES = Kind("list[str]", {"type": "array", "items": {"type": "string"}})
LOCATION = Kind(
    "Location",
    {
        "type": "object",
        "properties": {
            "x": {"type": "number"},
            "y": {"type": "number"},
            "theta": {"type": "number"},
            "place": {"anyOf": [{"type": "string"}, {"type": "null"}]},
        },
        "required": ["x", "y"],
    },
)
CLOCK = Kind(
    "Clock",
    {
        "type": "object",
        "properties": {
            "time": {"type": "string"},
            "weekday": {"type": "string"},
            "date": {"type": "string"},
            "zone": {"type": "string"},
        },
        "required": ["time", "weekday", "date"],
    },
)
PLACE_OR_LOCATION = Kind(
    "str | Location",
    # A location also travels as the name of its place would: as a value of `place`.
    {"anyOf": [NAME.schema, LOCATION.schema]},
)
ANYTHING = Kind("Any", {})

P = Parameter

THING = P("thing", NAME, 'a noun phrase: "stapler", "red cup", "person waving", "biggest box"')
PERSON = P("person", NAME, 'a name or a kind: "Alice", "nurse", "person"')
SOMEONE = P("person", _optional(NAME), "a name or a kind; whoever is here if left out", None)
PROMPT = P("prompt", _optional(TEXT), "what to say first", None)
X = P("x", METRES, "metres along the map's x axis")
Y = P("y", METRES, "metres along the map's y axis")
HEADING = P("theta", _optional(DEGREES), "degrees to face at the end; any if left out", None)

CORE: Final = "core"
"""The capability every robot has: stop, wait, wait_until, log, clock, places, location, battery,
capabilities of its own."""

_GOING = ("UnknownPlace", "Blocked", "NotPossible")


def _method(
    name: str,
    doc: str,
    *form: Parameter,
    forms: tuple[tuple[Parameter, ...], ...] | None = None,
    returns: Kind = NOTHING,
    needs: str,
    errors: tuple[str, ...] = (),
    paper: int | None = None,
    moves: bool = False,
    extra: bool = False,
    looks_or_tells: bool = False,
    tells: str | None = None,
) -> Method:
    return Method(
        name,
        doc,
        forms if forms else (form,),
        returns,
        needs,
        errors,
        paper,
        moves,
        extra,
        looks_or_tells,
        tells,
    )


METHODS: Final[dict[str, Method]] = {
    method.name: method
    for method in (
        # --- speech
        _method(
            "say",
            "Speak a text aloud; returns when it has been spoken.",
            P("text", TEXT, "what to say"),
            P("language", _optional(LANGUAGE), 'such as "de"; the set language if left out', None),
            needs="speech",
            paper=1,
            looks_or_tells=True,
            tells="speech",
        ),
        _method(
            "listen",
            "Listen to whoever is there and return the words heard.",
            PROMPT,
            P("timeout", SECONDS, "seconds to wait for somebody to speak", 10),
            returns=ANY_TEXT,
            needs="hearing",
            errors=("TimedOut",),
            paper=16,
        ),
        _method(
            "ask",
            "Ask a question and return the answer: one of the options exactly, or the words heard.",
            P("question", TEXT, "what to ask"),
            P("options", _optional(OPTIONS), "the answers that count, up to 20", None),
            P("person", _optional(NAME), "whom to ask; whoever is here if left out", None),
            returns=ANY_TEXT,
            needs="hearing",
            errors=("TimedOut", "NotFound"),
        ),
        _method(
            "answer",
            "Answer a question from the predefined ones; listens for it if none is given.",
            P("question", _optional(TEXT), "the question; heard from whoever is here", None),
            returns=ANY_TEXT,
            needs="hearing",
            errors=("TimedOut",),
            looks_or_tells=True,
        ),
        _method(
            "set_volume",
            "Set how loud the robot speaks.",
            P("percent", PERCENT, "0 is silent, 100 the loudest"),
            needs="speech",
            paper=2,
            tells="volume",
        ),
        _method(
            "set_language",
            "Set the language the robot speaks and hears.",
            P("code", LANGUAGE, '"en", "de" or "fr"'),
            needs="speech",
            tells="language",
        ),
        # --- driving
        _method(
            "goto",
            "Drive to a place, a point of the map, or a location remembered before.",
            forms=(
                (P("place", PLACE_OR_LOCATION, "a place's name, or a Location"),),
                (X, Y, HEADING),
            ),
            needs="navigation",
            errors=_GOING,
            paper=4,
            moves=True,
        ),
        _method(
            "move",
            "Drive straight ahead (or back, if negative).",
            P("metres", _number(-100, 100), "how far"),
            needs="motion",
            errors=("Blocked",),
            paper=3,
            moves=True,
        ),
        _method(
            "turn",
            "Turn on the spot.",
            P("degrees", DEGREES, "how far; left is +"),
            needs="motion",
            paper=3,
            moves=True,
        ),
        _method(
            "drive",
            "Drive as with a joystick for a moment.",
            P("linear", SPEED, "metres per second ahead"),
            P("angular", TURN_RATE, "degrees per second; left is +"),
            P("seconds", _number(0, 60), "for how long"),
            needs="motion",
            errors=("Blocked",),
            paper=3,
            moves=True,
        ),
        _method("stop", "Stop everything at once.", needs=CORE, errors=("StopNotConfirmed",)),
        _method(
            "wait",
            "Wait for a while.",
            P("seconds", SECONDS, "how long"),
            needs=CORE,
        ),
        _method(
            "wait_until",
            "Wait until the clock next shows a time: today, or tomorrow if that is over today.",
            P("time", TIME_OF_DAY, 'local time, "06:00" or "14:30"'),
            P("weekday", _optional(WEEKDAY), 'on the next such day, "Monday"; any day', None),
            P("date", _optional(DATE), 'on that day, "2026-12-24"; the next one if left out', None),
            needs=CORE,
            errors=("NotPossible",),
        ),
        _method(
            "dock",
            "Drive back to the charging station.",
            needs="dock",
            errors=("Blocked", "NotPossible"),
            paper=5,
            moves=True,
        ),
        _method(
            "location",
            "Tell where the robot is.",
            returns=LOCATION,
            needs="navigation",
            errors=("NotPossible",),
            paper=6,
            looks_or_tells=True,
        ),
        _method(
            "localize",
            "Tell the robot where it is, when it is wrong about it.",
            forms=(
                (P("place", PLACE_OR_LOCATION, "a place's name, or a Location"),),
                (X, Y, P("theta", DEGREES, "degrees it faces")),
            ),
            needs="navigation",
            errors=("UnknownPlace", "NotPossible"),
            paper=7,
        ),
        _method(
            "places",
            "List the named places.",
            P("kind", _optional(NAME), 'only those of a kind: "office", "ward", "lab"', None),
            returns=NAMES,
            needs=CORE,
            looks_or_tells=True,
        ),
        # --- body
        _method(
            "emotion",
            "Show an emotion.",
            P("name", NAME, '"neutral", "happy", "sad", "confused", "angry", ...'),
            needs="face",
            paper=8,
            tells="emotion",
        ),
        _method(
            "gesture",
            "Make a gesture.",
            P("name", NAME, '"wave", "nod", "bow", "point", ...'),
            needs="gesture",
            paper=9,
            moves=True,
        ),
        _method(
            "joint",
            "Move one joint to an angle and hold it there.",
            P("name", NAME, '"head_yaw", "left_shoulder", ...'),
            P("degrees", _number(-180, 180), "the angle"),
            needs="joints",
            paper=10,
            moves=True,
            tells="joint",
        ),
        _method(
            "log",
            "Read the last lines of the robot's debug log.",
            P("lines", _integer(1, 1000), "how many", 20),
            returns=LINES,
            needs=CORE,
            paper=11,
            looks_or_tells=True,
        ),
        # --- telepresence, scanner, screen
        _method(
            "call",
            "Start a video call with a contact.",
            P("contact", NAME, "whom to call"),
            needs="telepresence",
            errors=("UnknownPerson", "TimedOut"),
            paper=12,
        ),
        _method("hang_up", "End the video call.", needs="telepresence", paper=12),
        _method(
            "scan",
            "Scan a bar code or QR code held before the robot and return what it says.",
            PROMPT,
            P("timeout", SECONDS, "seconds to wait for a code", 30),
            returns=ANY_TEXT,
            needs="scanner",
            errors=("TimedOut",),
            paper=13,
        ),
        _method(
            "show",
            "Show a text, a page of HTML or a web page on the screen.",
            P("text", _optional(ANY_TEXT), "plain text in large letters", None),
            P("html", _optional(MARKUP), "a page of HTML", None),
            P("url", _optional(_text(r"^https?://", 2000)), "the address of a web page", None),
            needs="screen",
            paper=14,
            tells="screen",
        ),
        _method(
            "click",
            "Click on an element of the page on the screen.",
            P("selector", NAME, "a CSS selector"),
            needs="screen",
            errors=("NotFound",),
            paper=15,
        ),
        _method(
            "type_text",
            "Type into a field of the page on the screen.",
            P("selector", NAME, "a CSS selector"),
            P("text", ANY_TEXT, "what to type"),
            needs="screen",
            errors=("NotFound",),
            paper=15,
        ),
        _method(
            "touch",
            "Show buttons on the touchscreen and return the one that is touched.",
            P("options", OPTIONS, "the buttons, up to 20"),
            PROMPT,
            returns=ANY_TEXT,
            needs="screen",
            errors=("TimedOut",),
            paper=15,
        ),
        _method(
            "read_text",
            "Read the text of an element of the page on the screen.",
            P("selector", NAME, "a CSS selector"),
            returns=ANY_TEXT,
            needs="screen",
            errors=("NotFound",),
            paper=15,
        ),
        # --- seeing
        _method(
            "sees",
            "Tell whether the robot sees such a thing or person where it is.",
            THING,
            returns=YES_NO,
            needs="vision",
            looks_or_tells=True,
        ),
        _method(
            "count",
            "Count such things or people where the robot is.",
            THING,
            returns=COUNT,
            needs="vision",
            looks_or_tells=True,
        ),
        _method(
            "objects",
            "List the objects the robot sees where it is.",
            returns=NAMES,
            needs="vision",
            looks_or_tells=True,
        ),
        _method(
            "people",
            "List the people the robot sees where it is.",
            returns=NAMES,
            needs="vision",
            looks_or_tells=True,
        ),
        _method(
            "describe",
            "Describe such a thing or person in one sentence.",
            THING,
            returns=ANY_TEXT,
            needs="vision",
            errors=("NotFound",),
            looks_or_tells=True,
        ),
        _method(
            "find",
            "Look for such a thing or person, here and then from place to place, and stand by it.",
            THING,
            P("place", _optional(NAME), "look only there", None),
            returns=YES_NO,
            needs="vision",
            errors=("UnknownPlace", "Blocked"),
            moves=True,
        ),
        _method(
            "wait_for",
            "Wait until such a thing or person is there that was not already met by waiting here.",
            THING,
            P("timeout", _optional(SECONDS), "seconds; for ever if left out", None),
            returns=YES_NO,
            needs="vision",
        ),
        # --- handling
        _method(
            "grab",
            "Take a thing that is here.",
            THING,
            needs="manipulation",
            errors=("NotFound", "NotPossible"),
            moves=True,
        ),
        _method(
            "put",
            "Put a thing that is held down here, on or in a piece of furniture of this place.",
            THING,
            P("where", _optional(NAME), "furniture of this place; just here if left out", None),
            needs="manipulation",
            errors=("NotFound", "NotPossible"),
            moves=True,
        ),
        _method(
            "give",
            "Hand a thing that is held to a person who is here.",
            THING,
            SOMEONE,
            needs="manipulation",
            errors=("NotFound", "NotPossible"),
            moves=True,
        ),
        # --- people
        _method(
            "follow",
            "Go after a person until they reach a place, stand still for a while, or a stop.",
            PERSON,
            P("to", _optional(NAME), "the place where following ends", None),
            needs="following",
            errors=("NotFound", "UnknownPlace", "Blocked"),
            moves=True,
        ),
        _method(
            "guide",
            "Lead a person to a place at their pace, waiting for them.",
            PERSON,
            P("place", PLACE_OR_LOCATION, "where to"),
            needs="guiding",
            errors=("NotFound", *_GOING),
            moves=True,
        ),
        # --- itself
        _method(
            "clock",
            "Tell the time, the weekday, the date and the time zone.",
            returns=CLOCK,
            needs=CORE,
            looks_or_tells=True,
        ),
        _method(
            "battery",
            "Tell the battery's charge in percent.",
            returns=PERCENT,
            needs=CORE,
            looks_or_tells=True,
        ),
        _method(
            "do",
            "Use a skill of this robot's own, listed in its capabilities.",
            P("skill", NAME, 'such as "sit" for a robotic dog'),
            returns=ANYTHING,
            needs="skills",
            errors=("NotPossible",),
            moves=True,
            extra=True,
        ),
    )
}

CAPABILITIES: Final[tuple[str, ...]] = tuple(
    dict.fromkeys(method.capability for method in METHODS.values())
)
"""Every capability a robot can declare, in the order of the table."""

SUGGESTED_EMOTIONS: Final = ("neutral", "happy", "sad", "confused", "angry", "surprised")
SUGGESTED_GESTURES: Final = ("wave", "nod", "shake head", "bow", "point", "raise arms", "dance")
