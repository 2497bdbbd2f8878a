"""Maps as ROS's map_server writes them (a PGM or PNG and its YAML), turned into walls.

A pixel's darkness p is (255 - value) / 255, or value / 255 with `negate`. As map_server has it, a
cell is occupied where p > occupied_thresh and free where p < free_thresh; what lies between is
unknown. Here a cell that is not free is an obstacle: a robot does not drive where nobody measured.
The walls are the outlines of the free floor, straightened by up to a pixel and a half, so that a
wall of many cells is a few segments.
"""

from __future__ import annotations

import functools
import itertools
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from sim.world import GridMap, Point, Polygon, Pose, Segment, map_corners

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

    Cells = npt.NDArray[np.bool_]

MAX_BYTES = 100_000_000
STRAIGHTEN = 1.5
"""By how many pixels an outline may be off the cells' edges."""
ROOM_TO_START = 0.4
"""Metres of free floor that the robot needs around where it starts."""

_BINARY_PGM = re.compile(rb"P5\s(?:\s*#[^\n]*\n)*\s*(\d+)\s+(?:#[^\n]*\n\s*)*(\d+)\s+(\d+)\s")


class ImageError(Exception):
    """The image of a map cannot be used; the message says why."""


def image_size(path: Path) -> tuple[int, int]:
    """Width and height of the image in pixels, once it is sure that it can be read.

    A binary PGM is judged by its head and length, without an imaging library, so that a world with
    a map loads as fast as one without. Raises `ImageError`.
    """
    try:
        length = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(4096)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ImageError(
            f"The map's image {path.name} cannot be read: {reason}. Give its path, from the "
            "folder of this file."
        ) from None
    if length > MAX_BYTES:
        raise ImageError(f"The map's image {path.name} is too large. Scale it down.")
    match = _BINARY_PGM.match(head)
    if match is None:
        rows, columns = _open(path).shape
        return columns, rows
    width, height, most = (int(number) for number in match.groups())
    if not width or not height:
        raise ImageError(f"The map's image {path.name} has no pixels. Save it again.")
    if not 0 < most < 65536 or length < match.end() + width * height * (1 + (most > 255)):
        raise ImageError(f"The map's image {path.name} is cut short. Save it again.")
    return width, height


def free_cells(grid: GridMap) -> Cells:
    """Which cells are free: rows from below (the world's y), columns from the left."""
    values = _open(Path(grid.image))
    darkness = values / 255 if grid.negate else (255 - values) / 255
    free: Cells = (darkness < grid.free_thresh)[::-1]
    return free


@functools.lru_cache(maxsize=4)
def outlines(grid: GridMap) -> tuple[Polygon, ...]:
    """The outlines of the free floor in metres: anticlockwise around it, clockwise around what
    stands in it."""
    import shapely

    place = _placing(grid)
    found: list[Polygon] = []
    for outline in _outlines(free_cells(grid)):
        line = shapely.LineString([place(u, v) for u, v in outline])
        straight = line.simplify(STRAIGHTEN * grid.resolution)
        # What is so small that nothing would be left of it stays as it is: a table's leg.
        corners = (straight if len(straight.coords) > 3 else line).coords
        found.append(tuple(corners[:-1]))
    return tuple(found)


def trace_walls(grid: GridMap) -> tuple[Segment, ...]:
    """The outlines of the free floor as straight segments in metres."""
    return tuple(
        (*one, *two)
        for outline in outlines(grid)
        for one, two in itertools.pairwise((*outline, outline[0]))
    )


def roomiest_pose(grid: GridMap) -> Pose | None:
    """Where to start: the map's own (0, 0), where mapping began, if the robot fits there; else the
    middle of the widest free floor. None if nothing is free."""
    import numpy as np
    from scipy import ndimage

    free = free_cells(grid)
    room = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] * grid.resolution
    if not free.any():
        return None
    place = _placing(grid)
    (x, y), theta = map_corners(grid)[0], math.radians(grid.origin[2])
    column = int((-x * math.cos(theta) - y * math.sin(theta)) / grid.resolution)
    row = int((x * math.sin(theta) - y * math.cos(theta)) / grid.resolution)
    on_the_map = 0 <= row < free.shape[0] and 0 <= column < free.shape[1]
    if on_the_map and room[row, column] >= ROOM_TO_START:
        return Pose(0.0, 0.0)
    row, column = (int(index) for index in np.unravel_index(np.argmax(room), room.shape))
    return Pose(*place(column + 0.5, row + 0.5))


def _open(path: Path) -> npt.NDArray[np.float64]:
    """The grey values, 0 to 255, of the image from its top row down."""
    import numpy as np
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(path) as image:
            image.load()
            if image.mode.startswith("I"):  # 16 bits a pixel
                return np.asarray(image, dtype=np.float64) / 257
            # map_server averages the colour channels and leaves transparency out.
            colours = np.asarray(image.convert("RGB"), dtype=np.float64)
            grey: npt.NDArray[np.float64] = colours.mean(axis=2)
            return grey
    except (UnidentifiedImageError, OSError, ValueError, SyntaxError) as error:
        raise ImageError(
            f"The map's image {path.name} is no PGM or PNG that can be read ({error}). "
            "Save it again as PGM."
        ) from None
    except Image.DecompressionBombError:
        raise ImageError(f"The map's image {path.name} is too large. Scale it down.") from None


def _placing(grid: GridMap) -> Callable[[float, float], Point]:
    """From columns and rows of the map to metres in the world."""
    x, y, degrees = grid.origin
    cosine = math.cos(math.radians(degrees)) * grid.resolution
    sine = math.sin(math.radians(degrees)) * grid.resolution

    def place(column: float, row: float) -> Point:
        return (
            round(x + column * cosine - row * sine, 6),
            round(y + column * sine + row * cosine, 6),
        )

    return place


def _outlines(free: Cells) -> list[list[tuple[int, int]]]:
    """Closed outlines of the free cells, each corner once and the first again in the end.

    Every edge between a free cell and another runs so that the free one is on its left.
    """
    import numpy as np

    padded = np.pad(free, 1)
    ahead: dict[tuple[int, int], list[tuple[int, int]]] = {}

    def edges(mask: Cells, start: tuple[int, int], end: tuple[int, int]) -> None:
        rows, columns = np.nonzero(mask[1:-1, 1:-1])
        for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
            one = (column + start[0], row + start[1])
            ahead.setdefault(one, []).append((column + end[0], row + end[1]))

    def beyond(rows: int, columns: int) -> Cells:
        """Cells that are free while their neighbour is not."""
        return padded & ~np.roll(padded, (-rows, -columns), (0, 1))

    edges(beyond(-1, 0), (0, 0), (1, 0))
    edges(beyond(0, 1), (1, 0), (1, 1))
    edges(beyond(1, 0), (1, 1), (0, 1))
    edges(beyond(0, -1), (0, 1), (0, 0))

    outlines = []
    while ahead:
        first = next(iter(ahead))
        outline, at = [first], first
        while True:
            at = _step(ahead, at, outline)
            if len(outline) > 1 and _straight(outline[-2], outline[-1], at):
                outline[-1] = at
            else:
                outline.append(at)
            if at == first:
                break
        outlines.append(outline)
    return outlines


def _step(
    ahead: dict[tuple[int, int], list[tuple[int, int]]],
    at: tuple[int, int],
    outline: list[tuple[int, int]],
) -> tuple[int, int]:
    """The next corner. Where two free cells touch at a corner only, keep left, along the same
    cell."""
    ways = ahead[at]
    if len(ways) > 1 and len(outline) > 1:
        back = outline[-2]
        u, v = at[0] - back[0], at[1] - back[1]
        ways.sort(key=lambda way: u * (way[1] - at[1]) - v * (way[0] - at[0]))
    way = ways.pop()
    if not ways:
        del ahead[at]
    return way


def _straight(a: tuple[int, int], b: tuple[int, int], c: tuple[int, int]) -> bool:
    return (b[0] - a[0]) * (c[1] - b[1]) == (b[1] - a[1]) * (c[0] - b[0])
