"""A run as a moving picture: the robot and the people along the timeline, and what is said."""

from __future__ import annotations

import bisect
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from PIL import Image

from sim.pictures.floor import INK, Floor, draw_floor, person_shapes, robot_shapes
from sim.pictures.labels import LINE
from sim.pictures.png import blank, paint
from sim.pictures.run import BUBBLE_RIM, QUIET, people_at_first, time_colour
from sim.pictures.scene import Area, Box, Line, Shape, Spot, Text, rounded
from sim.pictures.story import told
from sim.pictures.text import text_width, wrapped
from sim.record import Record
from sim.world.model import World

LARGEST = (880.0, 640.0)
"""Pixels that the floor may have."""
MOST_FRAMES = 240
PER_SECOND = 10
"""Frames a second, as shown."""
SPEED = 5.0
"""A run is shown this much faster than it was, or more if it would have too many frames."""
_TITLE = 30.0
_SMOOTH = 2
_LETTERS = 12.5
_WIDTH = 230.0
_SHOWN = 3.0
"""Seconds of the run, at least, for which a bubble stays, and more for a longer text."""
_SHOWN_A_LETTER = 0.09
_LINGER_FRAMES = 15
"""How long the last picture stays before it begins again."""

_FORMATS = {".webp": "WEBP", ".gif": "GIF", ".png": "PNG"}


def animate(world: World, record: Record, path: str | Path) -> None:
    """Write a run as a moving picture; the name's end, .webp, .gif or .png, says which kind.

    Raises `ValueError` for another end, or if nothing was recorded; `OSError` if the file cannot
    be written.
    """
    path = Path(path)
    kind = _FORMATS.get(path.suffix.lower())
    if kind is None:
        raise ValueError(
            f'A moving picture cannot be written as "{path.name}". '
            "Let the name end in .webp, .gif or .png."
        )
    if not record.samples:
        raise ValueError("Nothing was recorded. Run a program first.")
    frames = list(_Film(world, record).frames())
    durations = [1000 // PER_SECOND] * len(frames)
    durations[-1] *= _LINGER_FRAMES
    options: dict[str, Any] = {}
    if kind == "WEBP":
        # Only what changes from frame to frame is kept: no whole pictures in between.
        options = {"quality": 62, "method": 0, "kmin": MOST_FRAMES, "kmax": MOST_FRAMES + 1}
    else:
        # All frames in the colours of the last one, which has all there are.
        palette = frames[-1].quantize(255, Image.Quantize.MAXCOVERAGE, kmeans=1)
        frames = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    frames[0].save(
        path, kind, save_all=True, append_images=frames[1:], duration=durations, loop=0, **options
    )


class _Film:
    """Draws the frames: what stands still once, what moves on a copy of it."""

    def __init__(self, world: World, record: Record) -> None:
        self.world = world
        self.record = record
        ways = [[(sample.x, sample.y) for sample in record.samples]]
        everybody = zip(*(sample.people for sample in record.samples), strict=False)
        ways += [list(way) for way in everybody]
        self.floor: Floor = draw_floor(
            world,
            people_at_first(world, record) or [],
            ways,
            symbols=False,
            top=_TITLE,
            largest=LARGEST,
        )
        scene = self.floor.scene
        scene.layer("title").append(Text(26, _TITLE - 6, world.name, 15, INK, "start", True))
        self.ground = paint(blank(scene, _SMOOTH), scene.shapes(), _SMOOTH)
        self.times = [sample.time for sample in record.samples]
        self.kinds = {person.name: person.kind for person in world.people}
        self.moments = [
            (happening.time, line)
            for happening in record.happenings
            if (line := told(happening)) is not None
        ]

    def frames(self) -> Iterator[Image.Image]:
        began = self.times[0]
        length = max(self.record.duration, 0.1)
        count = min(max(math.ceil(length / SPEED * PER_SECOND), 2), MOST_FRAMES)
        trail: Spot | None = None
        for number in range(count):
            share = number / (count - 1)
            time = began + share * length
            x, y, theta, people = self._at(time)
            spot = self.floor.frame.spot(x, y)
            if trail is not None and math.dist(trail, spot) > 0.5:
                # The trail stays: it is drawn onto the ground.
                paint(self.ground, [Line((trail, spot), time_colour(share), 3)], _SMOOTH)
            trail = spot
            image = paint(self.ground.copy(), self._moving(time, x, y, theta, people), _SMOOTH)
            yield image.reduce(_SMOOTH)

    def _moving(
        self, time: float, x: float, y: float, theta: float, people: Sequence[Spot]
    ) -> Iterator[Shape]:
        frame, scene = self.floor.frame, self.floor.scene
        for name, where in zip(self.record.people, people, strict=False):
            yield from person_shapes(frame, *where, name, self.kinds.get(name, "person"))
        yield from robot_shapes(frame, x, y, theta, self.world.robot.radius)
        elapsed = f"{time - self.times[0]:.0f} s"
        yield Text(scene.width - 26, _TITLE - 6, elapsed, 13, QUIET, "end")
        said = [
            line
            for since, line in self.moments
            if since <= time <= since + _SHOWN + _SHOWN_A_LETTER * len(line)
        ]
        if said:
            yield from self._bubble(frame.spot(x, y), said[-2:])

    def _bubble(self, spot: Spot, said: Sequence[str]) -> Iterator[Shape]:
        """Above the robot, or below it at the upper edge."""
        scene = self.floor.scene
        lines = [line for text in said for line in wrapped(text, _LETTERS, _WIDTH, 5)]
        width = max(text_width(line, _LETTERS) for line in lines) + 16
        height = len(lines) * _LETTERS * LINE + 12
        left = min(max(spot[0] - width / 2, 6), scene.width - width - 6)
        above = spot[1] - 18 - height > _TITLE
        top = spot[1] - 18 - height if above else spot[1] + 18
        box = Box(left, top, left + width, top + height)
        edge = box.bottom if above else box.top
        yield Line((spot, (min(max(spot[0], left + 8), left + width - 8), edge)), BUBBLE_RIM, 1.4)
        yield Area(rounded(box, 7), "#ffffff", BUBBLE_RIM, 1.2)
        for number, line in enumerate(lines):
            base = top + 6 + _LETTERS * (0.9 + LINE * number)
            yield Text(left + 8, base, line, _LETTERS, INK, "start")

    def _at(self, time: float) -> tuple[float, float, float, Sequence[Spot]]:
        """Where the robot and everybody was, between two samples."""
        samples = self.record.samples
        after = min(bisect.bisect_right(self.times, time), len(samples) - 1)
        one, two = samples[max(after - 1, 0)], samples[after]
        share = 0.0
        if two.time > one.time:
            share = min(max((time - one.time) / (two.time - one.time), 0.0), 1.0)
        turn = (two.theta - one.theta + 180) % 360 - 180

        def between(a: float, b: float) -> float:
            return a + (b - a) * share

        people = [
            (between(x1, x2), between(y1, y2))
            for (x1, y1), (x2, y2) in zip(one.people, two.people, strict=False)
        ]
        return (
            between(one.x, two.x),
            between(one.y, two.y),
            one.theta + turn * share,
            people,
        )
