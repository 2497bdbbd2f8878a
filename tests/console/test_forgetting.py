"""A visitor leaves the face, and the next one finds nothing of what they typed."""

from __future__ import annotations

import itertools
import json
import urllib.request
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from nl2robot.console.face.forgetting import IDLE, READ_FOR, Forgetting
from nl2robot.console.face.visitor_language import VisitorLanguage
from robot_api.capabilities.sound import Sound
from robot_api.driver import StopFlag
from robot_api.drivers import simulated
from sim.simulation import Simulation
from sim.world.loading import load_world
from tests.console.conftest import Look, Served
from tests.console.test_face import FORM, Tablet, Ward, end_of, start

NAME = "Zephyrine"
ASKS = """\
name = robot.ask("What is your name?")
robot.show(text="Welcome, " + name)
robot.say("Hello " + name)
"""


# --- when


class Clock:
    """Time that passes when a test says so."""

    def __init__(self) -> None:
        self.now = 0.0
        self.numbers = itertools.count(1)
        self.waits: dict[int, tuple[float, Callable[[], None]]] = {}

    def later(self, seconds: float, act: Callable[[], None]) -> Callable[[], None]:
        number = next(self.numbers)
        self.waits[number] = (self.now + seconds, act)
        return lambda: void(self.waits.pop(number, None))

    def passes(self, seconds: float) -> None:
        self.now += seconds
        for number, (at, act) in tuple(self.waits.items()):
            if at <= self.now and self.waits.pop(number, None):
                act()


def void(whatever: object) -> None:
    """As a function that returns nothing."""


class Face:
    """A face whose page may have been typed into."""

    def __init__(self) -> None:
        self.clock = Clock()
        self.driver = simulated(Simulation(load_world("city-hospital")))
        self.typed = False
        self.hushed = 0
        self.forgetting = Forgetting(
            self.driver, self.hush, lambda: self.typed, lambda: {"html": FORM}, self.clock.later
        )

    def hush(self) -> None:
        self.hushed += 1

    def program(self, state: str, run: int = 1) -> None:
        self.forgetting.on_event({"what": "state", "run": run, "state": state})

    def result(self, method: str) -> None:
        self.forgetting.on_event({"what": "result", "run": 1, "method": method})

    def shows(self, **content: str) -> None:
        self.driver.call("show", content, StopFlag())


@pytest.fixture
def shown() -> Iterator[list[dict[str, Any]]]:
    yield []


@pytest.fixture
def face(shown: list[dict[str, Any]]) -> Iterator[Face]:
    face = Face()
    unsubscribe = face.driver.subscribe(
        lambda kind, data: shown.append(dict(data)) if kind == "screen" else None
    )
    yield face
    unsubscribe()
    face.forgetting.close()
    face.driver.close()


def test_what_was_shown_to_a_visitor_can_be_read_and_is_gone(face: Face, shown: list[Any]) -> None:
    face.program("running")
    face.result("ask")
    face.shows(text=f"Welcome, {NAME}")
    face.program("done")
    assert face.hushed, "what was said is gone at once"
    face.clock.passes(READ_FOR - 1)
    assert shown[-1] == {"text": f"Welcome, {NAME}"}
    face.clock.passes(1)
    assert shown[-1] == {"text": ""}


@pytest.mark.parametrize("end", ["done", "failed", "stopped", "limit"])
def test_a_page_into_which_somebody_typed_is_gone_at_once(
    face: Face, shown: list[Any], end: str
) -> None:
    face.program("running")
    face.shows(html=FORM)
    face.forgetting.noticed()
    face.typed = True
    face.program(end)
    face.clock.passes(0)
    assert shown[-1] == {"text": ""}


def test_the_next_program_finds_nothing_of_who_was_there_before(
    face: Face, shown: list[Any]
) -> None:
    face.program("running")
    face.result("touch")
    face.shows(text=NAME)
    face.program("done")
    face.program("running", run=2)
    assert shown[-1] == {"text": ""}
    face.shows(text="Good morning")
    face.clock.passes(READ_FOR)
    assert shown[-1] == {"text": "Good morning"}, "what it shows is its own"


def test_a_sign_stays(face: Face, shown: list[Any]) -> None:
    face.program("running")
    face.shows(text="Closed today")
    face.program("done")
    face.clock.passes(10 * IDLE)
    assert shown[-1] == {"text": "Closed today"} and not face.hushed


def test_a_pause_forgets_nothing(face: Face, shown: list[Any]) -> None:
    face.program("running")
    face.result("ask")
    face.shows(text=NAME)
    face.program("pausing")
    face.program("paused")
    face.program("running")
    face.clock.passes(10 * IDLE)
    assert shown[-1] == {"text": NAME}, "the program still needs it"


def test_without_a_program_a_page_is_fresh_again_when_its_visitor_has_left(
    face: Face, shown: list[Any]
) -> None:
    face.forgetting.noticed()
    face.clock.passes(IDLE - 1)
    face.forgetting.noticed()  # still there
    face.clock.passes(IDLE - 1)
    assert not shown
    face.clock.passes(1)
    assert shown == [{"html": FORM}] and face.hushed
    face.clock.passes(10 * IDLE)
    assert len(shown) == 1, "nobody has been there since"


def test_a_call_that_failed_has_told_nothing(face: Face) -> None:
    face.program("running")
    face.forgetting.on_event({"what": "result", "run": 1, "method": "ask", "error": "TimedOut"})
    face.program("done")
    assert not face.clock.waits


# --- what


def test_no_service_tells_it_any_more() -> None:
    ward = Ward(Sound())
    with ward.server:
        front = Tablet(ward)
        ward.driver.call("show", {"html": FORM}, StopFlag())
        page = front.waits(lambda state: state["screen"].get("html") and state["screen"]["page"])
        front.request("page", page=page, html=FORM.replace('"name"', f'"name" value="{NAME}"'))
        assert NAME in json.dumps(front.request("state"))
        ward.driver.call("show", {"text": ""}, StopFlag())
        assert NAME not in json.dumps(front.request("state"))
        assert NAME not in json.dumps(front.request("here", visible=True))
        front.close()
        ward.close()


def everything(page: Page) -> str:
    """All that is in a page and in its frames, with what fields hold."""
    held = """() => document.documentElement.outerHTML
        + [...document.querySelectorAll('input, textarea')].map((each) => each.value).join(' ')"""
    return " ".join(frame.evaluate(held) for frame in page.frames)


def source(served: Served) -> str:
    with urllib.request.urlopen(f"{served.url}/face") as answer:
        return str(answer.read().decode())


def test_what_a_visitor_typed_is_nowhere_when_the_program_has_ended(
    look: Look, served: Served
) -> None:
    page = look("/face", width=1024, height=768)
    expect(page.locator("body[data-ready]")).to_be_attached()
    with served.robot() as robot:
        run = start(robot, ASKS)
        page.get_by_label("Your answer").fill(NAME)
        page.get_by_role("button", name="Send").click()
        expect(page.locator(".shown-text")).to_have_text(f"Welcome, {NAME}")
        assert end_of(robot, run) == "done"
        expect(page.locator("body")).to_have_attribute("data-view", "face")
        expect(page.locator("#caption")).to_be_empty()
        assert NAME not in everything(page)
        assert NAME not in json.dumps(robot.request("face.state"))
        assert NAME not in source(served)
        page.reload()
        expect(page.locator("body[data-ready]")).to_be_attached()
        assert NAME not in everything(page)


def test_a_page_that_was_filled_in_is_gone_with_its_program(look: Look, served: Served) -> None:
    page = look("/face", width=1024, height=768)
    expect(page.locator("body[data-ready]")).to_be_attached()
    with served.robot() as robot:
        start(robot, f"robot.show(html={FORM!r})\nrobot.wait(600)\n")
        shown = page.frame_locator(".shown-page")
        shown.locator("#name").fill(NAME)
        # The page tells it a moment later.
        page.wait_for_function(
            """async (name) => {
                const {wire} = await import('/static/wire.js');
                return JSON.stringify(await wire.request('face.state')).includes(name);
            }""",
            arg=NAME,
        )
        robot.stop()
        expect(page.locator(".shown-page")).to_have_count(0)
        assert NAME not in everything(page)
        assert NAME not in json.dumps(robot.request("face.state"))
        assert NAME not in source(served)


# --- the language of a visitor


def goes(run: int, state: str) -> dict[str, Any]:
    return {"what": "state", "run": run, "state": state}


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def spoken() -> list[str]:
    return ["en"]


@pytest.fixture
def theirs(spoken: list[str], clock: Clock) -> VisitorLanguage:
    return VisitorLanguage(lambda code, theirs: spoken.append(code), clock.later)


def test_a_language_goes_with_whoever_chose_it(
    theirs: VisitorLanguage, spoken: list[str], clock: Clock
) -> None:
    theirs.on_event(goes(1, "running"))
    theirs.choose("de", before="en")
    theirs.choose("fr", before="de")
    theirs.on_event(goes(1, "paused"))
    theirs.on_event(goes(1, "done"))
    clock.passes(READ_FOR - 1)
    assert spoken == ["en", "de", "fr"]
    clock.passes(2)
    assert spoken == ["en", "de", "fr", "en"]
    clock.passes(IDLE)
    assert spoken[-1] == "en" and len(spoken) == 4


def test_the_next_program_finds_the_language_of_the_house(
    theirs: VisitorLanguage, spoken: list[str], clock: Clock
) -> None:
    theirs.on_event(goes(1, "running"))
    theirs.choose("fr", before="en")
    theirs.on_event(goes(1, "done"))
    theirs.on_event(goes(2, "running"))
    assert spoken == ["en", "fr", "en"]


def test_who_chooses_before_a_program_has_it_in_that(
    theirs: VisitorLanguage, spoken: list[str], clock: Clock
) -> None:
    theirs.choose("fr", before="en")
    theirs.on_event(goes(1, "running"))
    clock.passes(IDLE + 1)
    assert spoken == ["en", "fr"]
    theirs.on_event(goes(1, "done"))
    clock.passes(READ_FOR + 1)
    assert spoken == ["en", "fr", "en"]


def test_who_chooses_and_walks_away_leaves_nothing(
    theirs: VisitorLanguage, spoken: list[str], clock: Clock
) -> None:
    theirs.choose("fr", before="en")
    clock.passes(IDLE + 1)
    assert spoken == ["en", "fr", "en"]
