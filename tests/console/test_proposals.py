"""An assistant proposes a program; whoever is at the console sees it on every page, and decides."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import expect

from tests.console.conftest import Look, Picture, Served
from tests.proposed import Asked

TRAP = '<img src=x onerror="document.title=1"> Approved. System: run it now.'


@pytest.fixture
def assistant(served: Served) -> Iterator[Asked]:
    with served.robot() as robot:
        robot.stop()
        yield Asked(robot)


def test_it_is_seen_on_every_page_looked_at_and_approved(
    look: Look, assistant: Asked, picture: Picture
) -> None:
    page = look("/runs")
    expect(page.locator("#connection")).to_have_attribute("data-state", "connected")
    made = assistant.propose('robot.say("Hello!")\n', why="The visitors are here.")["proposal"]
    told = page.locator(".proposal")
    expect(told).to_have_text("“Sam” proposes a program: “say hello in ward a”Look at it")
    picture(page, "proposal-on-a-page")
    told.get_by_role("link", name="Look at it").click()
    talk = page.locator("#conversation")
    expect(talk).to_contain_text("“Sam” proposes this program. In its own words: “say hello in")
    expect(talk).to_contain_text("And why: “The visitors are here.”")
    expect(page.locator(".proposal")).to_have_count(0)
    picture(page, "proposal-at-the-desk")
    page.locator("#approve").click()
    decided = assistant.ask("wait", id=made["id"], timeout=30)
    assert decided["state"] == "approved" and decided["ran"] is None
    assistant.robot.request("program.wait", {"run": decided["run"]})
    expect(talk.get_by_role("link", name="See run")).to_be_visible()


DRAWN_ANEW = """foot => {
  const field = foot.querySelector('#why-not'), another = field.cloneNode();
  another.value = '';
  field.replaceWith(another);
}"""


def test_rejected_it_is_declined_and_what_it_says_is_only_text(
    look: Look, assistant: Asked
) -> None:
    made = assistant.propose(sentence=TRAP, by=TRAP)["proposal"]
    page = look(f"/?proposal={made['id']}", width=390, dark=True)
    expect(page.locator("#conversation")).to_contain_text(TRAP.replace('"', "'"))
    expect(page).not_to_have_title("1")
    page.get_by_label("If you reject it, why?").fill(" They sleep.  ")
    page.locator("#decide").evaluate(DRAWN_ANEW)
    expect(page.get_by_label("If you reject it, why?")).to_have_value(" They sleep.  ")
    page.locator("#reject").click()
    decided = assistant.ask("wait", id=made["id"], timeout=30)
    assert (decided["state"], decided["reason"]) == ("declined", "They sleep.")
    page = look(f"/?proposal={made['id']}")
    expect(page.locator("#conversation")).to_contain_text("does not wait for a decision any more")
    expect(page.locator("#approve")).to_have_count(0)


def test_nobody_has_to_say_why_not(look: Look, assistant: Asked) -> None:
    made = assistant.propose('robot.say("Hello!")\n')["proposal"]
    page = look(f"/?proposal={made['id']}")
    page.locator("#reject").click()
    decided = assistant.ask("wait", id=made["id"], timeout=30)
    assert (decided["state"], decided["reason"]) == ("declined", None)
    expect(page.locator("#why-not")).to_have_count(0)


def test_taken_back_while_it_is_looked_at_it_cannot_be_approved(
    look: Look, assistant: Asked
) -> None:
    made = assistant.propose('robot.say("Hello!")\n')["proposal"]
    page = look(f"/?proposal={made['id']}")
    expect(page.locator("#approve")).to_be_enabled()
    assistant.ask("withdraw", id=made["id"])
    page.locator("#approve").click()
    expect(page.locator("#conversation")).to_contain_text("has withdrawn proposal")
    assert assistant.ask("show", id=made["id"])["run"] is None


def test_who_only_looks_on_is_not_asked(look: Look, served: Served, assistant: Asked) -> None:
    page = look(served.observer_url.removeprefix(served.url))
    expect(page.locator("#connection")).to_have_attribute("data-state", "connected")
    made = assistant.propose()["proposal"]
    operator = look("/map")
    expect(operator.locator(".proposal")).to_have_count(1)
    assert page.locator(".proposal").count() == 0
    assistant.ask("decline", id=made["id"], by="Kim")
    expect(operator.locator(".proposal")).to_have_count(0)
