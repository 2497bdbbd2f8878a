"""Scenes as SVG text."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from sim.pictures.scene import Area, Disc, Frame, Line, Scene, Shape, Spot, Text
from sim.pictures.text import text_width

_FONTS = "Aileron, 'Helvetica Neue', Helvetica, Arial, 'DejaVu Sans', sans-serif"


def to_svg(scene: Scene, frame: Frame, title: str) -> str:
    """The scene as one `<svg>` element.

    Its last group, `id="live"`, is empty and counts in the world's metres with y up, so that a web
    page can draw the robot there: `<circle cx="2.5" cy="7" r="0.25"/>`. For what must be placed in
    pixels, `data-scale`, `data-left` and `data-top` say where the world lies.
    """
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_n(scene.width)} '
        f'{_n(scene.height)}" width="{_n(scene.width)}" height="{_n(scene.height)}" '
        f'font-family="{_FONTS}" data-scale="{_n(frame.scale)}" data-left="{_n(frame.left)}" '
        f'data-top="{_n(frame.top)}">',
        f"<title>{_escape(title)}</title>",
        f'<rect width="100%" height="100%" fill="{scene.background}"/>',
    ]
    for name, shapes in scene.layers.items():
        lines.append(f'<g class="{escape(name)}">')
        lines += [_element(shape) for shape in shapes]
        lines.append("</g>")
    lines.append(
        f'<g id="live" transform="matrix({_n(frame.scale)} 0 0 {_n(-frame.scale)} '
        f'{_n(frame.left)} {_n(frame.top)})"></g>'
    )
    lines.append("</svg>")
    return "\n".join(lines) + "\n"


def _element(shape: Shape) -> str:
    if isinstance(shape, Text):
        weight = ' font-weight="bold"' if shape.bold else ""
        # The length as measured here, whatever font the viewer has: no label is cut or covered.
        return (
            f'<text x="{_n(shape.x)}" y="{_n(shape.y)}" font-size="{_n(shape.size)}" '
            f'fill="{shape.colour}" text-anchor="{shape.anchor}"{weight} '
            f'textLength="{_n(text_width(shape.text, shape.size))}" '
            f'lengthAdjust="spacingAndGlyphs">{_escape(shape.text)}</text>'
        )
    if isinstance(shape, Line):
        ends = "square" if shape.square else "round"
        join = "miter" if shape.square else "round"
        return (
            f'<polyline points="{_points(shape.points)}" fill="none" stroke="{shape.stroke}" '
            f'stroke-width="{_n(shape.width)}" stroke-linecap="{ends}" stroke-linejoin="{join}"/>'
        )
    paint = f'fill="{shape.fill or "none"}"'
    if shape.stroke:
        paint += f' stroke="{shape.stroke}" stroke-width="{_n(shape.width)}"'
    if isinstance(shape, Disc):
        start = f'<circle cx="{_n(shape.x)}" cy="{_n(shape.y)}" r="{_n(shape.radius)}" {paint}'
        return _noted(start, "circle", shape.note)
    assert isinstance(shape, Area)
    return _noted(f'<polygon points="{_points(shape.points)}" {paint}', "polygon", shape.note)


def _noted(start: str, tag: str, note: str) -> str:
    return f"{start}><title>{_escape(note)}</title></{tag}>" if note else f"{start}/>"


def _points(points: Iterable[Spot]) -> str:
    return " ".join(f"{_n(x)},{_n(y)}" for x, y in points)


def _n(number: float) -> str:
    return f"{round(number, 2):g}" if abs(number) < 1e5 else f"{number:.0f}"


def _escape(text: str) -> str:
    """For XML, which holds no control characters, not even escaped."""
    return escape("".join(c if c.isprintable() else " " for c in text))
