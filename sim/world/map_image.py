"""The image of a map: how bright each pixel is, and whether it shows anything at all."""

from __future__ import annotations

import re
import warnings
from pathlib import Path, PureWindowsPath
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    from PIL.Image import Image

MAX_BYTES = 100_000_000
MAX_PIXELS = 8192
"""Of an image's width and height."""

_BINARY_PGM = re.compile(rb"P5\s(?:\s*#[^\n]*\n)*\s*(\d+)\s+(?:#[^\n]*\n\s*)*(\d+)\s+(\d+)\s")
_FORMATS = ("PPM", "PNG", "BMP", "JPEG")
"""What maps are kept in. Pillow knows more, whose values nobody here knows how to take."""


class ImageError(Exception):
    """The image of a map cannot be used; the message says why."""


class Picture(NamedTuple):
    """The pixels, from the top row down."""

    shades: npt.NDArray[np.unsignedinteger]
    white: int
    """What the brightest pixel there can be has; black has 0."""
    opaque: npt.NDArray[np.bool_] | None
    """Which pixels are not transparent, not even a little; None: all of them."""


def find_image(folder: Path, name: str) -> Path:
    """The image that a map's YAML in this folder names. A map that was copied from another machine
    names a place there: then it is what lies beside the YAML under that name."""
    named, beside = folder / name, folder / PureWindowsPath(name).name
    return beside if is_there(beside) and not is_there(named) else named


def is_there(path: Path) -> bool:
    """Whether there is anything; not for a name that no file can have, either."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def image_size(path: Path) -> tuple[int, int]:
    """Width and height of the image in pixels, once it is sure that it can be read.

    A binary PGM is judged by its head and length, without an imaging library, so that a world with
    a map loads as fast as one without. Raises `ImageError`.
    """
    try:
        if is_there(path) and not path.is_file():
            raise ImageError(f"The map's image {path.name} is no file. Give the path of the image.")
        length = path.stat().st_size
        with path.open("rb") as file:
            head = file.read(4096)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ImageError(
            f"The map's image {path.name} cannot be read: {reason}. Give its path, from the "
            "folder of this file, or put it into that folder."
        ) from None
    if length > MAX_BYTES:
        raise ImageError(f"The map's image {path.name} is too large. Scale it down.")
    match = _BINARY_PGM.match(head)
    if match is None:
        rows, columns = read_image(path).shades.shape
        return columns, rows
    width, height, most = (int(number) for number in match.groups())
    _check_size(path, width, height)
    if not 0 < most < 65536 or length < match.end() + width * height * (1 + (most > 255)):
        raise ImageError(f"The map's image {path.name} is cut short. Save it again.")
    return width, height


def read_image(path: Path) -> Picture:
    """The pixels of a PGM, a PNG or what else map_server reads. Raises `ImageError`."""
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            # It has more pixels than is looked at here, and nobody wants to read more of that.
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(path, formats=_FORMATS) as image:
                _check_size(path, *image.size)
                image.load()
                return _picture(image)
    except (UnidentifiedImageError, OSError, ValueError, SyntaxError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise ImageError(
            f"The map's image {path.name} is no PGM or PNG that can be read ({reason}). "
            "Save it again as PGM."
        ) from None
    except (Image.DecompressionBombError, Image.DecompressionBombWarning):
        raise ImageError(f"The map's image {path.name} is too large. Scale it down.") from None


def _check_size(path: Path, width: int, height: int) -> None:
    if not width or not height:
        raise ImageError(f"The map's image {path.name} has no pixels. Save it again.")
    if max(width, height) > MAX_PIXELS:
        raise ImageError(
            f"The map is {width} x {height} pixels, more than {MAX_PIXELS}. Scale it down."
        )


def _picture(image: Image) -> Picture:
    import numpy as np

    if image.mode == "F":
        raise ValueError("its pixels are no whole numbers")
    if image.mode.startswith("I"):  # 16 bits a pixel
        deep = np.asarray(image).astype(np.uint16)
        clear = image.info.get("transparency")
        return Picture(deep, 65_535, None if clear is None else deep != clear)
    opaque = None
    if image.has_transparency_data:
        image = image.convert("RGBA")
        opaque = np.asarray(image.getchannel("A")) == 255
    if image.mode == "L":
        return Picture(np.asarray(image), 255, opaque)
    # map_server averages the colours.
    colours = np.asarray(image.convert("RGB"), dtype=np.uint16)
    return Picture(colours.sum(axis=2, dtype=np.uint16), 3 * 255, opaque)
