"""The floor map in a browser: what it shows and says, and what one does on it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.console.conftest import Look, Served
from tests.console.test_desk import approve

Picture = Callable[[Page, str], None]


@pytest.fixture
def floor(look: Look) -> Callable[..., Page]:
    """Open the map and wait until it is drawn and told."""

    def open_map(**how: Any) -> Page:
        page = look(**{"path": "/map", **how})
        page.wait_for_function("document.querySelector('#map')?.floorMap")
        expect(page.locator(".floor-told")).not_to_be_empty()
        return page

    return open_map


def pixel(page: Page, x: float, y: float) -> tuple[float, float]:
    """Where a spot in metres is in the window."""
    box = page.locator(".floor-stage").bounding_box()
    assert box is not None
    u, v = page.evaluate(
        "([x, y]) => document.querySelector('#map').floorMap.camera.toScreen(x, y)", [x, y]
    )
    return box["x"] + u, box["y"] + v


def robot_pose(page: Page) -> list[float]:
    found = page.evaluate("document.querySelector('#map').floorMap.robotPose()")
    assert isinstance(found, list)
    return found


def proposed(page: Page, program: str) -> None:
    """The review is there, on the same page, and is of this program."""
    expect(page.get_by_role("button", name="Approve and run")).to_be_enabled()
    expect(page.locator(".desk-editor .cm-content")).to_have_text(program)
    assert page.url.endswith("/map")


def choose(page: Page, mode: str) -> None:
    page.get_by_role("radio", name=mode).check()


def test_the_map_shows_and_says_where_the_robot_is(
    floor: Callable[..., Page], served: Served, picture: Picture
) -> None:
    page = floor()
    told = page.locator(".floor-told")
    expect(told).to_have_attribute("aria-live", "polite")
    with served.robot() as robot:
        robot.localize("pharmacy")
        expect(told).to_contain_text("Robin is here: pharmacy.")
        expect(page.get_by_role("img", name="Robin is here: pharmacy.")).to_be_visible()
        before = robot_pose(page)
        robot.move(0.5)
        page.wait_for_function(
            "([x, y]) => { const pose = document.querySelector('#map').floorMap.robotPose();"
            " return Math.hypot(pose[0] - x, pose[1] - y) > 0.4; }",
            arg=before[:2],
        )
        picture(page, "map")


def test_a_click_on_a_name_sends_there_after_a_review(floor: Callable[..., Page]) -> None:
    page = floor()
    choose(page, "Send")
    page.mouse.click(*pixel(page, *place(page, "ward a")[:2]))
    proposed(page, 'robot.goto("ward a")')
    expect(page.locator(".understood")).to_have_text("Go to ward a.")


@pytest.mark.parametrize("size", [{}, {"width": 390, "height": 844}])
def test_a_click_on_the_floor_is_reviewed_and_run_without_leaving_the_map(
    floor: Callable[..., Page], served: Served, picture: Picture, size: dict[str, int]
) -> None:
    with served.robot() as robot:
        robot.localize("waiting room")
    page = floor(**size)
    choose(page, "Send")
    page.mouse.click(*pixel(page, 5.5, 6.5))  # in the wall between pharmacy and corridor
    expect(page.locator(".understood")).to_have_text("Go to the spot by the door of the pharmacy.")
    expect(page.get_by_role("status").filter(has_text="nearest free spot, 0.")).to_be_visible()
    program = page.locator(".desk-editor .cm-content")
    expect(program).to_contain_text("# by the door of the pharmacy")
    expect(page.get_by_text("It would take")).to_be_visible()
    drawn = "document.querySelector('#map').floorMap"
    approve(page)
    expect(page.locator(".run-panel")).to_have_attribute("data-state", "running")
    picture(page, f"map-send-{page.viewport_size['width']}")  # type: ignore[index]
    expect(page.locator(".run-panel")).to_have_attribute("data-state", "done")
    x, y, _ = page.evaluate(f"{drawn}.robotPose()")
    assert abs(x - 5.5) < 0.3 and 6.7 < y < 7.2
    assert page.url.endswith("/map")
    with served.robot() as robot:
        kept = robot.request("runs.list", {})["runs"][0]
    assert kept["utterance"] == "Go to the spot by the door of the pharmacy."


def test_a_click_in_a_doorway_sends_it_to_where_people_get_through(
    floor: Callable[..., Page], picture: Picture
) -> None:
    page = floor(width=390, height=844)
    choose(page, "Send")
    page.mouse.click(*pixel(page, 3.7, 6.6))  # of the pharmacy
    expect(
        page.get_by_role("status").filter(has_text="people's way through a door")
    ).to_be_visible()
    program = page.locator(".desk-editor .cm-content")
    expect(program).to_contain_text("# by the door of the pharmacy")
    expect(program).to_contain_text(", 7.2")  # a robot's width before the door, in the corridor
    picture(page, "map-doorway")


@pytest.mark.parametrize(
    ("language", "send", "told", "approve"),
    [
        (
            "en",
            "Send",
            'There the robot may not go: it is in the keep-out zone "wet floor".',
            "run",
        ),
        ("de", "Schicken", "Das liegt in der Sperrzone „wet floor“.", "Freigeben"),
        ("fr", "Envoyer", "c'est dans la zone interdite « wet floor ».", "Approuver"),
    ],
)
def test_where_nobody_can_stand_nothing_is_proposed(
    floor: Callable[..., Page], served: Served, language: str, send: str, told: str, approve: str
) -> None:
    with served.robot() as robot:
        around = [[27, 1], [30, 1], [30, 4], [27, 4]]
        robot.request("zones.set", {"name": "wet floor", "polygon": around})
    page = floor(language=language)
    choose(page, send)
    page.mouse.click(*pixel(page, 28.5, 2.5))
    expect(page.get_by_role("alert").filter(has_text=told)).to_be_visible()
    expect(page.get_by_role("button", name=approve)).to_be_hidden()
    with served.robot() as robot:
        robot.request("zones.remove", {"name": "wet floor"})


def test_a_keyboard_moves_the_view_and_sends_the_robot(floor: Callable[..., Page]) -> None:
    page = floor()
    scale = "document.querySelector('#map').floorMap.camera.scale"
    fitted = page.evaluate(scale)
    page.locator(".floor-stage").focus()
    page.keyboard.press("+")
    assert page.evaluate(scale) > fitted
    left = pixel(page, 20, 10)[0]
    page.keyboard.press("ArrowRight")
    assert pixel(page, 20, 10)[0] < left
    page.keyboard.press("0")
    assert page.evaluate(scale) == fitted
    page.get_by_role("radio", name="Look").focus()
    page.keyboard.press("ArrowRight")
    expect(page.get_by_text("Click where the robot should go.")).to_be_visible()
    page.get_by_role("button", name="pharmacy", exact=True).focus()
    page.keyboard.press("Enter")
    proposed(page, 'robot.goto("pharmacy")')


def test_the_robot_is_dragged_to_where_it_stands(
    floor: Callable[..., Page], served: Served
) -> None:
    with served.robot() as robot:
        robot.localize("lobby")
        page = floor()
        choose(page, "Locate")
        drag(page, robot_pose(page)[:2], (10.0, 7.7))
        expect(page.locator(".floor-told")).to_contain_text("main corridor")
        where = robot.location()
        assert abs(where.x - 10.0) < 0.2 and abs(where.y - 7.7) < 0.2
        drag(page, robot_pose(page)[:2], (0.05, 0.05))
        expect(page.get_by_role("alert").filter(has_text="There is no room")).to_be_visible()
        assert abs(robot.location().x - 10.0) < 0.2
        changes = page.locator(".floor-changes li:visible")
        expect(changes.first).to_contain_text("robot set from lobby to main corridor")
        changes.first.get_by_role("button", name="Undo").click()
        expect(changes.first).to_contain_text("taken back: from main corridor to lobby")
        assert robot.location().place == "lobby"


def test_a_zone_is_drawn_and_kept_and_removed(floor: Callable[..., Page], picture: Picture) -> None:
    page, other = floor(), floor()
    choose(page, "Zones")
    drag(page, (1.0, 10.0), (3.5, 12.0))
    page.get_by_label("Name of the zone").fill("wet floor")
    page.get_by_role("button", name="Keep the robot out", exact=True).click()
    choose(other, "Zones")
    expect(other.get_by_role("button", name="Remove wet floor")).to_be_visible()
    picture(page, "map-zones")
    page.reload()
    page.wait_for_function("document.querySelector('#map')?.floorMap")
    choose(page, "Zones")
    page.get_by_role("button", name="Remove wet floor").click()
    expect(page.get_by_text("No keep-out zones yet")).to_be_visible()
    expect(other.get_by_text("No keep-out zones yet")).to_be_visible()
    other.get_by_text("Who changed what").locator("visible=true").click()
    changes = other.locator(".floor-changes li:visible")
    expect(changes.first).to_contain_text("“wet floor” removed")
    picture(other, "map-undo")
    changes.first.get_by_role("button", name="Undo").click()
    expect(changes.first).to_contain_text("“wet floor” brought back")
    expect(page.get_by_role("button", name="Remove wet floor")).to_be_visible()
    page.get_by_role("button", name="Remove wet floor").click()


def test_a_run_is_watched_again_frame_by_frame(floor: Callable[..., Page]) -> None:
    page = floor()
    page.evaluate(
        "() => { const map = document.querySelector('#map').floorMap;"
        " map.showPath([[3, 3], [9, 3]]); map.showAt({...map.floor.now, x: 3, y: 3, people: []}); }"
    )
    expect(page.locator(".floor-told")).to_have_text("Robin is here: pharmacy.")
    assert robot_pose(page)[:2] == [3, 3]
    page.evaluate("document.querySelector('#map').floorMap.showAt(null)")
    expect(page.locator(".floor-told")).to_contain_text("13 people.")


def test_what_is_hidden_stays_hidden(floor: Callable[..., Page]) -> None:
    page = floor()
    page.get_by_label("What to show").click()
    page.get_by_label("Laser scanner").uncheck()
    page.reload()
    page.wait_for_function("document.querySelector('#map')?.floorMap")
    page.get_by_label("What to show").click()
    expect(page.get_by_label("Laser scanner")).not_to_be_checked()
    expect(page.get_by_label("Objects")).to_be_checked()


def test_who_only_looks_on_sees_the_map_and_can_do_nothing(
    floor: Callable[..., Page], served: Served
) -> None:
    address, token = served.observer_url.split("/?")
    page = floor(url=address, path=f"/map?{token}")
    expect(page.get_by_role("radio")).to_have_count(0)
    expect(page.get_by_role("button", name="Zoom in")).to_be_visible()


def test_it_fits_a_phone_in_the_dark_in_german(
    floor: Callable[..., Page], picture: Picture
) -> None:
    page = floor(width=390, height=844, dark=True, language="de")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    expect(page.get_by_role("button", name="Apotheke", exact=True)).to_be_visible()
    assert page.evaluate(CORNER) != page.evaluate(f"{LIGHT}; {CORNER}")
    picture(page, "map-phone-dark")


LIGHT = "document.documentElement.dataset.look = 'light'"
CORNER = """new Promise((answer) => requestAnimationFrame(() => requestAnimationFrame(() => {
  const map = document.querySelector('#map').floorMap;
  const dense = window.devicePixelRatio;
  const [u, v] = map.camera.toScreen(1.2, 1.2).map((pixels) => pixels * dense);
  answer(`${map.planCanvas.getContext('2d').getImageData(u, v, 1, 1).data}`);
})))"""
"""The colour of a spot in the pharmacy, once it is drawn."""


def place(page: Page, name: str) -> list[float]:
    """The pose of a place."""
    found = page.evaluate(
        "(name) => document.querySelector('#map').floorMap.floor.places"
        ".find((place) => place.name === name).pose",
        name,
    )
    assert isinstance(found, list)
    return found


def drag(page: Page, start: Any, end: Any) -> None:
    """With the mouse, from one spot in metres to another."""
    page.mouse.move(*pixel(page, *start))
    page.mouse.down()
    page.mouse.move(*pixel(page, *end), steps=8)
    page.mouse.up()
