"""What was said: a recording and what may be said -> words, and whether to believe them.

A recogniser that may hear anything mishears what is rare elsewhere and common here; one that knows
the phrases of the grammar and the world hears those, but it hears nothing else: whatever is said
comes back as such phrases. So the same sound is decoded both ways, side by side. Both give a score
for how well their words fit the sound, and so

- where free words fit much better and are other words, the result is marked `doubtful`;
- all readings of both are kept, the best fitting first, for the grammar to choose from (`choose`).

The figures in docs/voice.md were measured with the constants in this file.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import vosk

from nl2robot.errors import UserError
from nl2robot.models import ModelError, need
from nl2robot.speech.audio import RATE, Audio, Samples
from nl2robot.speech.vocabulary import spell_numbers

vosk.SetLogLevel(-1)  # its C++ log goes to standard error

# Before and after the speech, silence: without it the model loses the first and last sounds.
PADDING = 0.3  # seconds
LOUDNESS = 0.6  # the peak that a recording is brought to; the model was trained on full ones
MOST_GAIN = 30.0
# Below this loudest moment (root mean square of 30 ms, 1 = full scale) there is nothing to hear.
SILENCE = 0.001
BLOCK = RATE // 4  # samples handed over at a time
PUNCTUATION = '-–.,;:!?…"“”„«»()'

# The second opinion: when a text is believed that free decoding does not agree with.
ALIKE = 0.9  # texts this similar are the same words
WORST_FIT = -0.05  # how much of its score a text may be behind free decoding
READINGS = 10  # of each decoder


class SpeechError(UserError):
    """Nothing can be heard as things are."""


@dataclass(frozen=True)
class Word:
    """One word that was heard; times in seconds from the start of the recording."""

    text: str
    start: float
    end: float
    confidence: float  # 0..1


@dataclass(frozen=True)
class Reading:
    """One way to read a sound."""

    text: str
    # How well it fits the sound: the share of its score by which it is ahead of the best free
    # reading (0). A worse fit than about -0.05 is hardly ever what was said.
    fit: float
    doubtful: bool


@dataclass(frozen=True)
class Heard:
    """What a recording says."""

    text: str  # empty for silence
    confidence: float  # 0..1, mean over the words; 0 when nothing was heard that may be said
    words: tuple[Word, ...]
    # With a limited vocabulary: something else was probably said, and `free_text` is what it
    # sounds like when anything may be said. Then ask again rather than act.
    doubtful: bool
    free_text: str | None
    readings: tuple[Reading, ...]  # of a limited vocabulary and freely, the best fitting first
    seconds_of_audio: float
    seconds_taken: float


def choose(heard: Heard, understood: Callable[[str], bool]) -> Heard:
    """What was heard, with the text that makes sense: the best of its readings, if any, that is
    not doubtful and is `understood`. Where none is, a doubtful text gives way to the free one: that
    is what to show the speaker. Of another text than the first, the times of words are not known.
    """
    makes_sense = understood(heard.text)
    if makes_sense and not heard.doubtful:
        return heard
    for reading in heard.readings:
        if not reading.doubtful and reading.text != heard.text and understood(reading.text):
            return replace(
                heard,
                text=reading.text,
                confidence=max(0.0, min(1.0, 1 + reading.fit)),
                words=(),
                doubtful=False,
            )
    if heard.doubtful and heard.free_text and not makes_sense:
        return replace(heard, text=heard.free_text, confidence=0.0, words=())
    return heard


@dataclass(frozen=True)
class _Grammar:
    """What may be said, for vosk."""

    json: str
    as_written: dict[str, str]  # words of the model that people write otherwise

    def written(self, text: str) -> str:
        return " ".join(self.as_written.get(word, word) for word in text.split())


@dataclass(frozen=True)
class _Scored:
    text: str
    score: float  # log likelihood of sound and words together; only differences mean anything


class Recogniser:
    """A loaded speech model. May be used from several threads at once."""

    def __init__(self, model: Path, language: str) -> None:
        """`model` is the folder of a vosk model. Raises ModelError if it cannot be used."""
        self.language = language
        self._unusable = ModelError(
            f"The speech model in {model} cannot be used. "
            f"Run `nl2robot models get {language} --again` to fetch it again."
        )
        try:
            self._model = vosk.Model(str(model))
        except Exception as error:  # vosk raises nothing more precise
            raise self._unusable from error

    def knows(self, word: str) -> bool:
        """Whether the model can hear this word at all."""
        return bool(self._model.vosk_model_find_word(word) >= 0)

    def spelling(self, word: str) -> tuple[str, ...] | None:
        """The words of the model that stand for `word` as people write it; None if there are none.

        "Pharmacy" is pharmacy, "x-ray" may be xray, or x and ray, "12" is twelve.
        """
        word = spell_numbers(word.lower().replace("’", "'"), self.language).strip(PUNCTUATION)
        together = word.replace("-", "").split()
        apart = word.replace("-", " ").replace("'", "' ").split()
        for spelling in (word.split(), together, apart):
            if spelling and all(map(self.knows, spelling)):
                return tuple(spelling)
        return None

    def unknown_words(self, phrases: Iterable[str]) -> list[str]:
        """The words among these phrases that the model can never hear, sorted, as written."""
        words = {word for phrase in phrases for word in phrase.split()}
        return sorted(word for word in words if word.strip(PUNCTUATION) and not self.spelling(word))

    def recognise(
        self,
        audio: Audio,
        phrases: Sequence[str] | None = None,
        *,
        worst_fit: float = WORST_FIT,
    ) -> Heard:
        """What is said in `audio`.

        `phrases` is what may be said: single words, names, and, better, whole sample sentences, for
        the recogniser learns from them which word follows which. Words the model does not know are
        left out (`unknown_words` tells which). None: anything may be said, and nothing is doubtful.
        `worst_fit` is by how much of its score free decoding may fit better before it is believed.
        Raises SpeechError if the model knows none of the words.
        """
        started = time.perf_counter()
        heard = self._recognise(audio, phrases, worst_fit)
        return replace(heard, seconds_taken=time.perf_counter() - started)

    def _recognise(self, audio: Audio, phrases: Sequence[str] | None, worst_fit: float) -> Heard:
        if _is_silent(audio.samples):
            return _heard((), audio)
        sound = _prepared(audio.samples)
        if phrases is None:
            return _heard(self._words(sound, None), audio)
        grammar = self._grammar(phrases)
        # The decoders run side by side: libvosk does not hold the interpreter's lock.
        with ThreadPoolExecutor(1, "second opinion") as pool:
            freely = pool.submit(self._scored, sound, None)
            words = self._words(sound, grammar)
            limited = self._scored(sound, grammar)
            free = freely.result()
        return replace(
            _heard(words, audio),
            doubtful=_reading(limited[0], free[0], worst_fit).doubtful,
            free_text=free[0].text,
            readings=_readings(limited, free, worst_fit),
        )

    def _grammar(self, phrases: Sequence[str]) -> _Grammar:
        spoken: dict[str, None] = {}  # an ordered set
        as_written: dict[str, str] = {}
        spellings: dict[str, tuple[str, ...] | None] = {}
        for phrase in phrases:
            run: list[str] = []
            for word in filter(lambda word: word.strip(PUNCTUATION), phrase.split()):
                if word not in spellings:
                    spellings[word] = self.spelling(word)
                spelling = spellings[word]
                if spelling is None:  # what stands around it still belongs together
                    spoken[" ".join(run)] = None
                    run = []
                    continue
                run += spelling
                if len(spelling) == 1 and "-" in word:
                    as_written.setdefault(spelling[0], word.lower())
            spoken[" ".join(run)] = None
        spoken.pop("", None)
        if not spoken:  # libvosk would crash
            raise SpeechError(
                "The speech model knows none of the words that may be said here. "
                "Use other words, or another language."
            )
        return _Grammar(json.dumps(list(spoken), ensure_ascii=False), as_written)

    def _words(self, sound: bytes, grammar: _Grammar | None) -> tuple[Word, ...]:
        """The words with their times and confidences."""
        return tuple(
            Word(
                grammar.written(word["word"]) if grammar else word["word"],
                max(0.0, word["start"] - PADDING),
                max(0.0, word["end"] - PADDING),
                word["conf"],
            )
            for result in self._run(sound, grammar, alternatives=0)
            for word in result.get("result", ())
        )

    def _scored(self, sound: bytes, grammar: _Grammar | None) -> list[_Scored]:
        """The likeliest texts with their scores, at least one; vosk gives scores or confidences."""
        texts = [_Scored("", 0.0)]
        for result in self._run(sound, grammar, alternatives=READINGS):
            # A pause divides the speech: every text so far goes on in each of these ways.
            texts = [
                _Scored(f"{text.text} {way['text']}".strip(), text.score + way["confidence"])
                for text in texts
                for way in result.get("alternatives") or [{"text": "", "confidence": 0.0}]
            ]
            texts = sorted(texts, key=lambda text: -text.score)[:READINGS]
        return [_Scored(grammar.written(t.text), t.score) for t in texts] if grammar else texts

    def _run(
        self, sound: bytes, grammar: _Grammar | None, alternatives: int
    ) -> list[dict[str, Any]]:
        limits = () if grammar is None else (grammar.json,)
        try:
            kaldi = vosk.KaldiRecognizer(self._model, RATE, *limits)
        except Exception as error:
            raise self._unusable from error
        kaldi.SetWords(True)
        kaldi.SetMaxAlternatives(alternatives)
        results = []
        for start in range(0, len(sound), BLOCK * 2):
            # After a pause in the speech a result is complete, and the next begins.
            if kaldi.AcceptWaveform(sound[start : start + BLOCK * 2]):
                results.append(json.loads(kaldi.Result()))
        results.append(json.loads(kaldi.FinalResult()))
        return results


@lru_cache(maxsize=3)
def load(code: str) -> Recogniser:
    """The recogniser of an installed language, loaded once. Raises ModelError if not installed."""
    return Recogniser(need(code), code)


def _prepared(samples: Samples) -> bytes:
    """As loud as the model is used to, with silence around it; never an odd or empty buffer."""
    scaled = samples.astype(np.float32)
    peak = max(1.0, float(np.abs(scaled).max()))
    gain = min(MOST_GAIN, LOUDNESS * 32767 / peak)
    padding = np.zeros(int(PADDING * RATE), np.int16)
    return np.concatenate([padding, (scaled * gain).astype(np.int16), padding]).tobytes()


def _is_silent(samples: Samples) -> bool:
    frame = RATE * 30 // 1000
    whole = len(samples) // frame * frame
    if whole == 0:
        return True  # shorter than any sound of speech
    frames = samples[:whole].reshape(-1, frame).astype(np.float32) / 32768
    return float(np.sqrt(np.square(frames).mean(axis=1)).max()) < SILENCE


def _heard(words: tuple[Word, ...], audio: Audio) -> Heard:
    return Heard(
        text=" ".join(word.text for word in words),
        confidence=sum(word.confidence for word in words) / len(words) if words else 0.0,
        words=words,
        doubtful=False,
        free_text=None,
        readings=(),
        seconds_of_audio=audio.seconds,
        seconds_taken=0.0,
    )


def _readings(
    limited: Sequence[_Scored], free: Sequence[_Scored], worst_fit: float
) -> tuple[Reading, ...]:
    best: dict[str, Reading] = {}
    for text in (*limited, *free):
        reading = _reading(text, free[0], worst_fit)
        if text.text and (text.text not in best or reading.fit > best[text.text].fit):
            best[text.text] = reading
    return tuple(sorted(best.values(), key=lambda reading: -reading.fit))


def _reading(text: _Scored, free: _Scored, worst_fit: float) -> Reading:
    from rapidfuzz import fuzz

    fit = (text.score - free.score) / max(1.0, abs(free.score))
    # Without blanks, for "good bye" and "goodbye" are the same.
    alike = fuzz.ratio(text.text.replace(" ", ""), free.text.replace(" ", "")) / 100 >= ALIKE
    return Reading(text.text, fit, doubtful=fit < worst_fit and not alike)
