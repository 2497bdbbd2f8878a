"""Every page for everybody: on phone, tablet and desktop, in light and dark, in other languages,
for those who see little and those who use no mouse."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from nl2robot.fleet.key import make_key
from tests.console.conftest import Look, Served, serving
from tests.console.test_desk import say

CONTRAST = (Path(__file__).parent / "contrast.js").read_text(encoding="utf-8")
STICKS_OUT = """() => [document.documentElement, ...document.querySelectorAll('.card, header, nav')]
    .filter((each) => each.checkVisibility() && each.scrollWidth > each.clientWidth + 1)
    .map((each) => each.tagName + '.' + each.className)"""
NAMED = {
    *("button", "link", "textbox", "searchbox", "checkbox", "radio", "combobox", "slider"),
    *("switch", "img", "image", "application", "dialog"),
}
"""Roles of what somebody who does not see it has to be told the name of."""
READY = {
    "/": "#desk-map .floor-told",
    "/map": ".floor-told",
    "/drive": "#drive .floor-told",
    "/routines": ".routines[data-ready=yes]",
    "/schedule": "#schedule[data-ready=yes]",
    "/runs": "[data-part=found]",
    "/fleet": "#fleet[data-ready=yes]",
    "/devices": "#devices .card",
}
SCREENS = {
    "de": [(320, 640, True), (768, 1024, False), (910, 700, True), (1280, 800, False)],
    "fr": [(844, 390, False), (1024, 768, False), (1440, 900, True)],
}
"""For each language: width, height, dark."""


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """With all pages that there are: also of the fleet."""
    home = tmp_path_factory.mktemp("home")
    make_key(home / "fleet.key")
    with serving(home, "--fleet", "Ada") as served:
        yield served


def drawn(page: Page) -> None:
    """Once the page knows of what has just changed around it, and has drawn itself anew."""
    page.evaluate(
        "() => new Promise((on) => requestAnimationFrame(() => requestAnimationFrame(on)))"
    )


def resized(page: Page, width: int, height: int) -> None:
    """The page on another screen. One page is enough for all: what opens costs a hundred times what
    turns a tablet."""
    page.set_viewport_size({"width": width, "height": height})
    drawn(page)


def in_look(page: Page, dark: bool) -> None:
    page.emulate_media(color_scheme="dark" if dark else "light")
    drawn(page)


def nameless(page: Page) -> list[Any]:
    """What a screen reader could tell no name of."""
    tree = page.context.new_cdp_session(page).send("Accessibility.getFullAXTree")["nodes"]
    return [
        node["role"]["value"]
        for node in tree
        if not node["ignored"]
        and node["role"]["value"] in NAMED
        and not node.get("name", {}).get("value", "").strip()
    ]


@pytest.mark.parametrize("path", READY)
@pytest.mark.parametrize("language", SCREENS)
def test_a_page_fits_is_read_and_is_told(look: Look, path: str, language: str) -> None:
    page = look(path, language=language)
    expect(page.locator(READY[path]).first).to_be_visible()
    expect(page.locator("#connection")).to_have_attribute("data-state", "connected")
    for width, height, dark in SCREENS[language]:
        resized(page, width, height)
        in_look(page, dark)
        assert page.evaluate(STICKS_OUT) == [], width
        assert page.evaluate(CONTRAST) == [], width
        assert nameless(page) == [], width
        expect(page.get_by_role("heading", level=1)).to_have_count(1)
        expect(page.locator("#stop")).to_be_in_viewport(ratio=1)
        for link in page.locator("header nav a").all():
            expect(link).to_be_in_viewport(ratio=1)


def test_from_the_words_to_the_run_without_a_mouse(page: Page) -> None:
    say(page, "say hello")
    approve = page.get_by_role("button", name="Approve and run")
    expect(approve).to_be_enabled()
    for _ in range(30):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.id") == "approve":
            break
    expect(approve).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")


def test_nothing_that_people_write_becomes_part_of_a_page(look: Look, served: Served) -> None:
    evil = '<img src=x onerror="window.caught = true"><b>'
    page = look("/?program=" + f"print('{evil}')%0Arobot.say('{evil}')".replace(" ", "%20"))
    page.get_by_role("button", name="Approve and run").click()
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")
    say(page, evil)
    expect(page.locator(".said.by-you").last).to_contain_text(evil)
    with served.robot() as robot:
        robot.request("zones.set", {"name": evil, "polygon": [[1, 1], [2, 1], [2, 2]]})
        robot.show(text=evil)
        for path in ("/map", "/drive", "/routines", "/schedule", "/runs", "/fleet", "/face"):
            page.goto(served.url + path)
            expect(page.locator("body")).to_contain_text("STOP")
            page.wait_for_load_state("networkidle")
            assert page.locator("img[src=x]").count() == 0, path
            assert page.evaluate("window.caught") is None, path
        robot.request("zones.remove", {"name": evil})
