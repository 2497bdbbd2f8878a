"""How a console is served: to whom, in which language, and that it asks for nothing elsewhere."""

from __future__ import annotations

from playwright.sync_api import Page, expect

from tests.console.conftest import Look, Served


def test_stop_is_on_the_page_and_reaches_the_robot(page: Page, served: Served) -> None:
    with served.robot() as robot:
        heard: list[str] = []
        robot.subscribe(["stopped"], lambda kind, data: heard.append(kind))
        page.get_by_role("button", name="STOP").click()
        expect(page.get_by_role("alert")).to_have_text("The robot was stopped.")
    assert heard


def test_the_console_speaks_the_language_of_the_browser(look: Look) -> None:
    german = look(language="de")
    expect(german.get_by_role("button", name="STOPP")).to_be_visible()
    expect(german.locator("html")).to_have_attribute("lang", "de")


def test_no_page_asks_for_anything_from_elsewhere(look: Look, served: Served) -> None:
    page = look("/healthz")
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(served.url)
    expect(page.locator("#connection")).to_have_attribute("data-state", "connected")
    assert asked
    assert all(url.startswith((served.url, "data:", "blob:")) for url in asked), asked
