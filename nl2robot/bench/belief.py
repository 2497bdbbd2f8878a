"""When to believe what was heard: `python -m nl2robot.bench.belief [SEED [LANGUAGE]]`.

Commands, remarks and noise are heard in several voices and noises, and each way to tell what to
believe gives the likeliest program of each and how sure it is. How sure it must be is settled with
half of the voices, for the most (right - wrong - 2 x remarks acted on), and counted with the other
half; then the other way round. The weights of the belief are fitted the same way, and then with all
voices, and printed: they are `nl2robot.speech.hear.rescorer.WEIGHTS`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from grammar.samples import all_samples, samples
from nl2robot.bench.trials import Stage, Trial, spoken
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.models.catalogue import find
from nl2robot.speech.hear.listening import has_speech
from nl2robot.speech.hear.recogniser import Heard, Recogniser
from nl2robot.speech.hear.rescorer import WEIGHTS, Evidence
from nl2robot.voice.hearing import Ear
from sim.world.loading import load_world

EACH = 100  # trials of each kind
NOBODY = 40
Weights = Sequence[float]
Row = NDArray[np.float64]


@dataclass(frozen=True)
class Case:
    """One trial, and what may be made of it."""

    trial: Trial
    wanted: str | None  # the program; None for what is no command
    readings: tuple[tuple[Evidence, str], ...]  # of the second ear, with their programs
    alone: tuple[tuple[Heard, str], ...]  # of the recogniser alone; one or none


@dataclass(frozen=True)
class Choice:
    """The program that one way would take."""

    right: bool
    sure: float


Way = Callable[[Case], Choice | None]


def cases(ear: Ear, seed: int) -> Iterator[Case]:
    """Takes about a second each. Raises ModelError or VoiceError."""
    stage, said = Stage(ear.language, seed), spoken(ear.language)
    lexicon = ear.knowledge.lexicon(ear.language)
    known = [text for topic in samples(lexicon, ear.language).values() for text in topic]
    told = all_samples(lexicon, ear.language)
    folder = find(ear.language)  # of vosk's model, which some languages lack here
    alone = Recogniser(folder, ear.language) if folder else None
    for kind, sayings in (
        ("command", [text for text in said["commands"] if text not in told]),
        ("command", [text for text in known if ear.program(text) is not None]),
        ("remark", said["remarks"]),
    ):
        for trial in stage.trials(kind, sayings, EACH):
            yield _case(ear, alone, trial)
    for trial in stage.nobody(NOBODY):
        yield _case(ear, alone, trial)


def _case(ear: Ear, alone: Recogniser | None, trial: Trial) -> Case:
    wanted = ear.program(trial.said) if trial.kind == "command" else None
    if not has_speech(trial.audio):
        return Case(trial, wanted, (), ())
    both = ear.recogniser.recognise(trial.audio, ear.phrases)
    heard = [ear.understood(alone.recognise(trial.audio, ear.phrases))] if alone else []
    return Case(
        trial,
        wanted,
        tuple(
            (reading.evidence, program)
            for reading in both.readings
            if reading.evidence and (program := ear.program(reading.text))
        ),
        tuple((each, program) for each in heard if (program := ear.program(each.text))),
    )


def _alone(case: Case) -> Choice | None:
    for heard, program in case.alone:
        return Choice(program == case.wanted, heard.confidence - heard.doubtful)
    return None


def _by(sure: Callable[[Evidence], float]) -> Way:
    def way(case: Case) -> Choice | None:
        ways = [Choice(program == case.wanted, sure(each)) for each, program in case.readings]
        return max(ways, key=lambda choice: choice.sure, default=None)

    return way


def _weighed(weights: Weights) -> Way:
    return _by(lambda each: float(np.dot(weights, each.row)))


WAYS: dict[str, Way] = {
    "the recogniser alone (vosk, two decoders)": _alone,
    "second ear: likelihood": _by(lambda each: -each.unlikely),
    "second ear: likelihood of a subword": _by(lambda each: -each.unlikely / each.subwords),
    "second ear: likelihood, and both heard it": _by(
        lambda each: -each.unlikely - 1000 * (not each.agreed)
    ),
    "second ear: belief, weights as they are": _weighed(WEIGHTS),
}


def counted(
    halves: Sequence[Sequence[Case]], way_for: Callable[[Sequence[Case]], Way]
) -> tuple[int, int, int]:
    """Right programs, wrong ones, and remarks or noise acted on, each half by the limit of the
    other; `way_for` makes the way from the half that it may know."""
    result = np.zeros(3, int)
    for known, other in (halves, halves[::-1]):
        way = way_for(known)
        limits = sorted({choice.sure for case in known if (choice := way(case))})
        worth = {limit: _outcome(known, way, limit) @ (1, -1, -2) for limit in limits}
        result += _outcome(other, way, max(limits, key=lambda limit: worth[limit]))
    return int(result[0]), int(result[1]), int(result[2])


def _outcome(cases: Sequence[Case], way: Way, limit: float) -> NDArray[np.int64]:
    right = wrong = acted = 0
    for case in cases:
        choice = way(case)
        if choice is None or choice.sure < limit:
            continue
        right += choice.right
        wrong += not choice.right and case.wanted is not None
        acted += case.wanted is None
    return np.array([right, wrong, acted])


def _always(way: Way) -> Callable[[Sequence[Case]], Way]:
    return lambda known: way


def fitted(cases: Sequence[Case], rounds: int = 4) -> Weights:
    """Weights of a logistic regression: is the reading right that these weights would choose?"""
    weights: Weights = WEIGHTS
    for _ in range(rounds):
        rows, right = [], []
        for case in cases:
            if case.readings:
                each, program = max(
                    case.readings, key=lambda each: float(np.dot(weights, each[0].row))
                )
                rows.append(each.row)
                right.append(program == case.wanted)
        weights = _regression(np.array(rows, float), np.array(right, float))
    return [round(float(weight), 3) for weight in weights]


def _regression(rows: Row, right: Row, steps: int = 4000) -> Weights:
    scale = rows.std(0)
    scale[scale == 0] = 1.0  # the constant, too
    scaled, weights = rows / scale, np.zeros(rows.shape[1])
    for _ in range(steps):
        predicted = 1 / (1 + np.exp(-scaled @ weights))
        weights -= 0.5 * (scaled.T @ (predicted - right) / len(right) + 1e-3 * weights)
    return list(weights / scale)


def main(arguments: Sequence[str]) -> None:
    """The seed of the trials (1), and the language (en)."""
    from rich.console import Console
    from rich.progress import track
    from rich.table import Table

    seed, language = [*arguments, *("1", "en")[len(arguments) :]][:2]
    ear = Ear(Knowledge(load_world(DEFAULT_WORLD)), language)
    whole = 3 * EACH + NOBODY
    heard = list(track(cases(ear, int(seed)), "Hearing", total=whole))
    voices = sorted({case.trial.speaker for case in heard})
    halves = [[case for case in heard if case.trial.speaker in voices[n::2]] for n in range(2)]
    table = Table("way", "right", "wrong", "remarks and noise acted on")
    for name, way in WAYS.items():
        table.add_row(name, *map(str, counted(halves, _always(way))))
    row = counted(halves, lambda known: _weighed(fitted(known)))
    table.add_row("second ear: belief, weights fitted to the other half", *map(str, row))
    commands = sum(case.wanted is not None for case in heard)
    console = Console()
    console.print(table)
    console.print(f"Of {commands} commands and {len(heard) - commands} others.")
    console.print(f"Weights fitted to all: {fitted(heard)}")


if __name__ == "__main__":
    main(sys.argv[1:])
