"""Scenes as pixels, drawn by Pillow several times larger and scaled down for smooth edges."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence

from PIL import Image, ImageDraw

from sim.pictures.scene import Area, Disc, Line, Scene, Shape, Spot, Text
from sim.pictures.text import draw_text

SMOOTH = 3
"""How many times larger it is drawn."""


def to_image(scene: Scene, smooth: int = SMOOTH) -> Image.Image:
    """The scene as an RGB image of its size in pixels."""
    return paint(blank(scene, smooth), scene.shapes(), smooth).reduce(smooth)


def blank(scene: Scene, smooth: int = SMOOTH) -> Image.Image:
    size = (math.ceil(scene.width) * smooth, math.ceil(scene.height) * smooth)
    return Image.new("RGB", size, scene.background)


def paint(image: Image.Image, shapes: Iterable[Shape], smooth: int = SMOOTH) -> Image.Image:
    """Draw the shapes into the image, which is `smooth` times larger than they say."""
    draw = ImageDraw.Draw(image)
    for shape in shapes:
        _draw(draw, shape, smooth)
    return image


def _draw(draw: ImageDraw.ImageDraw, shape: Shape, scale: int) -> None:
    if isinstance(shape, Text):
        at = (shape.x * scale, shape.y * scale)
        draw_text(draw, at, shape.text, shape.size * scale, shape.colour, shape.anchor, shape.bold)
    elif isinstance(shape, Disc):
        # Two discs, not an outline: Pillow's outlines are not smooth at odd widths.
        rim = shape.width / 2 if shape.stroke else 0.0
        if shape.stroke:
            _disc(draw, shape.x, shape.y, shape.radius + rim, shape.stroke, scale)
        _disc(draw, shape.x, shape.y, shape.radius - rim, shape.fill, scale)
    elif isinstance(shape, Line):
        _line(draw, shape.points, shape.stroke, shape.width, shape.square, scale)
    elif isinstance(shape, Area):
        if shape.fill:
            draw.polygon([(x * scale, y * scale) for x, y in shape.points], shape.fill)
        if shape.stroke:
            closed = (*shape.points, shape.points[0])
            _line(draw, closed, shape.stroke, shape.width, False, scale)


def _disc(
    draw: ImageDraw.ImageDraw, x: float, y: float, radius: float, fill: str, scale: int
) -> None:
    if radius > 0:
        draw.ellipse(
            (
                (x - radius) * scale,
                (y - radius) * scale,
                (x + radius) * scale,
                (y + radius) * scale,
            ),
            fill,
        )


def _line(
    draw: ImageDraw.ImageDraw,
    points: Sequence[Spot],
    stroke: str,
    width: float,
    square: bool,
    scale: int,
) -> None:
    """Each piece is a rectangle; at the corners there are discs, or the ends reach further."""
    half = width / 2
    for (x1, y1), (x2, y2) in itertools.pairwise(points):
        length = math.hypot(x2 - x1, y2 - y1)
        if length == 0:
            continue
        u, v = (x2 - x1) / length * half, (y2 - y1) / length * half
        if square:
            x1, y1, x2, y2 = x1 - u, y1 - v, x2 + u, y2 + v
        corners = ((x1 - v, y1 + u), (x2 - v, y2 + u), (x2 + v, y2 - u), (x1 + v, y1 - u))
        draw.polygon([(x * scale, y * scale) for x, y in corners], stroke)
    if not square and width * scale > 2:
        for x, y in points:
            _disc(draw, x, y, half, stroke, scale)
