"""Any word as a hot word, without training: by the speech model of its language, in two stages.

1. While somebody speaks (a voice detector tells), a decoder that knows the word and some everyday
   words runs along. It is cheap, and hears the word in much that sounds a bit like it.
2. Where it does, the last two seconds are decoded once more, by the recogniser with its second
   opinion: where free words fit the sound better than the word does, it was not said.
"""

from __future__ import annotations

import json
from collections import deque
from typing import Any, Final

import numpy as np

from nl2robot.errors import UserError
from nl2robot.speech.audio import RATE, Audio, Samples
from nl2robot.speech.hear.listening import FRAME as CHUNK
from nl2robot.speech.hear.listening import voice_detector
from nl2robot.speech.hear.recogniser import PUNCTUATION, Recogniser
from nl2robot.speech.hotword.detection import HELD, Detection
from nl2robot.speech.hotword.words import WORDS

SPEAKS: Final = 0.35  # probability of speech above which somebody speaks
FEW: Final = 6  # each so many-th of the everyday words is known to the first stage
LEAD: Final = 0.5  # seconds before the speech that are decoded too
HANGOVER: Final = 0.6  # seconds of quiet after which it has ended
EVERY: Final = 4  # chunks, between two looks at what was heard: 0.13 s
LONGEST: Final = 8.0  # seconds after which the first decoder starts afresh, in talk without a pause
BEFORE: Final = 0.15  # seconds before the word's beginning that are decoded again with it
WORST_FIT: Final = -0.03


class Spotter:
    """Hears one word, of a language whose speech model is installed."""

    def __init__(
        self,
        recogniser: Recogniser,
        word: str,
        *,
        worst_fit: float = WORST_FIT,
        second_stage: bool = True,
    ) -> None:
        """`second_stage` is left out only to measure what it is good for.

        Raises UserError for a word with parts that the speech model does not know."""
        self.word, self._recogniser, self._worst_fit = word, recogniser, worst_fit
        self._second_stage = second_stage
        unknown = recogniser.unknown_words([word])
        train = f'--lang {recogniser.language} --word "{word}"'
        if not recogniser.word_by_word:
            raise UserError(
                f"The speech model that is here hears whole utterances, and no hot word in them."
                f" Run `nl2robot models get {recogniser.language}` where there is internet, or"
                f" train the word: python -m nl2robot.training.hotword.training {train}"
            )
        if unknown or not word.strip(PUNCTUATION + " "):
            what = f"the word “{unknown[0]}”" if unknown else "an empty hot word"
            raise UserError(
                f"The speech model does not know {what} and will never hear it. Choose another hot"
                f" word, or train one: python -m nl2robot.training.hotword.training {train}"
            )
        spoken = [each for each in word.split() if each.strip(PUNCTUATION)]
        spelling = [part for each in spoken for part in recogniser.spelling(each) or ()]
        self._spelling, self._spoken = spelling, " ".join(spelling)
        around = [w for w in WORDS[recogniser.language].filler if recogniser.knows(w)]
        self._around = [w for w in around if w not in spelling]
        unknown_sound = ["[unk]"] if recogniser.knows("[unk]") else []
        self._grammar = json.dumps([self._spoken, *spelling, *self._around[::FEW], *unknown_sound])
        self._voice = voice_detector()
        self._samples = np.zeros(0, np.int16)
        self._fed = 0  # samples that were looked at
        self._heard = -HELD
        self._recent: deque[Samples] = deque(maxlen=int(4 * RATE / CHUNK))
        self._decoder: Any = None
        self._end()

    def reset(self) -> None:
        self._samples = np.zeros(0, np.int16)
        self._recent.clear()
        self._voice = voice_detector()
        self._end()

    def _end(self) -> None:
        """Nobody speaks any more."""
        self._decoder, self._quiet, self._chunks, self._found = None, 0.0, 0, 0
        self._began = 0.0

    def feed(self, samples: Samples) -> list[Detection]:
        self._samples = np.concatenate([self._samples, samples])
        found = []
        while len(self._samples) >= CHUNK:
            chunk, self._samples = self._samples[:CHUNK], self._samples[CHUNK:]
            self._fed += CHUNK
            self._recent.append(chunk)
            detection = self._look(chunk)
            if detection:
                found.append(detection)
        return found

    def _look(self, chunk: Samples) -> Detection | None:
        if self._voice(chunk) > SPEAKS:
            self._quiet = 0.0
            if self._decoder is None:
                self._begin()
                return None
        elif self._decoder is None:
            return None
        else:
            self._quiet += CHUNK / RATE
        self._chunks += 1
        ended = self._decoder.AcceptWaveform(chunk.tobytes())  # at a pause, a result is complete
        over = self._quiet > HANGOVER or self._chunks * CHUNK / RATE > LONGEST
        if not (ended or over) and self._chunks % EVERY:
            return None
        if ended or over:
            heard = self._decoder.Result() if ended else self._decoder.FinalResult()
            starts = self._starts(json.loads(heard).get("result", []))
        else:
            starts = self._starts(
                json.loads(self._decoder.PartialResult()).get("partial_result", [])
            )
        new, self._found = len(starts) > self._found, 0 if ended else len(starts)
        began = self._began
        if over:
            self._end()
        time = self._fed / RATE
        if not new or time - self._heard < HELD:
            return None
        return self._checked(began + starts[-1], time)

    def _starts(self, words: list[dict[str, Any]]) -> list[float]:
        """When each saying of the word begins, in seconds from the decoder's beginning."""
        texts = [each["word"] for each in words]
        size = len(self._spelling)
        return [
            float(words[i]["start"])
            for i in range(len(words) - size + 1)
            if texts[i : i + size] == self._spelling
        ]

    def _begin(self) -> None:
        import vosk

        self._decoder = vosk.KaldiRecognizer(self._recogniser._model, RATE, self._grammar)
        self._decoder.SetWords(True)
        self._decoder.SetPartialWords(True)
        before = np.concatenate(list(self._recent)[-int(LEAD * RATE / CHUNK) :])
        self._began = (self._fed - len(before)) / RATE
        self._decoder.AcceptWaveform(before.tobytes())

    def _checked(self, start: float, time: float) -> Detection | None:
        """The second stage: the sound from the word on, decoded again."""
        if not self._second_stage:
            self._heard = time
            return Detection(self.word, round(time, 3), 0.0)
        samples = int((time - start + BEFORE) * RATE)
        recent = np.concatenate(self._recent)[-samples:]
        heard = self._recogniser.recognise(
            Audio(recent), [self._spoken, *self._around], worst_fit=self._worst_fit
        )
        fits = [each.fit for each in heard.readings if self._spoken in each.text]
        if not fits or max(fits) < self._worst_fit:
            return None
        self._heard = time
        return Detection(self.word, round(time, 3), min(1.0, 1 + max(fits)))
