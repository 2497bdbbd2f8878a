"""Writes a map as ROS's map_saver does: a PGM, and the YAML beside it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from sim.world.geometry import FREE_THRESH, OCCUPIED_THRESH
from sim.world.map_image import MAX_PIXELS, ImageError

_FREE, _OCCUPIED, _UNKNOWN = 254, 0, 205
_FREE_TO, _OCCUPIED_FROM = 25, 65
"""Percent, as map_saver has them."""


def save_map(
    yaml: Path,
    *,
    width: int,
    height: int,
    resolution: float,
    origin: tuple[float, float, float],
    cells: Sequence[int],
) -> None:
    """Write the map with its image beside it. `cells` are those of ROS's OccupancyGrid, row by row
    from the lower left: -1 for unknown, else 0 to 100. `origin` is in metres and radians.

    The free_thresh is that of ROS 1, for the one of ROS 2 would make the unknown free. Raises
    `ImageError` if it is no map, `OSError` if it cannot be written.
    """
    import numpy as np

    if not 0 < width <= MAX_PIXELS or not 0 < height <= MAX_PIXELS:
        raise ImageError(
            f"The map has {width} x {height} cells; it can have {MAX_PIXELS} a side. Make a"
            " smaller one."
        )
    if len(cells) != width * height:
        raise ImageError(
            f"The map should have {width * height} cells, but {len(cells)} came. Ask for it again."
        )
    numbers = (resolution, *origin)
    if not np.isfinite(numbers).all() or resolution <= 0:
        raise ImageError("The map does not say where it lies or how large its cells are.")
    read = np.asarray(cells, np.int16).reshape(height, width)[::-1]
    grey = np.full(read.shape, _UNKNOWN, np.uint8)
    grey[(read >= 0) & (read <= _FREE_TO)] = _FREE
    grey[read >= _OCCUPIED_FROM] = _OCCUPIED
    image = yaml.with_suffix(".pgm")
    image.write_bytes(f"P5\n{width} {height}\n255\n".encode() + grey.tobytes())
    x, y, theta = (round(float(number), 9) for number in origin)
    yaml.write_text(
        f"image: {image.name}\n"
        "mode: trinary\n"
        f"resolution: {resolution:.9g}\n"
        f"origin: [{x}, {y}, {theta}]\n"
        "negate: 0\n"
        f"occupied_thresh: {OCCUPIED_THRESH}\n"
        f"free_thresh: {FREE_THRESH}\n",
        encoding="utf-8",
    )
