"""The record of a run: where everybody was when, and what happened; pictures are made from it."""

from __future__ import annotations

import math
from typing import Any

import msgspec


class Sample(msgspec.Struct, frozen=True, array_like=True):
    """Where the robot and the people were at one moment. Metres, degrees, seconds."""

    time: float
    x: float
    y: float
    theta: float
    people: tuple[tuple[float, float], ...] = ()
    """Where each person of `Record.people` was, in that order."""


class Happening(msgspec.Struct, frozen=True):
    """Something that happened, and where the robot was then.

    `kind` is one of `robot_api.driver.EVENTS` ("speech", "heard", "screen", "emotion", "gesture",
    "call", "battery", "stopped" ...) with the same data, or "grab", "put", "give" with the data
    {"thing": name, "person" or "where": name}.
    """

    time: float
    kind: str
    data: dict[str, Any]
    x: float
    y: float


class Record(msgspec.Struct):
    """The timeline of a run. It is only ever added to, in the order of time."""

    world: str
    people: tuple[str, ...] = ()
    samples: list[Sample] = []
    happenings: list[Happening] = []

    @property
    def duration(self) -> float:
        """From the first to the last moment, in seconds."""
        times = [sample.time for sample in (self.samples[:1] + self.samples[-1:])]
        times += [happening.time for happening in (self.happenings[:1] + self.happenings[-1:])]
        return max(times) - min(times) if times else 0.0

    @property
    def distance(self) -> float:
        """How far the robot drove, in metres."""
        return sum(
            math.hypot(b.x - a.x, b.y - a.y)
            for a, b in zip(self.samples, self.samples[1:], strict=False)
        )

    def between(self, start: float, end: float = math.inf) -> Record:
        """The part of the timeline from one moment to another, in seconds of simulated time."""
        start = round(start, 3)  # as what is noted is: it may be from this very moment
        return Record(
            world=self.world,
            people=self.people,
            samples=[sample for sample in self.samples if start <= sample.time <= end],
            happenings=[event for event in self.happenings if start <= event.time <= end],
        )


def to_json(record: Record) -> bytes:
    """The record as JSON, for a log."""
    return msgspec.json.encode(record)


def from_json(data: bytes | str) -> Record:
    """The record of such JSON. Raises `msgspec.MsgspecError` if it is none."""
    return msgspec.json.decode(data, type=Record)
