"""A nurse at the desk: she says what to do, sees what it means, decides, watches, stops."""

from __future__ import annotations

import re
from threading import Event
from urllib.parse import quote

import pytest
from playwright.sync_api import Page, expect

from tests.console.conftest import SOON, Look, Picture, Served


def say(page: Page, words: str) -> None:
    page.get_by_label("Tell the robot what to do").fill(words)
    page.keyboard.press("Enter")


def read_all(page: Page) -> None:
    """Look at all that is laid before one, as far as the screen shows it at once."""
    expect(page.locator("#decide[data-review]")).to_be_attached()
    decided = page.locator("#decide [data-decides]:enabled:visible")
    for _ in range(SOON // 60):
        if decided.count():
            return
        page.evaluate("document.querySelector('#read-on:not([hidden])')?.click()")
        page.wait_for_timeout(60)
    raise AssertionError("there is no end of reading on")


def approve(page: Page, name: str = "Approve and run") -> None:
    """Look at everything, then press the button, which has that name in the page's language."""
    read_all(page)
    button = page.get_by_role("button", name=name)
    expect(button).to_be_enabled()
    button.click()


@pytest.fixture(autouse=True)
def _at_rest(served: Served) -> None:
    """Each story begins with a robot that stands by its charger."""
    with served.robot() as robot:
        robot.stop()
        robot.localize("charger")


def test_say_hello_from_end_to_end(page: Page, served: Served, picture: Picture) -> None:
    expect(page.get_by_role("heading", name="What should the robot do?")).to_be_visible()
    picture(page, "console-empty")
    with served.robot() as robot:
        spoken: list[str] = []
        robot.subscribe(["speech"], lambda kind, data: spoken.append(data["text"]))
        say(page, "say hello")
        expect(page.locator(".said.by-robot").last).to_have_text(re.compile("I will say “Hello!”"))
        expect(page.locator(".cm-content")).to_have_text('robot.say("Hello!")')
        assert not spoken, "nothing was approved"
        approve(page)
        expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")
        assert spoken == ["Hello!"]
    expect(page.locator(".said.by-robot").last).to_have_text(re.compile(r"Hello! See run \d+"))


def test_a_program_is_reviewed_refused_and_nothing_was_done(page: Page, served: Served) -> None:
    say(page, "go to the pharmacy and ask Alice if she wants tea")
    review = page.get_by_role("region", name="Review")
    expect(review).to_contain_text(re.compile(r"It would take \d+ s and drive [\d.]+ m"))
    expect(review).to_contain_text("main corridor → pharmacy")
    page.get_by_role("button", name="Reject").click()
    expect(page.locator(".said").last).to_contain_text("Nothing was done.")
    with served.robot() as robot:
        assert robot.location().place == "charger"


def test_an_edit_is_checked_at_once_and_voids_the_review(page: Page) -> None:
    say(page, "go to the pharmacy")
    button = page.get_by_role("button", name="Approve and run")
    expect(button).to_be_enabled()
    page.locator(".cm-content").click()
    page.keyboard.press("Control+End")
    page.keyboard.type("robot.fly(3)")
    expect(page.locator(".mark.error")).to_contain_text("line 2")
    expect(button).to_be_disabled()
    expect(page.locator(".cm-line.line-error")).to_have_text("robot.fly(3)")
    for _ in "fly(3)":
        page.keyboard.press("Backspace")
    page.keyboard.type('say("I am here")')
    expect(page.locator(".reading")).to_contain_text("say “I am here”")
    expect(page.locator(".review-head")).to_contain_text("changed by hand")
    expect(button).to_be_enabled()


def test_what_is_approved_is_what_is_seen(page: Page, served: Served) -> None:
    say(page, "say one")
    button = page.get_by_role("button", name="Approve and run")
    expect(button).to_be_enabled()
    # What is typed gets lost on its way to the server, which still has the old program reviewed.
    page.evaluate(
        """() => {
            const emit = socket.emit;
            socket.emit = function (name, ...given) {
              const told = JSON.stringify(given);
              const edit = told.includes('two') && !told.includes('program');
              if (!edit) return emit.call(socket, name, ...given);
            };
        }"""
    )
    page.locator(".cm-content").click()
    page.keyboard.press("Control+End")
    page.keyboard.insert_text('robot.say("two")')
    expect(button).to_be_disabled()
    # Whoever gets round that is asked by the server.
    page.evaluate(
        """() => window.emitEvent('desk-approve', {
            program: 'robot.say("One.")\\nrobot.say("two")',
            sha256: document.getElementById('decide').dataset.review,
            all_the_same: false,
        })"""
    )
    expect(page.locator(".said").last).to_contain_text("The program has changed since its review.")
    with served.robot() as robot:
        state = robot.request("program.state")
        assert state is None or "One." not in state["program"]


def test_what_is_too_long_to_be_sent_is_not_taken(page: Page) -> None:
    say(page, "say one")
    page.locator(".cm-content").click()
    page.evaluate(
        """() => {
            const clipboardData = new DataTransfer();
            clipboardData.setData('text/plain', 'robot.wait(1)\\n'.repeat(5000));
            const paste = new ClipboardEvent('paste', {clipboardData, bubbles: true});
            document.activeElement.dispatchEvent(paste);
        }"""
    )
    expect(page.get_by_role("alert")).to_contain_text("longer than 64 kB")
    expect(page.locator(".cm-content")).to_have_text('robot.say("One.")')


def test_a_run_is_watched_paused_stepped_and_stopped_half_way(
    page: Page, look: Look, served: Served, picture: Picture
) -> None:
    say(page, "say one, go to the pharmacy and then go to radiology")
    expect(page.locator(".outlook")).to_be_visible()
    picture(page, "console")
    approve(page)
    current = page.locator("#run-panel li.current")
    expect(current).to_contain_text("pharmacy")
    picture(page, "console-running")
    colleague = look("/")
    expect(colleague.locator("#run-panel li.current")).to_contain_text("pharmacy")
    page.get_by_role("button", name="Pause").click()
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Paused")
    expect(page.locator("#run-panel .calls .halted")).to_contain_text("goes on later")
    expect(colleague.locator("#run-panel .chip[role=status]")).to_have_text("Paused")
    page.get_by_role("button", name="Go on").click()
    page.reload()
    expect(current).to_contain_text("pharmacy")
    page.locator("body").press("Escape")
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Stopped")
    expect(colleague.locator("#run-panel .chip[role=status]")).to_have_text("Stopped")
    expect(page.locator(".said.by-robot").last).to_contain_text("I stopped.")
    with served.robot() as robot:
        here = robot.location()
        assert here.place != "radiology"
        assert robot.location() == here


def test_the_space_key_stops_too_but_not_where_one_types(page: Page, served: Served) -> None:
    with served.robot() as robot:
        stopped = Event()
        robot.subscribe(["stopped"], lambda kind, data: stopped.set())
        line = page.get_by_label("Tell the robot what to do")
        line.press("Space")
        expect(line).to_have_value(" ")
        assert not stopped.is_set()
        page.locator("#main").press("Space")
        expect(page.get_by_role("alert")).to_have_text("The robot was stopped.")
        assert stopped.wait(5)


def test_a_typed_stop_needs_no_approval(page: Page) -> None:
    say(page, "stop")
    expect(page.locator(".said.by-robot").last).to_have_text(re.compile("The robot stands still."))
    expect(page.get_by_role("button", name="Approve and run")).to_have_count(0)


def test_what_is_not_understood_is_asked_back_and_help_is_by_topic(page: Page) -> None:
    say(page, "bring")
    expect(page.locator(".said.by-robot").last).to_contain_text("stops after “bring”")
    say(page, "gobbledygook the wuzzle")
    expect(page.locator(".said.by-robot").last).to_contain_text("I did not understand")
    page.locator(".said").last.get_by_role("button", name="What can I say?").click()
    topics = page.locator(".topics summary")
    expect(topics.first).to_be_visible()
    assert topics.count() > 3
    page.locator(".topics .suggestion").first.click()
    expect(page.get_by_role("button", name="Approve and run")).to_be_visible()


def test_what_was_said_comes_back_with_the_arrow_keys(page: Page) -> None:
    say(page, "say one")
    say(page, "say two")
    line = page.get_by_label("Tell the robot what to do")
    line.fill("half a sen")
    line.press("ArrowUp")
    line.press("ArrowUp")
    expect(line).to_have_value("say one")
    line.press("ArrowDown")
    line.press("ArrowDown")
    expect(line).to_have_value("half a sen")


def test_a_correction_makes_another_program_in_its_place(page: Page) -> None:
    say(page, "go to the pharmacy")
    expect(page.locator(".cm-content")).to_have_text('robot.goto("pharmacy")')
    say(page, "no, to radiology")
    expect(page.locator(".cm-content")).to_have_text('robot.goto("radiology")')


def test_what_only_looks_or_tells_needs_no_question(look: Look, served: Served) -> None:
    page = look(asks_always=False)
    last = page.locator(".said.by-robot").last
    say(page, "what time is it?")
    expect(last).to_have_text(re.compile(r"It is \d\d:\d\d\. See run \d+"))
    last.get_by_role("link").click()
    expect(page.locator("main")).to_contain_text("needed no question (it only looks or tells)")
    page.go_back()
    say(page, "go to the pharmacy")
    expect(page.get_by_role("button", name="Approve and run")).to_be_enabled()
    page.get_by_role("button", name="Reject").click()
    page.get_by_text("Options", exact=True).click()
    page.get_by_label(re.compile("Do what only looks or tells at once")).uncheck()
    say(page, "what time is it?")
    expect(page.get_by_role("button", name="Approve and run")).to_be_enabled()


def test_a_poll_is_answered_in_the_conversation_by_person(look: Look, hurried: Served) -> None:
    page = look(url=hurried.url, language="de")
    page.get_by_label("Sagen Sie dem Roboter, was er tun soll").fill(
        "frag alle in der Lobby, ob sie Tee möchten, und sag mir das Ergebnis"
    )
    page.keyboard.press("Enter")
    robot = page.locator(".said.by-robot")
    expect(robot.last).to_contain_text("alle, die ich sehe, „Möchten Sie Tee?“ fragen")
    approve(page, "Freigeben und starten")
    expect(robot.last).to_contain_text(
        re.compile(r"Tom: (ja|nein).*Rosa: (ja|nein)", re.DOTALL), timeout=60_000
    )
    expect(robot.last).to_contain_text("Das sind die Antworten")


def test_a_program_from_elsewhere_is_only_laid_before_the_operator(
    look: Look, served: Served
) -> None:
    page = look("/?program=robot.goto(%22pharmacy%22)%0A")
    expect(page.get_by_text("This program came by a link")).to_be_visible()
    expect(page.get_by_role("button", name="Approve and run")).to_be_enabled()
    expect(page).to_have_url(served.url + "/")


def test_an_observer_sees_the_run_and_has_no_controls_but_stop(
    page: Page, look: Look, served: Served
) -> None:
    observer = look(url=served.observer_url, path="")
    expect(observer).to_have_url(served.url + "/")
    expect(observer.get_by_text("You look on", exact=True)).to_be_visible()
    expect(observer.locator("#composer")).to_have_count(0)
    say(page, "go to the pharmacy")
    approve(page)
    expect(observer.locator("#run-panel li.current")).to_contain_text("pharmacy")
    expect(observer.get_by_role("button", name="Pause")).to_have_count(0)
    observer.get_by_role("button", name="STOP").click()
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Stopped")


@pytest.mark.parametrize(
    ("language", "words", "button"),
    [
        ("de", "fahr zur Apotheke", "Freigeben und starten"),
        ("fr", "va à la pharmacie", "Approuver et lancer"),
    ],
)
def test_it_speaks_german_and_french(look: Look, language: str, words: str, button: str) -> None:
    page = look(language=language)
    page.locator("#words").fill(words)
    page.keyboard.press("Enter")
    expect(page.get_by_role("button", name=button)).to_be_enabled()


def test_what_goes_wrong_and_where_it_goes_is_told_in_german_too(look: Look) -> None:
    page = look("/?program=robot.goto(%22pharmacy%22)%0Arobot.grab(%22unicorn%22)", language="de")
    outlook = page.locator(".outlook")
    expect(outlook).to_contain_text("Der Roboter sieht „unicorn“ hier nicht.")
    expect(page.locator(".facts")).to_contain_text("Hauptflur → Apotheke")
    page.get_by_role("button", name="Trotzdem starten").click()
    expect(page.locator("#run-panel li.current")).to_contain_text("pharmacy")
    page.get_by_role("button", name="STOPP").click()
    expect(page.locator(".run-message")).to_have_text("Der Roboter wurde angehalten.")
    expect(page.locator(".said").last).to_contain_text("Ich habe angehalten.")


def test_what_is_said_of_a_line_is_said_once(look: Look) -> None:
    page = look("/?program=while True:%0A    robot.ask(%22Tea%3F%22, [%22yes%22, %22no%22])")
    expect(page.locator(".mark")).to_have_count(1)
    expect(page.locator(".mark")).to_contain_text("until somebody stops it")
    expect(page.locator(".facts").get_by_text("Tea?", exact=True)).to_have_count(1)


def test_on_a_phone_in_the_dark_everything_is_there(look: Look, picture: Picture) -> None:
    page = look(width=390, height=844, dark=True)
    say(page, "go to the pharmacy and say hello")
    read_all(page)
    button = page.get_by_role("button", name="Approve and run")
    expect(button).to_be_enabled()
    button.scroll_into_view_if_needed()
    expect(page.get_by_role("button", name="STOP")).to_be_in_viewport()
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    picture(page, "console-phone-dark")


def test_the_desk_answers_for_a_visitor_who_is_silent(look: Look, served: Served) -> None:
    program = (
        'room = robot.ask("Which room?", ["x-ray", "lab"])\n'
        'name = robot.ask("And your name?")\n'
        'robot.say(f"{name} goes to {room}.")\n'
    )
    page = look(f"/?program={quote(program)}")
    approve(page)
    asked = page.get_by_role("form", name="Answer for them")
    expect(asked).to_contain_text("I am asking: Which room?")
    asked.get_by_role("button", name="lab").click()
    expect(asked).to_contain_text("I am asking: And your name?")
    asked.get_by_label("Answer for them").fill("Grace")
    page.keyboard.press("Enter")
    last = page.locator(".said.by-robot").last
    # On a busy machine the visitor may have answered the first question before the desk did.
    expect(last).to_contain_text(re.compile(r"Grace goes to (lab|x-ray)\."))
    expect(last).to_contain_text(re.compile(r"Answered at the desk by .+: (lab|Grace)"))
    expect(asked).to_have_count(0)
    last.get_by_role("link").click()
    expect(page.locator(".run-printed")).to_contain_text(
        re.compile("Answered at the desk by .+: Grace")
    )


def test_what_is_answered_by_the_visitor_needs_nobody_at_the_desk(
    look: Look, hurried: Served
) -> None:
    address = hurried.url
    page = look(f"/?program={quote(TEA)}", url=address, language="fr", width=390, height=844)
    approve(page, "Approuver et lancer")
    expect(page.locator(".said.by-robot").last).to_contain_text("Tom : ", timeout=60_000)
    expect(page.get_by_role("form", name="Répondre à leur place")).to_have_count(0)


TEA = """\
robot.goto("lobby")
robot.ask("Du thé ?", ["oui", "non"], person="Tom")
"""


def test_the_line_grows_with_a_long_command(page: Page) -> None:
    line = page.locator("#words")
    low = line.bounding_box()
    line.fill("go to the pharmacy")
    line.press("Shift+Enter")
    line.press_sequentially("and say good morning")
    high = line.bounding_box()
    assert low and high and high["height"] > low["height"] * 1.3
    line.press("Enter")
    expect(page.locator(".cm-content")).to_contain_text('robot.say("Good morning.")')
    expect(page.locator(".cm-content")).to_contain_text("pharmacy")
    expect(line).to_have_value("")
    again = line.bounding_box()
    assert again and (again["width"], again["height"]) == (low["width"], low["height"])
