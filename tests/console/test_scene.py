"""The live floor without a browser: what stays, what moves, and when nothing is told."""

from __future__ import annotations

import queue
import threading
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest
from PIL import Image

from nl2robot.console.floor.plan import floor_plan
from nl2robot.console.floor.scene import LEAP, Scene, frame_of_view, part
from nl2robot.console.visitor import LANGUAGES, texts
from nl2robot.station.part import Backstage
from robot_api.drivers import emulated, simulated
from sim.errors import Interrupted
from sim.simulation import Simulation
from sim.world.loading import load_world

SOON = 20.0
HOSPITAL = load_world("city-hospital")


class Watched:
    """A scene with somebody who watches it, or not."""

    def __init__(self, simulation: Simulation | None, driver: Any, world: Any = HOSPITAL) -> None:
        self.frames: queue.Queue[dict[str, Any]] = queue.Queue()
        self.asked = threading.Semaphore(0)
        self.watching = True
        self.backstage = Backstage(
            driver=driver,
            runner=SimpleNamespace(knowledge=SimpleNamespace(world=world)),  # type: ignore[arg-type]
            talks=None,  # type: ignore[arg-type]
            proposals=None,  # type: ignore[arg-type]
            simulation=simulation,
            publish=lambda kind, data, to=None: self.frames.put(dict(data)),
            wanted=self._wanted,
            stop=lambda because: None,
        )
        driver.subscribe(self.backstage.tell)
        self.scene = Scene(self.backstage)

    def _wanted(self, kind: str) -> bool:
        assert kind == "scene"
        self.asked.release()
        return self.watching

    def looks(self, times: int) -> None:
        """Wait until it has been looked so often whether somebody watches."""
        for _ in range(times):
            assert self.asked.acquire(timeout=SOON)

    def frame(self) -> dict[str, Any]:
        return self.frames.get(timeout=SOON)

    def until(self, wanted: Any) -> dict[str, Any]:
        while not wanted(frame := self.frame()):
            pass
        return frame


@pytest.fixture
def simulation() -> Iterator[Simulation]:
    with Simulation(HOSPITAL, seed=1) as simulation:
        yield simulation


@pytest.fixture
def still(simulation: Simulation) -> Iterator[Watched]:
    """A simulation in which time passes only when something is asked of the robot."""
    watched = Watched(simulation, simulated(simulation))
    yield watched
    watched.scene.close()


def never() -> threading.Event:
    return threading.Event()


def test_the_floor_has_everything_with_its_names_in_every_language() -> None:
    plan = floor_plan(HOSPITAL)
    pharmacy = next(place for place in plan["places"] if place["name"] == "pharmacy")
    assert pharmacy["names"] == {"de": "Apotheke", "fr": "pharmacie"}
    assert len(pharmacy["area"]) >= 4 and len(pharmacy["pose"]) == 3
    assert plan["bounds"] == (0, 0, 40, 25)
    assert len(plan["walls"]) > 20 and len(plan["furniture"]) > 20
    entrance = next(door for door in plan["doors"] if door["name"] == "main entrance")
    assert not entrance["open"]


def test_a_part_of_a_room_is_told_from_a_room_of_its_own() -> None:
    parts = {place["name"]: place["part"] for place in floor_plan(HOSPITAL)["places"]}
    assert parts["charger"] and not parts["pharmacy"]


def test_of_a_map_s_image_the_known_floor_is_shown(tmp_path: Path) -> None:
    cells = np.full((120, 200), 205, np.uint8)  # unknown
    cells[20:100, 20:180] = 254
    Image.fromarray(cells).save(tmp_path / "floor.pgm")
    file = tmp_path / "map.yaml"
    file.write_text("image: floor.pgm\nresolution: 0.05\norigin: [0, 0, 0]\n")
    plan = floor_plan(load_world(file))
    assert len(plan["ground"]) == 1
    assert plan["bounds"] == pytest.approx((1, 1, 9, 5), abs=0.1)


def test_the_map_has_the_same_texts_in_every_language() -> None:
    keys = [set(texts("map", language)) for language in LANGUAGES]
    assert keys[0] == keys[1] == keys[2]


def test_a_frame_is_small(simulation: Simulation) -> None:
    things = simulation.view().things
    simulation.run(simulation.drive_to(20.5, 8.0), never())
    frame = frame_of_view(simulation.view(), things)
    assert len(frame["people"]) == 13 and len(frame["lidar"]) == 36
    assert len(msgspec.json.encode(frame)) < 1500


def test_things_are_told_when_they_are_not_where_they_were(simulation: Simulation) -> None:
    simulation.run(simulation.find("stapler"), never())
    things = simulation.view().things
    simulation.run(simulation.grab("stapler"), never())
    frame = frame_of_view(simulation.view(), things)
    (moved,) = frame["things"]
    assert HOSPITAL.objects[moved.number].name == "stapler"
    assert moved.holder is True
    assert frame["holding"] == ["stapler"]


def test_a_door_that_is_closed_is_told(simulation: Simulation) -> None:
    before = simulation.view().closed
    simulation.set_door(1, False)
    assert set(simulation.view().closed) == {*before, 1}


def test_the_way_ahead_leads_to_the_goal_and_ends_there(simulation: Simulation) -> None:
    ways = []
    simulation.subscribe(lambda kind, data: ways.append(simulation.view().way))
    simulation.run(simulation.drive_to(20.5, 4.2), never())
    assert ways[0][-1] == (20.5, 4.2)
    assert simulation.view().way == ()


def test_a_stop_ends_the_way(simulation: Simulation) -> None:
    stop = threading.Event()
    simulation.subscribe(lambda kind, data: stop.set())
    with pytest.raises(Interrupted):
        simulation.run(simulation.drive_to(20.5, 4.2), stop)
    assert simulation.view().way == ()


def test_nothing_is_told_twice(still: Watched) -> None:
    still.scene.floor("en")
    assert still.frame()["place"] == "charger"
    still.looks(3)
    assert still.frames.empty()


def test_what_moves_is_told(still: Watched) -> None:
    still.scene.floor("en")
    first = still.frame()
    simulation = still.backstage.simulation
    assert simulation is not None
    simulation.run(simulation.move(0.5), never())
    assert still.until(lambda frame: frame["x"] != first["x"])


def test_nobody_looks_before_somebody_asked_or_while_nobody_watches(still: Watched) -> None:
    assert not still.asked.acquire(blocking=False)
    still.watching = False
    still.scene.floor("en")
    still.looks(3)
    assert still.frames.empty()
    still.watching = True
    assert still.frame()["place"] == "charger"


def test_who_comes_later_sees_the_trail(still: Watched) -> None:
    simulation = still.backstage.simulation
    assert simulation is not None
    simulation.run(simulation.drive_to(20.5, 4.2), never())
    floor = still.scene.floor("de")
    assert len(floor["trail"]) > 10
    assert floor["now"]["place"] == "lobby"
    assert floor["words"]["title"] == "Karte"


def test_a_robot_that_is_carried_leaves_no_trail_across_the_floor(still: Watched) -> None:
    tell = still.backstage.tell
    tell("pose", {"x": 1.0, "y": 1.0})
    tell("pose", {"x": 1.5, "y": 1.0})
    tell("pose", {"x": 1.5 + 2 * LEAP, "y": 1.0})
    assert still.scene.floor("en")["trail"] == [(1.5 + 2 * LEAP, 1.0)]


def test_a_robot_that_is_not_simulated_is_known_by_its_pose() -> None:
    driver = emulated(log=lambda line: None)
    watched = Watched(None, driver)
    try:
        now = watched.scene.floor("en")["now"]
        assert now["x"] is not None  # it was asked where it is
        assert now["people"] == () and now["lidar"] == ()
        watched.backstage.tell("pose", {"x": 3.0, "y": 2.0, "theta": 90.0, "place": "pharmacy"})
        frame = watched.until(lambda frame: frame["x"] == 3.0)
        assert frame["place"] == "pharmacy" and frame["closed"] is None
        watched.backstage.tell("lidar", {"metres": [1.5, None]})
        assert watched.until(lambda frame: len(frame["lidar"]) == 2)["lidar"] == [150, 10_000]
    finally:
        watched.scene.close()


def test_the_part_may_be_watched_by_observers(simulation: Simulation) -> None:
    watched = Watched(simulation, simulated(simulation))
    watched.scene.close()
    scene = part(watched.backstage)
    assert scene.services["scene.floor"].observes
    assert set(scene.events) == {"scene"}
    scene.close()
