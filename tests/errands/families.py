"""Families of errands: many ways to ask for the same, judged by what comes of it.

    python -m tests.errands.families [FILE ...] [--misses] [--all] [--part PATTERN]

A family is a YAML file, or one of several documents (`---`) of it:

    family: which rooms lack something
    language: en
    world: building.yaml               # or a built-in one: household
    sentences:                         # every way to put the parts together is one
      - "<check>, <report>"
    parts:
      check: [check every copy room for a stapler, ...]
      report: [come back and tell me which ones do not have one, ...]
    cases:                             # the same sentence in different scenes
      - things: {stapler: [copy room 1, copy room 3]}
        people: {Bob: Bob's office}    # who is not named here is nowhere
        answers: {Bob: {coffee: "yes", "": "no"}}    # by pattern of the question, or just "yes"
        arrivals: {elevator: [Zoe, Max]}
        traits: {Zoe: visitor}
        clock: "10:00"
        ends: done                     # or "over", of what goes on until it is stopped
        expect:                        # in this order, with others in between
          - all: [{visits: copy room 1}, {visits: copy room 2}, {visits: copy room 3}]  # any order
          - {says: copy room 2, not: "copy room 1|copy room 3", at: start, whom: operator}
        never: [{says: could not}]
        count: {takes: 0}

What is expected of an event is a regular expression, found anywhere in it, upper and lower case
alike; `at` and `whom` are names. A sentence is right if it does as expected in all cases, wrong if
it becomes a program that does not, and refused if it becomes none.
"""

from __future__ import annotations

import argparse
import itertools
import math
import random
import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Literal

import msgspec
import yaml

from nl2robot.deliberation.paper_robot import Event, Over, PaperRobot, Scene
from nl2robot.knowledge import Knowledge
from nl2robot.translate.outcome import Translation
from nl2robot.translate.translation import translate
from sim.world.loading import load_world
from sim.world.model import World

FOLDER = Path(__file__).parent
LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
"""Every worker reads all families before the first test."""
MOST = 60
"""Sentences of a family that are drawn, always the same, unless all are asked for."""
FEW = 8
"""Of these the first, which are tried at every change; all of them in `make soak`."""

Verdict = Literal["right", "wrong", "refused"]


class Case(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    expect: tuple[dict[str, Any], ...]
    never: tuple[dict[str, str], ...] = ()
    count: dict[str, int] = {}
    """How many events of a kind there must be."""
    things: dict[str, str | list[str]] = {}
    people: dict[str, str] = {}
    answers: dict[str, Any] = {}
    arrivals: dict[str, list[str]] = {}
    traits: dict[str, str] = {}
    clock: str = "10:00"
    weekday: str = "Tuesday"
    battery: int = 80
    ends: str = "done"
    """How the program ends: "done", or "over" where it goes on until it is stopped."""

    def scene(self, world: World) -> Scene:
        things = [
            (what, place)
            for what, where in self.things.items()
            for place in ([where] if isinstance(where, str) else where)
        ]
        return Scene(
            places={place.name: place.kind for place in world.places},
            people=dict(self.people),
            things=things,
            answers=self.answers,
            arrivals={place: list(who) for place, who in self.arrivals.items()},
            traits=self.traits,
            clock=self.clock,
            weekday=self.weekday,
            battery=self.battery,
        )


class Family(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    family: str
    sentences: tuple[str, ...]
    cases: tuple[Case, ...]
    parts: dict[str, tuple[str, ...]] = {}
    language: str = "en"
    world: str = "building.yaml"
    least: float = 0.0
    """The share of its sentences that is right by now; the tests do not let it sink."""
    most_wrong: float = 1.0
    """The share that becomes a wrong program by now."""

    def all_sentences(self) -> Iterator[tuple[str, tuple[str, ...]]]:
        """Every sentence, with the alternatives that it is made of."""
        for pattern in self.sentences:
            names = re.findall(r"<([^<>]+)>", pattern)
            for chosen in itertools.product(*(self.parts[name] for name in names)):
                sentence = pattern
                for name, words in zip(names, chosen, strict=True):
                    sentence = sentence.replace(f"<{name}>", words, 1)
                yield _capitals(sentence), chosen

    def drawn(self, most: int | None = MOST) -> list[tuple[str, tuple[str, ...]]]:
        found = list(self.all_sentences())
        if most is None or len(found) <= most:
            return found
        return random.Random(self.family).sample(found, most)


def _capitals(text: str) -> str:
    return re.sub(r"(^|[.?!] )(\w)", lambda found: found[1] + found[2].upper(), text)


@dataclass(frozen=True)
class Judged:
    sentence: str
    chosen: tuple[str, ...]
    """The alternatives of its parts."""
    verdict: Verdict
    why: str
    program: str | None


@cache
def knowledge(world: str) -> Knowledge:
    """A built-in world, or a file of this folder; without its map, for nobody drives there."""
    file = FOLDER / world
    return Knowledge(load_world(file if file.is_file() else world, names_only=True))


def load(file: Path) -> list[Family]:
    return [
        msgspec.convert(document, Family)
        for document in yaml.load_all(file.read_text(encoding="utf-8"), Loader=LOADER)
        if document
    ]


def families(files: Iterable[Path] | None = None) -> list[Family]:
    found = sorted(FOLDER.glob("*/*.yaml")) if files is None else list(files)
    return [family for file in found for family in load(file)]


def judged(family: Family, sentence: str, chosen: tuple[str, ...] = ()) -> Judged:
    known = knowledge(family.world)
    translation: Translation = translate(sentence, known, family.language)
    if translation.program is None:
        return Judged(sentence, chosen, "refused", str(translation.message), None)
    for number, case in enumerate(family.cases, 1):
        events, end = carried_out(translation.program, case.scene(known.world))
        fault = misses(case, events, end)
        if fault is not None:
            course = "".join(f"\n      {event}" for event in events[:25])
            why = f"case {number}: {fault}; it was ({end}):{course}"
            return Judged(sentence, chosen, "wrong", why, translation.program)
    return Judged(sentence, chosen, "right", "", translation.program)


def carried_out(program: str, scene: Scene) -> tuple[list[Event], str]:
    """What the program does in the scene, and how it ended: "done", "over" or why it failed. The
    rules' own programs are run as they are; a thousand a second."""
    robot = PaperRobot(scene)
    random.seed(0)
    try:
        exec(program, {"robot": robot, "math": math})
    except Over:
        return robot.events, "over"
    except Exception as error:  # noqa: BLE001 (whatever a program stumbles over is its end)
        return robot.events, f"{type(error).__name__}: {error}"
    return robot.events, "done"


def misses(case: Case, events: Sequence[Event], end: str) -> str | None:
    """What a run lacks; None if nothing."""
    if end != case.ends:
        return f"the program ended as {end}"
    rest = list(events)
    for expected in case.expect:
        wanted = expected.get("all", [expected])
        last = -1
        for each in wanted:
            at = next((i for i, event in enumerate(rest) if matches(event, each)), None)
            if at is None:
                return f"{each} did not come in its turn"
            last = max(last, at)
        rest = rest[last + 1 :]
    for unwanted in case.never:
        if any(matches(event, unwanted) for event in events):
            return f"{unwanted} happened"
    counts = Counter(event.kind for event in events)
    for kind, number in case.count.items():
        if counts[kind] != number:
            return f"{kind} happened {counts[kind]} times, not {number}"
    return None


def matches(event: Event, wanted: Mapping[str, str]) -> bool:
    for key, value in wanted.items():
        if key in ("at", "whom"):
            if getattr(event, key).lower() != value.lower():
                return False
        elif key == "not":
            if re.search(value, event.what, re.IGNORECASE):
                return False
        elif event.kind != key or not re.search(value, event.what, re.IGNORECASE):
            return False
    return True


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--misses", action="store_true", help="show what is not right")
    parser.add_argument("--all", action="store_true", help="every sentence, not a sample")
    parser.add_argument("--part", help="only sentences that this pattern is found in")
    given = parser.parse_args()
    total: Counter[str] = Counter()
    for family in families(given.files or None):
        drawn = family.drawn(None if given.all else MOST)
        if given.part:
            drawn = [each for each in drawn if re.search(given.part, each[0], re.IGNORECASE)]
        if not drawn:
            continue
        found = [judged(family, *each) for each in drawn]
        verdicts = Counter(each.verdict for each in found)
        total += verdicts
        print(f"{family.family} ({family.language})".ljust(60), told(verdicts))
        if not given.misses:
            continue
        for each in found:
            if each.verdict != "right":
                print(f"  [{each.verdict}] {each.sentence}\n    {each.why}")
                if each.program:
                    print("    | " + each.program.rstrip().replace("\n", "\n    | "))
        print("  by part, not right:")
        tries: dict[str, Counter[str]] = defaultdict(Counter)
        for each in found:
            for words in each.chosen:
                tries[words][each.verdict] += 1
        rows = sorted(tries.items(), key=lambda row: row[1]["right"] / row[1].total())
        for words, verdict in rows[:12]:
            print(f"    {told(verdict)}  {words}")
    print("all".ljust(60), told(total))


def told(verdicts: Counter[str]) -> str:
    count = verdicts.total() or 1
    shares = (f"{name} {100 * verdicts[name] / count:3.0f} %" for name in ("right", "wrong"))
    return f"{count:4d} {'  '.join(shares)}"


if __name__ == "__main__":
    main()
