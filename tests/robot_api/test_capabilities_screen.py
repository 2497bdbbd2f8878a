"""The tablet on the robot's chest: pages, buttons, and a face for a robot that has none."""

from __future__ import annotations

from typing import Any
from xml.etree import ElementTree

import pytest

from robot_api.capabilities.face import face_page
from robot_api.capabilities.page import Page
from robot_api.driver import Event, StopFlag
from robot_api.drivers import EmulatedDriver, emulated
from robot_api.errors import InvalidCall, NotFound, NotSupported, TimedOut
from robot_api.methods import SUGGESTED_EMOTIONS

FORM = """
<h1 id="title">How   are
   you?</h1>
<form>
  <input id="name" value="?"><textarea class="notes">none</textarea>
  <input type="checkbox" id="pain">
  <label><input type="radio" name="meal" value="a" checked>A</label>
  <label><input type="radio" name="meal" value="b">B</label>
  <select id="ward"><option>East</option><option>West</option></select>
  <details><summary>More</summary>text</details>
  <button class="big send">Send</button>
</form>
"""


def do(driver: EmulatedDriver, method: str, **arguments: Any) -> Any:
    return driver.call(method, arguments, StopFlag())


@pytest.fixture
def page() -> Page:
    return Page(FORM)


def test_texts_are_read_with_css_selectors(page: Page) -> None:
    assert page.read_text("#title") == "How are you?"
    assert page.read_text("form > button.send") == "Send"
    assert page.read_text("label:nth-of-type(2)") == "B"


def test_what_is_typed_can_be_read(page: Page) -> None:
    page.type_text("#name", "Ann <b>")
    page.type_text(".notes", "slept well")
    assert page.read_text("#name") == "Ann <b>"
    assert page.read_text("textarea") == "slept well"
    assert Page(page.html).read_text("#name") == "Ann <b>"


def test_boxes_are_ticked_and_options_picked(page: Page) -> None:
    page.click("#pain")
    assert page.read_text("#pain:checked ~ select") == "East"
    page.click("#pain")
    page.click('input[value="b"]')
    page.click("option:nth-of-type(2)")
    page.click("summary")
    assert page.read_text("#ward") == "West"
    ticked = Page(page.html)
    ticked.read_text('input[value="b"][checked]')
    ticked.read_text("details[open]")
    for gone in ("#pain[checked]", 'input[value="a"][checked]'):
        with pytest.raises(NotFound):
            ticked.read_text(gone)


def test_what_the_page_does_not_have(page: Page) -> None:
    with pytest.raises(NotFound, match="no '#address' on the page"):
        page.click("#address")
    with pytest.raises(NotFound, match="not a field"):
        page.type_text("button", "hello")
    with pytest.raises(InvalidCall, match="not a CSS selector"):
        page.read_text("p[[")


def test_pages_written_by_beginners() -> None:
    page = Page("<p>One<p>Two<br><b>bold</p><button>Go")
    assert page.read_text("button") == "Go"
    assert page.read_text("b").startswith("bold")


def test_a_form_on_the_robot() -> None:
    robot = emulated()
    shown: list[Event] = []
    robot.subscribe(lambda kind, data: shown.append(data) if kind == "screen" else None)
    do(robot, "show", html=FORM)
    do(robot, "type_text", selector="#name", text="Ann")
    do(robot, "click", selector="#pain")
    assert do(robot, "read_text", selector="#name") == "Ann"
    assert "Ann" in shown[-1]["html"] and "checked" in shown[-1]["html"]


def test_after_the_buttons_the_page_is_back() -> None:
    robot = emulated(["tea"])
    shown: list[Event] = []
    robot.subscribe(lambda kind, data: shown.append(data) if kind == "screen" else None)
    do(robot, "show", html=FORM)
    assert do(robot, "touch", options=["coffee", "tea"], prompt="What may it be?") == "tea"
    assert shown[1] == {"options": ["coffee", "tea"], "text": "What may it be?"}
    assert shown[2] == {"html": FORM}
    assert do(robot, "read_text", selector="h1") == "How are you?"


def test_nobody_touches_the_screen() -> None:
    with pytest.raises(TimedOut, match="Nobody touched the screen"):
        do(emulated([None]), "touch", options=["yes"])


def test_a_screen_without_a_page() -> None:
    robot = emulated()
    for content in ({}, {"text": "Hello"}, {"url": "https://example.org"}):
        do(robot, "show", **content)
        with pytest.raises(NotFound, match=r"page of HTML"):
            do(robot, "click", selector="button")


def test_the_screen_shows_one_thing_at_a_time() -> None:
    with pytest.raises(InvalidCall, match="one thing at a time"):
        do(emulated(), "show", text="Hello", html="<p>Hello</p>")


def test_a_robot_without_a_face_shows_emotions_on_its_screen() -> None:
    robot = emulated(without=["face"])
    events: list[tuple[str, Event]] = []
    robot.subscribe(lambda kind, data: events.append((kind, data)))
    do(robot, "emotion", name="Happy")
    told = dict(events)
    assert told["emotion"] == {"name": "happy"}
    assert 'aria-label="happy"' in told["screen"]["html"]
    with pytest.raises(NotSupported, match="I can look neutral, happy"):
        do(robot, "emotion", name="jealous")


def test_a_robot_without_face_and_screen_has_no_emotions() -> None:
    robot = emulated(without=["face", "screen"])
    assert "emotion" not in robot.capabilities().methods
    with pytest.raises(NotSupported, match="no face and no screen"):
        do(robot, "emotion", name="happy")


def test_every_face_is_a_drawing_of_its_own() -> None:
    pages = {emotion: face_page(emotion) for emotion in SUGGESTED_EMOTIONS}
    assert len(set(pages.values())) == len(pages)
    for page in pages.values():
        drawing = ElementTree.fromstring(page[page.index("<svg") : page.index("</body>")])
        assert len(drawing.findall(".//path")) == 3
        assert len(drawing.findall(".//ellipse")) == 2
