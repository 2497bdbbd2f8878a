"""Reads a world's YAML and reports everything that is wrong with it, line by line.

The text is composed into YAML nodes, which know their lines; `_Reader` walks them by the fields
that a world has, so nothing in a file can make it build more than a world. Names are taken as they
are written (`yes`, `12:30` and `0042` stay what they look like). What refers to something else is
checked in the end, when all names are known.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar, TypeVar
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

from sim.world import geometry as g
from sim.world import model as w
from sim.world.checks import Entries, check_zones, cut_doors, kind_of, settle
from sim.world.fields import MAX_TEXT, compose
from sim.world.geometry import Point, Segment
from sim.world.map_reader import MapReader, is_ros_map
from sim.world.masks import MaskError, masked_areas
from sim.world.model import Place, World, WorldError
from sim.world.starts import starting
from sim.world.yaml_nodes import Hopeless, MappingNode, Node, ScalarNode, short
from sim.world.zones import trouble_with

MAX_WALLS = 20_000
UNITS = {"m": 1.0, "cm": 0.01}

_T = TypeVar("_T")


def read_world(path: Path, names_only: bool = False) -> World:
    """The world in this file. Raises `WorldError` with all problems; with `names_only`, those that
    matter only to a robot which is to drive there are passed over."""
    reader = _Reader(str(path), names_only)
    try:
        root = compose(path)
        world = reader.ros_map(root, path) if is_ros_map(root) else reader.world(root, path)
    except Hopeless as problem:
        reader.problems.append(problem.problem)
        raise WorldError(reader.file, reader.problems) from None
    if reader.problems:
        raise WorldError(reader.file, reader.problems)
    return world


class _Reader(MapReader):
    """Reads nodes into structs; what it cannot read becomes a problem, and it reads on."""

    FIELDS: ClassVar = {
        "a world": (
            "name units scale clock map walls wall_thickness robot places people objects furniture "
            "doors contacts questions zones keep_out"
        ),
        **MapReader.FIELDS,
        "the robot": "name start radius battery",
        "the clock": "start zone",
        "a place": "name kind pose area in aliases",
        "a person": "name kind at pose is answers gender walks aliases",
        "an object": "name kind at on pose is code size weight aliases",
        "a piece of furniture": "name kind at pose size aliases",
        "a door": "name at from to open",
        "a contact": "name kind aliases",
        "a question": "ask answer",
        "a zone": "name polygon",
    }

    # --- entries

    def entries(
        self, fields: dict[str, Node], name: str, read: Callable[[Node], _T | None]
    ) -> list[tuple[int, _T]]:
        """Each entry of the list of this name with its line; those that cannot be read are left
        out."""
        if name not in fields:
            return []
        read_entries = [(node.line, read(node)) for node in self.items(fields[name], f'"{name}"')]
        return [(line, entry) for line, entry in read_entries if entry is not None]

    def name(self, fields: dict[str, Node], node: Node, what: str) -> str | None:
        if "name" in fields:
            return self.text(fields["name"], f"The name of {what}")
        if isinstance(node, MappingNode):
            self.problem(node.line, f"{what.capitalize()} has no name. Give it one.")
        return None

    def _common(self, fields: dict[str, Node], what: str) -> dict[str, Any]:
        """The fields that mean the same for everything."""
        values: dict[str, Any] = {}
        for field in ("kind", "at", "on", "gender", "code", "in"):
            if field in fields:
                values[field] = self.text(fields[field], f'"{field}" of {what}')
        for field in ("is", "walks"):
            if field in fields:
                values[field] = self.texts(fields[field], f'"{field}" of {what}')
        if "pose" in fields:
            values["pose"] = self.pose(fields["pose"], f"The pose of {what}")
        if "aliases" in fields:
            values["aliases"] = self.languages(fields["aliases"], f"The aliases of {what}")
        for field, attribute in (("is", "is_"), ("in", "inside")):
            if field in values:
                values[attribute] = values.pop(field)
        return {field: value for field, value in values.items() if value is not None}

    def place(self, node: Node) -> Place | None:
        fields = self.mapping(node, "a place")
        name = self.name(fields, node, "a place")
        what = f'"{name}"'
        values = self._common(fields, what)
        if "area" in fields:
            values["area"] = self.polygon(fields["area"], f"The area of {what}")
        if name is None:
            return None
        return Place(**{"name": name, "kind": kind_of(name), **values})

    def person(self, node: Node) -> w.Person | None:
        fields = self.mapping(node, "a person")
        name = self.name(fields, node, "a person")
        values = self._common(fields, f'"{name}"')
        if "answers" in fields:
            values["answers"] = self.texts(fields["answers"], f'The answers of "{name}"', MAX_TEXT)
        return None if name is None else w.Person(name=name, **values)

    def thing(self, node: Node) -> w.Thing | None:
        fields = self.mapping(node, "an object")
        name = self.name(fields, node, "an object")
        values = self._common(fields, f'"{name}"')
        if "size" in fields:
            values["size"] = self.size(fields["size"], f'The size of "{name}"', 3)
        if "weight" in fields:
            values["weight"] = self.number(fields["weight"], f'The weight of "{name}"', 0, 10_000)
        if name is None:
            return None
        return w.Thing(**{"name": name, "kind": kind_of(name), **values})

    def piece(self, node: Node) -> w.Furniture | None:
        fields = self.mapping(node, "a piece of furniture")
        name = self.name(fields, node, "a piece of furniture")
        values = self._common(fields, f'"{name}"')
        if "size" in fields and (size := self.size(fields["size"], f'The size of "{name}"', 2)):
            values["size"] = size
        if name is None:
            return None
        return w.Furniture(**{"name": name, "kind": kind_of(name), **values})

    def door(self, node: Node) -> w.Door | None:
        fields = self.mapping(node, "a door")
        values: dict[str, Any] = self._common(fields, "a door")
        if "name" in fields:
            values["name"] = self.text(fields["name"], "The name of a door")
        if "open" in fields:
            values["open"] = self.truth(fields["open"], '"open" of a door') is not False
        ends: list[Point] = []
        for end in ("from", "to"):
            if end not in fields:
                if isinstance(node, MappingNode):
                    self.problem(
                        node.line,
                        f'A door has no "{end}". Give both ends of the opening: '
                        "from: [x, y], to: [x, y].",
                    )
            elif pair := self.numbers(fields[end], f'"{end}" of a door', "[x, y]", (2,)):
                point = self.point(pair, f'"{end}" of a door')
                ends += [point] if point else []
        if len(ends) < 2:
            return None
        return w.Door(ends=(*ends[0], *ends[1]), **values)

    def contact(self, node: Node) -> w.Contact | None:
        if isinstance(node, ScalarNode):
            name = self.text(node, "A contact")
            return w.Contact(name=name) if name else None
        fields = self.mapping(node, "a contact")
        name = self.name(fields, node, "a contact")
        values = self._common(fields, f'"{name}"')
        return None if name is None else w.Contact(name=name, **values)

    def question(self, node: Node) -> w.Question | None:
        fields = self.mapping(node, "a question")
        if isinstance(node, MappingNode):
            for field in ("ask", "answer"):
                if field not in fields:
                    self.problem(
                        node.line,
                        f'A question has no "{field}". It needs "ask" and "answer".',
                    )
        if not {"ask", "answer"} <= set(fields):
            return None
        ask = self.languages(fields["ask"], "A question", MAX_TEXT)
        answers = self.languages(fields["answer"], "An answer", MAX_TEXT)
        return w.Question(ask=ask, answer={code: texts[0] for code, texts in answers.items()})

    def zone(self, node: Node) -> w.Zone | None:
        fields = self.mapping(node, "a zone")
        name = self.name(fields, node, "a zone")
        if "polygon" not in fields:
            if isinstance(node, MappingNode):
                self.problem(
                    node.line,
                    f'The zone "{name}" has no "polygon". Give its corners: '
                    "polygon: [[x, y], [x, y], [x, y], ...].",
                )
            return None
        polygon = self.zone_polygon(fields["polygon"], f'The polygon of the zone "{name}"')
        return None if name is None or not polygon else w.Zone(name, polygon)

    def zone_polygon(self, node: Node, what: str) -> g.Polygon:
        polygon = self.polygon(node, what)
        trouble = trouble_with(polygon) if polygon else None
        if trouble is None:
            return polygon
        self.problem(node.line, f"{what} {trouble}", floor=True)
        return ()

    def keep_out(self, node: Node, path: Path) -> list[tuple[int, w.Zone]]:
        """The zones without names: a list of outlines, or what is occupied in a mask, a map in the
        manner of ROS."""
        if isinstance(node, ScalarNode | MappingNode):
            outlines = [(node.line, outline) for outline in self._masked(node, path)]
        else:
            fields: dict[str, Node] = {"keep_out": node}
            outlines = self.entries(
                fields, "keep_out", lambda item: self.zone_polygon(item, '"keep_out"') or None
            )
        return [
            (line, w.Zone(f"area {number}", outline))
            for number, (line, outline) in enumerate(outlines, 1)
        ]

    def _masked(self, node: Node, path: Path) -> tuple[g.Polygon, ...]:
        mask = self.map(node, path, "keep-out mask")
        try:
            return masked_areas(mask) if mask is not None else ()
        except MaskError as error:
            self.problem(node.line, str(error))
            return ()

    def walls(self, node: Node) -> list[Segment]:
        """Each wall is a line through two or more points: [x1, y1, x2, y2, x3, y3, ...]."""
        segments: list[Segment] = []
        for item in self.items(node, '"walls"', MAX_WALLS):
            numbers = self.numbers(item, "A wall", "[x1, y1, x2, y2, ...]", range(4, 2001, 2))
            points = [
                self.point(pair, "a wall") for pair in zip(numbers[::2], numbers[1::2], strict=True)
            ]
            for one, two in itertools.pairwise(points):
                if one is not None and two is not None and one != two:
                    segments.append((*one, *two))
        return segments

    def robot(self, node: Node) -> w.Robot:
        fields = self.mapping(node, "the robot")
        values: dict[str, Any] = {}
        if "name" in fields:
            values["name"] = self.text(fields["name"], "The robot's name")
        if "start" in fields:
            start = fields["start"]
            if isinstance(start, ScalarNode):
                values["start"] = self.text(start, '"start" of the robot')
            else:
                values["start"] = self.pose(start, '"start" of the robot')
        if "radius" in fields:
            values["radius"] = self.length(fields["radius"], '"radius" of the robot', 0.05, 2)
        if "battery" in fields:
            values["battery"] = self.number(fields["battery"], '"battery" of the robot', 0, 100)
        return w.Robot(**{name: value for name, value in values.items() if value is not None})

    def clock(self, node: Node) -> w.Clock:
        fields = self.mapping(node, "the clock")
        start = daily = zone = None
        if "start" in fields:
            said = self.text(fields["start"], '"start" of the clock') or ""
            try:
                start, daily = starting(said)
            except ValueError as error:
                self.problem(fields["start"].line, f"{error}")
        if "zone" in fields:
            zone = self.text(fields["zone"], '"zone" of the clock')
            try:
                ZoneInfo(zone or "")
            except (ZoneInfoNotFoundError, ValueError, OSError):
                self.problem(
                    fields["zone"].line,
                    f'"{short(zone or "")}" is no time zone. Write one such as "Europe/Zurich".',
                )
                zone = None
        return w.Clock(start=start, daily=bool(daily), zone=zone)

    def ros_map(self, root: Node, path: Path) -> World:
        """A world that is nothing but a map."""
        return World(name=path.stem, map=self.map(root, path), file=str(path))

    # --- the whole

    def world(self, root: Node, path: Path) -> World:
        fields = self.mapping(root, "a world")
        name = self.text(fields["name"], "The name of the world") if "name" in fields else None
        units = self.text(fields["units"], '"units"') if "units" in fields else "m"
        if units is not None and units not in UNITS:
            self.problem(
                fields["units"].line,
                f'The unit "{short(units)}" is unknown.'
                ' Use "m" for metres or "cm" for centimetres.',
            )
        self.factor = UNITS.get(units or "m", 1.0)
        if "scale" in fields:
            self.factor *= self.number(fields["scale"], '"scale"', 1e-4, 1e4) or 1.0

        places = self.entries(fields, "places", self.place)
        people = self.entries(fields, "people", self.person)
        objects = self.entries(fields, "objects", self.thing)
        furniture = self.entries(fields, "furniture", self.piece)
        doors = self.entries(fields, "doors", self.door)
        contacts = self.entries(fields, "contacts", self.contact)
        questions = self.entries(fields, "questions", self.question)
        zones = self.entries(fields, "zones", self.zone)
        zones += self.keep_out(fields["keep_out"], path) if "keep_out" in fields else []
        walls = self.walls(fields["walls"]) if "walls" in fields else []
        thickness = (
            self.length(fields["wall_thickness"], '"wall_thickness"', 0.01, 2)
            if "wall_thickness" in fields
            else None
        )
        grid = self.map(fields["map"], path) if "map" in fields else None
        robot = self.robot(fields["robot"]) if "robot" in fields else w.Robot()

        clock = self.clock(fields["clock"]) if "clock" in fields else w.Clock()

        bare = World(
            name=name or path.stem,
            units=units if units in UNITS else "m",
            clock=clock,
            places=tuple(place for _, place in places),
            drawn_walls=cut_doors(walls, [door.ends for _, door in doors]),
            wall_thickness=thickness or 0.1,
            contacts=tuple(contact for _, contact in contacts),
            questions=tuple(question for _, question in questions),
            zones=tuple(zone for _, zone in zones),
            map=grid,
            file=str(path),
        )
        start_line = fields["robot"].line if "robot" in fields else 1
        entries = Entries(places, people, objects, furniture, doors, contacts, (start_line, robot))
        check_zones(self, zones)
        return settle(self, bare, walls, entries)
