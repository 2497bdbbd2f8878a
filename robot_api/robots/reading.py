"""Reads a robot file: everything that is wrong with it becomes a sentence with its line."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, ClassVar, Final, TypeVar, get_args

import msgspec
from msgspec import inspect

from robot_api.robots.registry import RobotKind
from robot_api.robots.robot_file import Limits, RobotFile, Voice
from sim.world.yaml_nodes import (
    FileProblems,
    Hopeless,
    MappingNode,
    Node,
    NodeReader,
    Problem,
    ScalarNode,
    SequenceNode,
    Sort,
    compose,
    did_you_mean,
    short,
)

MOST_NAMES: Final = 200
"""Joints, gestures, emotions or skills."""
MOST_DEGREES: Final = 3600.0

_SORT: Final = Sort(
    name="robot file",
    path="the path of a robot file, in YAML",
    least='A robot file has at least a "name" or "limits"; leave --robot-file out without one.',
)
_BOUNDS: Final = {
    "speed": (0.01, 5.0),
    "acceleration": (0.01, 20.0),
    "turn_rate": (1.0, 720.0),
    "volume": (0.0, 100.0),
}
"""What each limit may be."""
_FIELDS: Final = [
    *("name", "limits", "joints", "speech", "hearing", "gestures", "emotions", "skills")
]
"""What stands in every robot file; beside it, there is the section of its wire."""
_EXPECTED: Final = {
    "`str`": "a text",
    "`int`": "a whole number",
    "`float`": "a number",
    "`bool`": "true or false",
    "`array`": "a list",
    "`object`": "fields with values",
}
_T = TypeVar("_T")


class RobotFileError(FileProblems):
    """A robot file cannot be used."""


@dataclass(frozen=True)
class Read:
    """A robot file that was read."""

    file: RobotFile = field(default_factory=RobotFile)
    settings: msgspec.Struct | None = None
    """The section of its wire."""
    path: str | None = None
    """None where there is no file."""
    lines: Mapping[str, int] = field(default_factory=dict)
    """The line of each joint."""

    def error(self, message: str, joint: str | None = None) -> RobotFileError:
        """What a robot finds wrong with its file."""
        line = self.lines.get(joint) if joint is not None else None
        return RobotFileError(self.path or "the robot file", [Problem(line, message)])


def read_robot_file(path: Path, kind: RobotKind) -> Read:
    """The file of a robot of that kind. Raises `RobotFileError` with all that is wrong with it."""
    reader = _Reader(str(path), kind)
    try:
        read = reader.robot(compose(path, _SORT))
    except FileNotFoundError:
        problem = Problem(None, "There is no such robot file. Check its name, or leave it out.")
        raise RobotFileError(reader.file, [problem]) from None
    except Hopeless as hopeless:
        reader.problems.append(hopeless.problem)
        raise RobotFileError(reader.file, reader.problems) from None
    if reader.problems:
        raise RobotFileError(reader.file, reader.problems)
    return read


def without_file(kind: RobotKind) -> Read:
    """What holds for a robot of that kind that has no file. Raises `RobotFileError` if the kind
    cannot do without one."""
    if kind.settings is None:
        return Read()
    try:
        return Read(settings=msgspec.convert({}, kind.settings))
    except msgspec.ValidationError:
        needed = ", ".join(
            each.encode_name for each in msgspec.structs.fields(kind.settings) if each.required
        )
        message = f'{kind.title} needs a robot file with a section "{kind.section}" that has'
        raise RobotFileError("--robot-file", [Problem(None, f"{message} {needed}.")]) from None


class _Reader(NodeReader):
    FIELDS: ClassVar[Mapping[str, str]] = {"the entry limits": " ".join(_BOUNDS)}

    def __init__(self, file: str, kind: RobotKind) -> None:
        super().__init__(file)
        self._kind = kind
        self._lines: dict[str, int] = {}

    def robot(self, root: Node) -> Read:
        section = self._kind.section
        known = [*_FIELDS, section] if section else _FIELDS
        fields = self.fields(root, "the robot file", known)

        def read(name: str, how: Callable[[Node], _T], otherwise: _T) -> _T:
            return how(fields[name]) if name in fields else otherwise

        node = fields.get(section) if section else None
        wire, settings = self.section(node)
        file = RobotFile(
            name=read("name", lambda node: self.text(node, "The name"), None),
            limits=read("limits", self.limits, Limits()),
            joints=read("joints", self.joints, {}),
            speech=read("speech", lambda node: self.voice(node, "speech"), None),
            hearing=read("hearing", lambda node: self.voice(node, "hearing"), None),
            gestures=read("gestures", lambda node: self.names(node, "gestures"), {}),
            emotions=read("emotions", lambda node: self.names(node, "emotions"), {}),
            skills=read("skills", lambda node: self.names(node, "skills"), {}),
            wire=wire,
        )
        return Read(file, settings, self.file, self._lines)

    def limits(self, node: Node) -> Limits:
        fields = self.mapping(node, "the entry limits")
        return Limits(
            **{
                name: self.number(value, f"The limit {name}", *_BOUNDS[name])
                for name, value in fields.items()
            }
        )

    def joints(self, node: Node) -> dict[str, tuple[float, float]]:
        joints: dict[str, tuple[float, float]] = {}
        for name, value in self.named(node, "joints"):
            what = f'The joint "{short(name)}"'
            self._lines[name] = value.line
            items = self.numbers(value, what, "its least and greatest angle, [-40, 40]", (2,))
            angles = [self.number(item, what, -MOST_DEGREES, MOST_DEGREES) for item in items]
            if len(angles) != 2 or angles[0] is None or angles[1] is None:
                continue
            if angles[0] >= angles[1]:
                self.problem(
                    value.line,
                    f"{what} goes from {angles[0]:g} to {angles[1]:g} degrees."
                    " Write the lesser angle first.",
                )
                continue
            joints[name] = (angles[0], angles[1])
        return joints

    def voice(self, node: Node, what: str) -> Voice | None:
        text = self.text(node, f'The field "{what}"')
        if text is None:
            return None
        known: tuple[Voice, ...] = get_args(Voice)
        voices: dict[str, Voice] = {voice: voice for voice in known}
        if text not in voices:
            hint = did_you_mean(text, known) or f" It can be {', '.join(known)}."
            self.problem(node.line, f'The field "{what}" is "{short(text)}".{hint}')
        return voices.get(text)

    def names(self, node: Node, what: str) -> dict[str, str]:
        """What programs say, each with a text."""
        texts = {
            name: self.text(value, f'"{short(name)}" of the {what}')
            for name, value in self.named(node, what)
        }
        return {name: text for name, text in texts.items() if text is not None}

    def named(self, node: Node, what: str) -> Iterator[tuple[str, Node]]:
        """The entries of a mapping whose names are free."""
        self.count(node)
        if not isinstance(node, MappingNode):
            self.wrong(node, f'The field "{what}"', "names with values")
            return
        if len(node.value) > MOST_NAMES:
            self.problem(
                node.line,
                f'The field "{what}" has {len(node.value)} entries, more than {MOST_NAMES}.'
                " Make it shorter.",
            )
            return
        seen = set()
        for name_node, value in node.value:
            name = self.text(name_node, f"A name of the {what}")
            if name is None:
                continue
            if name in seen:
                self.problem(name_node.line, f'"{short(name)}" is here twice. Keep one of them.')
                continue
            seen.add(name)
            yield name, value

    # --- the section of the wire

    def section(self, node: Node | None) -> tuple[dict[str, Any], msgspec.Struct | None]:
        """The section as it stands, and as the kind reads it."""
        kind = self._kind.settings
        if kind is None:
            return {}, None
        found = len(self.problems)
        section = str(self._kind.section)
        if node is not None:
            self.look(node, inspect.type_info(kind), section)
        data = self.plain(node) if node is not None else {}
        if len(self.problems) > found:
            return {}, None
        try:
            # Values are written without quotes: what they are is for the type to say.
            return data, msgspec.convert(data, kind, strict=False)
        except msgspec.ValidationError as error:
            self.unfit(str(error), node, section)
            return {}, None

    def look(self, node: Node, wanted: inspect.Type, what: str) -> None:
        """Note the fields and words that are not known there, with those that are."""
        match wanted, node:
            case inspect.StructType(), MappingNode():
                known = {each.encode_name: each.type for each in wanted.fields}
                for name_node, value in node.value:
                    name = name_node.value if isinstance(name_node, ScalarNode) else "?"
                    if name in known:
                        self.look(value, known[str(name)], f"{what}.{name}")
                    else:
                        hint = did_you_mean(str(name), known)
                        self.problem(
                            name_node.line,
                            f'"{what}" has no field "{short(str(name))}".'
                            + (hint or f" The fields are: {', '.join(known)}."),
                        )
            case inspect.DictType(), MappingNode():
                for name_node, value in node.value:
                    named = name_node.value if isinstance(name_node, ScalarNode) else "?"
                    self.look(value, wanted.value_type, f"{what}.{named}")
            case ((inspect.ListType() | inspect.VarTupleType()), SequenceNode()):
                for item in node.value:
                    self.look(item, wanted.item_type, what)
            case inspect.UnionType(), _:
                fitting = [each for each in wanted.types if not isinstance(each, inspect.NoneType)]
                if len(fitting) == 1:
                    self.look(node, fitting[0], what)
            case inspect.LiteralType(), ScalarNode():
                words = [str(value) for value in wanted.values]
                if not node.empty and node.value not in words:
                    hint = did_you_mean(node.value, words) or f" It can be {', '.join(words)}."
                    self.problem(node.line, f'"{what}" is "{short(node.value)}".{hint}')

    def plain(self, node: Node) -> Any:
        """The node as data; values as texts."""
        self.count(node)
        match node:
            case ScalarNode():
                return None if node.empty else node.value
            case SequenceNode():
                return [self.plain(item) for item in node.value]
        return {
            str(name.value): self.plain(value)
            for name, value in node.value
            if not (isinstance(value, ScalarNode) and value.empty)  # as if it were not there
        }

    def unfit(self, message: str, node: Node | None, section: str) -> None:
        """Note what msgspec says of a value, which tells where by a path: `$.topics.velocity`."""
        said, _, path = message.partition(" - at `$")
        steps = [step for step in re.split(r"[.\[\]]+", path.rstrip("`")) if step]
        what = ".".join((section, *steps))
        line, value = _at(node, steps)
        missing = re.fullmatch(r"Object missing required field `(\w+)`", said)
        if missing:
            self.problem(line, f'"{what}" lacks the field "{missing[1]}". Add it.')
            return
        expected = re.match(r"Expected (`\w+`)(.*?)(?:, got .*)?$", said)
        if expected and expected[1] in _EXPECTED:
            told = f"It should be {_EXPECTED[expected[1]]}{expected[2].replace(' | null', '')}."
        else:
            told = f"{said.rstrip('.')}."
        found = f'"{short(value)}"' if value is not None else "not as it should be"
        self.problem(line, f'"{what}" is {found}. {told}')


def _at(node: Node | None, steps: list[str]) -> tuple[int, str | None]:
    """The line of what a path leads to, and its value if it is a single one."""
    line = node.line if node is not None else 1
    for step in steps:
        match node:
            case MappingNode():
                node = next(
                    (
                        value
                        for name, value in node.value
                        if isinstance(name, ScalarNode) and name.value == step
                    ),
                    None,
                )
            case SequenceNode() if step.isdigit() and int(step) < len(node.value):
                node = node.value[int(step)]
            case _:
                break
        line = node.line if node is not None else line
    return line, node.value if isinstance(node, ScalarNode) else None
