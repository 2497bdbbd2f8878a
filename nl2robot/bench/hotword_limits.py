"""Where the second stage of a hot word should draw its line:

    python -m nl2robot.bench.hotword_limits
    --hours 0.4   of each noise

For each limit that `judged` in data/hotwords.yaml may have: how often the word would be missed, and
how often heard by mistake. On the voices of the training, so that the evaluation of
`nl2robot bench hotword` stays unseen.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np

from nl2robot.bench.hotword import Sound, Stage, all_said
from nl2robot.bench.hotword_voices import Half
from nl2robot.speech.audio import RATE, Samples
from nl2robot.speech.hotword.detector import SMOOTH, STOP_SMOOTH, Heads
from nl2robot.speech.hotword.head import Head, load_head
from nl2robot.speech.hotword.judge import Judge, judge_of
from nl2robot.speech.hotword.words import WORDS

SEED: Final = 11  # that no head was trained with
SNRS: Final = (None, 10, 5)
KINDS: Final = ("babble", "talk", "corridor with talk")
PIECE: Final = 10  # seconds, in which one false alarm at most is counted
LIMITS: Final = range(-45, 3)
LOWEST: Final = -1000.0


class Noting(Judge):
    """A second stage that accepts nothing, and notes by how much it would have."""

    def __init__(self, judge: Judge) -> None:
        self._judge = judge.limited(LOWEST)  # far below, so that every model is asked
        self.floor, self.samples, self.limit = judge.floor, judge.samples, LOWEST
        self.most = -np.inf

    def verdict(self, samples: Samples, score: float) -> float:
        self.most = max(self.most, self._judge.verdict(samples, score))
        return -1.0


def strongest(head: Head, judge: Judge, smooth: int, sound: Sound) -> float:
    """The limit from which on nothing is heard in this sound."""
    noting = Noting(judge)
    Heads([head], [noting], smooth=smooth).hear(sound.embeddings, sound.samples)
    return noting.most + noting.limit


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description="What follows from the limits of second stages.")
    parser.add_argument("--hours", type=float, default=0.4, help="of each noise (default: 0.4)")
    parser.add_argument("--sayings", type=int, default=30, help="a figure (default: 30)")
    options = parser.parse_args(arguments)
    for code, words in WORDS.items():
        if words.judged:
            stage = Stage(words, SEED, Half.TRAINING)
            noises = {kind: list(_pieces(stage, kind, options.hours)) for kind in KINDS}
            for word in words.judged:
                smooth = SMOOTH if word == words.hot else STOP_SMOOTH
                _print_table(code, word, smooth, stage, noises, options.sayings)


def _pieces(stage: Stage, kind: str, hours: float) -> Iterator[Sound]:
    for minute in stage.noises(kind, hours):
        for at in range(0, len(minute.samples), PIECE * RATE):
            yield Sound(minute.samples[at : at + PIECE * RATE])


def _print_table(
    code: str,
    word: str,
    smooth: int,
    stage: Stage,
    noises: Mapping[str, Sequence[Sound]],
    sayings: int,
) -> None:
    head = load_head(code, word)
    judge = judge_of(code, word, head.threshold) if head else None
    if head is None or judge is None:
        raise SystemExit(f"“{word}” has no head or no second speech model here.")
    said = {
        f"{'neural' if neural else 'robotic'} {snr}": [
            strongest(head, judge, smooth, each)
            for each in all_said(stage, word, snr, sayings, neural=neural)
        ]
        for neural in stage.neural
        for snr in SNRS
    }
    heard = {
        kind: [strongest(head, judge, smooth, piece) for piece in pieces]
        for kind, pieces in noises.items()
    }
    print(f"{word}: % missed | alarms an hour")
    print("limit", *said, "|", *heard, sep="\t")
    for limit in LIMITS:
        missed = [100 * np.mean(np.array(most) <= limit) for most in said.values()]
        alarms = [(np.array(most) > limit).mean() * 3600 / PIECE for most in heard.values()]
        shares, rates = [f"{m:.0f}" for m in missed], [f"{a:.1f}" for a in alarms]
        print(limit, *shares, "|", *rates, sep="\t", flush=True)


if __name__ == "__main__":
    main()
