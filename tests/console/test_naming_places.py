"""Naming places on the map of a robot: the whole way, in a browser."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from playwright.sync_api import Page, expect

from sim.world.loading import load_world
from tests.console.conftest import Look, Served, serving
from tests.console.test_map import choose, drag, pixel
from tests.console.test_map import floor as floor  # a fixture

Picture = Callable[[Page, str], None]


def a_map(folder: Path) -> Path:
    """Two rooms and a corridor of 12 x 8 m, as a robot's map_server saved them."""
    cells = np.full((200, 280), 205, np.uint8)
    cells[20:180, 20:260] = 0
    cells[22:178, 22:258] = 254
    cells[98:100, 22:258] = 0
    cells[22:98, 139:141] = 0
    cells[98:100, 70:90] = cells[98:100, 190:210] = 254
    cells[140:160, 120:150] = 205
    Image.fromarray(cells).save(folder / "floor.pgm")
    file = folder / "world.yaml"
    file.write_text(
        "name: third floor\n"
        "map: {image: floor.pgm, resolution: 0.05, origin: [-1, -1, 0], free_thresh: 0.25}\n"
        "robot: {start: [1.5, 1.5]}\n"
    )
    return file


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("floor")
    with serving(folder / "home", "--speed", "1", "--world", str(a_map(folder))) as served:
        yield served


def name_here(page: Page, name: str, kind: str = "", aliases: str = "") -> None:
    page.get_by_label("Name of the place").fill(name)
    page.get_by_label("Kind").fill(kind)
    page.get_by_label("Also called").fill(aliases)
    page.get_by_role("button", name="Keep the place").click()


def test_a_place_is_named_moved_taken_along_and_removed(
    floor: Callable[..., Page], look: Look, served: Served, picture: Picture, tmp_path: Path
) -> None:
    page, other = floor(), floor()
    choose(page, "Places")
    expect(page.get_by_text("No places named here yet")).to_be_visible()

    page.mouse.click(*pixel(page, 3.0, 5.5))
    name_here(page, "Alice's office", aliases="the den, snug")
    change = page.get_by_role("button", name="Change Alice's office")
    expect(change).to_be_visible()
    drag(page, (9.0, 5.5), (9.0, 6.5))  # which way to face
    name_here(page, "ward b", kind="ward")
    expect(page.get_by_role("button", name="Change ward b")).to_be_visible()
    picture(page, "map-places")

    # Whoever looks sees it, and a sentence and the robot know it.
    expect(other.get_by_role("button", name="ward b", exact=True)).to_be_visible()
    with served.robot() as robot:
        assert {"Alice's office", "ward b"} <= set(robot.places())
        robot.localize("snug")
        assert robot.location().place == "Alice's office"
        robot.localize("ward b")
        assert abs(robot.location().theta - 90) < 3
    desk = look("/?program=" + "robot.goto(%22ward%20b%22)")
    expect(desk.get_by_text("ward b").first).to_be_visible()

    # A wall is no place; what is unknown is none either.
    page.mouse.click(*pixel(page, -0.6, 3.0))
    name_here(page, "nowhere")
    expect(page.get_by_role("alert").filter(has_text="There the robot has no room")).to_be_visible()
    page.get_by_role("button", name="Discard").click()

    drag(page, (3.0, 5.5), (4.5, 6.0))
    page.wait_for_function(
        "document.querySelector('#map').floorMap.floor.places"
        '.some(({name, pose}) => name === "Alice\'s office" && pose[0] > 4)'
    )
    change.click()
    expect(page.get_by_label("Also called")).to_have_value("the den, snug")
    page.get_by_label("Name of the place").fill("office")
    page.get_by_role("button", name="Keep the place").click()
    expect(page.get_by_role("button", name="Change office")).to_be_visible()

    with page.expect_download() as download:
        page.get_by_role("button", name="Save as a world file").click()
    file = tmp_path / "taken.yaml"
    download.value.save_as(file)
    taken = load_world(file, names_only=True)
    assert [place.name for place in taken.places] == ["ward b", "office"]
    assert taken.place("the den") is not None

    page.get_by_role("button", name="Remove ward b").click()
    expect(other.get_by_role("button", name="ward b", exact=True)).to_have_count(0)
    page.reload()
    page.wait_for_function("document.querySelector('#map')?.floorMap")
    choose(page, "Places")
    expect(page.get_by_role("button", name="Change office")).to_be_visible()
    page.get_by_role("button", name="Remove office").click()
    expect(page.get_by_text("No places named here yet")).to_be_visible()


def test_places_are_there_after_a_new_start(tmp_path: Path) -> None:
    world = a_map(tmp_path)
    options = ("--world", str(world))
    with serving(tmp_path / "home", *options) as served, served.robot() as robot:
        robot.request("places.set", {"name": "kiosk", "x": 3, "y": 5.5})
    with serving(tmp_path / "home", *options) as served, served.robot() as robot:
        assert robot.places() == ["kiosk"]
        robot.localize("kiosk")


def test_it_fits_a_phone_in_the_dark_in_french(
    floor: Callable[..., Page], picture: Picture
) -> None:
    page = floor(width=390, height=844, dark=True, language="fr", has_touch=True)
    choose(page, "Lieux")
    page.touchscreen.tap(*pixel(page, 3.0, 5.5))
    expect(page.get_by_label("Nom du lieu")).to_be_visible()
    page.get_by_label("Nom du lieu").fill("accueil")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    picture(page, "map-places-phone-dark")
    page.get_by_role("button", name="Garder le lieu").click()
    page.get_by_role("button", name="Supprimer accueil").click()
    expect(page.get_by_text("Aucun lieu nommé ici")).to_be_visible()


def test_the_unknown_is_drawn_as_such(floor: Callable[..., Page]) -> None:
    page = floor()
    unknown, free = page.evaluate(
        """new Promise((answer) => requestAnimationFrame(() => requestAnimationFrame(() => {
          const map = document.querySelector('#map').floorMap;
          const dense = window.devicePixelRatio;
          answer([[5.7, 1.6], [3, 5.5]].map(([x, y]) => {
            const [u, v] = map.camera.toScreen(x, y).map((pixels) => pixels * dense);
            return `${map.planCanvas.getContext('2d').getImageData(u, v, 1, 1).data}`;
          }));
        })))"""
    )
    assert (unknown, free) == ("213,218,222,255", "244,243,239,255")
