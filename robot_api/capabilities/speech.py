"""Speech: `say`, `set_volume`, `set_language`."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

from robot_api.capabilities.base import Capability, Hub, Turns
from robot_api.capabilities.emulation import Emulation, InEmulation
from robot_api.capabilities.languages import known_languages, language_data
from robot_api.capabilities.names import listed
from robot_api.capabilities.simulation import InSimulation
from robot_api.capabilities.sound import SILENT, Sound
from robot_api.driver import StopFlag
from robot_api.errors import NotSupported

if TYPE_CHECKING:
    from sim.simulation import Simulation


class Speech(Capability):
    """A voice. One text is spoken after the other, whoever asks for them."""

    name = "speech"
    lacking = "has no voice"

    def __init__(self) -> None:
        super().__init__()
        self._turns = Turns()

    @property
    @abstractmethod
    def language(self) -> str:
        """The code of the language that is spoken and heard unless a call says another."""

    @abstractmethod
    def speak(self, stop: StopFlag, text: str, language: str) -> None:
        """Speak aloud; returns when it has been spoken."""

    @abstractmethod
    def set_volume(self, stop: StopFlag, percent: int) -> None:
        """Be so loud from now on, and tell it to those who subscribed."""

    @abstractmethod
    def choose_language(self, code: str) -> None:
        """Speak and hear that one from now on, and tell it to those who subscribed."""

    def languages(self) -> tuple[str, ...]:
        return known_languages()

    def say(self, stop: StopFlag, text: str, language: str | None = None) -> None:
        code = self._known(language) if language else self.language
        with self._turns.mine(stop):
            self.speak(stop, text, code)

    def set_language(self, stop: StopFlag, code: str) -> None:
        self.choose_language(self._known(code))

    def declares(self) -> dict[str, Any]:
        return {"languages": self.languages()}

    def _known(self, code: str) -> str:
        if code[:2] in self.languages():
            return code[:2]
        names = [language_data(known).name or known for known in self.languages()]
        raise NotSupported(f"I do not speak the language '{code}'. I speak {listed(names)}.")


class EmulatedSpeech(InEmulation, Speech):
    def __init__(self, emulation: Emulation, sound: Sound = SILENT) -> None:
        super().__init__(emulation)
        self._sound = sound

    @property
    def language(self) -> str:
        return self.emulation.language

    def speak(self, stop: StopFlag, text: str, language: str) -> None:
        with self._sound.speaking(stop, text, language, self.emulation.volume):
            self.emulation.publish("speech", text=text, language=language)
            self.emulation.pass_time(1.0 + len(text) / 15, stop)

    def set_volume(self, stop: StopFlag, percent: int) -> None:
        self.emulation.volume = percent
        self.emulation.publish("volume", percent=percent)

    def choose_language(self, code: str) -> None:
        self.emulation.language = code
        self.emulation.publish("language", code=code)


class SimulatedSpeech(InSimulation, Speech):
    def __init__(self, simulation: Simulation, sound: Sound = SILENT) -> None:
        super().__init__(simulation)
        self._sound = sound

    @property
    def language(self) -> str:
        return self.simulation.robot.language

    def speak(self, stop: StopFlag, text: str, language: str) -> None:
        with self._sound.speaking(stop, text, language, self.simulation.robot.volume):
            self.run(self.simulation.speak(text, language), stop)

    def set_volume(self, stop: StopFlag, percent: int) -> None:
        self.simulation.set_volume(percent)

    def choose_language(self, code: str) -> None:
        self.simulation.set_language(code)
        self.simulation.emit("language", {"code": code})


class LoudspeakerSpeech(Speech):
    """The voice of a robot that has none: the server's, on its loudspeaker, or on whatever plays
    what is said. Without either it is written only."""

    stand_in = "the server's voice"

    def __init__(self, hub: Hub, sound: Sound) -> None:
        super().__init__()
        self._hub = hub
        self._sound = sound
        self._language = "en"
        self._volume = 80
        sound.publish_to(hub.forward)

    @property
    def language(self) -> str:
        return self._language

    def speak(self, stop: StopFlag, text: str, language: str) -> None:
        with self._sound.speaking(stop, text, language, self._volume):
            self._hub.publish("speech", text=text, language=language)

    def set_volume(self, stop: StopFlag, percent: int) -> None:
        self._volume = percent
        self._hub.publish("volume", percent=percent)

    def choose_language(self, code: str) -> None:
        self._language = code
        self._hub.publish("language", code=code)
