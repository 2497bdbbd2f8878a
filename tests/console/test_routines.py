"""A ward's routines at the console: taught, tested, changed, run by touch, handed to colleagues."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from nl2robot.console.visitor import texts
from robot_api.client import Robot
from robot_api.errors import InvalidCall, RobotError, Stopped
from tests.console.conftest import Look, Picture, Served
from tests.console.test_looks import CONTRAST, STICKS_OUT, nameless

TEA = 'robot.goto("lobby")\nrobot.say("Tea!")\n'
FILE = """\
nl2robot-routines: 1
routines:
- name: tea round
  program: |
    robot.goto("lobby")
    robot.say("Tea!")
- name: evening round
  sentence: go to the pharmacy and wave
"""


def set_down(robot: Robot) -> None:
    """By its charger. Who leaves a page while the robot moves stops it, a little later."""
    for _ in range(5):
        with suppress(Stopped):
            robot.stop()
            robot.localize("charger")
            return
    raise AssertionError("it is stopped again and again")


@pytest.fixture(autouse=True)
def _as_it_was(served: Served) -> Iterator[None]:
    """Each story begins with the evening round alone, and a robot by its charger."""
    with served.robot() as robot:
        set_down(robot)
        for each in robot.request("routines.list", {}):
            robot.request("routines.remove", {k: each[k] for k in ("name", "language")})
        new = {"name": "evening round", "language": "en", "by": "Ana"}
        robot.request("routines.keep", {**new, "sentence": "go to every ward and say good night"})
    yield


@pytest.fixture
def shelf(look: Look) -> Page:
    return opened(look("/routines"))


def opened(page: Page) -> Page:
    expect(page.locator(".routines[data-ready=yes]")).to_be_visible()
    return page


def card(page: Page, name: str) -> Locator:
    return page.get_by_role("listitem", name=name)


def known(served: Served) -> dict[str, dict]:
    with served.robot() as robot:
        return {each["name"]: each for each in robot.request("routines.list", {})}


def test_a_routine_is_run_by_touch_and_only_after_approval(
    shelf: Page, served: Served, picture: Picture
) -> None:
    evening = card(shelf, "evening round")
    expect(evening).to_contain_text("In every ward I will say “Good night”.")
    expect(evening.locator(".routine-facts")).to_contain_text("Taught by Ana on")
    expect(evening.locator(".routine-facts")).to_contain_text("never run yet")
    evening.get_by_text("Step by step").click()
    expect(evening.locator("pre")).to_contain_text('for place in robot.places("ward")')
    picture(shelf, "routines")
    evening.get_by_role("link", name="Run evening round").click()
    expect(shelf.get_by_role("button", name="Approve and run")).to_be_enabled()
    expect(shelf.locator(".said.by-you").last).to_contain_text("evening round")
    with served.robot() as robot:
        assert robot.location().place == "charger"
        shelf.get_by_role("button", name="Approve and run").click()
        expect(shelf.locator("#run-panel .chip[role=status]")).to_be_visible()
        robot.stop()
        # a stop ends whatever is asked meanwhile, such as what is known
        expect(shelf.locator("#run-panel .chip[role=status]")).to_have_text("Stopped")
    assert known(served)["evening round"]["runs"] == 1


def test_a_test_shows_the_outcome_and_the_way_and_moves_nothing(
    shelf: Page, served: Served
) -> None:
    with served.robot() as robot:
        before = robot.request("runs.list", {})["found"]
    evening = card(shelf, "evening round")
    evening.get_by_role("button", name="Test evening round").click()
    expect(evening.locator(".routine-test .outlook")).to_contain_text("It would")
    expect(evening.get_by_role("img", name="The way on the floor")).to_be_visible()
    assert evening.locator("img").evaluate("async (img) => (await img.decode(), img.naturalWidth)")
    expect(evening.locator(".routine-test")).to_contain_text("nothing has moved")
    with served.robot() as robot:
        assert robot.location().place == "charger"
        assert robot.request("runs.list", {})["found"] == before, "and is no run"


def test_a_new_routine_is_checked_while_it_is_written_and_can_be_said(
    shelf: Page, served: Served
) -> None:
    shelf.get_by_role("button", name="New routine").click()
    save = shelf.get_by_role("button", name="Save")
    shelf.get_by_label("Name", exact=True).fill("pharmacy")
    shelf.get_by_label("What to do").fill("go to the lobby and wave")
    expect(shelf.locator(".routine-check")).to_contain_text("I will go to the lobby")
    expect(shelf.locator(".routine-wrong").first).to_contain_text("cannot be called “pharmacy”")
    expect(save).to_be_disabled()
    shelf.get_by_label("Name", exact=True).fill("lobby greeting")
    expect(save).to_be_enabled()
    shelf.get_by_label("What to do").fill("fly to Mars")
    expect(shelf.locator(".routine-check .bad")).to_be_visible()
    expect(save).to_be_disabled()
    shelf.get_by_label("What to do").fill("go to the lobby and wave")
    expect(save).to_be_enabled()
    save.click()
    expect(shelf.locator("[data-part=told]")).to_contain_text("“lobby greeting” is kept")
    expect(card(shelf, "lobby greeting").get_by_role("heading")).to_be_focused()
    with served.robot() as robot:
        said = robot.request("program.translate", {"utterance": "do the lobby greeting"})
    assert said["program"] == 'robot.goto("lobby")\nrobot.gesture("wave")\n'


def test_a_change_is_checked_and_it_is_noted_whose_it_is(
    look: Look, served: Served, picture: Picture
) -> None:
    page = look("/routines")
    page.context.add_cookies([{"name": "who", "value": "Ben", "url": served.url}])
    page.reload()
    evening = card(opened(page), "evening round")
    evening.get_by_role("button", name="Edit evening round").click()
    page.get_by_label("As a program").check()
    program = page.get_by_role("textbox", name="Program")
    expect(program).to_have_value(re.compile("for place in"))  # it begins with what it did
    program.fill('robot.goto("lobby")\nrobot.fly(3)')
    expect(evening.locator(".routine-check .bad")).to_contain_text("ine 2")
    expect(evening.get_by_role("button", name="Save")).to_be_disabled()
    program.fill('robot.goto("moon base")')
    expect(evening.locator(".routine-check .bad")).to_contain_text("moon base")
    program.fill(TEA)
    expect(evening.locator(".routine-check")).to_contain_text("say “Tea!”")
    picture(page, "routines-edit")
    evening.get_by_role("button", name="Save").click()
    expect(evening.locator(".routine-facts")).to_contain_text("Taught by Ana on")
    expect(evening.locator(".routine-facts")).to_contain_text("changed by Ben on")
    kept = known(served)["evening round"]
    assert (kept["program"], kept["sentence"], kept["changed_by"]) == (TEA, "", "Ben")


def test_a_name_is_changed_and_what_was_counted_stays(shelf: Page, served: Served) -> None:
    evening = card(shelf, "evening round")
    evening.get_by_role("button", name="Rename evening round").click()
    field = evening.get_by_label("New name")
    expect(field).to_be_focused()
    field.fill("pharmacy")
    shelf.keyboard.press("Enter")
    expect(evening.get_by_role("alert")).to_contain_text("cannot be called “pharmacy”")
    field.fill("night round")
    shelf.keyboard.press("Enter")
    expect(card(shelf, "night round")).to_contain_text("formerly evening round")
    expect(card(shelf, "night round").get_by_role("heading")).to_be_focused()
    assert list(known(served)) == ["night round"]


def test_what_is_deleted_can_be_put_back_just_as_it_was(shelf: Page, served: Served) -> None:
    before = known(served)
    card(shelf, "evening round").get_by_role("button", name="Delete evening round").click()
    expect(card(shelf, "evening round")).to_have_count(0)
    assert known(served) == {}
    undo = shelf.get_by_role("button", name="Undo")
    expect(undo).to_be_focused()
    undo.click()
    expect(card(shelf, "evening round")).to_be_visible()
    assert known(served) == before


def test_a_file_is_looked_at_before_anything_of_it_is_kept(
    shelf: Page, served: Served, tmp_path: Path, picture: Picture
) -> None:
    file = tmp_path / "ward-b.yaml"
    file.write_text(FILE)
    shelf.get_by_role("button", name="Import").click()
    shelf.get_by_label("File").set_input_files(file)
    offers = shelf.locator(".routine-offers > li")
    expect(offers).to_have_count(2)
    expect(offers.first).to_contain_text("I will go to the lobby and say “Tea!”")
    expect(offers.last).to_contain_text("Another routine here has this name.")
    expect(offers.last.get_by_role("checkbox", name="evening round")).not_to_be_checked()
    assert list(known(served)) == ["evening round"]
    offers.last.get_by_label("Name").fill("pharmacy visit")
    picture(shelf, "routines-import")
    shelf.get_by_role("button", name="Import what is chosen").click()
    expect(shelf.locator("[data-part=told]")).to_contain_text("2 routines are imported")
    kept = known(served)
    assert sorted(kept) == ["evening round", "pharmacy visit", "tea round"]
    assert kept["evening round"]["by"] == "Ana", "nothing was overwritten"
    # It is nobody's word here before somebody has looked at it.
    tea = card(shelf, "tea round")
    expect(tea).to_contain_text("Not reviewed yet")
    expect(tea.get_by_role("link", name="Run tea round")).to_have_count(0)
    with served.robot() as robot:
        said = robot.request("program.translate", {"utterance": "tea round"})
        assert said["program"] is None and "nobody here has looked at it" in said["message"]
    tea.get_by_role("button", name="Review tea round").click()
    expect(tea.locator("pre")).to_be_visible()
    expect(tea.locator(".outlook")).to_contain_text("It would")
    tea.get_by_role("button", name="I have looked at it: it may be used").click()
    expect(card(shelf, "tea round").get_by_role("link", name="Run tea round")).to_be_visible()
    with served.robot() as robot:
        assert robot.request("program.translate", {"utterance": "tea round"})["program"] == TEA


def test_one_that_is_known_is_replaced_only_if_somebody_says_so(
    shelf: Page, served: Served, tmp_path: Path
) -> None:
    file = tmp_path / "ward-b.yaml"
    file.write_text(FILE)
    shelf.get_by_role("button", name="Import").click()
    shelf.get_by_label("File").set_input_files(file)
    offers = shelf.locator(".routine-offers > li")
    offers.first.get_by_role("checkbox").uncheck()
    expect(shelf.get_by_role("button", name="Import what is chosen")).to_be_disabled()
    offers.last.get_by_label("Replace the one that is here").check()
    shelf.get_by_role("button", name="Import what is chosen").click()
    expect(card(shelf, "evening round")).to_contain_text("Imported from ward-b.yaml")
    [kept] = known(served).values()
    assert (kept["sentence"], kept["reviewed"]) == ("go to the pharmacy and wave", False)


def test_a_file_that_is_wrong_is_refused_line_by_line(
    shelf: Page, served: Served, tmp_path: Path
) -> None:
    file = tmp_path / "ward-b.yaml"
    file.write_text(FILE.replace("sentence:", "sentense:").replace('"Tea!")', '"Tea!"'))
    shelf.get_by_role("button", name="Import").click()
    shelf.get_by_label("File").set_input_files(file)
    wrong = shelf.locator(".routine-found [role=alert] li")
    expect(wrong).to_have_count(2)
    expect(wrong.first).to_contain_text("ward-b.yaml:4: Line 2 of the program")
    expect(wrong.last).to_contain_text('ward-b.yaml:8: A routine has no field "sentense"')
    file.write_bytes(b"\xff\xfe")
    shelf.get_by_label("File").set_input_files(file)
    expect(shelf.locator(".routine-found [role=alert]")).to_contain_text("cannot be read")
    assert list(known(served)) == ["evening round"]


def test_a_colleague_opens_a_link_and_reviews_what_it_brings(
    shelf: Page, look: Look, served: Served
) -> None:
    card(shelf, "evening round").get_by_role("button", name="Share evening round").click()
    link = card(shelf, "evening round").get_by_label("Link").input_value()
    with shelf.expect_download() as download:
        card(shelf, "evening round").get_by_role("link", name="Download the file").click()
    assert "go to every ward" in download.value.path().read_text()
    card(shelf, "evening round").get_by_role("button", name="Delete evening round").click()
    expect(card(shelf, "evening round")).to_have_count(0)
    colleague = opened(look(link.removeprefix(served.url)))
    offer = colleague.locator(".routine-offers > li")
    expect(offer).to_contain_text("go to every ward and say good night")
    assert known(served) == {}, "to open it keeps nothing"
    colleague.get_by_role("button", name="Import what is chosen").click()
    expect(card(colleague, "evening round")).to_contain_text("Not reviewed yet")
    # Whoever looks on sees it at once.
    expect(card(shelf, "evening round")).to_contain_text("Not reviewed yet")
    again = opened(look(link.removeprefix(served.url)))
    expect(again.locator(".routine-offers > li")).to_contain_text("just so already")
    broken = opened(look("/routines#import=%%%"))
    expect(broken.locator("[data-part=told]")).to_contain_text("The link is not complete.")


def test_the_program_before_me_is_kept_under_a_name(page: Page, served: Served) -> None:
    page.get_by_label("Tell the robot what to do").fill("go to the lobby and say tea")
    page.keyboard.press("Enter")
    page.get_by_role("link", name="Keep this program").click()
    opened(page)
    expect(page.get_by_role("heading", name="Keep this program")).to_be_visible()
    expect(page.get_by_role("textbox", name="Program")).to_have_value(re.compile("lobby"))
    page.get_by_label("Name", exact=True).fill("tea call")
    expect(page.get_by_role("button", name="Save")).to_be_enabled()
    page.get_by_role("button", name="Save").click()
    expect(card(page, "tea call")).to_contain_text("Program")
    assert known(served)["tea call"]["program"].startswith('robot.goto("lobby")')


def test_the_program_of_a_run_is_kept(look: Look, served: Served) -> None:
    with served.robot() as robot:
        review = robot.request("program.check", {"program": 'robot.say("Done.")'})
        about = {"program": review["program"], "sha256": review["sha256"], "by": "Ana"}
        approval = robot.request("program.approve", about)
        run = robot.request("program.run", {"approval": approval["id"]})
        robot.request("program.wait", {"run": run})
    page = look(f"/runs/{run}")
    page.get_by_role("link", name="Keep this program").click()
    expect(page.get_by_role("textbox", name="Program")).to_have_value('robot.say("Done.")')


def test_one_taught_in_another_language_is_run_by_whoever_does_not_speak_it(
    shelf: Page, served: Served
) -> None:
    with served.robot() as robot:
        new = {"name": "Abendgruß", "language": "de", "sentence": "sag gute Nacht"}
        robot.request("routines.keep", new)
    greeting = card(shelf, "Abendgruß")
    expect(greeting).to_contain_text("I will say “Gute Nacht.”")
    expect(greeting).to_contain_text("Deutsch")
    greeting.get_by_role("link", name="Run Abendgruß").click()
    expect(shelf.locator(".cm-content")).to_have_text('robot.say("Gute Nacht.")')
    expect(shelf.locator(".said.by-robot").last).to_contain_text("I will say “Gute Nacht.”")


def test_what_is_taught_at_the_desk_stands_there_with_its_teacher(
    look: Look, shelf: Page, served: Served
) -> None:
    page = look("/")
    page.context.add_cookies([{"name": "who", "value": "Clara", "url": served.url}])
    page.reload()
    for words in ("when I say wake up call, say good morning", "yes"):
        page.get_by_label("Tell the robot what to do").fill(words)
        page.keyboard.press("Enter")
        expect(page.locator(".said.by-robot").last).to_contain_text("wake up call")
    expect(card(shelf, "wake up call")).to_contain_text("Taught by Clara")


def test_observers_look_and_change_nothing(look: Look, served: Served) -> None:
    page = opened(look(served.observer_url.removeprefix(served.url).replace("/?", "/routines?")))
    evening = card(page, "evening round")
    expect(evening).to_be_visible()
    expect(page.get_by_role("button", name="New routine")).to_have_count(0)
    expect(evening.get_by_role("button")).to_have_count(0)
    expect(evening.get_by_role("link")).to_have_count(0)
    name = {"name": "evening round", "language": "en"}
    asked = {
        "keep": name,
        "change": name,
        "rename": {**name, "new": "night round"},
        "accept": {**name, "sha256": "0" * 64},
        "remove": name,
        "restore": {"number": 1},
        "import": {"text": FILE},
        "test": name,
        "check": name,
    }
    for method, params in asked.items():
        refused = page.evaluate(
            """async ([method, params]) => {
                const {wire} = await import('/static/wire.js');
                return wire.request('routines.' + method, params).catch((error) => error.kind);
            }""",
            [method, params],
        )
        assert refused == "AccessDenied", method


def test_two_who_work_at_once_do_not_disturb_each_other(shelf: Page, served: Served) -> None:
    evening = card(shelf, "evening round")
    evening.get_by_role("button", name="Edit evening round").click()
    evening.get_by_label("What to do").fill("wave")
    with served.robot() as robot:
        new = {"name": "tea round", "language": "en", "program": TEA}
        robot.request("routines.keep", new)
    expect(card(shelf, "tea round")).to_be_visible()
    expect(evening.get_by_label("What to do")).to_have_value("wave")
    with served.robot() as robot:
        about = {"name": "tea round", "language": "en"}
        stale = robot.request("routines.show", about)["sha256"]
        robot.request("routines.change", {**about, "program": TEA + "robot.wait(1)\n"})
        with pytest.raises(RobotError, match="changed or removed since you looked"):
            robot.request("routines.accept", {**about, "sha256": stale})


def test_all_of_it_without_a_mouse(shelf: Page) -> None:
    shelf.get_by_role("button", name="New routine").focus()
    shelf.keyboard.press("Enter")
    expect(shelf.get_by_label("Name", exact=True)).to_be_focused()
    shelf.keyboard.type("tea call")
    for _ in range(8):
        shelf.keyboard.press("Tab")
        if shelf.evaluate("document.activeElement.tagName") == "TEXTAREA":
            break
    shelf.keyboard.type("say tea")
    expect(shelf.get_by_role("button", name="Save")).to_be_enabled()
    shelf.keyboard.press("Tab")
    while shelf.evaluate("document.activeElement.textContent") != "Save":
        shelf.keyboard.press("Tab")
    shelf.keyboard.press("Enter")
    expect(card(shelf, "tea call").get_by_role("heading")).to_be_focused()
    shelf.keyboard.press("Tab")  # the steps, then what can be done
    shelf.keyboard.press("Tab")
    assert shelf.evaluate("document.activeElement !== document.body")
    card(shelf, "tea call").get_by_role("button", name="Rename tea call").press("Enter")
    card(shelf, "tea call").get_by_role("button", name="Cancel").press("Enter")
    expect(card(shelf, "tea call").get_by_role("button", name="Rename tea call")).to_be_focused()


@pytest.mark.parametrize(
    ("width", "height", "dark", "language"),
    [
        (390, 844, True, "de"),
        (820, 1180, False, "fr"),
        (1280, 720, False, "en"),
        (720, 450, True, "fr"),  # 1440 x 900 at 200 %
    ],
)
def test_what_opens_in_a_card_fits_is_read_and_is_told(
    look: Look,
    served: Served,
    tmp_path: Path,
    picture: Picture,
    width: int,
    height: int,
    dark: bool,
    language: str,
) -> None:
    words = texts("routines", language)
    page = opened(look("/routines", width=width, height=height, dark=dark, language=language))
    evening = card(page, "evening round")

    def fits() -> None:
        assert page.evaluate(STICKS_OUT) == []
        assert page.evaluate(CONTRAST) == []
        assert nameless(page) == []
        expect(page.locator("#stop")).to_be_in_viewport(ratio=1)
        assert page.evaluate("document.activeElement !== document.body")

    evening.locator("summary").click()
    for act, there in (
        ("test", ".routine-test img"),
        ("edit", ".routine-check .outlook"),
        ("rename", "form input"),
        ("share", "[readonly]"),
    ):
        evening.get_by_role("button", name=f"{words[act]} evening round").click()
        expect(evening.locator(f".routine-panel {there}")).to_be_visible()
        fits()
    file = tmp_path / "ward-b.yaml"
    file.write_text(FILE)
    page.get_by_role("button", name=words["import"], exact=True).click()
    page.get_by_label(words["choose_file"]).set_input_files(file)
    expect(page.locator(".routine-offers > li")).to_have_count(2)
    fits()
    page.get_by_role("button", name=words["new"], exact=True).click()
    page.get_by_label(words["sentence"]).fill(words["sentence_example"])
    expect(page.locator(".routines-panel .routine-check .outlook")).to_be_visible()
    fits()
    picture(page, f"routines-{width}")


def test_what_is_left_out_of_a_list_is_asked_for(served: Served) -> None:
    with served.robot() as robot, pytest.raises(InvalidCall, match="language"):
        robot.request("routines.export", {"which": [{"name": "evening round"}]})
