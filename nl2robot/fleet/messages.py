"""What robots of a fleet say to each other, inside of sealed messages.

| kind    | from, to             | what                                                          |
|---------|----------------------|---------------------------------------------------------------|
| who     | anybody, one         | a challenge; answered by `proof` with the same bytes           |
| tell    | anybody, one         | what is it? answered by `about`                                |
| about   | a robot, all         | `About`: at the start, when it changes, every half minute      |
| state   | a robot, all         | `Standing`: when it changes, and every second                  |
| order   | a dispatcher, one    | `Order`: offer, go, withdraw, ask                              |
| answer  | a robot, one         | `Answer`: how it stands with what it was offered               |
| stop    | anybody, one         | `Stop`                                                        |
| stopped | a robot, one         | `Stopped`: whether it has confirmed that it stands             |
| zones   | a robot, all         | `Zones`: the keep-out zones drawn on a map                     |
| plan    | anybody, one         | what has it planned? answered by `plans`                       |
| plans   | a robot, one         | `Plans`: the appointments of the fleet that are kept there     |
"""

from __future__ import annotations

from typing import Any, Final, Literal

import msgspec

from nl2robot.schedule.outcomes import Outcome
from nl2robot.schedule.plans import Plan
from sim.world.geometry import Polygon


class About(msgspec.Struct, frozen=True, kw_only=True):
    """What seldom changes of a robot."""

    name: str
    kind: str
    methods: tuple[str, ...]
    world: str
    map: str
    """The hash of what its floor looks like; robots with the same one share a map."""
    version: str


class Standing(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """How a robot stands now."""

    state: str
    """As `nl2robot.run.state`."""
    x: float | None = None
    y: float | None = None
    theta: float | None = None
    place: str | None = None
    battery: float | None = None
    """Percent."""
    charging: bool = False
    run: int | None = None
    because: str | None = None
    driven_by: str | None = None
    zones: str = ""
    """A hash of the keep-out zones that it knows of its map: who knows others says which."""
    plans: str | None = None
    """A hash of the fleet's appointments that it keeps; None: it does not say."""
    waits: str | None = None
    """Why it would begin nothing now, as `nl2robot.schedule.clerk.Waits`; None: it is free."""


class Order(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """What a dispatcher says of something to do."""

    offer: str
    what: Literal["offer", "go", "withdraw", "ask"]
    session: str = ""
    """The process of the robot that it is for: of two with one id, as where a data folder was
    copied, one alone may begin it."""
    program: str = ""
    sha256: str = ""
    sentence: str = ""
    language: str = "en"
    by: str = ""
    """Who approved it, and where, for the robot's log."""
    reviewed: str = ""
    """What their review found, as `nl2robot.schedule.findings` keeps it."""
    station: str = ""
    signature: bytes = b""
    """Of an offer and a go: whose approval it is, and that station's word for it
    (`nl2robot.fleet.trust`)."""


Stand = Literal["accepted", "refused", "expired", "withdrawn", "begun", "over"]
NOT_BEGUN: Final = ("refused", "expired", "withdrawn")
"""By which the robot says that it has not begun, and never will."""


class Answer(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """How it stands with an offer, by the robot's own book."""

    offer: str
    stand: Stand
    why: str | None = None
    run: int | None = None
    status: str | None = None
    """Of a run that is over, as `nl2robot.run.runs`, or "broken_off"."""
    reminded: tuple[Outcome, ...] = ()
    """What came of a run that reminded somebody."""


class Stop(msgspec.Struct, frozen=True):
    stop: str
    because: str
    everyone: bool = False
    """Whether all were stopped: then what no robot has begun is called off, too."""


class Stopped(msgspec.Struct, frozen=True):
    stop: str
    confirmed: bool
    because: str = ""


class ZoneEntry(msgspec.Struct, frozen=True, kw_only=True):
    """The last that was done to a zone of that name. Of two the one with the higher count holds."""

    name: str
    count: int
    robot: str
    """The id of the robot at which it was done."""
    polygon: Polygon | None
    """None: it was removed."""


class Zones(msgspec.Struct, frozen=True):
    map: str
    entries: tuple[ZoneEntry, ...]


class Plans(msgspec.Struct, frozen=True):
    name: str
    """Of the robot that keeps them."""
    plans: tuple[Plan, ...]


KINDS: Final[dict[str, Any]] = {
    "about": About,
    "state": Standing,
    "order": Order,
    "answer": Answer,
    "stop": Stop,
    "stopped": Stopped,
    "zones": Zones,
    "plans": Plans,
}
_decoders = {kind: msgspec.msgpack.Decoder(made) for kind, made in KINDS.items()}
_encode = msgspec.msgpack.Encoder().encode


def packed(message: msgspec.Struct) -> bytes:
    return _encode(message)


def unpacked(kind: str, payload: bytes) -> Any:
    """Raises `msgspec.MsgspecError` for what is none, KeyError for a kind of a later version."""
    return _decoders[kind].decode(payload)
