"""Where the software has a fault, or too much to do, people read what they may do, and can stop the
robot."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from threading import Event

import pytest
from playwright.sync_api import expect

from tests.console import failing_console
from tests.console.conftest import SOON, Look, Picture, Served, serving

FAILING = (str(Path(__file__).with_name("failing_console.py")),)


@pytest.fixture(scope="module")
def failing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    with serving(tmp_path_factory.mktemp("home"), program=FAILING) as served:
        yield served


@pytest.mark.parametrize(
    ("path", "language", "status", "title", "again", "talk"),
    [
        ("/fails", "en", 500, "This page has failed", "Load again", "Talk"),
        ("/fails/7", "de", 500, "Diese Seite ist gescheitert", "Neu laden", "Sprechen"),
        ("/never?a=b", "fr", 503, "Cette page met trop de temps", "Recharger", "Parler"),
    ],
)
def test_a_page_that_fails_says_what_to_do_and_has_stop(
    look: Look,
    failing: Served,
    picture: Picture,
    path: str,
    language: str,
    status: int,
    title: str,
    again: str,
    talk: str,
) -> None:
    page = look("/healthz", url=failing.url, language=language, width=390, height=844)
    answer = page.goto(failing.url + path)
    assert answer is not None and answer.status == status
    expect(page.get_by_role("heading", level=1)).to_have_text(title)
    shown = page.content()
    for inside in ("Traceback", "Error", "response_timeout", failing_console.SECRET):
        assert inside not in shown
    picture(page, f"trouble-{status}-{language}")
    with failing.robot() as robot:
        stopped = Event()
        robot.subscribe(["stopped"], lambda kind, data: stopped.set())
        page.locator("#stop").click()
        expect(page.get_by_role("alert")).to_be_visible()
        assert stopped.wait(SOON / 1000)
    page.get_by_role("link", name=again).click()
    expect(page).to_have_url(failing.url + path)
    expect(page.get_by_role("heading", level=1)).to_have_text(title)
    page.get_by_role("link", name=talk).click()
    expect(page.locator("#conversation")).to_be_visible()


def test_what_failed_is_in_the_file_that_the_page_names(look: Look, failing: Served) -> None:
    look("/fails", url=failing.url)
    look("/never", url=failing.url)
    noted = (failing.home / "faults.log").read_text(encoding="utf-8")
    assert f"ZeroDivisionError: {failing_console.SECRET}" in noted
    assert "the page /never was not ready in time" in noted


def test_a_run_that_there_cannot_be_is_no_fault(look: Look, failing: Served) -> None:
    page = look("/healthz", url=failing.url)
    answer = page.goto(f"{failing.url}/runs/{10**30}")
    assert answer is not None and answer.status == 200
    expect(page.get_by_role("alert").filter(has_text="There is no run")).to_be_visible()
