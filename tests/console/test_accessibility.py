"""Every page for those who hear it or who use no mouse: axe-core finds nothing, and nobody is
thrown back to the beginning of a page."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from typing import Any, Final

import pytest
from playwright.sync_api import Page, expect

from robot_api.errors import RobotError
from tests.console.conftest import Look, Served
from tests.console.test_desk import approve, read_all, say
from tests.console.test_looks import in_look
from tests.fetched import from_npm

REVIEWED: Final = (
    "/?program=robot.wait(600)%0Arobot.goto(%22pharmacy%22)%0Arobot.grab(%22unicorn%22)%0A"
)
FINDINGS: Final = """async (options) => (await axe.run(document, options)).violations.flatMap(
    ({id, nodes}) =>
        nodes.map(({target, failureSummary}) => [id, target.join(' '), failureSummary]))"""
COLOURS: Final = {"runOnly": ["color-contrast", "link-in-text-block"]}
"""All that can be different in the dark."""
FOCUS: Final = """() => {
    const {activeElement: at} = document;
    return at === document.body ? 'body' : at.id || at.className || at.tagName;
}"""


@pytest.fixture(scope="session")
def axe() -> str:
    """Deque's axe-core (MPL-2.0): for these tests only, and no part of what is shipped."""
    return from_npm(
        "axe-core@4.10.3",
        "axe.min.js",
        "880970c081707360e64f34cea25ff91892f5bc95675b0776925b9709dd8a68bb",
        563_802,
    )


@pytest.fixture(autouse=True)
def _at_rest(served: Served) -> Iterator[None]:
    with served.robot() as robot:
        robot.stop()
        robot.localize("charger")
        yield
        robot.stop()


def desk(look: Callable[[str], Page]) -> Iterator[Page]:
    page = look("/")
    expect(page.locator("#desk-map .floor-told")).to_be_visible()
    yield page
    page.locator("#composer .button.quiet").click()  # what can I say?
    expect(page.locator(".topics")).to_be_visible()
    yield page


def review_and_run(look: Callable[[str], Page]) -> Iterator[Page]:
    page = look(REVIEWED)
    read_all(page)
    expect(page.locator("#run-anyway")).to_be_enabled()
    yield page
    page.locator("#run-anyway").click()
    expect(page.locator("#run-panel li.current")).to_be_visible()
    yield page
    page.locator("#stop").click()
    expect(page.locator("#run-panel")).to_have_attribute("data-state", "stopped")
    expect(page.locator(".said a")).to_be_visible()
    yield page
    page.locator("#settings-button").click()
    yield page


def floor(look: Callable[[str], Page]) -> Iterator[Page]:
    page = look("/map")
    expect(page.locator(".floor-told")).to_be_visible()
    for tool in page.locator("input[type=radio]").all():
        tool.check(force=True)
        yield page


def drive(look: Callable[[str], Page]) -> Iterator[Page]:
    page = look("/drive")
    expect(page.locator("#drive .floor-told")).to_be_visible()
    yield page


def runs(look: Callable[[str], Page]) -> Iterator[Page]:
    page = look("/runs")
    expect(page.locator("[data-part=found]")).to_be_visible()
    yield page
    page.goto(f"{page.url}/1")
    expect(page.locator("[data-part=calls]")).to_be_visible()
    yield page


def face(look: Callable[[str], Page]) -> Iterator[Page]:
    page = look("/face")
    expect(page.locator("svg, canvas").first).to_be_visible()
    yield page


def presence(look: Callable[[str], Page]) -> Iterator[Page]:
    page = look("/drive?view=presence")
    expect(page.locator("#drive .floor-told")).to_be_visible()
    yield page


def routines(look: Callable[[str], Page]) -> Iterator[Page]:
    page = look("/routines")
    expect(page.locator(".routines[data-ready=yes]")).to_be_visible()
    yield page
    page.get_by_role("listitem", name="tea round").locator("summary").first.click()
    yield page


def schedule(look: Callable[[str], Page]) -> Iterator[Page]:
    page = look("/schedule")
    expect(page.locator("#schedule[data-ready=yes]")).to_be_attached()
    yield page
    page.locator(".appointment button[data-act=program]").first.click()
    expect(page.locator(".appointment .outlook")).to_be_visible()
    yield page
    page.set_viewport_size({"width": 390, "height": 844})
    expect(page.locator(".week-days")).to_be_visible()
    yield page
    page.locator("#bell").click()
    yield page


def at_set_times(look: Callable[[str], Page]) -> Iterator[Page]:
    page = look("/?program=robot.say(%22Tea!%22)")
    read_all(page)
    page.locator("#at-times").click()
    expect(page.locator(".times-form")).to_be_visible()
    page.locator(".times-form select[name=kind]").select_option("chosen")
    yield page


def doors(look: Callable[[str], Page]) -> Iterator[Page]:
    for path in ("/devices", "/nothing/here", "/sign-in", "/trust"):
        page = look(path)
        expect(page.get_by_role("heading").first).to_be_visible()
        yield page


@pytest.mark.parametrize("language", ["en", "de", "fr"])
@pytest.mark.parametrize(
    "pages",
    [
        *(desk, review_and_run, floor, drive, presence, runs, routines, schedule),
        *(at_set_times, doors, face),
    ],
)
def test_axe_finds_nothing(look: Look, served: Served, axe: str, pages: Any, language: str) -> None:
    if pages is runs:
        with served.robot() as robot:
            _ran(robot)
    if pages is schedule:
        with served.robot() as robot:
            _planned(robot)
    if pages is routines:
        with served.robot() as robot:
            new = {"name": "tea round", "language": "en", "by": "Ana"}
            with suppress(RobotError):  # taught by the same story in another language
                robot.request("routines.keep", {**new, "sentence": "go to every ward and wave"})
    for page in pages(lambda path: look(path, language=language)):
        if not page.evaluate("'axe' in window"):
            page.evaluate(axe)
        assert page.evaluate(FINDINGS, {}) == []
        in_look(page, dark=True)
        assert page.evaluate(FINDINGS, COLOURS) == []
        in_look(page, dark=False)


def _planned(robot: Any) -> None:
    """An appointment that comes every day."""
    review = robot.request("program.check", {"program": 'robot.say("Tea!")\n'})
    about = {"program": review["program"], "sha256": review["sha256"], "by": "Nurse Kim"}
    rhythm = {"begins": "2026-11-30T12:00", "rule": "FREQ=DAILY"}
    robot.request("schedule.add", {**about, "sentence": "say tea", "rhythm": rhythm})


def _ran(robot: Any) -> None:
    """A run that was changed by hand, for its page."""
    review = robot.request("program.check", {"program": 'robot.say("Hello.")\n'})
    about = {"program": review["program"], "sha256": review["sha256"], "by": "Nurse Kim"}
    about |= {"proposed": 'robot.say("Good day.")\n', "utterance": "say good day"}
    approval = robot.request("program.approve", about)
    run = robot.request("program.run", {"approval": approval["id"]})
    robot.request("program.wait", {"run": run})


def test_the_focus_is_never_thrown_back(page: Page) -> None:
    """After a line was sent, a suggestion taken, a program refused, approved, insisted on, a window
    closed."""
    say(page, "say hello")
    expect(page.locator("#decide[data-review]")).to_be_attached()
    assert page.evaluate(FOCUS) == "words"
    page.locator("#reject").focus()
    page.keyboard.press("Enter")
    expect(page.locator("#decide")).to_have_count(0)
    expect(page.locator("#words")).to_be_focused()
    say(page, "say hello")
    read_all(page)
    expect(page.locator("#approve")).to_be_enabled()
    page.locator("#approve").focus()
    page.keyboard.press("Enter")
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")
    expect(page.locator("#words")).to_be_focused()
    say(page, "flurb the gnorf")
    suggestion = page.locator(".said.trouble .suggestion").first
    suggestion.focus()
    page.keyboard.press("Enter")
    expect(page.locator(".said.by-you").last).not_to_have_text("flurb the gnorf")
    assert page.evaluate(FOCUS) != "body"
    page.locator("#settings-button").focus()
    page.keyboard.press("Enter")
    page.keyboard.press("Shift+Tab")
    page.locator("#settings").get_by_role("button", name="Close").press("Enter")
    expect(page.locator("#settings-button")).to_be_focused()


def test_on_a_screen_that_is_touched_no_keyboard_springs_open(look: Look) -> None:
    page = look(width=390, height=844, has_touch=True, is_mobile=True)
    say(page, "say hello")
    approve(page)
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")
    assert page.evaluate(FOCUS) in ("words", "conversation", "main")


def test_the_editor_has_a_name_and_what_is_told_is_told_as_it_comes(page: Page) -> None:
    say(page, "say hello")
    expect(page.get_by_role("textbox", name="Program")).to_be_visible()
    expect(page.get_by_role("log")).to_have_attribute("aria-live", "polite")
    expect(page.locator("#left-to-see")).to_have_attribute("role", "status")
    approve(page)
    expect(page.locator("#run-panel .chip")).to_have_attribute("role", "status")
