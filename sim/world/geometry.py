"""Shapes and maps in metres and degrees: 0 along x, left is +."""

from __future__ import annotations

import math

import msgspec

Point = tuple[float, float]
"""x, y in metres."""

Polygon = tuple[Point, ...]
"""The corners in order; it closes itself."""

Segment = tuple[float, float, float, float]
"""x1, y1, x2, y2 in metres."""

OCCUPIED_THRESH, FREE_THRESH = 0.65, 0.196
"""What map_server takes where a map's file does not say."""


class Pose(msgspec.Struct, frozen=True):
    """A point and which way it faces. Metres and degrees."""

    x: float
    y: float
    theta: float = 0.0


class GridMap(msgspec.Struct, frozen=True, kw_only=True):
    """A map as ROS's map_server writes it; `sim.world.maps` reads the image."""

    image: str
    """The path of the PGM or PNG."""
    resolution: float
    """Metres a pixel."""
    origin: tuple[float, float, float]
    """Where the image's lower left corner is: metres, metres, degrees."""
    size: tuple[int, int]
    """Width and height in pixels."""
    negate: bool = False
    occupied_thresh: float = OCCUPIED_THRESH
    free_thresh: float = FREE_THRESH
    mode: str = "trinary"
    """ "trinary", "scale" or "raw"."""


def contains(polygon: Polygon, x: float, y: float) -> bool:
    """Whether the point is in the polygon (crossings of a ray to the right)."""
    inside = False
    x1, y1 = polygon[-1]
    for x2, y2 in polygon:
        if (y1 > y) != (y2 > y) and x < x1 + (y - y1) * (x2 - x1) / (y2 - y1):
            inside = not inside
        x1, y1 = x2, y2
    return inside


def polygon_area(polygon: Polygon) -> float:
    """Its area in square metres."""
    return 0.5 * abs(
        sum(
            x1 * y2 - x2 * y1
            for (x1, y1), (x2, y2) in zip(polygon, polygon[1:] + polygon[:1], strict=True)
        )
    )


def rectangle(pose: Pose, size: tuple[float, float]) -> Polygon:
    """The corners, anticlockwise, of a rectangle about the pose, its length along theta."""
    cosine, sine = math.cos(math.radians(pose.theta)), math.sin(math.radians(pose.theta))
    length, width = size[0] / 2, size[1] / 2
    return tuple(
        (pose.x + u * cosine - v * sine, pose.y + u * sine + v * cosine)
        for u, v in ((-length, -width), (length, -width), (length, width), (-length, width))
    )


def map_corners(grid: GridMap) -> list[Point]:
    """The four corners of the map's image in the world."""
    x, y, theta = grid.origin
    cosine, sine = math.cos(math.radians(theta)), math.sin(math.radians(theta))
    width, height = (pixels * grid.resolution for pixels in grid.size)
    return [
        (x + u * cosine - v * sine, y + u * sine + v * cosine)
        for u, v in ((0.0, 0.0), (width, 0.0), (width, height), (0.0, height))
    ]
