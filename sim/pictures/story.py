"""A run as a story: where the robot stopped, and in a few words what happened there."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from sim.record import Happening, Record

SAME_SPOT = 0.45
"""Metres within which two stops are one on the picture."""
STANDING = 3.0
"""Seconds that the robot stands still, with nothing happening, to make a stop."""
_NO_STORY = frozenset(
    {"pose", "lidar", "language", "volume", "joint", "battery", "log", "sound", "silence"}
    | {"searched", "stopping", "stop_not_confirmed", "link"}
)
"""Happenings that do not belong in a picture."""


@dataclass
class Visit:
    """One stay of the robot at a spot: its number in the order of time, and what happened."""

    number: int
    lines: list[str] = field(default_factory=list)


@dataclass
class Stop:
    """A spot in metres and the stays there."""

    x: float
    y: float
    visits: list[Visit]

    @property
    def numbers(self) -> str:
        """As on its mark: "1" or "1, 4, 7"."""
        numbers = [str(visit.number) for visit in self.visits]
        return ", ".join(numbers if len(numbers) <= 4 else [*numbers[:3], "..."])

    @property
    def lines(self) -> list[str]:
        """What happened there; after the numbers of the stays if there are several."""
        if len(self.visits) == 1:
            return self.visits[0].lines
        return [f"{visit.number}  {line}" for visit in self.visits for line in visit.lines]


def stops_of(record: Record) -> list[Stop]:
    """The stops of a run, in the order of the first stay at each."""
    stops: list[Stop] = []
    number = 0
    visit: Visit | None = None
    at = (math.inf, math.inf)
    for x, y, line in _moments(record):
        if visit is None or math.dist((x, y), at) > SAME_SPOT:
            number += 1
            visit, at = Visit(number), (x, y)
            stop = next((s for s in stops if math.dist((s.x, s.y), at) <= SAME_SPOT), None)
            if stop is None:
                stops.append(Stop(x, y, [visit]))
            else:
                stop.visits.append(visit)
        if line:
            visit.lines.append(line)
    return stops


def told(happening: Happening) -> str | None:
    """What happened in a few words; None for what does not belong in a picture."""
    data = happening.data
    match happening.kind:
        case "speech":
            return f"“{_text(data, 'text')}”"
        case "heard":
            return f"{_text(data, 'person') or 'hears'}: “{_text(data, 'text')}”"
        case "grab":
            return f"picks up {_text(data, 'thing')}"
        case "put":
            where = _text(data, "where")
            return f"puts down {_text(data, 'thing')}" + (f" on {where}" if where else "")
        case "give":
            person = _text(data, "person")
            return f"gives {_text(data, 'thing')}" + (f" to {person}" if person else "")
        case "gesture":
            return f"gesture: {_text(data, 'name')}"
        case "emotion":
            return f"looks {_text(data, 'name')}"
        case "screen":
            shown = _text(data, "text") or _text(data, "url") or _options(data)
            return f"shows “{shown}”" if shown else None
        case "call":
            state = _text(data, "state")
            return f"video call {_text(data, 'contact')}" + (f": {state}" if state else "")
        case "stopped":
            return f"stopped: {_text(data, 'because')}"
        case kind if kind in _NO_STORY:
            return None
        case kind:  # what only the capability knows that tells it
            return f"{kind}: {', '.join(_text(data, name) for name in data)}"


def _text(data: dict[str, Any], name: str) -> str:
    value = data.get(name)
    return "" if value is None else " ".join(str(value).split())


def _options(data: dict[str, Any]) -> str:
    options = data.get("options")
    return " / ".join(str(option) for option in options) if isinstance(options, list) else ""


def _moments(record: Record) -> Iterator[tuple[float, float, str | None]]:
    """In the order of time: what happened where, and where the robot just stood for long."""
    moments: list[tuple[float, float, float, str | None]] = [
        (happening.time, happening.x, happening.y, line)
        for happening in record.happenings
        if (line := told(happening))
    ]
    ends = {(0.0, 0.0)}
    if record.samples:
        ends = {(record.samples[0].x, record.samples[0].y)}
        ends.add((record.samples[-1].x, record.samples[-1].y))
    for start, end, x, y in _standing(record):
        quiet = not any(start - 0.5 <= time <= end + 0.5 for time, *_ in moments)
        at_an_end = any(math.dist((x, y), spot) <= SAME_SPOT for spot in ends)
        if end - start >= STANDING and quiet and not at_an_end:
            moments.append((start, x, y, None))
    for _, x, y, line in sorted(moments, key=lambda moment: moment[0]):
        yield x, y, line


def _standing(record: Record) -> Iterator[tuple[float, float, float, float]]:
    """From when to when the robot stood still, and where."""
    samples = record.samples
    first = 0
    for number in range(1, len(samples) + 1):
        still = (
            number < len(samples)
            and math.dist(
                (samples[number].x, samples[number].y), (samples[first].x, samples[first].y)
            )
            <= 0.02
        )
        if not still:
            yield (
                samples[first].time,
                samples[number - 1].time,
                samples[first].x,
                samples[first].y,
            )
            first = number
