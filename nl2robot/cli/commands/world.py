"""`nl2robot world`: begin a world from a map that a robot made, check one, and put into its file
what was drawn on its map."""

from __future__ import annotations

import argparse
import re
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from nl2robot.cli.options.values import words
from nl2robot.errors import ExitStatus, UserError
from nl2robot.paths import data_file
from nl2robot.station.drawn_zones import DrawnZones
from nl2robot.station.named_places import NamedPlaces, not_in
from nl2robot.station.world_file import beginning, exported, write_world
from robot_api.robots.address import BadAddress, parse
from sim.world.builtin import BUILTIN
from sim.world.fields import compose
from sim.world.loading import load_world
from sim.world.map_image import ImageError
from sim.world.map_reader import is_ros_map
from sim.world.map_saving import save_map
from sim.world.maps import free_cells
from sim.world.yaml_nodes import Hopeless

if TYPE_CHECKING:
    from sim.world.model import World


def add_arguments(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(dest="action", metavar="from-map|check|export", required=True)
    begin = actions.add_parser("from-map", help="begin a world from a map as ROS writes it")
    begin.add_argument(
        "map",
        type=words,
        metavar="MAP",
        help="the YAML that map_server wrote, or the address of a robot with ROS: ros2://HOST:9090",
    )
    begin.add_argument("--name", type=words, help="what the world is called (default: the map's)")
    begin.add_argument(
        "--keep-out",
        type=Path,
        metavar="MASK.yaml",
        help="a second map, whose occupied cells the robot keeps out of",
    )
    begin.add_argument(
        "--out", type=Path, metavar="FILE", help="the world's file (default: MAP-world.yaml)"
    )
    check = actions.add_parser("check", help="tell what a world has, and what is wrong with it")
    check.add_argument("world", metavar="WORLD", help="a built-in world's name or a YAML file")
    export = actions.add_parser(
        "export", help="put the places and zones that were drawn on its map into a world's file"
    )
    export.add_argument("world", metavar="WORLD", help="a built-in world's name or a YAML file")
    export.add_argument(
        "--out", type=Path, metavar="FILE", help="another file than the world's own"
    )
    for action in (begin, export):
        action.add_argument("--force", action="store_true", help="overwrite the file")


def run(options: argparse.Namespace) -> int:
    match options.action:
        case "from-map":
            return _from_map(options)
        case "export":
            return _export(options)
    return _check(options.world)


# --- from a map ----------------------------------------------------------------------------------


def _from_map(options: argparse.Namespace) -> int:
    fetched = "://" in options.map
    map_file = _file_for_fetched(options) if fetched else Path(options.map)
    out: Path = options.out or map_file.with_name(f"{_stem(map_file)}-world.yaml")
    if out.absolute() in (map_file.absolute(), (options.keep_out or map_file).absolute()):
        raise UserError(f"{out} is the map itself. Give the world another name with --out.")
    for file in (out, *((map_file,) if fetched else ())):
        _check_new(file, options.force)
    if fetched:
        _fetch(options.map, map_file)
    bare = _map_alone(map_file)
    if options.keep_out is not None:
        _map_alone(options.keep_out)
    if bare.start is None:
        raise UserError(
            f"The map {map_file} shows no free floor. Look at its image, at negate and at the"
            " thresholds."
        )
    name = options.name or _stem(map_file)
    text = beginning(map_file, out, name, options.keep_out, bare.start)
    _tell(write_world(text, out))
    print(f"""It is in {out}. Name its places next:
  nl2robot serve --world {out}
      On its page /map choose "Places", click where something is, and say what it is called.
  nl2robot world export {out}
      This puts the places that were named so into the file.""")
    return ExitStatus.OK


def _stem(map_file: Path) -> str:
    return map_file.stem.removesuffix("-map")


def _file_for_fetched(options: argparse.Namespace) -> Path:
    """Where a robot's map is kept: beside the world."""
    called = options.out.stem if options.out else options.name or "robot"
    name = re.sub(r"[^\w.-]+", "-", called).strip("-.") or "robot"
    return (options.out.parent if options.out else Path()) / f"{name}-map.yaml"


def _check_new(file: Path, force: bool) -> None:
    if file.exists() and not force:
        raise UserError(f"{file} is there already. Give another name, or --force to overwrite it.")


def _map_alone(file: Path) -> World:
    """The world that is nothing but this map. Raises `WorldError`, `UserError`."""
    if file.suffix.lower() in (".pgm", ".png", ".bmp"):
        raise UserError(f"{file} is an image. Give the YAML that map_server wrote beside it.")
    if not file.exists():
        raise UserError(f"There is no file {file}. Give the YAML that map_server wrote.")
    with suppress(Hopeless):  # the reader tells it in its own words
        if not is_ros_map(compose(file)):
            raise UserError(
                f"{file} is no map as ROS's map_server writes it, with image, resolution and"
                " origin. Give the YAML of a map."
            )
    return load_world(file)


def _fetch(address: str, map_file: Path) -> None:
    """Write the map of a robot with ROS. Raises `UserError`, `RobotError`."""
    try:
        robot = parse(address)
    except BadAddress as error:
        raise UserError(str(error)) from error
    if robot.scheme not in ("ros1", "ros2"):
        raise UserError(
            "Only a robot with ROS gives its map: ros2://HOST:9090 or ros1://HOST:9090. Of another"
            " give the files of a map."
        )
    try:
        fetch_map = import_module("robot_api.robots.ros.grid").fetch_map
    except ImportError as error:
        raise UserError(
            f"A robot with ROS cannot be reached: {error.name} is not installed."
            " pip install 'nl2robot[ros]' gets it.",
            ExitStatus.NO_ROBOT,
        ) from error
    grid = fetch_map(robot)
    try:
        save_map(
            map_file,
            width=grid.width,
            height=grid.height,
            resolution=grid.resolution,
            origin=(grid.origin.x, grid.origin.y, grid.origin.theta),
            cells=grid.cells,
        )
    except ImageError as error:
        raise UserError(str(error)) from error


# --- what a world has ----------------------------------------------------------------------------


def _check(name: str) -> int:
    """The exit status is 1 if the robot could not go to some place."""
    world = load_world(name)
    _tell(world)
    if not world.has_geometry:
        print("It has no geometry: sentences can be translated in it, but nothing driven.")
        return ExitStatus.OK
    from sim.simulation import Simulation
    from sim.spots import troubles_with_places

    Simulation(world).close()
    troubles = [f'"{place.name}" {why}.' for place, why in troubles_with_places(world)]
    print("\n".join(troubles) or "The robot can go to every place that has a pose.")
    return ExitStatus.FAILED if troubles else ExitStatus.OK


def _tell(world: World) -> None:
    """What the world has, in a line or two."""
    x1, y1, x2, y2 = world.bounds
    somewhere = sum(place.pose is not None for place in world.places)
    print(
        f"{world.name}: {x2 - x1:.1f} x {y2 - y1:.1f} m; places: {len(world.places)}, of which"
        f" {somewhere} have a pose; people: {len(world.people)}; objects: {len(world.objects)};"
        f" keep-out zones: {len(world.zones)}."
    )
    if world.map is not None:
        free = free_cells(world.map).sum() * world.map.resolution**2
        print(f"Its map shows {free:.1f} m² of free floor.")
    start = world.start
    if start is not None:
        print(f"The robot starts at {start.x:.2f}, {start.y:.2f}.")


# --- what was drawn ------------------------------------------------------------------------------


def _export(options: argparse.Namespace) -> int:
    world = load_world(options.world)
    kept_places, kept_zones = NamedPlaces(), DrawnZones(data_file("zones.yaml"))
    named, zones = tuple(not_in(world, kept_places.of(world))), kept_zones.of(world)
    if not named and not zones:
        print("Nothing was drawn on the map of this world: there is nothing to put into its file.")
        return ExitStatus.OK
    own = Path(world.file)
    out: Path = options.out or own
    if own.parent == BUILTIN and options.out is None:
        raise UserError(f"{world.name} comes with nl2robot. Give a file of your own with --out.")
    if out.absolute() != own.absolute():
        _check_new(out, options.force)
    write_world(exported(world, named, zones), out)
    if out.absolute() == own.absolute():  # the file has them now
        kept_places.keep(world, ())
        kept_zones.keep(world, ())
    print(f"In {out} now: places: {len(named)}, keep-out zones: {len(zones)}.")
    return ExitStatus.OK
