"""A robot on paper: it carries out a program at once and writes down what would have happened.

Nothing drives and nobody waits, so thousands of sentences can be judged by what comes of them
rather than by how their program is written. Where things and people are, and what people answer,
is the scene.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from typing import Any

from robot_api.capabilities.matching import match_answer
from robot_api.errors import NotFound, NotPossible, Stopped, UnknownPlace
from robot_api.methods import WEEKDAYS
from robot_api.moments import next_moment, seconds_until
from robot_api.values import Clock, Location

START = "start"
"""Where the command is given: where the operator stands."""
OPERATOR = "operator"
MOST_EVENTS = 400
LOOKED_AGAIN = 5.0
"""Minutes between two looks of somebody who waits for the same again and again."""


class Over(Stopped):
    """The program would go on for ever, or waits for somebody who does not come."""


@dataclass(frozen=True)
class Event:
    kind: str
    """visits, says, asks, shows, takes, puts, gives, guides, follows, waits, calls, does"""
    what: str
    at: str
    whom: str = ""

    def __str__(self) -> str:
        whom = f" ({self.whom})" if self.whom else ""
        return f"{self.kind} {self.what!r}{whom} at {self.at}"


@dataclass
class Scene:
    """What is where, and who says what; `is_` of a person or a thing are words that fit it."""

    places: Mapping[str, str]
    """Names and kinds."""
    people: dict[str, str] = field(default_factory=dict)
    """Who is where."""
    things: list[tuple[str, str]] = field(default_factory=list)
    """(what, where), a row for each."""
    answers: Mapping[str, Any] = field(default_factory=dict)
    """Of somebody: a text, a list of texts, or texts by patterns of the questions."""
    option: int | None = None
    """Which of the answers that are offered people give of whom nothing else is said, from 0 on;
    who is offered none gives one of `replies`, or names this number."""
    replies: Sequence[str] = ()
    arrivals: dict[str, list[str]] = field(default_factory=dict)
    """Who comes to a place, one after the other, while somebody waits there."""
    traits: Mapping[str, str] = field(default_factory=dict)
    """More words for somebody: {"Zoe": "visitor woman waving"}."""
    clock: str = "10:00"
    weekday: str = "Tuesday"
    date: str = "2026-11-24"
    battery: int = 80
    hurried: bool = False
    """Whether time flies while the robot waits for the same again and again, and that is one
    event."""


def words_of(phrase: str) -> set[str]:
    """The words of a noun phrase, singular, without those that say nothing: a bottle of water is
    water, but a bottle is a bottle."""
    words = _all_words(phrase)
    return words - _SILENT - _AMOUNTS or words & _AMOUNTS


def _all_words(phrase: str) -> set[str]:
    return {_singular(word) for word in re.findall(r"[\w'.-]+", phrase.lower())}


_SILENT = {"a", "an", "the", "any", "some", "my", "in", "of", "all", "other"}
_AMOUNTS = {"bottle", "piece"}
PERSON = {"person", "somebody", "someone", "anyone", "anybody", "everybody", "human", "people"}
"""Words for anybody."""


def _singular(word: str) -> str:
    if word in ("people", "persons"):
        return "person"
    for ending, instead in (("ies", "y"), ("ches", "ch"), ("xes", "x"), ("sses", "ss")):
        if word.endswith(ending):
            return word.removesuffix(ending) + instead
    return word.removesuffix("s") if not word.endswith(("ss", "us", "'s")) else word


class PaperRobot:
    """The robot methods; what they do is in `events`."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.place = START
        self.operator_at = START
        self.people_at = dict(scene.people)
        self.things = list(scene.things)
        self.held: list[str] = []
        self.events: list[Event] = []
        self.partner: str | None = None
        self.met: set[tuple[str, str]] = set()
        self.asked: dict[str, int] = {}
        self.minutes = 0.0

    # --- looking

    def _is(self, phrase: str, person: str) -> bool:
        traits = _all_words(self.scene.traits.get(person, ""))
        wanted = words_of(phrase)
        if wanted <= words_of(person):
            return True
        return bool(wanted) and wanted <= traits | words_of(person) | PERSON

    def _people_here(self, phrase: str = "person") -> list[str]:
        return [
            who
            for who, where in self.people_at.items()
            if where == self.place and self._is(phrase, who)
        ]

    def _things_here(self, phrase: str) -> list[str]:
        wanted = words_of(phrase) or {"thing"}
        return [
            what
            for what, where in self.things
            if where == self.place and (wanted <= _all_words(what) or wanted & {"thing", "object"})
        ]

    def _event(self, kind: str, what: object, whom: str = "") -> None:
        event = Event(kind, str(what), self.place, whom)
        if self.scene.hurried and kind == "waits" and self.events[-1:] == [event]:
            return
        self.events.append(event)
        if len(self.events) > MOST_EVENTS:
            raise Over

    # --- the methods

    def goto(self, place: Any = None, x: Any = None, y: Any = None, theta: Any = None) -> None:
        if place is None:
            self.place, self.partner = f"{x:g}, {y:g}", None
            self._event("visits", self.place)
            return
        name = str(place)
        known = isinstance(place, Location)  # the robot has been there
        if not known and name != START and name not in self.scene.places:
            raise UnknownPlace(f"There is no place called {name}.")
        self.place = name
        self.partner = None
        self._event("visits", name)

    def location(self) -> Location:
        return Location(0.0, 0.0, 0.0, self.place)

    def places(self, kind: str | None = None) -> list[str]:
        return [name for name, k in self.scene.places.items() if kind is None or k == kind]

    def dock(self) -> None:
        self.place = "charger"
        self._event("does", "dock")

    def sees(self, thing: str) -> bool:
        return bool(self._people_here(thing) or self._things_here(thing))

    def count(self, thing: str) -> int:
        self._event("counts", thing)
        return len(self._people_here(thing)) or len(self._things_here(thing))

    def people(self) -> list[str]:
        return self._people_here()

    def objects(self) -> list[str]:
        return self._things_here("thing")

    def describe(self, thing: str) -> str:
        seen = [*self._people_here(thing), *self._things_here(thing)]
        if not seen:
            raise NotFound(f"I do not see {thing}.")
        return f"I see {', '.join(seen)}."

    def find(self, thing: str, place: str | None = None) -> bool:
        self._event("looks for", thing)
        if place is not None:
            if self.place != str(place):
                self.goto(place)
            return self.sees(thing)
        if self.sees(thing):
            return True
        for name in self.scene.places:
            self.place = name
            if self.sees(thing):
                self._event("visits", name)
                return True
        return False

    def wait_for(self, thing: str, timeout: float | None = None) -> bool:
        self._event("waits", thing)
        here = [who for who in self._people_here(thing) if (who, self.place) not in self.met]
        if not here and self._things_here(thing):
            return True
        if not here:
            here = [who for who in self._coming() if self._is(thing, who)][:1]
            self.people_at.update(dict.fromkeys(here, self.place))
        if not here:
            if timeout is not None:
                self.minutes += timeout / 60
                return False
            raise Over
        self.partner = here[0]
        self.met.add((here[0], self.place))
        return True

    def _coming(self) -> list[str]:
        """Who is still to come to where the robot is."""
        coming = self.scene.arrivals.get(self.place, [])
        return [who for who in coming if who not in self.people_at]

    # --- talking

    def say(self, text: object, language: str | None = None) -> None:
        here = self._people_here()
        whom = self.partner if self.partner in here else here[0] if here else ""
        self._event("says", text, whom or (OPERATOR if self.place == self.operator_at else ""))

    def ask(
        self, question: object, options: Sequence[str] | None = None, person: str | None = None
    ) -> str:
        whom = self._one(person)
        self._event("asks", question, whom)
        if self.scene.option is not None and whom not in self.scene.answers:
            offered = options or self.scene.replies or [str(self.scene.option)]
            return offered[self.scene.option % len(offered)]
        answer = self._answer(whom, str(question))
        if not options:
            return answer
        said = answer.lower()
        for option in options:
            if option.lower() == said:
                return option
        for option in sorted(options, key=len, reverse=True):
            if re.search(rf"\b{re.escape(option.lower())}\b", said):
                return option
        return match_answer(answer, options) or list(options)[-1]

    def _one(self, person: str | None) -> str:
        here = self._people_here(person or "person")
        if person is None and self.partner in here:
            return str(self.partner)
        if person in here:
            self.partner = str(person)  # whoever is asked is who is spoken to next
            return self.partner
        if self.partner in here and (self.partner, self.place) in self.met:
            return str(self.partner)  # who was waited for just now
        unmet = [who for who in here if not self.asked.get(who)]
        if here:
            self.partner = (unmet or here)[0]
            return self.partner
        if self.place == self.operator_at:
            return OPERATOR
        raise NotFound(f"{person or 'Nobody'} is not here.")

    def _answer(self, whom: str, question: str) -> str:
        number = self.asked[whom] = self.asked.get(whom, 0) + 1
        given = self.scene.answers.get(whom, "yes")
        if isinstance(given, Mapping):
            for pattern, answer in given.items():
                if re.search(str(pattern), question, re.IGNORECASE):
                    return str(answer)
            return "yes"
        if isinstance(given, list):
            return str(given[min(number, len(given)) - 1])
        return str(given)

    def listen(self, prompt: str | None = None, timeout: float = 10) -> str:
        return self.ask(prompt or "")

    def touch(self, options: Sequence[str], prompt: str | None = None) -> str:
        return self.ask(prompt or "", options)

    def answer(self, question: str | None = None) -> str:
        self._event("answers", question or "")
        return "42"

    def show(self, text: object = None, html: object = None, url: object = None) -> None:
        self._event("shows", text or html or url)

    # --- things and company

    def grab(self, thing: object) -> None:
        here = self._things_here(str(thing))
        if self.held:
            raise NotPossible("My hand is full.")
        if not here:
            raise NotFound(f"I do not see {thing}.")
        self.things.remove((here[0], self.place))
        self.held.append(here[0])
        self._event("takes", here[0])

    def _let_go(self, thing: object) -> str:
        held = [each for each in self.held if words_of(str(thing)) <= _all_words(each)]
        if not held:
            raise NotPossible(f"I do not hold {thing}.")
        self.held.remove(held[0])
        return held[0]

    def put(self, thing: object, where: str | None = None) -> None:
        name = self._let_go(thing)
        self.things.append((name, self.place))
        self._event("puts", name, where or "")

    def give(self, thing: object, person: str | None = None) -> None:
        name = self._let_go(thing)
        self._event("gives", name, self._one(person))

    def guide(self, person: str, place: object) -> None:
        whom = self._one(person)
        self.place = str(place)
        if whom == OPERATOR:
            self.operator_at = self.place
        else:
            self.people_at[whom] = self.place
        self.partner = whom
        self._event("guides", whom, whom)

    def follow(self, person: str, to: object = None) -> None:
        whom = self._one(person)
        self._event("follows", whom, whom)
        if to is not None:
            self.place = str(to)
            self.people_at[whom] = self.place

    # --- the rest

    def wait(self, seconds: float) -> None:
        before = len(self.events)
        self._event("waits", f"{seconds:g} s")
        self.minutes += seconds / 60
        if len(self.events) == before:  # time flies to the next full five minutes
            self.minutes += -self.minutes % LOOKED_AGAIN
        self.people_at.update(dict.fromkeys(self._coming()[:1], self.place))

    def wait_until(self, time: str, weekday: str | None = None, date: str | None = None) -> None:
        now = self._now()
        self.wait(seconds_until(next_moment(now, time, weekday, date), now))

    def clock(self) -> Clock:
        now = self._now()
        begun = datetime.fromisoformat(self.scene.date).date()
        ahead = WEEKDAYS.index(self.scene.weekday) + (now.date() - begun).days
        return Clock(f"{now:%H:%M}", WEEKDAYS[ahead % 7], f"{now:%Y-%m-%d}")

    def _now(self) -> datetime:
        begun = datetime.fromisoformat(f"{self.scene.date}T{self.scene.clock}+00:00")
        return begun + timedelta(minutes=int(self.minutes))

    def battery(self) -> int:
        return self.scene.battery

    def scan(self, prompt: str | None = None, timeout: float = 30) -> str:
        self._event("does", "scan")
        return "4006381333931"

    def read_text(self, selector: str) -> str:
        self._event("does", f"read_text {selector}")
        return "text"

    def log(self, lines: int = 20) -> list[str]:
        return ["10:00 The robot stands."][:lines]

    def call(self, contact: str) -> None:
        self._event("calls", contact)

    def __getattr__(self, name: str) -> Any:
        def does(*values: object, **named: object) -> None:
            given = {key: _plain(named[key]) for key in sorted(named)}
            self._event("does", f"{name} {values} {given}")

        return does


def _plain(value: object) -> object:
    """A value so that 2 and 2.0 are told alike."""
    return float(value) if isinstance(value, int) else value
