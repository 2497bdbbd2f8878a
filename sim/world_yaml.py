"""Reads YAML nodes, which know their lines, and reports what is not as it should be.

Names are taken as they are written: `yes`, `12:30` and `0042` stay what they look like. Whatever a
file repeats by anchors, and however deep it nests, only the fields asked for are read, and the
values are counted.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import yaml

from sim.world import Aliases, Point, Polygon, Pose, Problem, builtin_worlds, key, polygon_area

MAX_BYTES = 1_000_000
MAX_ENTRIES = 1000
"""Places, people, objects ... of each kind."""
MAX_VALUES = 200_000
"""Values in the file as a whole, counted as often as anchors repeat them."""
MAX_NAME = 200
MAX_TEXT = 2000
MAX_METRES = 1000.0
MAX_PROBLEMS = 50
MAX_DEPTH = 20
TOO_DEEP = "Lists are nested too deep here. Look for a bracket too many."

_LANGUAGE = re.compile(r"[a-z]{2}(-[A-Z]{2})?")
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_EMPTY = ("", "~", "null", "Null", "NULL")
_TAGS = {
    f"tag:yaml.org,2002:{kind}" for kind in ("str", "int", "float", "bool", "null", "seq", "map")
}


@dataclass(slots=True)
class ScalarNode:
    """A single value, as it is written."""

    line: int
    value: str
    empty: bool = False
    """Whether nothing is written there, or `null`."""


@dataclass(slots=True)
class SequenceNode:
    line: int
    value: list[Node] = field(default_factory=list)


@dataclass(slots=True)
class MappingNode:
    line: int
    value: list[tuple[Node, Node]] = field(default_factory=list)


Node = ScalarNode | SequenceNode | MappingNode


class Hopeless(Exception):
    """No sense in reading on."""

    def __init__(self, line: int | None, message: str) -> None:
        self.problem = Problem(line, printable(message))


def compose(path: Path) -> Node:
    """The YAML of the file as nodes."""
    try:
        if path.is_file() and path.stat().st_size > MAX_BYTES:
            raise Hopeless(
                None, f"The file is larger than {MAX_BYTES // 1000} kB. Is it really a world?"
            )
        text = path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        known = builtin_worlds()
        raise Hopeless(
            None,
            f"There is no such world.{did_you_mean(path.name, known)} "
            f"Give a file, or one of: {', '.join(known)}.",
        ) from None
    except UnicodeDecodeError as error:
        raise Hopeless(
            None, f"The file is no text in UTF-8 (byte {error.start}). Save it as UTF-8."
        ) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise Hopeless(
            None, f"The file cannot be read: {reason}. Give the path of a world's YAML file."
        ) from None
    try:
        root = _build(yaml.parse(text, Loader=_LOADER))
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        what = " ".join(part for part in (error.context, error.problem) if part)
        line = mark.line + 1 if mark else None
        if "nesting depth" in what:  # libyaml's own limit; it reads ahead of `_build`
            raise Hopeless(line, TOO_DEEP) from None
        raise Hopeless(
            line,
            f"This is not valid YAML: {what}. Look at the indentation, colons, quotes and "
            "brackets here and on the line before.",
        ) from None
    except yaml.YAMLError as error:
        what = str(error).splitlines()[0]
        raise Hopeless(None, f"This is not valid YAML: {what}. Correct the file.") from None
    if root is None:
        raise Hopeless(None, 'The file is empty. A world has at least a "name" and "places".')
    return root


def _build(events: Iterable[Any]) -> Node | None:
    """The document of the events as nodes; None if there is none.

    PyYAML's own composer calls itself for every level, and deep nesting makes it crash.
    """
    root: Node | None = None
    anchors: dict[str, Node] = {}
    # Around the present place, from the outermost: each list or mapping with what was read of it.
    around: list[tuple[Node, list[Node]]] = []
    for event in events:
        line = event.start_mark.line + 1
        if isinstance(event, yaml.NodeEvent):
            node = _node(event, line, anchors)
            if event.anchor is not None and not isinstance(event, yaml.AliasEvent):
                anchors[event.anchor] = node
            if isinstance(event, yaml.CollectionStartEvent):
                around.append((node, []))
                if len(around) > MAX_DEPTH:
                    raise Hopeless(line, TOO_DEEP)
                continue
        elif isinstance(event, yaml.CollectionEndEvent):
            node, items = around.pop()
            if isinstance(node, MappingNode):
                node.value = list(zip(items[::2], items[1::2], strict=True))
            elif isinstance(node, SequenceNode):
                node.value = items
        elif isinstance(event, yaml.DocumentStartEvent) and root is not None:
            raise Hopeless(line, "A second world begins here. Put it into a file of its own.")
        else:
            continue
        if around:
            around[-1][1].append(node)
        else:
            root = node
    return root


def _node(event: Any, line: int, anchors: Mapping[str, Node]) -> Node:
    """The node that begins with this event, lists and mappings still empty."""
    if isinstance(event, yaml.AliasEvent):
        if event.anchor not in anchors:
            raise Hopeless(
                line,
                f'"*{short(str(event.anchor))}" repeats what is named nowhere above. '
                "Write out what is meant, in quotes if it begins with a star.",
            )
        return anchors[str(event.anchor)]
    if event.tag is not None and event.tag not in _TAGS:
        raise Hopeless(line, f'"{short(event.tag)}" has no meaning here. Remove it.')
    if isinstance(event, yaml.ScalarEvent):
        return ScalarNode(line, event.value, event.implicit[0] and event.value in _EMPTY)
    return SequenceNode(line) if isinstance(event, yaml.SequenceStartEvent) else MappingNode(line)


def did_you_mean(word: str, known: Iterable[str]) -> str:
    import difflib

    table: dict[str, str] = {}
    for name in known:
        table.setdefault(key(name), name)
    close = difflib.get_close_matches(key(word), list(table), n=1, cutoff=0.6)
    return f' Did you mean "{table[close[0]]}"?' if close else ""


def printable(message: str) -> str:
    """One line that does nothing odd to a terminal, whatever was quoted from the file."""
    return "".join(c if c.isprintable() else "?" for c in message)


def short(text: str) -> str:
    return text if len(text) <= 40 else text[:37] + "..."


class NodeReader:
    """Reads values from nodes; what it cannot read becomes a problem, and it reads on."""

    FIELDS: ClassVar[Mapping[str, str]] = {}
    """The fields that each sort of entry may have, in one text."""

    def __init__(self, file: str, names_only: bool = False) -> None:
        self.file = file
        self.names_only = names_only
        self.problems: list[Problem] = []
        self.factor = 1.0
        """Metres for each unit of length in the file."""
        self.poses: list[tuple[int, str, Pose]] = []
        """Every pose that was read: its line, what it belongs to, itself."""
        self._values = 0

    # --- problems

    def problem(self, line: int, message: str, *, floor: bool = False) -> None:
        """Note what is wrong. `floor`: it matters only to a robot that is to drive there, not to
        the names."""
        if floor and self.names_only:
            return
        self.problems.append(Problem(line, printable(message)))
        if len(self.problems) >= MAX_PROBLEMS:
            raise Hopeless(None, "There are more problems than these. Correct these first.")

    def wrong(self, node: Node, what: str, expected: str) -> None:
        if isinstance(node, ScalarNode):
            found = f'"{short(str(node.value))}"' if node.value else "nothing"
        else:
            found = "a list" if isinstance(node, SequenceNode) else "fields with values"
        self.problem(node.line, f"{what} is {found}. It should be {expected}.")

    # --- values

    def count(self, node: Node) -> None:
        self._values += 1
        if self._values > MAX_VALUES:
            raise Hopeless(
                node.line, f"The world has more than {MAX_VALUES} values. Make it smaller."
            )

    def mapping(self, node: Node, what: str) -> dict[str, Node]:
        """The fields of `what`; empty values are left out, as if the field were not there."""
        self.count(node)
        if not isinstance(node, MappingNode):
            self.wrong(node, what.capitalize(), 'fields with values, such as "name: pharmacy"')
            return {}
        known = self.FIELDS[what].split()
        fields: dict[str, Node] = {}
        for name_node, value in node.value:
            name = name_node.value if isinstance(name_node, ScalarNode) else "?"
            if name not in known:
                hint = did_you_mean(name, known) or f" The fields are: {', '.join(known)}."
                self.problem(
                    name_node.line,
                    f'{what.capitalize()} has no field "{short(name)}".{hint}',
                )
            elif name in fields:
                self.problem(name_node.line, f'The field "{name}" is here twice. Keep one of them.')
            elif not (isinstance(value, ScalarNode) and value.empty):
                fields[name] = value
        return fields

    def text(self, node: Node, what: str, longest: int = MAX_NAME) -> str | None:
        self.count(node)
        if not isinstance(node, ScalarNode) or node.empty or not node.value.strip():
            self.wrong(node, what, "a text")
            return None
        text = " ".join(str(node.value).split())
        if not text.isprintable():
            self.problem(node.line, f"{what} holds characters that cannot be shown. Remove them.")
            return None
        if len(text) > longest:
            self.problem(node.line, f"{what} is longer than {longest} characters. Shorten it.")
            return None
        return text

    def number(self, node: Node, what: str, low: float, high: float) -> float | None:
        self.count(node)
        try:
            value = float(node.value) if isinstance(node, ScalarNode) else math.nan
        except ValueError:
            value = math.nan
        if math.isnan(value):
            self.wrong(node, what, "a number")
            return None
        if not low <= value <= high:
            self.wrong(node, what, f"a number from {low:g} to {high:g}")
            return None
        return value

    def length(self, node: Node, what: str, low: float, high: float) -> float | None:
        """A length in the file's unit, in metres; the bounds are metres."""
        value = self.number(node, what, low / self.factor, high / self.factor)
        # Nine digits: 157 cm are 1.57 m, not 1.5700000000000001.
        return None if value is None else round(value * self.factor, 9)

    def items(self, node: Node, what: str, most: int = MAX_ENTRIES) -> list[Node]:
        self.count(node)
        if not isinstance(node, SequenceNode):
            self.wrong(node, what, "a list")
            return []
        if len(node.value) > most:
            self.problem(
                node.line,
                f"{what} has {len(node.value)} entries, more than {most}. Make it shorter.",
            )
            return []
        return list(node.value)

    def texts(self, node: Node, what: str, longest: int = MAX_NAME) -> tuple[str, ...]:
        """A list of texts; a text alone is a list of one."""
        if isinstance(node, ScalarNode):
            node = SequenceNode(node.line, [node])
        texts = (self.text(item, f"An entry of {what}", longest) for item in self.items(node, what))
        return tuple(text for text in texts if text is not None)

    def numbers(self, node: Node, what: str, expected: str, counts: Collection[int]) -> list[Node]:
        """A list of so many scalars."""
        items = self.items(node, what) if isinstance(node, SequenceNode) else []
        if len(items) not in counts or not all(isinstance(item, ScalarNode) for item in items):
            self.wrong(node, what, expected)
            return []
        return items

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

    def truth(self, node: Node, what: str) -> bool | None:
        value = {"true": True, "yes": True, "false": False, "no": False, "1": True, "0": False}.get(
            str(node.value).lower() if isinstance(node, ScalarNode) else ""
        )
        if value is None:
            self.wrong(node, what, "true or false")
        return value
