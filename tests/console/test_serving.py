"""How a console is served: to whom, in which language, and that it asks for nothing elsewhere."""

from __future__ import annotations

from pathlib import Path
from threading import Event

from playwright.sync_api import Page, expect

from nl2robot.console.reference import reference
from tests.console.conftest import SOON, Look, Served, serving
from tests.console.test_desk import approve, say


def test_stop_is_on_the_page_and_reaches_the_robot(page: Page, served: Served) -> None:
    with served.robot() as robot:
        stopped = Event()
        robot.subscribe(["stopped"], lambda kind, data: stopped.set())
        page.get_by_role("button", name="STOP").click()
        expect(page.get_by_role("alert")).to_have_text("The robot was stopped.")
        assert stopped.wait(SOON / 1000)


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


def test_a_page_outlives_its_server(look: Look, tmp_path: Path) -> None:
    with serving(tmp_path) as first:
        page = look(url=first.url)
        line = page.get_by_label("Tell the robot what to do")
        line.fill("say good")
        first.process.kill()
        first.process.wait()
        expect(page.get_by_role("alert")).to_contain_text("No connection to the robot.")
    with serving(tmp_path, "--port", first.address.partition(":")[2]):
        expect(page.locator("#connection")).to_have_attribute("data-state", "connected")
        page.wait_for_function("!document.querySelector('.nicegui-error-popup[aria-hidden=false]')")
        expect(line).to_have_value("say good")
        line.press_sequentially(" morning")
        line.press("Enter")
        expect(page.locator(".cm-content")).to_have_text('robot.say("Good morning.")')


def test_a_conversation_outlives_the_server_and_says_what_became_of_its_run(
    look: Look, tmp_path: Path
) -> None:
    with serving(tmp_path) as first:
        page = look(url=first.url)
        say(page, "go to radiology and then to the pharmacy")
        approve(page)
        expect(page.locator("#run-panel li.current")).to_contain_text("radiology")
        say(page, "say good morning")
        expect(page.get_by_role("button", name="Approve and run")).to_be_enabled()
        first.process.kill()
        first.process.wait()
        page.goto("about:blank")  # a page that is open loads itself anew when the server is back
    with serving(tmp_path, "--port", first.address.partition(":")[2]) as second:
        page.goto(second.url)
        expect(page.locator(".said.by-you").first).to_contain_text("go to radiology")
        expect(page.locator(".said.trouble")).to_contain_text("the program ended there. See run 1")
        approve(page)
        expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")
        with second.robot() as robot:
            assert robot.request("runs.show", {"run": 2})["utterance"] == "say good morning"


def test_others_need_the_token_that_the_start_up_line_prints(look: Look, tmp_path: Path) -> None:
    with serving(tmp_path, "--host", "0.0.0.0") as server:
        here = f"http://127.0.0.1:{server.address.partition(':')[2]}"
        refused = look(url=here)
        expect(refused.locator("body")).to_contain_text("Sign in to the robot")
        link = next(word for line in server.said for word in line.split() if "?token=" in word)
        page = look("/?token=" + link.partition("?token=")[2], url=here)
        expect(page.get_by_role("button", name="Send")).to_be_visible()
        assert "token" not in page.url


def test_the_docs_tell_what_the_console_adds_to_the_wire(served: Served) -> None:
    docs = Path(__file__).parents[2] / "docs" / "console.md"
    with served.robot() as robot:
        told = reference(robot.request("rpc.discover", {}))
    hint = f"python -m nl2robot.console.reference {served.address}"
    assert told in docs.read_text(encoding="utf-8"), f"anew: {hint}"
