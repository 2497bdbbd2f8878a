"""What a planner makes of sentences of the families that the rules refuse, for
`nl2robot.training.planner.calibrate --also`.

    python -m tests.errands.planned OUT.jsonl [--planner model] [--most 60]

The families are judged by what happens in their own scenes, and nobody has learned from them.
"""

from __future__ import annotations

import argparse
import json
import random
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from grammar.language import load_language
from grammar.planning.planner import Drafts, Watch
from grammar.planning.turn import Turn
from nl2robot.deliberation.confidence import features
from nl2robot.deliberation.voting import Vote, count
from nl2robot.translate.planners import planner
from nl2robot.translate.translation import translate
from tests.errands.families import Family, carried_out, families, knowledge, misses


def refused_by_rules(chance: random.Random) -> Iterator[tuple[Family, str]]:
    """A sentence of each family, as far as the rules refuse it."""
    all_families = list(families())
    chance.shuffle(all_families)
    for family in all_families:
        sentence, _ = chance.choice(list(family.all_sentences()))
        known = knowledge(family.world)
        if translate(sentence, known, family.language, "grammar").program is None:
            yield family, sentence


def measured(family: Family, sentence: str, name: str) -> dict[str, Any]:
    known = knowledge(family.world)
    turn = Turn(sentence, known.lexicon(family.language), load_language(family.language))
    began = time.monotonic()
    answer = planner(name).plan(turn, Watch())
    told: dict[str, Any] = {
        "where": family.family,
        "language": family.language,
        "say": sentence,
        "way_out": False,
        "seconds": round(time.monotonic() - began, 2),
    }
    if not isinstance(answer, Drafts):
        return {**told, "outcome": type(answer).__name__.lower()}
    votes = count(turn, answer.drafts, known)
    if not votes.votes:
        return {**told, "outcome": "dropped"}
    return {
        **told,
        "outcome": "drafts",
        "drafts": [each.context.written for each in answer.drafts],
        "right": [_is_right(family, vote) for vote in votes.votes],
        "features": features(turn, votes.votes[0], votes),
    }


def _is_right(family: Family, vote: Vote) -> bool:
    world = knowledge(family.world).world
    for case in family.cases:
        events, end = carried_out(vote.first.program, case.scene(world))
        if misses(case, events, end) is not None:
            return False
    return True


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("out", type=Path)
    parser.add_argument("--planner", default="model")
    parser.add_argument("--most", type=int, default=60)
    given = parser.parse_args()
    with given.out.open("w") as written:
        for number, (family, sentence) in enumerate(refused_by_rules(random.Random(0))):
            if number >= given.most:
                break
            written.write(json.dumps(measured(family, sentence, given.planner)) + "\n")
            written.flush()


if __name__ == "__main__":
    main()
