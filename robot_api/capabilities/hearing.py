"""Hearing: `listen`, `ask`, `answer`.

A robot only has to hear (`Hearing.hear`); asking until the answer is one of the options, with the
touchscreen as the way out, is the same for all.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from robot_api.capabilities.base import Capability, Hub
from robot_api.capabilities.emulation import Emulation, InEmulation
from robot_api.capabilities.languages import language_data
from robot_api.capabilities.matching import match_answer, match_question
from robot_api.capabilities.simulation import InSimulation
from robot_api.capabilities.sound import SILENT, Asked, Ears, Sound, Unsure
from robot_api.capabilities.tablet import answered, patience
from robot_api.driver import StopFlag
from robot_api.errors import NotFound, TimedOut
from robot_api.methods import MAX_TEXT

if TYPE_CHECKING:
    from robot_api.capabilities.screen import Screen
    from robot_api.capabilities.speech import Speech
    from sim.simulation import Simulation

ANSWER_TIMEOUT = 10.0
"""Seconds that somebody has to begin an answer."""
NOT_UNDERSTOOD = "Nobody gave an answer that I understood. Ask again when somebody is there."
"""Somebody spoke, and it was none of the answers that count."""
NOT_ANSWERED = "Nobody answered my question. Ask again when somebody is there."
_TRIES = 2
_YES_NO = ["yes", "no"]


@dataclass(frozen=True)
class Prepared:
    """A question that there is an answer for, in one language."""

    ways: tuple[str, ...]
    """The ways of asking it."""
    answer: str


class Hearing(Capability):
    """Ears, with a voice to ask and, if the robot has one, a touchscreen to fall back on; on a real
    tablet people may answer at once, instead of speaking."""

    name = "hearing"
    lacking = "cannot hear"
    hears_people = True
    """Whether it hears real people, and not simulated ones."""

    def __init__(self, speech: Speech | None, screen: Screen | None) -> None:
        super().__init__()
        self._speech = speech
        self._screen = screen

    @property
    @abstractmethod
    def language(self) -> str:
        """The code of the language that is heard."""

    @abstractmethod
    def hear(
        self,
        stop: StopFlag,
        timeout: float,
        question: str | None = None,
        options: Sequence[str] | None = None,
        person: str | None = None,
    ) -> str | Unsure | None:
        """The words of whoever speaks within `timeout` seconds, or None. What was asked, the
        answers that count and who is asked may help to recognise them; an answer that was heard
        badly is `Unsure`."""

    def prepared(self, language: str) -> Sequence[Prepared]:
        """The questions that there are answers for: none, unless a robot has some."""
        return ()

    def is_here(self, person: str) -> bool:
        """Whether that person can be spoken to; a robot that cannot tell believes it."""
        return True

    def listen(self, stop: StopFlag, prompt: str | None, timeout: float) -> str:
        heard = _words(self._answered(stop, prompt, timeout, prompt))
        if heard is None:
            raise TimedOut(
                f"I listened for {timeout:g} seconds, but nobody spoke. "
                "Speak up, or let me listen longer."
            )
        return heard[:MAX_TEXT]

    def ask(
        self, stop: StopFlag, question: str, options: list[str] | None, person: str | None
    ) -> str:
        if person is not None and not self.is_here(person):
            raise NotFound(f"I do not see {person} here. Let me look for {person} first.")
        misheard = spoken = False
        for attempt in range(_TRIES):
            again = language_data(self.language).again
            said = f"{again} {question}" if misheard else question
            heard = self._answered(stop, said, ANSWER_TIMEOUT, question, options, person)
            spoken = spoken or heard is not None
            if isinstance(heard, Unsure) and options and heard.perhaps in options:
                if self._confirmed(stop, heard.perhaps, person):
                    return heard.perhaps
                misheard = attempt == 0
                continue
            words = _words(heard)
            if words is None:
                continue
            if not options:
                return words[:MAX_TEXT]
            answer = self._chosen(words, options)
            if answer is not None:
                return answer
            misheard = attempt == 0
        if options and self._screen is not None and self._screen.touchable:
            choose = language_data(self.language).choose
            try:
                return self._screen.touch(stop, options, f"{question} {choose}")
            except TimedOut:
                if not spoken:
                    raise
        raise TimedOut(NOT_UNDERSTOOD if spoken else NOT_ANSWERED)

    def _chosen(self, words: str, options: Sequence[str]) -> str | None:
        """The option that is meant, by its own words or by those that the tablet has for it."""
        answer = match_answer(words, options, self.language)
        if answer is not None:
            return answer
        names = self.tablet.called(options, self.language)
        name = match_answer(words, names, self.language)
        return options[names.index(name)] if name is not None else None

    def _confirmed(self, stop: StopFlag, perhaps: str, person: str | None) -> bool:
        """Whether somebody says that this is what they answered."""
        question = language_data(self.language).was_that.format(perhaps)
        heard = _words(self._answered(stop, question, ANSWER_TIMEOUT, question, _YES_NO, person))
        return heard is not None and match_answer(heard, _YES_NO, self.language) == "yes"

    def _answered(
        self,
        stop: StopFlag,
        say: str | None,
        timeout: float,
        question: str | None = None,
        options: Sequence[str] | None = None,
        person: str | None = None,
    ) -> str | Unsure | None:
        """Say it and hear the answer (`hear`), which on a real tablet may also be touched or typed,
        whichever comes first, or be given by somebody elsewhere. Simulated people leave it to
        whoever stands there."""

        def heard(stop: StopFlag) -> str | Unsure | None:
            return self.hear(stop, timeout, question, options, person)

        def meanwhile(stop: StopFlag) -> str | Unsure | None:
            if say:
                self._say(stop, say)
            if self.hears_people or not self.tablet.connected:
                return heard(stop)
            patience(stop, self.tablet, timeout)
            return None

        touchable = self._screen is not None and self.tablet.connected
        if not (touchable or self.tablet.helped):
            return meanwhile(stop)
        asked = Asked(self.language, question, options, person)
        touched, words = answered(stop, self.tablet, asked, meanwhile)
        if touched is not None:
            if self._screen is not None:
                self._screen.noticed(touched)
            return touched
        gone = touchable and not self.tablet.connected and not self.hears_people
        return heard(stop) if gone and words is None else words

    def answer(self, stop: StopFlag, question: str | None) -> str:
        asked = self.listen(stop, None, ANSWER_TIMEOUT) if question is None else question
        prepared = self.prepared(self.language)
        which = match_question(asked, [known.ways for known in prepared], self.language)
        reply = language_data(self.language).no_answer if which is None else prepared[which].answer
        self._say(stop, reply)
        return reply[:MAX_TEXT]

    def _say(self, stop: StopFlag, text: str) -> None:
        if self._speech is not None:
            self._speech.say(stop, text)
        elif self._screen is not None:
            self._screen.show(stop, text, None, None)


def _words(heard: str | Unsure | None) -> str | None:
    return heard.words if isinstance(heard, Unsure) else heard


class EmulatedHearing(InEmulation, Hearing):
    """Hears the canned answers in their order, then the first option or "yes"; with ears, what is
    said."""

    def __init__(
        self,
        emulation: Emulation,
        speech: Speech | None,
        screen: Screen | None,
        sound: Sound = SILENT,
    ) -> None:
        super().__init__(emulation, speech, screen)
        self._sound = sound
        self.hears_people = sound.ears is not None

    @property
    def language(self) -> str:
        return self.emulation.language

    def hear(
        self,
        stop: StopFlag,
        timeout: float,
        question: str | None = None,
        options: Sequence[str] | None = None,
        person: str | None = None,
    ) -> str | Unsure | None:
        if self._sound.ears is not None:
            asked = Asked(self.language, question, options, person)
            heard = self._sound.ears.hear(stop, timeout, asked)
        else:
            heard = self.emulation.next_answer(options[0] if options else "yes")
        self.emulation.pass_time(timeout if heard is None else min(2.0, timeout), stop)
        if heard is not None:
            self.emulation.publish("heard", text=_words(heard), person=person)
        return heard

    def prepared(self, language: str) -> Sequence[Prepared]:
        return [Prepared((ask,), answer) for ask, answer in self.emulation.questions.items()]


class SimulatedHearing(InSimulation, Hearing):
    def __init__(
        self,
        simulation: Simulation,
        speech: Speech | None,
        screen: Screen | None,
        sound: Sound = SILENT,
    ) -> None:
        super().__init__(simulation, speech, screen)
        self._sound = sound
        self.hears_people = sound.ears is not None

    @property
    def language(self) -> str:
        return self.simulation.robot.language

    def hear(
        self,
        stop: StopFlag,
        timeout: float,
        question: str | None = None,
        options: Sequence[str] | None = None,
        person: str | None = None,
    ) -> str | Unsure | None:
        ears, voices = self._sound.ears, self._sound.voices
        asked = Asked(self.language, question, options, person)
        if ears is not None:
            heard = ears.hear(stop, timeout, asked)
            return self._published(heard, person)
        if voices is None:
            return self.run(self.simulation.hear(timeout, question, options, person), stop)
        reply = self.run(self.simulation.reply(timeout, question, options, person), stop)
        if reply is None:
            return None
        return self._published(voices.heard(stop, reply.person, reply.words, asked), reply.person)

    def prepared(self, language: str) -> Sequence[Prepared]:
        return [
            Prepared(known.ask[language], known.answer[language])
            for known in self.simulation.world.questions
            if language in known.ask and language in known.answer
        ]

    def is_here(self, person: str) -> bool:
        return bool(self.simulation.visible(person))

    def _published(self, heard: str | Unsure | None, person: str | None) -> str | Unsure | None:
        if heard:
            self.simulation.emit("heard", {"text": _words(heard), "person": person})
        return heard or None


class EarsHearing(Hearing):
    """Hears by ears that recognise words: the server's, or those that it makes of the robot's own
    microphone. Speaks and hears one language, the speech's."""

    def __init__(
        self,
        hub: Hub,
        speech: Speech,
        screen: Screen | None,
        ears: Ears,
        stand_in: str | None = None,
    ) -> None:
        super().__init__(speech, screen)
        self._hub = hub
        self._voice = speech
        self._ears = ears
        self.stand_in = stand_in

    @property
    def language(self) -> str:
        return self._voice.language

    def hear(
        self,
        stop: StopFlag,
        timeout: float,
        question: str | None = None,
        options: Sequence[str] | None = None,
        person: str | None = None,
    ) -> str | Unsure | None:
        heard = self._ears.hear(stop, timeout, Asked(self.language, question, options, person))
        if heard:
            self._hub.publish("heard", text=_words(heard), person=person)
        return heard or None


class TabletHearing(Hearing):
    """A robot that nobody can speak to: people answer on its tablet."""

    stand_in = "the tablet"

    def __init__(self, speech: Speech, screen: Screen) -> None:
        super().__init__(speech, screen)
        self._voice = speech

    @property
    def language(self) -> str:
        return self._voice.language

    def hear(
        self,
        stop: StopFlag,
        timeout: float,
        question: str | None = None,
        options: Sequence[str] | None = None,
        person: str | None = None,
    ) -> str | Unsure | None:
        """Gives people time to touch and to type, if they can."""
        patience(stop, self.tablet, timeout)
        return None
