"""A Pepper, put together from what it has and what stands in for what it lacks."""

from __future__ import annotations

from typing import Any

from robot_api.capabilities.base import Capability, Hub
from robot_api.capabilities.company import LeadingGuiding
from robot_api.capabilities.core import Core, LogBook
from robot_api.capabilities.driving import Navigation
from robot_api.capabilities.face import Face, ScreenFace
from robot_api.capabilities.hearing import EarsHearing, Hearing, TabletHearing
from robot_api.capabilities.screen import Screen
from robot_api.capabilities.sound import Ears
from robot_api.capabilities.speech import LoudspeakerSpeech, Speech
from robot_api.composed import ComposedDriver
from robot_api.driver import StopFlag
from robot_api.errors import NotSupported
from robot_api.local_time import local_now
from robot_api.methods import METHODS
from robot_api.robots.link import Link
from robot_api.robots.pepper.body import Body
from robot_api.robots.pepper.core import PepperCore
from robot_api.robots.pepper.ears import PepperMicrophone
from robot_api.robots.pepper.limbs import PepperEyes, PepperGesture, PepperJoints
from robot_api.robots.pepper.navigation import PepperNavigation
from robot_api.robots.pepper.session import Wire
from robot_api.robots.pepper.settings import PepperSettings
from robot_api.robots.pepper.skills import PepperSkills
from robot_api.robots.pepper.tablet import PepperScreen
from robot_api.robots.pepper.voice import PepperSpeech
from robot_api.robots.pepper.wheels import PepperMotion
from robot_api.robots.registry import Brake, Setup


class PepperDriver(ComposedDriver):
    """See `connect`."""

    def __init__(self, setup: Setup, wire: Wire, settings: PepperSettings) -> None:
        """Reaching for the robot moves nothing of it; what is wrong is known before it moves."""
        hub = Hub()
        book = LogBook(local_now, hub)
        name = setup.file.name or "Pepper"
        self._wire = wire
        self._body = Body(wire, settings.autonomous_life)
        parts = _parts(setup, wire, settings, self._body, hub, book)
        self._screen = next((part for part in parts if isinstance(part, PepperScreen)), None)
        link = Link(hub, name)
        super().__init__(name=name, kind="pepper", parts=parts, hub=hub, book=book, link=link)
        if self._screen is not None:
            self._screen.begin()
        wire.follow(link, self._body.found_again)

    def _do(self, part: Capability, method: str, arguments: dict[str, Any], stop: StopFlag) -> Any:
        """Whoever only asks leaves it as it is."""
        if METHODS[method].moves or not isinstance(part, Core | Navigation):
            self._body.take(stop)
        return super()._do(part, method, arguments, stop)

    def close(self) -> None:
        """Stop, leave the robot as it was found, and let go of it."""
        try:
            super().close()
        finally:
            if self._screen is not None:
                self._screen.close()
            self._body.give_back()
            self._wire.close()


def connect(setup: Setup) -> PepperDriver:
    """Reach the Pepper at an address. Raises `LostConnection`, `AccessDenied`, `NotSupported`."""
    settings = setup.settings
    if not isinstance(settings, PepperSettings):
        settings = PepperSettings()
    wire = Wire(setup.address, setup.password)
    wire.open()
    try:
        return PepperDriver(setup, wire, settings)
    except (TypeError, ValueError, LookupError) as error:
        wire.close()
        raise NotSupported(
            f"What answers at {setup.address.host} does not answer as a Pepper does ({error})."
            " Check the address, and the version of Pepper's software."
        ) from error
    except BaseException:
        wire.close()
        raise


def brake(setup: Setup) -> Brake:
    """What stops the robot beside a driver. Raises `LostConnection`, `AccessDenied`."""
    settings = setup.settings if isinstance(setup.settings, PepperSettings) else PepperSettings()
    wire = Wire(setup.address, setup.password)
    wire.open()
    return Brake(Body(wire, settings.autonomous_life).stand_still, wire.close)


def _parts(
    setup: Setup, wire: Wire, settings: PepperSettings, body: Body, hub: Hub, book: LogBook
) -> list[Capability]:
    file = setup.file
    speech = _speech(setup, wire, settings, hub)
    screen: Screen | None = None
    if wire.has("ALTabletService"):
        screen = PepperScreen(wire, speech, hub, settings.face_page)
    parts: list[Capability | None] = [
        PepperCore(wire, body, book, setup.places),
        speech,
        screen,
        _hearing(setup, wire, speech, screen, hub),
        PepperMotion(wire, body, file.limits),
        PepperJoints(wire, body, hub, settings.joint_speed),
        _face(setup, wire, screen, hub),
    ]
    if wire.has("ALAnimationPlayer"):
        parts.append(PepperGesture(wire, body, hub, file.gestures))
    if file.skills:
        parts.append(PepperSkills(wire, body, file.skills))
    if settings.map is not None:
        if not wire.has("ALNavigation"):
            raise NotSupported(
                "The robot file names a map, but this Pepper's software has no ALNavigation."
                " Bring it up to date, or take the map out of the file."
            )
        most = file.limits.speed
        navigation = PepperNavigation(wire, body, hub, setup.places, settings.map, most)
        parts += [navigation, LeadingGuiding(navigation, speech)]
    return [part for part in parts if part is not None]


def _speech(setup: Setup, wire: Wire, settings: PepperSettings, hub: Hub) -> Speech:
    own = wire.has("ALTextToSpeech", "ALAudioDevice")
    if setup.file.speech in (None, "robot") and own:
        animated = settings.animated_speech and wire.has("ALAnimatedSpeech")
        return PepperSpeech(wire, hub, setup.sound, animated=animated)
    return LoudspeakerSpeech(hub, setup.sound)


def _hearing(
    setup: Setup, wire: Wire, speech: Speech, screen: Screen | None, hub: Hub
) -> Hearing | None:
    """Its own ears where sound can be made words of, else the server's; none if there are none."""
    if setup.file.hearing == "tablet" and screen is not None:
        return TabletHearing(speech, screen)
    sound = setup.sound
    own: Ears | None = None
    if setup.file.hearing in (None, "robot") and wire.has("ALAudioDevice") and sound.ears_at:
        own = sound.ears_at(PepperMicrophone(wire))
    if own is not None:
        return EarsHearing(hub, speech, screen, own)
    if sound.ears is not None:
        return EarsHearing(hub, speech, screen, sound.ears, "the server's microphone")
    return None


def _face(setup: Setup, wire: Wire, screen: Screen | None, hub: Hub) -> Face | None:
    if wire.has("ALLeds"):
        return PepperEyes(wire, hub, setup.file.emotions)
    return ScreenFace(screen, hub) if screen is not None else None
