"""What lies before an operator has to have been before their eyes before it can be approved, on
every screen and by every way of using it."""

from __future__ import annotations

import re

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.console.conftest import Look, Picture, Served
from tests.console.test_desk import approve, read_all, say
from tests.console.test_looks import CONTRAST

SIZES = [
    (1440, 900, 1.0),
    (1280, 720, 1.0),
    (820, 1180, 1.0),
    (390, 844, 1.0),
    (1440, 900, 2.0),
    (390, 844, 2.0),
]
"""Width, height and zoom; a browser that zooms has as much less room."""

LONG = "".join(f'robot.say("Sentence number {number}.")\n' for number in range(1, 61))
RECEPTION = 'while True:\n    robot.wait_for("person")\n    robot.say("Welcome!")\n'
FAILS = 'robot.say("I look for it.")\nrobot.grab("unicorn")\n'


@pytest.fixture(autouse=True)
def _at_rest(served: Served) -> None:
    with served.robot() as robot:
        robot.stop()
        robot.localize("charger")


def sized(look: Look, size: tuple[float, float, float], path: str = "/", **more: object) -> Page:
    width, height, zoom = size
    return look(path, width=round(width / zoom), height=round(height / zoom), **more)


def laid_before(look: Look, size: tuple[float, float, float], program: str, **more: object) -> Page:
    """A page with this program under review."""
    lines = program.replace("\n", "%0A").replace(" ", "%20").replace("#", "%23")
    page = sized(look, size, f"/?program={lines}", **more)
    expect(page.locator("#decide[data-review]")).to_be_attached()
    return page


def read_on(page: Page) -> Locator:
    return page.get_by_role("button", name="Read on")


def lines_in_view(page: Page) -> set[str]:
    """The lines of the program that can be read now, found out otherwise than the page does."""
    return set(
        page.evaluate(
            """() => [...document.querySelectorAll('.desk-editor .cm-line')].filter((line) => {
              const {left, top, bottom} = line.getBoundingClientRect();
              return document.elementFromPoint(left + 9, (top + bottom) / 2) === line ||
                line.contains(document.elementFromPoint(left + 9, (top + bottom) / 2));
            }).map((line) => line.textContent)"""
        )
    )


@pytest.mark.parametrize("size", SIZES)
def test_a_long_program_is_read_before_it_is_approved(
    look: Look, size: tuple[float, float, float]
) -> None:
    page = laid_before(look, size, LONG)
    approve = page.locator("#approve")
    expect(read_on(page)).to_be_visible()
    expect(approve).to_be_hidden()
    expect(approve).to_be_disabled()
    expect(page.locator("#left-to-see")).to_contain_text("Still to be seen:")
    seen = lines_in_view(page)
    for _ in range(60):
        if not read_on(page).is_visible():
            break
        assert approve.is_disabled()
        read_on(page).click()
        page.wait_for_timeout(60)
        seen |= lines_in_view(page)
    assert {line for line in LONG.splitlines() if line} <= seen
    expect(approve).to_be_enabled()
    expect(approve).to_be_in_viewport()


@pytest.mark.parametrize("size", SIZES)
def test_who_scrolls_has_seen_it_as_well(look: Look, size: tuple[float, float, float]) -> None:
    page = laid_before(look, size, LONG)
    box = page.locator(".desk-editor").bounding_box()
    assert box
    page.mouse.move(box["x"] + box["width"] / 2, size[1] / size[2] / 2)
    expect(read_on(page)).to_be_visible()
    for _ in range(200):
        if not read_on(page).is_visible():
            break
        page.mouse.wheel(0, 120)
        page.wait_for_timeout(20)
    expect(page.locator("#approve")).to_be_enabled()


def test_a_second_command_on_a_small_screen_shows_what_is_approved(
    look: Look, served: Served, picture: Picture
) -> None:
    """The button stood there at once, and nothing of the program, under the run from before."""
    page = look(width=1280, height=720)
    say(page, "say hello")
    page.locator("#approve").click()
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")
    expect(page.locator("#run-panel .code")).to_be_visible()
    say(page, "go to the pharmacy, say hello, go to the kitchen and grab a cup")
    expect(page.locator("#decide[data-review]")).to_be_attached()
    expect(page.locator("#run-panel .code")).to_be_hidden()
    expect(page.get_by_role("link", name=re.compile("See run")).first).to_be_visible()
    read_all(page)
    expect(page.locator("#approve")).to_be_enabled()
    assert "robot.grab" in " ".join(lines_in_view(page))
    picture(page, "console-second-command")


@pytest.mark.parametrize("size", [(390, 844, 1.0), (820, 1180, 1.0), (1440, 900, 2.0)])
def test_a_review_begins_in_view_and_the_run_before_it_is_folded_away(
    look: Look, size: tuple[float, float, float]
) -> None:
    """It began below the run from before, under the bar of pages."""
    page = sized(look, size)
    say(page, "say hello")
    approve(page)
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")
    say(page, "go to the pharmacy, say hello, go to the kitchen and grab a cup")
    expect(page.locator("#decide[data-review]")).to_be_attached()
    expect(page.locator("#run-panel")).to_be_hidden()
    begins = page.get_by_role("heading", name="Shall the robot do this?")
    expect(begins).to_be_in_viewport(ratio=1)
    top = page.evaluate("document.querySelector('header.frame').getBoundingClientRect().bottom")
    box = begins.bounding_box()
    assert box and top <= box["y"] < size[1] / size[2] / 2
    page.get_by_role("button", name="Reject").click()
    expect(page.locator("#run-panel")).to_be_visible()


def test_who_writes_is_left_where_they_are(look: Look) -> None:
    """A review that comes, as of a program that is changed, takes nobody from their words."""
    page = laid_before(look, (390, 844, 1.0), LONG)
    page.locator(".cm-content").click()
    page.keyboard.press("Control+End")
    before = page.locator("#decide").get_attribute("data-review")
    page.keyboard.insert_text('robot.say("Tea?")')
    expect(page.locator(f"#decide[data-review]:not([data-review='{before}'])")).to_be_attached()
    page.wait_for_timeout(100)
    expect(page.locator(".cm-line", has_text="Tea?")).to_be_in_viewport()


def test_by_keyboard_alone_nothing_is_approved_unseen(look: Look, served: Served) -> None:
    page = laid_before(look, (1280, 720, 1.0), LONG)
    expect(read_on(page)).to_be_visible()
    read_on(page).focus()
    for _ in range(200):  # who leans on the key
        if not read_on(page).is_visible():
            break
        assert page.evaluate("document.activeElement.id") == "read-on"
        page.keyboard.press("Enter")
        page.wait_for_timeout(30)
    expect(page.locator("#approve")).to_be_enabled()
    expect(page.locator("#left-to-see")).to_be_focused()
    page.keyboard.press("Enter")
    with served.robot() as robot:
        assert robot.request("program.state") is None or page.locator("#decide").is_visible()
    page.keyboard.press("Tab")
    expect(page.locator("#approve")).to_be_focused()


def test_who_does_not_see_the_screen_hears_what_is_shown(look: Look) -> None:
    page = laid_before(look, (390, 844, 1.0), FAILS + LONG)
    told = page.locator("#shown-now")
    expect(told).to_have_attribute("role", "status")
    heard = []
    expect(read_on(page)).to_be_visible()
    for _ in range(60):
        if not read_on(page).is_visible():
            break
        read_on(page).click()
        page.wait_for_timeout(100)
        heard.append(told.text_content() or "")
    everything = " ".join(heard)
    assert "unicorn" in everything
    assert "Sentence number 60." in everything


def test_what_a_dialog_covers_is_not_seen(look: Look) -> None:
    page = look(width=390, height=844)
    page.get_by_label("Settings").first.click()
    page.evaluate("window.emitEvent('desk-propose', {program: 'robot.say(\"A\")', at_once: false})")
    expect(page.locator("#decide[data-review]")).to_be_attached()
    page.evaluate("document.querySelector('.desk-editor').scrollIntoView({block: 'center'})")
    page.wait_for_timeout(900)
    assert page.locator("#approve").is_disabled()
    page.get_by_role("button", name="Close").click()
    read_all(page)
    expect(page.locator("#approve")).to_be_enabled()


@pytest.mark.parametrize(
    ("language", "change", "anyway"),
    [
        ("en", "Change it", "Run it all the same"),
        ("de", "Ändern", "Trotzdem starten"),
        ("fr", "Modifier", "Lancer quand même"),
    ],
)
def test_what_did_not_come_to_its_end_is_changed_or_insisted_on(
    look: Look, served: Served, language: str, change: str, anyway: str
) -> None:
    page = laid_before(look, (1440, 900, 1.0), FAILS, language=language)
    expect(page.locator("#approve")).to_have_count(0)
    expect(page.locator(".outlook.bad")).to_be_visible()
    expect(page.locator(".mark.risk")).to_be_visible()
    primary = page.locator("#decide .button.primary")
    expect(primary).to_have_text(change)
    primary.click()
    expect(page.locator(".cm-content")).to_be_focused()
    page.get_by_role("button", name=anyway).click()
    expect(page.locator("#run-panel")).to_have_attribute("data-state", "failed")


@pytest.mark.parametrize("dark", [False, True])
def test_a_line_that_is_marked_is_as_easy_to_read_as_the_others(look: Look, dark: bool) -> None:
    page = laid_before(look, (1440, 900, 1.0), FAILS, dark=dark)
    expect(page.locator(".line-risk span").first).to_be_visible()
    assert page.evaluate(CONTRAST) == []


@pytest.mark.parametrize(
    ("language", "goes_on", "approve"),
    [
        ("en", "go on until somebody stops it", "Approve and run"),
        ("de", "weitergehen, bis jemand es anhält", "Freigeben und starten"),
        ("fr", "jusqu'à ce que quelqu'un l'arrête", "Approuver et lancer"),
    ],
)
def test_a_reception_has_not_failed_for_that_it_has_no_end(
    look: Look, picture: Picture, language: str, goes_on: str, approve: str
) -> None:
    page = laid_before(look, (1440, 900, 1.0), RECEPTION, language=language)
    expect(page.locator(".outlook:not(.bad)")).to_contain_text(goes_on)
    expect(page.locator(".facts")).to_contain_text("Welcome!")
    expect(page.locator(".mark.risk")).to_have_count(1)  # that it has no end
    expect(page.locator("#change, #run-anyway")).to_have_count(0)
    expect(page.locator("#decide #approve.primary")).to_have_text(approve)
    read_all(page)
    picture(page, f"console-reception-{language}")
    expect(page.locator("#approve")).to_be_enabled()


def test_to_change_it_is_to_say_it_otherwise(page: Page) -> None:
    say(page, "grab the unicorn")
    page.get_by_role("button", name="Change it").click()
    line = page.get_by_label("Tell the robot what to do")
    expect(line).to_be_focused()
    expect(line).to_have_value("grab the unicorn")


def test_the_server_takes_no_other_program_than_was_shown(page: Page, served: Served) -> None:
    page.goto(f"{served.url}/?program={FAILS.replace(chr(10), '%0A').replace(' ', '%20')}")
    expect(page.locator("#decide[data-review]")).to_be_attached()
    tell = f"""([sha256, all_the_same]) =>
      window.emitEvent('desk-approve', {{program: {FAILS!r}, sha256, all_the_same}})"""
    page.evaluate(tell, ["0" * 64, True])
    expect(page.locator(".said.trouble").last).to_contain_text("has changed since its review")
    shown = page.locator("#decide").get_attribute("data-review")
    page.evaluate(tell, [shown, False])
    expect(page.locator(".said.trouble").last).to_contain_text("Run it all the same")
    expect(page.locator("#run-panel")).to_be_hidden()


def test_what_was_changed_by_hand_is_kept_with_who_changed_it(look: Look, served: Served) -> None:
    page = look()
    page.get_by_label("Settings").first.click()
    page.get_by_label("Your name").fill("Nurse Kim")
    page.get_by_role("button", name="Close").click()
    say(page, "say good morning")
    expect(page.locator("#decide[data-review]")).to_be_attached()
    page.locator(".cm-content").click()
    page.keyboard.press("Control+End")
    page.keyboard.insert_text('robot.say("Tea?")')
    expect(page.locator(".review-head .chip")).to_have_text("changed by hand")
    approve(page)
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")
    page.goto(
        served.url
        + (page.get_by_role("link", name=re.compile("See run")).first.get_attribute("href") or "")
    )
    expect(page.locator(".run-facts")).to_contain_text("Changed by hand byNurse Kim")
    expect(page.locator(".run-changes .kept")).to_contain_text("Good morning")
    expect(page.locator(".run-changes .added")).to_contain_text('robot.say("Tea?")')
    number = page.url.rpartition("/")[2]
    data = page.request.get(f"{served.url}/runs/{number}/run.json").json()
    assert (data["utterance"], data["changed_by"]) == ("say good morning", "Nurse Kim")
    assert "Tea" in data["program"] and "Tea" not in data["proposed"]
