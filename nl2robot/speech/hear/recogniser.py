"""What was said: a recording and what may be said -> words, and whether to believe them.

A recogniser that may hear anything mishears what is rare elsewhere and common here; one that knows
the phrases of the grammar and the world hears those, but it hears nothing else: whatever is said
comes back as such phrases. So the same sound is decoded both ways, side by side. Both give a score
for how well their words fit the sound, and so

- where free words fit much better and are other words, the result is marked `doubtful`;
- all readings of both are kept, the best fitting first, for the grammar to choose from (`choose`).

Where there is a second ear for the language (`second_ear`), it takes the place of the free decoder:
it hears better, and tells how far each reading is to be believed.

The figures in docs/voice.md were measured with the constants in this file.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from nl2robot.errors import UserError
from nl2robot.models.catalogue import ModelError, find, need
from nl2robot.speech.audio import RATE, Audio, Samples
from nl2robot.speech.hear.levels import Silence, gain_for
from nl2robot.speech.hear.rescorer import Evidence, SecondEar, second_ear
from nl2robot.speech.hear.vocabulary import spell_numbers
from nl2robot.speech.hear.vosk_decoder import READINGS, Decoder, Scored, helpers, scored

# Before and after the speech, silence: without it the model loses the first and last sounds.
PADDING = 0.3  # seconds
MOST_LISTS = 16  # of phrases that are kept ready to be decoded with
MOST_IDLE = 2  # decoders kept for each: as many as there are sounds at a time
PUNCTUATION = '-–.,;:!?…"“”„«»()'

# The second opinion: when a text is believed that free decoding does not agree with. Chosen among
# the ways to tell that docs/voice.md compares.
ALIKE = 0.9  # texts this similar are the same words
WORST_FIT = -0.08  # how much of its score a text may be behind free decoding, where ...
DISAGREEMENT = 0.2  # ... as much counts as behind if it has nothing in common with the free text,
UNSURENESS = 0.1  # ... and as much if the limited decoder had no confidence in its words at all

# With a second ear.
LEAST_BELIEF = 0.45  # of what is not doubtful
CANDIDATES = 6  # of the limited decoder that it judges
LONGEST = 30.0  # seconds that it can hear at once; nothing that long is a command
NEWS = 0.8  # seconds of sound after which it tells anew what was said so far, where it hears alone


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
    # reading (0). A much worse fit is hardly ever what was said. 0 where a second ear tells.
    fit: float
    doubtful: bool
    # Log likelihood of sound and words together; to be compared with readings of one decoder only.
    score: float = 0.0
    free: bool = False  # found where anything may be said
    evidence: Evidence | None = None  # of a second ear

    @property
    def confidence(self) -> float:
        """0..1."""
        return self.evidence.belief if self.evidence else max(0.0, min(1.0, 1 + self.fit))


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
                confidence=reading.confidence,
                words=(),
                doubtful=False,
            )
    if heard.doubtful and heard.free_text and not makes_sense:
        return replace(heard, text=heard.free_text, confidence=0.0, words=())
    return heard


@dataclass(frozen=True, eq=False)  # kept by phrase list, so the same is the same object
class _Grammar:
    """What may be said, for vosk."""

    json: str
    phrases: tuple[str, ...]
    as_written: dict[str, str]  # words of the model that people write otherwise

    def written(self, text: str) -> str:
        return " ".join(self.as_written.get(word, word) for word in text.split())


class Recogniser:
    """A loaded speech model. May be used from several threads at once."""

    def __init__(self, model: Path | None, language: str, second: SecondEar | None = None) -> None:
        """`model` is the folder of a vosk model, `second` judges what is heard with it, or hears
        alone where there is none. Raises ModelError if the model cannot be used."""
        self.language = language
        self.second = second
        self._grammars: dict[tuple[str, ...], _Grammar] = {}
        self._idle: dict[tuple[_Grammar | None, int], list[Decoder]] = {}
        self._lock = threading.Lock()
        self._unusable = ModelError(
            f"The speech model {f'in {model} ' if model else ''}cannot be used. "
            f"Run `nl2robot models get {language} --again` to fetch it again."
        )
        if model is None and second is None:  # there is one, but it is damaged
            raise self._unusable
        try:
            import vosk

            vosk.SetLogLevel(-1)  # its C++ log goes to standard error
            self._model = vosk.Model(str(model)) if model else None
        except Exception as error:  # vosk raises nothing more precise
            raise self._unusable from error

    @property
    def word_by_word(self) -> bool:
        """Whether it hears words while they are said: there is a vosk model."""
        return self._model is not None

    def knows(self, word: str) -> bool:
        """Whether the model can hear this word at all; a second ear alone writes any."""
        return self._model is None or bool(self._model.vosk_model_find_word(word) >= 0)

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
        worst_fit: float | None = None,
    ) -> Heard:
        """What is said in `audio`.

        `phrases` is what may be said: single words, names, and, better, whole sample sentences, for
        the recogniser learns from them which word follows which. Words the model does not know are
        left out (`unknown_words` tells which). None: anything may be said, and nothing is doubtful.
        `worst_fit` is by how much of its score free decoding may fit better before it is believed,
        for sounds too short to count anything else. Without it, the second ear tells what to
        believe; where there is none, `WORST_FIT` with what the two decoders have in common and how
        sure the limited one is.
        Raises SpeechError if the model knows none of the words.
        """
        started = time.perf_counter()
        decoding = self.open(phrases, worst_fit=worst_fit, gain=gain_for(audio.samples))
        decoding.feed(audio.samples)
        return replace(decoding.finish(), seconds_taken=time.perf_counter() - started)

    def open(
        self,
        phrases: Sequence[str] | None = None,
        *,
        worst_fit: float | None = None,
        gain: float = 1.0,
    ) -> Decoding:
        """A decoding to be fed with sound while it comes; `phrases` and `worst_fit` as above.

        `gain` is what to multiply the sound with: how loud it will be is not known yet. `gain_for`
        tells it from sound of the same speaker. Raises SpeechError as `recognise` does.
        """
        grammar = None if phrases is None else self._grammar(phrases)
        if grammar is not None and self.second is not None and worst_fit is None:
            helpers().submit(self.second.expect, grammar.phrases)  # while they speak
        if self._model is None:
            return _Unaided(self, grammar, worst_fit)
        return Decoding(self, grammar, worst_fit, gain)

    def _grammar(self, phrases: Sequence[str]) -> _Grammar:
        key = tuple(phrases)
        with self._lock:
            known = self._grammars.pop(key, None)  # the least used stand first
        grammar = known or self._compiled(phrases)
        with self._lock:
            self._grammars[key] = grammar
            while len(self._grammars) > MOST_LISTS:
                del self._grammars[next(iter(self._grammars))]
        return grammar

    def _compiled(self, phrases: Sequence[str]) -> _Grammar:
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
        limits = json.dumps(list(spoken), ensure_ascii=False)
        return _Grammar(limits, tuple(phrases), as_written)

    def _decoder(self, grammar: _Grammar | None, alternatives: int) -> Decoder:
        """One that is done, or a new one. A used one is several times as fast: it keeps the parts
        of the search graph that it has unfolded."""
        key = (grammar, alternatives)
        with self._lock:
            if self._idle.get(key):
                return self._idle[key].pop()
        limits = () if grammar is None else (grammar.json,)
        try:
            import vosk

            kaldi = vosk.KaldiRecognizer(self._model, RATE, *limits)
        except Exception as error:
            raise self._unusable from error
        kaldi.SetWords(True)
        kaldi.SetMaxAlternatives(alternatives)
        return Decoder(kaldi)

    def _take_back(self, decoder: Decoder, grammar: _Grammar | None, alternatives: int) -> None:
        key = (grammar, alternatives)
        with self._lock:
            idle = self._idle.pop(key, [])  # the least used stand first
            self._idle[key] = [*idle, decoder][:MOST_IDLE]
            while len(self._idle) > MOST_LISTS:
                del self._idle[next(iter(self._idle))]


class Decoding:
    """Sound that is decoded while it comes. For one thread.

        decoding = recogniser.open(phrases, gain=gain)
        decoding.feed(samples)     # as often as there are some
        heard = decoding.finish()  # soon, for most is done by then

    `Recogniser.recognise` is this with a whole recording. One that is not finished costs nothing.
    """

    def __init__(
        self, recogniser: Recogniser, grammar: _Grammar | None, worst_fit: float | None, gain: float
    ) -> None:
        self._grammar = grammar
        self._worst_fit = worst_fit
        self._gain = gain
        self._samples = 0
        self._silent = Silence()
        self._recogniser = recogniser
        self._second = recogniser.second if worst_fit is None else None
        self._sound: list[Samples] = []  # for the second ear
        wanted: list[tuple[_Grammar | None, int]] = [(grammar, 0)]
        if grammar is not None:
            # With alternatives libvosk gives scores, without them confidences.
            wanted.append((grammar, READINGS))
            if self._second is None:
                wanted.append((None, READINGS))
        self._decoders = {key: recogniser._decoder(*key) for key in wanted}
        self._feed(np.zeros(int(PADDING * RATE), np.int16))

    def feed(self, samples: Samples) -> None:
        """Sound that follows what was fed, any number of samples. Takes about a fifth of its
        length."""
        self._samples += len(samples)
        self._silent.feed(samples)
        if self._second is not None:
            self._sound.append(samples)
        loud = samples.astype(np.float32) * self._gain
        self._feed(np.clip(loud, -32768, 32767).astype(np.int16))

    @property
    def so_far(self) -> str:
        """What it sounds like up to now; the last words may still change."""
        first = next(iter(self._decoders.values()))
        return self._written(first.so_far)

    def finish(self) -> Heard:
        """What was said. To be called once, after which nothing can be fed."""
        started = time.perf_counter()
        if self._silent:
            return _heard((), self._samples / RATE)
        if self._second is not None:
            with ThreadPoolExecutor(1) as beside:  # the ear hears while the decoders are ended
                heard = self._judged(beside.submit(self._ended).result, self._second)
        else:
            heard = self._compared(self._ended())
        for key, decoder in self._decoders.items():
            self._recogniser._take_back(decoder.anew(), *key)
        self._decoders = {}
        return replace(heard, seconds_taken=time.perf_counter() - started)

    def _ended(self) -> Heard:
        """What was heard word by word."""
        self._feed(np.zeros(int(PADDING * RATE), np.int16))
        self._each(Decoder.finish)
        sure, *_ = self._decoders.values()
        return _heard(self._words(sure), self._samples / RATE)

    def _compared(self, heard: Heard) -> Heard:
        """What was heard, beside what is heard where anything may be said."""
        if self._grammar is None:
            return heard
        _, limited, free = (scored(decoder.results) for decoder in self._decoders.values())
        limited = [Scored(self._written(text.text), text.score) for text in limited]
        trusted = _Trust(free[0], heard.confidence, self._worst_fit)
        return replace(
            heard,
            doubtful=trusted.reading(limited[0]).doubtful,
            free_text=free[0].text,
            readings=_readings(limited, free, trusted),
        )

    def _judged(self, unjudged: Callable[[], Heard], ear: SecondEar) -> Heard:
        """What was heard, as the second ear hears and believes it; `unjudged` waits for what was
        heard word by word."""
        if self._samples > LONGEST * RATE:
            heard = unjudged()
            return replace(heard, doubtful=True, free_text=heard.text)
        sound = np.concatenate(self._sound)
        if self._grammar is None:
            free, heard = ear.free(sound), unjudged()
            return replace(heard, text=free, words=heard.words if free == heard.text else ())
        opinion = ear.hear(sound, self._grammar.phrases, self._candidates(unjudged))
        heard = unjudged()
        readings = tuple(
            Reading(
                each.written or each.text,
                fit=0.0,
                doubtful=each.evidence.belief < LEAST_BELIEF,
                score=each.likelihood,
                evidence=each.evidence,
            )
            for each in opinion.readings
        )
        if not readings:
            return replace(heard, doubtful=bool(heard.text), free_text=opinion.free)
        best = readings[0]
        return replace(
            heard,
            text=best.text,
            confidence=best.confidence,
            words=heard.words if best.text.lower() == heard.text else (),
            doubtful=best.doubtful,
            free_text=opinion.free,
            readings=readings,
        )

    def _candidates(self, unjudged: Callable[[], Heard]) -> Iterator[str]:
        """What the limited decoder heard, the likeliest first. Waits for it."""
        unjudged()
        _, limited = self._decoders.values()
        for text in scored(limited.results)[:CANDIDATES]:
            yield self._written(text.text)

    def _feed(self, samples: Samples) -> None:
        sound = samples.tobytes()
        self._each(lambda decoder: decoder.feed(sound))

    def _each(self, work: Callable[[Decoder], None]) -> None:
        """The last, slowest one beside the others: libvosk does not hold the interpreter's lock."""
        *others, last = self._decoders.values()
        beside = helpers().submit(work, last) if others else None
        for decoder in others or [last]:
            work(decoder)
        if beside is not None:
            beside.result()

    def _written(self, text: str) -> str:
        return self._grammar.written(text) if self._grammar else text

    def _words(self, decoder: Decoder) -> tuple[Word, ...]:
        """The words with their times and confidences."""
        before = decoder.started + PADDING
        return tuple(
            Word(
                self._written(word["word"]),
                max(0.0, word["start"] - before),
                max(0.0, word["end"] - before),
                word["conf"],
            )
            for result in decoder.results
            for word in result.get("result", ())
        )


class _Unaided(Decoding):
    """With a second ear only. It hears whole utterances; what was said so far it tells anew now and
    then."""

    def __init__(
        self, recogniser: Recogniser, grammar: _Grammar | None, worst_fit: float | None
    ) -> None:
        assert recogniser.second is not None
        self._ear = recogniser.second
        self._grammar = grammar
        self._worst_fit = worst_fit
        self._samples = 0
        self._silent = Silence()
        self._sound: list[Samples] = []
        self._so_far = ""
        self._told = 0  # samples of which `_so_far` tells

    def feed(self, samples: Samples) -> None:
        self._samples += len(samples)
        self._silent.feed(samples)
        self._sound.append(samples)

    @property
    def so_far(self) -> str:
        anew = self._samples - self._told >= NEWS * RATE and not self._silent
        if anew and self._samples <= LONGEST * RATE:
            self._told = self._samples
            self._so_far = self._ear.quickly(np.concatenate(self._sound))
        return self._so_far

    def finish(self) -> Heard:
        started = time.perf_counter()
        silence = heard = _heard((), self._samples / RATE)
        if self._silent:
            return silence
        if self._worst_fit is None:
            heard = self._judged(lambda: silence, self._ear)
        elif heard.seconds_of_audio <= LONGEST:  # whoever sets it judges by themselves
            heard = replace(heard, text=self._ear.free(np.concatenate(self._sound)))
        return replace(heard, seconds_taken=time.perf_counter() - started)

    def _candidates(self, unjudged: Callable[[], Heard]) -> Iterator[str]:
        return iter(())


def load(code: str) -> Recogniser:
    """The recogniser of an installed language, loaded once. Raises ModelError if not installed."""
    need(code)
    return _loaded(find(code), code, second_ear(code))


@lru_cache(maxsize=4)
def _loaded(model: Path | None, code: str, second: SecondEar | None) -> Recogniser:
    return Recogniser(model, code, second)


def _heard(words: tuple[Word, ...], seconds: float) -> Heard:
    return Heard(
        text=" ".join(word.text for word in words),
        confidence=sum(word.confidence for word in words) / len(words) if words else 0.0,
        words=words,
        doubtful=False,
        free_text=None,
        readings=(),
        seconds_of_audio=seconds,
        seconds_taken=0.0,
    )


@dataclass(frozen=True)
class _Trust:
    """What is believed of a text beside the best free one."""

    free: Scored
    confidence: float  # of the limited decoder in its words
    worst_fit: float | None

    def reading(self, text: Scored) -> Reading:
        from rapidfuzz import fuzz

        fit = (text.score - self.free.score) / max(1.0, abs(self.free.score))
        # Without blanks, for "good bye" and "goodbye" are the same.
        same = fuzz.ratio(text.text.replace(" ", ""), self.free.text.replace(" ", "")) / 100
        if self.worst_fit is None:
            behind = DISAGREEMENT * (1 - same) + UNSURENESS * (1 - self.confidence)
            doubtful = fit - behind < WORST_FIT
        else:
            doubtful = fit < self.worst_fit
        return Reading(text.text, fit, doubtful and same < ALIKE, text.score)


def _readings(
    limited: Sequence[Scored], free: Sequence[Scored], trusted: _Trust
) -> tuple[Reading, ...]:
    best: dict[str, Reading] = {}
    for decoder in (limited, free):
        for text in decoder:
            reading = replace(trusted.reading(text), free=decoder is free)
            if text.text and (text.text not in best or reading.fit > best[text.text].fit):
                best[text.text] = reading
    return tuple(sorted(best.values(), key=lambda reading: -reading.fit))
