"""What happens begins a program: chosen at the desk, said, seen above the week, pressed on the
face."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from nl2robot.review.review import digest
from tests.console.conftest import Look, Picture, Served, serving
from tests.console.test_desk import read_all, say
from tests.console.test_looks import STICKS_OUT, nameless
from tests.console.test_schedule import STORY, TEA, Ward, card, schedule


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    home: Path = tmp_path_factory.mktemp("home")
    with serving(home, "--speed", "100", program=(str(STORY),)) as served:
        yield served


@pytest.fixture
def ward(served: Served) -> Iterator[Ward]:
    """On Wednesday at ten, with nothing planned."""
    ward = Ward(served)
    ward.clock("2026-12-02T10:00")
    yield ward
    for each in ward.ask("list"):
        ward.ask("remove", id=each["appointment"]["id"])


def on(ward: Ward, what: str, sentence: str = "say it is time for tea", **trigger: Any) -> int:
    about = {"program": TEA, "sha256": digest(TEA), "by": "Nurse Kim", "sentence": sentence}
    return int(ward.ask("add", **about, trigger={"what": what, **trigger})["id"])


def face(look: Look, **more: Any) -> Page:
    page = look("/face", **more)
    expect(page.locator("body[data-ready=yes]")).to_be_attached()
    return page


def test_a_button_on_the_face_begins_what_was_approved_for_it(
    look: Look, ward: Ward, picture: Picture
) -> None:
    page = face(look, width=1280, height=800)
    expect(page.locator("#buttons")).to_be_hidden()
    number = on(ward, "pressed", text="Call a nurse")
    nurse = page.get_by_role("button", name="Call a nurse")
    expect(nurse).to_be_visible()
    size = nurse.bounding_box()
    assert size is not None and size["height"] >= 84 and size["width"] >= 200
    picture(page, "face-button")
    nurse.click()
    expect(page.locator("#notice")).to_have_text("Thank you. It begins as soon as I am free.")
    expect(nurse).to_have_attribute("aria-disabled", "true")
    ward.until(number, "done")
    expect(nurse).not_to_have_attribute("aria-disabled", "true")
    nurse.focus()
    page.keyboard.press("Enter")
    expect(page.locator("#notice")).to_have_text("That was pressed a moment ago already.")
    assert ward.of(number)["came"] == 1
    ward.ask("pause", id=number)
    expect(page.locator("#buttons")).to_be_hidden()
    ward.ask("resume", id=number)
    expect(nurse).to_be_visible()
    ward.ask("remove", id=number)
    expect(page.locator("#buttons")).to_be_hidden()


def test_several_buttons_have_room_on_every_face(look: Look, ward: Ward, picture: Picture) -> None:
    for name in ("Call a nurse", "Bring me water", "Take me to the reception", "Tea"):
        on(ward, "pressed", name, text=name)
    page = face(look, width=390, height=844, has_touch=True, dark=True)
    expect(page.locator("#buttons button")).to_have_count(4)
    assert page.evaluate(STICKS_OUT) == []
    assert nameless(page) == []
    picture(page, "face-buttons-phone")
    page.set_viewport_size({"width": 1024, "height": 600})
    box = page.locator("#figure").bounding_box()
    assert box is not None and box["height"] > 150  # there is a face above them
    picture(page, "face-buttons-tablet")
    with ward.served.robot() as robot:
        robot.show("Visitors please wait in the lobby.")
    expect(page.locator(".shown-text")).to_be_visible()
    expect(page.get_by_role("button", name="Tea")).to_be_in_viewport()
    picture(page, "face-buttons-text")
    with ward.served.robot() as robot:
        robot.show("")


def test_who_looks_on_sees_no_button(look: Look, ward: Ward) -> None:
    on(ward, "pressed", text="Call a nurse")
    token = ward.served.observer_url.rpartition("=")[2]
    page = look(f"/face?token={token}")
    expect(page.locator("body[data-ready=yes]")).to_be_attached()
    expect(page.locator("#buttons")).to_be_hidden()


def test_an_event_is_chosen_at_the_desk(look: Look, ward: Ward, picture: Picture) -> None:
    page = look("/")
    say(page, "say it is time for tea")
    read_all(page)
    page.get_by_role("button", name="Later …").click()
    form = page.get_by_role("dialog")
    form.get_by_role("combobox", name="It begins").select_option("event")
    expect(page.get_by_role("dialog", name="When something happens")).to_be_visible()
    expect(form.get_by_label("Time", exact=True)).to_be_hidden()
    what = form.locator("select[name=event]")
    what.select_option("seen")
    form.get_by_role("combobox", name="Where").select_option("lobby")
    picture(page, "schedule-event-form")
    what.select_option("battery")
    form.get_by_label("Below how many percent").fill("35")
    what.select_option("pressed")
    form.get_by_role("button", name="Approve for this event").click()  # no name: it stays open
    expect(form).to_be_visible()
    form.get_by_label("What stands on the button").fill("Tea, please")
    form.get_by_label("At most once in how many minutes").fill("60")
    form.get_by_label("Of several that wait").select_option("7")
    form.get_by_label("Approved until").fill("2026-12-31")
    form.get_by_role("button", name="Approve for this event").click()
    expect(page.locator(".said.done").last).to_contain_text(
        "Planned: when “Tea, please” is pressed on its face, at most every hour."
    )
    [planned] = ward.ask("list")
    kept = planned["appointment"]
    assert kept["trigger"] == {"what": "pressed", "text": "Tea, please", "every": 3600.0}
    assert (kept["priority"], kept["rhythm"]) == (7, None)


def test_a_standing_order_is_said_and_approved(look: Look, ward: Ward) -> None:
    page = look("/")
    say(page, "whenever the battery is below 20 %, say it is time for tea")
    expect(page.locator(".said").last).to_contain_text("When the battery falls below 20 %")
    read_all(page)
    expect(page.locator("#approve")).to_have_count(0)
    page.get_by_role("button", name="When it happens …").click()
    form = page.get_by_role("dialog", name="When something happens")
    expect(form.locator("select[name=event]")).to_have_value("said")
    form.get_by_role("button", name="Approve for this event").click()
    expect(page.locator(".said.done").last).to_contain_text("Planned: when the battery falls")
    [planned] = ward.ask("list")
    assert planned["appointment"]["trigger"] == {"what": "battery", "below": 20}
    assert planned["appointment"]["sentence"] == "say it is time for tea"


def test_once_or_each_time_is_asked_back(look: Look, ward: Ward) -> None:
    page = look("/")
    say(page, "when somebody comes into the lobby, say it is time for tea")
    expect(page.locator(".said").last).to_contain_text("Each time that this happens, or only once")
    say(page, "each time")
    expect(page.locator(".said").last).to_contain_text("When the robot sees somebody come")
    page.get_by_role("button", name="Reject", exact=True).click()


def test_events_stand_above_the_week(look: Look, ward: Ward, picture: Picture) -> None:
    number = on(ward, "pressed", "bring tea", text="Tea")
    on(ward, "battery", "go and charge", below=20, every=1800)
    ward.add("go to ward a and say good morning", "FREQ=DAILY", "2026-11-30T08:00")
    page = face(look)
    page.get_by_role("button", name="Tea").click()
    ward.until(number, "done")
    page = schedule(look)
    rows = page.locator(".event")
    expect(rows).to_have_count(2)
    tea = rows.filter(has_text="bring tea")
    expect(tea).to_contain_text("Last time: Wed 2 Dec, 10:00, once in all")
    expect(rows.filter(has_text="go and charge")).to_contain_text(
        "when the battery falls below 20 %, at most every 30 minutes"
    )
    expect(rows.filter(has_text="go and charge")).to_contain_text("never yet")
    expect(page.locator("td .time.good", has_text="bring tea")).to_be_visible()
    picture(page, "schedule-events")
    tea.get_by_role("button", name="Pause").click()
    expect(tea.locator(".chip")).to_have_text("Paused")
    expect(card(page, number).locator(".chip")).to_have_text("Paused")
    expect(tea.get_by_role("button", name="Resume")).to_be_focused()
    tea.get_by_role("button", name="Resume").click()
    expect(tea.locator(".chip")).to_have_count(0)
    page.set_viewport_size({"width": 390, "height": 844})
    assert page.evaluate(STICKS_OUT) == []
    assert nameless(page) == []
    picture(page, "schedule-events-phone")
    page.emulate_media(color_scheme="dark")
    page.set_viewport_size({"width": 1280, "height": 800})
    picture(page, "schedule-events-dark")
    tea.get_by_role("button", name="Remove").click()
    card(page, number).locator(".panel").get_by_role("button", name="Remove").click()
    expect(rows).to_have_count(1)
