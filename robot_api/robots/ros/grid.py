"""The map that the robot drives by, as it publishes it."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from robot_api.errors import LostConnection, NotSupported
from robot_api.robots.ros.connection import Line
from robot_api.robots.ros.dialect import Dialect, Pose, field, number, pose_in
from robot_api.robots.ros.graph import Graph
from robot_api.robots.ros.settings import RosSettings
from robot_api.robots.ros.wire import Where

if TYPE_CHECKING:
    from PIL.Image import Image

    from robot_api.robots.address import Address

_MAP_WITHIN = 20.0
"""Seconds that a map may take to come: one of a large house has millions of cells."""
_MOST_CELLS = 100_000_000


@dataclass(frozen=True)
class OccupancyGrid:
    """A map in cells, row by row from the origin on: 0 is free, 100 is occupied, -1 is unknown."""

    width: int
    height: int
    resolution: float
    """Metres per cell."""
    origin: Pose
    """Where the corner of the first cell is on the map, and how the rows are turned."""
    cells: list[int]

    def picture(self) -> Image:
        """As map_saver writes it: north is up, free is 254, occupied 0, unknown 205; what is
        between free and occupied is grey."""
        from PIL import Image

        shade = bytes(
            205 if cell < 0 else max(0, round(254 * (1 - min(cell, 100) / 100)))
            for cell in self.cells
        )
        upside_down = Image.frombytes("L", (self.width, self.height), shade)
        return upside_down.transpose(Image.Transpose.FLIP_TOP_BOTTOM)

    @property
    def size(self) -> tuple[float, float]:
        """Metres along its rows, and across them."""
        return self.width * self.resolution, self.height * self.resolution


def read_grid(message: Mapping[str, Any]) -> OccupancyGrid:
    """Read a nav_msgs/OccupancyGrid. Raises `NotSupported` if it is none."""
    info, cells = field(message, "info"), field(message, "data")
    width, height = field(info, "width"), field(info, "height")
    resolution, origin = number(field(info, "resolution")), pose_in(field(info, "origin"))
    if (
        not isinstance(width, int)
        or not isinstance(height, int)
        or not isinstance(cells, list)
        or not 0 < width * height == len(cells) <= _MOST_CELLS
        or not all(isinstance(cell, int) and -128 <= cell <= 127 for cell in cells)
        or resolution is None
        or resolution <= 0
        or not isinstance(origin, Pose)
    ):
        raise NotSupported(
            "What the robot gives for its map is none. Look at what its map server has loaded."
        )
    return OccupancyGrid(width, height, resolution, origin, cells)


def received(line: Line, topic: str, kind: str, within: float = _MAP_WITHIN) -> OccupancyGrid:
    """The map on that topic. Raises `LostConnection` if none comes, `NotSupported` if what comes is
    none."""
    came = threading.Event()
    messages: list[Mapping[str, Any]] = []

    def hear(message: Mapping[str, Any]) -> None:
        messages.append(message)
        came.set()

    line.subscribe(topic, kind, hear)
    try:
        if not came.wait(within):
            raise LostConnection(
                f"The robot has not given its map within {within:g} seconds ({topic})."
                " Look whether its map server runs."
            )
    finally:
        line.unsubscribe(topic)
    return read_grid(messages[0])


def fetch_map(address: Address, settings: RosSettings | None = None) -> OccupancyGrid:
    """The map of the robot at that address. Raises `LostConnection`, `AccessDenied`,
    `NotSupported`."""
    settings = settings or RosSettings()
    where = Where(address.host, address.port or 9090, settings.tls, address.user)
    line = Line(where)
    line.open()
    try:
        graph = Graph(line.now, Dialect(1 if address.scheme == "ros1" else 2), settings)
        found = graph.topic("map", "nav_msgs/OccupancyGrid")
        if found is None:
            raise NotSupported(
                "The robot gives no map. Start its map server, or name the topic in its file."
            )
        return received(line, *found)
    finally:
        line.close()
