"""How well commands and answers are heard: `nl2robot bench hearing`.

Commands that the recogniser has not met and such that it has, remarks, noise in which nobody
speaks, digits, numbers, yes and no, and options: in several synthesised voices, in a quiet room and
in noise.
"""

from __future__ import annotations

import resource
import statistics
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from grammar.samples import all_samples, samples
from nl2robot.bench.trials import LEVELS, Stage, Trial, spoken
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.speech.hear.answers import expect, hear_answer
from nl2robot.speech.hear.levels import gain_for
from nl2robot.speech.hear.recogniser import PUNCTUATION
from nl2robot.speech.hear.vocabulary import number_words, spell_numbers
from nl2robot.speech.hear.vosk_decoder import BLOCK
from nl2robot.voice.hearing import Ear
from sim.world.loading import load_world

CONDITIONS = ("quiet", *(f"{level:g} dB" for level in LEVELS))
MOST = {"quick": 15, "full": 100}
"""Trials of each kind: the quick form takes two minutes of computing."""
NOBODY = {"quick": 6, "full": 60}
_NUMBERS = (12, 15, 21, 30, 47, 60, 99, 100, 105, 250)


@dataclass(frozen=True)
class Outcome:
    """What became of one trial."""

    trial: Trial
    heard: str
    right: bool
    asked: bool  # nothing done: the robot asks again, or keeps still
    errors: int = 0  # words
    seconds: float = 0.0  # from the end of the sound to the program
    share_of_time: float = 0.0  # of the decoding in the length of the sound


@dataclass
class Tally:
    """The outcomes of one language."""

    language: str
    outcomes: list[Outcome] = field(default_factory=list)

    def rows(self) -> Iterator[tuple[str, list[str]]]:
        """What, and its figure for each of `CONDITIONS` and for all of them."""
        for kind in dict.fromkeys(outcome.trial.kind for outcome in self.outcomes):
            of_kind = [outcome for outcome in self.outcomes if outcome.trial.kind == kind]
            for what, figure in _FIGURES[kind if kind in _FIGURES else ""].items():
                yield (
                    f"{kind}: {what}",
                    [
                        figure([each for each in of_kind if each.trial.condition == condition])
                        for condition in CONDITIONS
                    ]
                    + [figure(of_kind)],
                )

    @property
    def seconds(self) -> float:
        """Median from the end of a command's sound to its program."""
        return statistics.median(o.seconds for o in self.outcomes if o.seconds)

    @property
    def real_time_factor(self) -> float:
        return statistics.median(o.share_of_time for o in self.outcomes if o.share_of_time)


def megabytes() -> float:
    """The most memory that this process has had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def run(
    language: str,
    size: str = "full",
    seed: int = 1,
    progress: Callable[[int, int], None] = lambda done, of: None,
) -> Tally:
    """Raises ModelError or VoiceError where there is no model or no voice."""
    bench = _Bench(language, seed)
    tally = Tally(language)
    trials = list(bench.trials(size))
    for n, (trial, hear) in enumerate(trials):
        tally.outcomes.append(hear(trial))
        progress(n + 1, len(trials))
    return tally


class _Bench:
    def __init__(self, language: str, seed: int) -> None:
        self._language = language
        knowledge = Knowledge(load_world(DEFAULT_WORLD))
        self._ear = Ear(knowledge, language)
        self._stage = Stage(language, seed)
        lexicon = knowledge.lexicon(language)
        known = [
            sentence
            for topic in samples(lexicon, language).values()
            for sentence in topic
            if self._ear.program(sentence) is not None  # some are for the application
        ]
        order = np.random.default_rng(seed).permutation(len(known))
        self._known = [known[n] for n in order]
        self._told = frozenset(all_samples(lexicon, language))

    def trials(self, size: str) -> Iterator[tuple[Trial, Callable[[Trial], Outcome]]]:
        said, most = spoken(self._language), MOST[size]
        commands = [text for text in said["commands"] if text not in self._told]
        for kind, sayings in (
            ("new commands", commands),
            ("known commands", self._known[:40]),
            ("remarks", said["remarks"]),
        ):
            for trial in self._stage.trials(kind, sayings, most):
                yield trial, self._command
        for trial in self._stage.nobody(NOBODY[size]):
            yield trial, self._command
        language = self._language
        digits = {number_words(str(digit), language): str(digit) for digit in range(10)}
        numbers = {number_words(str(n), language): str(n) for n in _NUMBERS}
        options = {option: option for option in said["options"]}
        yes_no = dict.fromkeys(_YES[language], "yes") | dict.fromkeys(_NO[language], "no")
        for kind, what, answers in (
            ("digits", "digits", digits),
            ("numbers", "number", numbers),
            ("yes and no", "yes-no", yes_no),
            ("options", said["options"], options),
        ):
            yield from self._answers(kind, what, answers, most)
        for trial in self._stage.trials("asides to a question", said["asides"], most):
            yield trial, self._answer("digits", {})

    def _answers(
        self, kind: str, what: str | Sequence[str], answers: dict[str, str], most: int
    ) -> Iterator[tuple[Trial, Callable[[Trial], Outcome]]]:
        for trial in self._stage.trials(kind, list(answers), most):
            yield trial, self._answer(what, answers)

    def _answer(
        self, what: str | Sequence[str], answers: dict[str, str]
    ) -> Callable[[Trial], Outcome]:
        expected = expect(what, self._language)

        def hear(trial: Trial) -> Outcome:
            answer = hear_answer(self._ear.recogniser, trial.audio, expected)
            right = answer.answer is not None and answer.answer == answers.get(trial.said)
            return Outcome(trial, answer.heard, right, asked=answer.answer is None)

        return hear

    def _command(self, trial: Trial) -> Outcome:
        """Decoded while it comes, as from a microphone; what counts is what is left at its end."""
        samples = trial.audio.samples
        decoding = self._ear.open(gain_for(samples))
        began = time.perf_counter()
        for start in range(0, len(samples), BLOCK):
            decoding.feed(samples[start : start + BLOCK])
        ended = time.perf_counter()
        heard = self._ear.understood(decoding.finish())
        translation = self._ear.translate(heard)
        done = time.perf_counter()
        program = translation.program
        wanted = self._ear.program(trial.said) if trial.said else None
        return Outcome(
            trial,
            heard.text,
            right=program is not None and program == wanted,
            asked=program is None,
            errors=word_errors(self._spelled(trial.said), self._spelled(heard.text)),
            seconds=done - ended,
            share_of_time=(done - began) / trial.audio.seconds,
        )

    def _spelled(self, text: str) -> list[str]:
        words = spell_numbers(text.lower().replace("-", " "), self._language).split()
        return [word for word in (word.strip(PUNCTUATION) for word in words) if word]


def word_errors(said: Sequence[str], heard: Sequence[str]) -> int:
    """Words left out, put in or taken for others, as few as can explain it (Levenshtein)."""
    from rapidfuzz.distance import Levenshtein

    return int(Levenshtein.distance(said, heard))


def _percent(outcomes: Iterable[Outcome], holds: Callable[[Outcome], bool]) -> str:
    held = [holds(outcome) for outcome in outcomes]
    return f"{100 * sum(held) / len(held):.0f} %" if held else "-"


def _wrong_words(outcomes: Sequence[Outcome]) -> str:
    words = sum(len(outcome.trial.said.split()) for outcome in outcomes)
    return f"{100 * sum(o.errors for o in outcomes) / words:.0f} %" if words else "-"


Figure = Callable[[Sequence[Outcome]], str]
_ACTED: dict[str, Figure] = {"acted on": lambda some: _percent(some, lambda o: not o.asked)}
_ANSWERED: dict[str, Figure] = {
    "right": lambda some: _percent(some, lambda o: o.right),
    "wrong": lambda some: _percent(some, lambda o: not o.right and not o.asked),
}
_FIGURES: dict[str, dict[str, Figure]] = {
    "": _ANSWERED,
    "remarks": _ACTED,
    "nobody": _ACTED,
    "asides to a question": {"taken for a digit": _ACTED["acted on"]},
}
for _kind in ("new commands", "known commands"):
    _FIGURES[_kind] = {
        "words wrong": _wrong_words,
        **_ANSWERED,
        "asked again": lambda some: _percent(some, lambda o: o.asked),
    }
_YES = {"en": ["yes", "yes please", "of course"], "fr": ["oui", "oui merci", "bien sûr"]}
_YES["de"] = ["ja", "ja bitte", "natürlich"]
_NO = {"en": ["no", "no thank you", "not now"], "fr": ["non", "non merci", "pas maintenant"]}
_NO["de"] = ["nein", "nein danke", "nicht jetzt"]
