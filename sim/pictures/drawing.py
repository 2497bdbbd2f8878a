"""Pictures of floors and runs: SVG text, PNG files, and moving pictures.

    from sim.pictures.drawing import animate, floor_svg, png, svg
    svg(world, simulation.record)                    # text
    png(world, simulation.record, "run.png")
    animate(world, simulation.record, "run.webp")    # or .gif, .png (animated)

All are drawn from the same scenes (`sim.pictures.scene`), with no font or program but Pillow.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from sim.pictures.animation import animate
from sim.pictures.floor import draw_floor
from sim.pictures.png import to_image
from sim.pictures.run import draw_run, draw_way, summary
from sim.pictures.svg import to_svg
from sim.record import Record, Sample
from sim.world.model import World

__all__ = ["animate", "floor_svg", "png", "svg", "way_svg"]


def floor_svg(world: World, people: bool = True, language: str = "en") -> str:
    """The floor as SVG, to be shown alone or with live drawings on top (see
    `sim.pictures.svg.to_svg`), for which `people=False` leaves out the people. Places and things
    go by their names in that language."""
    floor = draw_floor(world, None if people else [], language=language)
    return to_svg(floor.scene, floor.frame, world.name)


def svg(world: World, record: Record) -> str:
    """A run on its floor as SVG."""
    scene, frame = draw_run(world, record)
    return to_svg(scene, frame, summary(record, world.name))


def way_svg(world: World, path: Sequence[tuple[float, float]]) -> str:
    """A way that was not driven yet on its floor, as SVG; points in metres."""
    samples: list[Sample] = []
    theta = 0.0
    for at, (x, y) in enumerate(path):
        if at + 1 < len(path):
            theta = math.degrees(math.atan2(path[at + 1][1] - y, path[at + 1][0] - x))
        samples.append(Sample(float(at), x, y, theta))
    scene, frame = draw_way(world, Record(world=world.name, samples=samples))
    return to_svg(scene, frame, world.name)


def png(world: World, record: Record | None, path: str | Path) -> None:
    """Write a run on its floor, or without a record the floor alone, as a PNG file.

    Raises `OSError` if the file cannot be written.
    """
    scene = draw_floor(world).scene if record is None else draw_run(world, record)[0]
    to_image(scene).save(path, "PNG", optimize=True)
