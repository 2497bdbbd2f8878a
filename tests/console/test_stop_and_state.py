"""STOP above everything, and the one state of the robot on every page at once."""

from __future__ import annotations

from contextlib import suppress
from queue import SimpleQueue

import pytest
from playwright.sync_api import Page, expect

from robot_api.client import Robot
from robot_api.errors import Stopped
from tests.console.conftest import Look, Picture, Served
from tests.console.test_desk import approve, read_all

PAGES = ("/", "/map", "/drive", "/runs")
ROUND = 'robot.goto("ward a")\nrobot.goto("ward b")\n'


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    from tests.console.conftest import serving

    with serving(tmp_path_factory.mktemp("home"), "--world", "ward", "--speed", "1") as served:
        yield served


@pytest.fixture(autouse=True)
def _at_rest(served: Served) -> None:
    """Each story begins with a robot that stands by its charger."""
    with served.robot() as robot:
        robot.stop()
        robot.localize("charger")


def runs(robot: Robot, program: str) -> int:
    sha256 = robot.request("program.check", {"program": program})["sha256"]
    approval = robot.request(
        "program.approve", {"program": program, "sha256": sha256, "by": "Nurse Kim"}
    )
    run: int = robot.request("program.run", {"approval": approval["id"]})
    return run


def badge(page: Page, text: str) -> None:
    expect(page.locator("#robot-badge")).to_have_text(text)


@pytest.fixture
def running(served: Served):
    """A program that drives; stopped at the end."""
    with served.robot() as robot:
        run = runs(robot, ROUND)
        yield run
        robot.stop()
        with suppress(Stopped):  # a stop breaks off these calls, too
            present = robot.request("program.state")
            robot.request("program.wait", {"run": present["run"]})


def stands(served: Served, run: int) -> None:
    with served.robot() as robot:
        assert robot.request("program.wait", {"run": run, "timeout": 10})["state"] == "stopped"
        assert robot.request("station.state")["state"] == "stopped"


@pytest.mark.parametrize("path", [*PAGES, "/face"])
def test_stop_is_the_first_thing_that_the_keyboard_comes_to(look: Look, path: str) -> None:
    page = look(path)
    expect(page.locator("#stop")).to_be_visible()
    page.evaluate("document.body.tabIndex = -1; document.body.focus()")  # as if just opened
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.id") == "stop"


def opened_settings(page: Page) -> None:
    page.get_by_role("button", name="Settings").click()
    expect(page.locator("#settings")).to_be_visible()
    page.get_by_label("Your name").fill("Nurse Kim, who is still typing")


@pytest.mark.parametrize("path", PAGES)
def test_stop_lies_above_the_settings(
    look: Look, served: Served, running: int, path: str, picture: Picture
) -> None:
    page = look(path)
    badge(page, "Running")
    place = page.locator("#stop").bounding_box()
    opened_settings(page)
    assert place is not None
    page.mouse.click(place["x"] + place["width"] / 2, place["y"] + place["height"] / 2)
    stands(served, running)
    expect(page.locator("#settings")).to_be_visible()
    expect(page.get_by_label("Your name")).to_have_value("Nurse Kim, who is still typing")
    picture(page, "stop-above-settings")


def test_stop_lies_above_the_settings_for_a_finger(
    look: Look, served: Served, running: int
) -> None:
    page = look("/", width=390, height=844, has_touch=True, is_mobile=True)
    badge(page, "Running")
    opened_settings(page)
    place = page.locator("#settings > .stop").bounding_box()
    assert place is not None and place["height"] >= 44
    page.touchscreen.tap(place["x"] + place["width"] / 2, place["y"] + place["height"] / 2)
    stands(served, running)
    expect(page.locator("#settings")).to_be_visible()


@pytest.mark.parametrize("keys", [("Escape",), ("Home", "Space")])
def test_the_keys_stop_with_the_settings_open(
    look: Look, served: Served, running: int, keys: tuple[str, ...]
) -> None:
    page = look("/drive")
    badge(page, "Running")
    opened_settings(page)
    if keys == ("Escape",):
        page.keyboard.press("Escape")
    else:  # from the first field back to what stands before it
        page.locator("#language").focus()
        page.keyboard.press("Shift+Tab")
        assert page.evaluate("document.activeElement.className").startswith("stop")
        page.keyboard.press("Space")
    stands(served, running)


def test_the_state_is_the_same_everywhere_at_once(look: Look, served: Served) -> None:
    pages = [look(path) for path in PAGES]
    face = look("/face")
    expect(face.locator("body")).to_have_attribute("data-ready", "yes")
    with served.robot() as robot:
        run = runs(robot, ROUND)
        for page in pages:
            badge(page, "Running")
        pages[0].get_by_role("button", name="Pause").click()
        for page in pages:
            badge(page, "Paused")
        expect(pages[0].locator("#run-panel .chip[role=status]")).to_have_text("Paused")
        expect(face.locator("#alarm")).to_have_text("I am pausing. I will go on soon.")
        where = robot.location()
        late = look("/map", language="de")
        badge(late, "Pausiert")
        assert robot.location() == where
        pages[0].get_by_role("button", name="Go on").click()
        for page in (*pages, late):
            badge(page, "Running" if page is not late else "Läuft")
        expect(face.locator("#alarm")).to_be_hidden()
        robot.stop()
        robot.request("program.wait", {"run": run})
        for page in pages:
            badge(page, "Stopped")
        expect(face.locator("body")).to_have_attribute("data-robot", "stopped")


def test_a_state_that_was_overtaken_is_ignored(look: Look) -> None:
    page = look("/")
    expect(page.locator("#robot-badge")).to_be_visible()
    before = page.locator("#robot-badge").inner_text()
    page.evaluate(
        """async () => {
          const {present} = await import('/static/state.js');
          present._take({...present.now, sequence: present.now.sequence - 1, state: 'lost'});
        }"""
    )
    badge(page, before)


def test_what_lies_before_somebody_is_under_review(look: Look, page: Page) -> None:
    onlooker = look("/map")
    page.get_by_role("textbox", name="Tell the robot what to do").fill("go to ward a")
    page.keyboard.press("Enter")
    badge(onlooker, "Under review")
    page.get_by_role("button", name="Reject").click()
    expect(onlooker.locator("#robot-badge")).not_to_have_text("Under review")


def test_nothing_is_approved_while_another_program_runs(
    look: Look, page: Page, running: int, served: Served
) -> None:
    page.get_by_role("textbox", name="Tell the robot what to do").fill("say good morning")
    page.keyboard.press("Enter")
    expect(page.locator(".busy-note")).to_contain_text("approve it when that is over")
    read_all(page)
    page.locator("#approve").click()
    expect(page.locator("#notice")).to_contain_text("Another program is running.")
    with served.robot() as robot:
        robot.stop()
        robot.request("program.wait", {"run": running})
    expect(page.locator(".busy-note")).to_be_hidden()
    approve(page)
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")


def test_after_a_stop_one_looks_at_what_is_left_and_goes_on(
    look: Look, page: Page, served: Served, picture: Picture
) -> None:
    with served.robot() as robot:
        run = runs(robot, 'robot.say("One.")\nrobot.goto("ward a")\nrobot.say("Three.")\n')
        badge(page, "Running")
        expect(page.locator(".calls li")).to_have_count(2)
        page.keyboard.press("Escape")
        expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Stopped")
        page.get_by_role("button", name="Go on from there").click()
        expect(page.get_by_role("heading", name=f"What is left of run {run}")).to_be_visible()
        told = page.locator(".said.by-robot").last
        expect(told).to_contain_text("Done already, and not done again:")
        expect(told).to_contain_text("It goes on at line 2:")
        picture(page, "go-on")
        approve(page)
        expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")
        rows = page.locator("#run-panel .calls li code")
        expect(rows).to_have_text(['goto(place="ward a")', 'say(text="Three.")'])


def test_what_is_left_is_found_again_on_the_page_of_the_run(
    look: Look, page: Page, served: Served
) -> None:
    """Also when the desk has long gone on to something else."""
    with served.robot() as robot:
        run = runs(robot, 'robot.say("One.")\nrobot.goto("ward b")\nrobot.say("Three.")\n')
        expect(page.locator(".calls li")).to_have_count(2)
        page.keyboard.press("Escape")
        expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Stopped")
        page.goto(f"{served.url}/runs/{run}")
        page.get_by_role("link", name="Go on from there").click()
        expect(page.get_by_role("heading", name=f"What is left of run {run}")).to_be_visible()
        approve(page)
        expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")
        page.goto(f"{served.url}/runs/{run}")
        expect(page.locator(".run-facts")).to_contain_text(f"Continued byRun {run + 1}")
        expect(page.get_by_role("link", name="Go on from there")).to_have_count(0)
        page.get_by_role("link", name=f"Run {run + 1}").click()
        expect(page.locator(".run-facts")).to_contain_text(f"Goes on withRun {run}")


def test_of_a_move_the_rest_is_left_and_that_the_robot_was_moved_is_told(
    look: Look, page: Page, served: Served, picture: Picture
) -> None:
    with served.robot() as robot:
        robot.localize("corridor")
        poses: SimpleQueue[float] = SimpleQueue()
        robot.subscribe(["pose"], lambda kind, data: poses.put(data["x"]))
        began = robot.location().x
        runs(robot, "robot.move(2)\n")
        while abs(poses.get(timeout=20) - began) < 0.5:
            pass
        page.keyboard.press("Escape")
        expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Stopped")
        robot.localize("ward a")
    page.get_by_role("button", name="Go on from there").click()
    told = page.locator(".said.by-robot").last
    expect(told).to_contain_text("A part of that step is done already")
    expect(told).to_contain_text("The robot is no longer where it stopped, but ")
    picture(page, "go-on-rest")
    page.get_by_role("button", name="Reject").click()


def test_go_on_is_typed_as_well(look: Look, page: Page, served: Served, running: int) -> None:
    badge(page, "Running")
    page.get_by_role("button", name="Pause").click()
    badge(page, "Paused")
    line = page.get_by_role("textbox", name="Tell the robot what to do")
    line.fill("go on")
    line.press("Enter")
    badge(page, "Running")
