"""What the robot sees: a noun phrase and the things and people it fits, where the robot is.

A phrase fits what explains all of its words, be it with name, aliases, kind or attributes. Words
that say nothing about the thing itself are left out; a superlative picks one of those that fit; a
relation ("on the desk") is about where it is.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from sim.errors import NotFound
from sim.people.crowd import Human
from sim.physics.placing import ROBOT, Item
from sim.physics.robot import bearing, wrap
from sim.world.geometry import contains
from sim.world.model import Aliases, Furniture, key
from sim.world.words import words

if TYPE_CHECKING:
    from sim.hospital import Hospital


@dataclass(frozen=True)
class Seen:
    """A thing or a person that the robot sees. Metres on the map."""

    name: str
    kind: str
    attributes: tuple[str, ...]
    x: float
    y: float
    is_person: bool


Sight = Human | Item | Furniture


@dataclass(frozen=True)
class Phrase:
    """A noun phrase, taken apart."""

    text: str
    words: tuple[str, ...]
    """What must be explained; fillers and superlatives are left out."""
    measure: str | None
    """A superlative: "leftmost", "biggest" ..."""
    place: str | None
    """What it is on, in or near: the words after a relation."""
    side: str | None
    """Where it is of that, for who looks: "left", "behind"; None for "on", "near" and the like."""
    rank: int
    """Which one by the superlative, from 1 on: "second biggest"."""
    number: int | None
    """How many at most: "3 biggest things"; None where that is not said."""
    whole: str
    """All of it as one name."""


@functools.lru_cache(maxsize=256)
def parse(text: str) -> Phrase:
    """Take a noun phrase apart."""
    whole = key(text)
    head, place, side = whole, None, None
    for relation in words().relations:
        before, found, after = whole.partition(f" {relation} ")
        if found and len(before) < len(head):
            head, place, side = before, after, words().sides.get(relation)
    superlatives = words().superlatives
    tokens = _tokens(head)
    number = int(tokens.pop(0)) if len(tokens) > 1 and tokens[0].isdecimal() else None
    measure = next((superlatives[token] for token in tokens if token in superlatives), None)
    rank = 1
    silent = words().fillers | superlatives.keys()
    if measure is not None:
        rank = next((words().ordinals[token] for token in tokens if token in words().ordinals), 1)
        silent |= words().ordinals.keys()
    kept = [token for token in tokens if token not in silent]
    return Phrase(text, tuple(kept), measure, place, side, rank, number, whole)


def visible(hospital: Hospital, thing: str) -> list[Seen]:
    """Those in view, the nearest first."""
    return [_seen(hospital, sight) for sight in in_view(hospital, thing)]


def in_view(hospital: Hospital, thing: str) -> list[Sight]:
    """The people, things and, if there are none of these, furniture that a phrase fits and that
    the robot sees."""
    return pick(
        hospital,
        thing,
        [sight for sight in fitting(hospital, thing) if hospital.here(*spot_of(sight))],
    )


def person_in_view(hospital: Hospital, person: str) -> Human:
    """The one meant: whom the robot deals with already if the phrase fits them, else the nearest.
    Raises `NotFound`."""
    here = [sight for sight in in_view(hospital, person) if isinstance(sight, Human)]
    if not here:
        raise NotFound(
            f'The robot does not see "{person}" here. Send it to where they are, or wait for them.'
        )
    return next((human for human in here if human.name == hospital.partner), here[0])


def item_in_view(hospital: Hospital, thing: str) -> Item:
    """The nearest thing meant that nobody holds. Raises `NotFound`."""
    for sight in in_view(hospital, thing):
        if isinstance(sight, Item) and sight.holder is None:
            return sight
    raise NotFound(
        f'The robot does not see "{thing}" here. Look for it in another place, '
        "or describe it differently."
    )


def describe(hospital: Hospital, thing: str) -> str:
    sights = in_view(hospital, thing)
    if not sights:
        raise NotFound(f'The robot does not see "{thing}" here. Look for it in another place.')
    if _is_plural(thing, sights):
        return f"I see {_listed([_shown(hospital, sight) for sight in sights])}."
    sight = sights[0]
    if isinstance(sight, Furniture):
        return f"The {sight.name} is a {sight.kind}."
    seen = _seen(hospital, sight)
    if isinstance(sight, Human):
        kind = "" if sight.person.kind in ("person", seen.name) else f", {_a(sight.person.kind)},"
        held = [hospital.items[number].thing.name for number in sight.holding]
        doing = _listed([*seen.attributes, *(f"holding {_a(name)}" for name in held)])
        return f"{seen.name}{kind} is {doing}."
    what = _a(" ".join([*seen.attributes, seen.name]))
    plain = seen.kind == "object" or key(seen.kind) in key(seen.name)
    kind = "" if plain else f" ({seen.kind})"
    where = f" on the {sight.on}" if sight.on else ""
    return f"It is {what}{kind}{where}."


# --- which it fits -------------------------------------------------------------------------------


def fitting(hospital: Hospital, thing: str) -> list[Sight]:
    """All that a phrase fits, wherever it is; a superlative is not applied."""
    phrase = parse(thing)
    sights: list[Sight] = [*hospital.people]
    sights += [item for item in hospital.items if item.present and item.holder != ROBOT]
    found = [sight for sight in sights if fits(hospital, sight, phrase)]
    if found:
        return found
    return [
        piece for piece in hospital.world.furniture if piece.pose and fits(hospital, piece, phrase)
    ]


def fits(hospital: Hospital, sight: Sight, phrase: Phrase) -> bool:
    if not phrase.words and phrase.measure is None:
        return False
    if phrase.whole in _names(sight):
        return True
    known = _vocabulary(sight)
    if phrase.place is None:
        return _explains(known, phrase.words)
    if _explains(known, phrase.words):
        if phrase.side is not None:
            return _is_beside(hospital, sight, phrase.side, phrase.place)
        if _is_at(hospital, sight, phrase.place) or _is_by_thing(hospital, sight, phrase.place):
            return True
    # "the man in the blue coat": no relation after all.
    after = [token for token in _tokens(phrase.place) if token not in words().fillers]
    return _explains(known, [*phrase.words, *after])


def _explains(known: frozenset[str], tokens: Iterable[str]) -> bool:
    return all(any(single in known for single in words().singulars(token)) for token in tokens)


def _names(sight: Sight) -> set[str]:
    if isinstance(sight, Furniture):
        return {key(sight.name)}
    named = sight.person if isinstance(sight, Human) else sight.thing
    return {key(named.name), *(key(alias) for alias in _all(named.aliases))}


def _vocabulary(sight: Sight) -> frozenset[str]:
    """Every word that explains what it is."""
    if isinstance(sight, Human):
        known = _texts_words(
            (sight.name, sight.person.kind, *sight.person.is_), sight.person.aliases
        )
        known -= frozenset().union(*words().postures.values())
        known |= words().person | words().postures[posture_now(sight)]
        if sight.person.gender == "male":
            known |= words().male
        elif sight.person.gender == "female":
            known |= words().female
        return known
    if isinstance(sight, Item):
        thing = sight.thing
        known = _texts_words((thing.name, thing.kind, *thing.is_), thing.aliases) | words().thing
        for group in (words().big, words().small):
            if known & group:
                known |= group
        return known
    return _texts_words((sight.name, sight.kind), sight.aliases)


@functools.lru_cache(maxsize=4096)
def _words_of(texts: tuple[str, ...]) -> frozenset[str]:
    found: set[str] = set()
    for text in texts:
        for token in _tokens(key(text)):
            found.update(words().singulars(token))
    return frozenset(found)


def _texts_words(texts: tuple[str, ...], aliases: Aliases) -> frozenset[str]:
    return _words_of((*texts, *_all(aliases)))


def _all(aliases: Aliases) -> Iterable[str]:
    return (alias for group in aliases.values() for alias in group)


def _tokens(text: str) -> list[str]:
    # "Alice's" explains "Alice", and "l'objet" is an "objet".
    return re.findall(r"\w+", re.sub(r"\b(l|d|qu)'|'s\b", " ", text.replace("-", " ")))


def names_in(text: str) -> frozenset[str]:
    """The words of a name or a phrase, without those that say nothing."""
    return frozenset(_tokens(key(text))) - words().fillers


def posture_now(human: Human) -> str:
    return "walking" if human.walking else human.posture


# --- where it is ---------------------------------------------------------------------------------


def spot_of(sight: Sight) -> tuple[float, float]:
    if isinstance(sight, Human):
        return sight.position
    if isinstance(sight, Item):
        return sight.x, sight.y
    assert sight.pose is not None
    return sight.pose.x, sight.pose.y


def _is_at(hospital: Hospital, sight: Sight, where: str) -> bool:
    """Whether it is on, in or near the furniture or place of that name."""
    tokens = [token for token in _tokens(where) if token not in words().fillers]
    if not tokens:  # "on the floor"
        return True
    if isinstance(sight, Item) and sight.on and _explains(_words_of((sight.on,)), tokens):
        return True
    x, y = spot_of(sight)
    place = hospital.world.place(" ".join(where.split()[1:])) or hospital.world.place(where)
    if place is not None:
        at = hospital.world.place_at(x, y)
        return (at is not None and at.name == place.name) or bool(
            place.area and contains(place.area, x, y)
        )
    return any(
        piece.pose is not None
        and piece is not sight
        and math.dist((piece.pose.x, piece.pose.y), (x, y)) < max(piece.size) / 2 + 0.5
        and _explains(_words_of((piece.name, piece.kind)), tokens)
        for piece in hospital.world.furniture
    )


_NEAR: Final = 1.0
"""Metres between things that are next to each other."""
_IN_SIGHT: Final = 3.0
"""Metres to a thing that another one is told by."""


def _landmarks(hospital: Hospital, sight: Sight, noun: str) -> list[tuple[float, float]]:
    """Where the other things and people of this name are, in the reach of the eye from it."""
    tokens = [token for token in _tokens(noun) if token not in words().fillers]
    others: list[Sight] = [*hospital.people, *hospital.items]
    others += [piece for piece in hospital.world.furniture if piece.pose]
    spots = [
        spot_of(other)
        for other in others
        if other is not sight
        and not (isinstance(other, Item) and (other.holder or not other.present))
        and tokens
        and _explains(_vocabulary(other), tokens)
    ]
    return [spot for spot in spots if math.dist(spot, spot_of(sight)) < _IN_SIGHT]


def _is_by_thing(hospital: Hospital, sight: Sight, noun: str) -> bool:
    """Whether it is next to another thing or person."""
    return any(
        math.dist(spot, spot_of(sight)) < _NEAR for spot in _landmarks(hospital, sight, noun)
    )


def _is_beside(hospital: Hospital, sight: Sight, side: str, noun: str) -> bool:
    """Whether it is on this side of something, as the robot sees them."""
    robot, here = hospital.robot.position, spot_of(sight)
    if side == "between":
        join = next((each for each in words().joins if f" {each} " in noun), None)
        first, _, second = noun.partition(f" {join} ")
        return any(
            math.dist(one, here) + math.dist(here, other) < 1.3 * math.dist(one, other) + 0.1
            for one in _landmarks(hospital, sight, first)
            for other in _landmarks(hospital, sight, second)
        )
    for spot in _landmarks(hospital, sight, noun):
        turned = wrap(bearing(robot, here) - bearing(robot, spot))
        further = math.dist(robot, here) - math.dist(robot, spot)
        if {"left": turned > 0, "right": turned < 0, "behind": further > 0, "before": further < 0}[
            side
        ]:
            return True
    return False


# --- the superlatives ----------------------------------------------------------------------------


def pick(hospital: Hospital, thing: str, sights: Sequence[Sight]) -> list[Sight]:
    """Those of the sights that a superlative or a number leaves; the nearest first."""
    robot = hospital.robot.position
    near = sorted(sights, key=lambda sight: math.dist(robot, spot_of(sight)))
    phrase = parse(thing)
    measure, rank = phrase.measure, phrase.rank
    if measure is None or not near:
        return near[: phrase.number]
    score = _measures(hospital, near)[measure]
    known = [(value, -i) for i, sight in enumerate(near) if (value := score(sight)) is not None]
    if len(known) >= rank:
        best = sorted(known, reverse=True)[rank - 1 : rank - 1 + (phrase.number or 1)]
        return [near[-at] for _, at in best]
    return [_by_words(near, measure)] if rank == 1 else []


def _by_words(sights: Sequence[Sight], measure: str) -> Sight:
    """Where nothing was measured, "big" and "small" are what is known."""
    sign = -1 if measure in _LEAST else 1

    def size(sight: Sight) -> int:
        known = _vocabulary(sight)
        return sign * (bool(known & words().big) - bool(known & words().small))

    return max(sights, key=size)


_LEAST = frozenset({"smallest", "lightest", "shortest", "thinnest"})
_Measure = Callable[[Sight], float | None]


def _measures(hospital: Hospital, sights: Sequence[Sight]) -> dict[str, _Measure]:
    """How much of what a superlative asks for each has; None if that is not known."""
    robot = hospital.robot.position
    count = len(sights)
    middle = (
        sum(spot_of(sight)[0] for sight in sights) / count,
        sum(spot_of(sight)[1] for sight in sights) / count,
    )
    # Left and right as the robot sees them when it looks at them all.
    ahead = bearing(robot, middle)

    def left(sight: Sight) -> float:
        return wrap(bearing(robot, spot_of(sight)) - ahead)

    def distance(sight: Sight) -> float:
        return math.dist(robot, spot_of(sight))

    def size(axis: int) -> _Measure:
        return lambda sight: (
            sight.thing.size[axis] if isinstance(sight, Item) and sight.thing.size else None
        )

    def volume(sight: Sight) -> float | None:
        known = isinstance(sight, Item) and sight.thing.size
        return math.prod(known) if known else None

    def weight(sight: Sight) -> float | None:
        return sight.thing.weight if isinstance(sight, Item) else None

    def least(measure: _Measure) -> _Measure:
        return lambda sight: None if (value := measure(sight)) is None else -value

    return {
        "leftmost": left,
        "rightmost": least(left),
        "nearest": least(distance),
        "farthest": distance,
        "biggest": volume,
        "smallest": least(volume),
        "heaviest": weight,
        "lightest": least(weight),
        "tallest": size(2),
        "shortest": least(size(2)),
        "thickest": size(1),
        "thinnest": least(size(1)),
    }


# --- in words ------------------------------------------------------------------------------------


def _seen(hospital: Hospital, sight: Sight) -> Seen:
    x, y = spot_of(sight)
    if isinstance(sight, Human):
        postures = frozenset().union(*words().postures.values())
        others = [text for text in sight.person.is_ if not set(_tokens(key(text))) & postures]
        attributes = (posture_now(sight), *others)
        return Seen(sight.name, sight.person.kind, attributes, x, y, True)
    if isinstance(sight, Item):
        return Seen(sight.thing.name, sight.thing.kind, sight.thing.is_, x, y, False)
    return Seen(sight.name, sight.kind, (), x, y, False)


def _is_plural(thing: str, sights: Sequence[Sight]) -> bool:
    """Whether a phrase asks for all or several of them: "objects", "red cups", "2 biggest cups"."""
    if (parse(thing).number or 1) > 1:
        return True
    known = frozenset().union(*(_vocabulary(sight) for sight in sights))
    return any(token in words().several or token not in known for token in parse(thing).words)


def _shown(hospital: Hospital, sight: Sight) -> str:
    """One of several, in few words: "a red cup", "Emma"."""
    seen = _seen(hospital, sight)
    return seen.name if seen.is_person else _a(" ".join([*seen.attributes, seen.name]))


def _a(noun: str) -> str:
    return f"{'an' if noun[:1].lower() in 'aeiou' else 'a'} {noun}"


def _listed(parts: Sequence[str]) -> str:
    return " and ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)
