"""What the probabilities of a planner mean.

    python -m nl2robot.training.planner.calibrate OUT.jsonl [--planner model] [--also FILE]

What became of sentences (`evaluate`; OUT grows line by line and is gone on from) is told in a
table, and a logistic regression is fitted to one half of it and tried on the other; fitted to both
it goes to `nl2robot/data/confidence.json` (`nl2robot.deliberation.confidence`).
"""

from __future__ import annotations

import argparse
import functools
import json
import random
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from grammar.language import load_language
from grammar.planning.planner import Drafts, Watch
from grammar.planning.turn import Turn
from grammar.understanding import Context
from nl2robot.deliberation.confidence import READ, WEIGHTS, features_alone
from nl2robot.deliberation.considering import consider
from nl2robot.deliberation.deciding import ACCEPTED
from nl2robot.deliberation.sufficing import SURE_OF_RULES
from nl2robot.knowledge import Knowledge
from nl2robot.training.planner.corpus import files, load
from nl2robot.training.planner.evaluate import Row, measure, scores, table
from nl2robot.training.planner.examples import is_held_out
from nl2robot.training.planner.export import file_digest
from nl2robot.training.planner.noise import as_typed
from nl2robot.translate.planners import installed_model, learned, planner
from sim.world.loading import load_world

TYPED: Final = Path(__file__).with_name("typed.jsonl")

USED: Final = {
    "model": ("surest", "score", "branches", "hardly asked"),
    "grammar": (
        *("lines", "words", "unused words", "unasked", "unheeded", "branches", "remarks"),
        *("hardly asked", "own", "sure", "parts", "texts", "text words", "marks"),
    ),
}
"""Features that count. Those of the model were chosen one by one as long as the probabilities of
drafts that they were not fitted to became truer; of rules, that have learned from none of the
corpus, what they have read counts besides (`READ`), where it is not too rare to tell."""
OFTEN_ENOUGH: Final = 8
"""Drafts in which something was read, for it to count."""
RIGHT_IN_ANOTHER_WAY: Final = 0.19
"""The share of drafts of the model that do something else than the author's program and are right:
nine of 47 that somebody has read. Of rules, that do less of what was not said, none is assumed."""
PULL: Final = {"model": 5.0, "grammar": 40.0}
"""How strongly weights are drawn towards nothing, of standardised features."""
OF_THE_CORPUS: Final = 0.5
"""What a draft counts for that was compared with the author's program, where one that somebody has
read counts for 1: whatever does something else than the author's program is counted as wrong, and
the corpus has more long orders than people have."""


def fitted(measured: Sequence[Row], planner: str) -> dict[str, float]:
    """A logistic regression of whether the first vote was right."""
    used = _used(measured, planner)
    x = np.array([[each["features"].get(name, 0.0) for name in used] for each in measured])
    y = np.array([_right(each, planner) for each in measured])
    counts = np.array([_counts(each, planner) for each in measured])
    middle, wide = x.mean(0), x.std(0) + 1e-9
    standard = (x - middle) / wide

    def loss(weights: NDArray[np.float64]) -> tuple[float, NDArray[np.float64]]:
        total = standard @ weights[1:] + weights[0]
        own = counts * (np.logaddexp(0, total) - y * total)
        drawn = PULL[planner] * weights[1:]
        steep = counts * (1 / (1 + np.exp(-total)) - y)
        slope = np.concatenate([[steep.sum()], standard.T @ steep + drawn])
        return float(own.sum() + (drawn * weights[1:]).sum() / 2), slope

    weights = minimize(loss, np.zeros(len(used) + 1), jac=True, method="L-BFGS-B").x
    slopes = weights[1:] / wide
    plain = {name: round(float(slope), 5) for name, slope in zip(used, slopes, strict=True)}
    return {"bias": round(float(weights[0] - (slopes * middle).sum()), 5), **plain}


def _used(measured: Sequence[Row], planner: str) -> list[str]:
    """The names of the features that count."""
    seen = Counter(name for each in measured for name in each["features"])
    read = sorted(name for name in seen if name.startswith(READ) and seen[name] >= OFTEN_ENOUGH)
    return [*USED[planner], *(read if planner == "grammar" else ())]


def _right(each: Row, planner: str) -> float:
    """How likely the first vote was right; of those that do something else than the author's
    program, a share is right, too."""
    also_right = RIGHT_IN_ANOTHER_WAY if planner == "model" else 0.0
    return 1.0 if each["right"][0] else also_right


def _counts(each: Row, planner: str) -> float:
    return OF_THE_CORPUS if planner == "grammar" and not each.get("read") else 1.0


def probability(weights: dict[str, float], each: Row) -> float:
    known = {"bias": 1.0, **each["features"]}
    total = sum(weight * known.get(name, 0.0) for name, weight in weights.items())
    return float(1 / (1 + np.exp(-total)))


def tried(measured: Sequence[Row], planner: str) -> Iterator[str]:
    """How true the probabilities are on halves that they were not fitted to."""
    halves = measured[::2], measured[1::2]
    told = [
        (probability(weights, each), _right(each, planner))
        for learned, other in (halves, halves[::-1])
        for weights in (fitted(learned, planner),)
        for each in other
    ]
    for low, high in ((0.0, 0.3), (0.3, 0.5), (0.5, 0.7), (0.7, 0.85), (0.85, 1.01)):
        mine = [(p, right) for p, right in told if low <= p < high]
        if mine:
            said = sum(p for p, _ in mine) / len(mine)
            was = sum(right for _, right in mine) / len(mine)
            yield f"said {said:.2f}, were right {was:.2f} ({len(mine)})"
    accepted = {"model": ACCEPTED, "grammar": SURE_OF_RULES}[planner]
    shown = [right for p, right in told if p >= accepted]
    yield f"shown from {accepted} on: {sum(shown):.0f} right, {len(shown) - sum(shown):.0f} wrong"


def read_by_somebody() -> list[Row]:
    """What rules made of sentences that people have typed, where it is what somebody has judged by
    reading it (`typed.jsonl`): what became something else since is not known to be right. And what
    they make of each as fingers in a hurry type it: right if that is the same."""
    worlds, chance = functools.cache(_world), random.Random(2)
    rows: list[Row] = []
    for line in TYPED.read_text("utf-8").splitlines():
        typed = json.loads(line)
        lexicon = worlds(typed["world"]).lexicon(typed["language"])
        names = frozenset(
            word.lower()
            for each in (*lexicon.people, *lexicon.places)
            for word in each.name.split()
        )
        hurried = as_typed(typed["say"], chance, names)
        for say in dict.fromkeys((typed["say"], hurried)):
            turn = Turn(say, lexicon, load_language(typed["language"]), Context())
            answer = planner("grammar").plan(turn, Watch())
            made = consider(turn, answer.drafts[0]) if isinstance(answer, Drafts) else None
            same = made is not None and made.program == typed["program"]
            if say == typed["say"] and not same:
                break
            if made is not None:
                known = features_alone(turn, made)
                rows.append({"features": known, "right": [typed["right"] and same], "read": True})
    return rows


def _world(name: str) -> Knowledge:
    return Knowledge(load_world(name, names_only=True))


def _learned() -> str:
    """What the language model that is used here has learned, as `evaluate` notes it."""
    folder = installed_model()
    changes = learned(folder.name) if folder is not None else None
    return file_digest(changes) if changes is not None else ""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--planner", default="model", choices=USED)
    parser.add_argument("--most", type=int, default=120)
    parser.add_argument("--also", type=Path, help="what tests/errands/planned.py has measured")
    given = parser.parse_args()
    items = [item for item in load(files()) if given.planner != "model" or is_held_out(item)]
    random.Random(0).shuffle(items)
    of = _learned() if given.planner == "model" else ""
    measured = measure(items[: given.most], planner(given.planner), given.out, of)
    print(*table(scores(measured, "language")), sep="\n")
    if given.also is not None:
        also = [json.loads(line) for line in given.also.read_text().splitlines()]
        print("families:", *table(scores(also, "language")), sep="\n")
        measured = [*measured, *also]
    drafted = [each for each in measured if each["outcome"] == "drafts"]
    random.Random(1).shuffle(drafted)
    if given.planner == "grammar":
        typed = read_by_somebody()
        print(f"{len(typed)} drafts for typed sentences, {sum(r['right'][0] for r in typed)} right")
        drafted = [*drafted, *typed]
        random.Random(1).shuffle(drafted)
    print(*tried(drafted, given.planner), sep="\n")
    known = json.loads(WEIGHTS.read_text("utf-8"))
    known[given.planner] = fitted(drafted, given.planner)
    WEIGHTS.write_text(json.dumps(known, indent=2) + "\n", "utf-8")


if __name__ == "__main__":
    main()
