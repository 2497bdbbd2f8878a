"""What the probabilities of a planner mean.

    python -m nl2robot.training.planner.calibrate OUT.jsonl [--planner model] [--also FILE]

What became of sentences (`evaluate`; OUT grows line by line and is gone on from) is told in a
table, and a logistic regression is fitted to one half of it and tried on the other; fitted to both
it goes to `nl2robot/data/confidence.json` (`nl2robot.deliberation.confidence`).
"""

from __future__ import annotations

import argparse
import json
import random
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from nl2robot.deliberation.confidence import WEIGHTS
from nl2robot.deliberation.deciding import ACCEPTED
from nl2robot.training.planner.corpus import files, load
from nl2robot.training.planner.evaluate import Row, measure, scores, table
from nl2robot.training.planner.examples import is_held_out
from nl2robot.training.planner.export import file_digest
from nl2robot.translate.planners import installed_model, learned, planner

USED: Final = {
    "model": ("surest", "score", "branches", "hardly asked"),
    "grammar": ("lines", "words", "unused words", "unasked", "unheeded", "branches", "remarks"),
}
"""Features that count, chosen one by one as long as the probabilities of drafts that they were not
fitted to became truer. Of rules there are more, since they have learned from none of the corpus."""
RIGHT_IN_ANOTHER_WAY: Final = 0.19
"""The share of drafts of the model that do something else than the author's program and are right:
nine of 47 that somebody has read. Of rules, that do less of what was not said, none is assumed."""
PULL: Final = 5.0
"""How strongly weights are drawn towards nothing, of standardised features."""


def fitted(
    measured: Sequence[Row], used: Sequence[str], also_right: float = 0.0
) -> dict[str, float]:
    """A logistic regression of whether the first vote was right; of those that do something else
    than the author's program, a share is right, too."""
    x = np.array([[each["features"][name] for name in used] for each in measured])
    y = np.array([1.0 if each["right"][0] else also_right for each in measured])
    middle, wide = x.mean(0), x.std(0) + 1e-9
    standard = (x - middle) / wide

    def loss(weights: NDArray[np.float64]) -> float:
        total = standard @ weights[1:] + weights[0]
        own = np.logaddexp(0, total) - y * total
        return float(own.sum() + PULL * (weights[1:] ** 2).sum() / 2)

    weights = minimize(loss, np.zeros(len(used) + 1)).x
    slopes = weights[1:] / wide
    plain = {name: round(float(slope), 5) for name, slope in zip(used, slopes, strict=True)}
    return {"bias": round(float(weights[0] - (slopes * middle).sum()), 5), **plain}


def probability(weights: dict[str, float], each: Row) -> float:
    known = each["features"]
    total = sum(weight * known.get(name, 1.0) for name, weight in weights.items())
    return float(1 / (1 + np.exp(-total)))


def tried(measured: Sequence[Row], used: Sequence[str], also_right: float) -> Iterator[str]:
    """How true the probabilities are on halves that they were not fitted to."""
    halves = measured[::2], measured[1::2]
    told = [
        (
            probability(fitted(learned, used, also_right), each),
            1.0 if each["right"][0] else also_right,
        )
        for learned, other in (halves, halves[::-1])
        for each in other
    ]
    for low, high in ((0.0, 0.3), (0.3, 0.5), (0.5, 0.7), (0.7, 0.85), (0.85, 1.01)):
        mine = [(p, right) for p, right in told if low <= p < high]
        if mine:
            said = sum(p for p, _ in mine) / len(mine)
            was = sum(right for _, right in mine) / len(mine)
            yield f"said {said:.2f}, were right {was:.2f} ({len(mine)})"
    shown = [right for p, right in told if p >= ACCEPTED]
    yield f"shown from {ACCEPTED} on: {sum(shown):.0f} right, {len(shown) - sum(shown):.0f} wrong"


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
    used = USED[given.planner]
    also_right = RIGHT_IN_ANOTHER_WAY if given.planner == "model" else 0.0
    print(*tried(drafted, used, also_right), sep="\n")
    known = json.loads(WEIGHTS.read_text("utf-8"))
    known[given.planner] = fitted(drafted, used, also_right)
    WEIGHTS.write_text(json.dumps(known, indent=2) + "\n", "utf-8")


if __name__ == "__main__":
    main()
