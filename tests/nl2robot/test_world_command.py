"""From the map of a robot to a world: `nl2robot world`."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from nl2robot.errors import ExitStatus
from nl2robot.paths import data_file
from nl2robot.station.drawn_zones import DrawnZones
from nl2robot.station.named_places import NamedByHand, NamedPlaces
from robot_api.errors import LostConnection
from sim.world.loading import load_world
from sim.world.maps import occupancy
from sim.world.model import Zone

Command = Callable[..., tuple[int, str, str]]


def save(folder: Path, name: str = "floor", **fields: object) -> Path:
    """A room of 8 x 4 m in the unknown, as map_saver of ROS 2 writes it."""
    cells = np.full((120, 200), 205, np.uint8)
    cells[20:100, 20:180] = 0
    cells[22:98, 22:178] = 254
    Image.fromarray(cells).save(folder / f"{name}.pgm")
    values = {
        "image": f"{name}.pgm",
        "mode": "trinary",
        "resolution": 0.05,
        "origin": [-1.5, -1.5, 0],
        "negate": 0,
        "occupied_thresh": 0.65,
        "free_thresh": 0.25,
        **fields,
    }
    file = folder / f"{name}.yaml"
    file.write_text("".join(f"{field}: {value}\n" for field, value in values.items()))
    return file


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_map_becomes_a_world_in_one_command(nl2robot: Command, here: Path) -> None:
    save(here)
    mask = np.full((120, 200), 254, np.uint8)
    mask[60:80, 150:170] = 0
    save(here, "mask")
    Image.fromarray(mask).save(here / "mask.pgm")
    status, out, _ = nl2robot("world", "from-map", "floor.yaml", "--keep-out", "mask.yaml")
    assert status == ExitStatus.OK
    assert "keep-out zones: 1" in out and "29.6 m² of free floor" in out
    assert "nl2robot serve --world floor-world.yaml" in out
    world = load_world("floor-world.yaml")
    assert world.name == "floor" and [zone.name for zone in world.zones] == ["area 1"]
    assert world.start is not None and (world.start.x, world.start.y) == (0, 0)
    assert nl2robot("world", "check", "floor-world.yaml")[0] == ExitStatus.OK
    status, out, _ = nl2robot("run", "--world", "floor-world.yaml", "--yes", "drive 1 m forward")
    assert status == ExitStatus.OK, out


def test_the_world_may_lie_elsewhere_under_any_name(nl2robot: Command, here: Path) -> None:
    (here / "maps").mkdir()
    save(here / "maps")
    out = here / "worlds" / "ours.yaml"
    out.parent.mkdir()
    given = ("world", "from-map", "maps/floor.yaml", "--out", str(out), "--name", 'no: "3"')
    assert nl2robot(*given)[0] == ExitStatus.OK
    assert load_world(out).name == 'no: "3"'
    text = out.read_text()
    assert 'map: "../maps/floor.yaml"\n' in text
    out.write_text(f"{text}places: [{{name: desk, pose: [1, 1]}}]\n")
    status, _, err = nl2robot(*given)
    assert status == ExitStatus.BAD_INPUT and "is there already" in err and "--force" in err
    assert load_world(out).place("desk"), "nothing was overwritten"
    assert nl2robot(*given, "--force")[0] == ExitStatus.OK
    assert load_world(out).places == ()


@pytest.mark.parametrize(
    ("given", "told"),
    [
        (["gone.yaml"], "There is no file gone.yaml"),
        (["floor.pgm"], "floor.pgm is an image. Give the YAML"),
        (["world.yaml"], "world.yaml is no map"),
        (["floor.yaml", "--out", "floor.yaml", "--force"], "is the map itself"),
        (["floor.yaml", "--keep-out", "swapped.yaml"], "swapped.yaml:7: free_thresh is 0.9"),
        (["floor.yaml", "--keep-out", "gone.yaml"], "There is no file gone.yaml"),
        (["swapped.yaml"], "swapped.yaml:7: free_thresh is 0.9"),
        (["nan.yaml"], "nan.yaml:3: The resolution of the map"),
        (["dark.yaml"], "shows no free floor"),
        (["floor.yaml", "--name", "x" * 300], "longer than 200 characters"),
        (["floor.yaml", "--out", "nowhere/world.yaml"], "cannot be used"),
        (["pepper://there"], "Only a robot with ROS gives its map"),
        (["ros2://"], "is no address of a robot"),
    ],
)
def test_bad_input_is_told_in_a_sentence_and_writes_nothing(
    nl2robot: Command, here: Path, given: list[str], told: str
) -> None:
    save(here)
    save(here, "swapped", free_thresh=0.9)
    save(here, "nan", resolution="nan")
    save(here, "dark", negate=1, free_thresh=0.0)
    (here / "world.yaml").write_text("name: ours\nplaces: [{name: desk}]\n")
    before = {file: file.read_bytes() for file in here.iterdir() if file.is_file()}
    status, out, err = nl2robot("world", "from-map", *given)
    assert status == ExitStatus.BAD_INPUT, err
    assert told in err and "Traceback" not in err and not out
    assert {file: file.read_bytes() for file in here.iterdir() if file.is_file()} == before


# --- from a robot --------------------------------------------------------------------------------


@pytest.fixture
def robot(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """A robot with ROS, as `robot_api.robots.ros.grid` reads its map."""
    found: dict[str, Any] = {
        "width": 40,
        "height": 30,
        "resolution": 0.1,
        "origin": SimpleNamespace(x=-1.0, y=-1.5, theta=0.1),
        "cells": [-1] * 40 * 5 + ([100] + [0] * 37 + [60, 100]) * 25,
    }

    def fetch_map(address: object) -> SimpleNamespace:
        if str(address) == "ros2://away:9090":
            raise LostConnection("The robot cannot be reached.")
        return SimpleNamespace(**found)

    for name in ("robot_api.robots.ros", "robot_api.robots.ros.grid"):
        monkeypatch.setitem(sys.modules, name, ModuleType(name))
    sys.modules["robot_api.robots.ros.grid"].fetch_map = fetch_map  # type: ignore[attr-defined]
    return found


def test_a_robot_gives_its_map(nl2robot: Command, here: Path, robot: dict[str, Any]) -> None:
    status, out, err = nl2robot(
        "world", "from-map", "ros2://porter:9090", "--out", "third-floor.yaml"
    )
    assert status == ExitStatus.OK, err
    assert "nl2robot serve --world third-floor.yaml" in out
    world = load_world("third-floor.yaml")
    assert world.name == "third-floor" and world.map is not None
    assert world.map.image == "third-floor-map.pgm"
    cells = np.array(robot["cells"]).reshape(30, 40)
    expected = np.where(cells == 60, -1, cells)  # who knows what stands there
    assert (occupancy(world.map) == expected).all()
    assert world.map.origin == pytest.approx((-1, -1.5, np.degrees(0.1)))


def test_a_robot_that_gives_no_sound_map_is_told_of(
    nl2robot: Command, here: Path, robot: dict[str, Any]
) -> None:
    status, _, err = nl2robot("world", "from-map", "ros2://away:9090")
    assert (status, err) == (ExitStatus.NO_ROBOT, "The robot cannot be reached.\n")
    for field, value, told in (
        ("resolution", float("nan"), "how large its cells are"),
        ("width", 41, "should have 1230 cells, but 1200 came"),
        ("width", 0, "0 x 30 cells"),
        ("origin", SimpleNamespace(x=0, y=float("inf"), theta=0), "does not say where it lies"),
        ("cells", [-1] * 1200, "shows no free floor"),
    ):
        with pytest.MonkeyPatch.context() as patch:
            patch.setitem(robot, field, value)
            status, _, err = nl2robot("world", "from-map", "ros2://porter", "--force")
            assert status == ExitStatus.BAD_INPUT and told in err, err
    assert not (here / "robot-world.yaml").exists()


# --- check ---------------------------------------------------------------------------------------


def test_a_world_is_checked_for_places_nobody_can_drive_to(nl2robot: Command, here: Path) -> None:
    save(here)
    (here / "world.yaml").write_text(
        "name: ours\nmap: floor.yaml\nzones: [{name: shelf, polygon: [3, 0, 4, 1]}]\n"
        "places: [{name: desk, pose: [1, 1]}, {name: wall, pose: [-0.35, 1]},\n"
        "  {name: outside, pose: [8, 4]}, {name: shelf, pose: [3.5, 0.5]}, {name: lab}]\n"
    )
    status, out, _ = nl2robot("world", "check", "world.yaml")
    assert status == ExitStatus.FAILED
    assert '"wall" is so close to a wall' in out
    assert '"outside" is where the map shows no floor' in out
    assert '"shelf" is in the keep-out zone "shelf"' in out
    assert '"desk"' not in out and '"lab"' not in out
    assert nl2robot("world", "check", "ward")[0] == ExitStatus.OK
    (here / "names.yaml").write_text("places: [{name: desk}]\n")
    status, out, _ = nl2robot("world", "check", "names.yaml")
    assert status == ExitStatus.OK and "no geometry" in out
    (here / "bad.yaml").write_text("places:\n- {name: desk}\n- {name: desk}\n")
    assert nl2robot("world", "check", "bad.yaml")[0] == ExitStatus.BAD_INPUT


# --- what was drawn ------------------------------------------------------------------------------

KIOSK = NamedByHand("news kiosk", "shop", (2.0, 1.0, 90.0), {"de": ("Kiosk",), "fr": ("a, b",)})
WET = Zone("wet: floor", ((3.0, 0.0), (4.0, 0.0), (4.0, 1.0)))
HEAD = "name: ours  # the third floor\nmap: floor.yaml\n"
ITEM = "  - {name: desk, pose: [100, 100]}"


@pytest.mark.parametrize(
    "places",
    [
        "",
        "places:\n",
        "places: []\n",
        "places: [{name: desk, pose: [100, 100]}]  # one\n",
        "places: [\n  {name: desk, pose: [100, 100]},  # one\n  # no more\n]\n",
        f"places:\n{ITEM}  # one\n\n# the end\n",
        "places:\n- name: desk\n  pose:\n  - 100\n  - 100\n  aliases:\n    de: [Tisch]\n",
        f"places:\n{ITEM}",
        "places:\n  - name: desk\n    kind: |\n      desk\n",
    ],
)
@pytest.mark.parametrize(
    "end", ["", "people: [{name: Ann}]\nzones:\n  - {name: z, polygon: [1,1,99,99]}\n"]
)
def test_what_was_drawn_goes_into_the_file_that_somebody_wrote(
    nl2robot: Command, here: Path, places: str, end: str
) -> None:
    save(here)
    file = here / "world.yaml"
    tail = end if not places or places.endswith("\n") else f"\n{end}"
    text = f"{HEAD}units: cm\n{places}{tail}"
    file.write_text(text)
    before = load_world(file)
    NamedPlaces().keep(before, (KIOSK,))
    DrawnZones(data_file("zones.yaml")).keep(before, (WET,))
    status, _, err = nl2robot("world", "export", "world.yaml")
    assert status == ExitStatus.OK, err
    after = load_world(file)
    assert after.places == (*before.places, KIOSK.place)
    assert after.zones == (*before.zones, WET)
    assert after.people == before.people
    kept = [line for line in text.splitlines() if "#" in line]
    assert all(line.split("#")[1] in file.read_text() for line in kept), "comments are kept"
    assert NamedPlaces().of(after) == () and DrawnZones(data_file("zones.yaml")).of(after) == ()
    assert "Nothing was drawn" in nl2robot("world", "export", "world.yaml")[1]


def test_what_cannot_be_put_into_the_file_is_kept(nl2robot: Command, here: Path) -> None:
    save(here)
    NamedPlaces().keep(load_world("floor.yaml"), (KIOSK,))
    status, _, err = nl2robot("world", "export", "floor.yaml")
    assert status == ExitStatus.BAD_INPUT and "is a map, and a map has no places" in err
    (here / "flow.yaml").write_text("{name: ours, map: floor.yaml}\n")
    NamedPlaces().keep(load_world("flow.yaml"), (KIOSK,))
    status, _, err = nl2robot("world", "export", "flow.yaml")
    assert status == ExitStatus.BAD_INPUT and "cannot be put into" in err
    assert NamedPlaces().of(load_world("flow.yaml")) == (KIOSK,)
    NamedPlaces().keep(load_world("ward"), (KIOSK,))
    status, _, err = nl2robot("world", "export", "ward")
    assert status == ExitStatus.BAD_INPUT and "Give a file of your own" in err
    assert nl2robot("world", "export", "ward", "--out", "mine.yaml")[0] == ExitStatus.OK
    assert load_world("mine.yaml").place("Kiosk")
    assert NamedPlaces().of(load_world("ward")) == (KIOSK,), "the ward itself has it no more"


def test_a_sentence_knows_what_was_named_on_the_page(nl2robot: Command, here: Path) -> None:
    NamedPlaces().keep(load_world("ward"), (KIOSK,))
    status, out, _ = nl2robot("translate", "--world", "ward", "--json", "go to the news kiosk")
    assert status == ExitStatus.OK and 'robot.goto(\\"news kiosk\\")' in out
