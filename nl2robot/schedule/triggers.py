"""Events that begin an approved program: "whenever somebody comes into the lobby, greet them".

    due = Watch(triggers, last).happened("battery", {"percent": 18, "charging": False}, now)

Without I/O: what happens goes in, the numbers of the appointments that are due come out. What holds
on counts once, when it begins: a battery that is low does not send the robot to charge every
second. And none is due more often than it allows.

| what   | is due when                                                                           |
|--------|---------------------------------------------------------------------------------------|
| battery | the battery falls below `below` percent and is not charging                          |
| place   | the robot comes to `place`                                                           |
| seen    | it sees `thing` that it did not see before; with `place`, only while it is there     |
| heard   | what people say to it has the words `text`                                           |
| scanned | it scans the code `text`, any if empty                                               |
| pressed | somebody presses the button `text` of its face                                       |
| message | the house's broker says `text` (anything, if empty) at `topic`                       |
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any, Final, Literal

import msgspec

from nl2robot.errors import UserError
from nl2robot.schedule.topics import is_below, is_topic, matches

What = Literal["battery", "place", "seen", "heard", "scanned", "pressed", "message"]
MINUTE: Final = 60.0
ANYBODY: Final = "person"
"""What is seen where anybody is meant."""
SHORTEST: Final = 5.0
"""Seconds between two times at least, whatever somebody wishes."""
REARMED_AT: Final = 5
"""Percent above `below` at which a battery that was low counts as filled again."""
GONE_AFTER: Final = 20.0
"""Seconds without being seen after which somebody who is seen has come anew."""
LONGEST: Final = 200
"""Letters of a text."""


class Trigger(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """What begins an appointment instead of the clock. `checked` says whether it makes sense."""

    what: What
    text: str = ""
    """Words, a code, the name of a button, a payload."""
    thing: str = ""
    """What is seen, as `robot.sees` is told: "person", a name."""
    place: str = ""
    """A name of the world."""
    topic: str = ""
    """Of MQTT; `+` and `#` stand for levels."""
    below: int = 0
    """Percent."""
    every: float = MINUTE
    """Seconds that lie between two times at least."""


class BadTrigger(UserError):
    """It could never happen, or all the time; the message says what to change."""


def checked(trigger: Trigger) -> Trigger:
    """The same. Raises `BadTrigger`."""
    needed: Mapping[What, str] = {
        "place": "place",
        "seen": "thing",
        "heard": "text",
        "pressed": "text",
        "message": "topic",
    }
    name = needed.get(trigger.what)
    if name is not None and not getattr(trigger, name).strip():
        raise BadTrigger(f"An event of the kind {trigger.what!r} needs {name!r}: say which.")
    if trigger.what == "battery" and not 1 <= trigger.below <= 99:
        raise BadTrigger("A battery is below 1 to 99 percent: say how many.")
    if trigger.what == "message" and not is_topic(trigger.topic, wildcards=True):
        raise BadTrigger(
            f"{trigger.topic!r} is no topic of MQTT. Write one such as ward-a/call, with + for any"
            " one level and # at the end for all below."
        )
    if any(len(each) > LONGEST for each in (trigger.text, trigger.thing, trigger.topic)):
        raise BadTrigger(f"What begins a program is told in {LONGEST} letters at most.")
    if not SHORTEST <= trigger.every <= 31 * 24 * 60 * MINUTE:
        raise BadTrigger(
            f"An event begins a program every {SHORTEST:.0f} seconds at most: allow it that rarely."
        )
    return trigger


def possible(trigger: Trigger, methods: Collection[str], places: Collection[str]) -> Trigger:
    """The same, its place by the name that it has in this house. Raises `BadTrigger` if a robot
    with these methods, in a house with these places, would never notice it."""
    by: Mapping[What, str] = {"seen": "sees", "scanned": "scan"}
    if trigger.what in by and by[trigger.what] not in methods:
        raise BadTrigger("This robot would never notice that. Choose another event.")
    if not trigger.place:
        return trigger
    named = {name.casefold(): name for name in places}
    if trigger.place.casefold() not in named:
        raise BadTrigger(
            f"There is no place “{trigger.place}” here. Name one as the map of this house does."
        )
    return msgspec.structs.replace(trigger, place=named[trigger.place.casefold()])


def of_others(trigger: Trigger, prefix: str) -> Trigger:
    """The same. Raises `BadTrigger` for a message of the robot's own, below this prefix: what it
    says of a run would begin the next, and so on."""
    if trigger.what == "message" and is_below(trigger.topic, prefix):
        raise BadTrigger(
            f"What is said at {trigger.topic!r} is the robot's own, and begins nothing. Choose a"
            f" topic that does not begin with {prefix}."
        )
    return trigger


_OF_A_TEXT: Final[Mapping[str, What]] = {
    "heard": "heard",
    "scanned": "scanned",
    "pressed": "pressed",
}
WRITTEN: Final = (
    "battery:20, seen:person@lobby, place:lobby, heard:WORDS, scanned:CODE, pressed:BUTTON,"
    " message:TOPIC=TEXT"
)
"""How people write them."""


def written(text: str, every: float = MINUTE) -> Trigger:
    """Read a trigger as people write it, such as "seen:person@lobby" (`WRITTEN`). Raises
    `BadTrigger`."""
    what, _, rest = (each.strip() for each in text.partition(":"))
    if what == "place":
        return checked(Trigger(what="place", place=rest, every=every))
    if what in _OF_A_TEXT:
        return checked(Trigger(what=_OF_A_TEXT[what], text=rest, every=every))
    if what == "seen":
        thing, _, place = rest.partition("@")
        return checked(Trigger(what="seen", thing=thing.strip(), place=place.strip(), every=every))
    if what == "message":
        topic, _, payload = rest.partition("=")
        return checked(Trigger(what="message", topic=topic, text=payload, every=every))
    if what == "battery" and rest.rstrip("% ").isdecimal() and len(rest) < LONGEST:
        return checked(Trigger(what="battery", below=int(rest.rstrip("% ")), every=every))
    raise BadTrigger(f"{text!r} is no event that begins a program. There are: {WRITTEN}.")


class Watch:
    """What is so, and which appointments were due lately. One thread at a time may use it.

    `triggers` by the numbers of their appointments, `last` when each was due (seconds since the
    epoch), as the book knows it: so nothing is due too often after a restart. `located`: it is
    known where the robot is, at `place` or at none with a name.
    """

    def __init__(
        self,
        triggers: Mapping[int, Trigger],
        last: Mapping[int, float],
        place: str | None = None,
        located: bool = False,
    ) -> None:
        self._triggers = dict(triggers)
        self._last = dict(last)
        self._held: dict[int, bool] = {}
        """Of what holds on: whether it does."""
        self._seen: dict[str, float] = {}
        """When each thing was seen last."""
        self._place, self._located = place, located

    def now(self, triggers: Mapping[int, Trigger]) -> None:
        """The appointments that there are now; of those that stay, what was so stays so."""
        for number in self._held.keys() - triggers.keys():
            del self._held[number]
        self._triggers = dict(triggers)

    def looks_for(self) -> list[str]:
        """The things that the robot has to look for where it is, for these triggers."""
        wanted = {
            each.thing: None
            for each in self._triggers.values()
            if each.what == "seen" and each.place in ("", self._place)
        }
        return list(wanted)

    def topics(self) -> set[str]:
        """Where the broker has to be heard."""
        return {each.topic for each in self._triggers.values() if each.what == "message"}

    def buttons(self) -> list[str]:
        """The buttons that the face shows."""
        named = [each.text for each in self._triggers.values() if each.what == "pressed"]
        return list(dict.fromkeys(named))

    def rests(self, button: str, now: float) -> bool:
        """Whether a press of this button would begin nothing yet: it was pressed lately."""
        its = [n for n, each in self._triggers.items() if is_button(each, button)]
        return bool(its) and not any(self._may(n, self._triggers[n], now) for n in its)

    def happened(self, kind: str, data: Mapping[str, Any], now: float) -> list[int]:
        """Something has happened, an event of the wire or one of these: `seen` (thing, there),
        `scanned` (code), `pressed` (button), `message` (topic, text). Returns what is due."""
        due = []
        for number, trigger in self._triggers.items():
            if self._begins(number, trigger, kind, data, now) and self._may(number, trigger, now):
                self._last[number] = now
                due.append(number)
        if kind == "seen" and data["there"]:
            self._seen[data["thing"]] = now
        elif kind == "pose":
            self._place, self._located = data.get("place"), True
        return due

    def _may(self, number: int, trigger: Trigger, now: float) -> bool:
        last = self._last.get(number)
        # A clock that was set back is no reason to wait for years.
        return last is None or now - last >= trigger.every or now < last

    def _begins(
        self, number: int, trigger: Trigger, kind: str, data: Mapping[str, Any], now: float
    ) -> bool:
        match trigger.what, kind:
            case "battery", "battery":
                return self._falls(number, trigger, data)
            case "place", "pose":
                # Where it stands from the first is not where it has come to.
                came = self._located and self._place != trigger.place
                return came and data.get("place") == trigger.place
            case "seen", "seen" if data["thing"] == trigger.thing:
                return bool(data["there"]) and self._comes(trigger, now)
            case "heard", "heard":
                return _words(trigger.text) in _words(str(data.get("text", "")))
            case "scanned", "scanned":
                return trigger.text in ("", data["code"])
            case "pressed", "pressed":
                return is_button(trigger, data["button"])
            case "message", "message":
                return matches(trigger.topic, data["topic"]) and trigger.text in ("", data["text"])
        return False

    def _changes(self, number: int, holds: bool) -> bool:
        """Whether it holds now and did not before."""
        before = self._held.get(number, False)
        self._held[number] = holds
        return holds and not before

    def _falls(self, number: int, trigger: Trigger, data: Mapping[str, Any]) -> bool:
        percent = data.get("percent")
        if percent is None:
            return False
        low = percent < trigger.below
        if self._held.get(number) and percent < trigger.below + REARMED_AT:
            low = True  # a reading that trembles is no second fall
        if data.get("charging"):
            self._held[number] = low  # it is where it would be sent
            return False
        return self._changes(number, low)

    def _comes(self, trigger: Trigger, now: float) -> bool:
        if trigger.place and trigger.place != self._place:
            return False
        before = self._seen.get(trigger.thing)
        return before is None or not 0 <= now - before < GONE_AFTER


def is_button(trigger: Trigger, name: str) -> bool:
    """Whether a press of the button of this name begins it."""
    return trigger.what == "pressed" and trigger.text == name


def _words(text: str) -> str:
    """Its words, between spaces."""
    plain = "".join(letter if letter.isalnum() else " " for letter in text.casefold())
    return f" {' '.join(plain.split())} "
