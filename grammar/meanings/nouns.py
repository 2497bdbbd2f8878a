"""Noun phrases: things, people, places, quantities and times."""

from __future__ import annotations

from typing import Any

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, NotUnderstood, Thing, Where, as_value
from grammar.lexicon import Name
from grammar.meanings.registry import meaning
from grammar.plan import Ask, Number, Recall, Text, Value
from grammar.wordforms import singular

# --- places


@meaning("place_name")
def place_name(d: Discourse, node: Node) -> Value:
    place: Value = d.get(node, "place")
    d.place = place
    return place


@meaning("place_of_kind")
def place_of_kind(d: Discourse, node: Node) -> Value:
    """ "the office": the only one there is, else the question which."""
    kind = d.get(node, "kind")
    places = d.lexicon.place_kinds[kind]
    if len(places) > 1:
        raise d.which(node.start, node.end, tuple(place.name for place in places))
    d.place = Text(places[0].name)
    return d.place


@meaning("place_there")
def place_there(d: Discourse, node: Node) -> Value:
    if d.place is None:
        raise NotUnderstood(d.language.phrase("where_is_there"))
    return d.place


@meaning("place_here")
def place_here(d: Discourse, node: Node) -> Value:
    return d.start() if d.at is None else d.at


@meaning("place_start")
def place_start(d: Discourse, node: Node) -> Value:
    return d.start()


@meaning("place_unknown")
def place_unknown(d: Discourse, node: Node) -> Value:
    words = d.words(node.parts["unknown"].start, node.parts["unknown"].end)
    raise NotUnderstood(
        d.language.phrase("unknown_place", name=words), nearest(words, d.lexicon.places)
    )


def nearest(words: str, names: tuple[Name, ...]) -> tuple[str, ...]:
    """The names most like some words, the best first."""
    from rapidfuzz import fuzz, process

    choices = {text: name.name for name in names for text in (name.name, *name.aliases)}
    found = process.extract(words.lower(), list(choices), scorer=fuzz.WRatio, limit=6)
    return tuple(dict.fromkeys(choices[text] for text, _, _ in found))[:3]


@meaning("where")
def where(d: Discourse, node: Node) -> Where:
    furniture = d.get(node, "furniture")
    place = d.get(node, "place_at") or d.get(node, "place")
    if place is None and furniture:
        place = home_of(d, furniture)
    return Where(place, furniture)


def home_of(d: Discourse, furniture: str) -> Value | None:
    """The place a piece of furniture stands in, where the world says so."""
    homes = {each.inside for each in d.lexicon.furniture if each.name == furniture and each.inside}
    return Text(homes.pop()) if len(homes) == 1 else None


@meaning("place_list")
def place_list(d: Discourse, node: Node) -> list[Value]:
    first = d.get(node, "place")
    rest = d.get(node, "place_list")
    return [first, *(rest or [])]


# --- things


@meaning("thing")
def thing(d: Discourse, node: Node) -> Thing:
    """A noun with its adjectives; what follows it ("in the kitchen", "that is red") is added."""
    head = node.parts["head"]
    assert isinstance(head, Leaf)
    words = " ".join(d.norms(head.start, head.end))
    name: str = head.value[0] if isinstance(head.value, tuple) else words
    if head.slot == "object":
        adjectives = node.parts.get("adjectives")
        if adjectives is not None:
            name = f"{' '.join(d.norms(adjectives.start, adjectives.end))} {name}"
    one = singular(name, d.language)
    after = d.get(node, "after")
    if after:
        one = f"{one} {after}"
    at: Where = d.get(node, "where") or Where()
    found = Thing(
        Text(one),
        place=at.place,
        furniture=at.furniture,
        known=head.slot == "object",
        plural=one != name,
        here=bool(node.production.fixed.get("here")),
    )
    d.thing, d.thing_last = found, True
    return found


@meaning("thing_it")
def thing_it(d: Discourse, node: Node) -> Thing:
    if d.thing is not None:
        return Thing(d.thing.value, known=d.thing.known, here=True)
    if d.holding is not None:
        return Thing(d.holding, here=True)
    raise NotUnderstood(d.language.phrase("what_is_it", word=d.words(node.start, node.end)))


@meaning("descriptor")
def descriptor(d: Discourse, node: Node) -> str:
    """What stands after a noun and tells it from others: "waving", "with a red shirt"."""
    form: str = node.production.fixed.get("form", "{what}")
    part = node.parts.get("what")
    what = "" if part is None else " ".join(d.norms(part.start, part.end))
    if isinstance(part, Leaf) and isinstance(part.value, tuple):
        what = str(part.value[0])
    return form.format(what=what)


# --- people


@meaning("person_name")
def person_name(d: Discourse, node: Node) -> Thing:
    leaf = node.parts["person"]
    assert isinstance(leaf, Leaf)
    at: Where = d.get(node, "where") or Where()
    found = Thing(Text(d.one_of(leaf).name), place=at.place, known=True, person=True)
    d.person, d.thing_last = found, False
    return found


@meaning("person_kind")
def person_kind(d: Discourse, node: Node) -> Thing:
    """ "the visitor waving in the lobby", "a nurse", "this gentleman"."""
    kind = d.get(node, "kind_of_person", ANYONE)
    words = [str(kind)]
    adjectives = node.parts.get("adjectives")
    if adjectives is not None:
        words.insert(0, " ".join(d.norms(adjectives.start, adjectives.end)))
    after = d.get(node, "after")
    if after:
        words.append(after)
    at: Where = d.get(node, "where") or Where()
    found = Thing(
        Text(" ".join(words)),
        place=at.place,
        furniture=at.furniture,
        person=True,
        here=bool(node.production.fixed.get("here")),
        plural=bool(node.production.fixed.get("plural")),
    )
    d.person, d.thing_last = found, False
    return found


@meaning("person_pronoun")
def person_pronoun(d: Discourse, node: Node) -> Thing:
    """ "him", "her", "them": the person spoken of last, else whoever is here."""
    if d.person is not None:
        return Thing(d.person.value, known=d.person.known, person=True, here=True)
    owner = owner_of(d)
    if owner is not None:
        return Thing(owner, known=True, person=True, here=True)
    return Thing(d.with_person or Text(ANYONE), person=True, here=True)


def owner_of(d: Discourse) -> Text | None:
    """Whose place was spoken of last: Bob, after "Bob's office"."""
    if isinstance(d.place, Text):
        for person in d.lexicon.people:
            if d.place.value.lower().startswith(
                person.name.lower() + d.language.speech["possessive"]
            ):
                return Text(person.name)
    return None


@meaning("person_me")
def person_me(d: Discourse, node: Node) -> Thing:
    return Thing(Recall("me"), person=True, here=True)


def is_me(person: Thing | None) -> bool:
    return person is not None and person.value == Recall("me")


# --- quantities: always in the unit of the method table


@meaning("quantity")
def quantity(d: Discourse, node: Node) -> float:
    number = d.get(node, "number", 1.0)
    more = d.get(node, "more", 0.0)
    result: float = float(number) * float(node.production.fixed.get("unit", 1)) + float(more)
    return result


@meaning("negative")
def negative(d: Discourse, node: Node) -> float:
    value: float = -d.get(node, "quantity")
    return value


@meaning("clock_time")
def clock_time(d: Discourse, node: Node) -> str:
    """A time of day as "HH:MM"."""
    fixed = node.production.fixed
    if "time" in fixed:
        return str(fixed["time"])
    given = d.get(node, "clock")
    if given:
        hours, minutes = (int(part) for part in given.split(":"))
    else:
        hours = int(d.get(node, "hour"))
        minutes = int(d.get(node, "minute", 0))
    minutes += int(fixed.get("add", 0))
    if fixed.get("to"):
        minutes = 60 - minutes
        hours -= 1
    half = d.get(node, "half_of_day")
    if half == "pm" and hours < 12:
        hours += 12
    if half == "am" and hours == 12:
        hours = 0
    if not (0 <= hours < 24 and 0 <= minutes < 60):
        raise NotUnderstood(d.language.phrase("no_such_time", time=d.words(node.start, node.end)))
    return f"{hours:02}:{minutes:02}"


def kind_places(d: Discourse, kind: str | None) -> Ask:
    """All places of a kind, asked of the robot."""
    return Ask("places", {"kind": Text(kind)} if kind else {})


def number_value(value: Any) -> Number:
    result = as_value(value)
    assert isinstance(result, Number)
    return result


@meaning("fixed")
def fixed(d: Discourse, node: Node) -> Any:
    """A value that the rule states itself."""
    return node.production.fixed["value"]
