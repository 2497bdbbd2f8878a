"""Routes: the shortest way around walls and furniture that keeps some clearance.

A `Chart` is the free floor of one map for a round body, as a visibility graph: its nodes are the
corners of the obstacles, grown by the clearance; its edges join the corners that see each other
and around which a shortest way can bend. Doors and zones that may be closed are `gates`: the edges
that cross one are left out of a query that names it. Zones are laid over the floor of a chart that
is there already (`with_zones`), so that they can be drawn at any time. People who stand in the way
are given with the query, as discs, and get corners of their own.

Everything is in metres.
"""

from __future__ import annotations

import copy
import functools
import itertools
import math
import threading
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any, Concatenate, NamedTuple, ParamSpec, TypeVar

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from shapely.geometry import LineString, MultiPolygon, Point, Polygon, box
from shapely.geometry.base import BaseGeometry

Spot = tuple[float, float]
Floats = NDArray[np.float64]

_GRAZE = 1e-3  # edges run along the grown obstacles; this much inside does not count as crossing
_LEAVE = 1000.0
"""How many metres of way a metre in a zone counts, for a body that is to leave it."""
_DISC_CORNERS = 8
_PAIRS_AT_ONCE = 1_000_000
_SPOTS_ON_A_WAY = [odd / parts for parts in (2, 4, 8, 16, 32) for odd in range(1, parts, 2)]


class Disc(NamedTuple):
    """A person in the way; `radius` is what to keep from their middle."""

    x: float
    y: float
    radius: float


class Route(NamedTuple):
    points: tuple[Spot, ...]
    """From the start to the goal, both included."""
    length: float
    gates: frozenset[str]
    """The gates it passes."""


class _Zone(NamedTuple):
    """An area that a query may close."""

    area: BaseGeometry
    wide: BaseGeometry
    """With what routes keep away from it."""


P = ParamSpec("P")
R = TypeVar("R")


def _one_at_a_time(
    question: Callable[Concatenate[Chart, P], R],
) -> Callable[Concatenate[Chart, P], R]:
    """Simulations in several threads share a chart, but GEOS's prepared shapes allow one at a
    time."""

    @functools.wraps(question)
    def alone(chart: Chart, /, *args: P.args, **kwargs: P.kwargs) -> R:
        with chart._lock:
            return question(chart, *args, **kwargs)

    return alone


class Chart:
    """The free floor for a body of `radius`, which routes keep `margin` further away than that.

    `walls` are segments (x1, y1, x2, y2) of a `thickness`, `solids` the corners of furniture,
    `gates` the lines of doors, `zones` the outlines of areas that a query may close as it does
    gates. `floor` is all the floor there is; without it, it ends a little beyond the walls."""

    def __init__(
        self,
        walls: Iterable[tuple[float, float, float, float]],
        solids: Iterable[Sequence[Spot]] = (),
        gates: Mapping[str, tuple[float, float, float, float]] | None = None,
        zones: Mapping[str, Sequence[Spot]] | None = None,
        *,
        thickness: float = 0.0,
        radius: float = 0.25,
        margin: float = 0.1,
        floor: BaseGeometry | None = None,
    ) -> None:
        self._lock = threading.RLock()
        self.radius = radius
        self.clearance = radius + margin
        pieces: list[BaseGeometry] = [
            _grow(LineString([(a, b), (c, d)]), thickness / 2) for a, b, c, d in walls
        ]
        self._walls = shapely.STRtree(pieces)
        pieces += [Polygon(corners) for corners in solids]
        self._obstacles = shapely.union_all(pieces) if pieces else Polygon()
        self._obstacle_tree = shapely.STRtree(pieces)
        self._doors: dict[str, BaseGeometry] = {
            name: LineString([(a, b), (c, d)]) for name, (a, b, c, d) in (gates or {}).items()
        }

        grown = shapely.union_all([_grow(piece, self.clearance) for piece in pieces])
        self._frame = _frame(pieces) if floor is None else floor
        shapely.prepare(self._frame)
        self._free = self._frame.difference(grown)
        self._passable = self._free.buffer(_GRAZE, join_style="mitre")
        shapely.prepare(self._free)
        shapely.prepare(self._passable)
        nothing = np.empty(0, dtype=np.intp)
        self._nodes = self._before = self._after = np.empty((0, 2))
        self._first, self._second = nothing, nothing
        self._add_nodes([grown])
        self._lay_zones(zones or {})

    def with_zones(self, zones: Mapping[str, Sequence[Spot]]) -> Chart:
        """The same floor, which stays as it is, with these zones and no others."""
        assert not self._zones, "zones are laid over a bare floor"
        twin = copy.copy(self)
        twin._lay_zones(zones)
        return twin

    @_one_at_a_time
    def _lay_zones(self, zones: Mapping[str, Sequence[Spot]]) -> None:
        self._zones: dict[str, _Zone] = {}
        for name, corners in zones.items():
            area = Polygon(corners)
            self._zones[name] = _Zone(area, _grow(area, self.clearance))
        self._add_nodes([zone.wide for zone in self._zones.values()])
        self._edges = _lines(self._nodes[self._first], self._nodes[self._second])
        self._lengths = shapely.length(self._edges)
        self._gates = self._doors | {
            name: zone.wide.buffer(-_GRAZE) for name, zone in self._zones.items()
        }
        self._crossing = {
            name: shapely.intersects(gate, self._edges) for name, gate in self._gates.items()
        }

    def _add_nodes(self, grown: Iterable[BaseGeometry]) -> None:
        """Put the corners of grown obstacles before the nodes that there are, with their edges to
        one another and to those."""
        corners = [_corners(each) for each in grown]
        if not corners:
            return
        here, before, after = (np.concatenate(part) for part in zip(*corners, strict=True))
        reachable = shapely.intersects_xy(self._passable, here[:, 0], here[:, 1])
        count = int(reachable.sum())
        self._nodes = np.concatenate([here[reachable], self._nodes])
        self._before = np.concatenate([before[reachable], self._before])
        self._after = np.concatenate([after[reachable], self._after])
        found = [self._edges_from(rows) for rows in _shares(count, len(self._nodes))]
        known = (self._first + count, self._second + count)
        self._first, self._second = (
            np.concatenate(part) for part in zip(*found, known, strict=True)
        )

    def _edges_from(self, rows: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
        """The ends of clear ways from these nodes to later ones that a shortest way can take."""
        first, second = np.nonzero(np.arange(len(self._nodes)) > rows[:, None])
        first = rows[first]
        bends = self._bends(self._nodes[first], second) & self._bends(self._nodes[second], first)
        first, second = first[bends], second[bends]
        # Of most ways a few spots tell that something is in between, much faster than the line.
        for share in _SPOTS_ON_A_WAY:
            spots = (1 - share) * self._nodes[first] + share * self._nodes[second]
            free = shapely.intersects_xy(self._passable, spots[:, 0], spots[:, 1])
            first, second = first[free], second[free]
        clear = shapely.covers(self._passable, _lines(self._nodes[first], self._nodes[second]))
        return first[clear], second[clear]

    def _bends(self, origin: Floats, nodes: NDArray[Any]) -> NDArray[np.bool_]:
        """Whether a shortest way that comes from `origin` can bend around each of the `nodes`."""
        here = self._nodes[nodes]
        way = here - origin
        left = _cross(way, self._before[nodes] - here)
        right = _cross(way, self._after[nodes] - here)
        return left * right >= -1e-9

    # --- questions about single spots ------------------------------------------------------------

    @_one_at_a_time
    def distance(self, x: float, y: float) -> float:
        """How far the nearest wall or piece of furniture is; 0 inside of furniture."""
        here = Point(x, y)
        index = self._obstacle_tree.nearest(here)
        return (
            math.inf
            if index is None
            else float(here.distance(self._obstacle_tree.geometries[index]))
        )

    @_one_at_a_time
    def fits(self, x: float, y: float) -> bool:
        """Whether the body can be there without touching anything, on the floor."""
        return self.distance(x, y) >= self.radius and bool(self._frame.covers(Point(x, y)))

    @_one_at_a_time
    def is_floor(self, x: float, y: float) -> bool:
        """Whether there is floor at all: not what a map does not show, nor beyond the walls."""
        return bool(self._frame.covers(Point(x, y)))

    @_one_at_a_time
    def to_zone(self, name: str, x: float, y: float) -> float:
        """How far a zone is; 0 in it."""
        return float(self._zones[name].area.distance(Point(x, y)))

    @_one_at_a_time
    def clear(self, start: Spot, goal: Spot) -> bool:
        """Whether the straight way keeps the clearance."""
        return bool(self._passable.covers(LineString([start, goal])))

    @_one_at_a_time
    def in_sight(self, start: Spot, end: Spot) -> bool:
        """Whether no wall stands between; doors do not count."""
        line = LineString([start, end])
        return bool(self._walls.query(line, predicate="intersects").size == 0)

    @_one_at_a_time
    def nearest_free(self, x: float, y: float) -> Spot | None:
        """The nearest spot that keeps the clearance, on this side of the walls."""
        here = Point(x, y)
        if self._passable.covers(here):
            return x, y
        if not self._frame.covers(here):
            return None
        parts = self._free.geoms if isinstance(self._free, MultiPolygon) else [self._free]
        near = sorted((here.distance(part), i) for i, part in enumerate(parts) if not part.is_empty)
        for _, i in near:
            link = shapely.shortest_line(here, parts[i])
            if not self._crosses_wall(link):
                found = link.coords[-1]
                return float(found[0]), float(found[1])
        return None

    def _crosses_wall(self, link: BaseGeometry) -> bool:
        away = link.interpolate(min(1e-6, link.length))
        beyond = LineString([away, link.coords[-1]])
        return self._obstacle_tree.query(beyond, predicate="intersects").size > 0 and not (
            # A body that stands against (or in) furniture may leave it.
            self._obstacles.distance(away) < 1e-3
        )

    # --- routes ----------------------------------------------------------------------------------

    @_one_at_a_time
    def route(
        self,
        start: Spot,
        goal: Spot,
        closed: Collection[str] = (),
        people: Sequence[Disc] = (),
    ) -> Route | None:
        """The shortest way that crosses none of the `closed` gates and keeps off the `people`;
        None if there is none. From within a closed zone it leads out by the shortest way."""
        depart, arrive = self.nearest_free(*start), self.nearest_free(*goal)
        if depart is None or arrive is None:
            return None
        discs = [disc for disc in (_beside(disc, depart, arrive) for disc in people) if disc]
        ways_out = self._ways_out(depart, closed)
        extra = np.array([depart, arrive, *ways_out, *self._around(discs)])
        count = len(self._nodes)
        distances, before = self._search(extra, closed, discs)
        if not math.isfinite(distances[count + 1]):
            return None
        way = [count + 1]
        while way[-1] != count:
            way.append(int(before[way[-1]]))
        spots = _spots(self._nodes, extra, np.array(way[::-1]))
        points = _without_repeats([start, *((float(x), float(y)) for x, y in spots), goal])
        line = LineString(points) if len(points) > 1 else Point(points[0])
        passed = frozenset(name for name, gate in self._gates.items() if gate.intersects(line))
        return Route(points, float(line.length), passed)

    @_one_at_a_time
    def lengths(
        self, start: Spot, goals: Sequence[Spot], closed: Collection[str] = ()
    ) -> list[float]:
        """How long the shortest way to each of the goals is; infinite where there is none. A way
        out of a closed zone counts as very long."""
        depart = self.nearest_free(*start)
        arrivals = [self.nearest_free(*goal) for goal in goals]
        reachable = [spot for spot in arrivals if spot is not None]
        if depart is None or not reachable:
            return [math.inf] * len(goals)
        extra = np.array([depart, *reachable, *self._ways_out(depart, closed)])
        distances, _ = self._search(extra, closed, ())
        found = iter(distances[len(self._nodes) + 1 :])
        return [math.inf if spot is None else float(next(found)) for spot in arrivals]

    def _search(
        self, extra: Floats, closed: Collection[str], discs: Sequence[Disc]
    ) -> tuple[Floats, NDArray[Any]]:
        """The distance of every node, and then of every `extra` spot, from the first of these;
        and for each which comes before it on the way."""
        count = len(self._nodes)
        ends, starts, lines = self._join(extra)
        open_old = np.ones(len(self._edges), dtype=np.bool_)
        open_new = np.ones(len(lines), dtype=np.bool_)
        old_lengths, new_lengths = self._lengths, shapely.length(lines)
        for name in closed:
            zone = self._zones.get(name)
            crossing = shapely.intersects(self._gates[name], lines)
            if zone is not None:
                room = _to(zone.area, extra)
                if room[0] < self.radius:  # it has to leave
                    new_lengths = new_lengths + _LEAVE * _within(zone.wide, lines)
                if room[0] == 0.0:
                    old_lengths = old_lengths + _LEAVE * _within(zone.wide, self._edges)
                    continue
                crossing &= self._too_close(zone, lines, room, starts, ends)
            open_old &= ~self._crossing[name]
            open_new &= ~crossing
        for disc in discs:
            open_old &= ~_near(disc, self._nodes[self._first], self._nodes[self._second])
            open_new &= ~_near(disc, extra[starts - count], _spots(self._nodes, extra, ends))
        rows = np.concatenate([self._first[open_old], starts[open_new]])
        columns = np.concatenate([self._second[open_old], ends[open_new]])
        lengths = np.concatenate([old_lengths[open_old], new_lengths[open_new]])
        size = count + len(extra)
        # A tiny constant keeps edges of length nought in the graph.
        graph = csr_array((lengths + 1e-9, (rows, columns)), shape=(size, size))
        distances, before = dijkstra(
            graph, directed=False, indices=[count], return_predecessors=True
        )
        return distances[0], before[0]

    def _too_close(
        self,
        zone: _Zone,
        lines: NDArray[Any],
        room: Floats,
        starts: NDArray[Any],
        ends: NDArray[Any],
    ) -> NDArray[np.bool_]:
        """Which lines come too close to a zone, from which the `extra` spots have so much room:
        one that begins or ends beside it may be as close as that, if the body is not in it. The
        first spot is where the body is, even if it is partly in it."""
        enough = (room >= self.radius) | (np.arange(len(room)) == 0)
        keep = np.concatenate(
            [np.full(len(self._nodes), self.clearance), np.minimum(room, self.clearance)]
        )
        stands = np.concatenate([np.ones(len(self._nodes), dtype=np.bool_), enough])
        nearest = np.minimum(keep[starts], keep[ends]) - _GRAZE
        return np.asarray(
            (shapely.distance(zone.area, lines) < nearest) | ~(stands[starts] & stands[ends])
        )

    def _join(self, extra: Floats) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
        """Edges from each of the `extra` spots to all nodes and to each other that are clear."""
        count = len(self._nodes)
        starts = np.repeat(np.arange(len(extra)), count)
        ends = np.tile(np.arange(count), len(extra))
        bends = self._bends(extra[starts], ends)
        among, others = np.triu_indices(len(extra), 1)
        starts = np.concatenate([starts[bends], among])
        ends = np.concatenate([ends[bends], others + count])
        lines = _lines(extra[starts], _spots(self._nodes, extra, ends))
        clear = shapely.covers(self._passable, lines)
        return ends[clear], starts[clear] + count, lines[clear]

    def _ways_out(self, spot: Spot, closed: Collection[str]) -> list[Spot]:
        """Just outside of the closed zones that the spot is in or close to: straight across each
        of their sides."""
        here = Point(spot)
        found: list[Spot] = []
        for name in closed:
            zone = self._zones.get(name)
            if zone is None or not zone.wide.covers(here):
                continue
            ring = zone.wide.buffer(_GRAZE, join_style="mitre").exterior.coords
            for side in itertools.pairwise(ring):
                x, y = shapely.shortest_line(LineString(side), here).coords[0]
                if self._passable.covers(Point(x, y)):
                    found.append((float(x), float(y)))
        return found

    def _around(self, discs: Sequence[Disc]) -> list[Spot]:
        reach = 1.02 / math.cos(math.pi / _DISC_CORNERS)
        spots = [
            (
                disc.x + disc.radius * reach * math.cos(angle),
                disc.y + disc.radius * reach * math.sin(angle),
            )
            for disc in discs
            for angle in np.arange(_DISC_CORNERS) * (2 * math.pi / _DISC_CORNERS)
        ]
        return [spot for spot in spots if shapely.intersects_xy(self._passable, *spot)]


# --- geometry ------------------------------------------------------------------------------------


def _grow(piece: BaseGeometry, by: float) -> BaseGeometry:
    # Mitred corners: a few nodes a wall, and room to cut a corner when following the route.
    return piece.buffer(by, cap_style="square", join_style="mitre", mitre_limit=2) if by else piece


def _frame(pieces: Sequence[BaseGeometry]) -> BaseGeometry:
    """A floor without outer walls ends somewhere, too."""
    if not pieces:
        return box(-50, -50, 50, 50)
    return box(*shapely.total_bounds(np.array(pieces, dtype=object))).buffer(5, join_style="mitre")


def _corners(grown: BaseGeometry) -> tuple[Floats, Floats, Floats]:
    """The corners of the obstacles around which a way can bend, each with its two neighbours."""
    none = np.empty((0, 2))
    found: list[tuple[Floats, Floats, Floats]] = [(none, none, none)]
    polygons = grown.geoms if isinstance(grown, MultiPolygon) else [grown]
    for polygon in polygons:
        if polygon.is_empty:
            continue
        oriented = shapely.geometry.polygon.orient(polygon.simplify(_GRAZE / 2))
        for ring in (oriented.exterior, *oriented.interiors):
            here = np.array(ring.coords)[:-1]
            before, after = np.roll(here, 1, axis=0), np.roll(here, -1, axis=0)
            # Oriented rings have the obstacle on their left: left turns stick out.
            sticks_out = _cross(here - before, after - here) > 1e-9
            found.append((here[sticks_out], before[sticks_out], after[sticks_out]))
    here, before, after = (np.concatenate(part) for part in zip(*found, strict=True))
    return here, before, after


def _shares(rows: int, columns: int) -> list[NDArray[Any]]:
    """So many rows in shares that make up to a million pairs each."""
    return np.array_split(np.arange(rows), max(1, rows * columns // _PAIRS_AT_ONCE))


def _cross(a: Floats, b: Floats) -> Floats:
    return np.asarray(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0])


def _lines(starts: Floats, ends: Floats) -> NDArray[Any]:
    return np.asarray(shapely.linestrings(np.stack([starts, ends], axis=1)))


def _spots(nodes: Floats, extra: Floats, which: NDArray[Any]) -> Floats:
    return np.asarray(np.concatenate([nodes, extra])[which])


def _within(area: BaseGeometry, lines: NDArray[Any]) -> Floats:
    """How much of each line lies in the area, in metres."""
    return np.asarray(shapely.length(shapely.intersection(area, lines)))


def _to(area: BaseGeometry, spots: Floats) -> Floats:
    """How far each spot is from the area."""
    return np.asarray(shapely.distance(area, shapely.points(spots)))


def _near(disc: Disc, starts: Floats, ends: Floats) -> NDArray[np.bool_]:
    """Which of the straight edges come nearer to the disc's middle than its radius."""
    middle = np.array([disc.x, disc.y])
    along = ends - starts
    squared = np.maximum((along**2).sum(axis=1), 1e-12)
    share = np.clip(((middle - starts) * along).sum(axis=1) / squared, 0, 1)
    offset = starts + share[:, None] * along - middle
    return np.asarray((offset**2).sum(axis=1) < disc.radius**2)


def _beside(disc: Disc, *ends: Spot) -> Disc | None:
    """The disc, made small enough for a way that starts or ends beside the person."""
    room = min(math.dist(end, (disc.x, disc.y)) for end in ends) - 0.02
    return disc if room >= disc.radius else Disc(disc.x, disc.y, room) if room > 0 else None


def _without_repeats(points: Sequence[Spot]) -> tuple[Spot, ...]:
    kept = [points[0]]
    for point in points[1:]:
        if math.dist(point, kept[-1]) > 1e-6:
            kept.append(point)
    return tuple(kept)
