"""Pictures of floors and runs: SVG text, PNG files, and moving pictures.

    from sim.pictures import animate, floor_svg, png, svg
    svg(world, simulation.record)                    # text
    png(world, simulation.record, "run.png")
    animate(world, simulation.record, "run.webp")    # or .gif, .png (animated)

All are drawn from the same scenes (`sim.pictures_scene`), with no font or program but Pillow.
"""

from __future__ import annotations

from pathlib import Path

from sim.pictures_animation import animate
from sim.pictures_floor import draw_floor
from sim.pictures_png import to_image
from sim.pictures_run import draw_run, summary
from sim.pictures_svg import to_svg
from sim.record import Record
from sim.world import World

__all__ = ["animate", "floor_svg", "png", "svg"]


def floor_svg(world: World, people: bool = True) -> str:
    """The floor as SVG, to be shown alone or with live drawings on top (see
    `sim.pictures_svg.to_svg`), for which `people=False` leaves out the people."""
    floor = draw_floor(world, None if people else [])
    return to_svg(floor.scene, floor.frame, world.name)


def svg(world: World, record: Record) -> str:
    """A run on its floor as SVG."""
    scene, frame = draw_run(world, record)
    return to_svg(scene, frame, summary(record, world.name))


def png(world: World, record: Record | None, path: str | Path) -> None:
    """Write a run on its floor, or without a record the floor alone, as a PNG file.

    Raises `OSError` if the file cannot be written.
    """
    scene = draw_floor(world).scene if record is None else draw_run(world, record)[0]
    to_image(scene).save(path, "PNG", optimize=True)
