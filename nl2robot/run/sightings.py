"""Whom and what the robot has seen just now, and where: it need not drive to tell of that.

It is noted from the calls of programs as they come back, with the place that the robot's pose says;
a robot that tells of no places remembers nothing. What it looked for in vain, or took away, is
forgotten.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Final

from grammar import plan as p
from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.naming import joined_up, naming, place_called, the
from grammar.planning.turn import Turn
from nl2robot.texts import texts_in

GOOD_FOR: Final = 300.0
"""Seconds for which it counts that somebody was seen: people go on."""
HOUR: Final = 3600.0
FORGOTTEN_AFTER: Final = 12 * HOUR
"""Where they were before says nothing any more."""
JUST_NOW: Final = 90.0
"""Seconds; what is longer ago is told in minutes."""


@dataclass(frozen=True)
class Sighting:
    place: str
    at: float
    """Seconds since the epoch."""


class Sightings:
    """Where somebody or something was seen last. Any thread may call any of it."""

    def __init__(self, now: Callable[[], float] = time.time) -> None:
        self._now = now
        self._last: dict[str, Sighting] = {}

    def of(self, thing: str) -> Sighting | None:
        """Where it was seen, if that was just now."""
        found = self._last.get(thing.lower())
        return found if found is not None and self._now() - found.at <= GOOD_FOR else None

    def note(
        self, method: str, arguments: Mapping[str, Any], result: Any, place: str | None
    ) -> None:
        """A robot call has come back; the robot is at this place now."""
        thing, person = arguments.get("thing"), arguments.get("person")
        match method:
            case "find" if not result and arguments.get("place") is None:
                self._last.pop(str(thing).lower(), None)  # it looked everywhere
            case "find" | "sees" | "wait_for" | "count":
                self._put(thing, bool(result), place)
            case "people" | "objects":
                for name in result:
                    self._put(name, True, place)
            case "put":
                self._put(thing, True, place)
            case "grab":
                self._last.pop(str(thing).lower(), None)
            case "give":
                self._last.pop(str(thing).lower(), None)
                self._put(person, True, place)
            case "ask" | "listen" | "guide" | "follow":
                self._put(person, True, place)

    def _put(self, thing: object, seen: bool, place: str | None) -> None:
        if not isinstance(thing, str):
            return
        name = thing.lower()
        if seen and place is not None:
            self._last[name] = Sighting(place, self._now())
        elif name in self._last and self._last[name].place == place:
            del self._last[name]

    def told(self, turn: Turn, plan: p.Plan) -> tuple[str, str] | None:
        """Whom or what a question is after, and the answer to it from here: "I saw Bob in ward a
        2 minutes ago."; None for anything else, and for what was not seen just now."""
        thing = sought(plan)
        seen = self.of(thing) if thing is not None else None
        if thing is None or seen is None or not _only_asks(turn):
            return None
        return thing, self._sentence("seen", thing, seen, turn)

    def told_of_before(self, turn: Turn, plan: p.Plan) -> str | None:
        """Where somebody who is now to be looked for was seen last: "I last saw Bob in ward a 40
        minutes ago."; None for anything else."""
        thing = sought(plan)
        seen = self._last.get(thing.lower()) if thing is not None else None
        if thing is None or seen is None or self._now() - seen.at > FORGOTTEN_AFTER:
            return None
        return self._sentence("last_seen", thing, seen, turn)

    def _sentence(self, name: str, thing: str, seen: Sighting, turn: Turn) -> str:
        words = texts_in(turn.language.code, "sightings")
        ago = self._now() - seen.at
        number = round(ago / 60) if ago < 2 * HOUR else round(ago / HOUR)
        when = "just_now" if ago < JUST_NOW else "minutes" if ago < 2 * HOUR else "hours"
        sentence = words[name].format(
            thing=_called(thing, turn.lexicon, turn.language),
            place=place_called(seen.place, turn.lexicon, turn.language),
            ago=words[when].format(number=number),
        )
        return joined_up(sentence, turn.language)


def sought(plan: p.Plan) -> str | None:
    """What a program only looks for, to come back and tell where it is."""
    match plan.steps:
        case (
            p.Remember(value=p.Ask(method="location")),
            p.If(
                condition=p.Holds(value=p.Ask(method="find", arguments=given)),
                then=(p.Remember(value=p.Ask(method="location")), *_),
            ),
        ) if set(given) == {"thing"}:
            thing = given["thing"]
            return thing.value if isinstance(thing, p.Text) else None
        case _:
            return None


def _only_asks(turn: Turn) -> bool:
    """Whether somebody asks where, and says nothing of looking for it."""
    pack = turn.language
    words = texts_in(pack.code, "sightings")
    said, asking = pack.tokens_of(turn.text), {*pack.tokens_of(words["asking"]), ","}
    where = [at for at, word in enumerate(said) if word in pack.tokens_of(words["where"])]
    return bool(where) and asking.issuperset(said[: where[0]])


def _called(thing: str, lexicon: Lexicon, pack: Language) -> str:
    called = naming(lexicon, pack).called(thing)
    known = any(each.name.lower() == thing.lower() for each in lexicon.people)
    return called if known else the(called, pack)
