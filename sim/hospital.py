"""The state of the simulated hospital and what one step does to it.

The behaviours (`driving`, `company`, `searching`, `handling`, `talking`) act on a `Hospital`; a
`sim.simulation.Simulation` runs them. Everything here happens in the thread that has the turn.
"""

from __future__ import annotations

import collections
import functools
import math
import random
from collections.abc import Callable, Generator
from datetime import datetime
from typing import TYPE_CHECKING, Any

import msgspec

from sim.errors import NotPossible, UnknownPlace
from sim.people.crowd import Home, Human
from sim.physics.bodies import BORDER_WIDTH, STEP, Physics
from sim.physics.navigation import Chart, Spot
from sim.physics.placing import Item, free_spot, people_at_start, things_at_start
from sim.physics.robot import Robot, RobotState
from sim.record import Happening, Record, Sample
from sim.snapshot import Snapshot
from sim.world.geometry import GridMap, Segment, map_corners
from sim.world.maps import free_floor
from sim.world.model import Person, Place, World, Zone
from sim.world.starts import beginning

if TYPE_CHECKING:
    from shapely.geometry.base import BaseGeometry

Listener = Callable[[str, dict[str, Any]], None]

RAYS, REACH = 36, 8.0
"""Of the lidar: how many, and how many metres."""
PERSON_RADIUS = 0.25
MAX_SEGMENTS = 50_000
"""Of walls and a map's outlines; with more, finding ways between them would take minutes."""

_LEAST_FEELER = 1e-3
_TO_BORDER = BORDER_WIDTH / 2 + 1e-3
"""Metres between the robot and a zone whose border it just does not touch."""
_SCAN_EVERY = 6  # steps: ten times a second
_SAMPLE_EVERY = 12
_MOST_SAMPLES = 60_000  # more than three hours of driving; then the oldest go


class Hospital:
    """Everything there is, at one moment. Raises `NotPossible` if the world has no geometry, or
    more than can be driven in."""

    def __init__(self, world: World, seed: int, start: datetime | None) -> None:
        pose = world.start
        if pose is None:
            raise NotPossible(
                f"The world {world.name} has no map to drive on. "
                "Give its places a pose, or choose another world."
            )
        if len(world.walls) > MAX_SEGMENTS:
            raise NotPossible(
                f"The map of {world.name} has too many specks to find ways between. "
                "Clean its image, or scale it down."
            )
        self.world = world
        self.start = beginning(world, start)
        self.random = random.Random(seed)
        self.steps = 0
        self.leapt = 0
        """How many of the steps were leapt over."""
        self.chart: Chart = chart_of(world)
        """Another one when the zones are drawn anew."""
        if not self.chart.is_floor(pose.x, pose.y):
            raise NotPossible(
                f"The robot cannot start at {pose.x:g}, {pose.y:g} in {world.name}: there the map "
                "shows no floor. Let it start on free floor."
            )
        self.open_doors = [door.open for door in world.doors]
        self.physics = self._new_physics()
        self.robot = Robot(
            self.physics.add_robot(pose.x, pose.y, world.robot.radius),
            pose.theta,
            world.robot.battery,
        )
        self._keep_out()
        self.items: list[Item] = things_at_start(world, self.chart)
        self.people: list[Human] = []
        for person, placing in people_at_start(world, self.chart):
            human = self.add_person(person, placing.x, placing.y, placing.theta, placing.posture)
            human.home = Home(placing.x, placing.y, placing.theta, placing.posture)
        self.known_closed: dict[str, float] = {}
        self.last_seen: dict[str, str] = {}
        """By the name of a thing or a person, the place where the robot saw it last."""
        """Doors that the robot has found closed, and when."""
        self.trail: list[Spot] = []
        """Where the robot has driven since it began to guide somebody."""
        self.met: dict[str | None, set[str]] = {}
        """By place, whom and what `wait_for` has met there."""
        self.partner: str | None = None
        """The person whom the robot deals with: the last it met, found or talked with."""
        self.newcomers = 0
        self._begin()

    def _new_physics(self) -> Physics:
        closed = [
            door.ends
            for door, is_open in zip(self.world.doors, self.open_doors, strict=True)
            if not is_open
        ]
        return Physics(
            self.world.walls,
            self.world.wall_thickness,
            [piece.outline for piece in self.world.furniture if piece.outline],
            closed,
        )

    def _begin(self) -> None:
        self.events: collections.deque[tuple[str, dict[str, Any]]] = collections.deque()
        self._told_battery = -1
        self._told_charging = False
        self._told_moving = False
        self._sampled: object = None
        self.record = Record(self.world.name, tuple(human.name for human in self.people))
        self._scan: list[float] = []
        self._scanned = -1
        self._sample()

    @classmethod
    def of(cls, snapshot: Snapshot, chart: Chart | None = None) -> Hospital:
        """As it was, with a record of its own that begins now; what is in the snapshot is its own
        from then on. `chart` is that of the snapshot's world, if there is one."""
        self = cls.__new__(cls)
        self.world, self.start, self.steps = snapshot.world, snapshot.start, snapshot.steps
        self.chart = chart or chart_of(snapshot.world)
        self.leapt = 0
        self.random = random.Random()
        self.random.setstate(snapshot.chance)
        self.open_doors = snapshot.open_doors
        self.physics = self._new_physics()
        robot_body = self.physics.add_robot(
            *snapshot.robot_moves.position, snapshot.world.robot.radius
        )
        robot_body.resume(snapshot.robot_moves)
        self.robot = snapshot.robot.copy(robot_body)
        self._keep_out()
        self.items = snapshot.items
        self.people = []
        for human, motion in zip(snapshot.people, snapshot.people_move, strict=True):
            body = self.physics.add_person(*motion.position, PERSON_RADIUS)
            body.resume(motion)
            self.people.append(human.copy(body))
        self.known_closed = snapshot.known_closed
        self.last_seen = snapshot.last_seen
        self.trail = snapshot.trail
        self.met = snapshot.met
        self.partner = snapshot.partner
        self.newcomers = snapshot.newcomers
        self._begin()
        return self

    def add_person(self, person: Person, x: float, y: float, theta: float, posture: str) -> Human:
        """Let somebody be there from now on."""
        body = self.physics.add_person(x, y, PERSON_RADIUS)
        human = Human(len(self.people), person, body, theta, posture)
        human.busy_until = self.time + self.random.uniform(1.0, 15.0)
        self.people.append(human)
        return human

    # --- time ------------------------------------------------------------------------------------

    @property
    def time(self) -> float:
        return self.steps * STEP

    def step(self) -> None:
        """Let one step pass."""
        self.steps += 1
        steps, robot = self.steps, self.robot
        robot.step()
        for human in self.people:
            human.step(self)
        self.physics.step()
        if self._in_zones:
            self._keep_out()
        if steps % _SCAN_EVERY == 0:
            self._tell_pose()
        robot.use_energy(self._on_charger())
        if steps % _SAMPLE_EVERY == 0:
            self._sample()

    def rest(self) -> None:
        self.robot.rest()
        self._tell_pose()  # who watches a stop need not wait for the next tenth of a second

    def wait(self, seconds: float) -> Generator[None, None, None]:
        """A behaviour that does nothing for so long."""
        end = self.time + seconds
        while self.time < end - STEP / 2:
            yield

    def leap(self, seconds: float) -> None:
        """Let time pass at once: nobody moves meanwhile, the battery does its part."""
        steps = round(seconds / STEP)
        self.steps += steps
        self.leapt += steps
        self.robot.use_energy(self._on_charger(), steps)

    def _on_charger(self) -> bool:
        charger = self.world.charger
        if charger is None or charger.pose is None:
            return False
        return math.dist(self.robot.position, (charger.pose.x, charger.pose.y)) < 0.3

    @property
    def lidar(self) -> list[float]:
        """What the laser scanner sees, ten times a second; looked for when somebody asks."""
        number = self.steps // _SCAN_EVERY
        if number != self._scanned:
            robot, self._scanned = self.robot, number
            x, y = robot.position
            self._scan = self.physics.lidar(
                x, y, math.radians(robot.theta), RAYS, REACH, robot.body.radius
            )
        return self._scan

    # --- what is told and written down -----------------------------------------------------------

    def emit(self, kind: str, data: dict[str, Any]) -> None:
        """Tell those who subscribed, and put it into the record (but for poses and the log)."""
        self.events.append((kind, data))
        if kind not in ("pose", "log"):
            self.note(kind, data)

    def note(self, kind: str, data: dict[str, Any]) -> None:
        """Put it into the record alone."""
        x, y = self.robot.position
        self.record.happenings.append(
            Happening(round(self.time, 3), kind, data, round(x, 3), round(y, 3))
        )

    def _tell_pose(self) -> None:
        robot = self.robot
        if robot.moving or self._told_moving:
            x, y = robot.position
            place = self.world.place_at(x, y)
            self.emit(
                "pose",
                {
                    "x": round(x, 3),
                    "y": round(y, 3),
                    "theta": round(robot.theta, 1),
                    "place": place.name if place else None,
                    "speed": round(robot.speed, 3),
                    "time": round(self.time, 3),
                },
            )
        self._told_moving = robot.moving
        percent = int(robot.battery)
        if percent != self._told_battery or robot.charging != self._told_charging:
            told_before = self._told_battery >= 0
            self._told_battery, self._told_charging = percent, robot.charging
            if told_before:
                self.emit("battery", {"percent": percent, "charging": robot.charging})

    def _sample(self) -> None:
        x, y = self.robot.position
        where = (round(x, 3), round(y, 3), round(self.robot.theta, 1))
        people = tuple([(round(px, 2), round(py, 2)) for px, py in map(_position, self.people)])
        if (where, people) == self._sampled:
            return
        samples = self.record.samples
        if self._sampled is not None and samples and self.time - samples[-1].time > 0.5:
            # Everybody stood still until now.
            samples.append(_again(samples[-1], self.time - _SAMPLE_EVERY * STEP))
        self._sampled = (where, people)
        samples.append(Sample(round(self.time, 3), *where, people))
        if len(samples) > _MOST_SAMPLES:
            del samples[: _MOST_SAMPLES // 4]

    def new_record(self) -> Record:
        """Close the record and begin another."""
        ended, self.record = (
            self.record,
            Record(self.world.name, tuple(human.name for human in self.people)),
        )
        self._sampled = None
        self._sample()
        return ended

    # --- where things are ------------------------------------------------------------------------

    def robot_state(self) -> RobotState:
        robot = self.robot
        x, y = robot.position
        place = self.world.place_at(x, y)
        return RobotState(
            x=x,
            y=y,
            theta=robot.theta,
            place=place.name if place else None,
            speed=abs(robot.speed),
            battery=robot.battery,
            charging=robot.charging,
            holding=[self.items[number].thing.name for number in robot.holding],
            emotion=robot.emotion,
            joints=dict(robot.joints),
            volume=robot.volume,
            language=robot.language,
            screen=dict(robot.screen),
        )

    @property
    def place(self) -> Place | None:
        """The place that the robot is in."""
        return self.world.place_at(*self.robot.position)

    def place_named(self, name: str) -> Place:
        place = self.world.place(name)
        if place is None:
            raise UnknownPlace(
                f'There is no place called "{name}" on this map. '
                "Choose one of the places that the map names."
            )
        return place

    def locate(self, name: str) -> tuple[float, float, float]:
        """Where the robot stands when it is there: x, y, theta."""
        place = self.place_named(name)
        pose = self.pose_of(place)
        if pose is None:
            raise UnknownPlace(
                f"The map does not show where {place.name} is. "
                "Choose another place, or give it a pose in the world's file."
            )
        return pose

    def pose_of(self, place: Place) -> tuple[float, float, float] | None:
        if place.pose is not None:
            return place.pose.x, place.pose.y, place.pose.theta
        if place.area:
            x = sum(corner[0] for corner in place.area) / len(place.area)
            y = sum(corner[1] for corner in place.area) / len(place.area)
            spot = self.chart.nearest_free(x, y)
            return (*spot, 0.0) if spot else None
        around = self.world.place(place.inside) if place.inside else None
        return self.pose_of(around) if around is not None and around is not place else None

    def here(self, x: float, y: float) -> bool:
        """Whether a spot is where the robot is: in the same room, or, where the map knows no
        rooms, in sight within the lidar's reach."""
        robot = self.robot.position
        mine, theirs = self.world.areas_at(*robot), self.world.areas_at(x, y)
        if mine and theirs and mine[0] == theirs[0]:
            return True
        if (mine or theirs) and not set(mine) & set(theirs):
            return False
        return math.dist(robot, (x, y)) <= REACH and self.physics.sees(robot, (x, y))

    def name_of_spot(self, x: float, y: float) -> str:
        """How to speak of a spot."""
        place = self.world.place_at(x, y)
        return place.name if place else f"the point {x:.1f}, {y:.1f}"

    # --- the floor as it is now ------------------------------------------------------------------

    def localize(self, x: float, y: float, theta: float) -> None:
        if not self.chart.fits(x, y):
            raise NotPossible(
                f"There is no room for the robot at {x:.1f}, {y:.1f}. Give a spot on free floor."
            )
        self.robot.body.place(x, y)
        self.robot.rest()
        self.robot.theta = theta
        self.physics.lift_borders()
        self._keep_out()
        self._scanned = -1
        self._told_moving = True

    def set_zones(self, zones: tuple[Zone, ...], chart: Chart) -> None:
        """Keep the robot out of these zones and no others; `chart` is that of a world with them."""
        self.world, self.chart = msgspec.structs.replace(self.world, zones=zones), chart
        self.physics.lift_borders()
        self._keep_out()

    def _keep_out(self) -> None:
        """Raise the borders of all zones that the robot is not in. Of one that it is in it may
        leave: in part, and it comes no deeper; with its middle, and it drives as it likes."""
        body, raised = self.robot.body, self.physics.borders()
        room = {zone.polygon: self.chart.to_zone(gate, *body.position) for gate, zone in self.zones}
        outside = {zone for zone, metres in room.items() if metres > 0}
        for zone in raised - outside:
            self.physics.lift_border(zone)
        for zone in outside - raised:
            self.physics.raise_border(zone)
        fits = min((room[zone] for zone in outside), default=math.inf) - _TO_BORDER
        grows = body.feeler if outside <= raised else _LEAST_FEELER
        body.feeler = min(body.radius, max(fits, grows))
        self._in_zones = any(metres < body.radius + _TO_BORDER for metres in room.values())

    @property
    def zones(self) -> list[tuple[str, Zone]]:
        """The keep-out zones, each with its name as a gate of the chart."""
        return [(f"zone {i}", zone) for i, zone in enumerate(self.world.zones)]

    def set_door(self, number: int, is_open: bool) -> None:
        ends = self.world.doors[number].ends
        self.open_doors[number] = is_open
        if is_open:
            self.physics.open_door(ends)
        else:
            self.physics.close_door(ends)

    def closed_doors(self) -> set[str]:
        """The gates of the chart that nobody can pass."""
        return {f"door {i}" for i, is_open in enumerate(self.open_doors) if not is_open}

    def gate_name(self, gate: str) -> str:
        """How to speak of a gate of the chart."""
        kind, _, number = gate.partition(" ")
        if kind != "door":
            return f'the keep-out zone "{self.world.zones[int(number)].name}"'
        door = self.world.doors[int(number)]
        if door.name:
            return door.name
        return f"the door of {door.at}" if door.at else "a door"

    def free_spot(self, x: float, y: float, nearest: float, farthest: float) -> Spot | None:
        """A spot around x, y in the same room where a person can stand free of all others."""
        others = [human.position for human in self.people]
        return free_spot(
            self.world, self.chart, (x, y), [*others, self.robot.position], nearest, farthest
        )


def _position(human: Human) -> tuple[float, float]:
    return human.position


def _again(sample: Sample, time: float) -> Sample:
    return Sample(round(time, 3), sample.x, sample.y, sample.theta, sample.people)


def chart_of(world: World) -> Chart:
    """The free floor of a world; made once."""
    return _with_zones(
        _build_chart(
            world.walls,
            world.wall_thickness,
            tuple(piece.outline for piece in world.furniture if piece.outline),
            tuple(door.ends for door in world.doors),
            max(world.robot.radius, PERSON_RADIUS),
            world.map,
            world.drawn_walls,
        ),
        world.keep_out,
    )


@functools.lru_cache(maxsize=8)
def _with_zones(chart: Chart, zones: tuple[tuple[Spot, ...], ...]) -> Chart:
    return chart.with_zones({f"zone {i}": corners for i, corners in enumerate(zones)})


@functools.lru_cache(maxsize=8)
def _build_chart(
    walls: tuple[tuple[float, float, float, float], ...],
    thickness: float,
    furniture: tuple[tuple[Spot, ...], ...],
    doors: tuple[tuple[float, float, float, float], ...],
    radius: float,
    grid: GridMap | None,
    drawn: tuple[Segment, ...],
) -> Chart:
    return Chart(
        walls,
        furniture,
        {f"door {i}": ends for i, ends in enumerate(doors)},
        thickness=thickness,
        radius=radius,
        floor=None if grid is None else _floor(grid, drawn),
    )


def _floor(grid: GridMap, drawn: tuple[Segment, ...]) -> BaseGeometry:
    """What the map shows to be free, and what walls drawn beside it stand around: of the map, what
    is unknown is no floor."""
    import shapely

    shown = free_floor(grid)
    if not drawn:
        return shown
    around = shapely.MultiLineString([((a, b), (c, d)) for a, b, c, d in drawn]).envelope
    return shown | (around - shapely.Polygon(map_corners(grid)))
