"""The live floor: `scene.floor` tells what stays as it is, the event `scene` what moves.

Ten times a second, while somebody watches, one look at the simulation becomes one frame for all who
watch; a frame that tells nothing new is not sent. A robot that is not simulated is known by its
events alone: its poses, and what its lidar measures if it has one. There the frames hold no people.
"""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Mapping, Sequence
from typing import Any, Final

from nl2robot.console.floor.plan import floor_plan
from nl2robot.console.visitor import LANGUAGES, texts
from nl2robot.station.part import Backstage, Part
from nl2robot.wire import service
from robot_api.driver import Event, StopFlag
from robot_api.errors import RobotError
from sim.view import ThingSeen, View

PERIOD: Final = 0.08
"""Seconds between two frames, so that ten a second are there even if some come late."""
TRAIL_STEP: Final = 0.15
"""Metres between two points of the trail."""
TRAIL_POINTS: Final = 600
LEAP: Final = 3.0
"""Metres that nobody drives between two poses: the robot was carried, and a new trail begins."""
FAR: Final = 10_000
"""Centimetres that stand for nothing in reach of the lidar."""
MOST_PEOPLE: Final = 40
"""Of a frame; a crowd would make it slow to send, and nobody could read the names."""

Frame = dict[str, Any]

EVENTS: Mapping[str, str] = {
    "scene": "time, x, y (metres), theta (degrees), speed (m/s), place, way [[x, y]] ahead,"
    " lidar [centimetres], people [[name, kind, x, y, theta, posture]], things that were moved"
    " [[number, x, y, holder: name | true for the robot | null]], closed [numbers of doors],"
    " holding [names]; at most 12 a second, once `scene.floor` was called",
}


def part(backstage: Backstage) -> Part:
    """The floor and what moves on it, for maps."""
    stage = Scene(backstage)
    return Part(
        services={
            "scene.floor": service(
                lambda p: stage.floor(p.get("language", "en")),
                "Tell what the floor looks like, the robot's trail, the scene as it is now, and the"
                " map's texts.",
                {"language": {"enum": list(LANGUAGES)}},
                observes=True,
                result=dict[str, Any],
            )
        },
        events=EVENTS,
        close=stage.close,
    )


class Scene:
    """Looks at the floor for all who watch it."""

    def __init__(self, backstage: Backstage) -> None:
        self._backstage = backstage
        self._pose: Event = {}
        self._lidar: Sequence[int] = ()
        self._trail: deque[tuple[float, float]] = deque(maxlen=TRAIL_POINTS)
        simulation = backstage.simulation
        self._things: Sequence[ThingSeen] = simulation.view().things if simulation else ()
        """Where the things were at first; frames tell of those that are elsewhere."""
        self._sent: Frame | None = None
        self._closed = threading.Event()
        self._unsubscribe = backstage.subscribe(self._hear)
        self._ticker: threading.Thread | None = None
        self._starting = threading.Lock()

    def floor(self, language: str) -> dict[str, Any]:
        """What a map needs before its first frame, and that frame."""
        if self._backstage.simulation is None and not self._pose:
            self._ask_pose()
        self._start()
        plan = floor_plan(self._backstage.runner.knowledge.world, self._things)
        return {
            **plan,
            "trail": list(self._trail),
            "now": self._frame(),
            "words": texts("map", language),
        }

    def close(self) -> None:
        """Look no more."""
        self._closed.set()
        self._unsubscribe()
        if self._ticker is not None:
            self._ticker.join()

    def _start(self) -> None:
        """Look from now on; before anybody has asked for the floor nobody can draw a frame."""
        with self._starting:
            if self._ticker is None and not self._closed.is_set():
                self._ticker = threading.Thread(
                    target=self._tell, name="console scene", daemon=True
                )
                self._ticker.start()

    def _hear(self, kind: str, data: Event) -> None:
        if kind == "lidar":
            self._lidar = [FAR if each is None else round(100 * each) for each in data["metres"]]
        if kind != "pose":
            return
        self._pose = data
        spot = (round(data["x"], 2), round(data["y"], 2))
        trail = self._trail
        far = math.dist(trail[-1], spot) if trail else math.inf
        if far > LEAP:
            trail.clear()
        if far >= TRAIL_STEP:
            trail.append(spot)

    def _ask_pose(self) -> None:
        """A robot that stands still since before we came has sent no pose."""
        try:
            where = self._backstage.driver.call("location", {}, StopFlag())
        except RobotError:
            return  # a map without the robot is better than none
        self._pose = {"x": where.x, "y": where.y, "theta": where.theta, "place": where.place}

    def _tell(self) -> None:
        while not self._closed.wait(PERIOD):
            if not self._backstage.wanted("scene"):
                self._sent = None
                continue
            frame = self._frame()
            news = {**frame, "time": None}  # time alone is no news
            if news != self._sent:
                self._sent = news
                self._backstage.publish("scene", frame)

    def _frame(self) -> Frame:
        simulation = self._backstage.simulation
        if simulation is not None:
            return frame_of_view(simulation.view(), self._things)
        return frame_of_pose(self._pose, self._lidar)


def frame_of_view(view: View, things: Sequence[ThingSeen]) -> Frame:
    """The frame of a simulated floor; `things` as they were at first."""
    robot = view.robot
    before = {thing.number: thing for thing in things}
    return {
        "time": view.time,
        "x": round(robot.x, 3),
        "y": round(robot.y, 3),
        "theta": round(robot.theta, 1),
        "speed": round(robot.speed, 2),
        "place": robot.place,
        "way": view.way,
        "lidar": [round(100 * metres) for metres in view.lidar],
        "people": view.people[:MOST_PEOPLE],
        "things": [thing for thing in view.things if before.get(thing.number) != thing],
        "closed": view.closed,
        "holding": robot.holding,
    }


def frame_of_pose(pose: Event, lidar: Sequence[int] = ()) -> Frame:
    """The frame of a robot of which only the pose and the lidar are known, or nothing yet."""
    return {
        "time": pose.get("time"),
        "x": pose.get("x"),
        "y": pose.get("y"),
        "theta": pose.get("theta"),
        "speed": pose.get("speed", 0.0),
        "place": pose.get("place"),
        "way": (),
        "lidar": lidar,
        "people": (),
        "things": (),
        "closed": None,
        "holding": (),
    }
