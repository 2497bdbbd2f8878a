"""Video calls between the robot's face and an operator's page."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from nl2robot.console.face.video import Calls
from robot_api.driver import StopFlag
from robot_api.errors import NotPossible, Stopped, TimedOut
from robot_api.server import Context
from tests.console.conftest import SOON, Look, Served

AT_ONCE = SOON / 1000


class Switchboard:
    """Calls, with pages that do nothing by themselves; what they are told is kept."""

    def __init__(self, rings_for: float = AT_ONCE, returns_within: float = 0.2) -> None:
        self.told: list[tuple[str | None, str, dict[str, Any]]] = []
        self.changed = threading.Condition()
        self.calls = Calls(self.publish, rings_for, returns_within)
        self.services = self.calls.services()
        self.over = threading.Event()
        self.threads = ThreadPoolExecutor()

    def publish(self, kind: str, data: Any, to: str | None = None) -> None:
        with self.changed:
            self.told.append((to, kind, dict(data)))
            self.changed.notify_all()

    def does(self, page: str, method: str, **params: Any) -> Any:
        context = Context(page, StopFlag(), self.publish)
        return self.services[f"call.{method}"].handler(params, context)

    def robot_calls(self, stop: StopFlag | None = None) -> Future[bool]:
        ring = self.calls.ring
        return self.threads.submit(ring, stop or StopFlag(), "Alice", "tablet", self.over.set)

    def waits(self, page: str, state: str) -> dict[str, Any]:
        """What the page was told when it came to that state."""

        def found() -> dict[str, Any] | None:
            return next(
                (d for to, kind, d in self.told if to == page and d.get("state") == state), None
            )

        with self.changed:
            assert self.changed.wait_for(found, AT_ONCE), self.told
            about = found()
            assert about is not None
            return about


@pytest.fixture
def board() -> Iterator[Switchboard]:
    board = Switchboard()
    board.does("tablet", "ready", side="face")
    board.does("desk", "ready", side="operator")
    yield board
    board.calls.close()
    board.threads.shutdown()


def test_the_robot_calls_and_somebody_answers(board: Switchboard) -> None:
    board.does("drive", "ready", side="operator")
    call = board.robot_calls()
    number = board.waits("desk", "ringing")["call"]
    board.waits("drive", "ringing")
    assert board.waits("tablet", "calling")["who"] == "Alice"
    assert board.does("desk", "answer", call=number)
    assert call.result(AT_ONCE)
    assert not board.does("drive", "answer", call=number), "too late"
    assert board.waits("drive", "ended")["because"] == "elsewhere"
    assert board.waits("tablet", "answered")["offers"]
    assert not board.waits("desk", "answered")["offers"]
    board.does("desk", "end", call=number)
    assert board.waits("tablet", "ended")["because"] == "hung_up"
    assert board.over.wait(AT_ONCE)


def test_only_the_two_sides_hear_each_other(board: Switchboard) -> None:
    board.does("drive", "ready", side="operator")
    call = board.robot_calls()
    number = board.waits("desk", "ringing")["call"]
    board.does("desk", "signal", call=number, signal={"too": "early"})
    board.does("desk", "answer", call=number)
    call.result(AT_ONCE)
    board.does("tablet", "signal", call=number, signal={"candidate": 1})
    board.does("drive", "signal", call=number, signal={"from": "outside"})
    signals = [(to, data["signal"]) for to, kind, data in board.told if kind == "call.signal"]
    assert signals == [("desk", {"candidate": 1})]


def test_a_call_is_declined_when_nobody_is_left_who_rings(board: Switchboard) -> None:
    board.does("drive", "ready", side="operator")
    call = board.robot_calls()
    number = board.waits("desk", "ringing")["call"]
    board.does("desk", "end", call=number)
    assert not call.done()
    board.does("drive", "end", call=number)
    with pytest.raises(NotPossible, match="Alice declined"):
        call.result(AT_ONCE)


def test_nobody_answers() -> None:
    board = Switchboard(rings_for=0.05)
    board.does("tablet", "ready", side="face")
    assert board.robot_calls().result(AT_ONCE) is False, "there is nobody who could"
    board.does("desk", "ready", side="operator")
    with pytest.raises(TimedOut, match="Nobody answered"):
        board.robot_calls().result(AT_ONCE)
    assert board.waits("desk", "ended")["because"] == "nobody"


def test_a_page_that_is_opened_while_it_rings_can_answer(board: Switchboard) -> None:
    call = board.robot_calls()
    number = board.waits("desk", "ringing")["call"]
    board.calls.left("desk")
    assert isinstance(call.exception(AT_ONCE), TimedOut), "the only one has gone"
    board.does("desk", "ready", side="operator")
    call = board.robot_calls()
    number = board.waits("tablet", "calling")["call"] + 1
    board.does("late", "ready", side="operator")
    assert board.waits("late", "ringing")["call"] == number
    assert board.does("late", "answer", call=number) and call.result(AT_ONCE)


def test_a_lost_page_ends_the_call_for_the_other(board: Switchboard) -> None:
    call = board.robot_calls()
    board.does("desk", "answer", call=board.waits("desk", "ringing")["call"])
    assert call.result(AT_ONCE)
    board.calls.left("tablet")
    assert board.waits("desk", "ended")["because"] == "lost"
    assert board.over.wait(AT_ONCE)


def test_a_stop_ends_the_ringing(board: Switchboard) -> None:
    stop = StopFlag()
    call = board.robot_calls(stop)
    board.waits("desk", "ringing")
    stop.set()
    with pytest.raises(Stopped):
        call.result(AT_ONCE)
    board.waits("desk", "ended")


def test_an_operator_calls_the_robot(board: Switchboard) -> None:
    number = board.does("desk", "start", who="Nurse Ann")
    assert board.waits("tablet", "ringing")["who"] == "Nurse Ann"
    with pytest.raises(NotPossible, match="in a video call"):
        board.does("desk", "start", who="Nurse Ann")
    assert board.does("tablet", "answer", call=number)
    assert board.waits("desk", "answered")["offers"]
    board.calls.hang_up()
    board.waits("tablet", "ended")
    board.calls.left("tablet")
    with pytest.raises(NotPossible, match="open anywhere"):
        board.does("desk", "start", who="Nurse Ann")


# --- from page to page


@pytest.fixture
def patient() -> Iterator[Switchboard]:
    """One that waits long for a page to come back."""
    board = Switchboard(returns_within=AT_ONCE)
    board.does("tablet", "ready", side="face")
    board.does("desk", "ready", side="operator")
    yield board
    board.calls.close()
    board.threads.shutdown()


def answered(board: Switchboard) -> tuple[int, str]:
    """The desk calls the robot, and is answered: the call, and the key of the desk."""
    number = board.does("desk", "start", who="Ruth")
    board.does("tablet", "answer", call=number)
    return number, board.waits("desk", "answered")["key"]


def test_a_page_takes_up_the_call_of_another_one(patient: Switchboard) -> None:
    number, key = answered(patient)
    patient.calls.left("desk")
    patient.waits("tablet", "away")
    patient.told.clear()
    patient.does("map", "ready", side="operator")
    assert not patient.does("map", "resume", call=number, key="guessed")
    assert patient.does("map", "resume", call=number, key=key)
    assert patient.waits("map", "answered")["offers"]
    assert not patient.waits("tablet", "answered")["offers"], "who stayed is sure to listen"
    patient.does("tablet", "signal", call=number, signal={"candidate": 1})
    assert patient.told[-1][0] == "map"
    assert not patient.over.is_set()
    patient.does("map", "end", call=number)
    assert patient.waits("tablet", "ended")["because"] == "hung_up"
    assert not patient.does("late", "resume", call=number, key=key)


def test_both_sides_may_be_between_pages(patient: Switchboard) -> None:
    number, key = answered(patient)
    tablets = patient.waits("tablet", "answered")["key"]
    patient.calls.left("desk")
    patient.calls.left("tablet")
    patient.told.clear()
    assert patient.does("map", "resume", call=number, key=key)
    assert not patient.told, "nobody is there to connect to"
    assert patient.does("new tablet", "resume", call=number, key=tablets)
    patient.waits("map", "answered")
    patient.waits("new tablet", "answered")


def test_who_does_not_come_back_has_left(board: Switchboard) -> None:
    number, key = answered(board)
    board.calls.left("desk")
    assert board.waits("tablet", "ended")["because"] == "lost"
    assert not board.does("map", "resume", call=number, key=key)


def test_it_rings_on_where_somebody_goes_to_another_page(patient: Switchboard) -> None:
    called = patient.robot_calls()
    number = patient.waits("desk", "ringing")["call"]
    patient.calls.left("desk")
    patient.does("map", "ready", side="operator")
    assert patient.waits("map", "ringing")["call"] == number
    assert patient.does("map", "answer", call=number) and called.result(AT_ONCE)


# --- in browsers

MOVES = """() => {
  const video = document.querySelector('video.theirs');
  return video && video.videoWidth > 0 && video.currentTime > 0.3;
}"""
WATCH_TRACKS = """() => {
  window.tracks = [];
  const open = navigator.mediaDevices.getUserMedia.bind(navigator.mediaDevices);
  navigator.mediaDevices.getUserMedia = async (wanted) => {
    const stream = await open(wanted);
    window.tracks.push(...stream.getTracks());
    return stream;
  };
}"""
CAMERA_IS_OFF = "() => tracks.length > 0 && tracks.every((track) => track.readyState === 'ended')"


def operators_page(look: Look) -> Page:
    page = look("/")
    page.evaluate(WATCH_TRACKS)
    expect(page.locator(".video-call.operator[data-ready]")).to_be_attached()
    return page


def test_a_call_between_two_browsers(
    look: Look, served: Served, picture: Callable[[Page, str], None]
) -> None:
    face = look("/face", width=1024, height=768)
    face.evaluate(WATCH_TRACKS)
    expect(face.locator(".video-call.face[data-ready]")).to_be_attached()
    expect(face.locator("body[data-ready]")).to_be_attached()
    desk = operators_page(look)
    robot = served.robot()
    with ThreadPoolExecutor() as threads:
        called = threads.submit(robot.call, "reception")
        expect(face.get_by_text("Calling reception")).to_be_visible()
        desk.get_by_role("button", name="Accept").click()
        called.result(AT_ONCE)
        for page in (desk, face):
            page.wait_for_function(MOVES)
        picture(desk, "video-call")
        picture(face, "face-video-call")
        face.get_by_role("button", name="Hang up").click()
        for page in (desk, face):
            expect(page.get_by_text("The call is over.")).to_be_visible()
            page.wait_for_function(CAMERA_IS_OFF)
            assert page.locator("video").count() == 0

        called = threads.submit(robot.call, "reception")
        desk.get_by_role("button", name="Decline").click()
        with pytest.raises(NotPossible, match="declined"):
            called.result(AT_ONCE)

    desk.evaluate("document.dispatchEvent(new CustomEvent('call-robot'))")
    face.get_by_role("button", name="Accept").click()
    for page in (desk, face):
        page.wait_for_function(MOVES)
    face.close()
    expect(desk.get_by_text("The connection to the other side was lost.")).to_be_visible()
    desk.wait_for_function(CAMERA_IS_OFF)
    robot.close()


LEFT_OF_PANEL = "document.querySelector('.video-call').getBoundingClientRect().left"


@pytest.mark.parametrize("size", [{}, {"width": 390, "height": 844}])
def test_a_call_survives_going_from_page_to_page(
    look: Look, served: Served, size: dict[str, int]
) -> None:
    face = look("/face", width=1024, height=768)
    face.evaluate(WATCH_TRACKS)
    expect(face.locator("body[data-ready]")).to_be_attached()
    expect(face.locator(".video-call.face[data-ready]")).to_be_attached()
    page = look("/drive", **size)
    expect(page.locator(".video-call.operator[data-ready]")).to_be_attached()
    page.get_by_role("button", name="Video call with the robot").click()
    face.get_by_role("button", name="Accept").click()
    for each in (page, face):
        each.wait_for_function(MOVES)
    microphone = page.locator("[data-call=microphone]")
    microphone.click()
    expect(microphone).to_have_attribute("aria-pressed", "false")

    for name in ("Map", "Talk"):
        page.get_by_role("link", name=name, exact=True).click()
        for each in (page, face):
            expect(each.get_by_text("In a call with")).to_be_visible()
            each.wait_for_function(MOVES)
        expect(page.locator("[data-call=microphone]")).to_have_attribute("aria-pressed", "false")
        aside = page.locator("[data-call=aside]")
        right = page.evaluate(LEFT_OF_PANEL)
        aside.click()  # it lay upon what is to be read
        assert page.evaluate(LEFT_OF_PANEL) <= min(16, right)
        aside.click()
        assert page.evaluate(LEFT_OF_PANEL) == right
    page.evaluate(WATCH_TRACKS)
    page.get_by_role("button", name="Hang up").click()
    expect(face.get_by_text("The call is over.")).to_be_visible()
    face.wait_for_function(CAMERA_IS_OFF)
    page.reload()
    expect(page.locator(".video-call.operator[data-ready]")).to_be_attached()
    expect(page.locator("video")).to_have_count(0)


SIZES = [(1440, 900), (1280, 720), (820, 1180), (390, 844)]


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_call_map_and_joystick_are_in_one_view(
    look: Look, served: Served, picture: Callable[[Page, str], None], width: int, height: int
) -> None:
    face = look("/face?answer=auto", width=1024, height=768)
    expect(face.locator("body[data-ready]")).to_be_attached()
    expect(face.locator(".video-call.face[data-ready]")).to_be_attached()
    page = look("/drive", width=width, height=height)
    page.get_by_role("button", name="Take the helm").click()
    page.get_by_role("button", name="Telepresence").click()
    start = page.get_by_role("button", name="Video call with the robot")
    expect(start.locator("visible=true")).to_have_count(1)
    start.locator("visible=true").click()
    page.wait_for_function(MOVES)
    stands = page.locator("video.theirs, #drive-map .floor-stage, .stick, [data-call=hang_up]")
    expect(stands).to_have_count(4)
    for each in stands.all():
        expect(each).to_be_in_viewport(ratio=0.99)
    stop = page.get_by_role("button", name="STOP")
    expect(stop).to_be_in_viewport(ratio=1)
    assert page.evaluate("[document.documentElement.scrollWidth, scrollY]") == [width, 0]
    picture(page, f"telepresence-{width}")

    with served.robot() as robot:
        robot.localize("charger")
        before = robot.location()
        page.keyboard.down("w")  # the joystick works beside the call
        moved = "() => parseFloat(document.querySelector('[data-vital=speed]').dataset.speed) > 0.1"
        page.wait_for_function(moved)
        page.keyboard.up("w")
        assert robot.location() != before

    page.reload()  # the view is the same, and the call goes on in it
    page.wait_for_function(MOVES)
    expect(page.locator(".presence-call video.theirs")).to_be_in_viewport()
    page.get_by_role("button", name="All controls").click()
    expect(page.get_by_role("button", name="Say it")).to_be_attached()
    page.wait_for_function(MOVES)
    page.get_by_role("button", name="Hang up").last.click()
    expect(page.get_by_text("The call is over.")).to_be_visible()
