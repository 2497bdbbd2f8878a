"""Files that are nearly right: worlds, maps, robot files and routines.

Each is made out of what the project ships, changed as data, as a text, or as bytes.
"""

from __future__ import annotations

import functools
import io
import json
import random
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import msgspec
import yaml

from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from nl2robot.translate.routine_files import exported, read
from robot_api.robots.reading import read_robot_file
from robot_api.robots.registry import RobotKind, known
from sim.errors import SimError
from sim.simulation import Simulation
from sim.world.builtin import BUILTIN
from sim.world.loading import load_world
from sim.world.map_image import ImageError
from sim.world.model import World
from sim.world.reader import _Reader
from sim.world.yaml_nodes import FileProblems
from tests.attacks.inputs import (
    LANGUAGES,
    Case,
    Target,
    Unfit,
    file,
    folder,
    is_chosen,
    problems,
    sentence,
)
from tests.attacks.mutations import WORDS, bytes_like, data_like, odd, text_like, thinned


def _yaml(chance: random.Random, trees: Sequence[Any], names: Sequence[str]) -> str | bytes:
    """Of one of these a part, changed as data, as a text or as bytes."""
    tree = thinned(chance, chance.choice(trees), 5)
    way = chance.random()
    if way < 0.55:
        tree = data_like(chance, tree, names)
    # JSON is YAML, and written fast; but all of its texts are in quotes.
    text = json.dumps(tree, ensure_ascii=False) if chance.random() < 0.6 else _dumped(tree)
    if way < 0.55:
        return text
    if way < 0.8:
        return text_like(chance, [text], [*WORDS, *names])
    return bytes_like(chance, [text.encode("utf-8", "replace")])


def _dumped(tree: Any) -> str:
    return str(yaml.dump(tree, Dumper=yaml.CSafeDumper, allow_unicode=True, sort_keys=False))


def _tree(path: Path) -> Any:
    return yaml.load(path.read_text("utf-8"), Loader=yaml.CSafeLoader)


@functools.cache
def _worlds() -> tuple[list[Any], list[str]]:
    trees = [_tree(each) for each in sorted(BUILTIN.glob("*.yaml"))]
    return trees, sorted({word for fields in _Reader.FIELDS.values() for word in fields.split()})


def _make_world(chance: random.Random) -> Case:
    return Case(_yaml(chance, *_worlds()))


def _feed_world(case: Case) -> None:
    try:
        world = load_world(file("world.yaml", case.data), names_only=is_chosen(case, 5))
    except FileProblems as error:
        problems(error)
        return
    _use(world)
    if is_chosen(case):
        _drive_in(world)


def _use(world: World) -> None:
    """What everybody asks of a world that was read."""
    world.place_at(0, 0)
    _ = world.bounds, world.start, world.charger, world.keep_out
    for language in LANGUAGES:
        Knowledge(world).lexicon(language)


def _drive_in(world: World) -> None:
    try:
        Simulation(world)
    except SimError as error:
        sentence(str(error))


# --- maps ----------------------------------------------------------------------------------------

_MAP: Final = {
    "image": "floor.pgm",
    "resolution": 0.05,
    "origin": [-1.0, -2.0, 0.1],
    "negate": 0,
    "occupied_thresh": 0.65,
    "free_thresh": 0.196,
    "mode": "trinary",
}


@functools.cache
def _images() -> dict[str, bytes]:
    """Small maps of every kind that is read."""
    from PIL import Image

    picture = Image.frombytes(
        "L", (24, 16), bytes((254 if 3 < i % 24 < 20 else 0) for i in range(384))
    )
    made = {}
    for name, mode, options in (
        ("floor.pgm", "L", {}),
        ("floor.png", "L", {}),
        ("rgba.png", "RGBA", {}),
        ("palette.png", "P", {}),
        ("bit.png", "1", {}),
        ("deep.png", "I;16", {}),
        ("floor.bmp", "RGB", {}),
        ("floor.jpg", "L", {"quality": 30}),
    ):
        held = io.BytesIO()
        kind = {"pgm": "PPM", "jpg": "JPEG"}.get(name[-3:], name[-3:].upper())
        changed = picture.convert("I").convert(mode) if mode == "I;16" else picture.convert(mode)
        changed.save(held, kind, **options)
        made[name] = held.getvalue()
    made["plain.pgm"] = b"P2\n# by hand\n4 3 15\n" + b"15 0 15 15\n" * 3
    made["deep.pgm"] = b"P5 4 3 65535\n" + b"\xff\xfe" * 12
    return made


@functools.cache
def _mapfolder() -> Path:
    for name, data in _images().items():
        file(name, data)
    return folder()


def _make_map(chance: random.Random) -> Case:
    tree = {**_MAP, "image": chance.choice([*_images(), "lost.pgm", "/dev/zero", "."])}
    names = [*_MAP, "map", "name", "places"]
    if chance.random() < 0.3:
        tree = {"name": "x", "map": tree, "places": [{"name": "hall", "pose": [0, 0]}]}
    return Case(_yaml(chance, [tree], names))


def _feed_map(case: Case) -> None:
    _mapfolder()
    _read_map(file("map.yaml", case.data), is_chosen(case))


def _make_image(chance: random.Random) -> Case:
    name = chance.choice(list(_images()))
    return Case(
        bytes_like(chance, [_images()[name], *_images().values()][: chance.choice((1, 99))])
    )


def _feed_image(case: Case) -> None:
    file("any.pgm", case.data)
    map_file = folder() / "image.yaml"
    if not map_file.exists():
        map_file.write_text(_dumped({**_MAP, "image": "any.pgm"}), "utf-8")
    _read_map(map_file, is_chosen(case, 4))


def _read_map(path: Path, uses: bool) -> None:
    try:
        world = load_world(path)
        _ = world.bounds
        if uses:
            _ = world.walls, world.start
            _drive_in(world)
    except FileProblems as error:
        problems(error)
    except ImageError as error:  # a PGM whose head promises more than is behind it
        sentence(str(error))


# --- robots and routines -------------------------------------------------------------------------

_ROBOT: Final = {
    "name": "The porter",
    "limits": {"speed": 0.5, "acceleration": 0.5, "turn_rate": 45, "volume": 80},
    "joints": {"head": [-40, 40], "arm": [-10.5, 90]},
    "speech": "robot",
    "hearing": "server",
    "gestures": {"wave": "animations/Stand/Gestures/Hey_1"},
    "emotions": {"happy": "smile"},
    "skills": {"sit": "sits down"},
}


@functools.cache
def _kinds() -> dict[str, RobotKind]:
    return dict(known().kinds)


@functools.cache
def _sections() -> dict[str, list[str]]:
    """By kind the fields of the section of its wire."""
    return {
        name: [each.encode_name for each in msgspec.structs.fields(kind.settings)]
        if kind.settings is not None
        else []
        for name, kind in _kinds().items()
    }


def _make_robot(chance: random.Random) -> Case:
    name = chance.choice(list(_kinds()))
    fields, kind = _sections()[name], _kinds()[name]
    tree: dict[str, Any] = dict(_ROBOT)
    if kind.section and fields:
        chosen = chance.sample(fields, min(len(fields), chance.randint(0, 4)))
        tree[kind.section] = {
            each: chance.choice(
                ("/cmd_vel", 1, True, [], {}, {"velocity": "/cmd_vel"}, odd(chance))
            )
            for each in chosen
        }
    return Case(_yaml(chance, [tree], [*_ROBOT, *fields, kind.section or "ros"]), name)


def _feed_robot(case: Case) -> None:
    try:
        read_robot_file(file("robot.yaml", case.data), _kinds()[case.how])
    except FileProblems as error:
        problems(error)


_ROUTINES: Final = {
    "nl2robot-routines": 1,
    "routines": [
        {
            "name": "evening round",
            "sentence": "go to every ward and say good night",
            "language": "en",
        },
        {"name": "Teerunde", "sentence": "geh in jedes Zimmer und sag guten Tag", "language": "de"},
        {"name": "tea", "program": 'robot.goto("lobby")\nrobot.say("Tea!")\n', "language": "fr"},
    ],
}


def _make_routines(chance: random.Random) -> Case:
    data = _yaml(chance, [_ROUTINES], ["name", "sentence", "program", "language", "routines"])
    # It comes in over the wire, as a text.
    return Case(data.decode("utf-8", "replace") if isinstance(data, bytes) else data)


def _feed_routines(case: Case) -> None:
    assert isinstance(case.data, str)
    try:
        found = read(case.data, "routines.yaml")
    except UserError as error:
        for line in str(error).splitlines():
            sentence(line)
        return
    again = read(exported(each.routine for each in found), "again.yaml")
    if len(again) != len(found):
        raise Unfit("what was read is not read again once it is exported")


FILES: Final = (
    Target("worlds", _make_world, _feed_world, 70_000),
    Target("maps", _make_map, _feed_map, 50_000),
    Target("images of maps", _make_image, _feed_image, 50_000),
    Target("robot files", _make_robot, _feed_robot, 50_000),
    Target("routines", _make_routines, _feed_routines, 50_000),
)
