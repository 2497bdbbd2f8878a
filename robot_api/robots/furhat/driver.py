"""A driver for a Furhat: its capabilities, put together."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from typing import Any

from robot_api.capabilities.base import Capability, Hub
from robot_api.capabilities.core import Core, LogBook
from robot_api.capabilities.screen import TabletScreen
from robot_api.capabilities.sound import Sound
from robot_api.driver import StopFlag
from robot_api.drivers import ComposedDriver
from robot_api.errors import NotSupported
from robot_api.local_time import local_now
from robot_api.robots.furhat.face import FurhatFace, FurhatGesture, Gestures
from robot_api.robots.furhat.people import FurhatVision
from robot_api.robots.furhat.robot import STOP_WITHIN, Furhat
from robot_api.robots.furhat.settings import DEFAULT_PORT, FurhatSettings
from robot_api.robots.furhat.skills import FurhatSkills
from robot_api.robots.furhat.voice import FurhatHearing, FurhatSpeech, Voice
from robot_api.robots.link import Link
from robot_api.robots.places import Places
from robot_api.robots.registry import Setup
from robot_api.robots.robot_file import RobotFile


class FurhatCore(Core):
    """It stands on a desk, and hangs on the mains."""

    def __init__(self, book: LogBook, furhat: Furhat, places: Places) -> None:
        super().__init__(book)
        self._furhat = furhat
        self._places = {place.name: place.kind for place in places.named.values()}

    def wait(self, stop: StopFlag, seconds: float) -> None:
        stop.wait(seconds)
        stop.check()

    def place_kinds(self) -> Mapping[str, str]:
        return self._places

    def now(self) -> datetime:
        return local_now()

    def charge(self) -> float:
        return 100.0

    def rest(self) -> None:
        self._furhat.halt()

    def declares(self) -> dict[str, Any]:
        return {"stop_within": STOP_WITHIN}


class FurhatDriver(ComposedDriver):
    """See `connect`."""

    def __init__(self, setup: Setup, furhat: Furhat, hub: Hub, link: Link) -> None:
        file = setup.file
        settings = setup.settings
        if not isinstance(settings, FurhatSettings):
            settings = FurhatSettings()
        self._furhat = furhat
        self._vision = FurhatVision(furhat)
        book = LogBook(local_now, hub)
        super().__init__(
            name=file.name or "The Furhat",
            kind="furhat",
            parts=[
                FurhatCore(book, furhat, setup.places),
                *_talking(furhat, hub, settings, setup.sound),
                *_moving(furhat, hub, file),
                self._vision,
                FurhatSkills(furhat),
            ],
            hub=hub,
            book=book,
            link=link,
        )

    def begin(self) -> None:
        self._vision.begin()

    def close(self) -> None:
        try:
            super().close()
        finally:
            self._furhat.close()


def connect(setup: Setup) -> FurhatDriver:
    """A driver for the Furhat at that address. Raises `LostConnection` (nobody is there, or no
    Furhat), `AccessDenied` (it wants its key), `NotSupported` (the robot file asks for what it
    cannot do)."""
    _check(setup.file)
    address, hub = setup.address, Hub()
    link = Link(hub, setup.file.name or "The Furhat")
    host = f"[{address.host}]" if ":" in address.host else address.host
    furhat = Furhat(f"{host}:{address.port or DEFAULT_PORT}", setup.password, link)
    try:
        return FurhatDriver(setup, furhat, hub, link)
    except BaseException:
        furhat.close()
        raise


def _check(file: RobotFile) -> None:
    if file.joints:
        raise NotSupported(
            "A Furhat has no joints that can be set one by one. Take them out of the robot file."
        )
    if file.skills:
        raise NotSupported(
            "A Furhat's skills are known: look at person, look at point, light. Take the skills out"
            " of the robot file."
        )
    for who, what in ((file.speech, "speaks"), (file.hearing, "hears")):
        if who not in (None, "robot"):
            raise NotSupported(f"A Furhat {what} itself. Write 'robot' for it in the robot file.")


def _talking(furhat: Furhat, hub: Hub, settings: FurhatSettings, sound: Sound) -> list[Capability]:
    voice = Voice(furhat, settings)
    speech = FurhatSpeech(furhat, hub, voice, sound)
    screen = TabletScreen(hub, speech)
    return [speech, screen, FurhatHearing(furhat, hub, voice, speech, screen, settings)]


def _moving(furhat: Furhat, hub: Hub, file: RobotFile) -> list[Capability]:
    gestures = Gestures(furhat)
    return [
        FurhatGesture(gestures, hub, file.gestures),
        FurhatFace(furhat, gestures, hub, file.emotions),
    ]
