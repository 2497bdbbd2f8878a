"""The page of the appointments: a week of a ward, seen, called off, approved anew, and told of."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from queue import SimpleQueue
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

from nl2robot.review.review import digest
from tests.console.conftest import Look, Picture, Served, serving
from tests.console.test_desk import read_all, say
from tests.console.test_looks import STICKS_OUT, nameless
from tests.schedule.conftest import at

ZURICH = "Europe/Zurich"
ROUND = 'robot.goto("ward a")\nrobot.say("Good morning.")\n'
TEA = 'robot.say("It is time for tea.")\n'
REMINDER = """\
if robot.find("=Henry"):
    robot.say("Please drink.")
    reminder_done = robot.ask("Have you done it?", ["yes", "no"])
"""
STORY = Path(__file__).with_name("scheduled_console.py")


class Ward:
    """A station with its clock, and a nurse at a client of it."""

    def __init__(self, served: Served) -> None:
        self.served = served

    def clock(self, local: str) -> None:
        process = self.served.process
        assert process.stdin is not None and process.stdout is not None
        process.stdin.write(f"{local}\n")
        process.stdin.flush()
        while process.stdout.readline().strip() != local:
            pass
        self.now = at(local)

    def ask(self, method: str, **given: Any) -> Any:
        with self.served.robot() as robot:
            return robot.request(f"schedule.{method}", given)

    def add(self, sentence: str, rule: str | None, begins: str, **given: Any) -> int:
        program = given.pop("program", ROUND)
        about = {
            "program": program,
            "sha256": digest(program),
            "by": "Nurse Kim",
            "sentence": sentence,
            "rhythm": {"begins": begins, "zone": ZURICH, "rule": rule},
            **given,
        }
        return int(self.ask("add", **about)["id"])

    def until(self, number: int, state: str) -> None:
        """Wait for what became of the last time of an appointment."""
        with self.served.robot() as robot:
            heard: SimpleQueue[str] = SimpleQueue()
            robot.subscribe(("schedule", "notice"), lambda kind, data: heard.put(kind))
            while self.of(number)["state"] != state:
                heard.get(timeout=30)

    def of(self, number: int) -> dict[str, Any]:
        [found] = [each for each in self.ask("list") if each["appointment"]["id"] == number]
        return dict(found)


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    home = tmp_path_factory.mktemp("home")
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


def schedule(look: Look, **more: Any) -> Page:
    page = look("/schedule", timezone_id="America/New_York", **more)
    expect(page.locator("#schedule")).to_have_attribute("data-ready", "yes")
    return page


def card(page: Page, number: int) -> Locator:
    return page.locator(f"#appointment-{number}")


def press(card: Locator, name: str) -> None:
    card.get_by_role("button", name=name, exact=True).click()


def column(page: Page, day: str) -> list[str]:
    """What stands on the cards of a day in the table, from morning to evening."""
    place = page.locator("thead th").all_inner_texts().index(day)
    cells = page.locator(f"tbody td:nth-child({place + 2}) .time")
    return [re.sub(r"\s+", " ", text) for text in cells.all_inner_texts()]


def test_a_week_of_the_ward(look: Look, ward: Ward, picture: Picture) -> None:
    ward.clock("2026-11-30T07:00")
    morning = ward.add("go to ward a and say good morning", "FREQ=DAILY", "2026-11-30T08:00")
    ward.add(
        "say it is time for tea",
        "FREQ=DAILY;BYHOUR=14,15;BYMINUTE=0,15,30,45",
        "2026-12-03T00:00",
        program=TEA,
    )
    ward.clock("2026-11-30T08:00")
    ward.until(morning, "done")
    ward.clock("2026-12-02T10:00")  # it was off over night, and until now
    ward.until(morning, "missed")
    ward.ask("skip", id=morning, date="2026-12-03")
    page = schedule(look)
    expect(page.locator("#week-title")).to_have_text("30 November to 6 December")
    [monday] = column(page, "Mon 30 Nov")
    assert monday.startswith("08:00 go to ward a and say good morning every day at 08:00 done Run")
    expect(page.locator("td .time.good a.run")).to_have_attribute("href", re.compile(r"/runs/\d+"))
    assert "missed: nl2robot was not running" in column(page, "Tue 1 Dec")[0]
    thursday = column(page, "Thu 3 Dec")
    assert thursday[0].endswith("called off")
    expect(page.locator("s", has_text="good morning").first).to_be_visible()
    assert thursday[1].startswith("14:00 – 14:45 (4 times) say it is time for tea")
    assert column(page, "Fri 4 Dec")[0] == (
        "08:00 go to ward a and say good morning every day at 08:00"
    )
    assert page.locator("td.today .now").inner_text() == "It is 10:00"
    picture(page, "schedule")
    page.get_by_role("button", name="Week after").click()
    expect(page.locator("#week-title")).to_have_text("7 December to 13 December")
    expect(page.locator(".now")).to_have_count(0)
    page.get_by_role("button", name="This week").click()
    expect(page.locator("#week-title")).to_have_text("30 November to 6 December")
    page.set_viewport_size({"width": 390, "height": 844})
    today = page.locator(".week-days section", has_text="today")
    expect(today.get_by_role("listitem")).to_have_text([re.compile("08:00"), "It is 10:00"])
    assert page.evaluate(STICKS_OUT) == []
    assert nameless(page) == []
    picture(page, "schedule-phone")
    page.emulate_media(color_scheme="dark")
    page.set_viewport_size({"width": 1280, "height": 800})
    picture(page, "schedule-dark")


def test_a_nurse_calls_off_pauses_and_removes(look: Look, ward: Ward) -> None:
    number = ward.add("go to ward a and say good morning", "FREQ=DAILY", "2026-11-30T08:00")
    page = schedule(look)
    it = card(page, number)
    expect(it).to_contain_text("every day at 08:00")
    expect(it).to_contain_text("by Nurse Kim, until 1 January 2027")
    expect(it).to_contain_text("The simulated robot")
    expect(it.locator("dd").first).to_have_text("Thu 3 Dec, 08:00")
    press(it, "Not tomorrow")
    expect(it.locator("dd").first).to_have_text("Fri 4 Dec, 08:00")
    expect(page.locator(".schedule-told")).to_have_text("Called off: Thu 3 Dec, 08:00.")
    press(it, "Not this time")
    expect(it.locator("s")).to_have_text(["Thu 3 Dec, 08:00", "Fri 4 Dec, 08:00"])
    it.get_by_role("button", name="Do it after all").first.click()
    expect(it.locator("dd").first).to_have_text("Thu 3 Dec, 08:00")
    press(it, "Pause")
    expect(it.locator(".chip")).to_have_text("Paused")
    expect(page.locator("td .time[data-state=paused]").first).to_contain_text("paused")
    assert ward.of(number)["appointment"]["paused"]
    press(it, "Resume")
    expect(it.locator(".chip")).to_have_count(0)
    press(it, "History")
    expect(it.locator(".history li")).to_have_text(
        ["Fri 4 Dec, 08:00: skipped: somebody called it off"]
    )
    press(it, "Remove")
    expect(it.locator(".panel")).to_contain_text("Remove “go to ward a and say good morning”?")
    expect(it.get_by_role("button", name="Keep it")).to_be_focused()
    page.keyboard.press("Enter")
    expect(it.get_by_role("button", name="Remove", exact=True)).to_be_focused()
    page.keyboard.press("Enter")
    page.keyboard.press("Shift+Tab")
    page.keyboard.press("Enter")
    expect(page.locator(".appointments")).to_contain_text("There are no appointments yet.")
    expect(page.locator("#all-title")).to_be_focused()
    assert ward.ask("list") == []


def test_what_waits_for_an_approval_is_read_and_approved_anew(
    look: Look, ward: Ward, picture: Picture
) -> None:
    long = ROUND + "".join(f'robot.say("Word {number}.")\n' for number in range(40))
    number = ward.add(
        "go to ward a and talk",
        "FREQ=DAILY",
        "2026-11-30T03:00",
        program=long,
        until=ward.now + 3600,
    )
    page = schedule(look, width=820, height=700)
    it = card(page, number)
    expect(it).to_be_visible()
    ward.clock("2026-12-02T12:00")
    expect(it.locator(".chip")).to_have_text("Waits for approval")
    expect(it).to_contain_text("The approval has ended.")
    press(it, "Review it")
    approve = it.get_by_role("button", name="Approve anew")
    expect(approve).to_be_disabled()
    expect(it.locator(".outlook")).to_be_visible()
    expect(it).to_contain_text("at night")  # at noon it is approved for three
    expect(it).to_contain_text("Read to the end, then you can approve it.")
    picture(page, "schedule-approval")
    it.locator(".code li").last.scroll_into_view_if_needed()
    expect(approve).to_be_disabled()  # the middle was jumped over
    for _ in range(60):
        if approve.is_enabled():
            break
        page.evaluate("scrollBy(0, -150)")
        page.wait_for_timeout(30)
    it.get_by_label("Approved until").fill("2026-12-24")
    approve.click()
    expect(page.locator(".schedule-told")).to_have_text(
        "“go to ward a and talk” is approved until 24 December 2026."
    )
    expect(it.locator(".chip")).to_have_count(0)
    expect(it).to_contain_text("by operator, until 24 December 2026")
    expect(it.locator("h3")).to_be_focused()
    kept = ward.of(number)["appointment"]
    assert kept["asked"] is None and kept["sha256"] == digest(long)


def test_a_reviewed_program_is_planned_at_the_desk(
    look: Look, ward: Ward, picture: Picture
) -> None:
    page = look("/")
    say(page, "say it is time for tea")
    read_all(page)
    at_times = page.get_by_role("button", name="Later …")
    expect(at_times).to_be_enabled()
    at_times.click()
    form = page.get_by_role("dialog", name="Later or repeatedly")
    expect(form.get_by_label("What it is")).to_have_value("say it is time for tea")
    picture(page, "schedule-form")
    form.locator("select[name=kind]").select_option("chosen")
    form.get_by_label("Time", exact=True).fill("14:00")
    form.get_by_role("button", name="Approve for these times").click()
    expect(form.get_by_role("alert")).to_have_text("Choose at least one day.")
    form.get_by_role("checkbox", name="Monday").check()
    form.get_by_role("checkbox", name="Thursday").check()
    form.get_by_label("Approved until").fill("2026-12-31")
    form.get_by_role("combobox", name="If it was missed").select_option("60")
    form.get_by_role("button", name="Approve for these times").click()
    expect(page.locator(".said.done").last).to_contain_text(
        "Planned: every Monday and Thursday at 14:00."
    )
    expect(page.locator("#decide")).to_have_count(0)
    [planned] = ward.ask("list")
    assert planned["appointment"]["makes_up"] == 60
    assert planned["appointment"]["approved_by"] == "operator"
    assert planned["appointment"]["approved_until"] == at("2027-01-01 00:00")
    assert planned["appointment"]["sha256"] == digest(planned["appointment"]["program"])
    page.get_by_role("link", name="See the schedule").click()
    expect(card(page, planned["appointment"]["id"])).to_be_in_viewport()


def test_times_that_were_said_are_in_the_form_already(look: Look, ward: Ward) -> None:
    page = look("/")
    say(page, "every weekday from 9 to 11 every 30 minutes go to ward a and say good morning")
    read_all(page)
    expect(page.locator("#approve")).to_have_count(0)  # it was not meant for now
    page.locator("#at-times").click()
    form = page.get_by_role("dialog", name="Later or repeatedly")
    expect(form.locator("select[name=kind]")).to_have_value("said")
    form.get_by_role("button", name="Approve for these times").click()
    expect(page.locator(".said.done").last).to_contain_text("Planned: every 30")
    [planned] = ward.ask("list")
    assert planned["appointment"]["sentence"] == "go to ward a and say good morning"


def test_what_is_new_at_that_time_of_day_is_shown_before_it_is_approved(
    look: Look, ward: Ward
) -> None:
    page = look("/")
    say(page, "set the volume to 100 and say hello")
    read_all(page)
    page.locator("#at-times").click()
    form = page.get_by_role("dialog", name="Later or repeatedly")
    form.get_by_label("Time", exact=True).fill("02:30")
    form.get_by_role("button", name="Approve for these times").click()
    expect(form.get_by_role("alert")).to_contain_text("At that time there is this to mind as well.")
    assert ward.ask("list") == []
    form.get_by_role("button", name="Approve for these times").click()
    expect(page.locator(".said.done").last).to_contain_text("Planned: every day at 02:30.")


NOTIFIED = """
    window.told = [];
    window.Notification = class extends EventTarget {
        static permission = 'default';
        static requestPermission() { return Promise.resolve((this.permission = 'granted')); }
        constructor(title, {body, tag, lang}) { super(); told.push({title, body, tag, lang}); }
    };
"""


def test_what_was_missed_is_told_on_every_page_and_by_the_browser(
    look: Look, ward: Ward, picture: Picture
) -> None:
    number = ward.add("go to ward a", "FREQ=DAILY", "2026-12-02T11:00")
    page = look("/schedule", language="de", width=1100)
    page.add_init_script(NOTIFIED)
    page.add_init_script(
        "localStorage.setItem('notices-seen', localStorage.getItem('notices-seen') ?? '0')"
    )
    page.reload()
    page.get_by_role("button", name="Auf diesem Gerät benachrichtigen").click()
    expect(page.get_by_role("button", name="Hier nicht mehr benachrichtigen")).to_be_visible()
    page.evaluate("localStorage.setItem('notices-seen', 1e6)")  # all of before
    page.evaluate("Notification.permission")
    page.goto(page.url.replace("/schedule", "/runs"))
    page.evaluate("Notification.permission = 'granted'")  # which a browser keeps
    ward.clock("2026-12-02T13:00")
    told = "«go to ward a» war am Mittwoch, 2. Dezember 2026, um 11:00 fällig und wurde nicht getan"
    expect(page.locator(".toast")).to_contain_text(told)
    picture(page, "schedule-notice")
    bell = page.locator("#bell")
    expect(bell).to_have_attribute("aria-label", re.compile("Meldungen, [1-9]"))
    page.wait_for_function("told.length > 0")
    [notified] = page.evaluate("told")
    assert told in notified["body"] and notified["lang"] == "de"
    assert notified["title"] == "Der simulierte Roboter: Meldung"
    page.get_by_role("button", name="Schließen").first.click()
    expect(page.locator(".toast")).to_have_count(0)
    bell.click()
    expect(page.locator("#notices li.unseen").first).to_contain_text(told)
    page.keyboard.press("Escape")
    expect(bell).to_have_attribute("aria-label", "Meldungen")
    ward.clock("2026-12-03T13:00")
    expect(page.locator("#bell .count")).to_have_text("1")
    page.reload()
    expect(page.locator("#bell .count")).to_have_text("1")
    ward.ask("remove", id=number)


def test_who_looks_on_sees_all_of_it_and_changes_nothing(look: Look, ward: Ward) -> None:
    number = ward.add("go to ward a", "FREQ=DAILY", "2026-12-02T11:00")
    page = look("", url=ward.served.observer_url)
    page.goto(f"{ward.served.url}/schedule")
    it = card(page, number)
    expect(it).to_contain_text("go to ward a")
    expect(page.locator("#schedule")).to_contain_text("You look on.")
    assert it.get_by_role("button").all_inner_texts() == ["Program", "History"]
    press(it, "Program")
    expect(it.locator(".code")).to_contain_text('robot.goto("ward a")')
    expect(it.locator("form")).to_have_count(0)


def test_who_plans_late_in_the_evening_plans_for_tomorrow(look: Look, ward: Ward) -> None:
    ward.clock("2026-12-02T23:10")
    page = schedule(look)
    page.goto(f"{ward.served.url}/?program=robot.say(%22Tea%22)")
    read_all(page)
    page.locator("#at-times").click()
    page.locator(".times-form select[name=kind]").select_option("once")
    expect(page.locator(".times-form input[type=time]:enabled")).to_have_value("00:00")
    expect(page.locator(".times-form input[type=date]:enabled").first).to_have_value("2026-12-03")


@pytest.mark.parametrize("language", ["de", "fr"])
def test_the_form_and_the_page_fit_a_phone_in_every_language(
    look: Look, ward: Ward, language: str
) -> None:
    number = ward.add("go to ward a", "FREQ=DAILY", "2026-12-02T11:00", makes_up=60)
    page = schedule(look, language=language, width=320, height=640)
    for button in ("history", "remove"):
        card(page, number).locator(f"[data-act={button}]").click()
        expect(card(page, number).locator(".panel > *").first).to_be_visible()
        assert page.evaluate(STICKS_OUT) == []
    assert nameless(page) == []
    page.goto(f"{ward.served.url}/?program=robot.say(%22Tee%22)")
    read_all(page)
    page.locator("#at-times").click()
    expect(page.locator(".times-form")).to_be_visible()
    for kind in ("once", "chosen", "passing"):
        page.locator(".times-form select[name=kind]").select_option(kind)
        assert page.evaluate(STICKS_OUT) == []
        assert page.evaluate("document.querySelector('.times-form').scrollWidth") <= 320
    assert nameless(page) == []


def test_what_came_of_a_reminder_stands_in_a_table_that_can_be_saved(
    look: Look, ward: Ward
) -> None:
    ward.add("remind somebody to drink", None, "2026-12-02T10:05", program=REMINDER, insists=True)
    page = schedule(look)
    ward.clock("2026-12-02T10:05")
    row = page.locator(".reminders tbody tr", has_text="=Henry")
    expect(row).to_contain_text("2 Dec, 10:05")
    expect(row).to_contain_text("answered")
    with page.expect_download() as saved:
        page.get_by_role("link", name="Save as CSV").click()
    text = Path(saved.value.path()).read_text(encoding="utf-8-sig")
    assert text.startswith("due,said,person,what,") and ",'=Henry,Please drink.," in text
    assert "2026-12-02T10:05:00+01:00" in text
