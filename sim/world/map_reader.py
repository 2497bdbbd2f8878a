"""Reads the fields of a ROS map, in a world's file or in one of their own."""

from __future__ import annotations

import math
from pathlib import Path
from typing import ClassVar

from sim.world import geometry as g
from sim.world.fields import MAX_METRES, MAX_TEXT, NodeReader, compose
from sim.world.map_image import ImageError, find_image, image_size, is_there
from sim.world.yaml_nodes import Hopeless, MappingNode, Node, ScalarNode

MODES = ("trinary", "scale", "raw")


def is_ros_map(root: Node) -> bool:
    """Whether this is what ROS's map_server writes, not a world."""
    if not isinstance(root, MappingNode):
        return False
    fields = {node.value for node, _ in root.value if isinstance(node, ScalarNode)}
    return {"image", "resolution"} <= fields and not fields & {"name", "places", "map"}


class MapReader(NodeReader):
    """Reads maps. Lengths are metres and angles radians, as in ROS, whatever the world's unit."""

    FIELDS: ClassVar = {
        "a map": "image resolution origin negate occupied_thresh free_thresh mode",
    }

    def map(self, node: Node, path: Path, what: str = "map") -> g.GridMap | None:
        """The map in the fields of the node, or in the file that it names. `path` is the file that
        the node is from, `what` it is called to people."""
        if isinstance(node, ScalarNode):
            return self._map_in_file(node, path, what)
        fields = self.mapping(node, "a map")
        for field in ("image", "resolution", "origin"):
            if field not in fields and isinstance(node, MappingNode):
                self.problem(
                    node.line,
                    f'A map has no "{field}". It needs image, resolution and origin, as ROS\'s '
                    "map_server writes them.",
                )
        if not {"image", "resolution", "origin"} <= set(fields):
            return None
        image = self.text(fields["image"], "The image of the map", MAX_TEXT)
        resolution = self.number(fields["resolution"], "The resolution of the map", 0.001, 10)
        origin = self.numbers(fields["origin"], "The origin of the map", "[x, y, radians]", (2, 3))
        numbers = [
            self.number(item, "The origin of the map", -MAX_METRES, MAX_METRES) for item in origin
        ]
        thresholds = self._thresholds(fields)
        negate = "negate" in fields and self.truth(fields["negate"], '"negate" of the map')
        mode = self.text(fields["mode"], '"mode" of the map') if "mode" in fields else "trinary"
        if mode is not None and mode not in MODES:
            self.wrong(fields["mode"], '"mode" of the map', '"trinary", "scale" or "raw"')
        if image is None or resolution is None or not numbers or None in numbers:
            return None
        if self.names_only:
            return None
        file = find_image(path.parent, image)
        try:
            size = image_size(file)
        except ImageError as error:
            self.problem(fields["image"].line, str(error))
            return None
        if max(size) * resolution > MAX_METRES:
            self.problem(
                fields["resolution"].line,
                f"The map is {max(size) * resolution:g} metres wide or high, more than "
                f"{MAX_METRES:g}. Correct the resolution, which is metres a pixel.",
            )
            return None
        x, y, theta = [number for number in [*numbers, 0.0] if number is not None][:3]
        return g.GridMap(
            image=str(file),
            resolution=resolution,
            origin=(x, y, math.degrees(theta)),
            size=size,
            negate=bool(negate),
            mode=mode or "trinary",
            **thresholds,
        )

    def _map_in_file(self, named: ScalarNode, path: Path, what: str) -> g.GridMap | None:
        """The map in a file of its own; what is wrong there is told with the line there, too."""
        name = self.text(named, f"The {what}", MAX_TEXT)
        if name is None or self.names_only:
            return None
        path = path.parent / name
        if not is_there(path):
            self.problem(
                named.line,
                f"The {what} {name} is not there. Give the path of its YAML, from the folder of "
                "this file.",
            )
            return None
        reader = MapReader(str(path), self.names_only)
        try:
            root = compose(path)
            if isinstance(root, ScalarNode):
                raise Hopeless(root.line, "This is no map. It needs image, resolution and origin.")
            grid = reader.map(root, path, what)
        except Hopeless as error:
            reader.problems.append(error.problem)
            grid = None
        for problem in reader.problems:
            where = f", line {problem.line}" if problem.line else ""
            self.problem(named.line, f"The {what} {name}{where}: {problem.message}")
        return grid

    def _thresholds(self, fields: dict[str, Node]) -> dict[str, float]:
        """Those of the file. Swapped ones would make walls free."""
        found: dict[str, float] = {}
        for field in ("occupied_thresh", "free_thresh"):
            if field in fields:
                value = self.number(fields[field], f'"{field}" of the map', 0, 1)
                if value is None:
                    return {}
                found[field] = value
        occupied = found.get("occupied_thresh", g.OCCUPIED_THRESH)
        free = found.get("free_thresh", g.FREE_THRESH)
        if free > occupied:
            lines = [fields[field].line for field in found]
            self.problem(
                max(lines),
                f"free_thresh is {free:g} and occupied_thresh {occupied:g}: a cell would be free "
                "and occupied at once. free_thresh must be the lesser; perhaps they are swapped.",
            )
        return found
