"""Maps as ROS's map_server writes and reads them: an image and its YAML, turned into walls.

What map_server publishes of a pixel depends on the map's mode, and on its darkness p, which is
(255 - value) / 255, or value / 255 with `negate`:

    trinary  occupied (100) where p >= occupied_thresh, free (0) where p < free_thresh, else unknown
    scale    the same, and 0 to 100 between the two thresholds
    raw      the value itself where it is 0 to 100, else unknown; `negate` does not count

What is transparent is unknown in every mode. And so is, but in raw mode, the gray of 205: it is
what map_server writes for it, though with the `free_thresh` of 0.25 that ROS 2 writes beside it
the rule makes it free. The robots that took it at its word drove into what nobody had measured.

A cell is free here where it is 0, in raw mode where it is less than `free_thresh` in percent. What
is not free is an obstacle: a robot does not drive where nobody measured, or where somebody might
stand. The walls are the outlines of the free floor, straightened by up to a pixel and a half, so
that a wall of many cells is a few segments.
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from sim.world.geometry import GridMap, Point, Polygon, Pose, Segment, map_corners
from sim.world.map_image import read_image

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    from shapely.geometry.base import BaseGeometry

    Cells = npt.NDArray[np.bool_]
    Occupancy = npt.NDArray[np.int8]

What = Literal["free", "occupied", "unknown"]

UNKNOWN, FREE, OCCUPIED = -1, 0, 100
"""What a cell of ROS's OccupancyGrid says; between the last two, how likely something is there."""
UNKNOWN_DARKNESS = 50
"""Of 255: the gray of 205 that map_server writes for what is unknown."""
STRAIGHTEN = 1.5
"""By how many pixels an outline may be off the cells' edges."""
ROOM_TO_START = 0.4
"""Metres of free floor that the robot needs around where it starts."""


def occupancy(grid: GridMap) -> Occupancy:
    """What map_server would publish: -1 for unknown, or 0 to 100; rows from below (the map's y),
    columns from the left. Raises `ImageError`."""
    import numpy as np

    picture = read_image(Path(grid.image))
    read: Occupancy = _readings(grid, picture.white)[picture.shades]
    if picture.opaque is not None:
        read = np.where(picture.opaque, read, np.int8(UNKNOWN))
    return read[::-1]


def free_cells(grid: GridMap) -> Cells:
    """Which cells a robot may drive in; rows from below, columns from the left."""
    import numpy as np

    read = occupancy(grid)
    if grid.mode != "raw":
        return np.equal(read, FREE)
    free: Cells = (read >= FREE) & (read < grid.free_thresh * 100)
    return free


def occupied_cells(grid: GridMap) -> Cells:
    """Which cells have something in them, as far as is known; rows from below, columns from the
    left."""
    most = OCCUPIED if grid.mode != "raw" else grid.occupied_thresh * 100
    occupied: Cells = occupancy(grid) >= most
    return occupied


def _readings(grid: GridMap, white: int) -> Occupancy:
    """What is published of each shade from black to `white`."""
    import numpy as np

    shades = np.arange(white + 1) / white
    if grid.mode == "raw":
        values = np.rint(shades * 255)
        return np.where(values <= OCCUPIED, values, UNKNOWN).astype(np.int8)
    darkness = shades if grid.negate else 1 - shades
    readings = np.full(white + 1, UNKNOWN, np.int8)
    if grid.mode == "scale" and grid.occupied_thresh > grid.free_thresh:
        share = (darkness - grid.free_thresh) / (grid.occupied_thresh - grid.free_thresh)
        readings = np.rint(np.clip(share, 0, 1) * 100).astype(np.int8)
    readings[darkness < grid.free_thresh] = FREE
    readings[darkness >= grid.occupied_thresh] = OCCUPIED
    readings[np.rint(darkness * 255) == UNKNOWN_DARKNESS] = UNKNOWN
    return readings


def cell_at(grid: GridMap, x: float, y: float) -> tuple[int, int] | None:
    """Column and row, from the lower left, of the cell that the spot is in; None off the map."""
    left, bottom, degrees = grid.origin
    cosine, sine = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    u, v = x - left, y - bottom
    column = math.floor((u * cosine + v * sine) / grid.resolution)
    row = math.floor((v * cosine - u * sine) / grid.resolution)
    width, height = grid.size
    return (column, row) if 0 <= column < width and 0 <= row < height else None


def middle_of(grid: GridMap, column: int, row: int) -> Point:
    """Where the middle of a cell is, in metres."""
    return to_metres(grid)(column + 0.5, row + 0.5)


@functools.lru_cache(maxsize=4)
def outlines(grid: GridMap) -> tuple[Polygon, ...]:
    """The outlines of the free floor in metres: anticlockwise around it, clockwise around what
    stands in it."""
    return tuple(_straight_outline(grid, outline) for outline in cell_outlines(free_cells(grid)))


@functools.lru_cache(maxsize=4)
def painted(grid: GridMap) -> tuple[tuple[What, Polygon], ...]:
    """The map as areas in metres to be painted one over the other: what each is, and its outline.
    The first is the map as a whole, unknown."""
    found: list[tuple[float, bool, What, Polygon]] = []
    kinds: tuple[tuple[What, Cells], ...] = (
        ("free", free_cells(grid)),
        ("occupied", occupied_cells(grid)),
    )
    for what, cells in kinds:
        for outline in cell_outlines(cells):
            area = _signed_area(outline)
            # A hole is painted before what fills it, and is unknown until then.
            solid = area > 0
            straight = _straight_outline(grid, outline)
            found.append((-abs(area), solid, what if solid else "unknown", straight))
    found.sort(key=lambda piece: piece[:2])
    whole: tuple[What, Polygon] = ("unknown", tuple(map_corners(grid)))
    return (whole, *((what, outline) for _, _, what, outline in found))


@functools.lru_cache(maxsize=4)
def free_floor(grid: GridMap) -> BaseGeometry:
    """The free floor as an area, between the outlines."""
    import shapely

    free = free_cells(grid)

    def is_free(x: float, y: float) -> bool:
        cell = cell_at(grid, x, y)
        return cell is not None and bool(free[cell[::-1]])

    floor: BaseGeometry = shapely.union_all(list(enclosed(outlines(grid), is_free)))
    return floor


def enclosed(
    outlines: Iterable[Sequence[Point]], inside: Callable[[float, float], bool]
) -> Iterator[BaseGeometry]:
    """The areas between the outlines that are inside. Which they are is asked for a point of each:
    outlines may touch, and straightened ones cross by a pixel, so that it is no matter of
    counting."""
    import shapely

    rings = [shapely.LinearRing(outline) for outline in outlines]
    for face in shapely.get_parts(shapely.polygonize([shapely.union_all(rings)])):
        point = face.representative_point()
        if inside(point.x, point.y):
            yield face


def _straight_outline(grid: GridMap, outline: Sequence[tuple[int, int]]) -> Polygon:
    """In metres, with as few corners as may be."""
    import shapely

    place = to_metres(grid)
    line = shapely.LineString([place(u, v) for u, v in outline])
    straight = line.simplify(STRAIGHTEN * grid.resolution)
    # What is so small that nothing would be left of it stays as it is: a table's leg.
    corners = (straight if len(straight.coords) > 3 else line).coords
    return tuple(corners[:-1])


def _signed_area(outline: Sequence[tuple[int, int]]) -> float:
    """In pixels; negative for a hole."""
    return sum(a * d - c * b for (a, b), (c, d) in itertools.pairwise(outline)) / 2


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
    began = cell_at(grid, 0.0, 0.0)
    if began is not None and room[began[::-1]] >= ROOM_TO_START:
        return Pose(0.0, 0.0)
    row, column = (int(index) for index in np.unravel_index(np.argmax(room), room.shape))
    return Pose(*middle_of(grid, column, row))


def to_metres(grid: GridMap) -> Callable[[float, float], Point]:
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


def cell_outlines(cells: Cells) -> list[list[tuple[int, int]]]:
    """Closed outlines of the marked cells in columns and rows, each corner once and the first again
    in the end. Every edge between a marked cell and another has the marked one on its left."""
    import numpy as np

    padded = np.pad(cells, 1)
    ahead: dict[tuple[int, int], list[tuple[int, int]]] = {}

    def edges(mask: Cells, start: tuple[int, int], end: tuple[int, int]) -> None:
        rows, columns = np.nonzero(mask[1:-1, 1:-1])
        for row, column in zip(rows.tolist(), columns.tolist(), strict=True):
            one = (column + start[0], row + start[1])
            ahead.setdefault(one, []).append((column + end[0], row + end[1]))

    def beyond(rows: int, columns: int) -> Cells:
        """Cells that are marked while their neighbour is not."""
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
    """The next corner. Where two marked cells touch at a corner only, keep left, along the same
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
