"""What every page says of a robot that is lost, and of a stop that it has not confirmed."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Page, expect

from robot_api.errors import StopNotConfirmed
from tests.console.conftest import Look, Picture, Served, serving
from tests.robots.far_robot import FarPackage

PAGES = ("/", "/map", "/drive", "/runs")
UNCONFIRMED = "The robot has not confirmed that it stands. Use its own button!"


@pytest.fixture(scope="module")
def far(tmp_path_factory: pytest.TempPathFactory) -> Iterator[FarPackage]:
    far = FarPackage(tmp_path_factory.mktemp("far"))
    yield far
    far.close()


@pytest.fixture(scope="module")
def served(far: FarPackage, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """The console of a real robot, as `nl2robot serve --robot far://porter` starts it."""
    before = dict(os.environ)
    os.environ.update(far.environment)
    try:
        with serving(tmp_path_factory.mktemp("home"), "--robot", "far://porter") as served:
            yield served
    finally:
        os.environ.clear()
        os.environ.update(before)


@pytest.fixture(autouse=True)
def well_again(far: FarPackage) -> Iterator[None]:
    yield
    far.tell("confirm")
    far.tell("be found")


def state(page: Page) -> Callable[..., None]:
    return lambda words: expect(page.locator("#robot-state")).to_contain_text(words)


def test_a_lost_robot_is_seen_on_every_page_and_found_again(
    look: Look, far: FarPackage, picture: Picture
) -> None:
    pages = [look(path) for path in PAGES]
    for page in pages:
        expect(page.locator("#connection")).to_have_attribute("data-state", "connected")
        expect(page.locator("#robot-state")).to_be_hidden()
    far.tell("be lost")
    for page in pages:
        state(page)("The robot cannot be reached since ")
        expect(page.locator("#connection")).to_have_attribute("data-state", "lost")
    picture(pages[0], "desk-lost")
    late = look("/drive", language="de")
    state(late)("Der Roboter ist seit ")
    far.tell("be found")
    for page in [*pages, late]:
        expect(page.locator("#robot-state")).to_be_hidden()
        expect(page.locator("#connection")).to_have_attribute("data-state", "connected")
    expect(pages[0].locator("#notice")).to_have_text(
        "The robot can be reached again. Nothing was taken up again."
    )


def test_a_stop_that_is_not_confirmed_is_said_to_everybody_until_one_is(
    look: Look, far: FarPackage, served: Served
) -> None:
    desk, onlooker = look("/"), look("/map", language="fr")
    far.tell("confirm nothing")
    desk.get_by_role("button", name="STOP", exact=True).click()
    state(desk)(UNCONFIRMED)
    state(onlooker)("Le robot n'a pas confirmé qu'il est à l'arrêt.")
    expect(desk.locator("#notice")).to_be_hidden()
    late = look("/runs")
    state(late)(UNCONFIRMED)
    far.tell("confirm")
    desk.get_by_role("button", name="STOP", exact=True).click()
    for page in (desk, onlooker, late):
        expect(page.locator("#robot-state")).to_be_hidden()
    expect(desk.locator("#notice")).to_have_text("The robot was stopped.")


def test_whoever_types_stop_is_told_the_truth(look: Look, far: FarPackage) -> None:
    desk = look("/")
    far.tell("confirm nothing")
    desk.get_by_role("textbox", name="Tell the robot what to do").fill("stop")
    desk.keyboard.press("Enter")
    expect(desk.locator(".said.by-robot").last).to_contain_text(UNCONFIRMED.split("!")[0][:40])
    far.tell("confirm")
    desk.get_by_role("textbox", name="Tell the robot what to do").fill("stop")
    desk.keyboard.press("Enter")
    expect(desk.locator(".said.by-robot").last).to_contain_text("The robot stands still.")


def test_the_face_says_it_to_whoever_stands_before_it(
    look: Look, far: FarPackage, served: Served, picture: Picture
) -> None:
    face = look("/face")
    expect(face.locator("body")).to_have_attribute("data-ready", "yes")
    alarm = face.locator("#alarm")
    expect(alarm).to_be_hidden()
    far.tell("confirm nothing")
    with served.robot() as robot, pytest.raises(StopNotConfirmed):
        robot.stop()
    expect(alarm).to_have_text("I do not know whether I stand. Use the button on me!")
    late = look("/face")
    expect(late.locator("#alarm")).to_be_visible()
    far.tell("be lost")
    expect(alarm).to_contain_text("My body cannot be reached since ")
    picture(face, "face-lost")
    far.tell("confirm")
    far.tell("be found")
    with served.robot() as robot:
        robot.stop()
    expect(alarm).to_be_hidden()
    expect(late.locator("#alarm")).to_be_hidden()


def test_the_pages_cope_with_a_robot_that_is_not_simulated(look: Look, served: Served) -> None:
    faults: list[str] = []
    for path in (*PAGES, "/face"):
        page = look(path)
        page.on("pageerror", lambda error: faults.append(str(error)))
        page.wait_for_load_state("networkidle")
    desk = look("/")
    desk.get_by_role("textbox", name="Tell the robot what to do").fill("say good morning")
    desk.keyboard.press("Enter")
    desk.get_by_role("button", name="Approve and run").click()
    expect(desk.locator("#run-panel .chip[role=status]")).to_have_text("Done")
    assert faults == []
    expect(look("/map").locator("canvas").first).to_be_visible()
