"""The robot's face: what is touched and typed on its tablet reaches the program."""

from __future__ import annotations

import json
import threading
import urllib.request
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import MISSING, fields
from http.server import HTTPServer, SimpleHTTPRequestHandler
from types import SimpleNamespace
from typing import Any

import pytest
from playwright.sync_api import Page, expect
from starlette.applications import Starlette

from nl2robot.cli.operator import Operator
from nl2robot.console.face import choices, tablet
from nl2robot.console.face import page as face
from nl2robot.run.present import Present
from nl2robot.run.state import on_wire
from nl2robot.station.part import Backstage
from robot_api import Robot, Server
from robot_api.capabilities.sound import Asked, Sound
from robot_api.driver import StopFlag
from robot_api.drivers import simulated
from robot_api.errors import AccessDenied, InvalidCall, NotFound, Stopped, TimedOut
from sim.simulation import Simulation
from sim.world.loading import load_world
from tests.console.conftest import SOON, Look, Served

AT_ONCE = SOON / 1000
FORM = """
<h1>Your wishes</h1>
<input id="name"> <input type="checkbox" id="tea">
<button id="send" onclick="out.textContent = 'Thank you, ' + document.querySelector('#name').value">
Send</button> <p id="out">nothing yet</p>
"""


class Ears:
    """Somebody real who speaks when told to."""

    def __init__(self) -> None:
        self.words: str | None = None
        self.speaks = threading.Event()
        self.asked: list[Asked] = []

    def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> str | None:
        self.asked.append(asked)
        stop.on_set(self.speaks.set)
        self.speaks.wait(AT_ONCE)
        stop.check()
        return self.words


def backstage_with(**given: Any) -> Backstage:
    """What the face uses of it; the rest is missing."""
    needed = [field.name for field in fields(Backstage) if field.default_factory is MISSING]
    return Backstage(**{name: given.get(name) for name in needed})


class Ward:
    """A robot with the face's services, and no browser."""

    def __init__(self, sound: Sound) -> None:
        simulation = Simulation(load_world("city-hospital"))
        self.driver = simulated(simulation, sound)

        def publish(kind: str, data: Any, to: str | None = None) -> None:
            self.server.publish(kind, data, to)

        runner: Any = SimpleNamespace(
            knowledge=SimpleNamespace(world=simulation.world), state=lambda: None
        )
        backstage = backstage_with(
            driver=self.driver, runner=runner, simulation=simulation, publish=publish
        )
        self.part = face.part(backstage)
        self.server = Server(
            self.driver,
            port=0,
            services=self.part.services,
            events=self.part.events,
            pages=Starlette(routes=self.part.routes),
            on_left=self.part.left,
        )
        present = Present(lambda state: backstage.tell("state", on_wire(state)))
        backstage.subscribe(present.on_event)
        self.unsubscribe = self.driver.subscribe(backstage.tell)
        self.calls = ThreadPoolExecutor()

    def asks(self, method: str, **arguments: Any) -> Future[Any]:
        """The robot is asked to do something, which takes until somebody answers."""
        return self.calls.submit(self.driver.call, method, arguments, StopFlag())

    def close(self) -> None:
        self.server.close()
        self.calls.shutdown()
        self.part.close()
        self.unsubscribe()
        self.driver.close()


class Tablet:
    """A face as its page would be: it knows what it is to show, and can be touched."""

    def __init__(self, ward: Ward, visible: bool = True) -> None:
        self.robot = Robot(ward.server.address)
        self.changed = threading.Condition()
        self.orders: list[dict[str, Any]] = []
        self.answered = 0
        self.state: dict[str, Any] = {"version": 0}
        self.robot.subscribe(["face", "face.act"], self.hear)
        state = self.request("here", visible=visible)
        with self.changed:
            self.state = state if state["version"] > self.state["version"] else self.state

    def request(self, method: str, **params: Any) -> Any:
        return self.robot.request(f"face.{method}", params)

    def hear(self, kind: str, data: Any) -> None:
        with self.changed:
            if kind == "face":
                self.state = {**self.state, **data}
            else:
                self.orders.append(dict(data))
            self.changed.notify_all()

    def waits(self, until: Callable[[dict[str, Any]], Any]) -> Any:
        with self.changed:
            assert self.changed.wait_for(lambda: until(self.state), AT_ONCE), self.state
            return until(self.state)

    def question(self) -> dict[str, Any]:
        """What is asked now; not what was answered before."""
        asking: dict[str, Any] = self.waits(
            lambda state: (
                state["asking"] and state["asking"]["number"] > self.answered and state["asking"]
            )
        )
        return asking

    def touch(self, answer: str) -> bool:
        number = self.question()["number"]
        taken: bool = self.request("touch", number=number, answer=answer)
        self.answered = number
        return taken

    def close(self) -> None:
        self.robot.close()


@pytest.fixture
def ears() -> Ears:
    return Ears()


@pytest.fixture
def ward() -> Iterator[Ward]:
    ward = Ward(Sound())
    with ward.server:
        yield ward
        ward.close()


@pytest.fixture
def hearing_ward(ears: Ears) -> Iterator[Ward]:
    """Its robot hears real people."""
    ward = Ward(Sound(ears=ears))
    with ward.server:
        yield ward
        ward.close()


@pytest.fixture
def front(ward: Ward) -> Iterator[Tablet]:
    front = Tablet(ward)
    yield front
    front.close()


def test_the_button_that_is_touched_is_the_answer(ward: Ward, front: Tablet) -> None:
    heard: list[Any] = []
    ward.driver.subscribe(lambda kind, data: heard.append(data) if kind == "heard" else None)
    touched = ward.asks("touch", options=["tea", "coffee"], prompt="What would you like?")
    assert front.question()["question"] == "What would you like?"
    assert front.question()["options"] == ["tea", "coffee"]
    with pytest.raises(InvalidCall, match="none of the buttons"):
        front.touch("cake")
    assert front.touch("coffee")
    assert touched.result(AT_ONCE) == "coffee"
    assert heard == [{"text": "coffee", "person": None}]
    assert front.waits(lambda state: state["asking"] is None)


def test_the_first_touch_wins(ward: Ward, front: Tablet) -> None:
    other = Tablet(ward)
    touched = ward.asks("touch", options=["tea", "coffee"])
    number = other.question()["number"]
    assert front.touch("tea")
    assert not other.request("touch", number=number, answer="coffee")
    assert touched.result(AT_ONCE) == "tea"
    other.close()


def test_who_opens_a_face_later_is_asked_as_well(ward: Ward, front: Tablet) -> None:
    touched = ward.asks("touch", options=["tea", "coffee"])
    front.question()
    later = Tablet(ward)
    assert later.touch("coffee") and touched.result(AT_ONCE) == "coffee"
    later.close()


def test_an_answer_is_typed_where_there_are_no_options(ward: Ward, front: Tablet) -> None:
    asked = ward.asks("ask", question="What is your name?")
    assert front.question() | {"number": 0} == {
        "number": 0,
        "question": "What is your name?",
        "options": None,
        "person": None,
        "called": {"en": [], "de": [], "fr": []},
        "language": None,
    }
    assert front.touch("Marie") and asked.result(AT_ONCE) == "Marie"
    listened = ward.asks("listen")
    assert front.touch("Hello") and listened.result(AT_ONCE) == "Hello"


def test_one_may_speak_or_touch(hearing_ward: Ward, ears: Ears) -> None:
    front = Tablet(hearing_ward)
    options = ["radiology", "pharmacy"]
    asked = hearing_ward.asks("ask", question="Where to?", options=options)
    assert front.question()["options"] == options
    ears.words = "to the pharmacy, please"
    ears.speaks.set()
    assert asked.result(AT_ONCE) == "pharmacy"
    front.waits(lambda state: state["asking"] is None)
    ears.speaks.clear()
    asked = hearing_ward.asks("ask", question="Where to?", options=options)
    assert front.touch("radiology") and asked.result(AT_ONCE) == "radiology"
    front.close()


@pytest.mark.parametrize(
    ("code", "options", "called"),
    [
        ("de", ["yes", "no"], ["ja", "nein"]),
        ("fr", ["Ja", "Nein"], ["Oui", "Non"]),
        ("en", ["ja", "nein"], ["yes", "no"]),
        ("de", ["radiology", "pharmacy"], ["Radiologie", "Apotheke"]),
        ("en", ["Radiologie", "Apotheke"], ["radiology", "pharmacy"]),
        ("en", ["front desk", "lobby"], ["front desk", "lobby"]),
        ("fr", ["yes", "oui"], ["yes", "oui"]),
        ("fr", ["two sugars", "none"], ["two sugars", "none"]),
    ],
)
def test_answers_are_called_what_a_language_calls_them(
    code: str, options: list[str], called: list[str]
) -> None:
    assert choices.called(options, load_world("city-hospital"), code) == called


def test_who_reads_an_answer_in_their_language_may_say_it(hearing_ward: Ward, ears: Ears) -> None:
    """The program is in English, the visitor has chosen German."""
    front = Tablet(hearing_ward)
    front.request("language", code="de")
    asked = hearing_ward.asks("ask", question="Where to?", options=["radiology", "pharmacy"])
    assert front.question()["called"]["de"] == ["Radiologie", "Apotheke"]
    ears.words = "zur Apotheke, bitte"
    ears.speaks.set()
    assert asked.result(AT_ONCE) == "pharmacy"
    front.close()


def test_without_a_face_simulated_people_answer(ward: Ward) -> None:
    hidden = Tablet(ward, visible=False)
    assert ward.driver.call("ask", {"question": "Tea?", "options": ["yes", "no"]}, StopFlag()) in (
        "yes",
        "no",
    )
    hidden.close()


def test_when_the_face_goes_away_simulated_people_answer(
    ward: Ward, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tablet, "COMES_BACK_WITHIN", 0.05)
    front = Tablet(ward)
    touched = ward.asks("touch", options=["tea", "coffee"])
    front.question()
    front.close()
    assert touched.result(AT_ONCE) in ("tea", "coffee")


def test_a_face_that_is_loaded_anew_is_not_missed(ward: Ward) -> None:
    front = Tablet(ward)
    touched = ward.asks("touch", options=["tea", "coffee"])
    front.question()
    front.close()
    again = Tablet(ward)
    assert again.touch("tea") and touched.result(AT_ONCE) == "tea"
    again.close()


def test_a_stop_ends_the_question(ward: Ward, front: Tablet) -> None:
    for method, arguments in (("touch", {"options": ["tea"]}), ("ask", {"question": "Tea?"})):
        asked = ward.asks(method, **arguments)
        front.question()
        front.robot.stop()
        with pytest.raises(Stopped):
            asked.result(AT_ONCE)
        front.waits(lambda state: state["asking"] is None and state["stopped"])


def test_nobody_touches(ward: Ward, front: Tablet, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robot_api.capabilities.screen.TOUCH_TIMEOUT", 0.2)
    with pytest.raises(TimedOut, match="Nobody touched"):
        ward.driver.call("touch", {"options": ["tea"]}, StopFlag())


# --- pages


def test_what_people_type_into_a_page_is_read_by_the_program(ward: Ward, front: Tablet) -> None:
    ward.driver.call("show", {"html": FORM}, StopFlag())
    page = front.waits(lambda state: state["screen"].get("html") and state["screen"]["page"])
    typed = FORM.replace('id="name"', 'id="name" value="Ann"')
    front.request("page", page=page, html=typed)
    assert ward.driver.call("read_text", {"selector": "#name"}, StopFlag()) == "Ann"
    assert front.waits(lambda state: state["screen"]["by"])
    front.request("page", page=page - 1, html="<p>An older page</p>")
    assert ward.driver.call("read_text", {"selector": "#name"}, StopFlag()) == "Ann"
    ward.driver.call("show", {"html": FORM}, StopFlag())
    assert ward.driver.call("read_text", {"selector": "#name"}, StopFlag()) == ""


def test_what_the_program_does_is_done_on_the_tablet(ward: Ward, front: Tablet) -> None:
    ward.driver.call("show", {"html": FORM}, StopFlag())
    clicked = ward.asks("click", selector="#send")
    front.waits(lambda state: front.orders)
    order = front.orders.pop()
    assert (order["act"], order["selector"]) == ("click", "#send")
    answered = FORM.replace("nothing yet", "Thank you")
    front.request("did", number=order["number"], html=answered)
    clicked.result(AT_ONCE)
    assert ward.driver.call("read_text", {"selector": "#out"}, StopFlag()) == "Thank you"
    with pytest.raises(NotFound):
        ward.driver.call("click", {"selector": "#nothing"}, StopFlag())
    assert not front.orders


def test_a_tablet_that_does_nothing_is_done_without(
    ward: Ward, front: Tablet, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tablet, "ACT_WITHIN", 0.05)
    ward.driver.call("show", {"html": FORM}, StopFlag())
    ward.driver.call("type_text", {"selector": "#name", "text": "Ann"}, StopFlag())
    assert ward.driver.call("read_text", {"selector": "#name"}, StopFlag()) == "Ann"


# --- what the face shows


def test_the_state_has_all_that_is_to_be_seen(ward: Ward, front: Tablet) -> None:
    ward.driver.call("emotion", {"name": "happy"}, StopFlag())
    ward.driver.call("show", {"text": "Hello"}, StopFlag())
    ward.driver.call("say", {"text": "Good morning"}, StopFlag())
    front.request("language", code="de")
    front.waits(lambda state: state["language"] == "de")
    state = front.request("state")
    assert (state["emotion"], state["language"]) == ("happy", "de")
    assert state["screen"]["text"] == "Hello"
    assert state["speech"]["text"] == "Good morning"
    assert front.waits(lambda seen: {**seen, "name": ""} == {**state, "name": ""})


def test_a_program_that_searches_looks_thoughtful(ward: Ward) -> None:
    told = backstage_with(driver=ward.driver, publish=lambda *given: None)
    seen = face.Face(told)
    seen.on_event("program", {"what": "call", "method": "find"})
    assert seen.state["mood"] == "thinking"
    seen.on_event("program", {"what": "result"})
    assert seen.state["mood"] is None


def test_the_page_comes_with_what_it_shows(ward: Ward) -> None:
    ward.driver.call("show", {"text": "</script><script>alert(1)</script>"}, StopFlag())
    with urllib.request.urlopen(f"http://{ward.server.address}/face") as answer:
        page, policy = answer.read().decode(), answer.headers["Content-Security-Policy"]
    data = page.split('id="page-data">')[1].split("</script>")[0]
    assert json.loads(data)["state"]["screen"]["text"].startswith("</script>")
    assert "frame-ancestors 'self'" in policy and "form-action 'none'" in policy


def test_who_looks_on_touches_nothing(ward: Ward, front: Tablet) -> None:
    touched = ward.asks("touch", options=["tea"])
    number = front.question()["number"]
    looks_on = Robot(ward.server.address, token=ward.server.observer_token)
    assert looks_on.request("face.state", {})["asking"]["number"] == number
    with pytest.raises(AccessDenied):
        looks_on.request("face.touch", {"number": number, "answer": "tea"})
    looks_on.close()
    assert front.touch("tea") and touched.result(AT_ONCE) == "tea"


class Detour(SimpleHTTPRequestHandler):
    """A web site that sends everybody elsewhere."""

    to = ""

    def do_GET(self) -> None:
        self.send_response(302)
        self.send_header("Location", self.to)
        self.end_headers()


@contextmanager
def another_site(handler: type[SimpleHTTPRequestHandler]) -> Iterator[str]:
    with HTTPServer(("127.0.0.1", 0), handler) as site:
        threading.Thread(target=site.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{site.server_port}/"
        site.shutdown()


def test_a_web_page_that_cannot_be_framed_is_found_out(
    ward: Ward, front: Tablet, monkeypatch: pytest.MonkeyPatch
) -> None:
    # As if this machine were the open internet.
    monkeypatch.setattr("nl2robot.console.face.sites._is_public", lambda url: True)
    with another_site(SimpleHTTPRequestHandler) as site:
        for url, answer in (
            (f"http://{ward.server.address}/face", "refuses"),
            (site, "yes"),
            ("http://127.0.0.1:1/", "away"),
        ):
            ward.driver.call("show", {"url": url}, StopFlag())
            assert front.request("site") == answer


def test_nobody_learns_by_it_what_there_is_in_the_hospital(
    ward: Ward, front: Tablet, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether somebody listens there or not, the answer is the same; a detour does not help."""
    with another_site(Detour) as site:
        for url in ("http://127.0.0.1:1/", site, "http://10.0.0.1/", "http://[::1]:1/"):
            ward.driver.call("show", {"url": url}, StopFlag())
            assert front.request("site") == "yes"
        monkeypatch.setattr("nl2robot.console.face.sites._is_public", lambda url: url == site)
        ward.driver.call("show", {"url": site}, StopFlag())
        for Detour.to in ("http://127.0.0.1:1/", f"http://{ward.server.address}/face"):
            assert front.request("site") == "yes"
        Detour.to = site  # for ever
        assert front.request("site") == "away"


# --- in a browser

PROGRAM = """\
robot.emotion("happy")
drink = robot.touch(["tea", "coffee"], "What would you like?")
name = robot.ask("What is your name?")
robot.say(name + " would like " + drink)
"""


def start(robot: Robot, program: str, **more: Any) -> int:
    """Run a program as an operator does."""
    review = robot.request("program.check", {"program": program})
    about = {"program": program, "sha256": review["sha256"], "by": "test", **more}
    approval = robot.request("program.approve", about)
    run: int = robot.request("program.run", {"approval": approval["id"]})
    return run


def end_of(robot: Robot, run: int) -> str:
    """How a run ended; asked as operators do, since a stop breaks off a wait that has begun."""
    return Operator(robot, "test").wait(run).state


def test_a_program_meets_somebody_at_the_tablet(
    look: Look, served: Served, picture: Callable[[Page, str], None]
) -> None:
    page = look("/face", width=1024, height=768)
    phone = look("/face", width=390, height=844)
    robot = served.robot()
    for each in (page, phone):
        expect(each.locator("body[data-ready]")).to_be_attached()
        expect(each.locator("#figure")).to_have_attribute("aria-label", "The robot looks at you.")
    run = start(robot, PROGRAM)
    expect(page.locator(".choice")).to_have_text(["tea", "coffee"])
    expect(page.locator("#figure")).to_have_attribute("data-look", "happy")
    expect(phone.locator("h1")).to_have_text("What would you like?")
    picture(page, "face-asks")
    page.reload()
    page.get_by_role("button", name="coffee").click()
    phone.get_by_label("Your answer").fill("Marie")
    phone.get_by_role("button", name="Send").click()
    expect(page.locator("#caption")).to_have_text("Marie would like coffee")
    expect(page.locator("#figure")).to_have_attribute("data-speaking", "yes")
    assert end_of(robot, run) == "done"
    expect(page.locator("body")).to_have_attribute("data-view", "face")
    picture(page, "face")
    robot.close()


def test_a_page_is_filled_in_at_the_tablet(look: Look, served: Served) -> None:
    page = look("/face", width=1024, height=768)
    robot = served.robot()
    expect(page.locator("body[data-ready]")).to_be_attached()
    robot.show(html=FORM)
    shown = page.frame_locator(".shown-page")
    shown.locator("#name").fill("Ann")
    robot.click("#tea")
    robot.click("#send")
    assert robot.read_text("#out") == "Thank you, Ann", "its own script has run"
    assert shown.locator("#tea").is_checked()
    robot.type_text("#name", "Bea")
    expect(shown.locator("#name")).to_have_value("Bea")
    page.reload()
    expect(page.frame_locator(".shown-page").locator("#name")).to_have_value("Bea")
    reach = "() => { try { return parent.document.title } catch { return 'nothing' } }"
    frame = page.frames[1]
    assert frame.evaluate(reach) == "nothing"
    assert frame.evaluate("fetch('/healthz').then(() => 'reached', () => 'nothing')") == "nothing"
    robot.show(text="")
    robot.close()


def test_language_and_stop_by_touch(look: Look, served: Served) -> None:
    page = look("/face", width=800, height=1280)
    robot = served.robot()
    page.get_by_role("button", name="Deutsch").click()
    expect(page.get_by_role("button", name="STOPP")).to_be_visible()
    assert page.title() == "Das Gesicht des Roboters"
    run = start(robot, 'robot.ask("Wer sind Sie?")')
    expect(page.locator(".hint")).to_have_text("Sagen Sie es, oder schreiben Sie es hier.")
    page.get_by_role("button", name="STOPP").click()
    assert end_of(robot, run) == "stopped"
    expect(page.get_by_role("alert")).to_have_text("Ich habe angehalten.")
    expect(page.locator("body")).to_have_attribute("data-view", "face")
    page.get_by_role("button", name="English").click()
    expect(page.get_by_role("button", name="STOP", exact=True)).to_be_visible()
    robot.close()


def test_escape_stops_from_within_a_page_as_well(look: Look, served: Served) -> None:
    page = look("/face", width=1024, height=768)
    robot = served.robot()
    run = start(robot, f"robot.show(html={FORM!r})\nrobot.wait(60)")
    page.frame_locator(".shown-page").locator("#name").press("Escape")
    assert end_of(robot, run) == "stopped"
    robot.show(text="")
    robot.close()


def test_who_looks_on_is_told_so(look: Look, served: Served) -> None:
    face_of_others = look("/face", width=1024, height=768)
    page = look(f"/face?token={served.observer_url.rpartition('=')[2]}", width=1024, height=768)
    robot = served.robot()
    page.get_by_role("button", name="Deutsch").click()
    expect(page.get_by_role("alert")).to_contain_text("only looks on")
    robot.emotion("sad")
    expect(page.locator("#figure")).to_have_attribute("data-look", "sad")
    robot.emotion("neutral")
    expect(face_of_others.locator("#figure")).to_have_attribute("data-look", "neutral")
    robot.close()


def test_around_a_question_all_is_in_the_language_that_a_visitor_has_chosen(
    look: Look, served: Served, picture: Callable[[Page, str], None]
) -> None:
    page = look("/face", width=1024, height=768)
    desk = look("/", language="fr")
    robot = served.robot()
    expect(page.locator("body[data-ready]")).to_be_attached()
    program = 'robot.say("It is " + robot.ask("Would you like some water?", ["yes", "no"]))'
    run = start(robot, program, utterance="ask for water", language="en")
    expect(page.locator(".choice")).to_have_text(["yes", "no"])
    expect(page.locator(".hint")).to_have_text("Say it, or touch it here.")
    page.get_by_role("button", name="Deutsch").click()
    expect(page.locator(".choice")).to_have_text(["ja", "nein"])
    expect(page.locator(".hint")).to_have_text(
        [
            "Diese Frage gibt es nur auf Englisch. Sie dürfen auf Deutsch antworten.",
            "Sagen Sie es, oder tippen Sie es hier an.",
        ]
    )
    expect(page.locator(".asking h1[lang=en]")).to_have_text("Would you like some water?")
    expect(page.locator(".asking[lang=de]")).to_be_visible()
    expect(desk.locator(".standing-in .suggestion")).to_have_text(["oui", "non"])
    picture(page, "face-other-language")
    page.get_by_role("button", name="ja").click()
    expect(page.locator("#caption")).to_have_text("It is yes")
    assert end_of(robot, run) == "done"
    page.get_by_role("button", name="English").click()
    expect(page.get_by_role("button", name="STOP", exact=True)).to_be_visible()
    robot.close()


def test_where_nobody_has_chosen_a_language_a_question_is_in_that_of_its_program(
    look: Look, served: Served
) -> None:
    """The receptionist speaks German, the robot English; the visitor has touched nothing yet."""
    robot = served.robot()
    robot.set_language("en")
    page = look("/face", width=390, height=844)
    expect(page.locator("body[data-ready]")).to_be_attached()
    expect(page.get_by_role("button", name="STOP", exact=True)).to_be_visible()
    program = 'robot.ask("Wie heißen Sie?")'
    run = start(robot, program, utterance="Frag, wie er heißt", language="de")
    expect(page.locator(".hint")).to_have_text("Sagen Sie es, oder schreiben Sie es hier.")
    page.get_by_label("Ihre Antwort").fill("Mar")
    page.get_by_role("button", name="Français").click()
    expect(page.locator(".hint").first).to_have_text(
        "Cette question n'existe qu'en allemand. Vous pouvez répondre en français."
    )
    expect(page.get_by_label("Votre réponse")).to_have_value("Mar")
    page.get_by_label("Votre réponse").fill("Marie")
    page.get_by_role("button", name="Envoyer").click()
    assert end_of(robot, run) == "done"
    page.get_by_role("button", name="English").click()
    robot.close()
