"""The robot's own voice, and what is told to it by name: gestures, emotions, skills."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

from robot_api.capabilities.arms import Gesture
from robot_api.capabilities.base import Hub
from robot_api.capabilities.face import Face
from robot_api.capabilities.skills import Skills
from robot_api.capabilities.sound import SILENT, Sound
from robot_api.capabilities.speech import Speech
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall, NotPossible, NotSupported
from robot_api.robots.ros.connection import Line
from robot_api.robots.ros.dialect import field
from robot_api.robots.ros.settings import SpeechService

_SPEAKS_WITHIN = 120.0
"""Seconds that a service has to speak a text."""
_WORKS_WITHIN = 120.0
"""Seconds that a skill has to be done."""
_GESTURE_SECONDS = 3.0
"""For how long a gesture counts as going on: nobody says when it is over."""

Say = Callable[[StopFlag, str, str], None]
"""Speaks a text in a language; returns when it has been spoken."""


def by_topic(line: Line, topic: str, kind: str) -> Say:
    """A std_msgs/String that is spoken. Nobody says when it has been, so it takes as long as a text
    of that length does."""
    line.advertise(topic, kind)

    def say(stop: StopFlag, text: str, language: str) -> None:
        line.publish(topic, {"data": text})
        stop.wait(0.5 + len(text) / 15)
        stop.check()

    return say


def by_service(line: Line, service: SpeechService) -> Say:
    """A service that answers when it has spoken."""

    def say(stop: StopFlag, text: str, language: str) -> None:
        arguments = {service.text: text}
        if service.language is not None:
            arguments[service.language] = language
        answer = line.now.call(service.name, arguments, within=_SPEAKS_WITHIN, stop=stop)
        if not answer.ok:
            raise NotSupported(
                f"My voice does not work ({answer.said[:120]}). Tell whoever looks after the robot."
            )

    return say


class RosSpeech(Speech):
    """Its volume is its own."""

    def __init__(self, hub: Hub, say: Say, languages: Sequence[str], sound: Sound = SILENT) -> None:
        """What it says goes through `sound.spoken`."""
        super().__init__()
        self._hub = hub
        self._say = say
        self._spoken = sound.spoken
        self._languages = tuple(languages)
        self._language = self._languages[0]

    def offers(self) -> tuple[str, ...]:
        return tuple(name for name in super().offers() if name != "set_volume")

    def languages(self) -> tuple[str, ...]:
        return self._languages

    @property
    def language(self) -> str:
        return self._language

    def speak(self, stop: StopFlag, text: str, language: str) -> None:
        self._hub.publish("speech", text=text, language=language)
        self._say(stop, self._spoken(text, language), language)

    def set_volume(self, stop: StopFlag, percent: int) -> None:
        raise NotSupported("I cannot speak louder or more softly. Turn my loudspeaker up or down.")

    def choose_language(self, code: str) -> None:
        self._language = code
        self._hub.publish("language", code=code)


class Names:
    """Things that a robot has names of its own for, published on a topic."""

    def __init__(self, line: Line, topic: str, kind: str, names: Mapping[str, str]) -> None:
        self._line = line
        self._topic = topic
        self._names = names
        line.advertise(topic, kind)

    def __iter__(self) -> Iterator[str]:
        return iter(self._names)

    def publish(self, name: str) -> None:
        self._line.publish(self._topic, {"data": self._names[name]})


class RosGesture(Gesture):
    def __init__(self, hub: Hub, names: Names) -> None:
        self._hub = hub
        self._names = names
        self.gestures = tuple(names)

    def make(self, stop: StopFlag, gesture: str) -> None:
        self._names.publish(gesture)
        self._hub.publish("gesture", name=gesture)
        stop.wait(_GESTURE_SECONDS)
        stop.check()


class RosFace(Face):
    def __init__(self, hub: Hub, names: Names) -> None:
        self._hub = hub
        self._names = names
        self.emotions = tuple(names)

    def express(self, stop: StopFlag, emotion: str) -> None:
        self._names.publish(emotion)
        self._hub.publish("emotion", name=emotion)


class RosSkills(Skills):
    """Each a std_srvs/Trigger service."""

    def __init__(self, line: Line, services: Mapping[str, str], skills: Mapping[str, str]) -> None:
        self._line = line
        self._services = services
        self._skills = skills

    @property
    def skills(self) -> Mapping[str, str]:
        return self._skills

    def use(self, stop: StopFlag, skill: str, parameters: dict[str, Any]) -> Any:
        if parameters:
            raise InvalidCall(f"The skill '{skill}' takes nothing besides. Leave the rest out.")
        began = time.monotonic()
        answer = self._line.now.call(self._services[skill], within=_WORKS_WITHIN, stop=stop)
        if answer.ok and field(answer.values, "success") is not False:
            return None
        said = str(field(answer.values, "message") or answer.said)[:120].rstrip(".!? ")
        raise NotPossible(
            f"I could not {skill}{f' ({said})' if said else ''} after"
            f" {time.monotonic() - began:.0f} seconds. Tell whoever looks after the robot."
        )
