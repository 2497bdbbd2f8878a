"""What a benchmark of hearing plays: sentences in several voices, in quiet and in noisy rooms.

    stage = Stage("en", seed=1)
    for trial in stage.trials("remark", ["the soup was cold"]): ...

Everything is synthesised here and the same for the same seed, except that a neural voice never
says a sentence quite the same way twice.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

import numpy as np
import yaml

from nl2robot.bench import kokoro
from nl2robot.paths import PACKAGED
from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, Audio, from_float
from nl2robot.speech.scenes import Signal
from nl2robot.speech.speak.voices import Voice, espeak, joined, voices

NOISES: Final = ("babble", "corridor")
LEVELS: Final = (20.0, 10.0, 5.0, 0.0)
"""Decibels by which the speech is louder than the noise."""
_VARIANTS: Final = {
    "en": (("en-us", "m3"), ("en-029", "f2"), ("en-us", "f4"), ("en-gb-scotland", "m1")),
    "fr": (("fr", "m3"), ("fr", "f2"), ("fr-be", "f4"), ("fr-ch", "m1")),
    "de": (("de", "m3"), ("de", "f2"), ("de", "f4"), ("de", "m1")),
}
"""Of espeak-ng: men and women, by language."""
_PACE: Final = ((0.95, 1.0), (0.85, 1.1), (1.05, 0.9), (0.9, 1.2))
"""Speed and pitch of each of these."""
_NEURAL_PACE: Final = (1.0, 0.88, 1.12)
"""Speeds of a neural voice, each counted as a voice of its own."""
_KOKORO: Final = {
    "en": ("af_bella", "am_adam", "bf_emma", "bm_george", "am_eric", "hf_beta", "zm_yunjian"),
    "fr": ("ff_siwis",),
}
"""Its speakers, by language: of French there is one. It speaks no German that Germans would."""
_DIALECT: Final = {"a": "en-us", "b": "en-gb-x-rp", "h": "en-us", "z": "en-us", "f": "fr"}
"""What each speaks, by where they are from."""
_SCENE: Final = 40.0  # seconds of each noise
_QUIET: Final = 0.25  # seconds before and after what is said


@dataclass(frozen=True)
class Speaker:
    """A voice at a speed and a pitch."""

    voice: Voice
    speed: float = 1.0
    pitch: float = 1.0

    @property
    def name(self) -> str:
        return self.voice.name if self.speed == 1 else f"{self.voice.name} x{self.speed:g}"

    def say(self, text: str) -> Signal:
        """With a quarter of a second of quiet around it; of a peak of 0.5."""
        sound = joined(self.voice.speak(text, speed=self.speed, pitch=self.pitch))
        frames = (sound.samples / 32768).astype(np.float32).reshape(-1, 1)
        said = scenes.signal(from_float(frames, sound.rate))
        peak = max(float(np.abs(said).max()), 1e-6) if len(said) else 1.0
        quiet = np.zeros(int(_QUIET * RATE), np.float32)
        return np.concatenate([quiet, said * np.float32(0.5 / peak), quiet])


@dataclass(frozen=True, eq=False)
class Trial:
    """One thing to be heard."""

    kind: str
    said: str  # empty where nobody speaks
    speaker: str
    noise: str  # one of `NOISES`, or empty for a quiet room
    decibels: float | None
    audio: Audio

    @property
    def condition(self) -> str:
        return "quiet" if self.decibels is None else f"{self.decibels:g} dB"


class Stage:
    """The speakers and the noises of one language."""

    def __init__(self, language: str, seed: int = 1) -> None:
        """Raises VoiceError where nothing can be spoken."""
        self._language = language
        self._rng = np.random.default_rng(seed)
        self.speakers = _speakers(language)
        sayings = spoken(language)["remarks"]
        crowd = [
            speaker.say(text)
            for speaker, text in zip(
                self.speakers * len(sayings), sayings[: 2 * len(self.speakers)], strict=False
            )
        ]
        self._noises = {
            "babble": scenes.babble(crowd, _SCENE, self._rng),
            "corridor": scenes.corridor(_SCENE, self._rng),
        }
        self._said: dict[tuple[str, str], Signal] = {}

    def trials(self, kind: str, sayings: Sequence[str], most: int | None = None) -> Iterator[Trial]:
        """Each saying once in a quiet room and once at each level, the speakers and the noises in
        turn; `most`: that many of them, chosen by chance."""
        conditions = [None, *LEVELS]
        all_of_them = [
            (text, decibels, n) for n, text in enumerate(sayings) for decibels in conditions
        ]
        if most is not None and most < len(all_of_them):
            picked = self._rng.permutation(len(all_of_them))[:most]
            all_of_them = [all_of_them[i] for i in sorted(picked)]
        for text, decibels, n in all_of_them:
            speaker = self.speakers[n % len(self.speakers)]
            noise = NOISES[(n // len(self.speakers)) % len(NOISES)] if decibels is not None else ""
            yield self.trial(kind, text, speaker, noise, decibels)

    def trial(
        self, kind: str, text: str, speaker: Speaker, noise: str, decibels: float | None
    ) -> Trial:
        key = (speaker.name, text)
        if key not in self._said:
            self._said[key] = speaker.say(text)
        sound = self._said[key]
        if decibels is not None:
            # A quiet room echoes little; where many people are, it echoes.
            room = scenes.echo(self._rng, seconds=float(self._rng.uniform(0.3, 0.7)))
            echoed = scenes.echoing(sound, room)[: len(sound) + RATE // 4]
            sound = scenes.at_snr(echoed, self._noises[noise], decibels, self._rng)
        return Trial(kind, text, speaker.name, noise, decibels, scenes.audio(sound))

    def nobody(self, count: int, seconds: float = 4.0) -> Iterator[Trial]:
        """Noise in which nobody speaks to the robot: babble, corridor, music in turn."""
        for n in range(count):
            noise = (*NOISES, "music")[n % 3]
            if noise == "music":
                sound = scenes.music(seconds, self._rng)
            else:
                length = int(seconds * RATE)
                start = int(self._rng.integers(0, len(self._noises[noise]) - length))
                sound = self._noises[noise][start : start + length]
            sound = sound * np.float32(self._rng.uniform(0.1, 0.6))
            yield Trial("nobody", "", "", noise, 0.0, scenes.audio(sound))


def spoken(language: str) -> dict[str, list[str]]:
    """What is said in a language, by kind: data/spoken.yaml; empty for other languages."""
    said: dict[str, list[str]] = _data().get(language, {})
    return said


@cache
def _data() -> dict[str, Any]:
    path = PACKAGED / "spoken.yaml"
    data: dict[str, Any] = yaml.safe_load(path.read_text("utf-8"))
    return data


def _speakers(language: str) -> list[Speaker]:
    piper = [voice for voice in voices(language) if voice.name.startswith("piper")]
    neural = [Speaker(voice, pace) for voice in piper for pace in _NEURAL_PACE]
    if kokoro.speakers():
        neural += [
            Speaker(kokoro.Kokoro(name, _DIALECT[name[0]])) for name in _KOKORO.get(language, ())
        ]
    robotic = [
        Speaker(espeak(dialect, variant), speed, pitch)
        for (dialect, variant), (speed, pitch) in zip(
            _VARIANTS.get(language, ((language, ""),)), _PACE, strict=False
        )
    ]
    return neural + robotic
