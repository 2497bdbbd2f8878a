"""YAML as nodes, which know their lines, for files that people write: what is not as it should be
becomes a sentence with its line.

Names are taken as they are written: `yes`, `12:30` and `0042` stay what they look like. Whatever a
file repeats by anchors, and however deep it nests, only the fields asked for are read, and the
values are counted. Knows nothing of worlds.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import msgspec
import yaml

MAX_BYTES = 1_000_000
MAX_ENTRIES = 1000
"""Places, people, objects ... of each kind."""
MAX_VALUES = 200_000
"""Values in the file as a whole, counted as often as anchors repeat them."""
MAX_NAME = 200
MAX_PROBLEMS = 50
MAX_DEPTH = 20
TOO_DEEP = "Lists are nested too deep here. Look for a bracket too many."

_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_EMPTY = ("", "~", "null", "Null", "NULL")
_TAGS = {
    f"tag:yaml.org,2002:{kind}" for kind in ("str", "int", "float", "bool", "null", "seq", "map")
}


class Problem(msgspec.Struct, frozen=True):
    """One thing that is wrong with a file."""

    line: int | None
    """Counted from 1; None if it is about the file as a whole."""
    message: str


class FileProblems(Exception):
    """A file cannot be used; `problems` holds all that is wrong with it, in order of lines."""

    def __init__(self, file: str, problems: Iterable[Problem]) -> None:
        self.file = file
        self.problems = tuple(sorted(problems, key=lambda problem: problem.line or 0))
        super().__init__(file, self.problems)

    def __str__(self) -> str:
        """One line for each problem: "ward.yaml:12: what is wrong; what to do"."""
        return "\n".join(
            f"{self.file}:{problem.line}: {problem.message}"
            if problem.line
            else f"{self.file}: {problem.message}"
            for problem in self.problems
        )


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


@dataclass(frozen=True)
class Sort:
    """A sort of file, in the words in which people are told about it."""

    name: str
    """What it is called: "world"."""
    path: str
    """What to give instead of a file that is none: "the path of a world's YAML file"."""
    least: str
    """What is at least in one."""


def compose(path: Path, sort: Sort) -> Node:
    """The YAML of the file as nodes. Raises `Hopeless`, and `FileNotFoundError`."""
    try:
        with path.open("rb") as file:
            data = file.read(MAX_BYTES + 1)  # nobody knows the size of a device
        if len(data) > MAX_BYTES:
            raise Hopeless(
                None,
                f"The file is larger than {MAX_BYTES // 1000} kB. Is it really a {sort.name}?",
            )
        text = data.decode("utf-8-sig")
    except FileNotFoundError:
        raise
    except UnicodeDecodeError as error:
        raise Hopeless(
            None, f"The file is no text in UTF-8 (byte {error.start}). Save it as UTF-8."
        ) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise Hopeless(None, f"The file cannot be read: {reason}. Give {sort.path}.") from None
    return compose_text(text, sort)


def compose_text(text: str, sort: Sort) -> Node:
    """The YAML of a text as nodes. Raises `Hopeless`."""
    try:
        root = _build(yaml.parse(text, Loader=_LOADER), sort)
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
        raise Hopeless(None, f"The file is empty. {sort.least}")
    return root


def _build(events: Iterable[Any], sort: Sort) -> Node | None:
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
            if isinstance(event, yaml.AliasEvent) and any(node is outer for outer, _ in around):
                raise Hopeless(
                    line,
                    f'"*{short(str(event.anchor))}" repeats something that it is itself a part of,'
                    " without end. Write out what is meant.",
                )
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
            raise Hopeless(
                line, f"A second {sort.name} begins here. Put it into a file of its own."
            )
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


def key(name: str) -> str:
    """What two spellings of a name have in common: case, spaces and kind of apostrophe do not
    count."""
    return " ".join(name.replace("’", "'").casefold().split())


def did_you_mean(word: str, known: Iterable[str]) -> str:
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

    def __init__(self, file: str) -> None:
        self.file = file
        self.problems: list[Problem] = []
        self._values = 0

    # --- problems

    def problem(self, line: int, message: str) -> None:
        """Note what is wrong."""
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
                node.line, f"The file has more than {MAX_VALUES} values. Make it smaller."
            )

    def mapping(self, node: Node, what: str) -> dict[str, Node]:
        """The fields of `what`; empty values are left out, as if the field were not there."""
        return self.fields(node, what, self.FIELDS[what].split())

    def fields(self, node: Node, what: str, known: Sequence[str]) -> dict[str, Node]:
        """As `mapping`, of fields that are known so."""
        self.count(node)
        if not isinstance(node, MappingNode):
            self.wrong(node, what.capitalize(), 'fields with values, such as "name: pharmacy"')
            return {}
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

    def truth(self, node: Node, what: str) -> bool | None:
        value = {"true": True, "yes": True, "false": False, "no": False, "1": True, "0": False}.get(
            str(node.value).lower() if isinstance(node, ScalarNode) else ""
        )
        if value is None:
            self.wrong(node, what, "true or false")
        return value
