"""How the robot and its program stand: one state, which is all that anybody shows.

    state = after(state, StopAsked("The robot was stopped."), now=time.time())

Without I/O: what happens goes in, a state comes out; nothing that happens is ever refused with an
error, it only may change nothing. `present` keeps the state of a station and tells everybody.

| state     | what is so                                             | may be followed by         |
|-----------|--------------------------------------------------------|----------------------------|
| idle      | nothing goes on                                        | all but pausing, paused    |
| reviewing | a program lies before somebody who decides on it       | all but pausing, paused    |
| charging  | the robot is at its charging station, nothing else     | all but pausing, paused    |
| running   | an approved program runs                               | all but paused, stopped    |
| pausing   | it was told to pause; the robot may still move         | all but stopped            |
| paused    | the robot has come to rest; the program waits          | all but pausing, stopped   |
| stopping  | it was told to stop; that is not confirmed, or the     | all but running, pausing,  |
|           | program is not over                                    | paused                     |
| stopped   | the robot has confirmed that it stands, nothing runs   | all but pausing, paused    |
| lost      | the robot cannot be reached                            | all but running, pausing,  |
|           |                                                        | paused                     |

A stop wins: from every state it leads to `stopping`, and only the robot's own confirmation leads
from there to `stopped`. A stop that was not confirmed stays `stopping`, with `unconfirmed`, until
one is; no program can begin before. What is true at the same time is told beside the state:
`lost_since`, `unconfirmed`, `charging`, `driven_by`.
"""

from __future__ import annotations

from typing import Any, Final, Literal, TypedDict

import msgspec

Phase = Literal[
    "idle",
    "reviewing",
    "charging",
    "running",
    "pausing",
    "paused",
    "stopping",
    "stopped",
    "lost",
]

GOING: Final = ("running", "pausing", "paused")
"""The states of a program that is not over."""
HELD: Final = ("pausing", "paused")
"""Those of one that was told to pause."""
PAUSED: Final = "Paused"
"""What the log calls the end of a call that a pause broke off."""

FOLLOWS: Final[dict[str, frozenset[str]]] = {
    **dict.fromkeys(
        ("idle", "reviewing", "charging", "stopped"),
        frozenset(
            ("idle", "reviewing", "charging", "running", "stopping", "stopped", "lost"),
        ),
    ),
    "running": frozenset(("idle", "reviewing", "charging", "pausing", "stopping", "lost")),
    "pausing": frozenset(
        ("idle", "reviewing", "charging", "running", "paused", "stopping", "lost")
    ),
    "paused": frozenset(("idle", "reviewing", "charging", "running", "stopping", "lost")),
    "stopping": frozenset(("idle", "reviewing", "charging", "stopped", "lost")),
    "lost": frozenset(("idle", "reviewing", "charging", "stopping", "stopped")),
}
"""Which states may follow which; the table above, for programs."""


class State(msgspec.Struct, frozen=True, kw_only=True):
    """How it stands. The first fields go over the wire, see `on_wire`; the rest is what is
    remembered to tell what comes next."""

    sequence: int
    """Rises with every change. It begins with the milliseconds since the epoch, so that it rises
    over a restart as well: of two states the one with the higher number is the newer."""
    state: Phase = "idle"
    since: float = 0.0
    """Seconds since the epoch, of `state`."""
    because: str | None = None
    """Why it is so, in a sentence, if there is more to say than the state itself."""
    run: int | None = None
    """The run that goes on; also while it is being stopped."""
    line: int | None = None
    """Where that is."""
    unconfirmed: bool = False
    """Whether the robot has not confirmed the last stop: it may still move."""
    lost_since: float | None = None
    """Seconds since the epoch; None while the robot can be reached."""
    charging: bool = False
    driven_by: str | None = None
    """Who has the helm, if somebody drives it by hand."""

    pause: Literal["pausing", "paused"] | None = None
    stops: int = 0
    """Stops that the robot has not answered."""
    ending: bool = False
    """Whether the program was told to end."""
    stands: bool = False
    """Whether the robot has confirmed the last stop, and nothing was begun since."""
    reviewing: tuple[str, ...] = ()
    """Before whom a program lies."""


class Told(TypedDict):
    """The fields of a `State` that others are told."""

    sequence: int
    state: Phase
    since: float
    because: str | None
    run: int | None
    line: int | None
    unconfirmed: bool
    lost_since: float | None
    charging: bool
    driven_by: str | None


ON_WIRE: Final = tuple(Told.__annotations__)


def on_wire(state: State) -> dict[str, Any]:
    """The data of the event `state`."""
    return {name: getattr(state, name) for name in ON_WIRE}


# --- what may happen -----------------------------------------------------------------------------


class Reviewing(msgspec.Struct, frozen=True):
    """A program lies before somebody from now on, or no longer."""

    who: str
    """By which they are told apart: the name of a conversation, or of a connection."""
    lies: bool


class Began(msgspec.Struct, frozen=True):
    """An approved program begins."""

    run: int


class AtLine(msgspec.Struct, frozen=True):
    line: int


class PauseAsked(msgspec.Struct, frozen=True):
    """The program is told to pause."""


class Halted(msgspec.Struct, frozen=True):
    """The robot, told to pause, has come to rest."""


class Resumed(msgspec.Struct, frozen=True):
    """The program goes on after a pause, if only for a step."""


class EndAsked(msgspec.Struct, frozen=True):
    """The program is told to end; a stop of the robot follows."""

    because: str


class Ended(msgspec.Struct, frozen=True):
    """The program is over."""

    run: int
    how: str
    """As `sandbox.execution.Outcome.status`."""
    because: str | None = None


class StopAsked(msgspec.Struct, frozen=True):
    """The robot is told to stop."""

    because: str


class StopConfirmed(msgspec.Struct, frozen=True):
    """The robot says that it stands."""

    because: str


class StopNotConfirmed(msgspec.Struct, frozen=True):
    """The robot has not said in time that it stands."""

    because: str


class Moving(msgspec.Struct, frozen=True):
    """The wheels turn."""


class Lost(msgspec.Struct, frozen=True):
    since: float
    because: str


class Found(msgspec.Struct, frozen=True):
    pass


class Charging(msgspec.Struct, frozen=True):
    charges: bool


class Driven(msgspec.Struct, frozen=True):
    """Somebody drives the robot by hand from now on, or nobody does any more."""

    by: str | None


Happening = (
    Reviewing
    | Began
    | AtLine
    | PauseAsked
    | Halted
    | Resumed
    | EndAsked
    | Ended
    | StopAsked
    | StopConfirmed
    | StopNotConfirmed
    | Moving
    | Lost
    | Found
    | Charging
    | Driven
)


# --- what comes of it ----------------------------------------------------------------------------


def after(state: State, happening: Happening, now: float) -> State:
    """The state after something happened at `now`, seconds since the epoch; the very same object if
    that is nothing to others."""
    changed = msgspec.structs.replace(state, **_changes(state, happening))
    phase = _phase(changed)
    because = changed.because
    if phase != state.state and because == state.because:
        because = None  # which told why the state before was so
    changed = msgspec.structs.replace(
        changed,
        state=phase,
        since=now if phase != state.state else state.since,
        because=because,
    )
    if changed == state:
        return state
    if on_wire(changed) == on_wire(state):
        return changed
    return msgspec.structs.replace(changed, sequence=state.sequence + 1)


def may_begin(state: State) -> bool:
    """Whether a program may begin now."""
    return state.run is None and state.state not in ("stopping", "lost")


def _phase(state: State) -> Phase:
    if state.stops:
        return "stopping"
    if state.lost_since is not None:
        return "lost"
    if state.unconfirmed or state.ending or (state.stands and state.run is not None):
        return "stopping"
    if state.run is not None:
        return state.pause or "running"
    if state.stands:
        return "stopped"
    if state.reviewing:
        return "reviewing"
    return "charging" if state.charging else "idle"


def _changes(state: State, happening: Happening) -> dict[str, Any]:
    match happening:
        case StopAsked(because):
            return {
                "stops": state.stops + 1,
                "ending": state.run is not None,
                "unconfirmed": False,
                "stands": False,
                "because": because,
            }
        case StopConfirmed(because):
            return {
                "stops": max(0, state.stops - 1),
                "unconfirmed": False,
                "stands": True,
                "because": because,
            }
        case StopNotConfirmed(because):
            return {
                "stops": max(0, state.stops - 1),
                "ending": state.run is not None,
                "unconfirmed": True,
                "stands": False,
                "because": because,
            }
        case Lost(since, because):
            return {
                "ending": state.run is not None,  # a program that runs ends with the loss
                "stands": False,
                # Nobody may ever answer for the stops that were on their way.
                "stops": 0,
                "unconfirmed": state.unconfirmed or state.stops > 0,
                "lost_since": since,
                "because": because,
            }
        case Found():
            return {"lost_since": None}
        case Charging(charges):
            return {"charging": charges}
        case Driven(by):
            return {"driven_by": by}
        case Moving():
            return {"stands": False} if state.run is None else {}
        case Reviewing(who, lies):
            others = tuple(each for each in state.reviewing if each != who)
            if not lies:
                return {"reviewing": others}
            # Whoever goes on after a stop has seen it.
            seen = {} if who in state.reviewing or state.run is not None else {"stands": False}
            return {**seen, "reviewing": (*others, who)}
        case _:
            return _changes_of_program(state, happening)


def _changes_of_program(state: State, happening: Happening) -> dict[str, Any]:
    going = state.state in GOING
    match happening:
        case Began(run) if may_begin(state):
            return {"run": run, "line": None, "pause": None, "stands": False, "because": None}
        case AtLine(line) if state.run is not None:
            return {"line": line}
        case PauseAsked() if state.state == "running":
            return {"pause": "pausing"}
        case Halted() if state.state == "pausing":
            return {"pause": "paused"}
        case Resumed() if going:
            return {"pause": None}
        case EndAsked(because) if state.run is not None:
            return {"ending": True, "because": because}
        case Ended(run, how, because) if state.run == run:
            over = {"run": None, "line": None, "pause": None, "ending": False, "because": because}
            return over if how == "stopped" else {**over, "stands": False}
    return {}
