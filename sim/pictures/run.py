"""A run drawn on its floor: the path in the colours of time, stops with what happened there."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from sim.pictures.floor import INK, Floor, Inhabitant, draw_floor, robot_shapes
from sim.pictures.labels import LINE, Board
from sim.pictures.scene import (
    Area,
    Box,
    Disc,
    Frame,
    Line,
    Scene,
    Shape,
    Spot,
    Text,
    box_about,
    box_at,
    mixed,
    rounded,
)
from sim.pictures.story import Stop, stops_of
from sim.pictures.text import shortened, text_width, wrapped
from sim.record import Record
from sim.world.model import World

TITLE = 44.0
LEGEND = 40.0
TIME = ("#12a594", "#3565d4", "#9436bd")
"""The colours of the path's beginning, middle and end."""
QUIET = "#6a7682"
BUBBLE_RIM = "#8693a1"
START = "#2f9e57"

_LETTERS = 12.5
_BUBBLE_WIDTH = 240.0
_BUBBLE_LINES = 12
_LINES_OF_ONE = 4
_PAD = 7.0
_FARTHEST = 400.0
"""Pixels that a bubble's middle may be off its stop; else what it says stands below the picture."""
_LONGEST_LEADER = 240.0
_CROSSED = 350.0
"""What it counts that a leader line runs across a label."""
_PIECES = 64
_ASIDE = 2.6
"""Pixels by which the path is drawn to the right of where it was, so that the way back is seen."""
_ARROW_EVERY = 95.0


def draw_run(world: World, record: Record) -> tuple[Scene, Frame]:
    """The floor with the run on it, a title above and a legend below."""
    stops = stops_of(record)
    ways = [[(sample.x, sample.y) for sample in record.samples]]
    ways += [[(stop.x - 0.2, stop.y), (stop.x + 0.2, stop.y)] for stop in stops]
    floor = draw_floor(world, people_at_first(world, record), ways, top=TITLE)
    _draw_title(floor.scene, record, world, sum(len(stop.visits) for stop in stops))
    _draw_walkers(floor, record)
    _draw_path(floor, record)
    _draw_start(floor, world, record)
    _draw_marks(floor, stops)
    leftover = _Bubbles(floor).draw(stops)
    if record.samples:
        last = record.samples[-1]
        robot = robot_shapes(floor.frame, last.x, last.y, last.theta, world.robot.radius)
        floor.scene.layer("robot").extend(robot)
    return _with_legend(floor, leftover), floor.frame


def draw_way(world: World, record: Record) -> tuple[Scene, Frame]:
    """The floor with the way alone, from its start to its end; nothing is told of time."""
    floor = draw_floor(world, [], [[(sample.x, sample.y) for sample in record.samples]])
    _draw_path(floor, record)
    _draw_start(floor, world, record)
    if record.samples:
        last = record.samples[-1]
        robot = robot_shapes(floor.frame, last.x, last.y, last.theta, world.robot.radius)
        floor.scene.layer("robot").extend(robot)
    return floor.scene, floor.frame


def summary(record: Record, name: str) -> str:
    """ "city-hospital: 1 min 42 s, 63 m"."""
    return f"{name}: {_duration(record.duration)}, {record.distance:.0f} m"


def _duration(seconds: float) -> str:
    whole = round(seconds)
    hours, minutes, rest = whole // 3600, whole // 60 % 60, whole % 60
    if hours:
        return f"{hours} h {minutes} min"
    return f"{minutes} min {rest} s" if minutes else f"{rest} s"


def people_at_first(world: World, record: Record) -> list[Inhabitant] | None:
    """Everybody where they were when the run began; None if the record does not tell."""
    if not record.samples or len(record.samples[0].people) != len(record.people):
        return None
    found: list[Inhabitant] = []
    for name, (x, y) in zip(record.people, record.samples[0].people, strict=True):
        person = world.person(name)
        found.append((x, y, name, person.kind if person else "person"))
    return found


def _draw_title(scene: Scene, record: Record, world: World, stays: int) -> None:
    layer = scene.layer("title")
    left, base = 26.0, TITLE - 10
    facts = [_duration(record.duration), f"{record.distance:.1f} m driven"]
    if stays:
        facts.append(f"{stays} stop{'s' if stays > 1 else ''}")
    rest = "  ·  ".join(facts)
    name = shortened(world.name, 20, max(scene.width - 2 * left - text_width(rest, 14) - 30, 60))
    layer.append(Text(left, base, name, 20, INK, "start", True))
    if text_width(name, 20) + text_width(rest, 14) + 2 * left + 20 <= scene.width:
        at = left + text_width(name, 20) + 18
        layer.append(Text(at, base, rest, 14, QUIET, "start"))


# --- the way -------------------------------------------------------------------------------------


def time_colour(share: float) -> str:
    """The colour of this share (0 to 1) of the run's time."""
    if share < 0.5:
        return mixed(TIME[0], TIME[1], share * 2)
    return mixed(TIME[1], TIME[2], min(share * 2 - 1, 1))


def _draw_path(floor: Floor, record: Record) -> None:
    track = _track(floor.frame, record)
    if len(track) < 2:
        return
    layer = floor.scene.layer("path")
    layer.append(Line(tuple(point[:2] for point in track), "#ffffff", 6.4))
    length = sum(math.dist(a[:2], b[:2]) for a, b in itertools.pairwise(track))
    for piece in _pieces(track, max(length / _PIECES, 6.0)):
        spots = tuple(point[:2] for point in piece)
        layer.append(Line(spots, time_colour(piece[len(piece) // 2][2]), 3.2))
        floor.board.draw(box_about(spots).grown(3), 2.0)
    layer.extend(_arrows(track))


_Point = tuple[float, float, float]
"""x, y in pixels, and the share of the run's time."""


def _track(frame: Frame, record: Record) -> list[_Point]:
    """The robot's way without its stands, moved a little to the right."""
    if len(record.samples) < 2:
        return []
    began, ended = record.samples[0].time, record.samples[-1].time
    whole = max(ended - began, 1e-9)
    way: list[_Point] = []
    for sample in record.samples:
        spot = frame.spot(sample.x, sample.y)
        if not way or math.dist(spot, way[-1][:2]) >= 2.5:
            way.append((*spot, (sample.time - began) / whole))
    aside: list[_Point] = []
    for number, (x, y, share) in enumerate(way):
        before, after = way[max(number - 1, 0)], way[min(number + 1, len(way) - 1)]
        u, v = after[0] - before[0], after[1] - before[1]
        length = math.hypot(u, v)
        if length > 1e-6:
            # In pixels y goes down: the right of (u, v) is (-v, u).
            x, y = x - v / length * _ASIDE, y + u / length * _ASIDE
        aside.append((x, y, share))
    return aside


def _pieces(track: Sequence[_Point], length: float) -> list[list[_Point]]:
    """The track in pieces of about this length, each beginning where the last one ends."""
    pieces: list[list[_Point]] = [[track[0]]]
    at = 0.0
    for before, after in itertools.pairwise(track):
        pieces[-1].append(after)
        at += math.dist(before[:2], after[:2])
        if at >= length:
            pieces.append([after])
            at = 0.0
    return [piece for piece in pieces if len(piece) > 1]


def _arrows(track: Sequence[_Point]) -> list[Shape]:
    """Heads along the path that show which way it was driven."""
    arrows: list[Shape] = []
    at = _ARROW_EVERY / 2
    for (x1, y1, share), (x2, y2, _) in itertools.pairwise(track):
        length = math.hypot(x2 - x1, y2 - y1)
        at -= length
        if at > 0 or length < 1e-6:
            continue
        at += _ARROW_EVERY
        u, v = (x2 - x1) / length, (y2 - y1) / length
        head = tuple(
            (x2 + a * u - b * v, y2 + a * v + b * u) for a, b in ((7, 0), (-4, 5.5), (-4, -5.5))
        )
        arrows.append(Area(head, time_colour(share), "#ffffff", 1))
    return arrows


def _draw_walkers(floor: Floor, record: Record) -> None:
    """Dots along the ways of the people who walked."""
    layer = floor.scene.layer("walkers")
    for number in range(len(record.people)):
        dotted: set[tuple[int, int]] = set()
        for sample in record.samples:
            if number < len(sample.people):
                x, y = floor.frame.spot(*sample.people[number])
                dotted.add((round(x / 10), round(y / 10)))
        if len(dotted) > 2:
            layer += [Disc(x * 10, y * 10, 1.5, "#a9b0b8") for x, y in sorted(dotted)]


def _draw_start(floor: Floor, world: World, record: Record) -> None:
    """A ring where the run began; room is kept for the robot where it ended."""
    if not record.samples:
        return
    first, last = record.samples[0], record.samples[-1]
    start, end = floor.frame.spot(first.x, first.y), floor.frame.spot(last.x, last.y)
    robot = max(world.robot.radius * floor.frame.scale, 7.0)
    ring = robot + 3.5 if math.dist(start, end) < robot else 7.0
    floor.scene.layer("start").append(Disc(*start, ring, "#ffffff", START, 3.2, "start"))
    for spot, radius in ((start, ring), (end, robot)):
        floor.board.labels.append(box_at(*spot, 2 * radius + 4, 2 * radius + 4))


# --- the stops -----------------------------------------------------------------------------------


def _draw_marks(floor: Floor, stops: Sequence[Stop]) -> None:
    """A dot at each stop and its number beside it."""
    layer = floor.scene.layer("stops")
    spots = [floor.frame.spot(stop.x, stop.y) for stop in stops]
    for spot in spots:
        layer.append(Disc(*spot, 3.6, INK, "#ffffff", 1.4))
        floor.board.draw(box_at(*spot, 8, 8), 40.0)
    for stop, spot in zip(stops, spots, strict=True):
        width, height = max(text_width(stop.numbers, 12) + 11, 19.0), 19.0
        box = _beside(floor.board, spot, width, height)
        layer.append(Line((spot, box.middle), INK, 1.3))
        layer.append(Area(rounded(box, height / 2), INK, "#ffffff", 1.4))
        x, y = box.middle
        layer.append(Text(x, y + 4.3, stop.numbers, 12, "#ffffff", "middle", True))
        floor.board.labels.append(box)


def _beside(board: Board, spot: Spot, width: float, height: float) -> Box:
    """A box near the spot, better where nothing is covered."""
    boxes = []
    for away in (15.0, 24.0, 36.0, 52.0, 75.0, 105.0, 140.0):
        for turn in range(16):
            angle = math.radians(turn * 22.5 - 45)
            x = spot[0] + math.cos(angle) * (away + width / 2 - 9)
            y = spot[1] + math.sin(angle) * away
            box = box_at(x, y, width, height)
            crossed = sum(_cuts(label, spot, box.middle) for label in board.labels)
            boxes.append((board.cost(box) + away * 8 + crossed * _CROSSED, box))
    cost, best = min(boxes, key=lambda pair: pair[0])
    return best if math.isfinite(cost) else box_at(*spot, width, height)


@dataclass
class _Bubbles:
    """Places the bubbles one by one, so that they cover neither each other nor any label, and no
    leader line runs across one."""

    floor: Floor
    leaders: list[tuple[Spot, Spot]] = field(default_factory=list)
    boxes: list[Box] = field(default_factory=list)

    def draw(self, stops: Sequence[Stop]) -> list[Stop]:
        """Returns the stops of which not all could be told in the picture."""
        leftover = []
        lines_of = [(stop, *_bubble_lines(stop)) for stop in stops if stop.lines]
        placed: list[tuple[Box, list[str]]] = []
        for stop, lines, complete in lines_of:
            spot = self.floor.frame.spot(stop.x, stop.y)
            box = self._place(spot, lines)
            if box is None or not complete:
                leftover.append(stop)
            if box is not None:
                placed.append((box, lines))
        back, layer = self.floor.scene.layer("leaders"), self.floor.scene.layer("bubbles")
        back += [Line(leader, BUBBLE_RIM, 1.2) for leader in self.leaders]
        for box, lines in placed:
            layer.append(Area(rounded(box, 7), "#ffffff", BUBBLE_RIM, 1.2))
            layer += [
                Text(
                    box.left + _PAD,
                    box.top + _PAD + _LETTERS * (0.86 + LINE * number),
                    line,
                    _LETTERS,
                    INK,
                    "start",
                )
                for number, line in enumerate(lines)
            ]
        return leftover

    def _place(self, spot: Spot, lines: Sequence[str]) -> Box | None:
        width = max(text_width(line, _LETTERS) for line in lines) + 2 * _PAD
        height = len(lines) * _LETTERS * LINE + 2 * _PAD - 2
        board = self.floor.board
        labels = [label for label in board.labels if not label.covers(box_at(*spot, 2, 2))]
        best: tuple[float, Box, Spot] | None = None
        for distance, x, y in _around(spot):
            if best is not None and best[0] <= distance * 5:
                break
            box = box_at(x, y, width, height)
            cost = board.cost(box.grown(3)) * 0.25
            if not math.isfinite(cost):
                continue
            end = _nearest(box, spot)
            length = math.dist(end, spot)
            cost += length * 5
            if length > _LONGEST_LEADER or (best is not None and cost >= best[0]):
                continue
            crossed = sum(_cuts(label, spot, end) for label in labels)
            cost += crossed * _CROSSED
            if crossed > 1 or (best is not None and cost >= best[0]):
                continue
            if self._clear(box, spot, end):
                best = (cost, box, end)
        if best is None:
            return None
        _, box, end = best
        self.leaders.append((spot, end))
        self.boxes.append(box)
        self.floor.board.labels.append(box)
        return box

    def _clear(self, box: Box, spot: Spot, end: Spot) -> bool:
        """Whether its leader crosses no bubble and no leader, and it covers no leader."""
        if any(_cuts(other.grown(2), spot, end) for other in self.boxes):
            return False
        return not any(
            _cuts(box.grown(2), *leader) or _cross(spot, end, *leader) for leader in self.leaders
        )


def _bubble_lines(stop: Stop) -> tuple[list[str], bool]:
    """The lines of a stop's bubble, and whether they are all that there is to tell."""
    lines: list[str] = []
    for text in stop.lines:
        lines += wrapped(text, _LETTERS, _BUBBLE_WIDTH, _LINES_OF_ONE)
    whole = sum(len(wrapped(text, _LETTERS, _BUBBLE_WIDTH, 999)) for text in stop.lines)
    if len(lines) > _BUBBLE_LINES:
        lines = [*lines[: _BUBBLE_LINES - 1], "(more below)"]
    return lines, len(lines) == whole


def _around(spot: Spot) -> list[tuple[float, float, float]]:
    """Middles to try for a bubble, the nearest first: how far from the spot, and where."""
    step = 14
    tries = []
    for i in range(-round(_FARTHEST / step), round(_FARTHEST / step) + 1):
        for j in range(-round(_FARTHEST / step), round(_FARTHEST / step) + 1):
            far = math.hypot(i, j) * step
            # A bubble is wider than high: its nearest point is nearer than its middle.
            tries.append((max(far - _BUBBLE_WIDTH, 0.0), spot[0] + i * step, spot[1] + j * step))
    return sorted(tries)


def _nearest(box: Box, spot: Spot) -> Spot:
    return (
        min(max(spot[0], box.left), box.right),
        min(max(spot[1], box.top), box.bottom),
    )


def _cuts(box: Box, a: Spot, b: Spot) -> bool:
    """Whether the line from a to b goes through the box."""
    low, high = 0.0, 1.0
    for start, change, near, far in (
        (a[0], b[0] - a[0], box.left, box.right),
        (a[1], b[1] - a[1], box.top, box.bottom),
    ):
        if abs(change) < 1e-9:
            if not near < start < far:
                return False
            continue
        ends = sorted(((near - start) / change, (far - start) / change))
        low, high = max(low, ends[0]), min(high, ends[1])
    return low < high


def _cross(a: Spot, b: Spot, c: Spot, d: Spot) -> bool:
    """Whether the line from a to b crosses the one from c to d."""

    def side(p: Spot, q: Spot, r: Spot) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


# --- below the picture ---------------------------------------------------------------------------


def _with_legend(floor: Floor, leftover: Sequence[Stop]) -> Scene:
    """The scene made higher for the legend, and for what the bubbles had no room for."""
    scene = floor.scene
    layer = scene.layer("legend")
    left, right = 26.0, scene.width - 26.0
    y = scene.height + LEGEND / 2 - 8
    x = left
    for shapes, word in _signs():
        width = 26 + text_width(word, 12) + 22
        if x + width > right and x > left:
            x, y = left, y + 24
        layer += [_moved(shape, x, y) for shape in shapes]
        layer.append(Text(x + 26, y + 4.2, word, 12, QUIET, "start"))
        x += width
    x, y = _draw_scale(layer, floor.frame, x, y, left, right)
    y += LEGEND / 2 + 4
    for stop in leftover:
        layer.append(Text(left, y + 12, stop.numbers, 12, INK, "start", True))
        indent = left + text_width(stop.numbers, 12) + 10
        for text in stop.visits[0].lines if len(stop.visits) == 1 else stop.lines:
            for line in wrapped(text, 12, right - indent, 40):
                layer.append(Text(indent, y + 12, line, 12, INK, "start"))
                y += 12 * LINE
        y += 5
    return replace(scene, height=y + (10 if leftover else 0))


def _signs() -> list[tuple[list[Shape], str]]:
    """What the legend explains: shapes about (0, 0) to (20, 0), and a word."""
    gradient: list[Shape] = [
        Line(((step * 2.0, 0), (step * 2.0 + 2, 0)), time_colour(step / 9), 3.6)
        for step in range(10)
    ]
    frame = Frame(30, 10, 0)
    number = Area(rounded(box_at(10, 0, 18, 18), 9), INK)
    bubble = Area(rounded(Box(1, -6.5, 20, 6.5), 4), "#ffffff", BUBBLE_RIM, 1.2)
    thing = Area(((10, -5), (15, 0), (10, 5), (5, 0)), "#d64541", INK, 1.1)
    return [
        ([Disc(10, 0, 6, "#ffffff", START, 3)], "start"),
        (robot_shapes(frame, 0, 0, 0, 0.25), "robot at the end"),
        (gradient, "path, from first to last"),
        ([number, Text(10, 4.3, "1", 12, "#ffffff", "middle", True)], "stop"),
        ([bubble], "what was said and done"),
        ([thing], "object"),
        ([Disc(3.0 + 5 * step, 0, 1.5, "#a9b0b8") for step in range(4)], "somebody walked"),
    ]


def _moved(shape: Shape, x: float, y: float) -> Shape:
    if isinstance(shape, (Disc, Text)):
        return replace(shape, x=shape.x + x, y=shape.y + y)
    return replace(shape, points=tuple((u + x, v + y) for u, v in shape.points))


def _draw_scale(
    layer: list[Shape], frame: Frame, x: float, y: float, left: float, right: float
) -> Spot:
    """A bar of a round length in metres."""
    metres = next(
        m for m in (1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000) if m * frame.scale > 100
    )
    word, length = f"{metres} m", metres * frame.scale
    if x + length + text_width(word, 12) + 12 > right:
        x, y = left, y + 24
    ends = (
        (x, y - 3),
        (x, y + 3),
        (x, y),
        (x + length, y),
        (x + length, y - 3),
        (x + length, y + 3),
    )
    layer.append(Line(ends, QUIET, 1.4))
    layer.append(Text(x + length + 8, y + 4.2, word, 12, QUIET, "start"))
    return x, y
