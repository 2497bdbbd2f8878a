"""What a picture is made of: shapes in pixels, x to the right and y down, in layers.

A `Scene` is drawn the same by `sim.pictures.svg` and `sim.pictures.png`. A `Frame` tells where a
point of the world lies in it. Colours are opaque "#rrggbb".
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

Spot = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Area:
    """A filled polygon."""

    points: tuple[Spot, ...]
    fill: str | None
    stroke: str | None = None
    width: float = 1.0
    note: str = ""
    """What a pointer over it tells, where the picture can."""


@dataclass(frozen=True, slots=True)
class Line:
    """A line through points; `square` ends reach half the width beyond, others are round."""

    points: tuple[Spot, ...]
    stroke: str
    width: float = 1.0
    square: bool = False


@dataclass(frozen=True, slots=True)
class Disc:
    x: float
    y: float
    radius: float
    fill: str
    stroke: str | None = None
    width: float = 1.0
    note: str = ""


@dataclass(frozen=True, slots=True)
class Text:
    """One line of text; `y` is its base line; `anchor` says what of it is at `x`."""

    x: float
    y: float
    text: str
    size: float
    colour: str
    anchor: str = "middle"
    """ "start", "middle" or "end"."""
    bold: bool = False


Shape = Area | Line | Disc | Text


@dataclass(frozen=True)
class Scene:
    """A picture of `width` x `height` pixels; layers by name, the first at the bottom."""

    width: float
    height: float
    background: str
    layers: dict[str, list[Shape]] = field(default_factory=dict)

    def layer(self, name: str) -> list[Shape]:
        """The layer of this name, put on top if it is new."""
        return self.layers.setdefault(name, [])

    def shapes(self) -> Iterable[Shape]:
        for shapes in self.layers.values():
            yield from shapes


@dataclass(frozen=True)
class Frame:
    """Where the world lies in the picture: `scale` pixels a metre, the world's (0, 0) at
    (`left`, `top`), y up."""

    scale: float
    left: float
    top: float

    def spot(self, x: float, y: float) -> Spot:
        return (self.left + x * self.scale, self.top - y * self.scale)

    def spots(self, points: Iterable[tuple[float, float]]) -> tuple[Spot, ...]:
        return tuple(self.spot(x, y) for x, y in points)


@dataclass(frozen=True, slots=True)
class Box:
    """A rectangle in pixels, to tell what would cover what."""

    left: float
    top: float
    right: float
    bottom: float

    @property
    def middle(self) -> Spot:
        return ((self.left + self.right) / 2, (self.top + self.bottom) / 2)

    def grown(self, by: float) -> Box:
        return Box(self.left - by, self.top - by, self.right + by, self.bottom + by)

    def covers(self, other: Box) -> bool:
        """Whether they have a piece in common."""
        return (
            self.left < other.right
            and other.left < self.right
            and self.top < other.bottom
            and other.top < self.bottom
        )

    def within(self, other: Box) -> bool:
        return (
            self.left >= other.left
            and self.right <= other.right
            and self.top >= other.top
            and self.bottom <= other.bottom
        )


def box_about(points: Sequence[Spot]) -> Box:
    """The least box about the points."""
    xs, ys = zip(*points, strict=True)
    return Box(min(xs), min(ys), max(xs), max(ys))


def box_at(x: float, y: float, width: float, height: float) -> Box:
    """The box with its middle there."""
    return Box(x - width / 2, y - height / 2, x + width / 2, y + height / 2)


def rounded(box: Box, radius: float) -> tuple[Spot, ...]:
    """The outline of the box with round corners."""
    radius = min(radius, (box.right - box.left) / 2, (box.bottom - box.top) / 2)
    points = []
    for x, y, start in (
        (box.right - radius, box.bottom - radius, 0),
        (box.left + radius, box.bottom - radius, 90),
        (box.left + radius, box.top + radius, 180),
        (box.right - radius, box.top + radius, 270),
    ):
        for step in range(7):
            angle = math.radians(start + step * 15)
            points.append((x + radius * math.cos(angle), y + radius * math.sin(angle)))
    return tuple(points)


def dashes(points: Sequence[Spot], on: float, off: float) -> list[tuple[Spot, Spot]]:
    """The line through the points in pieces of length `on` with gaps of `off`."""
    pieces: list[tuple[Spot, Spot]] = []
    left, drawing = on, True
    for (x1, y1), (x2, y2) in itertools.pairwise(points):
        length, at = math.hypot(x2 - x1, y2 - y1), 0.0
        while length - at > 1e-6:
            step = min(left, length - at)
            if drawing:
                (a, b) = (at / length, (at + step) / length)
                pieces.append(
                    (
                        (x1 + (x2 - x1) * a, y1 + (y2 - y1) * a),
                        (x1 + (x2 - x1) * b, y1 + (y2 - y1) * b),
                    )
                )
            at, left = at + step, left - step
            if left <= 1e-6:
                drawing = not drawing
                left = on if drawing else off
    return pieces


def hatching(polygon: Sequence[Spot], apart: float) -> list[tuple[Spot, Spot]]:
    """Slanting lines through a polygon, so many pixels apart."""
    sides = list(itertools.pairwise((*polygon, polygon[0])))
    depths = [x + y for x, y in polygon]  # the same all along a line that slants upwards
    lines: list[tuple[Spot, Spot]] = []
    step = apart * math.sqrt(2)
    for number in range(math.ceil(min(depths) / step), math.floor(max(depths) / step) + 1):
        depth = number * step
        crossings = sorted(
            (x1 + (x2 - x1) * share, y1 + (y2 - y1) * share)
            for (x1, y1), (x2, y2) in sides
            if (x1 + y1 > depth) != (x2 + y2 > depth)
            for share in [(depth - x1 - y1) / (x2 + y2 - x1 - y1)]
        )
        lines += zip(crossings[::2], crossings[1::2], strict=True)
    return lines


def arc(x: float, y: float, radius: float, start: float, end: float) -> tuple[Spot, ...]:
    """Points on a circle from one angle to another, in degrees, anticlockwise as seen."""
    steps = max(2, round(abs(end - start) / 10))
    angles = [math.radians(start + (end - start) * step / steps) for step in range(steps + 1)]
    return tuple((x + radius * math.cos(a), y - radius * math.sin(a)) for a in angles)


def mixed(one: str, two: str, share: float) -> str:
    """The colour so far (0 to 1) from one to the other."""
    pairs = zip(_channels(one), _channels(two), strict=True)
    return "#" + "".join(f"{round(a + (b - a) * share):02x}" for a, b in pairs)


def _channels(colour: str) -> tuple[int, ...]:
    return tuple(int(colour[i : i + 2], 16) for i in (1, 3, 5))
