"""Reads what worlds are made of from YAML nodes: lengths, poses, outlines, names by language."""

from __future__ import annotations

import re
from collections.abc import Sequence
from pathlib import Path

from sim.world.builtin import builtin_worlds
from sim.world.geometry import Point, Polygon, Pose, polygon_area
from sim.world.model import Aliases
from sim.world.yaml_nodes import (
    MAX_NAME,
    Hopeless,
    MappingNode,
    Node,
    ScalarNode,
    SequenceNode,
    Sort,
    did_you_mean,
    short,
)
from sim.world.yaml_nodes import NodeReader as PlainReader
from sim.world.yaml_nodes import compose as compose_file

MAX_TEXT = 2000
MAX_METRES = 1000.0

_WORLD = Sort(
    name="world",
    path="the path of a world's YAML file",
    least='A world has at least a "name" and "places".',
)
_LANGUAGE = re.compile(r"[a-z]{2}(-[A-Z]{2})?")


def compose(path: Path) -> Node:
    """The YAML of the file as nodes."""
    try:
        return compose_file(path, _WORLD)
    except FileNotFoundError:
        known = builtin_worlds()
        raise Hopeless(
            None,
            f"There is no such world.{did_you_mean(path.name, known)} "
            f"Give a file, or one of: {', '.join(known)}.",
        ) from None


class NodeReader(PlainReader):
    """Reads values of a world from nodes; what it cannot read becomes a problem, and it reads
    on."""

    def __init__(self, file: str, names_only: bool = False) -> None:
        super().__init__(file)
        self.names_only = names_only
        self.factor = 1.0
        """Metres for each unit of length in the file."""
        self.poses: list[tuple[int, str, Pose]] = []
        """Every pose that was read: its line, what it belongs to, itself."""

    def problem(self, line: int, message: str, *, floor: bool = False) -> None:
        """Note what is wrong. `floor`: it matters only to a robot that is to drive there, not to
        the names."""
        if not (floor and self.names_only):
            super().problem(line, message)

    def length(self, node: Node, what: str, low: float, high: float) -> float | None:
        """A length in the file's unit, in metres; the bounds are metres."""
        value = self.number(node, what, low / self.factor, high / self.factor)
        # Nine digits: 157 cm are 1.57 m, not 1.5700000000000001.
        return None if value is None else round(value * self.factor, 9)

    def point(self, pair: Sequence[Node], what: str) -> Point | None:
        x, y = pair
        first = self.length(x, f"{what}: x", -MAX_METRES, MAX_METRES)
        second = self.length(y, f"{what}: y", -MAX_METRES, MAX_METRES)
        return None if first is None or second is None else (first, second)

    def pose(self, node: Node, what: str) -> Pose | None:
        items = self.numbers(node, what, "[x, y] or [x, y, degrees]", (2, 3))
        if not items:
            return None
        point = self.point(items[:2], what)
        theta = self.number(items[2], f"{what}: the angle", -3600, 3600) if items[2:] else 0.0
        if point is None or theta is None:
            return None
        pose = Pose(*point, theta)
        self.poses.append((node.line, what, pose))
        return pose

    def polygon(self, node: Node, what: str) -> Polygon:
        """A rectangle [x1, y1, x2, y2], or a list of corners [x, y]."""
        expected = "a rectangle [x1, y1, x2, y2] or at least three corners [[x, y], ...]"
        items = self.items(node, what) if isinstance(node, SequenceNode) else []
        if len(items) == 4 and all(isinstance(item, ScalarNode) for item in items):
            one, two = self.point(items[:2], what), self.point(items[2:], what)
            if one is None or two is None:
                return ()
            (x1, y1), (x2, y2) = one, two
            polygon: Polygon = ((x1, y1), (x2, y1), (x2, y2), (x1, y2))
        elif len(items) >= 3 and all(isinstance(item, SequenceNode) for item in items):
            pairs = [self.numbers(item, f"A corner of {what}", "[x, y]", (2,)) for item in items]
            corners = [self.point(pair, what) for pair in pairs if pair]
            polygon = tuple(corner for corner in corners if corner is not None)
            if len(polygon) < len(items):
                return ()
        else:
            self.wrong(node, what, expected)
            return ()
        if polygon_area(polygon) < 1e-4:
            self.problem(node.line, f"{what} has no extent. It should be {expected}.")
            return ()
        return polygon

    def size(self, node: Node, what: str, dimensions: int) -> tuple[float, ...] | None:
        """So many lengths; one length alone stands for all."""
        items: list[Node] = [node] * dimensions
        if not isinstance(node, ScalarNode):
            items = self.numbers(node, what, f"{dimensions} lengths", (dimensions,))
        lengths = [self.length(item, what, 0.001, 100) for item in items]
        if not lengths or None in lengths:
            return None
        return tuple(length for length in lengths if length is not None)

    def languages(self, node: Node, what: str, longest: int = MAX_NAME) -> Aliases:
        """Texts by language: {en: [...], de: ...}; without a language they are English."""
        if not isinstance(node, MappingNode):
            texts = self.texts(node, what, longest)
            return {"en": texts} if texts else {}
        self.count(node)
        found: Aliases = {}
        for language, value in node.value:
            code = str(language.value)
            if not _LANGUAGE.fullmatch(code):
                self.problem(
                    language.line,
                    f'"{short(code)}" is no language code. Use two letters: en, de, fr, ...',
                )
                continue
            found[code] = found.get(code, ()) + self.texts(value, f"{what} ({code})", longest)
        return {code: texts for code, texts in found.items() if texts}
