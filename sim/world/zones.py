"""What the outline of a keep-out zone must be like, whether a file has it or a hand drew it."""

from __future__ import annotations

import itertools
import math

from sim.world.geometry import Point, Polygon, contains, polygon_area

MOST_CORNERS = 100
FARTHEST = 1000.0
"""Metres from the origin."""
LEAST_AREA = 0.04
"""Square metres; what is smaller is a slip of the hand."""


def trouble_with(polygon: Polygon) -> str | None:
    """What is wrong with an outline, to be read after "it"; None if nothing is."""
    if len(polygon) < 3:
        return "has fewer than three corners. Draw it around an area."
    if len(polygon) > MOST_CORNERS:
        return f"has more than {MOST_CORNERS} corners. Draw it with fewer."
    if not all(math.isfinite(x) and math.isfinite(y) for x, y in polygon):
        return "has a corner that is no point. Give x and y in numbers."
    if any(abs(x) > FARTHEST or abs(y) > FARTHEST for x, y in polygon):
        return f"goes farther than {FARTHEST:g} metres from the origin. Draw it on the map."
    if _crosses_itself(polygon):
        return "crosses itself. Draw it around an area without crossing a line."
    if polygon_area(polygon) < LEAST_AREA:
        return f"is smaller than {LEAST_AREA:g} square metres. Draw it larger."
    return None


def _crosses_itself(polygon: Polygon) -> bool:
    """Whether two sides have a point in common, other than the corner between neighbours."""
    closed = itertools.pairwise((*polygon, polygon[0]))
    sides = [(a, b) for a, b in closed if a != b]  # a click may come twice
    for (i, (a, b)), (j, (c, d)) in itertools.combinations(enumerate(sides), 2):
        if j == i + 1 or (i == 0 and j == len(sides) - 1):
            # Neighbours may meet in their corner, but not lie on each other.
            before, corner, after = (a, b, d) if j == i + 1 else (c, d, b)
            if _folds_back(before, corner, after):
                return True
        elif _meet(a, b, c, d):
            return True
    return False


def _folds_back(before: Point, corner: Point, after: Point) -> bool:
    ahead = (before[0] - corner[0]) * (after[0] - corner[0])
    aside = (before[1] - corner[1]) * (after[1] - corner[1])
    return _turn(before, corner, after) == 0 and ahead + aside > 0


def _meet(a: Point, b: Point, c: Point, d: Point) -> bool:
    one, other = _turn(a, b, c), _turn(a, b, d)
    third, fourth = _turn(c, d, a), _turn(c, d, b)
    if one * other < 0 and third * fourth < 0:
        return True
    return any(
        turn == 0 and _between(start, end, point)
        for turn, start, end, point in (
            (one, a, b, c),
            (other, a, b, d),
            (third, c, d, a),
            (fourth, c, d, b),
        )
    )


def _turn(a: Point, b: Point, c: Point) -> float:
    """Positive if c lies left of the line from a to b, 0 on it."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _between(start: Point, end: Point, point: Point) -> bool:
    return min(start[0], end[0]) <= point[0] <= max(start[0], end[0]) and min(
        start[1], end[1]
    ) <= point[1] <= max(start[1], end[1])


def distance_to(polygon: Polygon, x: float, y: float) -> float:
    """How far a point is from an outline, in metres; 0 in it."""
    if contains(polygon, x, y):
        return 0.0
    return min(
        distance_to_line(start, end, (x, y))
        for start, end in itertools.pairwise((*polygon, polygon[0]))
    )


def distance_to_line(start: Point, end: Point, point: Point) -> float:
    """How far a point is from a line between two others."""
    along = (end[0] - start[0], end[1] - start[1])
    squared = along[0] ** 2 + along[1] ** 2
    share = 0.0
    if squared:
        off = (point[0] - start[0]) * along[0] + (point[1] - start[1]) * along[1]
        share = min(1.0, max(0.0, off / squared))
    return math.dist(point, (start[0] + share * along[0], start[1] + share * along[1]))
