"""Every page for who sees little: twice as large on a laptop, a tablet and a phone. A browser that
zooms has half the room."""

from __future__ import annotations

import pytest
from playwright.sync_api import Page, expect

from tests.console.conftest import Look, Picture, Served
from tests.console.test_looks import STICKS_OUT, resized
from tests.console.test_runs import run_by

HALVES = [(640, 360), (410, 590), (195, 422)]
MAIN = {
    "/": "#words",
    "/map": ".floor-bar button",
    "/drive": "#drive .helm .button.primary",
    "/drive?view=presence": ".presence-idle .button",
    "/runs": ".runs-search .button.primary",
    "/routines": ".routines .button.primary",
    "/devices": "#devices .button",
    "/sign-in": ".door main .button",
    "/trust": ".door main .button",
    "/face": "#languages button",
    "/nothing/here": ".door main a.button",
}
"""What one comes to a page for."""
WITHOUT_STOP = ("/sign-in", "/trust")
BESIDE = """() => {
  const width = document.documentElement.clientWidth;
  const usable = 'a, button, input, select, textarea, summary, [role=button], [role=slider]';
  const out = [...document.querySelectorAll(usable)].filter((each) => {
    const {left, right, width: wide} = each.getBoundingClientRect();
    const seen = each.checkVisibility() && wide > 1 && !each.classList.contains('skip');
    if (!seen || each.closest('.nicegui-error-popup')) return false;
    // What one scrolls sideways to, in a box of its own, is within reach.
    for (let box = each.parentElement; box; box = box.parentElement) {
      if (/auto|scroll/.test(getComputedStyle(box).overflowX)) return false;
    }
    return left < -1 || right > width + 1;
  });
  return out.map((each) => `${each.tagName}.${each.className}: ${each.textContent.trim()}`);
}"""
UNDER_A_FINGER = """() => {
  const stop = document.getElementById('stop');
  const {left, right, top, bottom} = stop.getBoundingClientRect();
  return stop.contains(document.elementFromPoint((left + right) / 2, (top + bottom) / 2));
}"""


@pytest.fixture(scope="module")
def run(served: Served) -> int:
    return run_by(served, "go to reception and ask whether anybody needs water")


def holds(page: Page, main: str, stop: bool = True) -> None:
    """Nothing is cut off sideways, STOP is under a finger, what one came for can be reached."""
    expect(page.locator(main).first).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert page.evaluate(STICKS_OUT) == []
    assert page.evaluate(BESIDE) == []
    if stop:
        expect(page.locator("#stop")).to_be_in_viewport(ratio=1)
        assert page.evaluate(UNDER_A_FINGER)
    action = page.locator(main).first
    action.scroll_into_view_if_needed()
    action.click(trial=True)  # nothing lies over it
    expect(action).to_be_in_viewport(ratio=0.9)
    if stop:
        expect(page.locator("#stop")).to_be_in_viewport(ratio=1)


@pytest.mark.parametrize("path", MAIN)
def test_a_page_twice_as_large_can_be_used(look: Look, path: str, picture: Picture) -> None:
    page = look(path, language="de")
    for width, height in HALVES:
        resized(page, width, height)
        holds(page, MAIN[path], stop=path not in WITHOUT_STOP)
        picture(page, f"zoomed-{width}{path.replace('/', '-')}")


def test_a_run_twice_as_large_is_read_and_watched(look: Look, run: int) -> None:
    page = look(f"/runs/{run}", language="fr")
    expect(page.locator(".run-replay[data-ready]")).to_be_visible()
    for width, height in HALVES:
        resized(page, width, height)
        holds(page, "[data-play]")
        page.locator(".run-answers").scroll_into_view_if_needed()
        expect(page.locator(".run-answers")).to_be_in_viewport()


def test_what_the_map_shows_is_chosen_on_a_phone_twice_as_large(look: Look) -> None:
    page = look("/map", width=195, height=422, language="de")
    page.locator(".floor-layers summary").click()
    expect(page.locator(".floor-menu")).to_be_visible()
    assert page.evaluate(BESIDE) == []
