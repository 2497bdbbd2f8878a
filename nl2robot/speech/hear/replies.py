"""What somebody replied to the robot: the answer that was expected, or the words.

`Replies` makes words of a sound; `AtMicrophone` waits for somebody to speak and is a robot's ears
(`robot_api.capabilities.sound.Ears`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

from nl2robot.errors import UserError
from nl2robot.speech.audio import Audio, Samples
from nl2robot.speech.hear.answers import expect, expected_by, hear_answer
from nl2robot.speech.hear.listening import ANSWERS, Listener, NothingHeard, SpeechEnded, TooLong
from nl2robot.speech.hear.recogniser import Recogniser, SpeechError
from robot_api.capabilities.sound import Unsure
from robot_api.errors import NotPossible

if TYPE_CHECKING:
    from robot_api.capabilities.sound import Asked
    from robot_api.driver import StopFlag

LIKELY: Final = 0.4
"""The share from which an answer is worth asking about."""

Microphone = Callable[[], AbstractContextManager[Iterable[Samples]]]
"""Opens one: blocks of sound at 16 kHz, for as long as it is open."""


@dataclass(frozen=True)
class Replies:
    """What replies are made of, by language."""

    recogniser_for: Callable[[str], Recogniser]
    """Raises `UserError` where a language cannot be heard."""
    phrases_for: Callable[[str], Sequence[str]]
    """What may be said to a question of which nothing is known."""

    def recognised(self, audio: Audio, asked: Asked) -> str | Unsure:
        """The answer, as the question has it; else the words; empty if there were none. `Unsure`
        where an option is likely, but not sure enough to act on."""
        recogniser = self.recogniser_for(asked.language)
        expected = expected_by(asked.question or "", asked.options, asked.language)
        if expected:
            try:
                answer = hear_answer(recogniser, audio, expect(expected, asked.language))
            except SpeechError:  # it knows none of the words: then the touchscreen will have to do
                return recogniser.recognise(audio).text
            if answer.answer is None and asked.options and answer.likely:
                perhaps, share = answer.likely[0]
                if share >= LIKELY and perhaps in asked.options:
                    return Unsure(answer.heard, perhaps)
            if answer.answer or asked.options:
                return answer.answer or answer.heard
        heard = recogniser.recognise(audio, self.phrases_for(asked.language))
        return (heard.free_text or "") if heard.doubtful else heard.text


class AtMicrophone:
    """The ears of a robot whose microphone is here."""

    def __init__(self, microphone: Microphone, replies: Replies) -> None:
        self._microphone = microphone
        self._replies = replies

    def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> str | Unsure | None:
        """As `Ears.hear`. Raises `NotPossible` where nothing can be heard."""
        try:
            self._replies.recogniser_for(asked.language)  # loaded before somebody speaks
            listener = Listener(manner=replace(ANSWERS, patience=timeout))
            with self._microphone() as blocks:
                for block in blocks:
                    stop.check()
                    for event in listener.feed(block):
                        if isinstance(event, SpeechEnded):
                            return self._replies.recognised(event.audio, asked) or None
                        if isinstance(event, NothingHeard | TooLong):
                            return None
        except UserError as error:
            raise NotPossible(str(error)) from error
        return None
