"""A run that is heard: what `--speak`, `--voices` and `--mic` ask for, for a simulated robot.

    with aloud(Wishes(speak=Path("run.wav"), voices=True), world) as sound:
        simulated_station(world, log, sound=sound)

Whatever is missing is found out here, before anything runs.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from nl2robot.speech.hear.answers import expect
from nl2robot.speech.hear.full_duplex import FullDuplex, full_duplex
from nl2robot.speech.hear.microphone import Microphone
from nl2robot.speech.hear.open_microphone import OpenMicrophone
from nl2robot.speech.hear.recogniser import load
from nl2robot.speech.hear.replies import AtMicrophone, Replies
from nl2robot.speech.hear.vocabulary import number_words
from nl2robot.speech.speak.browser import Browsers
from nl2robot.speech.speak.loudspeaker import Nowhere, Output, SoundCard, SoundError, WavFile
from nl2robot.speech.speak.people import SimulatedVoices
from nl2robot.speech.speak.sound_cache import KeptSounds, folder
from nl2robot.speech.speak.speaking import Speaker, Utterance
from nl2robot.speech.speak.text_normalisation import as_spoken
from nl2robot.speech.speak.voices import Voice, espeak, voice
from nl2robot.speech.speak.wishes import IN_BROWSERS, Clock, SoundFor, Wishes
from robot_api.capabilities.sound import Ears, Sound, Voices
from robot_api.capabilities.sound import Microphone as RobotsMicrophone

if TYPE_CHECKING:
    from nl2robot.speech.audio import Samples
    from robot_api.driver import StopFlag
    from sim.world.model import World


@contextmanager
def aloud(
    wishes: Wishes,
    world: World,
    tell: Callable[[str], None] | None = None,
    duplex: FullDuplex | None = None,
) -> Iterator[SoundFor | None]:
    """What a simulated robot needs for it; None if nothing is wished for. `tell` gets a sentence
    where something cannot be heard, by default on standard error. `duplex` hears at somebody else's
    microphone what is played. Raises `UserError`."""
    if not (wishes.speak or wishes.voices or wishes.microphone):
        yield None
        return
    tell = tell or _complain
    robots_voice = cache(lambda language: _robots_voice(language, wishes))
    if wishes.speak:
        next(robots_voice(wishes.language).speak("Hello."), None)  # loads it, or tells why not
    if wishes.voices:
        next(espeak(wishes.language).speak("Hello."), None)
    replies = None
    if wishes.voices or wishes.microphone:
        replies = _replies(wishes.language, world)
    with ExitStack() as stack:
        ears, own = None, None
        if replies is not None and wishes.microphone:
            if wishes.speak is True and duplex is None:
                duplex = own = full_duplex(tell)
            ears = stack.enter_context(_ears(wishes, replies, own))
        output = _output(wishes, tell, duplex)
        stack.callback(output.close)

        def sound_for(clock: Clock) -> Sound:
            in_real_time = isinstance(output, SoundCard | Browsers)
            speaker = Speaker(
                output,
                voice_for=robots_voice,
                kept=KeptSounds(folder()),
                clock=time.monotonic if in_real_time else clock,
                tell=tell,
            )
            stack.callback(speaker.close)
            if duplex is not None:
                duplex.speaker = speaker
            heard = wishes.speak and type(output) is not Nowhere
            loudspeaker = RobotVoice(speaker, duplex) if heard else None
            people = None
            if replies is not None and wishes.voices:
                people = _people(wishes, world, replies, speaker, clock)
            played = output.subscribe if isinstance(output, Browsers) else None
            return Sound(
                loudspeaker,
                ears=ears,
                voices=people,
                subscribe=played,
                give_way=speaker.interrupt,
                spoken=as_spoken,
            )

        yield sound_for


class RobotVoice:
    """A speaker as the robot's; `robot_api.capabilities.sound.Loudspeaker`."""

    def __init__(self, speaker: Speaker, duplex: FullDuplex | None = None) -> None:
        self.speaker = speaker
        self._duplex = duplex

    @contextmanager
    def speaking(self, stop: StopFlag, text: str, language: str, volume: int) -> Iterator[None]:
        """As `Loudspeaker.speaking`; whole or interrupted, it is over."""
        if self._duplex is not None:
            self._duplex.gave_way = False  # what was said before is no answer to this
        utterance: Utterance = self.speaker.begin(text, language, volume)
        stop.on_set(utterance.cancel)
        try:
            yield
        except BaseException:
            utterance.cancel()
            raise
        utterance.wait()
        stop.check()


def _robots_voice(language: str, wishes: Wishes) -> Voice:
    """The wished one; in a language that it does not speak, the best there is."""
    if wishes.voice and language != wishes.language:
        return voice(language)
    return voice(language, wishes.voice)


def ears_at(world: World) -> Callable[[RobotsMicrophone], Ears]:
    """Makes ears of a robot's own microphone. What recognises words is loaded when somebody is
    first listened to."""

    def made(microphone: RobotsMicrophone) -> Ears:
        import numpy as np

        @contextmanager
        def opened() -> Iterator[Iterator[Samples]]:
            with microphone() as blocks:
                yield (np.frombuffer(block, "<i2").astype(np.int16) for block in blocks)

        return AtMicrophone(opened, _replies_here(world))

    return made


def _replies(language: str, world: World) -> Replies:
    load(language)
    return _replies_here(world)


def _replies_here(world: World) -> Replies:
    return Replies(load, cache(lambda language: _said_here(world, language)))


@contextmanager
def _ears(wishes: Wishes, replies: Replies, duplex: FullDuplex | None) -> Iterator[Ears]:
    """With `duplex`, the microphone stays open: who answers may interrupt the question."""
    device = wishes.microphone if isinstance(wishes.microphone, str) else None

    @contextmanager
    def microphone() -> Iterator[Iterator[Samples]]:
        with Microphone(device) as opened:
            yield opened.blocks()

    with microphone():  # or it is told now that there is none
        pass
    if duplex is None:
        yield AtMicrophone(microphone, replies)
        return
    stays_open = OpenMicrophone(duplex, lambda: Microphone(device))
    stays_open.start()
    try:
        yield AtMicrophone(stays_open, replies)
    finally:
        stays_open.close()


def _output(wishes: Wishes, tell: Callable[[str], None], duplex: FullDuplex | None) -> Output:
    if isinstance(wishes.speak, Path):
        return WavFile(wishes.speak)
    if wishes.speak == IN_BROWSERS:
        return Browsers()
    if not wishes.speak:
        return Nowhere()
    try:
        return SoundCard(played=duplex.played if duplex else None)
    except SoundError as error:
        tell(str(error))
        return Nowhere()


def _people(
    wishes: Wishes, world: World, replies: Replies, speaker: Speaker, clock: Clock
) -> Voices:
    return SimulatedVoices(
        replies=replies,
        genders={person.name: person.gender for person in world.people},
        speaker=speaker,
        clock=clock,
        seed=wishes.seed,
    )


def _said_here(world: World, language: str) -> Sequence[str]:
    """What people may answer to any question: yes and no, numbers, what there is here."""
    named = (world.places, world.people, world.objects)
    names = [
        name
        for each in (thing for things in named for thing in things)
        for name in (each.name, *each.aliases.get(language, ()))
    ]
    return (
        *expect("yes-no", language).phrases,
        *(number_words(str(number), language) for number in range(101)),
        *(expect(names, language).phrases if names else ()),
    )


def _complain(message: str) -> None:
    print(message, file=sys.stderr, flush=True)
