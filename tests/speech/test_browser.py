"""The robot is heard where its pages are open: on the wire, up to the sound that a page plays."""

from __future__ import annotations

import base64
import io
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import soundfile
from numpy.typing import NDArray

from nl2robot.cli import main as cli
from nl2robot.errors import ExitStatus
from nl2robot.speech.speak.aloud import aloud
from nl2robot.speech.speak.browser import PIECE, Browsers
from nl2robot.speech.speak.voices import Sound
from nl2robot.speech.speak.wishes import Wishes
from robot_api.client import Robot
from robot_api.driver import Event
from robot_api.drivers import simulated
from robot_api.errors import Stopped
from robot_api.protocol import MAX_FRAME
from robot_api.server import Server
from sim.simulation import Simulation
from sim.world.loading import load_world

LONG = "I will tell you about the rooms of this floor, one after the other, from left to right."
SOON = 20.0
"""Seconds to wait for, on a busy machine."""


class Page:
    """What a page hears, and when."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.heard: list[tuple[float, str, Event]] = []
        self._changed = threading.Condition()
        robot.subscribe(["sound", "silence", "speech"], self._take)

    def _take(self, kind: str, data: Event) -> None:
        with self._changed:
            self.heard.append((time.monotonic(), kind, data))
            self._changed.notify_all()

    def until(self, kind: str) -> float:
        """When the first event of that kind came."""
        with self._changed:
            found = self._changed.wait_for(lambda: kind in self.kinds, SOON)
        assert found, f"no event {kind}"
        return next(at for at, each, _ in self.heard if each == kind)

    @property
    def kinds(self) -> list[str]:
        return [kind for _, kind, _ in self.heard]

    @property
    def sounds(self) -> list[NDArray[np.int16]]:
        files = [base64.b64decode(data["audio"]) for _, kind, data in self.heard if kind == "sound"]
        return [soundfile.read(io.BytesIO(file), dtype="int16")[0] for file in files]


@pytest.fixture
def robot() -> Iterator[Robot]:
    ward = Simulation(load_world("ward"))
    with aloud(Wishes(speak="browser", voice="espeak"), ward.world) as sound:
        assert sound is not None
        driver = simulated(ward, sound(lambda: ward.time))
        with Server(driver, port=0) as server, Robot(server.address) as robot:
            yield robot
        driver.close()


@pytest.fixture
def page(robot: Robot) -> Page:
    return Page(robot)


def test_a_page_is_sent_what_the_robot_says_and_it_ends_when_it_was_heard(page: Page) -> None:
    began = time.monotonic()
    page.robot.say("Good morning. Lunch is ready.")
    took = time.monotonic() - began
    samples = np.concatenate(page.sounds)
    seconds = sum(data["seconds"] for _, kind, data in page.heard if kind == "sound")
    assert seconds == pytest.approx(len(samples) / 22_050, abs=0.01)
    assert seconds > 1
    assert abs(samples).max() > 3000
    assert seconds <= took < seconds + 5
    assert "silence" not in page.kinds


def test_a_stop_is_heard_at_once(page: Page) -> None:
    failed: list[Exception] = []

    def say() -> None:
        try:
            page.robot.say(LONG)
        except Stopped as stopped:
            failed.append(stopped)

    saying = threading.Thread(target=say)
    saying.start()
    page.until("sound")
    with Robot(page.robot.address) as somebody:
        stopped = time.monotonic()
        somebody.stop()
    saying.join(SOON)
    assert failed
    assert page.until("silence") - stopped < 0.1
    assert page.kinds[-1] == "silence"  # nothing is sent after it


def test_it_is_as_loud_as_it_was_told_to_be(page: Page) -> None:
    page.robot.set_volume(100)
    page.robot.say("Hello.")
    loud = abs(np.concatenate(page.sounds)).max()
    page.heard.clear()
    page.robot.set_volume(50)
    page.robot.say("Hello.")
    assert abs(np.concatenate(page.sounds)).max() == pytest.approx(loud / 4, rel=0.02)


def test_no_piece_is_longer_than_a_frame_may_be() -> None:
    browsers = Browsers()
    events: list[Event] = []
    browsers.subscribe(lambda kind, data: events.append(data))
    noise = np.arange(int(48_000 * (2 * PIECE + 0.5))).astype(np.int16)
    browsers.write(Sound(noise, 48_000), 0.0)
    assert [event["seconds"] for event in events] == [PIECE, PIECE, 0.5]
    assert max(len(event["audio"]) for event in events) < MAX_FRAME


def test_who_is_spoken_to_gives_way_and_its_program_goes_on() -> None:
    ward = Simulation(load_world("ward"))
    with aloud(Wishes(speak="browser", voice="espeak"), ward.world) as sound_for:
        assert sound_for is not None
        sound = sound_for(lambda: ward.time)
        driver = simulated(ward, sound)
        heard = threading.Event()
        driver.subscribe(lambda kind, data: heard.set() if kind == "sound" else None)

        def interrupt() -> None:
            heard.wait(SOON)
            sound.give_way()

        somebody = threading.Thread(target=interrupt)
        somebody.start()
        with Server(driver, port=0) as server, Robot(server.address) as robot:
            began = time.monotonic()
            robot.say(LONG)  # no error
            assert time.monotonic() - began < 4
        somebody.join(SOON)
        driver.close()


def test_only_a_server_has_pages_to_be_heard_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        cli.main(["run", "say hello", "--speak", "browser"])
    assert ended.value.code == ExitStatus.BAD_INPUT
    assert "'browser' is no .wav file" in capsys.readouterr().err
