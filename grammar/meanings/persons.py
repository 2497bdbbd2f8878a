"""Who is meant: by name, kind, pronoun, or as a group."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, Thing, Where
from grammar.errors import NotUnderstood
from grammar.lexicon import nearest
from grammar.meanings.descriptions import described
from grammar.meanings.places import (
    listed,
    owner_of,
    sought,
)
from grammar.meanings.registry import meaning
from grammar.plan import Ask, Items, Text
from grammar.wordforms import singular


@meaning("person_name")
def person_name(d: Discourse, node: Node) -> Thing:
    leaf = node.parts["person"]
    assert isinstance(leaf, Leaf)
    name = d.one_of(leaf).name
    person = Thing(Text(name), known=True, person=True)
    d.people = replace(d.people, named=(*d.people.named, name), last_named=person)
    d.scene = replace(d.scene, person=person)  # "Alice in her office"
    found = replace(described(d, name, node), value=Text(name), known=True, person=True)
    d.scene = d.scene.speaking_of_person(found)
    return found


@meaning("person_unknown")
def person_unknown(d: Discourse, node: Node) -> Thing:
    part = node.parts["stranger"]
    raise unknown_person(d, d.words(part.start, part.end), node)


def unknown_person(d: Discourse, words: str, node: Node) -> NotUnderstood:
    known = nearest(words, d.lexicon.people)
    message = d.language.phrase("unknown_person", name=words)
    if not known:
        message = f"{message} {d.language.phrase('say_who')}"
    span = (node.start, node.end)
    return NotUnderstood(message, known, span if known else (0, 0), gap=span)


@meaning("person_kind")
def person_kind(d: Discourse, node: Node) -> Thing:
    """ "the visitor waving in the lobby", "a nurse", "this gentleman"."""
    kind = str(d.get(node, "kind_of_person", ANYONE))
    if "kind_of_person" in node.parts:
        only_somebody(d, node)
    found = replace(
        by_furniture(d, described(d, kind, node)),
        person=True,
        here=bool(node.production.fixed.get("here")),
        plural=bool(node.production.fixed.get("plural")) or kind_in_plural(d, node),
        every=bool(node.production.fixed.get("plural")),
        noun=kind,
    )
    for each in d.lexicon.people:  # "the person named Alice" is Alice
        if found.text == f"{kind} named {each.name}":
            found = replace(found, value=Text(each.name), known=True)
    found = where_spoken_of(d, node, found)
    d.scene = d.scene.speaking_of_person(found)
    return found


def only_somebody(d: Discourse, node: Node) -> None:
    """Refuse what is to be done to nobody: "dis à personne que je suis parti"."""
    nobody = d.tokens[node.start].norm in d.language.words_called("nobody")
    to = node.start == 1 or d.tokens[node.start - 1].norm in d.language.words_called("to_nobody")
    if nobody and node.start > 0 and to:
        words = d.words(max(0, node.start - 1), node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))


def where_spoken_of(d: Discourse, node: Node, found: Thing) -> Thing:
    """ "there is a visitor at the reception. Bring the visitor to Bob": the one spoken of, as long
    as nobody has led them elsewhere."""
    if found.place is not None or found.furniture is not None or found.plural or found.here:
        return found
    if d.tokens[node.start].norm not in d.language.speech.get("definite", ()):
        return found
    if d.scene.with_person == found.value or found.value in d.scene.left or d.scene.at is not None:
        return found
    spoken_of = (each for each in (d.scene.person, d.people.visitor) if each is not None)
    before = next((each for each in spoken_of if each.value == found.value and each.place), None)
    return found if before is None else replace(found, place=before.place, first=before.first)


def kind_in_plural(d: Discourse, node: Node) -> bool:
    """ "the visitors", not "the visitor"."""
    part = node.parts.get("kind_of_person")
    if not isinstance(part, Leaf):
        return False
    said = " ".join(d.norms(part.start, part.end))
    return singular(said, d.language) != said


def by_furniture(d: Discourse, person: Thing) -> Thing:
    """A person told by the furniture they are at: "woman next to the door"."""
    if person.furniture is None or person.furniture == d.scene.at_furniture:
        return person
    if person.preposition:
        return replace(person, value=sought(d, person), furniture=None)
    at = d.language.phrase("at_furniture", furniture=person.furniture)
    return replace(person, value=Text(f"{person.text} {at}"), furniture=None)


@meaning("person_in")
def person_in(d: Discourse, node: Node) -> Thing:
    """ "bring it to him in his office": where he is to be found."""
    person: Thing = d.get(node, "person_ref")
    d.scene = replace(d.scene, person=person)
    place = d.get(node, "own_place")
    if d.scene.with_person != person.value:
        person = replace(person, place=place, here=False)
    d.scene = replace(d.scene, person=person)
    return person


@meaning("person_pronoun")
def person_pronoun(d: Discourse, node: Node) -> Thing:
    """ "him", "her", "them": whose place this is, the person spoken of last, or whoever is here."""
    articles = d.language.speech.get("articles", ())
    if d.parted(node.start, node.end) and not {*d.norms(node.start, node.end)}.isdisjoint(articles):
        # the "dem" of "zum" is the article of what follows, and nobody
        part = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=part))
    host = host_here(d, node)
    if host is not None:
        d.called_so(host, node.start, node.end)
        d.has_named(host.text)
        d.scene = replace(d.scene, person=host)
        return host
    if (
        d.scene.person is not None
        and is_several(d.scene.person)
        and d.people.last_named is not None
    ):
        several = d.language.speech.get("things_too", ())
        if not set(d.norms(node.start, node.end)) & set(several):
            return d.people.last_named  # "him", after "Alice and Bob ... tell Dr Weber"
    everybody = (
        d.scene.person is not None and d.scene.person.every and d.scene.person.group is not None
    )
    if everybody and not d.is_plural(node):
        # "ask every visitor ... and send him away": each in his turn
        raise NotUnderstood(d.language.phrase("one_person"))
    if d.scene.person is not None and not d.may_be(d.scene.person, node.start, node.end):
        # "ask Bob if he is free; if so, tell Alice, if not, tell her ..."
        other = d.one_called(node.start, node.end)
        if other is not None:
            return replace(other, here=d.scene.with_person == other.value)
        guest = led_there(d)
        if guest is not None:
            d.called_so(guest, node.start, node.end)
            return guest
    if d.scene.person is not None:
        d.called_so(d.scene.person, node.start, node.end)
        met = d.scene.person.here or d.scene.with_person == d.scene.person.value
        elsewhere = d.scene.person.place is not None and not met
        return replace(d.scene.person, here=not elsewhere and (met or not d.scene.person.known))
    owner = owner_of(d)
    if owner is not None:
        d.has_named(owner.value)
        host = Thing(owner, known=True, person=True, here=True)
        d.called_so(host, node.start, node.end)
        return host
    if d.people.last_named is not None and d.scene.with_person is None and not d.is_plural(node):
        return d.people.last_named  # somebody named in the other branch
    return Thing(d.scene.with_person or Text(ANYONE), person=True, here=True)


def guest_for(d: Discourse, part: Leaf | Node | None, person: Thing | None) -> Thing | None:
    """ "take the visitor to Bob. If he is not there, tell him to wait": who is spoken to or led is
    not Bob, who was just said not to be there."""
    guest: Thing | None = d.scene.led
    if guest is None or person is None or d.scene.missing is None or not isinstance(part, Node):
        return person
    by_pronoun = part.means in ("person_pronoun", "thing_it")
    missing = d.scene.missing.value == person.value
    return replace(guest, here=True) if by_pronoun and missing else person


def led_there(d: Discourse) -> Thing | None:
    """Somebody without a name who was led where the robot is: "take the visitor to Clara. If she is
    not there, tell him to wait"; he is not Clara."""
    named = {each.name for each in d.lexicon.people}
    led = (
        each
        for each, place in d.scene.left.items()
        if place == d.scene.at and isinstance(each, Text)
    )
    guest = next((each for each in led if each.value not in named), None)
    return None if guest is None else Thing(guest, person=True, here=True)


def is_several(person: Thing) -> bool:
    """Whether somebody is a group, or all who are somewhere."""
    return person.group is not None or person.plural


def host_here(d: Discourse, node: Node) -> Thing | None:
    """Whoever's place the robot was sent to, if nobody was spoken of since: "tell Alice that ...
    Then go to Bob's office and ask him ..."."""
    owner = owner_of(d) if d.scene.at is not None and d.scene.place == d.scene.at else None
    before = d.scene.person
    if owner is None or before is None or d.is_plural(node):
        return None
    host = Thing(owner, known=True, person=True, here=True)
    said_to_be_here = before.place == d.scene.at and not before.here
    left = not before.known and d.scene.with_person is None  # a visitor who was left behind
    nearer = before is d.scene.person_on_arrival and not said_to_be_here and before.value != owner
    if not (left or nearer):
        return None
    return host if d.may_be(host, node.start, node.end) else None


@meaning("person_group")
def person_group(d: Discourse, node: Node) -> Thing:
    """ "Alice, Bob and Carol"."""
    person = together(listed(d, node))
    d.scene = replace(d.scene, person=person, group=person.group)
    return person


@meaning("person_either")
def person_either(d: Discourse, node: Node) -> list[Thing] | Thing:
    """ "Alice or Bob": one of them; for a condition, both as a group."""
    people = listed(d, node)
    return people if d.loops.taking_apart else together(people)


def known_by_name(d: Discourse, found: Thing, kind: str) -> tuple[Text, ...]:
    """All people of a kind, if the world knows them by name and nothing tells which are meant."""
    here = found.place is not None or d.scene.at is not None
    if found.text != kind or here or kind in ("visitor", "patient"):
        return ()
    return tuple(Text(each.name) for each in d.lexicon.people if each.kind == kind)


@meaning("person_group_kind")
def person_group_kind(d: Discourse, node: Node) -> Thing:
    """ "all nurses": those whom the world knows by name; of others, whoever is there."""
    kind = str(d.get(node, "kind_of_person", ANYONE))
    found = replace(by_furniture(d, described(d, kind, node)), person=True, plural=True)
    but: Thing | None = d.get(node, "but")
    named = known_by_name(d, found, kind)
    if named:
        left_out = but.group.items if but and isinstance(but.group, Items) else (but and but.value,)
        d.scene = replace(
            d.scene, group=Items(tuple(name for name in named if name not in left_out))
        )
        return replace(found, known=True, group=d.scene.group)
    if but is not None:
        if found.text != ANYONE:
            raise NotUnderstood(d.language.phrase("but_whom"))
        found = replace(found, but=but.group or Items((but.value,)))
    d.scene = replace(d.scene, group=Ask("people"))
    d.scene = d.scene.speaking_of_person(found)
    return replace(found, group=d.scene.group, every=True)


@meaning("person_count")
def person_count(d: Discourse, node: Node) -> Thing:
    """ "three visitors": one after the other, whoever they are."""
    kind = str(d.get(node, "kind_of_person", ANYONE))
    found = replace(described(d, kind, node), person=True, plural=True)
    spot: Where | None = d.get(node, "from")
    found = found if spot is None else replace(found, place=spot.place)
    number = int(d.get(node, "count"))
    named = known_by_name(d, found, kind)
    if d.tokens[node.start].norm in d.language.speech.get("definite", ()) and len(named) == number:
        d.scene = replace(
            d.scene, group=Items(named)
        )  # "the two doctors", where the world knows two
        return replace(found, known=True, group=d.scene.group)
    found = replace(found, count=number)
    d.scene = d.scene.speaking_of_person(replace(found, here=True, plural=False))
    return found


@meaning("person_coming")
def person_coming(d: Discourse, node: Node) -> Thing:
    """ "every visitor who comes in": one after the other, without end."""
    kind = str(d.get(node, "kind_of_person", ANYONE))
    found = Thing(Text(kind), person=True, here=True)
    d.scene = d.scene.speaking_of_person(found)
    spot: Where | None = d.get(node, "from")
    return replace(found, coming=True, place=None if spot is None else spot.place)


@meaning("whoever_at")
def whoever_at(d: Discourse, node: Node) -> Thing:
    """ "tell reception", "ask the kitchen": whoever is there."""
    person = Thing(Text(ANYONE), d.get(node, "place"), person=True)
    d.scene = d.scene.speaking_of_person(person)
    return person


@meaning("person_first")
def person_first(d: Discourse, node: Node) -> Thing:
    """ "the first visitor you meet": whoever comes first; on guard, each of them."""
    if d.people.came is not None:  # "wait for Alice or Bob and take whoever comes first ..."
        d.scene = d.scene.speaking_of_person(d.people.came)
        return d.people.came
    if d.people.on_duty == "guard" and node.production.fixed.get("whoever"):
        return person_coming(d, node)
    kind = str(d.get(node, "kind_of_person", ANYONE))
    found = replace(by_furniture(d, described(d, kind, node)), person=True, first=True)
    d.scene = d.scene.speaking_of_person(replace(found, first=False, place=None, here=True))
    return found


@meaning("person_group_them")
def person_group_them(d: Discourse, node: Node) -> Thing:
    """ "both of them", "each of them"."""
    if d.scene.group is None:
        found = d.scene.person or Thing(Text(ANYONE), person=True)
        if found.count is not None:  # "we expect two visitors": each of the two
            return replace(found, plural=True)
        return replace(found, here=True, plural=True, every=True)
    return Thing(Text(ANYONE), person=True, plural=True, known=True, group=d.scene.group)


@meaning("person_me")
def person_me(d: Discourse, node: Node) -> Thing:
    return Thing(Text(ANYONE), person=True, here=True, me=True)


def is_me(person: Thing | None) -> bool:
    return person is not None and person.me


def together(several: list[Thing]) -> Thing:
    """Several people or things as one group."""
    names = Items(tuple(each.value for each in several))
    people = all(each.person for each in several)
    return Thing(Text(ANYONE), person=people, plural=True, known=True, group=names)
