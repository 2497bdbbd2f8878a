"""Writes worlds: one to begin with from a map, and one with what people drew on its map.

A file that somebody wrote keeps its comments and its order: entries are put into the text.
"""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import yaml

from nl2robot.errors import UserError
from nl2robot.station.named_places import NamedByHand
from robot_api.errors import cause
from sim.world.checks import kind_of
from sim.world.fields import compose
from sim.world.geometry import Pose
from sim.world.loading import load_world
from sim.world.map_reader import is_ros_map
from sim.world.model import Place, World, WorldError, Zone
from sim.world.reader import UNITS

_PLAIN = re.compile(r"[^\W\d_](?:[\w ./'-]*[\w.'])?")
_RESERVED = {"null", "true", "false", "yes", "no", "on", "off", "y", "n", "~"}


# --- one to begin with ---------------------------------------------------------------------------


def beginning(map_file: Path, out: Path, name: str, keep_out: Path | None, start: Pose) -> str:
    """The text of a world that is a map, for the file `out`. `start` is the robot's pose."""
    lines = [
        "# Begun by `nl2robot world from-map`. docs/worlds.md says all that a world may say.",
        f"name: {scalar(name)}",
        f"map: {scalar(_from(out, map_file))}",
    ]
    if keep_out is not None:
        lines.append(f"keep_out: {scalar(_from(out, keep_out))}")
    lines += [
        f"robot: {{start: [{start.x:.2f}, {start.y:.2f}, {start.theta:g}]}}",
        "",
        "# Name places by a click on the page /map of `nl2robot serve`, or here:",
        "# places:",
        "#   - {name: pharmacy, pose: [1.5, 2, 90], aliases: {de: [Apotheke], fr: [pharmacie]}}",
    ]
    return "\n".join(lines) + "\n"


def _from(out: Path, file: Path) -> str:
    """The path of a file as one in the folder of `out` names it."""
    with suppress(ValueError):  # another drive
        return Path(os.path.relpath(file, out.parent)).as_posix()
    return str(file.absolute())


def write_world(text: str, out: Path) -> World:
    """Write a world that our own reader has read. Raises `WorldError`; the file then is as it
    was."""
    new = out.with_name(f".{out.name}.new")
    try:
        new.write_text(text, encoding="utf-8")
        world = _read(new, out)
        new.replace(out)
    finally:
        new.unlink(missing_ok=True)
    return world


def _read(file: Path, called: Path) -> World:
    try:
        return load_world(file)
    except WorldError as error:
        raise WorldError(str(called), error.problems) from None


# --- one with what was drawn ---------------------------------------------------------------------


def exported(world: World, named: Sequence[NamedByHand], zones: Sequence[Zone] = ()) -> str:
    """The text of the world's file with these places and zones in it. Raises `UserError`."""
    try:
        before = Path(world.file).read_text(encoding="utf-8-sig")
        root = yaml.compose(before, Loader=yaml.SafeLoader)
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise UserError(
            f"The world's file {world.file} cannot be read any more ({cause(error)})."
        ) from error
    if not isinstance(root, yaml.MappingNode) or is_ros_map(compose(Path(world.file))):
        raise UserError(
            f"{world.file} is a map, and a map has no places. Begin a world with it, and name them"
            " there: nl2robot world from-map"
        )
    per_unit = 1 / _factor(root)
    try:
        text = _with_entries(before, "places", [_place(each.place, per_unit) for each in named])
        text = _with_entries(text, "zones", [_zone(zone, per_unit) for zone in zones])
    except yaml.YAMLError as error:
        raise _by_hand(world) from error
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / Path(world.file).name
        file.write_text(text, encoding="utf-8")
        try:
            there = load_world(file, names_only=True)
        except WorldError as error:
            raise _by_hand(world) from error
    if not {each.place.name for each in named} <= {place.name for place in there.places}:
        raise _by_hand(world)
    return text


def _by_hand(world: World) -> UserError:
    return UserError(
        f"What was drawn cannot be put into {world.file} as it is written. Give its places and"
        ' zones as lists, one entry a line beginning with "- ", and try again.'
    )


def _factor(root: yaml.MappingNode) -> float:
    """Metres for each unit of length in the file."""
    told = {
        node.value: value.value
        for node, value in root.value
        if isinstance(node, yaml.ScalarNode) and isinstance(value, yaml.ScalarNode)
    }
    return UNITS[told.get("units") or "m"] * float(told.get("scale") or 1)


def _place(place: Place, per_unit: float) -> str:
    assert place.pose is not None
    x, y = (_number(metres * per_unit) for metres in (place.pose.x, place.pose.y))
    fields = [f"name: {scalar(place.name)}"]
    if place.kind != kind_of(place.name):
        fields.append(f"kind: {scalar(place.kind)}")
    fields.append(f"pose: [{x}, {y}, {_number(place.pose.theta)}]")
    if place.aliases:
        others = (
            f"{language}: [{', '.join(map(scalar, texts))}]"
            for language, texts in place.aliases.items()
        )
        fields.append(f"aliases: {{{', '.join(others)}}}")
    return f"{{{', '.join(fields)}}}"


def _zone(zone: Zone, per_unit: float) -> str:
    corners = ", ".join(
        f"[{_number(x * per_unit)}, {_number(y * per_unit)}]" for x, y in zone.polygon
    )
    return f"{{name: {scalar(zone.name)}, polygon: [{corners}]}}"


def _number(value: float) -> str:
    return f"{round(value, 4):.10g}"


def scalar(text: str) -> str:
    """The text as YAML, in quotes where it needs them."""
    if _PLAIN.fullmatch(text) and text.casefold() not in _RESERVED:
        return text
    return json.dumps(text, ensure_ascii=False)


def _with_entries(text: str, section: str, entries: Sequence[str]) -> str:
    """The text with these entries at the end of the list of that name."""
    if not entries:
        return text
    root = yaml.compose(text, Loader=yaml.SafeLoader)
    assert isinstance(root, yaml.MappingNode)
    found = next((pair for pair in root.value if pair[0].value == section), None)
    lines = text.splitlines(keepends=True)
    if lines and not lines[-1].endswith("\n"):
        lines[-1] += "\n"
    if found is None:
        return "".join([*lines, f"{section}:\n", *(f"  - {entry}\n" for entry in entries)])
    title, value = found
    if isinstance(value, yaml.SequenceNode) and value.flow_style:
        # Before the bracket, or after the last entry, which a comment may follow.
        at = value.value[-1].end_mark.index if value.value else value.start_mark.index + 1
        told = ", ".join(entries)
        return text[:at] + (f", {told}" if value.value else told) + text[at:]
    indent, after = "  ", title.end_mark.line
    if isinstance(value, yaml.SequenceNode):
        indent, after = " " * value.start_mark.column, _last_line(value)
    new = [f"{indent}- {entry}\n" for entry in entries]
    return "".join([*lines[: after + 1], *new, *lines[after + 1 :]])


def _last_line(node: yaml.Node) -> int:
    """The last line that the node is on, without what empty lines and comments follow."""
    if not isinstance(node, yaml.CollectionNode) or node.flow_style or not node.value:
        end = node.end_mark
        # A text of several lines ends where the next line begins.
        return int(
            end.line - 1 if end.column == 0 and end.line > node.start_mark.line else end.line
        )
    last = node.value[-1]
    return _last_line(last[1] if isinstance(last, tuple) else last)
