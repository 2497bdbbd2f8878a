"""Is the corpus sound?  `python -m nl2robot.training.planner.check [FILE ...] [--show]`

Every program has to be one that the model is allowed to write for this sentence in this world, and
has to run in the scenes that are made for it. With `--show`, what happens there is printed.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

from grammar.language import load_language
from grammar.planning.model.expansion import expanded
from grammar.planning.model.prompt import hints, vocabulary
from grammar.planning.model.recogniser import CLARIFY, REFUSE, Partial
from grammar.prepared import forget
from grammar.program import write_program
from nl2robot.deliberation.paper_robot import Event
from nl2robot.deliberation.playing import played
from nl2robot.deliberation.staging import scenes
from nl2robot.training.planner.corpus import CORPUS, Item, files, knowledge, load

SHOWN = 14
WAYS_OUT = (f"{REFUSE}(", f"{CLARIFY}(")


def problems(item: Item, show: bool = False) -> Iterator[str]:
    """What is wrong with an item."""
    lexicon = knowledge(item.world).lexicon(item.language)
    language = load_language(item.language)
    forget()
    turn = item.turn
    words = vocabulary(turn)
    if show:
        print(f"\n{item.where} [{item.language}] {item.say}\n  ({hints(turn)})")
        print("    " + item.do.replace("\n", "\n    "))
    draft: Partial | None = Partial.begin(words)
    for at, letter in enumerate(item.do):
        assert draft is not None
        draft = draft.extended(letter)
        if draft is None:
            yield f"the dialect does not allow {item.do[: at + 1].splitlines()[-1]!r}"
            return
    assert draft is not None
    if not draft.is_whole:
        yield "the program is not finished, or something that was found out is never used"
        return
    if item.do.startswith(WAYS_OUT):
        return
    plan = expanded(item.do, words.people, lexicon, language)
    program = write_program(plan)
    for number, scene in enumerate(scenes(lexicon, [program], words.people), 1):
        course = played(program, scene)
        if show:
            print(f"  scene {number}: {_told(course.events)} ({course.end} {course.message})")
        if number == 1 and course.end == "failed":
            yield f"where everything is at its place, it fails: {course.message}"


def _told(events: tuple[Event, ...]) -> str:
    told = [str(event) for event in events if event.kind != "looks for"]
    return "; ".join(told[:SHOWN]) + ("; ..." if len(told) > SHOWN else "")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--show", action="store_true", help="print what happens")
    given = parser.parse_args()
    bad = 0
    said: Counter[str] = Counter()
    count = 0
    for item in load(given.files or files()):
        count += 1
        said[item.say.lower()] += 1
        if said[item.say.lower()] == 2 and item.after is None:
            print(f"{item.where}: this was said before: {item.say}")
        for problem in problems(item, given.show):
            bad += 1
            print(f"{item.where}: {item.say}\n    {problem}")
    print(f"{count} items, {bad} problems")
    return 1 if bad else 0


__all__ = ["CORPUS", "problems"]

if __name__ == "__main__":
    sys.exit(main())
