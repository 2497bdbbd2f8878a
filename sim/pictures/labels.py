"""Where labels go, so that none is cut, covers another, or hides much of what is below it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from sim.pictures.scene import Box, Spot, Text, box_about, box_at
from sim.pictures.text import text_width, wrapped
from sim.world.geometry import contains

LINE = 1.2
"""From one base line to the next, as a share of the letter size."""
ASCENT = 0.8
_SIZES = (15.0, 14.0, 13.0, 12.0, 11.0, 10.0, 9.0, 8.0)
_SMALLER = 90.0
"""What a label's being one size smaller counts, in square pixels covered."""
_GRID = 12
_CELL = 2
"""Pixels: how finely it is kept what is drawn where."""


class Board:
    """What is taken on a picture: `labels`, which nothing may cover, and drawings, which had better
    not be covered, each by its weight for every square pixel."""

    def __init__(self, whole: Box) -> None:
        self.whole = whole
        self.labels: list[Box] = []
        self._weights = np.zeros((_cell(whole.bottom) + 1, _cell(whole.right) + 1))
        self._sums: NDArray[np.float64] | None = None

    def draw(self, box: Box, weight: float) -> None:
        """Something has been drawn in the box."""
        rows = slice(_cell(box.top), max(_cell(box.bottom), _cell(box.top) + 1))
        columns = slice(_cell(box.left), max(_cell(box.right), _cell(box.left) + 1))
        self._weights[rows, columns] += weight
        self._sums = None

    def cost(self, box: Box) -> float:
        """What covering this box covers; infinite for labels and beyond the picture."""
        if not box.within(self.whole) or any(label.covers(box) for label in self.labels):
            return math.inf
        if self._sums is None:
            # The sum of all weights above and to the left: a box's sum is four of these.
            self._sums = np.pad(self._weights.cumsum(0).cumsum(1), ((1, 0), (1, 0)))
        sums = self._sums
        top, bottom = _cell(box.top), _cell(box.bottom) + 1
        left, right = _cell(box.left), _cell(box.right) + 1
        inner = sums[bottom, right] - sums[top, right] - sums[bottom, left] + sums[top, left]
        return float(inner) * _CELL * _CELL


def _cell(pixels: float) -> int:
    return max(int(pixels / _CELL), 0)


def text_box(x: float, y: float, lines: Sequence[str], size: float) -> Box:
    """The box of lines of text that has its middle there."""
    width = max(text_width(line, size) for line in lines)
    return box_at(x, y, width + size * 0.4, size * LINE * len(lines) + size * 0.1)


def text_lines(box: Box, lines: Sequence[str], size: float, colour: str) -> list[Text]:
    """The lines, each in the middle of the box."""
    x = (box.left + box.right) / 2
    top = box.top + size * 0.05 + size * (LINE - 1) / 2
    return [
        Text(x, top + size * (ASCENT + LINE * number), line, size, colour)
        for number, line in enumerate(lines)
    ]


def label_area(board: Board, name: str, outline: Sequence[Spot], colour: str) -> list[Text] | None:
    """The name of a room, somewhere in its outline, as large and as free as can be; None if there
    is no room for it."""
    around = box_about(outline)
    middle_x, middle_y = around.middle
    best: tuple[float, Box, list[str], float] | None = None
    for size in _SIZES:
        penalty = _SMALLER * (_SIZES[0] - size)
        if best is not None and best[0] <= penalty:
            break
        for lines in _breakings(name, size, around.right - around.left):
            for x, y in _grid(around):
                box = text_box(x, y, lines, size)
                if not all(contains(tuple(outline), *spot) for spot in _rim(box)):
                    continue
                far = math.hypot((x - middle_x) / 2, y - middle_y)
                cost = penalty + board.cost(box) + far + 40 * (len(lines) - 1)
                if math.isfinite(cost) and (best is None or cost < best[0]):
                    best = (cost, box, lines, size)
    if best is None:
        return None
    _, box, lines, size = best
    board.labels.append(box)
    return text_lines(box, lines, size, colour)


def label_spot(
    board: Board, name: str, spot: Spot, radius: float, size: float, colour: str
) -> list[Text] | None:
    """The name of something small, beside it; None if there is no room for it."""
    width = text_width(name, size)
    best: tuple[float, Box] | None = None
    for box in _beside(spot, radius, width + size * 0.4, size * LINE):
        cost = board.cost(box)
        if best is None or cost < best[0]:
            best = (cost, box)
    if best is None or math.isinf(best[0]):
        return None
    board.labels.append(best[1])
    return text_lines(best[1], [name], size, colour)


def _beside(spot: Spot, radius: float, width: float, height: float) -> Iterable[Box]:
    """Below, above, right, left, and the same a little further off."""
    x, y = spot
    for gap in (1.0, 5.0, 10.0):
        away_x, away_y = radius + gap + width / 2, radius + gap + height / 2
        yield box_at(x, y + away_y, width, height)
        yield box_at(x, y - away_y, width, height)
        yield box_at(x + away_x, y, width, height)
        yield box_at(x - away_x, y, width, height)
        for side in (-0.6, 0.6):
            yield box_at(x + side * away_x, y + away_y, width, height)
            yield box_at(x + side * away_x, y - away_y, width, height)


def _breakings(name: str, size: float, width: float) -> Iterable[list[str]]:
    """The name on one line, two, three, as far as it is several words."""
    words = name.split()
    seen: list[list[str]] = []
    for lines in range(1, min(3, len(words)) + 1):
        share = text_width(name, size) / lines
        longest = max(text_width(word, size) for word in words)
        broken = wrapped(name, size, max(share * 1.15, longest) + 1, 4)
        if broken not in seen and max(text_width(line, size) for line in broken) < width:
            seen.append(broken)
            yield broken


def _grid(box: Box) -> Iterable[Spot]:
    for i in range(1, _GRID):
        for j in range(1, _GRID):
            yield (
                box.left + (box.right - box.left) * i / _GRID,
                box.top + (box.bottom - box.top) * j / _GRID,
            )


def _rim(box: Box) -> Iterable[Spot]:
    x, y = box.middle
    for u in (box.left, x, box.right):
        for v in (box.top, y, box.bottom):
            yield (u, v)
