"""Keep-out zones drawn on the map are kept, told to everybody, and hold."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from nl2robot.console.floor import zones
from nl2robot.knowledge import Knowledge
from nl2robot.station.part import Backstage
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall
from robot_api.robots.places import Places
from robot_api.server import Context
from sim.simulation import Simulation
from sim.world.loading import load_world
from sim.world.model import World, Zone

SQUARE = [[4, 1], [6, 1], [6, 2], [4, 2]]


class Console:
    """The part by itself, as one start of the server has it."""

    def __init__(self, world: World, real: bool = False, places: Places | None = None) -> None:
        self.published: list[tuple[str, Any]] = []
        self.simulation = None if real else Simulation(world)
        backstage = SimpleNamespace(
            runner=SimpleNamespace(knowledge=Knowledge(world)),
            simulation=self.simulation,
            places=places,
            publish=lambda kind, data: self.published.append((kind, data)),
        )
        self.part = zones.part(cast(Backstage, backstage))

    def __call__(self, method: str, **params: Any) -> list[dict[str, Any]]:
        context = Context("tester", StopFlag(), lambda kind, data, to=None: None)
        answer: list[dict[str, Any]] = self.part.services[method].handler(params, context)
        return answer

    def names(self) -> list[str]:
        return [zone["name"] for zone in self("zones.list")]


@pytest.fixture
def start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Console]:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path))
    return Console


def test_a_zone_that_is_drawn_holds_at_once_and_after_a_new_start(start) -> None:
    world = load_world("ward")
    console = start(world)
    assert console("zones.list") == []
    told = console("zones.set", name=" wet  floor ", polygon=SQUARE)
    assert told == [{"name": "wet floor", "polygon": SQUARE, "removable": True}]
    assert console.published == [("zones", {"zones": told, "history": console("zones.history")})]
    assert console.simulation.world.zone_at(5, 1.5).name == "wet floor"

    again = start(world)
    assert again.names() == ["wet floor"]
    assert again.simulation.world.zone_at(5, 1.5).name == "wet floor"
    assert start(load_world("city-hospital")).names() == []

    assert again("zones.set", name="Wet Floor", polygon=[[1, 1], [2, 1], [2, 2]])[0]["name"] == (
        "Wet Floor"
    )
    assert again("zones.remove", name="wet floor") == []
    assert start(world).names() == []


@pytest.mark.parametrize(
    ("name", "polygon", "told"),
    [
        ("x", [[0, 0], [2, 2], [2, 0], [0, 2.1]], '"x" crosses itself'),
        ("x", [[0, 0], [0.1, 0], [0, 0.1]], "smaller than"),
        ("x", [[0, 0], [1, 0]], "fewer than three corners"),
        ("x", [[0, 0], [math.inf, 0], [1, 1]], "no point"),
        ("x", [[math.cos(i), math.sin(i)] for i in range(200)], "more than 100 corners"),
        ("  ", SQUARE, "needs a name"),
        ("x" * 100, SQUARE, "needs a name"),
        ("a\x1b[2J", SQUARE, "needs a name"),
    ],
)
def test_what_is_no_zone_is_refused_in_a_sentence(start, name, polygon, told) -> None:
    console = start(load_world("ward"))
    with pytest.raises(InvalidCall, match=told):
        console("zones.set", name=name, polygon=polygon)
    assert console.names() == [] and not console.published


def test_zones_of_the_file_are_listed_and_stay(start, tmp_path) -> None:
    file = tmp_path / "my.yaml"
    file.write_text(
        "places: [{name: here, pose: [1, 1]}]\nzones: [{name: store, polygon: [4, 4, 6, 6]}]\n"
    )
    console = start(load_world(file))
    console("zones.set", name="wet floor", polygon=SQUARE)
    assert [(zone["name"], zone["removable"]) for zone in console("zones.list")] == [
        ("store", False),
        ("wet floor", True),
    ]
    for method, more in (("zones.remove", {}), ("zones.set", {"polygon": SQUARE})):
        with pytest.raises(InvalidCall, match="in the world's file"):
            console(method, name="Store", **more)


def test_removing_what_is_not_there_says_so(start) -> None:
    with pytest.raises(InvalidCall, match='no keep-out zone "lobby"'):
        start(load_world("ward"))("zones.remove", name="lobby")


@pytest.mark.parametrize(
    "text",
    [
        "worlds: [",
        "worlds: {ward: [{name: x}]}",
        "worlds: {ward: [{name: x, polygon: [[0, 0], [2, 2], [2, 0], [0, 2.1]]}]}",
        "worlds: {ward: [{name: x, polygon: [[.nan, 0], [2, 2], [2, 0]]}]}",
        "\x00",
        "[" * 5000,
        "worlds: 3",
    ],
)
def test_a_damaged_file_is_left_alone_and_told_to_who_draws(start, tmp_path, caplog, text) -> None:
    file = tmp_path / "zones.yaml"
    file.write_text(text)
    console = start(load_world("ward"))
    assert "Mend the file" in caplog.text
    assert console.names() == []
    with pytest.raises(InvalidCall, match="cannot be read from"):
        console("zones.set", name="x", polygon=SQUARE)
    assert file.read_text() == text


def test_there_is_an_end_to_zones(start) -> None:
    console = start(load_world("ward"))
    full = tuple(Zone(str(i), ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0))) for i in range(50))
    zones.DrawnZones(zones.data_file("zones.yaml")).keep(load_world("ward"), full)
    with pytest.raises(InvalidCall, match="50 keep-out zones already"):
        console("zones.set", name="one more", polygon=SQUARE)
    console("zones.set", name="7", polygon=SQUARE)


def test_a_real_robot_is_told_of_zones_as_they_are_drawn(start) -> None:
    places, told = Places(), []
    places.on_keep_out(lambda: told.append(list(places.keep_out)))
    console = start(load_world("ward"), real=True, places=places)
    console("zones.set", name="stairs", polygon=SQUARE)
    assert console.names() == ["stairs"] and told[-1] == [tuple(map(tuple, SQUARE))]
    again = Places()
    again.on_keep_out(lambda: None)
    start(load_world("ward"), real=True, places=again)
    assert again.keep_out == told[-1], "a new start knows them"
    console("zones.remove", name="stairs")
    assert told[-1] == [] == places.keep_out


def test_a_robot_that_goes_by_no_map_is_kept_out_by_its_own_software(start) -> None:
    console = start(load_world("ward"), real=True, places=Places())
    assert console("zones.list") == []
    with pytest.raises(InvalidCall, match="software that drives it"):
        console("zones.set", name="x", polygon=SQUARE)


def test_who_did_what_is_kept_and_taken_back_after_a_new_start(start) -> None:
    world = load_world("ward")
    console = start(world)
    console("zones.set", name="wet floor", polygon=SQUARE, who="Ruth")
    console("zones.set", name="wet floor", polygon=[[1, 1], [2, 1], [2, 2]], who="Karim")
    console("zones.remove", name="Wet Floor", who="Lea")
    console = start(world)
    told = console("zones.history")
    assert [(each["who"], each["what"], each["undoable"]) for each in told] == [
        ("Lea", "removed", True),
        ("Karim", "changed", False),
        ("Ruth", "drawn", False),
    ]
    assert all(abs(each["when"] - time.time()) < 60 for each in told)

    removed, changed, drawn = (each["number"] for each in told)
    with pytest.raises(InvalidCall, match="changed again since"):
        console("zones.undo", change=drawn, who="Ruth")
    assert console("zones.undo", change=removed, who="Ruth")[0]["polygon"][0] == [1, 1]
    assert console.simulation.world.zone_at(1.9, 1.5).name == "wet floor"
    undoable = [each["number"] for each in console("zones.history") if each["undoable"]]
    assert undoable == [removed + 1, changed], "what was just undone, and what came before it"
    assert console("zones.undo", change=changed, who="Ruth")[0]["polygon"] == SQUARE
    assert console("zones.undo", change=drawn, who="Ruth") == []
    last = console("zones.history")[0]
    assert (last["who"], last["what"], last["undoes"]) == ("Ruth", "removed", drawn)
    assert console("zones.undo", change=last["number"])[0]["name"] == "wet floor", "undone itself"
    with pytest.raises(InvalidCall, match="too long ago"):
        console("zones.undo", change=99)


def test_only_the_newest_changes_are_kept(start) -> None:
    console = start(load_world("ward"))
    for _ in range(zones.CHANGES_KEPT):
        console("zones.set", name="wet floor", polygon=SQUARE)
        console("zones.remove", name="wet floor")
    told = console("zones.history")
    assert len(told) == zones.CHANGES_KEPT
    assert told[0]["number"] == 2 * zones.CHANGES_KEPT


def test_observers_only_look(start) -> None:
    services = start(load_world("ward")).part.services
    observed = {name for name, service in services.items() if service.observes}
    assert observed == {"zones.list", "zones.history"}
