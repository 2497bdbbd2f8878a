"""Several places spoken of at once by what their names have in common: "offices 1 to 4", "wards a
and c", "Alice's and Bob's office"."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse
from grammar.errors import NotUnderstood
from grammar.lexicon import Name, series_of
from grammar.meanings.places import is_of, kind_places, unknown_place
from grammar.meanings.registry import meaning
from grammar.plan import Ask, Items, Text, Value


@meaning("all_places")
def all_places(d: Discourse, node: Node) -> Value:
    """ "every office but Bob's", "the other labs", "the first two wards", "offices 1 to 4"."""
    if "place" in node.parts:  # "the kitchen and the lounge"
        return Items((d.get(node, "place"), *d.get(node, "place_list")))
    kind: str | None = d.get(node, "kind") or d.get(node, "kinds")
    fixed = node.production.fixed
    but: list[Value | None] = [d.get(node, "but"), *(d.get(node, "place_list") or [])]
    number = d.get(node, "number")
    skipped = d.get(node, "skipped")
    if skipped is not None:  # "all labs but the first one"
        left = list(d.lexicon.place_kinds[str(kind)])
        position = int(skipped) - 1 if int(skipped) > 0 else int(skipped)
        if not -len(left) <= position < len(left):
            raise NotUnderstood(d.language.phrase("which_places"))
        del left[position]
        return Items(tuple(Text(each.name) for each in left))
    if but == [None] and number is None and not fixed.get("other"):
        return kind_places(d, kind)
    if fixed.get("other"):
        but = [d.scene.place, *(d.get(node, "place_list") or [])]
    known = d.lexicon.place_kinds[kind] if kind else d.lexicon.places
    but = [owned_by(d, known, each) if isinstance(each, str) else each for each in but]
    names = [Text(each.name) for each in known if Text(each.name) not in but]
    lost = [each for each in but if each is not None and not isinstance(each, Text)]
    if lost or (fixed.get("other") and (d.scene.place is None or len(names) == len(known))):
        raise NotUnderstood(d.language.phrase("which_places"))
    if number is not None and int(number) != len(names):
        if not fixed.get("from_first") or int(number) > len(names):
            raise NotUnderstood(d.language.phrase("which_places"))
        names = names[: int(number)] if fixed["from_first"] > 0 else names[-int(number) :]
    return Items(tuple(names))


def owned_by(d: Discourse, places: Sequence[Name], owner: str) -> Text:
    """Whichever of some places is somebody's: "the one of Alice"."""
    found = next((each for each in places if is_of(d, each.name, owner)), None)
    if found is None:
        raise NotUnderstood(d.language.phrase("which_places"))
    return Text(found.name)


@meaning("places_numbered")
def places_numbered(d: Discourse, node: Node) -> Value:
    """ "offices 1 to 4", "copy rooms 1, 2 and 3", "wards a and c"."""
    kind = str(d.get(node, "kind"))
    numbered: dict[str, Name] = {}
    for place in d.lexicon.place_kinds[kind]:
        if series_of(place.name) is not None:
            numbered.setdefault(place.name.lower().split()[-1], place)
    first, last = str(d.get(node, "first")), d.get(node, "last")
    wanted = [first, *(d.get(node, "rest") or [])] if last is None else _between(first, str(last))
    missing = [each for each in wanted if each not in numbered]
    if missing or not wanted:
        raise unknown_place(d, f"{kind} {missing[0] if missing else first}", node)
    return Items(tuple(Text(numbered[each].name) for each in wanted))


def _between(first: str, last: str) -> list[str]:
    """The numbers, or the letters, from one to another."""
    if first.isdigit() and last.isdigit():
        return [str(each) for each in range(int(first), int(last) + 1)]
    if len(first) == len(last) == 1:
        return [chr(each) for each in range(ord(first), ord(last) + 1)]
    return []


@meaning("places_alternate")
def places_alternate(d: Discourse, node: Node) -> Value:
    """ "the even-numbered offices": those whose names end with such a number."""
    odd = int(node.production.fixed["odd"])
    known = d.lexicon.place_kinds[str(d.get(node, "kinds"))]
    numbers = {each: each.name.split()[-1] for each in known}
    such = [each for each in known if numbers[each].isdigit() and int(numbers[each]) % 2 == odd]
    return some_of(d, node, such)


@meaning("places_within")
def places_within(d: Discourse, node: Node) -> Value:
    """ "the labs on the first floor": those that the world says to be a part of it."""
    kind = d.get(node, "kinds")
    known = d.lexicon.places if kind is None else d.lexicon.place_kinds[str(kind)]
    area = str(d.get(node, "area"))
    return some_of(d, node, [each for each in known if each.inside == area])


def some_of(d: Discourse, node: Node, places: list[Name]) -> Value:
    """Some places as a round. Raises `NotUnderstood` if there are none."""
    if not places:
        raise unknown_place(d, d.words(node.start, node.end), node)
    return Items(tuple(Text(each.name) for each in places))


@meaning("places_joined")
def places_joined(d: Discourse, node: Node) -> Value:
    """ "all meeting rooms and lecture halls", "the wards and the lobby": one round of all."""
    first: Value = d.get(node, "first")
    rest: Value | None = d.get(node, "rest")
    if rest is None:
        return first
    names = [name for part in (first, rest) for name in names_of(d, part)]
    return Items(tuple(dict.fromkeys(names)))


def names_of(d: Discourse, places: Value | str) -> list[Value]:
    """The places that are meant, each by its name."""
    known = kind_places(d, places)
    if isinstance(known, Ask):
        kind = known.arguments.get("kind")
        found = d.lexicon.place_kinds[kind.value] if isinstance(kind, Text) else d.lexicon.places
        return [Text(each.name) for each in found]
    return list(known.items) if isinstance(known, Items) else [known]


@meaning("place_left")
def place_left(d: Discourse, node: Node) -> Value | str:
    """What is left out: a place, or whose it is."""
    owner: str | None = d.get(node, "owner")
    return d.get(node, "place") if owner is None else owner


@meaning("owner_list")
@meaning("tail_list")
def rest_of_list(d: Discourse, node: Node) -> list[str]:
    """ "2 and 3" of "offices 1, 2 and 3", "Bob's and Clara's" of "Alice's, Bob's and Clara's"."""
    return [str(d.get(node, "first")), *(d.get(node, "rest") or [])]


@meaning("tail")
def tail(d: Discourse, node: Node) -> str:
    """What tells a place from others of its kind: a number, also in words, or a letter."""
    (part,) = node.parts.values()
    assert isinstance(part, Leaf)
    number = isinstance(part.value, int | float)
    return f"{part.value:g}" if number else d.tokens[part.start].norm


@meaning("place_tail")
def place_tail(d: Discourse, node: Node) -> Value:
    """ "b" in "ward a, b and c": a place of the same kind as the one before."""
    leaf = node.parts["place_tail"]
    assert isinstance(leaf, Leaf)
    before = d.scene.place.value if isinstance(d.scene.place, Text) else ""
    kind = next((place.kind for place in d.lexicon.places if place.name == before), None)
    alike = [name.name for name in leaf.value if name.kind == kind and name.name != before]
    if len(alike) > 1:  # of the same series: "meeting room 1 or 2"
        series = before.rsplit(" ", 1)[0]
        alike = [name for name in alike if name.rsplit(" ", 1)[0] == series]
    if kind is None and len(leaf.value) == 1:  # "every ward but c"
        alike = [leaf.value[0].name]
    if len(alike) != 1:
        raise NotUnderstood(
            d.language.phrase("unknown_place", name=d.words(node.start, node.end)),
            tuple(name.name for name in leaf.value),
            (node.start, node.end),
        )
    place = Text(alike[0])
    d.scene = replace(d.scene, place=place)
    return place


@meaning("places_owned")
def places_owned(d: Discourse, node: Node) -> Value:
    """ "Alice's, Bob's and Clara's offices"."""
    kind = str(d.get(node, "kind"))
    names: list[Value] = []
    for owner in (d.get(node, "first"), *d.get(node, "rest")):
        known = (each.name for each in d.lexicon.place_kinds[kind])
        place = next((name for name in known if is_of(d, name, owner)), None)
        if place is None:
            raise unknown_place(d, f"{d.words(node.start, node.end)} ({owner})", node)
        names.append(Text(place))
    return Items(tuple(names))


@meaning("owner_name")
def owner_name(d: Discourse, node: Node) -> str:
    """ "Bob's", whose place is named behind others'."""
    leaf = node.parts["person"]
    assert isinstance(leaf, Leaf)
    return d.one_of(leaf).name


@meaning("places_listed")
def places_listed(d: Discourse, node: Node) -> Value:
    """ "the lobby and the kitchen": gone round like all places of a kind."""
    places = (d.get(node, "place"), *d.get(node, "place_list"))
    if not all(isinstance(each, Text) for each in places):
        raise NotUnderstood(d.language.phrase("which_places"))
    return Items(places)
