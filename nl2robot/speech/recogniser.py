"""What was said: a recording and what may be said -> words, and whether to believe them.

A recogniser that may hear anything gets one command in three right word for word; one that knows
the phrases of the grammar and the world gets most of them right. But then everything it hears, it
hears as such phrases. So the same sound is also decoded freely, side by side, and compared: where
free words fit the sound much better and are other words, the result is marked `doubtful`.

The figures in docs/voice.md were measured with the constants in this file.
"""

from __future__ import annotations

import json
import time
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import vosk

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

# The second opinion. Of right commands 1 in 100 is doubted, of chatter 1 in 25 is not.
ALIKE = 0.9  # free and limited texts this similar are the same words
WORST_FIT = -0.05


@dataclass(frozen=True)
class Word:
    """One word that was heard; times in seconds from the start of the recording."""

    text: str
    start: float
    end: float
    confidence: float  # 0..1


@dataclass(frozen=True)
class Heard:
    """What a recording says."""

    text: str  # empty for silence
    confidence: float  # 0..1, mean over the words; 0 when nothing was heard
    words: tuple[Word, ...]
    # With a limited vocabulary: something else was probably said, and `free_text` is what it
    # sounds like when anything may be said. Then ask again rather than act.
    doubtful: bool
    free_text: str | None
    seconds_of_audio: float
    seconds_taken: float


@dataclass(frozen=True)
class _Decoded:
    words: tuple[Word, ...]
    score: float = 0.0  # log likelihood of sound and words together; only differences mean anything

    @property
    def text(self) -> str:
        return " ".join(word.text for word in self.words)


class Recogniser:
    """A loaded speech model. May be used from several threads at once."""

    def __init__(self, model: Path, language: str) -> None:
        """`model` is the folder of a vosk model. Raises ModelError if it cannot be used."""
        try:
            self._model = vosk.Model(str(model))
        except Exception as error:  # vosk raises nothing more precise
            raise ModelError(
                f"The speech model in {model} cannot be used. "
                f"Run `nl2robot models get {language} --again` to fetch it again."
            ) from error
        self.language = language

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
        """
        started = time.perf_counter()
        heard = self._recognise(audio, phrases, worst_fit)
        return replace(heard, seconds_taken=time.perf_counter() - started)

    def _recognise(self, audio: Audio, phrases: Sequence[str] | None, worst_fit: float) -> Heard:
        if _is_silent(audio.samples):
            return _heard((), audio)
        sound = _prepared(audio.samples)
        if phrases is None:
            return _heard(self._decode(sound, None).words, audio)
        grammar, as_written = self._grammar(phrases)
        # The decoders run side by side: libvosk does not hold the interpreter's lock.
        with ThreadPoolExecutor(1, "second opinion") as pool:
            freely = pool.submit(self._score, sound, None)
            limited = self._decode(sound, grammar)
            scored = self._score(sound, grammar)
            free = freely.result()
        return replace(
            _heard(tuple(_written(word, as_written) for word in limited.words), audio),
            doubtful=not _alike(limited.text, free.text) and _fit(scored, free) < worst_fit,
            free_text=free.text,
        )

    def _grammar(self, phrases: Sequence[str]) -> tuple[str, dict[str, str]]:
        """vosk's JSON for these phrases; and model words that people write otherwise."""
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
        return json.dumps(list(spoken), ensure_ascii=False), as_written

    def _decode(self, sound: bytes, grammar: str | None) -> _Decoded:
        """The words with their times and confidences."""
        results = self._run(sound, grammar, alternatives=0)
        return _Decoded(
            tuple(
                Word(
                    word["word"],
                    max(0.0, word["start"] - PADDING),
                    max(0.0, word["end"] - PADDING),
                    word["conf"],
                )
                for result in results
                for word in result.get("result", ())
            )
        )

    def _score(self, sound: bytes, grammar: str | None) -> _Decoded:
        """The words with their score; vosk gives either scores or confidences."""
        best = [
            result["alternatives"][0]
            for result in self._run(sound, grammar, alternatives=1)
            if result.get("alternatives")
        ]
        words = tuple(
            Word(word["word"], word["start"], word["end"], 0.0)
            for alternative in best
            for word in alternative.get("result", ())
        )
        return _Decoded(words, sum(alternative["confidence"] for alternative in best))

    def _run(self, sound: bytes, grammar: str | None, alternatives: int) -> list[dict[str, Any]]:
        arguments = (self._model, RATE) if grammar is None else (self._model, RATE, grammar)
        kaldi = vosk.KaldiRecognizer(*arguments)
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
        text=_Decoded(words).text,
        confidence=sum(word.confidence for word in words) / len(words) if words else 0.0,
        words=words,
        doubtful=False,
        free_text=None,
        seconds_of_audio=audio.seconds,
        seconds_taken=0.0,
    )


def _written(word: Word, as_written: dict[str, str]) -> Word:
    return replace(word, text=as_written.get(word.text, word.text))


def _alike(limited: str, free: str) -> bool:
    from rapidfuzz import fuzz

    # Without blanks, for "good bye" and "goodbye" are the same.
    return fuzz.ratio(limited.replace(" ", ""), free.replace(" ", "")) / 100 >= ALIKE


def _fit(limited: _Decoded, free: _Decoded) -> float:
    """How much better the limited words fit the sound than free ones, as a share of the score."""
    return (limited.score - free.score) / max(1.0, abs(free.score))
