"""Places: by name, by kind, by whose they are, by what is there; and where in them."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Thing, Where
from grammar.errors import NotUnderstood
from grammar.lexicon import nearest
from grammar.meanings.registry import meaning
from grammar.plan import Ask, Call, Items, Recall, Remember, Text, Value


@meaning("place_name")
def place_name(d: Discourse, node: Node) -> Value:
    place: Value = d.get(node, "place")
    d.scene = replace(d.scene, place=place)
    return place


@meaning("each_place")
def each_place(d: Discourse, node: Node) -> Value:
    """ "every office": the places, for a loop (`grammar.meanings.quantifiers`)."""
    only_taken_apart(d, node)
    if "place" in node.parts:
        return Items((d.get(node, "place"), *d.get(node, "place_list")))
    return kind_places(d, d.get(node, "places"))


def only_taken_apart(d: Discourse, node: Node) -> None:
    """Refuse a phrase that speaks of several where nothing makes a loop of it."""
    if not d.loops.taking_apart:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("one_of_several", words=words))


@meaning("place_unknown")
def place_unknown(d: Discourse, node: Node) -> Value:
    raise unknown_place(d, d.words(node.parts["unknown"].start, node.parts["unknown"].end), node)


def unknown_place(d: Discourse, words: str, node: Leaf | Node) -> NotUnderstood:
    capitals = any(token.capital for token in d.tokens[node.start : node.end] if token.start)
    known = words.lower() in (each.name.lower() for each in d.lexicon.people)
    if capitals and not known and not d.language.speech.get("capital_nouns"):
        return NotUnderstood(
            d.language.phrase("unknown_name", name=words),
            nearest(words, (*d.lexicon.places, *d.lexicon.people)),
            (node.start, node.end),
        )
    return NotUnderstood(
        d.language.phrase("unknown_place", name=words),
        nearest(words, d.lexicon.places),
        (node.start, node.end),
    )


@meaning("place_of_owner")
def place_of_owner(d: Discourse, node: Node) -> Value:
    """ "Alice's": the one place that is called after her."""
    leaf = node.parts["person"]
    assert isinstance(leaf, Leaf)
    return place_called_after(d, d.one_of(leaf).name, node)


def place_called_after(d: Discourse, owner: str, node: Leaf | Node) -> Value:
    own = [each.name for each in d.lexicon.places if is_of(d, each.name, owner)]
    if not own:
        raise unknown_place(d, d.words(node.start, node.end), node)
    if len(own) > 1:
        raise d.which(node.start, node.end, tuple(own))
    place = Text(own[0])
    d.scene = replace(d.scene, place=place)
    return place


@meaning("place_any")
def place_any(d: Discourse, node: Node) -> Value:
    """ "any office": whichever; the only one if there is no other."""
    only_taken_apart(d, node)
    if "first" in node.parts:  # "the kitchen or the lobby, you choose"
        return Items((d.get(node, "first"), d.get(node, "second")))
    places = d.lexicon.place_kinds[d.get(node, "kind")]
    if len(places) == 1:
        return Text(places[0].name)
    return kind_places(d, d.get(node, "kind"))


@meaning("place_either")
def place_either(d: Discourse, node: Node) -> list[Value]:
    """ "the lobby or the kitchen"."""
    only_taken_apart(d, node)
    return [d.get(node, "first"), d.get(node, "second")]


@meaning("place_where")
def place_where(d: Discourse, node: Node) -> Thing:
    """ "where Bob is", "a room with a printer": wherever that is found."""
    only_taken_apart(d, node)
    before = d.scene
    found: Thing = d.get(node, "thing") or d.get(node, "person_ref")
    if stands_behind_it(d, node):
        d.scene = d.scene.with_it_of(before)
    return found


def stands_behind_it(d: Discourse, node: Node) -> bool:
    """Whether what was spoken of before is what goes there: "get the soap and put it where the
    towel is"."""
    before = d.norms(max(0, node.start - 2), node.start)
    return not {*before}.isdisjoint(d.language.speech.get("things_too", ()))


@meaning("where_owned")
def where_owned(d: Discourse, node: Node) -> Where:
    """ "Bob's desk", "his desk": the desk in Bob's office."""
    if "person" in node.parts:
        return Where(place_of_owner(d, node), d.get(node, "furniture"))
    owner = (
        d.scene.person.value if d.scene.person is not None and d.scene.person.known else owner_of(d)
    )
    if not isinstance(owner, Text):
        word = d.words(node.start, node.start + 1)
        raise NotUnderstood(d.language.phrase("what_is_it", word=word), gap=(node.start, node.end))
    return Where(place_called_after(d, owner.value, node), d.get(node, "furniture"))


@meaning("where")
def where(d: Discourse, node: Node) -> Where:
    furniture = d.get(node, "furniture")
    if furniture is not None:
        furniture = piece_called(d, furniture)
    place = d.get(node, "place_at") or d.get(node, "place")
    if place is None and "beside" in node.parts:  # "the sofa by the window"
        place = home_of(d, d.get(node, "beside"))
    if place is None and furniture:
        place = home_of(d, furniture)
    return Where(place, furniture)


def piece_called(d: Discourse, furniture: str) -> str:
    """The one piece of the world that goes by a word for this furniture: "trash" for its bin; else
    what any furniture of the kind is called."""
    words = d.language.lists["furniture"].get(furniture, ())
    pieces = {
        piece.name
        for piece in d.lexicon.furniture
        if any(d.language.tokens_of(name) in words for name in (piece.name, *piece.aliases))
    }
    return furniture if furniture in pieces or len(pieces) != 1 else pieces.pop()


def extraposed(d: Discourse, part: Leaf | Node | None) -> tuple[Where, Where] | None:
    """ "put the comb on the table that is in the bathtub": where the comb goes and where it is, if
    the furniture that it goes to stands elsewhere by all that is known."""
    spot = part.parts.get("spot", part) if isinstance(part, Node) else None
    if not isinstance(spot, Node) or "furniture" not in spot.parts:
        return None
    source = Where(d.get(spot, "place_at"))
    if "beside" in spot.parts:
        beside = piece_called(d, d.get(spot, "beside"))
        words = d.norms(spot.parts["furniture"].end, spot.parts["beside"].start)
        stands = d.language.speech.get("stands", {})
        how = next((stands[word] for word in words if word in stands), "")
        source = Where(home_of(d, beside), beside, preposition=how)
    furniture = piece_called(d, d.get(spot, "furniture"))
    named = (each for each in d.lexicon.furniture if furniture in (each.name, each.kind))
    homes = {each.inside for each in named if each.inside}  # of the kitchen table, too
    if not isinstance(source.place, Text) or not homes or source.place.value in homes:
        return None
    return Where(home_of(d, furniture), furniture), source


@meaning("where_it")
def where_it(d: Discourse, node: Node) -> Where:
    """ "go to the shelf and put the cup on it"."""
    if d.scene.at is None and d.scene.at_furniture is None:
        raise NotUnderstood(d.language.phrase("where_is_there"))
    return Where(d.scene.at, d.scene.at_furniture)


@meaning("where_is")
def where_is(d: Discourse, node: Node) -> Where:
    """A preposition and a spot: "on the table"."""
    spot: Where = d.get(node, "spot")
    words = " ".join(d.norms(node.start, node.parts["spot"].start))
    return replace(spot, preposition=d.language.speech.get("stands", {}).get(words, ""))


def home_of(d: Discourse, furniture: str) -> Value | None:
    """The place a piece of furniture stands in: where the robot is, or where the world says."""
    homes = {
        each.inside
        for each in d.lexicon.furniture
        if furniture in (each.name, *each.aliases) and each.inside
    }
    if isinstance(d.scene.at, Text) and d.scene.at.value in homes:
        return d.scene.at
    return Text(homes.pop()) if len(homes) == 1 else None


@meaning("place_list")
def place_list(d: Discourse, node: Node) -> list[Value]:
    first = d.get(node, "place")
    rest = d.get(node, "place_list")
    return [first, *(rest or [])]


@meaning("place_of_furniture")
def place_of_furniture(d: Discourse, node: Node) -> Value:
    """ "wait at the main entrance": the place where it is."""
    furniture = d.get(node, "furniture")
    home = home_of(d, furniture)
    if home is None:
        raise NotUnderstood(d.language.phrase("unknown_place", name=furniture))
    d.scene = replace(d.scene, place=home)
    return home


def kind_places(d: Discourse, kind: str | Value | None) -> Value:
    """All places of a kind, asked of the robot; those of a series by their names, and those that a
    noun phrase speaks of as they are."""
    if isinstance(kind, str) and d.lexicon.is_series(kind):
        return Items(tuple(Text(each.name) for each in d.lexicon.place_kinds[kind]))
    if kind is None or isinstance(kind, str):
        return Ask("places", {"kind": Text(kind)} if kind else {})
    return kind


def owner_of(d: Discourse) -> Text | None:
    """Whose place was spoken of last: Bob, after "Bob's office"."""
    if isinstance(d.scene.place, Text):
        for person in d.lexicon.people:
            if is_of(d, d.scene.place.value, person.name):
                return Text(person.name)
    return None


def is_of(d: Discourse, place: str, owner: str) -> bool:
    """Whether a place is called after somebody: "Bob's office", "bureau de Bob"."""
    if place.lower().startswith(owner.lower() + d.language.speech["possessive"]):
        return True
    forms: list[str] = d.language.speech.get("owned_places", [])
    return any(re.search(form.format(owner=re.escape(owner)), place, re.I) for form in forms)


def own_place(d: Discourse, person: Thing) -> Text | None:
    """The one place that is called after somebody."""
    own = [each.name for each in d.lexicon.places if is_of(d, each.name, person.text)]
    return Text(own[0]) if person.text and len(own) == 1 else None


def at_own_place(d: Discourse, person: Thing) -> Thing:
    """Somebody who "is in", unless the robot was just sent to a place: where they work."""
    last = d.done[-1] if d.done else None
    sent = last is None or (isinstance(last, Call) and last.method in ("goto", "guide"))
    spoken_of = (d.scene.at is not None or d.scene.place is not None) and sent
    return person if spoken_of or d.loops.in_loop else replace(person, place=own_place(d, person))


def listed(d: Discourse, node: Node) -> list[Thing]:
    """The noun phrases of a list: `first`, then `rest`."""
    found: list[Thing] = []
    each: Any = node
    while isinstance(each, Node) and "first" in each.parts:
        found.append(d.build(each.parts["first"]))
        each = each.parts.get("rest")
    if isinstance(each, Node):
        found.append(d.build(each))
    return found


def source_of(d: Discourse, thing: Thing) -> Value | None:
    """The place where a thing was taken, remembered from there on."""
    for at in range(len(d.done) - 1, -1, -1):
        step = d.done[at]
        if (
            isinstance(step, Call)
            and step.method == "grab"
            and step.arguments["thing"]
            in (
                thing.value,
                sought(d, thing),
            )
        ):
            source = d.variable("source")
            d.done.insert(at + 1, Remember(source, Ask("location", field="place")))
            return Recall(source)
    return None


def sought(d: Discourse, thing: Thing) -> Value:
    """The thing as the robot is to look for it: "cup on the table"."""
    if thing.count is not None and not thing.person and isinstance(thing.value, Text):
        thing = replace(thing, value=Text(f"{thing.count} {thing.text}"), count=None)
    named = thing.person and thing.known  # somebody by name is told by nothing else
    if thing.furniture and thing.preposition and isinstance(thing.value, Text) and not named:
        near = d.language.phrase(
            "by_furniture", preposition=thing.preposition, furniture=thing.furniture
        )
        return Text(f"{thing.value.value} {near}")
    if thing.furniture and isinstance(thing.value, Text) and not thing.person:
        on = d.language.phrase("on_furniture", furniture=thing.furniture)
        return Text(f"{thing.value.value} {on}")
    nowhere = thing.place is None or (thing.furniture and home_of(d, thing.furniture) is None)
    if thing.furniture and isinstance(thing.value, Text) and not thing.known and nowhere:
        return Text(
            f"{thing.value.value} {d.language.phrase('at_furniture', furniture=thing.furniture)}"
        )
    return thing.value
