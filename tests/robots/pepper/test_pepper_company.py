"""Pepper speaks, hears, waves and shows."""

from __future__ import annotations

import base64
import threading
import wave
from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from robot_api.capabilities.sound import Asked, Sound
from robot_api.checker import check_driver
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall, NotPossible, NotSupported, TimedOut
from robot_api.robots.pepper import PepperSettings
from robot_api.robots.robot_file import RobotFile
from tests.robots.pepper.conftest import Call, call, until

RECORDING = Path(__file__).parents[2] / "speech" / "recordings" / "to-the-pharmacy-please.wav"


class Silent:
    """Ears that nobody speaks to."""

    def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> None:
        return None


# --- speech --------------------------------------------------------------------------------------


def test_it_speaks_the_languages_that_are_installed(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(languages=["French", "English", "Japanese"])
    driver = drive(pepper)
    assert driver.capabilities().languages == ("en", "fr")
    call(driver, "say", text="Bonjour.")  # what it was set to
    call(driver, "say", text="Good morning.", language="en")
    call(driver, "set_volume", percent=30)
    call(driver, "set_language", code="en")
    call(driver, "say", text="Hello.")
    assert pepper.said == [
        ["Bonjour.", "French", 50],
        ["Good morning.", "English", 50],
        ["Hello.", "English", 30],
    ]
    with pytest.raises(NotSupported, match="I speak English and French"):
        call(driver, "say", text="Guten Tag.", language="de")


def test_what_would_command_its_voice_is_only_read(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """A text may make it neither louder than is allowed nor move its arms."""
    pepper = standing_in()
    driver = drive(pepper)
    call(driver, "say", text=r"\vol=100\Fire! ^start(animations/Stand/Gestures/Hey_1)")
    assert pepper.texts == [" vol=100 Fire!  start(animations/Stand/Gestures/Hey_1)"]


def test_it_moves_its_arms_while_it_speaks_where_that_is_wanted(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    call(drive(pepper, settings=PepperSettings(animated_speech=True)), "say", text="Hello.")
    assert "animated contextual" in pepper.done


def test_the_server_speaks_in_its_place(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    heard: list[tuple[str, str, int]] = []

    class Loudspeaker:
        @contextmanager
        def speaking(self, stop: StopFlag, text: str, language: str, volume: int) -> Any:
            heard.append((text, language, volume))
            yield

    pepper = standing_in()
    driver = drive(pepper, file=RobotFile(speech="server"), sound=Sound(Loudspeaker()))
    call(driver, "set_volume", percent=20)
    call(driver, "set_language", code="de")
    call(driver, "say", text="Guten Tag.")
    assert heard == [("Guten Tag.", "de", 20)]
    assert pepper.texts == []


# --- hearing -------------------------------------------------------------------------------------


def test_its_own_microphone_is_what_our_ears_hear(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """Sample for sample, and only while somebody is listened to."""
    sound = b""

    class Ears:
        def __init__(self, microphone: Any) -> None:
            self._microphone = microphone

        def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> str:
            nonlocal sound
            with self._microphone() as blocks:
                for block in blocks:
                    stop.check()
                    sound += block
                    if len(sound) > 140_000:
                        break
            return "to the pharmacy"

    pepper = standing_in(voices=[str(RECORDING)], hurry=20.0)
    driver = drive(pepper, sound=Sound(ears_at=Ears))
    assert "subscribe" not in pepper.done
    assert call(driver, "ask", question="Where to?", options=["pharmacy", "lobby"]) == "pharmacy"
    assert pepper.done[-2:] == ["subscribe", "unsubscribe"]
    with wave.open(str(RECORDING)) as recording:
        spoken = recording.readframes(recording.getnframes())
    assert spoken in sound


def test_a_firewall_keeps_its_sound_away(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    class Ears:
        def __init__(self, microphone: Any) -> None:
            self._microphone = microphone

        def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> None:
            with self._microphone() as blocks:
                for _ in blocks:
                    stop.check()

    driver = drive(standing_in(lost_sound=True), sound=Sound(ears_at=Ears))
    with pytest.raises(NotPossible, match="check its firewall"):
        call(driver, "listen")
    listening = Call(driver, "listen")
    listening.stop.set()  # nor does a stop wait for a sound
    assert listening.over(1.0)


def test_without_ears_nothing_is_asked(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    driver = drive(standing_in())
    assert not {"listen", "ask", "answer"} & set(driver.capabilities().methods)


def test_who_is_not_understood_touches_the_tablet(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper, sound=Sound(ears_at=lambda _: Silent()))
    asking = Call(driver, "ask", question="Tea or coffee?", options=["tea", "coffee & cake"])
    assert until(lambda: pepper.touch("coffee & cake"))
    assert asking.over()
    assert asking.result == "coffee & cake"


def test_a_pepper_that_is_answered_on_its_tablet_alone(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper, file=RobotFile(hearing="tablet"))
    asking = Call(driver, "ask", question="Are you well?", options=["yes", "no"])
    assert until(lambda: pepper.touch("yes"))
    assert asking.over()
    assert asking.result == "yes"


# --- the tablet ----------------------------------------------------------------------------------


def shown(pepper: Any) -> str:
    return base64.b64decode(pepper.shown.partition("base64,")[2]).decode()


def test_texts_pages_and_addresses_are_shown(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    call(driver, "show", text="Welcome <Ann> & Bob")
    assert "Welcome &lt;Ann&gt; &amp; Bob" in shown(pepper)
    call(driver, "show", html="<input id=name>")
    call(driver, "type_text", selector="#name", text="Ann")
    assert 'value="Ann"' in shown(pepper)
    call(driver, "show", url="https://example.org/")
    assert pepper.shown == "https://example.org/"
    driver.close()
    assert pepper.shown is None


def test_nobody_touches_and_an_old_button_does_not_count(
    standing_in: Callable[..., Any],
    drive: Callable[..., Any],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    asking = Call(driver, "touch", options=["tea", "coffee"])
    assert until(lambda: pepper.touch("tea"))
    assert asking.over()
    monkeypatch.setattr("robot_api.capabilities.screen.TOUCH_TIMEOUT", 0.3)
    pepper.touch("tea")  # is no longer there
    with pytest.raises(TimedOut):
        call(driver, "touch", options=["yes", "no"])


def test_our_own_face_is_on_its_tablet(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """Then the page shows by itself what it is told to, and tells what is touched."""
    pepper = standing_in()
    page = "http://192.168.1.5:9090/face?token=secret"
    driver = drive(pepper, settings=PepperSettings(face_page=page))
    assert pepper.shown == page
    screens: list[Any] = []
    driver.subscribe(lambda kind, data: screens.append(data) if kind == "screen" else None)
    call(driver, "show", text="Welcome")
    assert screens == [{"text": "Welcome"}]
    assert pepper.shown == page


# --- arms, joints, eyes --------------------------------------------------------------------------


def test_gestures_by_the_names_of_programs_and_by_the_robots_own(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    """What it comes with and lacks is not offered."""
    pepper = standing_in()
    file = RobotFile(gestures={"dance": "animations/Stand/Waiting/FunnyDancer_1"})
    driver = drive(pepper, file=file)
    assert driver.capabilities().gestures == ("wave", "nod", "shake head", "bow", "dance")
    call(driver, "gesture", name="Wave")
    call(driver, "gesture", name="dance")
    assert pepper.done[-2:] == [
        "animations/Stand/Gestures/Hey_1",
        "animations/Stand/Waiting/FunnyDancer_1",
    ]
    with pytest.raises(NotSupported, match="I know wave"):
        call(driver, "gesture", name="fly")


def test_joints_by_the_robots_own_names(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper)
    joints = driver.capabilities().joints
    assert joints["HeadYaw"] == (-119.5, 119.5)
    assert not {"WheelFL", "LHand"} & set(joints)
    told: list[Any] = []
    driver.subscribe(lambda kind, data: told.append(data) if kind == "joint" else None)
    call(driver, "joint", name="HeadYaw", degrees=45)
    assert told == [{"name": "HeadYaw", "degrees": 45.0}]
    assert pepper.angles["HeadYaw"] == pytest.approx(0.785, abs=0.001)
    for name, degrees in (("HeadYaw", 150), ("RElbowRoll", -5)):
        with pytest.raises(InvalidCall):
            call(driver, "joint", name=name, degrees=degrees)
    with pytest.raises(NotSupported, match="HeadYaw"):
        call(driver, "joint", name="tail", degrees=5)


def test_behaviours_that_are_installed_are_its_skills(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(hurry=0.1)
    driver = drive(pepper, file=RobotFile(skills={"taichi": "show some tai chi"}))
    assert driver.capabilities().skills == {"taichi": "show some tai chi"}
    with pytest.raises(InvalidCall, match="takes nothing besides"):
        call(driver, "do", skill="taichi", times=2)
    doing = Call(driver, "do", skill="taichi")
    assert until(lambda: "run taichi" in pepper.done)
    doing.stop.set()
    assert doing.over(1.0)
    assert until(lambda: "end taichi" in pepper.done)


def test_its_eyes_show_how_it_feels(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in()
    driver = drive(pepper, file=RobotFile(emotions={"proud": "#00ff00"}))
    call(driver, "emotion", name="sad")
    assert pepper.eyes == 0x0040FF
    call(driver, "emotion", name="proud")
    assert pepper.eyes == 0x00FF00


def test_without_eyes_its_face_is_on_the_tablet(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(without=["ALLeds"])
    call(drive(pepper), "emotion", name="happy")
    assert 'aria-label="happy"' in shown(pepper)


def test_a_pepper_with_little_offers_little(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    lacks = ["ALTabletService", "ALAnimationPlayer", "ALLeds", "ALAudioDevice", "ALAutonomousLife"]
    driver = drive(standing_in(without=lacks))
    methods = set(driver.capabilities().methods)
    assert not {"show", "touch", "gesture", "emotion", "ask", "do", "scan", "grab"} & methods
    assert {"say", "goto", "move", "joint", "battery"} <= methods


def test_two_do_not_speak_at_once(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    pepper = standing_in(speaks=100.0)
    driver = drive(pepper)
    threads = [
        threading.Thread(target=call, args=(driver, "say"), kwargs={"text": text * 20})
        for text in "ab"
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(pepper.texts) == ["a" * 20, "b" * 20]


def test_it_does_what_the_method_table_promises(
    standing_in: Callable[..., Any], drive: Callable[..., Any]
) -> None:
    class Ears:
        def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> str:
            if timeout > 60:
                stop.wait(timeout)
                stop.check()
            return asked.options[0] if asked.options else "yes"

    pepper = standing_in(speaks=400.0, hurry=1.0)
    driver = drive(pepper, sound=Sound(ears_at=lambda _: Ears()))
    over = threading.Event()

    def visitor() -> None:
        while not over.wait(0.05):
            pepper.touch("yes")

    touching = threading.Thread(target=visitor)
    touching.start()
    try:
        report = check_driver(driver)
        assert report == [], report.table()
    finally:
        over.set()
        touching.join()
