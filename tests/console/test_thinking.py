"""What the rules do not know, a language model thinks about: what people see of it meanwhile, how
they end it, and how they are told who has written a program."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from tests.console.conftest import Look, Picture, Served, serving
from tests.console.test_desk import approve, read_all, say
from tests.console.test_looks import CONTRAST, STICKS_OUT, nameless
from tests.console.writing_console import CHEER, EITHER, JOKE, TEA

CONSOLE = Path(__file__).parent / "writing_console.py"
DROPPED = "I have stopped thinking about it."

Tell = Callable[[str], None]


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    home = tmp_path_factory.mktemp("home")
    with serving(home, "--speed", "1", program=[str(CONSOLE)]) as served:
        yield served


@pytest.fixture
def writer(served: Served) -> Iterator[Tell]:
    """Tell the model to "hold", to "go on", or wait until it is "idle"; it is held at first."""
    tell(served, "hold")
    yield lambda order: tell(served, order)
    tell(served, "go on")


def tell(served: Served, order: str) -> None:
    """Wait until the console has done what it was told."""
    stdin, stdout = served.process.stdin, served.process.stdout
    assert stdin is not None and stdout is not None
    stdin.write(f"{order}\n")
    stdin.flush()
    for line in stdout:
        if line.strip() == order:
            return


def thought(page: Page) -> Locator:
    return page.locator("#thought")


def line(page: Page) -> Locator:
    return page.locator("#words")


def thinks(page: Page, words: str = TEA) -> None:
    """Have something said that is thought about, and held there."""
    line(page).fill(words)
    line(page).press("Enter")
    expect(thought(page)).to_contain_text("robot.goto(")


def last_said(page: Page) -> Locator:
    return page.locator(".said").last


def test_the_program_grows_while_it_is_written_and_is_then_reviewed(
    page: Page, writer: Tell, picture: Picture
) -> None:
    thinks(page)
    expect(thought(page)).to_contain_text("I am thinking")
    expect(line(page)).to_have_value("")
    picture(page, "console-thinking")
    writer("go on")
    expect(page.locator(".cm-content")).to_contain_text('robot.say("Tea!")')
    expect(thought(page)).to_be_hidden()
    review = page.get_by_role("region", name="Review")
    expect(review).to_contain_text("Written by a language model: read it before you approve.")
    expect(review.locator(".by-model")).to_contain_text("wheel")
    expect(review.locator(".reading")).to_contain_text("say “Tea!”")
    picture(page, "console-by-model")
    page.locator(".cm-content").click()
    page.keyboard.press("Control+End")
    page.keyboard.type("robot.wait(1)")
    expect(review).to_contain_text("changed by hand")
    expect(review).to_contain_text("Written by a language model")
    approve(page)
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Running")
    page.get_by_role("button", name="STOP").click()
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Stopped")


def test_what_the_rules_know_says_nothing_of_a_model(page: Page) -> None:
    say(page, "go to the lobby")
    expect(page.get_by_role("button", name="Approve and run")).to_be_enabled()
    expect(page.locator(".by-model")).to_have_count(0)
    expect(thought(page)).to_be_hidden()


def test_what_the_model_would_say_of_its_own_is_told(page: Page, writer: Tell) -> None:
    writer("go on")
    say(page, JOKE)
    own = page.locator(".by-model")
    expect(own).to_contain_text("of the model's own knowledge; see whether it is true")
    expect(own).to_contain_text("Why did the robot cross the road?")


def test_a_cancelled_sentence_comes_back_to_be_changed(page: Page, writer: Tell) -> None:
    thinks(page)
    page.get_by_role("button", name="Cancel").click()
    expect(thought(page)).to_be_hidden()
    expect(last_said(page)).to_contain_text(DROPPED)
    expect(line(page)).to_have_value(TEA)
    expect(line(page)).to_be_focused()
    writer("idle")
    line(page).fill("go to the lobby")
    line(page).press("Enter")
    expect(page.get_by_role("button", name="Approve and run")).to_be_enabled()
    expect(page.locator(".said", has_text=DROPPED)).to_have_count(1)


def test_what_was_cancelled_is_as_if_nobody_had_said_it(page: Page, writer: Tell) -> None:
    say(page, "go to the pharmacy")
    expect(page.get_by_role("button", name="Approve and run")).to_be_enabled()
    thinks(page)
    page.get_by_role("button", name="Cancel").click()
    expect(last_said(page)).to_contain_text(DROPPED)
    say(page, "no, to radiology")
    expect(page.locator(".cm-content")).to_have_text('robot.goto("radiology")')


def test_escape_cancels_and_leaves_what_was_typed_since(page: Page, writer: Tell) -> None:
    thinks(page)
    line(page).fill("something else")
    page.keyboard.press("Escape")
    expect(thought(page)).to_be_hidden()
    expect(last_said(page)).to_contain_text(DROPPED)
    expect(line(page)).to_have_value("something else")
    expect(page.get_by_role("alert")).to_have_text("The robot was stopped.")
    writer("idle")


def test_who_stops_the_robot_anywhere_ends_the_thinking(
    page: Page, served: Served, writer: Tell
) -> None:
    thinks(page)
    with served.robot() as robot:
        robot.stop()
    expect(thought(page)).to_be_hidden()
    expect(line(page)).to_have_value(TEA)
    writer("idle")


def test_a_new_sentence_takes_the_place_of_the_one_before(page: Page, writer: Tell) -> None:
    thinks(page)
    say(page, "go to the pharmacy")
    expect(page.locator(".cm-content")).to_have_text('robot.goto("pharmacy")')
    expect(page.locator(".said", has_text=DROPPED)).to_have_count(1)
    expect(line(page)).to_have_value("")
    writer("idle")


def test_meanwhile_all_else_goes_on(page: Page, look: Look, served: Served, writer: Tell) -> None:
    say(page, "say one")
    expect(page.get_by_role("button", name="Approve and run")).to_be_enabled()
    thinks(page)
    approve(page)  # the program from before
    expect(last_said(page)).to_contain_text("One. See run")
    colleague = look()
    say(colleague, "go to the pharmacy")
    expect(colleague.get_by_role("button", name="Approve and run")).to_be_enabled()
    expect(colleague.locator("#desk-map .floor-told")).to_contain_text(re.compile(r"\w"))
    expect(thought(page)).to_be_visible()
    expect(thought(colleague)).to_be_hidden()
    writer("go on")
    expect(page.locator(".cm-content")).to_contain_text('robot.say("Tea!")')


def test_a_page_that_is_loaded_anew_finds_the_thought_and_one_that_is_closed_ends_it(
    page: Page, served: Served, writer: Tell
) -> None:
    thinks(page)
    page.reload()
    expect(thought(page)).to_contain_text("robot.goto(")
    page.close()
    writer("idle")


PONDER = """(program) =>
  emitEvent('desk-ponder', {microphone: 3, text: 'wheel it in', program})"""
"""What the desk's script says when its microphone is told of a thought."""


def test_what_was_spoken_is_thought_about_in_the_same_bubble(page: Page) -> None:
    page.evaluate(PONDER, "")
    expect(page.locator(".said.by-you")).to_have_text(re.compile("wheel it in"))
    page.evaluate(PONDER, "robot.goto(")
    expect(thought(page)).to_contain_text("robot.goto(")
    page.get_by_role("button", name="Cancel").click()
    expect(thought(page)).to_be_hidden()
    page.evaluate(PONDER, "robot.goto('lobby')")  # told late
    say(page, "go to the pharmacy")
    expect(page.get_by_role("button", name="Approve and run")).to_be_enabled()
    expect(thought(page)).to_be_hidden()
    expect(page.locator(".said.by-you")).to_have_count(2)


def test_who_closes_the_page_that_heard_it_ends_that_thought(page: Page) -> None:
    page.evaluate(PONDER, "robot.goto(")
    expect(thought(page)).to_be_visible()
    page.reload()
    expect(last_said(page)).to_contain_text(DROPPED)
    expect(thought(page)).to_be_hidden()


def test_a_question_which_of_two_is_meant_is_answered_with_a_click(
    page: Page, writer: Tell, picture: Picture
) -> None:
    writer("go on")
    say(page, EITHER)
    expect(last_said(page)).to_contain_text("Shall I say “Hello!”, or say “Good morning!”?")
    picture(page, "console-either")
    last_said(page).get_by_role("button", name="say “Good morning!”").click()
    expect(page.locator(".cm-content")).to_contain_text('robot.say("Good morning!")')


@pytest.mark.parametrize(("width", "height"), [(390, 844), (320, 640), (1440, 900)])
@pytest.mark.parametrize("dark", [False, True])
def test_it_is_read_on_a_phone_and_in_the_dark(
    look: Look, writer: Tell, picture: Picture, width: int, height: int, dark: bool
) -> None:
    page = look(width=width, height=height, dark=dark, language="de")
    name = f"thinking-{width}-{'dark' if dark else 'light'}"
    thinks(page, CHEER)
    picture(page, name)
    assert page.evaluate(STICKS_OUT) == []
    assert page.evaluate(CONTRAST) == []
    assert nameless(page) == []
    writer("go on")
    expect(page.locator(".by-model")).to_contain_text("Von einem Sprachmodell geschrieben")
    read_all(page)
    expect(page.get_by_role("button", name="Freigeben und starten")).to_be_enabled()
    page.locator(".by-model").scroll_into_view_if_needed()
    picture(page, f"{name}-review")
    assert page.evaluate(STICKS_OUT) == []
    assert page.evaluate(CONTRAST) == []
    assert nameless(page) == []
