"""Text in pictures: how long it is, how it wraps, and its drawing with no font but Pillow's own.

That font knows no accented letters. They are put together here, from the letter and an accent drawn
above it (or below), so that English, German and French look the same on every machine; other
scripts appear as they should in SVG only.
"""

from __future__ import annotations

import functools
import unicodedata
from bisect import bisect_right

from PIL import ImageDraw, ImageFont

_SPELLED = str.maketrans(
    {
        "ß": "ss", "œ": "oe", "Œ": "OE", "æ": "ae", "Æ": "AE", "ø": "o", "Ø": "O", "ł": "l",
        "–": "-", "—": "-", "−": "-", "„": '"', "‚": "'", "→": "->", "€": "EUR", "×": "x",
        "\u00a0": " ", "\u202f": " ",
    }
)  # fmt: skip
# Strokes of accents in thousandths of the letter size: x from the letter's middle, y up from its
# top; a single point is a dot.
_ACCENTS: dict[str, tuple[tuple[tuple[int, int], ...], ...]] = {
    "\u0300": (((-90, 190), (40, 70)),),
    "\u0301": (((90, 190), (-40, 70)),),
    "\u0302": (((-110, 70), (0, 180), (110, 70)),),
    "\u0303": (((-120, 80), (-50, 140), (50, 90), (120, 150)),),
    "\u0308": (((-90, 120),), ((90, 120),)),
    "\u030a": (((0, 70), (60, 130), (0, 190), (-60, 130), (0, 70)),),
    "\u030c": (((-110, 180), (0, 70), (110, 180)),),
}
_CEDILLA = "\u0327"


@functools.lru_cache(maxsize=64)
def _font(size: float) -> ImageFont.FreeTypeFont:
    font = ImageFont.load_default(size)
    if not isinstance(font, ImageFont.FreeTypeFont):
        raise RuntimeError("Pillow was built without FreeType. Install Pillow from PyPI.")
    return font


def _spelled(text: str) -> tuple[str, list[tuple[int, str]]]:
    """Letters that the font has, and accents with the number of the letter they belong to."""
    letters, accents = "", []
    for character in unicodedata.normalize("NFD", text.translate(_SPELLED)):
        if not unicodedata.combining(character):
            letters += character
        elif letters:
            accents.append((len(letters) - 1, character))
    return letters, accents


def text_width(text: str, size: float) -> float:
    """How many pixels wide the text is at this letter size."""
    # Measured large and scaled, so that the width is the same share of the size at any size.
    return float(_font(100).getlength(_spelled(text)[0])) * size / 100


def wrapped(text: str, size: float, width: float, most: int) -> list[str]:
    """The text in lines no wider than `width`; what is more than `most` lines ends in "..."."""
    lines: list[str] = []
    line = ""
    for word in text.split():
        for piece in _broken(word, size, width):
            longer = f"{line} {piece}" if line else piece
            if line and text_width(longer, size) > width:
                lines.append(line)
                longer = piece
            line = longer
    if line:
        lines.append(line)
    if len(lines) > most:
        lines = lines[:most]
        lines[-1] = shortened(lines[-1] + " ...", size, width)
    return lines


def shortened(text: str, size: float, width: float) -> str:
    """The text, cut with "..." if it is wider than `width`."""
    if text_width(text, size) <= width:
        return text
    text = text.removesuffix("...").rstrip()
    while text and text_width(text + "...", size) > width:
        text = text[:-1].rstrip()
    return text + "..."


def _broken(word: str, size: float, width: float) -> list[str]:
    """A word in pieces that fit, mostly one."""
    pieces = []
    while text_width(word, size) > width and len(word) > 1:
        # Letters differ in width: as many as fit, not as many as would on average.
        wider = bisect_right(range(len(word)), width, key=lambda n: text_width(word[:n], size))
        fits = max(1, wider - 1)
        pieces.append(word[:fits])
        word = word[fits:]
    return [*pieces, word]


def draw_text(
    draw: ImageDraw.ImageDraw,
    at: tuple[float, float],
    text: str,
    size: float,
    colour: str,
    anchor: str = "start",
    bold: bool = False,
) -> None:
    """Draw one line of text with its base line at `at`."""
    font = _font(size)
    letters, accents = _spelled(text)
    x, y = at
    x -= {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor] * text_width(text, size)
    weight = round(size * 0.02) if bold else 0
    draw.text((x, y), letters, colour, font, "ls", stroke_width=weight, stroke_fill=colour)
    pen = max(1, round(size * (0.1 if bold else 0.075)))
    for number, accent in accents:
        before = font.getlength(letters[:number])
        middle = x + before + font.getlength(letters[number]) / 2
        if accent == _CEDILLA:
            draw.text((middle, y + size * 0.06), ",", colour, font, "ms")
        top = y + font.getbbox(letters[number], anchor="ls")[1]
        for stroke in _ACCENTS.get(accent, ()):
            points = [(middle + u * size / 1000, top - v * size / 1000) for u, v in stroke]
            if len(points) > 1:
                draw.line(points, colour, pen, "curve")
            else:
                radius = pen * 0.7
                (u, v) = points[0]
                draw.ellipse((u - radius, v - radius, u + radius, v + radius), colour)
