"""How good the language model is on sentences that it has not learned from, and what its
probabilities mean.

    python -m nl2robot.training.planner.calibrate OUT.jsonl [--planner model] [--also FILE]

Each held-out sentence of the corpus is planned as `nl2robot translate` would do it, and what the
program does in a few scenes is compared with what the program of the corpus does there. OUT grows
line by line and is gone on from. In the end a table is printed, and a logistic regression is
fitted to one half and tried on the other; fitted to both it goes to `nl2robot/data/confidence.json`
(`nl2robot.deliberation.confidence`).
"""

from __future__ import annotations

import argparse
import json
import random
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from grammar.normal import normal
from grammar.planning.model.expansion import expanded
from grammar.planning.model.prompt import vocabulary
from grammar.planning.planner import Draft, Drafts, Watch
from grammar.planning.turn import Turn
from grammar.program_parser import NotAPlan
from nl2robot.deliberation.confidence import WEIGHTS, features
from nl2robot.deliberation.considering import consider
from nl2robot.deliberation.deciding import ACCEPTED
from nl2robot.deliberation.voting import count, same
from nl2robot.training.planner.corpus import Item, files, knowledge, load
from nl2robot.training.planner.examples import is_held_out
from nl2robot.translate.planners import planner

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

Measured = dict[str, Any]


def measure(items: Sequence[Item], name: str, out: Path) -> list[Measured]:
    """What became of each of these; what `out` holds already is not done again."""
    known = [json.loads(line) for line in out.read_text().splitlines()] if out.exists() else []
    done = {each["where"] for each in known}
    with out.open("a") as written:
        for item in items:
            if item.where not in done:
                began = time.monotonic()
                each = {"where": item.where, "language": item.language, **_measured(item, name)}
                each["seconds"] = round(time.monotonic() - began, 2)
                known.append(each)
                written.write(json.dumps(each, ensure_ascii=False) + "\n")
                written.flush()
    return known


def _measured(item: Item, name: str) -> Measured:
    turn = item.turn
    answer = planner(name).plan(turn, Watch())
    wanted = _wanted(item, turn)
    told: Measured = {"say": item.say, "wanted": item.do, "way_out": wanted is None}
    if not isinstance(answer, Drafts):
        return {**told, "outcome": type(answer).__name__.lower(), "message": str(answer)}
    told["drafts"] = [each.context.written for each in answer.drafts]
    votes = count(turn, answer.drafts, knowledge(item.world))
    if not votes.votes:
        objections = [
            f"{each.kind}: {each.about}" for it in votes.dropped for each in it.checked.objections
        ]
        return {**told, "outcome": "dropped", "objections": objections}
    right = [wanted is not None and _does(turn, vote.first.draft, wanted) for vote in votes.votes]
    return {
        **told,
        "outcome": "drafts",
        "right": right,
        "shares": [round(each.share, 4) for each in votes.votes],
        "features": features(turn, votes.votes[0], votes),
    }


def _wanted(item: Item, turn: Turn) -> Draft | None:
    """The program of the corpus as a draft; None for a way out."""
    try:
        plan = normal(expanded(item.do, vocabulary(turn).people, turn.lexicon, turn.language))
    except NotAPlan:
        return None
    return Draft(plan, "corpus", 1.0, turn.context)


def _does(turn: Turn, draft: Draft, wanted: Draft) -> bool:
    """Whether a draft does what was wanted."""
    one, other = consider(turn, draft), consider(turn, wanted)
    return one is not None and other is not None and same(turn, one, other)


# --- what it says


def table(measured: Sequence[Measured]) -> Iterator[str]:
    """Right, wrong and no programs, by language."""
    for language in (*sorted({each["language"] for each in measured}), "all"):
        mine = [each for each in measured if language in ("all", each["language"])]
        counted = Counter(_outcome(each) for each in mine if not each["way_out"])
        ways = [each for each in mine if each["way_out"]]
        refused = sum(1 for each in ways if each["outcome"] != "drafts")
        seconds = sorted(each["seconds"] for each in mine)
        yield (
            f"{language:4} {sum(counted.values()):4} programs: "
            + ", ".join(f"{name} {number}" for name, number in sorted(counted.items()))
            + f"; {refused} of {len(ways)} ways out; {seconds[len(seconds) // 2]} s median"
        )


def _outcome(each: Measured) -> str:
    if each["outcome"] != "drafts":
        return str(each["outcome"])
    return "right" if each["right"][0] else "wrong, a vote right" if any(each["right"]) else "wrong"


# --- what its probabilities mean


def fitted(
    measured: Sequence[Measured], used: Sequence[str], also_right: float = 0.0
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


def probability(weights: dict[str, float], each: Measured) -> float:
    known = each["features"]
    total = sum(weight * known.get(name, 1.0) for name, weight in weights.items())
    return float(1 / (1 + np.exp(-total)))


def tried(measured: Sequence[Measured], used: Sequence[str], also_right: float) -> Iterator[str]:
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


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--planner", default="model", choices=USED)
    parser.add_argument("--most", type=int, default=120)
    parser.add_argument("--also", type=Path, help="what tests/errands/planned.py has measured")
    given = parser.parse_args()
    items = [item for item in load(files()) if given.planner != "model" or is_held_out(item)]
    random.Random(0).shuffle(items)
    measured = measure(items[: given.most], given.planner, given.out)
    print(*table(measured), sep="\n")
    if given.also is not None:
        also = [json.loads(line) for line in given.also.read_text().splitlines()]
        print("families:", *table(also), sep="\n")
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
