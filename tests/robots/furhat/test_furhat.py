"""A Furhat at the reception: it welcomes visitors, and has bad days."""

from __future__ import annotations

import queue
import re
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from nl2robot.speech.speak.text_normalisation import as_spoken
from robot_api import Robot, Server
from robot_api.capabilities import screen
from robot_api.capabilities.sound import SILENT, Asked, Sound
from robot_api.capabilities.tablet import NO_TABLET
from robot_api.checker import check_robot
from robot_api.driver import Event, StopFlag
from robot_api.drivers import ComposedDriver, emulated
from robot_api.errors import (
    AccessDenied,
    InvalidCall,
    LostConnection,
    NotSupported,
    RobotError,
    StopNotConfirmed,
    Stopped,
    TimedOut,
)
from robot_api.robots.address import Address
from robot_api.robots.furhat import FURHAT, connection, face, robot, voice
from robot_api.robots.furhat.settings import FurhatSettings
from robot_api.robots.places import NamedPlace, Places
from robot_api.robots.reading import read_robot_file
from robot_api.robots.registry import Setup
from robot_api.robots.robot_file import RobotFile
from tests.robots.furhat.stand_in import SOON, VOICES, Cable, FurhatStandIn

DOCS = Path(__file__).parents[3] / "docs" / "robots" / "furhat.md"
PLACES = Places({name: NamedPlace(name, kind="room") for name in ("pharmacy", "radiology")})

WELCOME = """
robot.wait_for("visitor")
robot.gesture("nod")
robot.emotion("happy")
place = robot.ask("Welcome! Where would you like to go?", ["pharmacy", "radiology"])
if place == "pharmacy":
    robot.say("The pharmacy is down this corridor, the second door on the left.")
else:
    robot.say("Radiology is upstairs, beside the lift.")
robot.say("A visitor has been shown the way to " + place + ".")
"""


@pytest.fixture
def furhat() -> Iterator[FurhatStandIn]:
    with FurhatStandIn() as furhat:
        yield furhat


@contextmanager
def connected(
    port: int,
    *,
    key: str | None = None,
    file: RobotFile | None = None,
    settings: FurhatSettings | None = None,
    sound: Sound = SILENT,
) -> Iterator[ComposedDriver]:
    setup = Setup(
        address=Address("furhat", "127.0.0.1", port),
        file=file or RobotFile(),
        places=PLACES,
        settings=settings,
        password=key,
        sound=sound,
    )
    driver = FURHAT.connect(setup)
    assert isinstance(driver, ComposedDriver)
    try:
        yield driver
    finally:
        driver.close()


@pytest.fixture
def driver(furhat: FurhatStandIn) -> Iterator[ComposedDriver]:
    with connected(furhat.port) as driver:
        yield driver


def do(driver: ComposedDriver, method: str, **arguments: Any) -> Any:
    return driver.call(method, arguments, StopFlag())


class Bystander:
    """Notices what happens to a robot."""

    def __init__(self, driver: ComposedDriver) -> None:
        self._events: queue.SimpleQueue[tuple[str, Event]] = queue.SimpleQueue()
        driver.subscribe(lambda kind, data: self._events.put((kind, data)))

    def sees(self, kind: str, **data: Any) -> Event:
        """Wait for the next such event."""
        while True:
            came, what = self._events.get(timeout=SOON)
            if came == kind and data.items() <= dict(what).items():
                return what


class Errand:
    """A call in a thread of its own."""

    def __init__(self, call: Callable[[], Any]) -> None:
        self._outcome: queue.SimpleQueue[Any] = queue.SimpleQueue()

        def run() -> None:
            try:
                self._outcome.put(call())
            except BaseException as error:  # noqa: BLE001 - looked at by who waits for it
                self._outcome.put(error)

        threading.Thread(target=run, daemon=True).start()

    def outcome(self) -> Any:
        return self._outcome.get(timeout=SOON)


def talk(driver: ComposedDriver, furhat: FurhatStandIn) -> Errand:
    """It is in the middle of a long story."""
    furhat.seconds_a_letter = 1.0
    errand = Errand(lambda: do(driver, "say", text="Once upon a time there was a ward."))
    furhat.until(lambda furhat: furhat.speaking)
    furhat.seconds_a_letter = 0.001
    return errand


# --- at the reception ----------------------------------------------------------------------------


def test_a_visitor_is_welcomed_and_shown_the_way(
    furhat: FurhatStandIn, driver: ComposedDriver
) -> None:
    furhat.hears.append("to the pharmacy, please")
    with Server(driver, port=0) as server, Robot(server.address) as robot:
        program = Errand(lambda: exec(WELCOME, {"robot": robot}))
        furhat.until(lambda furhat: bool(furhat.asked("request.users.once")))
        furhat.users.append("user-7")  # somebody steps up to it
        assert program.outcome() is None
    assert furhat.said == [
        "Welcome! Where would you like to go?",
        "The pharmacy is down this corridor, the second door on the left.",
        "A visitor has been shown the way to pharmacy.",
    ]
    assert furhat.attends == "user-7"
    gestures = [made["name"] for made in furhat.asked("request.gesture.start")]
    assert gestures == ["Nod", "BigSmile"]
    config = furhat.asked("request.listen.config")[-1]
    assert config["phrases"] == ["pharmacy", "radiology"]


def test_it_speaks_as_people_do_and_shows_what_is_written(furhat: FurhatStandIn) -> None:
    with connected(furhat.port, sound=Sound(spoken=as_spoken)) as driver:
        bystander = Bystander(driver)
        do(driver, "say", text="Dr. Kim comes at 13:00.")
        assert furhat.said == ["Doctor Kim comes at one p.m."]
        bystander.sees("speech", text="Dr. Kim comes at 13:00.")


def test_somebody_stops_it_in_the_middle_of_a_sentence(
    furhat: FurhatStandIn, driver: ComposedDriver
) -> None:
    bystander = Bystander(driver)
    talking = talk(driver, furhat)
    driver.stop("Quiet, please.")
    assert not furhat.speaking  # it has confirmed it
    assert isinstance(talking.outcome(), Stopped)
    bystander.sees("stopped", because="Quiet, please.")
    assert furhat.said == []
    do(driver, "say", text="As you wish.")
    assert furhat.said == ["As you wish."]


def test_it_tells_all_its_clients_what_it_does(
    furhat: FurhatStandIn, driver: ComposedDriver
) -> None:
    furhat.tells_all = True
    do(driver, "say", text="One.")
    talking = talk(driver, furhat)
    driver.stop("Quiet, please.")
    assert isinstance(talking.outcome(), Stopped)
    do(driver, "say", text="Two.")
    driver.stop("Enough.")
    assert furhat.said == ["One.", "Two."]


def test_one_call_is_ended_and_it_falls_silent(
    furhat: FurhatStandIn, driver: ComposedDriver
) -> None:
    furhat.seconds_a_letter = 1.0
    flag = StopFlag()
    talking = Errand(lambda: driver.call("say", {"text": "A long story."}, flag))
    furhat.until(lambda furhat: furhat.speaking)
    flag.set()
    assert isinstance(talking.outcome(), Stopped)
    furhat.until(lambda furhat: not furhat.speaking)


def test_it_stops_listening_when_it_is_stopped(
    furhat: FurhatStandIn, driver: ComposedDriver
) -> None:
    listening = Errand(lambda: do(driver, "listen", timeout=3600))
    furhat.until(lambda furhat: furhat.listening)
    driver.stop("Never mind.")
    assert isinstance(listening.outcome(), Stopped)
    furhat.until(lambda furhat: not furhat.listening)


def test_each_visitor_is_met_once(furhat: FurhatStandIn, driver: ComposedDriver) -> None:
    furhat.users += ["user-1", "user-2"]
    assert do(driver, "sees", thing="somebody")
    assert do(driver, "count", thing="people") == 2
    assert do(driver, "people") == ["a person", "a person"]
    assert do(driver, "wait_for", thing="person", timeout=0)
    assert furhat.attends == "user-1"
    assert do(driver, "wait_for", thing="a person", timeout=0)
    assert furhat.attends == "user-2"
    assert not do(driver, "wait_for", thing="person", timeout=0.1)
    driver.begin()  # another program
    assert do(driver, "wait_for", thing="person", timeout=0)


@pytest.mark.parametrize("thing", ["cup", "nurse", "person waving", "Alice"])
def test_it_does_not_claim_to_see_what_it_cannot(driver: ComposedDriver, thing: str) -> None:
    for method in ("sees", "count", "wait_for"):
        with pytest.raises(NotSupported, match="not who it is"):
            do(driver, method, thing=thing)
    with pytest.raises(NotSupported):
        do(driver, "find", thing="person")


def test_what_it_says_and_hears_changes_with_the_language(
    furhat: FurhatStandIn, driver: ComposedDriver
) -> None:
    assert driver.capabilities().languages == ("en", "de")  # it has no French voice
    do(driver, "say", text="Good morning.")
    assert furhat.asked("request.voice.config") == []  # somebody chose the voice that it has
    do(driver, "set_language", code="de")
    furhat.hears.append("zur Apotheke")
    assert do(driver, "ask", question="Wohin?", options=["Apotheke", "Labor"]) == "Apotheke"
    assert furhat.voice["name"] == "Vicki"
    assert furhat.asked("request.listen.config")[-1]["languages"] == ["de-DE"]
    do(driver, "say", text="Goodbye.", language="en")
    assert furhat.asked("request.voice.config")[-1]["language"] == "en-US"
    with pytest.raises(NotSupported, match="I speak English and German"):
        do(driver, "set_language", code="fr")


def test_the_robot_file_names_voice_gestures_and_emotions(furhat: FurhatStandIn) -> None:
    file = RobotFile(name="Frieda", gestures={"agree": "Nod"}, emotions={"happy": "Smile"})
    settings = FurhatSettings(voices={"de": "Vicki"}, locales={"de": "de-CH"})
    furhat.hears.append("ja")
    with connected(furhat.port, file=file, settings=settings) as driver:
        assert driver.capabilities().name == "Frieda"
        do(driver, "gesture", name="agree")
        do(driver, "emotion", name="happy")
        do(driver, "emotion", name="neutral")
        do(driver, "set_language", code="de")
        do(driver, "ask", question="Alles gut?")
    assert [made["name"] for made in furhat.asked("request.gesture.start")] == ["Nod", "Smile"]
    assert len(furhat.asked("request.face.reset")) == 1
    assert furhat.asked("request.voice.config")[-1]["name"] == "Vicki"
    assert furhat.asked("request.listen.config")[-1]["languages"] == ["de-CH"]


def test_the_robot_file_in_the_docs_is_one(tmp_path: Path) -> None:
    [written] = re.findall(r"```yaml\n(.*?)```", DOCS.read_text("utf-8"), re.DOTALL)
    file = tmp_path / "robot.yaml"
    file.write_text(written, "utf-8")
    read = read_robot_file(file, FURHAT)
    assert read.file.name == "Frieda"
    assert read.settings == FurhatSettings(voices={"de": "Vicki"}, locales={"en": "en-GB"})


def test_the_docs_name_what_it_can_do(driver: ComposedDriver) -> None:
    works = DOCS.read_text("utf-8").split("## What works")[1].split("What it lacks")[0]
    has = driver.capabilities()
    assert set(re.findall(r"`([a-z_]+)`", works)) - {"light"} == set(has.methods)
    assert all(name in works for name in (*has.gestures, *has.skills))


def test_its_light_and_where_it_looks(furhat: FurhatStandIn, driver: ComposedDriver) -> None:
    do(driver, "do", skill="light", color="#00ff00")
    assert furhat.light == "#00ff00"
    do(driver, "do", skill="look at person")
    assert furhat.attends == "closest"
    do(driver, "do", skill="look at point", x=1, y=0, z=2.5)
    assert furhat.attends == (1, 0, 2.5)
    for wrong in (
        {"skill": "light"},
        {"skill": "light", "color": "<b>"},
        {"skill": "light", "color": 7},
        {"skill": "look at person", "who": "Alice"},
        {"skill": "look at point", "x": 1, "y": 0, "z": 1e9},
        {"skill": "look at point", "x": True, "y": 0, "z": 0},
    ):
        with pytest.raises(InvalidCall):
            do(driver, "do", **wrong)
    with pytest.raises(NotSupported):
        do(driver, "do", skill="sit")


def test_a_tablet_beside_it_is_touched_when_nobody_is_understood(
    furhat: FurhatStandIn, driver: ComposedDriver
) -> None:
    class FingerOnLab:
        """Somebody who does not speak, and touches at the end."""

        connected = True

        def answer(self, stop: StopFlag, asked: Asked) -> str | None:
            if "screen" not in (asked.question or ""):
                stop.wait(SOON)
                stop.check()
            return "lab"

        def __getattr__(self, name: str) -> Any:
            return getattr(NO_TABLET, name)

    furhat.hears += ["er", "hm"]
    driver.attach(FingerOnLab())
    bystander = Bystander(driver)
    assert do(driver, "ask", question="Where to?", options=["lab", "pharmacy"]) == "lab"
    assert bystander.sees("screen")["options"] == ["lab", "pharmacy"]


def test_nobody_touches_a_tablet_that_is_not_there(
    driver: ComposedDriver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(screen, "TOUCH_TIMEOUT", 0.2)
    with pytest.raises(TimedOut, match="Nobody touched"):
        do(driver, "touch", options=["yes", "no"])


def test_it_conforms_also_where_the_network_fails(
    furhat: FurhatStandIn, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(screen, "TOUCH_TIMEOUT", 0.2)
    furhat.seconds_a_letter = 0.01
    furhat.hears += ["yes"] * 4
    furhat.users.append("user-1")
    address = Address("furhat", "127.0.0.1", furhat.port)
    report = check_robot(lambda address: FURHAT.connect(Setup(address=address)), address)
    assert list(report) == []


# --- listening -----------------------------------------------------------------------------------


def test_nobody_speaks(furhat: FurhatStandIn, driver: ComposedDriver) -> None:
    with pytest.raises(TimedOut, match="nobody spoke"):
        do(driver, "listen", timeout=0.1)
    assert 0 < furhat.asked("request.listen.start")[0]["no_speech_timeout"] <= 0.1


def test_it_listens_again_when_it_was_kept_from_it(
    furhat: FurhatStandIn, driver: ComposedDriver
) -> None:
    furhat.ends_listening.append("robot_speak")
    furhat.hears.append("good morning")
    assert do(driver, "listen") == "good morning"


def test_words_without_an_end_are_what_was_understood(
    furhat: FurhatStandIn, driver: ComposedDriver
) -> None:
    furhat.words_end = False
    furhat.hears.append("pharmacy please")
    assert do(driver, "listen") == "pharmacy"


# --- a stop tells the truth ----------------------------------------------------------------------


def test_a_robot_that_does_not_answer_has_not_stopped(
    furhat: FurhatStandIn, driver: ComposedDriver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(robot, "STOP_WITHIN", 0.2)
    furhat.never.add("request.face.status")
    with pytest.raises(StopNotConfirmed, match="robot's own button"):
        driver.stop("Stop!")


def test_a_robot_that_goes_on_speaking_has_not_stopped(
    furhat: FurhatStandIn, driver: ComposedDriver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(robot, "STOP_WITHIN", 0.2)
    talk(driver, furhat)
    furhat.never.add("request.speak.stop")
    with pytest.raises(StopNotConfirmed):
        driver.stop("Stop!")
    furhat.never.clear()
    driver.stop("Stop, I said!")
    assert not furhat.speaking


def test_a_gesture_is_waited_for(furhat: FurhatStandIn, driver: ComposedDriver) -> None:
    furhat.gesture_seconds = 0.3
    nodding = Errand(lambda: do(driver, "gesture", name="nod"))
    furhat.until(lambda furhat: bool(furhat.asked("request.gesture.start")))
    driver.stop("Stop!")
    assert furhat.gestures_made == 1
    assert isinstance(nodding.outcome(), Stopped)


def test_a_gesture_that_takes_too_long_is_not_called_stopped(
    furhat: FurhatStandIn, driver: ComposedDriver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(robot, "STOP_WITHIN", 0.1)
    furhat.gesture_seconds = 1.0
    Errand(lambda: do(driver, "gesture", name="nod"))
    furhat.until(lambda furhat: bool(furhat.asked("request.gesture.start")))
    with pytest.raises(StopNotConfirmed):
        driver.stop("Stop!")


def test_a_sentence_that_begins_after_the_stop_is_silenced(
    furhat: FurhatStandIn, driver: ComposedDriver
) -> None:
    furhat.thinks = threading.Event()
    furhat.seconds_a_letter = 1.0
    talking = Errand(lambda: do(driver, "say", text="A voice from far away."))
    furhat.until(lambda furhat: bool(furhat.asked("request.speak.text")))
    driver.stop("Stop!")
    assert isinstance(talking.outcome(), Stopped)
    furhat.thinks.set()
    furhat.until(lambda furhat: furhat.aborted == 1)


# --- lost and found ------------------------------------------------------------------------------


def test_the_network_is_cut_in_the_middle_of_a_sentence(furhat: FurhatStandIn) -> None:
    with Cable(furhat.port) as cable, connected(cable.port) as driver:
        bystander = Bystander(driver)
        talking = talk(driver, furhat)
        waiting = Errand(lambda: do(driver, "listen", timeout=3600))
        furhat.until(lambda furhat: furhat.listening)
        cable.cut()
        lost = bystander.sees("link", state="lost")
        assert "does not answer any more" in lost["because"]
        for errand in (talking, waiting):
            assert isinstance(errand.outcome(), LostConnection)
        with pytest.raises(LostConnection, match="switched on"):
            do(driver, "say", text="Anybody there?")
        with pytest.raises(StopNotConfirmed):
            driver.stop("Stop!")

        cable.mend()
        bystander.sees("link", state="connected")
        furhat.until(lambda furhat: not furhat.speaking)  # nothing is taken up again
        do(driver, "say", text="Here I am again.")
        assert furhat.said == ["Here I am again."]


def test_a_plug_is_pulled(furhat: FurhatStandIn, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "PING_EVERY", 0.1)
    monkeypatch.setattr(connection, "PONG_WITHIN", 0.3)
    with Cable(furhat.port) as cable, connected(cable.port) as driver:
        bystander = Bystander(driver)
        waiting = Errand(lambda: do(driver, "listen", timeout=3600))
        furhat.until(lambda furhat: furhat.listening)
        cable.hold_back()  # no network says that nobody is there any more
        bystander.sees("link", state="lost")
        assert isinstance(waiting.outcome(), LostConnection)
        cable.cut()
        cable.mend()
        bystander.sees("link", state="connected")


def test_it_is_switched_off_and_on_again(furhat: FurhatStandIn) -> None:
    with Cable(furhat.port) as cable, connected(cable.port) as driver:
        bystander = Bystander(driver)
        do(driver, "say", text="Auf Wiedersehen.", language="de")
        cable.cut()
        bystander.sees("link", state="lost")
        furhat.voice = VOICES[0]  # it begins anew with its first voice
        cable.mend()
        bystander.sees("link", state="connected")
        do(driver, "say", text="Guten Morgen.", language="de")
        assert furhat.voice["name"] == "Vicki"


def test_it_is_let_go_of(furhat: FurhatStandIn) -> None:
    with connected(furhat.port):
        assert furhat.clients == 2
    furhat.until(lambda furhat: furhat.clients == 0)


# --- bad input, and a robot that is not well -----------------------------------------------------


def test_nobody_is_there() -> None:
    with socket.create_server(("127.0.0.1", 0)) as closed:
        port = closed.getsockname()[1]
    with pytest.raises(LostConnection, match=f"127.0.0.1:{port} does not answer"), connected(port):
        pass


def test_who_is_there_is_no_furhat(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(connection, "OPENS_WITHIN", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as mute, pytest.raises(LostConnection):
        connected(mute.getsockname()[1]).__enter__()
    with Server(emulated(), port=0) as server:
        port = int(server.address.rpartition(":")[2])
        with pytest.raises(LostConnection, match="is no Furhat"):
            connected(port).__enter__()


@pytest.mark.parametrize("key", [None, "guessed"])
def test_the_key_is_wrong(key: str | None) -> None:
    with FurhatStandIn(key="sesame") as furhat:
        with pytest.raises(AccessDenied, match="NL2ROBOT_ROBOT_PASSWORD"):
            connected(furhat.port, key=key).__enter__()
        with connected(furhat.port, key="sesame") as driver:
            do(driver, "say", text="Hello.")


@pytest.mark.parametrize(
    "file",
    [
        RobotFile(joints={"head": (-40, 40)}),
        RobotFile(skills={"sit": "sit down"}),
        RobotFile(speech="server"),
        RobotFile(hearing="tablet"),
    ],
)
def test_a_robot_file_of_another_robot(furhat: FurhatStandIn, file: RobotFile) -> None:
    with pytest.raises(NotSupported, match="robot file"), connected(furhat.port, file=file):
        pass
    assert furhat.received == []


def test_it_talks_nonsense_besides(furhat: FurhatStandIn) -> None:
    furhat.nonsense = [
        *("", "hello", "[1, 2]", "{}", '{"type": 7}', "[" * 100_000, b"\xff\xfe"),
        '{"type": "response.speak.end"}',
        '{"type": "response.users.data", "request_id": 4, "users": 5}',
    ]
    furhat.voices = {"Amy": 1}
    furhat.users.append("user-1")
    furhat.hears.append("to the lab")
    with connected(furhat.port) as driver:
        assert driver.capabilities().languages == ("en", "de", "fr")  # it does not tell
        do(driver, "say", text="Hello.")
        assert do(driver, "count", thing="person") == 1
        assert do(driver, "listen") == "to the lab"
        do(driver, "gesture", name="nod")
        driver.stop("Enough.")


@pytest.mark.parametrize(
    ("deaf_to", "method", "arguments"),
    [
        ("request.speak.text", "say", {"text": "Hello."}),
        ("request.listen.start", "listen", {}),
        ("request.users.once", "people", {}),
        ("request.face.status", "emotion", {"name": "neutral"}),
        ("request.voice.status", "say", {"text": "Hallo.", "language": "de"}),
    ],
)
def test_it_is_there_but_does_nothing(
    furhat: FurhatStandIn,
    driver: ComposedDriver,
    monkeypatch: pytest.MonkeyPatch,
    deaf_to: str,
    method: str,
    arguments: dict[str, Any],
) -> None:
    monkeypatch.setattr(voice, "_STARTS_WITHIN", 0.1)
    monkeypatch.setattr(voice, "_HESITATES", 0.1)
    monkeypatch.setattr(robot, "ANSWERS_WITHIN", 0.1)
    furhat.never.add(deaf_to)
    with pytest.raises(LostConnection, match="does not do what it is asked"):
        do(driver, method, **arguments)


def test_it_answers_late(furhat: FurhatStandIn, driver: ComposedDriver) -> None:
    furhat.late = {"request.users.once": 0.3, "request.speak.text": 0.3}
    assert do(driver, "count", thing="person") == 0
    do(driver, "say", text="Well ...")
    assert furhat.said == ["Well ..."]


def test_its_voice_fails(furhat: FurhatStandIn, driver: ComposedDriver) -> None:
    furhat.fails_to_speak = True
    with pytest.raises(NotSupported, match="Choose another voice"):
        do(driver, "say", text="Hello.")


def test_a_gesture_that_this_robot_does_not_know(
    furhat: FurhatStandIn, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(face, "_STARTS_WITHIN", 0.1)
    with connected(furhat.port, file=RobotFile(gestures={"salute": "Salute"})) as driver:
        with pytest.raises(NotSupported, match="'Salute'"):
            do(driver, "gesture", name="salute")
        with pytest.raises(RobotError, match="I do not know the gesture 'wave'"):
            do(driver, "gesture", name="wave")
