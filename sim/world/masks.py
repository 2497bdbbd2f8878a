"""Keep-out masks: what is occupied in a second map becomes outlines to keep out of.

Outlines have no holes and few corners, but the cells of a mask lie as somebody's brush left them.
So the masked area is grown by a pixel, straightened by a little less, and cut where it has a hole
or too many corners. The outlines are never smaller than the mask, and go beyond it by `tolerance`
at most.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from sim.world.geometry import GridMap, Polygon
from sim.world.maps import cell_outlines, enclosed, occupied_cells, to_metres
from sim.world.zones import LEAST_AREA, MOST_CORNERS

if TYPE_CHECKING:
    from shapely.geometry import Polygon as Area
    from shapely.geometry.base import BaseGeometry

MOST_AREAS = 200
"""Outlines of one mask; with more, finding ways between them takes too long."""

# All in pixels.
_GROW, _STRAIGHTEN = 1.0, 0.9
_REACH = 2.5
"""How far that goes beyond the mask: a grown corner is the square root of two away."""
_OVERLAP = 0.02
"""What two parts of a cut area share, so that there is nothing between them."""
_GRID = 0.01
"""To which corners are rounded."""

_FATTEN = 1.02 * math.sqrt(LEAST_AREA / math.pi)
"""Metres by which what would be too small for a zone is grown: to a disc, at least."""
_SHARPEST = 1.5
"""How many times farther the end of a spike goes then; its two corners are farther, beside it."""


class MaskError(Exception):
    """A mask cannot be made into zones; the message says why."""


def tolerance(mask: GridMap) -> float:
    """How many metres an outline goes beyond the masked cells at most: some pixels, and what a
    single dot needs to become as large as a zone must be."""
    return _REACH * mask.resolution + math.hypot(_SHARPEST, 1) * _FATTEN


@functools.lru_cache(maxsize=4)
def masked_areas(mask: GridMap) -> tuple[Polygon, ...]:
    """Outlines in metres, each sound by `sim.world.zones.trouble_with`, that cover every occupied
    cell of the mask. Raises `MaskError`, `sim.world.map_image.ImageError`."""
    place = to_metres(mask)
    found: list[Polygon] = []
    for part in _parts(mask):
        found.append(tuple(place(u, v) for u, v in part.exterior.coords[:-1]))
        if len(found) > MOST_AREAS:
            raise MaskError(
                f"The keep-out mask has more than {MOST_AREAS} separate areas. Clean its image of "
                "specks, or join areas that are close to each other."
            )
    return tuple(found)


def _parts(mask: GridMap) -> Iterator[Area]:
    """The outlines, in columns and rows of the mask."""
    import shapely

    cells = occupied_cells(mask)
    if not cells.any():
        return
    faces = enclosed(cell_outlines(cells), lambda u, v: bool(cells[int(v), int(u)]))
    masked = shapely.union_all(list(faces))
    least = 1.01 * LEAST_AREA / mask.resolution**2
    for area in shapely.get_parts(masked.buffer(_GROW, join_style="mitre")):
        for part in _cut(_straightened(area, masked)):
            if part.area < least:
                by = _FATTEN / mask.resolution
                yield part.buffer(by, join_style="mitre", mitre_limit=_SHARPEST)
            else:
                yield part


def _straightened(area: Area, masked: BaseGeometry) -> BaseGeometry:
    """With fewer corners, and without the holes that are too narrow to matter."""
    import shapely

    holes = [
        hole for hole in area.interiors if not shapely.Polygon(hole).buffer(-_STRAIGHTEN).is_empty
    ]
    plain = shapely.Polygon(area.exterior, holes)
    straight = plain.simplify(_STRAIGHTEN)
    inner = (masked & plain).buffer((_GROW - _STRAIGHTEN) / 2, join_style="mitre")
    outer = plain.buffer(_STRAIGHTEN)
    if not (straight.covers(inner) and outer.covers(straight)):
        # Where an outline begins GEOS straightens twice, so let it do half of it.
        straight = plain.simplify(_STRAIGHTEN / 2)
    return shapely.set_precision(straight, _GRID)


def _cut(area: BaseGeometry) -> Iterator[Area]:
    """The parts of the area that have no holes and few enough corners."""
    import shapely

    for part in shapely.get_parts(area):
        if not part.interiors and len(part.exterior.coords) - 1 <= MOST_CORNERS:
            yield part
            continue
        left, bottom, right, top = part.bounds
        # A cut through a hole opens it; between two columns or rows it leaves every cell whole.
        a, b, c, d = part.interiors[0].bounds if part.interiors else part.bounds
        if right - left > top - bottom:
            at = _between(a, c)
            halves = ((left, bottom, at + _OVERLAP, top), (at - _OVERLAP, bottom, right, top))
        else:
            at = _between(b, d)
            halves = ((left, bottom, right, at + _OVERLAP), (left, at - _OVERLAP, right, top))
        for half in halves:
            yield from _cut(_areas_of(part & shapely.box(*half)))


def _between(low: float, high: float) -> float:
    """About the middle; a whole number if there is one between."""
    middle = (low + high) / 2
    whole = float(round(middle))
    return whole if low + 2 * _OVERLAP < whole < high - 2 * _OVERLAP else middle


def _areas_of(cut: BaseGeometry) -> BaseGeometry:
    """Without the lines and points in which a cut may have touched."""
    import shapely

    rounded = shapely.set_precision(cut, _GRID)
    return shapely.union_all([each for each in shapely.get_parts(rounded) if each.area > 0])
