"""The second ear: a neural recogniser that judges whole utterances, beside the one that hears them
word by word.

    ear = second_ear("en")
    opinion = ear.hear(samples, phrases, candidates=["go to the pharmacy"])
    opinion.readings[0].text, opinion.readings[0].evidence.belief, opinion.free

It says how likely any words are, given the sound, so it also judges what others have heard. Which
of that is to be believed is told by four things: how likely the words are by the sound alone, how
long they are, how likely they are to be said here at all, and whether the other recogniser heard
the same (`nl2robot.bench.belief` compares this with other ways, and fits the weights).
"""

from __future__ import annotations

import re
import threading
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache, lru_cache
from math import exp
from operator import mul
from typing import Final

import numpy as np

from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.hear import moonshine, whisper
from nl2robot.speech.hear.expectation import Expectation
from nl2robot.speech.hear.levels import gain_for
from nl2robot.speech.hear.search import Network, Sound
from nl2robot.speech.hear.vocabulary import spell_numbers

CANDIDATES: Final = 6  # of its own that are judged
PADDING: Final = 0.15  # seconds; of digits 196 of 200 were heard with 0.15 and 0.3, 179 with none
CAPITALS: Final = ("de",)
"""Languages that write nouns with capitals: what the robot is to say is shown so."""
_LISTS: Final = 16  # of phrases whose expectation is kept
_PERCENT: Final = {"en": " percent", "de": " Prozent", "fr": " pour cent"}
_QUOTES_AND_END: Final = re.compile(r'["“”„«»…]|[.,?!;:\s]+$')


@dataclass(frozen=True)
class Evidence:
    """What speaks for a text."""

    unlikely: float  # minus log likelihood of the text given the sound
    subwords: int
    unexpected: float  # minus log probability of a subword of it, on average, before any sound
    agreed: bool  # the other recogniser heard it as well

    @property
    def belief(self) -> float:
        """The probability (0..1) that this was said, if it makes sense."""
        return 1 / (1 + exp(min(_LEAST_ODDS, -sum(map(mul, WEIGHTS, self.row)))))

    @property
    def row(self) -> tuple[float, ...]:
        """As `WEIGHTS` counts it."""
        return 1.0, self.unlikely, self.subwords, self.unexpected, self.agreed


WEIGHTS: Final = (3.36, -0.378, 0.144, -0.553, 3.49)
"""Of a logistic regression, fitted in the way of `nl2robot.bench.belief` to English trials of
seeds 1 and 2; on trials of seed 5 they do no worse than weights fitted to these, and they hold for
Whisper as well (docs/voice.md)."""
_LEAST_ODDS: Final = 700.0  # their logarithm against; more would be too much for a float


@dataclass(frozen=True)
class Judged:
    """A text, as the other recogniser would write it."""

    text: str
    likelihood: float  # log, of the text given the sound
    evidence: Evidence
    written: str = ""  # the same with the capitals that the language wants, if it wants any


@dataclass(frozen=True)
class Opinion:
    """What the second ear makes of a sound."""

    free: str  # where anything may be said; empty for none
    readings: tuple[Judged, ...]  # the best first


class SecondEar:
    """May be used from several threads at once."""

    def __init__(self, model: Network, language: str = "en") -> None:
        self._model = model
        self._language = language
        self._nouns = language in CAPITALS
        self._expected = lru_cache(maxsize=_LISTS)(self._expected_of)
        self._lock = threading.Lock()

    def hear(
        self, samples: Samples, phrases: Sequence[str], candidates: Iterable[str] = ()
    ) -> Opinion:
        """`phrases` are what may be said, `candidates` what others heard, the likeliest first; they
        are asked for last, so that an iterator may wait for them."""
        expected = self.expect(phrases)
        sound = self._listened(samples)
        with ThreadPoolExecutor(1) as beside:  # on another core, if there is one
            freely = beside.submit(sound.texts, width=1)
            own = sound.texts(expected.sentences)[:CANDIDATES]
            free = freely.result()[0]
        likelihoods = {text.text: text.likelihood for text in [free, *own] if text.text}
        others = [expected.words.written(text) for text in candidates]
        agreed = {self._plain(text, expected.words) for text in others}
        likelihoods |= zip(others, sound.likelihoods(others), strict=True)
        judged: dict[str, Judged] = {}
        for text, likelihood in likelihoods.items():
            plain = self._plain(text, expected.words)
            numbers = self._model.subwords.of(text)
            evidence = Evidence(
                unlikely=-likelihood,
                subwords=len(numbers) + 1,
                unexpected=-expected.sentences.of(numbers) / (len(numbers) + 1),
                agreed=plain in agreed,
            )
            written = self._plain(text, expected.words, lower=False) if self._nouns else ""
            each = Judged(plain, likelihood, evidence, written)
            if plain and (plain not in judged or evidence.belief > judged[plain].evidence.belief):
                judged[plain] = each
        best = sorted(judged.values(), key=lambda each: -each.evidence.belief)
        return Opinion(self._plain(free.text, expected.words), tuple(best))

    def expect(self, phrases: Sequence[str]) -> _Expected:
        """Makes ready to hear these phrases, which takes up to half a second the first time."""
        with self._lock:
            return self._expected(tuple(phrases))

    def free(self, samples: Samples) -> str:
        """What is said where anything may be said; empty for nothing."""
        return self._plain(self._listened(samples).texts()[0].text, _Words(()))

    def quickly(self, samples: Samples) -> str:
        """The same in a third of the time, and not quite as well."""
        return self._plain(self._listened(samples).texts(width=1)[0].text, _Words(()))

    def _listened(self, samples: Samples) -> Sound:
        """As loud as the model is used to, with a little silence around it."""
        loud = np.clip(samples * np.float32(gain_for(samples)), -32768, 32767).astype(np.int16)
        return self._model.listen(np.pad(loud, int(PADDING * RATE)))

    def _expected_of(self, phrases: tuple[str, ...]) -> _Expected:
        words = _Words(phrases)
        sentences = [f"{words.written(phrase)}{end}" for phrase in phrases for end in ".?"]
        return _Expected(words, self._model.expectation(sentences))

    def _plain(self, text: str, words: _Words, *, lower: bool = True) -> str:
        """As the other recogniser writes, but for the commas: they divide orders."""
        text = text.lower() if lower else text
        plain = words.joined(_QUOTES_AND_END.sub("", text).replace("%", _PERCENT[self._language]))
        return " ".join(spell_numbers(plain, self._language).split())


@dataclass(frozen=True)
class _Expected:
    """What is likely to be said where some phrases may be said."""

    words: _Words
    sentences: Expectation


def second_ear(language: str) -> SecondEar | None:
    """The one of this language, loaded once; None if none is installed."""
    model = moonshine.load(language) or whisper.load(language)
    return _ear(model, language) if model else None


@cache
def _ear(model: Network, language: str) -> SecondEar:
    return SecondEar(model, language)


class _Words:
    """How the words of some phrases are written."""

    def __init__(self, phrases: Iterable[str]) -> None:
        apart = [phrase.split() for phrase in phrases]
        names = (word for words in apart for word in words[1:] if word[:1].isupper())
        self._names = {word.lower(): word for word in names}
        """Words that begin with a capital letter wherever they stand."""
        self._joined = {word.lower() for words in apart for word in words if "-" in word}

    def written(self, text: str) -> str:
        """As people write a sentence, without its end."""
        sentence = " ".join(self._names.get(word, word) for word in text.split())
        return sentence[:1].upper() + sentence[1:]

    def joined(self, text: str) -> str:
        """With hyphens only in words that have them here."""
        return " ".join(
            word if word.lower() in self._joined else word.replace("-", " ")
            for word in text.split()
        )
