"""Places named on the map are kept, told to everybody, and known to sentences and to the robot."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from PIL import Image

from nl2robot.console.floor import places, zones
from nl2robot.knowledge import Knowledge
from nl2robot.station.named_places import with_named_places
from nl2robot.station.part import Backstage
from nl2robot.translate.translation import translate
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall
from robot_api.robots.places import Places
from robot_api.server import Context
from sim.simulation import Simulation
from sim.world.loading import load_world
from sim.world.model import World


class Console:
    """The part by itself, as one start of the server has it."""

    def __init__(self, world: World, real: bool = False) -> None:
        self.published: list[tuple[str, Any]] = []
        world = with_named_places(world)  # as `nl2robot serve` does
        self.simulation = None if real else Simulation(world)
        self.knowledge = Knowledge(world)
        self.driver = Places() if real else None
        backstage = cast(
            Backstage,
            SimpleNamespace(
                runner=SimpleNamespace(knowledge=self.knowledge),
                simulation=self.simulation,
                places=self.driver,
                publish=lambda kind, data: self.published.append((kind, data)),
            ),
        )
        self.services = {
            **zones.part(backstage).services,
            **places.part(backstage).services,
        }

    def __call__(self, method: str, **params: Any) -> Any:
        context = Context("tester", StopFlag(), lambda kind, data, to=None: None)
        return self.services[method].handler(params, context)

    def names(self) -> list[str]:
        return [place["name"] for place in self("places.list") if place["removable"]]


@pytest.fixture
def start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Console]:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path / "home"))
    return Console


def test_a_place_is_known_at_once_and_after_a_new_start(start) -> None:
    console = start(load_world("ward"))
    assert translate("go to the kiosk", console.knowledge).program is None
    told = console("places.set", name=" news  kiosk ", x=6, y=1.2, aliases={"de": ["Kiosk", " "]})
    assert told["moved"] == 0
    (kind, data) = console.published[-1]
    assert kind == "places" and data["places"] == told["places"]
    for again in (console, start(load_world("ward"))):
        assert again.names() == ["news kiosk"]
        assert translate("go to the kiosk", again.knowledge).program == 'robot.goto("news kiosk")\n'
        assert translate("fahr zum Kiosk", again.knowledge, "de").status == "ok"
        again.simulation.run(again.simulation.drive_to(*again.simulation.locate("Kiosk")), stop())
        assert again.simulation.robot.place == "news kiosk"
        twin = again.simulation.copy()
        assert twin.locate("news kiosk") == (6, 1.2, 0), "dry runs know it as well"
    assert start(load_world("city-hospital")).names() == []


def test_a_place_is_moved_renamed_and_removed(start) -> None:
    console = start(load_world("ward"))
    console("places.set", name="kiosk", kind="Shop", x=6, y=1.2, theta=-90, aliases={"fr": ["x"]})
    console("places.set", name="kiosk", was="kiosk", kind="shop", x=7, y=1.2)
    (place,) = (place for place in console("places.list") if place["removable"])
    assert place["pose"] == [7, 1.2, 270] and place["aliases"] == {"fr": ("x",)}
    assert place["kind"] == "shop"
    console("places.set", name="newsstand", was="kiosk", x=7, y=1.2, aliases={})
    assert console.names() == ["newsstand"]
    assert console.knowledge.world.place("kiosk") is None
    with pytest.raises(InvalidCall, match='Nobody named a place "kiosk"'):
        console("places.set", name="a", was="kiosk", x=7, y=1.2)
    console("places.remove", name="Newsstand")
    assert console.names() == [] and console.knowledge.world.place("newsstand") is None
    with pytest.raises(InvalidCall, match='Nobody named a place "newsstand"'):
        console("places.remove", name="newsstand")
    with pytest.raises(InvalidCall, match="in the world's file"):
        console("places.remove", name="ward a")


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"name": "  "}, "The place needs a name"),
        ({"name": "a\x1b[2J"}, "needs a name"),
        ({"name": "x" * 61}, "at most 60 letters"),
        ({"name": "Ward A"}, 'goes by "Ward A" already. Choose'),
        ({"name": "Hallway"}, 'goes by "Hallway" already, the place "corridor"'),
        ({"aliases": {"de": ["Flur"]}}, 'goes by "Flur" already, the place "corridor"'),
        ({"kind": "a\nb\x00"}, "The kind needs a name"),
        ({"x": math.nan}, "no spot on this map"),
        ({"x": 1e9}, "no spot on this map"),
        ({"theta": math.inf}, "no number"),
        ({"x": -3}, "no way there"),
        ({"x": 60}, "no room"),
        ({"x": 10.2, "y": 0.6}, 'in the keep-out zone "wet floor"'),
    ],
)
def test_what_is_no_place_is_refused_in_a_sentence(start, given, told) -> None:
    console = start(load_world("ward"))
    wet = [[9.5, 0.2], [11, 0.2], [11, 1.5], [9.5, 1.5]]
    console("zones.set", name="wet floor", polygon=wet)
    console.published.clear()
    with pytest.raises(InvalidCall, match=told):
        console("places.set", **{"name": "kiosk", "x": 6, "y": 1.2, **given})
    assert console.names() == [] and not console.published


def test_a_click_on_a_wall_is_put_beside_it(start) -> None:
    console = start(load_world("ward"))
    told = console("places.set", name="notice board", x=6, y=0.02)
    assert 0.2 < told["moved"] <= 0.6
    x, y, _ = console.simulation.locate("notice board")
    assert (x, y) == pytest.approx((6, 0.4), abs=0.1)
    console.simulation.run(console.simulation.drive_to(x, y), stop())


def test_on_a_map_the_unknown_is_no_place(start, tmp_path) -> None:
    cells = np.full((100, 200), 205, np.uint8)
    cells[10:90, 10:100] = 254
    Image.fromarray(cells).save(tmp_path / "floor.pgm")
    file = tmp_path / "world.yaml"
    file.write_text("name: hall\nmap: {image: floor.pgm, resolution: 0.05, origin: [0, 0, 0]}\n")
    console = start(load_world(file))
    with pytest.raises(InvalidCall, match="where the map shows no floor"):
        console("places.set", name="kiosk", x=8, y=2.5)
    console("places.set", name="kiosk", x=3, y=2.5)
    assert console.names() == ["kiosk"]


def test_the_driver_of_a_real_robot_is_told(start) -> None:
    console = start(load_world("ward"), real=True)
    console("places.set", name="kiosk", x=6, y=1.2, theta=90, aliases={"de": ["Bude"]})
    kiosk = console.driver.named["kiosk"]
    assert (kiosk.goal.x, kiosk.goal.y, kiosk.goal.theta) == (6, 1.2, 90)
    assert kiosk.aliases == ("Bude",) and "ward a" in console.driver.named
    console("places.remove", name="kiosk")
    assert "kiosk" not in console.driver.named
    assert translate("go to the kiosk", console.knowledge).program is None


def test_the_worlds_own_file_comes_first(start, tmp_path) -> None:
    file = tmp_path / "my.yaml"
    text = "name: my\nplaces:\n  - {name: here, pose: [1, 1]}\n"
    file.write_text(text)
    console = start(load_world(file))
    console("places.set", name="kiosk", x=3, y=1)
    exported = console("places.export")
    assert exported["file"] == "my.yaml"
    assert exported["text"] == f"{text}  - {{name: kiosk, pose: [3, 1, 0]}}\n"
    file.write_text(exported["text"])
    again = start(load_world(file))
    assert again.names() == [], "it is in the file now"
    assert again.knowledge.world.place("kiosk") is not None
    assert [place["name"] for place in again("places.list")] == ["here", "kiosk"]


@pytest.mark.parametrize(
    "text",
    [
        "worlds: [",
        "worlds: {ward: [{name: x}]}",
        "worlds: {ward: [{name: x, kind: x, pose: [.nan, 0, 0]}]}",
        "worlds: {ward: [{name: '', kind: x, pose: [1, 0, 0]}]}",
        "other: {}",
        "\x00",
        "[" * 5000,
        "worlds: 3",
    ],
)
def test_a_damaged_file_is_left_alone_and_told_to_who_names(start, tmp_path, caplog, text) -> None:
    file = tmp_path / "home" / "places.yaml"
    file.parent.mkdir()
    file.write_text(text)
    console = start(load_world("ward"))
    assert "Mend the file" in caplog.text
    assert console.names() == []
    with pytest.raises(InvalidCall, match="cannot be read from"):
        console("places.set", name="x", x=6, y=1.2)
    assert file.read_text() == text


def test_observers_only_look(start) -> None:
    services = start(load_world("ward")).services
    observed = {name for name, service in services.items() if service.observes}
    assert observed == {"zones.list", "zones.history", "places.list", "places.export"}


def stop() -> threading.Event:
    return threading.Event()
