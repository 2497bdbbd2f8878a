"""What a person should think about before approving a program, marked on its lines.

A risk stands in nobody's way: what this robot cannot do is an error of `nl2robot.review.policy`.
Some are seen in the program itself, in what is written with fixed values; others only in the dry
run.
"""

from __future__ import annotations

import ast
import bisect
import functools
import itertools
import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import TYPE_CHECKING, Any, Final, Literal

import msgspec

from grammar.language import load_language
from grammar.naming import naming
from nl2robot.knowledge import Knowledge
from nl2robot.review import endless
from nl2robot.review.policy import robot_calls
from nl2robot.texts import texts_in
from robot_api.limits import loudest
from robot_api.methods import METHODS
from sim.world.model import World, key
from sim.world.zones import distance_to

if TYPE_CHECKING:
    from nl2robot.review.rehearsal import Call, Course, DryRun
    from sim.record import Sample
    from sim.simulation import Simulation


WALKING_PACE: Final = 1.2
"""m/s."""
FAST_NEAR_PEOPLE: Final = 0.6
"""m/s."""
NEAR: Final = 1.0
"""Metres between the middles of the robot and a person."""
NIGHT: Final = (22, 6)
"""From this hour on, until that one."""
LOUD_AT_NIGHT: Final = 50
"""Percent of the volume, from which on it wakes people."""
LONG: Final = 300.0
"""Seconds."""
MOMENT: Final = 1e-3
"""Seconds by which the times of a record are rounded."""
KEEPS_AWAY: Final = 0.25
"""Metres from a zone within which a robot has no room to stand."""

_AREAS: Final = frozenset({"ward", "department", "unit", "station", "clinic", "floor", "building"})
"""Kinds of places that one leaves."""
_TO_PEOPLE: Final = frozenset({"give", "guide", "follow", "ask"})
_STEERED_BY_HAND: Final = frozenset({"drive", "move"})
_SPEECH: Final = frozenset({"say", "ask", "listen", "answer"})

Kind = Literal["leaves", "zone", "speed", "volume", "person", "long", "endless", "unproven"]
_Found = Iterator[tuple[int, Kind, str, dict[str, str]]]
"""Line, kind, which text, and what to fill in."""


class Risk(msgspec.Struct, frozen=True):
    """Something to think about, and where it is in the program."""

    line: int
    kind: Kind
    text: str
    """In the language of the review."""


@dataclass(frozen=True)
class Situation:
    """What the program would begin with."""

    world: World
    """With the keep-out zones of this moment."""
    place: str | None
    volume: int
    clock: datetime
    seconds: float
    """The simulation's time."""

    @classmethod
    def of(cls, simulation: Simulation) -> Situation:
        robot = simulation.robot
        return cls(simulation.world, robot.place, robot.volume, simulation.clock(), simulation.time)

    def clock_at(self, seconds: float) -> datetime:
        """What the clock shows at that time of the simulation."""
        return self.clock + timedelta(seconds=seconds - self.seconds)


@dataclass(frozen=True)
class Tried:
    """What became of the program in its dry run."""

    situation: Situation
    dry_run: DryRun
    course: Course


def risks(
    program: str, knowledge: Knowledge, language: str = "en", tried: Tried | None = None
) -> tuple[Risk, ...]:
    """What is risky about a program, in order of lines; of a kind once a line. A program that is
    no Python has none: the check says that."""
    try:
        tree = ast.parse(program)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return ()
    looking = _Looking(tree, knowledge, tried)
    called = naming(knowledge.lexicon(language), load_language(language)).called
    texts = _texts(language)
    found: dict[tuple[int, Kind], str] = {}
    for line, kind, text, values in looking.found():
        named = {
            name: called(value) if name in ("area", "place") else value
            for name, value in values.items()
        }
        found.setdefault((line, kind), texts[text].format(**named))
    return tuple(Risk(*place, text) for place, text in sorted(found.items(), key=_line))


def _line(risk: tuple[tuple[int, Kind], str]) -> int:
    return risk[0][0]


class _Looking:
    """Looks at one program."""

    def __init__(self, tree: ast.Module, knowledge: Knowledge, tried: Tried | None) -> None:
        self.tree = tree
        self.knowledge = knowledge
        self.tried = tried
        self.world = tried.situation.world if tried else knowledge.world
        self.written = [
            (call.lineno, method.name, arguments) for call, method, arguments in robot_calls(tree)
        ]
        self.done: tuple[Call, ...] = tried.course.calls if tried else ()

    def found(self) -> _Found:
        yield from self.zone_goals()
        yield from self.fast()
        yield from self.unknown_people()
        yield from self.endless()
        yield from self.too_loud()
        if self.tried is not None:
            yield from self.leaves(self.tried)
            yield from self.zones_on_the_way(self.tried)
            yield from self.near_people(self.tried)
            yield from self.loud(self.tried)
            yield from self.long(self.tried)
            yield from self.unproven(self.tried.dry_run)
        else:
            yield from self.long_waits()

    # --- where it goes

    def goals(self) -> Iterator[tuple[int, str]]:
        """The places that are written to be gone to."""
        for line, method, arguments in self.written:
            goal = arguments.get("to" if method == "follow" else "place")
            place = self.world.place(goal) if isinstance(goal, str) else None
            if place is not None and METHODS[method].moves:
                yield line, place.name

    def leaves(self, tried: Tried) -> _Found:
        """The first line by which the robot is out of the ward, department or floor it is in."""
        area = _area_of(self.world, tried.situation.place)
        if area is None:
            return
        left = (
            (line, place)
            for line, place in itertools.chain(self.goals(), self.arrivals(tried))
            if _is_outside(self.world, area, place)
        )
        first = min(left, key=lambda found: found[0], default=None)
        if first is not None:
            line, place = first
            yield line, "leaves", "leaves", {"area": area, "place": place}

    def arrivals(self, tried: Tried) -> Iterator[tuple[int, str]]:
        """The lines of the dry run's movements, and the places in which they end."""
        samples = tried.course.record.samples
        times = [sample.time for sample in samples]
        for call in self.done:
            latest = bisect.bisect_right(times, call.ended + MOMENT)
            if latest and METHODS[call.method].moves:
                last = samples[latest - 1]
                place = self.world.place_at(last.x, last.y)
                if place is not None:
                    yield call.line, place.name

    def zone_goals(self) -> _Found:
        for line, name in self.goals():
            place = self.world.place(name)
            if place is not None and place.pose is not None:
                yield from self.zones_at(line, name, place.pose.x, place.pose.y)
        for line, method, arguments in self.written:
            x, y = arguments.get("x"), arguments.get("y")
            if method == "goto" and isinstance(x, int | float) and isinstance(y, int | float):
                yield from self.zones_at(line, f"{x:g}, {y:g}", x, y)

    def zones_at(self, line: int, place: str, x: float, y: float) -> _Found:
        for zone in self.world.zones:
            if distance_to(zone.polygon, x, y) < KEEPS_AWAY:
                yield line, "zone", "zone_goal", {"place": place, "zone": zone.name}

    def zones_on_the_way(self, tried: Tried) -> _Found:
        told = tried.dry_run.message or ""
        for zone in self.world.zones:
            if tried.dry_run.line is not None and f'keep-out zone "{zone.name}"' in told:
                yield tried.dry_run.line, "zone", "zone_way", {"zone": zone.name}
        for call, (here, there) in self.steps(tried):
            zone_here = self.world.zone_at(here.x, here.y)
            if zone_here is not None and (here.x, here.y) != (there.x, there.y):
                yield call.line, "zone", "zone_inside", {"zone": zone_here.name}

    # --- how it drives

    def fast(self) -> _Found:
        for line, method, arguments in self.written:
            speed = arguments.get("linear")
            if method == "drive" and isinstance(speed, int | float) and abs(speed) > WALKING_PACE:
                yield line, "speed", "fast", {"speed": f"{abs(speed):g}"}

    def near_people(self, tried: Tried) -> _Found:
        """Somebody may step into the way of a robot that is steered by a line of a program."""
        names = tried.course.record.people
        for call, (here, there) in self.steps(tried):
            if call.method not in _STEERED_BY_HAND:
                continue
            speed = math.dist((here.x, here.y), (there.x, there.y)) / (there.time - here.time)
            for name, spot in zip(names, there.people, strict=False):
                if speed > FAST_NEAR_PEOPLE and math.dist(spot, (there.x, there.y)) < NEAR:
                    yield call.line, "speed", "fast_near", {"speed": f"{speed:.1f}", "person": name}

    def steps(self, tried: Tried) -> Iterator[tuple[Call, tuple[Sample, Sample]]]:
        """Where the robot was from one moment of the dry run to the next, and by which call."""
        calls = iter(call for call in self.done if METHODS[call.method].moves)
        call = next(calls, None)
        for here, there in itertools.pairwise(tried.course.record.samples):
            while call is not None and call.ended < there.time:
                call = next(calls, None)
            if call is None:
                return
            if call.began <= here.time:
                yield call, (here, there)

    # --- whom and how it speaks

    def unknown_people(self) -> _Found:
        """Names that nobody here has; "nurse" or "man waving" is no name."""
        people = self.knowledge.lexicon("en").people
        known = {word for each in people for name in _names(each) for word in key(name).split()}
        for line, method, arguments in self.written:
            person = arguments.get("person")
            if method in _TO_PEOPLE and isinstance(person, str) and person[:1].isupper():
                words = key(person).split()
                if self.world.person(person) is None and not known.intersection(words):
                    yield line, "person", "person", {"person": person}

    def too_loud(self) -> _Found:
        """What this robot will say less loudly than it is asked to."""
        robot = self.knowledge.capabilities
        for line, method, arguments in self.written:
            most = loudest(method, arguments, robot) if robot is not None else None
            if most is not None:
                values = {"percent": str(arguments["percent"]), "most": str(most)}
                yield line, "volume", "too_loud", values

    def loud(self, tried: Tried) -> _Found:
        """Setting the volume high at night; else the first words that are spoken loudly then."""
        situation, volume, marked = tried.situation, tried.situation.volume, False
        for line, method, arguments in self.written:
            percent = arguments.get("percent")
            if method == "set_volume" and isinstance(percent, int) and percent > LOUD_AT_NIGHT:
                times = [call.began for call in self.done if call.line == line]
                time = situation.clock_at(times[0]) if times else situation.clock
                if _is_night(time):
                    marked = True
                    values = {"time": f"{time:%H:%M}", "percent": str(percent)}
                    yield line, "volume", "loud", values
        for call in self.done:
            time = situation.clock_at(call.began)
            if call.method == "set_volume":
                volume = call.arguments["percent"]
            elif call.method in _SPEECH and volume > LOUD_AT_NIGHT and _is_night(time):
                if not marked:
                    values = {"time": f"{time:%H:%M}", "percent": str(volume)}
                    yield call.line, "volume", "loud_speech", values
                return

    # --- how long it takes

    def long(self, tried: Tried) -> _Found:
        dry_run = tried.dry_run
        if dry_run.seconds < LONG:
            return
        spent: Counter[int] = Counter()
        for call in self.done:
            spent[call.line] += round(1000 * (call.ended - call.began))
        line = spent.most_common(1)[0][0] if spent else 1
        if dry_run.status != "unfinished":
            minutes = {"minutes": f"{round(dry_run.seconds / 60)}"}
            yield line, "long", "long", minutes

    def unproven(self, dry_run: DryRun) -> _Found:
        """Where the dry run did not come to the program's end, nobody has seen what comes."""
        if dry_run.goes_on:
            yield from self.waited(dry_run)
        if dry_run.complete:
            return
        values = {"minutes": f"{round(dry_run.seconds / 60)}", "calls": str(dry_run.calls)}
        text = f"broke_off_{dry_run.broke_off}" if dry_run.broke_off else "did_not_go"
        yield dry_run.line or 1, "unproven", text, values

    def waited(self, dry_run: DryRun) -> _Found:
        """What goes on without end may have waited at one line for all of its dry run."""
        last = self.done[-1]
        if last.method == "wait_for" and all(call.line != last.line for call in self.done[:-1]):
            values = {"minutes": f"{round((last.ended - last.began) / 60)}"}
            yield last.line, "unproven", "waited", values

    def long_waits(self) -> _Found:
        for line, method, arguments in self.written:
            seconds = arguments.get("seconds")
            if method == "wait" and isinstance(seconds, int | float) and seconds >= LONG:
                yield line, "long", "waits", {"minutes": f"{round(seconds / 60)}"}

    def endless(self) -> _Found:
        for loop in endless.loops(self.tree):
            yield loop.lineno, "endless", "endless", {}


# --- places --------------------------------------------------------------------------------------


def _around(world: World, place: str) -> list[str]:
    """The place and what it is in, from the inside out; the last may be a floor that is no
    place."""
    chain: list[str] = []
    name: str | None = place
    while name is not None and name not in chain:
        chain.append(name)
        found = world.place(name)
        name = found.inside if found is not None else None
    return chain


def _area_of(world: World, place: str | None) -> str | None:
    """The ward or department that a place is in, else its floor; None if the world does not say."""
    chain = _around(world, place) if place is not None else []
    wards = (name for name in chain if (found := world.place(name)) and found.kind in _AREAS)
    return next(wards, None) or _floor_of(world, chain)


def _floor_of(world: World, chain: list[str]) -> str | None:
    """The end of the chain, if it is no place itself: a floor, a building."""
    return chain[-1] if len(chain) > 1 and world.place(chain[-1]) is None else None


def _is_outside(world: World, area: str, place: str) -> bool:
    """Whether a place is surely not in the area."""
    chain = _around(world, place)
    known = world.place(area) is not None or _floor_of(world, chain) is not None
    return known and area not in chain


# --- people and time -----------------------------------------------------------------------------


def _names(person: Any) -> tuple[str, ...]:
    return (person.name, *person.aliases)


def _is_night(time: datetime) -> bool:
    evening, morning = NIGHT
    return time.hour >= evening or time.hour < morning


@functools.cache
def _texts(language: str) -> Mapping[str, str]:
    """The texts in a language; in English where there are none in it."""
    return texts_in(language, "risks")
