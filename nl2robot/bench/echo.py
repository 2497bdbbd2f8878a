"""How well the robot is interrupted, and does not hear itself:
`python -m nl2robot.bench.echo`.

Its voice is played by a small loudspeaker into a room, comes back late, and louder than the person
who speaks over it in another voice. A session is one room and one canceller that knows nothing of
it at the beginning; the robot speaks alone, and then somebody speaks over it. "Before" is without
cancelling, "now" is with it.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from dataclasses import dataclass, field
from difflib import SequenceMatcher
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.bench.trials import Speaker, spoken
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, Audio, Samples
from nl2robot.speech.hear.echo_cancelling import EchoCanceller, Played
from nl2robot.speech.hear.full_duplex import BargeIn, Over
from nl2robot.speech.hear.listening import SpeechEnded
from nl2robot.speech.hotword.detection import Detection
from nl2robot.speech.hotword.detector import Detector, HotWord, StopWord
from nl2robot.speech.scenes import Signal
from nl2robot.speech.speak.loudspeaker import LATENCY
from nl2robot.speech.speak.voices import espeak, voice
from nl2robot.voice.hearing import Ear
from sim.world.loading import load_world

TEXTS: Final = (
    "Good morning. I am the robot of this ward, and I can take you to any place in the hospital.",
    "The pharmacy is closed today, but the night service can help you. Please ring twice.",
    "Hello Alice, would you like coffee, tea or water? You can also choose nothing at all.",
    "Please go to radiology, wait there for the doctor, and bring the red cup to the kitchen.",
    "There are two wheelchairs in the lobby, and nobody is in the waiting room at the moment.",
)
WITH_ITS_WORDS: Final = (
    "Please stop here and wait. The bus stop is in front of the main entrance.",
    "If you need me again, say hey robot, and then tell me where to go.",
)
"""With the words that it obeys at once."""
DELAYS: Final = (0.02, 0.06, 0.15)
"""Seconds until the sound comes back, beyond the buffer that the loudspeaker is known to have."""
LOUDER: Final = (0.0, 6.0, 12.0)
"""Decibels by which the robot is louder than the person, at the microphone."""
SPOKEN_OVER: Final = 4  # times in a session
LEVEL: Final = 0.05  # of the person, of full scale
CORRIDOR: Final = 25.0  # decibels by which it is quieter than the person
BLOCK: Final = RATE // 50  # as a microphone gives them
QUIET: Final = 0.25  # seconds before what a `Speaker` says


def _both() -> dict[str, int]:
    return {"raw": 0, "cleaned": 0}


@dataclass
class Figures:
    """Of one voice of the robot at one loudness."""

    minutes: float = 0.0  # of the robot alone
    interruptions: int = 0  # by itself, before anybody speaks
    woken: dict[str, int] = field(default_factory=_both)
    """Or stopped, by itself: by text where nothing is cleaned (`OwnVoice`), else where a voice is
    heard (`BargeIn.nobody`)."""
    commands: dict[str, int] = field(default_factory=_both)
    cries: int = 0
    obeyed: dict[str, int] = field(default_factory=_both)
    spoken_over: int = 0
    delays: list[float] = field(default_factory=list)  # of those that were noticed
    words: dict[str, list[float]] = field(
        default_factory=lambda: {"alone": [], "raw": [], "cleaned": []}
    )


@dataclass(frozen=True, eq=False)
class Scene:
    """What a microphone heard while the robot spoke."""

    raw: Samples
    """With the robot speaking to its end."""
    cleaned: Samples
    nobody: NDArray[np.bool_]
    """Of each sample, whether `BargeIn.nobody`."""
    silent: float
    """When the robot fell silent, in seconds."""


class Session:
    """One room, in which the robot begins to speak for the first time."""

    def __init__(self, rng: np.random.Generator, delay: float, louder: float) -> None:
        self._rng = rng
        room = float(rng.uniform(0.3, 0.7))
        self._to_robot = np.concatenate(
            [np.zeros(int(delay * RATE), np.float32), scenes.echo(rng, room, 6.0)]
        )
        self._to_person = scenes.echo(rng, room, 3.0)
        self._loudness = LEVEL * 10 ** (louder / 20)
        self._played = Played()
        self._canceller = EchoCanceller(self._played)
        self._gain: float | None = None  # of the loudspeaker, from its first words on
        self._now = 0.0

    def hear(self, robot: Signal, person: Signal, at: float) -> Scene:
        """The robot falls silent if somebody begins to speak in the cleaned sound."""
        count = max(len(robot), int(at * RATE) + len(person)) + RATE
        count -= count % BLOCK
        play = np.zeros(count, np.float32)
        play[: len(robot)] = robot
        others = self._person(person, at, count)
        barge_in, cleaned, nobody, silent = BargeIn(), [], [], np.inf
        heard = self._mixed(play, others)
        raw = heard
        for start in range(0, count, BLOCK):
            now = self._now + start / RATE
            block = np.asarray(play[start : start + BLOCK] * 32767, np.int16)
            self._played.add(block, RATE, now)
            now += BLOCK / RATE
            cleaned.append(self._canceller.clean(heard[start : start + BLOCK], now))
            if Over.BEGAN in barge_in.feed(cleaned[-1], self._played.sounds(now)):
                if silent == np.inf:
                    silent = (start + BLOCK) / RATE
                play[int((silent + LATENCY) * RATE) :] = 0.0
                heard = self._mixed(play, others)
            nobody.append(barge_in.nobody)
        self._now += count / RATE
        return Scene(raw, np.concatenate(cleaned), np.repeat(nobody, BLOCK), silent)

    def alone(self, person: Signal) -> Samples:
        """The person, where the robot says nothing."""
        count = len(person) + RATE
        return self._mixed(np.zeros(count, np.float32), self._person(person, 0.0, count))

    def _person(self, person: Signal, at: float, count: int) -> Signal:
        """With the corridor."""
        others = scenes.corridor(count / RATE + 0.1, np.random.default_rng(1))[:count]
        others *= np.float32(LEVEL * 10 ** (-CORRIDOR / 20) / scenes.level(others))
        if len(person):
            said = _through(person, self._to_person)
            said *= np.float32(LEVEL / scenes.level(said))
            first = int(at * RATE)
            others[first : first + len(said)] += said[: count - first]
        return others

    def _mixed(self, play: Signal, others: Signal) -> Samples:
        distorted = np.tanh(2 * play) * np.float32(0.5)  # a small loudspeaker
        echo = _through(distorted, self._to_robot)[: len(play)]
        if play.any():
            if self._gain is None:
                self._gain = self._loudness / scenes.level(echo)
            echo = echo * np.float32(self._gain)
        return scenes.audio(echo + others).samples


def _through(sound: Signal, room: Signal) -> Signal:
    from scipy.signal import fftconvolve

    return np.asarray(fftconvolve(sound, room), np.float32)


class Bench:
    """Everything that hears, and what it heard."""

    def __init__(self, seed: int = 1) -> None:
        self._rng = np.random.default_rng(seed)
        self._ear = Ear(Knowledge(load_world(DEFAULT_WORLD)))
        self._said = spoken("en")["commands"]
        neural, robotic = Speaker(voice("en", "piper")), Speaker(voice("en", "espeak"))
        man, woman = Speaker(espeak("en-us", "m3"), 0.95), Speaker(espeak("en-us", "f4"), 1.05)
        self._casts = {"piper": (neural, [man, woman]), "espeak": (robotic, [neural, woman])}

    def run(self) -> Iterator[tuple[str, float, Figures]]:
        """The robot's voice, how much louder it is, and the figures."""
        for name, (robot, people) in self._casts.items():
            for louder in LOUDER:
                figures = Figures()
                for delay in DELAYS:
                    session = Session(self._rng, delay, louder)
                    for text in (*TEXTS, *WITH_ITS_WORDS):
                        listens = delay == DELAYS[1]
                        self._robot_alone(session, text, robot.say(text), figures, listens)
                    for n in range(SPOKEN_OVER):
                        said = self._said[int(self._rng.integers(len(self._said)))]
                        own = robot.say(TEXTS[int(self._rng.integers(len(TEXTS)))])
                        person = people[n % len(people)]
                        self._spoken_over(session, own, said, person.say(said), figures)
                        self._cried(session, own, person.say("Stop!"), figures)
                yield name, louder, figures

    def _robot_alone(
        self, session: Session, text: str, robot: Signal, figures: Figures, listens: bool
    ) -> None:
        scene = session.hear(robot, robot[:0], 0.0)
        figures.minutes += len(robot) / RATE / 60
        figures.interruptions += scene.silent < np.inf
        raw, cleaned = self._words(scene)
        figures.woken["raw"] += sum(each.word not in text.lower() for each in raw)
        figures.woken["cleaned"] += len(cleaned)
        if listens:
            for way, sound in (("raw", scene.raw), ("cleaned", scene.cleaned)):
                figures.commands[way] += self._commands(sound)

    def _words(self, scene: Scene) -> tuple[list[Detection], list[Detection]]:
        """Hot words and stops, in the raw sound and those believed in the cleaned one."""
        last = len(scene.nobody) - 1
        cleaned = _spotted(scene.cleaned)
        believed = [at for at in cleaned if not scene.nobody[min(last, int(at.time * RATE))]]
        return _spotted(scene.raw), believed

    def _cried(self, session: Session, robot: Signal, person: Signal, figures: Figures) -> None:
        at = float(self._rng.uniform(1.0, 2.0))
        raw, cleaned = self._words(session.hear(robot, person, at))
        figures.cries += 1
        for way, found in (("raw", raw), ("cleaned", cleaned)):
            figures.obeyed[way] += any(each.word == "stop" and each.time > at for each in found)

    def _commands(self, sound: Samples) -> int:
        """How often something is heard that would be acted on, if it listened."""
        listener = self._ear.listener()
        events = [*listener.feed(sound), *listener.finish()]
        heard = [event.heard for event in events if isinstance(event, SpeechEnded)]
        chosen = [self._ear.understood(each) for each in heard if each is not None]
        return sum(
            bool(each.text) and not each.doubtful and self._ear.program(each.text) is not None
            for each in chosen
        )

    def _spoken_over(
        self, session: Session, robot: Signal, said: str, person: Signal, figures: Figures
    ) -> None:
        at = float(self._rng.uniform(1.0, 2.0))
        scene = session.hear(robot, person, at)
        figures.spoken_over += 1
        if at + QUIET < scene.silent < np.inf:
            figures.delays.append(scene.silent - at - QUIET)
        figures.interruptions += scene.silent <= at + QUIET
        first, last = int(at * RATE), int(at * RATE) + len(person) + RATE // 2
        for way, sound in (
            ("alone", session.alone(person)),
            ("raw", scene.raw[first:last]),
            ("cleaned", scene.cleaned[first:last]),
        ):
            figures.words[way].append(share(said, self._ear.hear(Audio(sound)).text))


def _spotted(sound: Samples) -> list[Detection]:
    detectors: tuple[Detector, ...] = (HotWord("en"), StopWord("en"))
    return [found for detector in detectors for found in detector.feed(sound)]


def share(said: str, heard: str) -> float:
    """Of the words that were said, in their order."""
    words = said.lower().replace(",", "").split()
    blocks = SequenceMatcher(None, words, heard.lower().split(), False).get_matching_blocks()
    return sum(block.size for block in blocks) / len(words)


COLUMNS: Final = (
    "robot's voice, louder by",
    "interrupts itself",
    "woken or stopped by itself, before / now",
    "commands made of its words, before / now",
    '"stop" cried over it is obeyed, before / now',
    "noticed when spoken over",
    "after (median)",
    "words understood: person alone / before / now",
)


def _row(voice_name: str, louder: float, of: Figures) -> str:
    words = " / ".join(f"{100 * statistics.mean(of.words[way]):.0f} %" for way in of.words)
    obeyed, spoken_over = of.obeyed, f"{len(of.delays)} of {of.spoken_over}"
    cells = (
        f"{voice_name}, {louder:g} dB",
        f"{of.interruptions} in {of.minutes:.1f} min",
        f"{of.woken['raw']} / {of.woken['cleaned']}",
        f"{of.commands['raw']} / {of.commands['cleaned']}",
        f"{obeyed['raw']} / {obeyed['cleaned']} of {of.cries}",
        spoken_over,
        f"{statistics.median(of.delays):.2f} s" if of.delays else "-",
        words,
    )
    return f"| {' | '.join(cells)} |"


def main() -> None:
    print(f"| {' | '.join(COLUMNS)} |")
    print("|---" * len(COLUMNS) + "|")
    for voice_name, louder, figures in Bench().run():
        print(_row(voice_name, louder, figures), flush=True)


if __name__ == "__main__":
    main()
