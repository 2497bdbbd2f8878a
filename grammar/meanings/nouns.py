"""Noun phrases: things and people, and what follows their nouns."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, NotUnderstood, Thing, Where
from grammar.meanings.genders import means_receiver, means_thing
from grammar.meanings.places import (
    home_of,
    listed,
    nearest,
    only_taken_apart,
    owner_of,
    sought,
    source_of,
    unknown_place,
)
from grammar.meanings.registry import meaning
from grammar.plan import Ask, Items, Text, Value
from grammar.wordforms import head_word, singular

# --- what follows a noun


@meaning("mods")
def mods(d: Discourse, node: Node) -> list[Where | str]:
    """All that follows a noun: where it is, and what tells it from others."""
    part = node.parts["first"]
    says_nothing = isinstance(part, Node) and not part.parts and part.production.means is None
    first = None if says_nothing else d.build(part)  # "the bottle you can find"
    found = [first] if isinstance(first, Where) or (isinstance(first, str) and first) else []
    if isinstance(first, list):
        found = first
    words = d.norms(node.parts["first"].start, node.parts["first"].end)
    if words[-1] in d.language.speech.get("pointing", ()):
        found = []  # "the woman there": nothing that tells her from others
    return [*found, *(d.get(node, "rest") or [])]


@meaning("where_pointed")
def where_pointed(d: Discourse, node: Node) -> str:
    """ "in it", "on them": where the robot is by what was said; of nothing spoken of, nowhere."""
    if not (d.place or d.thing or d.at or d.at_furniture or d.person):
        raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))
    return ""


@meaning("descriptor")
def descriptor(d: Discourse, node: Node) -> str:
    """What stands after a noun and tells it from others: "waving", "with a red shirt"."""
    form: str = node.production.fixed.get("form", "{what}")
    words = {name: d.described_by(part) for name, part in node.parts.items()}
    return form.format_map({"what": "", **words})


@meaning("attributes")
def attributes(d: Discourse, node: Node) -> str:
    """Adjectives one after the other."""
    return " ".join(d.described_by(part) for part in node.parts.values())


@meaning("descriptor_fixed")
def descriptor_fixed(d: Discourse, node: Node) -> str:
    """What is said after a noun, but is a superlative: "that weighs the most"."""
    return f"{SUPERLATIVE}{node.production.fixed['what']}"


@meaning("worn")
def worn(d: Discourse, node: Node) -> str:
    """ "in a red shirt", "in white": what somebody wears. Anything else is no place we know."""
    part = node.parts["what"]
    words = d.noun_words(part.start, part.end)
    last = words.split()[-1]
    lists = d.language.lists
    clothes = {
        " ".join(way)
        for name in ("garment", "colour")
        for ways in lists[name].values()
        for way in ways
    }
    if last not in clothes and singular(last, d.language) not in clothes:
        raise unknown_place(d, words, node)
    return f"{d.language.speech['wearing']} {words}"


@meaning("between")
def between(d: Discourse, node: Node) -> str:
    """ "between the cup and the box"."""
    remembered, last = d.thing, d.thing_last
    first, second = d.get(node, "first"), d.get(node, "second")
    d.thing, d.thing_last = remembered, last
    return d.language.phrase("between", first=first.text, second=second.text)


@meaning("superlative_after")
def superlative_after(d: Discourse, node: Node) -> str:
    return f"{SUPERLATIVE}{d.get(node, 'superlative')}"


@meaning("side_of")
def side_of(d: Discourse, node: Node) -> list[Where | str]:
    """ "on the left side of the shelf": the leftmost of what is there."""
    return [descriptor_fixed(d, node), d.get(node, "spot")]


@meaning("relation")
def relation(d: Discourse, node: Node) -> Where | str:
    """ "behind the cup": a descriptor; with its place if the other thing has one."""
    remembered, last = d.thing, d.thing_last
    other: Thing = d.get(node, "other")
    d.thing, d.thing_last = remembered, last
    words = f"{node.production.fixed['relation']} {other.text}"
    if other.place is not None or other.furniture is not None:
        return Where(other.place, other.furniture, words)
    home = home_of(d, other.text)  # "behind the sofa"
    return words if home is None else Where(home, None, words)


SUPERLATIVE = "\0"
"""Marks a descriptor that stands before the noun."""


POSTURES: Final = ("sitting", "standing", "lying down")
"""Of people, what is to be seen of them; things are only somewhere."""
SEXES: Final = {"male": "man", "female": "woman"}


def described(d: Discourse, noun: str, node: Node, *, lies_about: bool = False) -> Thing:
    """A noun with all that its node says about it. Of a thing that lies about, it says nothing that
    it lies or stands somewhere."""
    before: list[str] = []
    number = node.parts.get("number")
    if number is not None and node.production.rule != "thing":
        before.append(str(d.build(number)))  # "the three biggest" as one name
    superlative = d.get(node, "superlative")
    if superlative:
        before.append(superlative)
    adjectives = node.parts.get("adjectives")
    if adjectives is not None:
        before.append(d.described_by(adjectives))
    after: list[str] = []
    place: Value | None = None
    furniture: str | None = None
    preposition = ""
    for mod in (d.get(node, "mods") or []) + (d.get(node, "mods_after") or []):
        if isinstance(mod, Where):
            place = mod.place or place
            if mod.furniture:
                furniture, preposition = mod.furniture, mod.preposition
            if mod.words:
                after.append(mod.words)
        elif mod.startswith(SUPERLATIVE):
            before.append(mod[len(SUPERLATIVE) :])
        elif not (lies_about and mod in POSTURES):
            after.append(mod)
    if noun == ANYONE:
        for words in (before, after):
            sex = next((each for each in words if each in SEXES), None)
            if sex is not None:  # "a female person" is a woman
                words.remove(sex)
                noun = SEXES[sex]
    if place is None and furniture is None:
        place, furniture = d.at_place, d.at_furniture
    text = " ".join(word for word in (*before, noun, *after) if word)
    return Thing(Text(text), place, furniture, preposition=preposition)


# --- things


@meaning("thing")
def thing(d: Discourse, node: Node) -> Thing:
    """A noun with its adjectives and what follows it."""
    head = node.parts.get("head")
    if isinstance(head, Leaf):
        words = d.noun_words(head.start, head.end)
        name = head.value[0] if isinstance(head.value, tuple) else words
        called = d.tokens[head.end - 1].capital and not d.language.speech.get("capital_nouns")
        one = name if called else singular(name, d.language)  # Jonas is no plural
        known = head.slot in ("object", "furniture")
        one = name if known else one
        if known and "adjectives" in node.parts and is_short_for(d, words, name):
            one, known = words, False  # "apple juice" is no orange juice
        many = words not in (one, name) or one != name
        one = instead_of_one(d, node, one)
        if not known and node.end == head.end and is_strange_name(d, node.start, node.end):
            raise unknown_person(d, d.words(node.start, node.end), node)
    else:
        one, known, many = str(node.production.fixed.get("what", "object")), False, False
        if "superlative" in node.parts and d.thing is not None:
            one = d.thing.noun or one  # "the biggest one"
    count = d.get(node, "number") if node.production.rule == "thing" else None
    found = replace(
        described(d, one, node, lies_about=True),
        known=known,
        plural=many,
        here=bool(node.production.fixed.get("here")),
        count=int(count) if count is not None and count > 1 else None,
        every=bool(node.production.fixed.get("every")),
        noun=head_word(one, d.language),
    )
    d.thing, d.thing_last = found, True
    return found


def is_short_for(d: Discourse, words: str, name: str) -> bool:
    """Whether a name is called by its last words only: "juice" for "orange juice"."""
    return name != words and name.endswith(f" {singular(words, d.language)}")


def is_strange_name(d: Discourse, start: int, end: int) -> bool:
    """Whether words are written as a name is: "Zorro", not at the beginning of the sentence."""
    if start == 0 or d.language.speech.get("capital_nouns"):
        return False
    tokens = d.tokens[start:end]
    after_stop = d.tokens[start - 1].kind == "mark"
    return not after_stop and all(
        token.kind == "word" and token.capital and token.norm not in d.language.words
        for token in tokens
    )


def instead_of_one(d: Discourse, node: Node, noun: str) -> str:
    """ "blue one", after a cup was spoken of: "blue cup"."""
    *before, last = noun.split()
    if last not in d.language.speech.get("one_words", ()):
        return noun
    return " ".join((*before, spoken_of(d, node).noun))


def spoken_of(d: Discourse, node: Node) -> Thing:
    """The thing spoken of last. Raises `NotUnderstood` if there is none."""
    if d.thing is None or not d.thing.noun:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("which_other", words=words))
    return d.thing


@meaning("thing_other")
def thing_other(d: Discourse, node: Node) -> Thing:
    """ "the other cup", after one of them: to be found where that was; "another cup"."""
    head = node.parts.get("head")
    noun = singular(d.noun_words(head.start, head.end), d.language) if head is not None else ""
    before = d.thing
    new = node.production.fixed.get("new")
    if before is None or not before.noun or (noun and head_word(noun, d.language) != before.noun):
        if new and noun:
            return replace(described(d, noun, node), noun=head_word(noun, d.language))
        before = spoken_of(d, node) if not noun else None
    if before is None:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("which_other", words=words))
    other = replace(described(d, noun or before.noun, node), noun=before.noun, known=before.known)
    if other.place is None and other.furniture is None:
        place = before.place or source_of(d, before)
        if place is None and not new:
            words = d.words(node.start, node.end)
            raise NotUnderstood(d.language.phrase("which_other", words=words))
        other = replace(
            other, place=place, furniture=before.furniture, preposition=before.preposition
        )
    d.thing, d.thing_last = other, True
    return other


@meaning("thing_same")
def thing_same(d: Discourse, node: Node) -> Thing:
    """ "the same cup": the one spoken of."""
    return replace(spoken_of(d, node), pronoun=True)


@meaning("things")
def things(d: Discourse, node: Node) -> list[Thing]:
    """ "the cup and the book"."""
    only_taken_apart(d, node)
    return listed(d, node)


@meaning("thing_rather")
def thing_rather(d: Discourse, node: Node) -> Thing:
    """ "the cup on the counter, not the one on the table": the first says enough."""
    found: Thing = d.get(node, "first")
    return found


@meaning("thing_either")
def thing_either(d: Discourse, node: Node) -> list[Thing]:
    """ "the red cup, or if there is none the blue one"."""
    only_taken_apart(d, node)
    first: Thing = d.get(node, "first")
    rest = node.parts["rest"]
    assert isinstance(rest, Node)
    return [first, *(d.build(rest) if rest.means == "thing_either" else [d.build(rest)])]


@meaning("thing_something")
def thing_something(d: Discourse, node: Node) -> Thing:
    """ "something": of a kind that is told by where or how it is, else asked for."""
    if "mods" not in node.parts:
        word = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("bring_what", word=word), gap=(node.start, node.end))
    found = described(d, "object", node, lies_about=True)
    d.thing, d.thing_last = found, True
    return found


@meaning("thing_it")
def thing_it(d: Discourse, node: Node) -> Thing:
    """ "it"; where a language has one word for things and people, whichever it can mean."""
    somebody = d.person is not None or owner_of(d) is not None
    either = node.production.fixed.get("or_whom") and somebody
    if either and (means_receiver(d, node) or not means_thing(d, node)):
        return person_pronoun(d, node)
    if d.thing is not None:
        if d.thing.several and not d.is_plural(node):  # "bring one of them"
            return replace(d.thing, count=None, every=False, pronoun=True)
        return replace(d.thing, pronoun=True)
    if d.holding is not None:
        return Thing(d.holding, pronoun=True)
    if d.person is not None:  # "where is Victor? look for him"
        return person_pronoun(d, node)
    word = d.words(node.start, node.end)
    raise NotUnderstood(d.language.phrase("what_is_it", word=word), gap=(node.start, node.end))


@meaning("thing_from")
def thing_from(d: Discourse, node: Node) -> Thing:
    """ "one from the supply room", of what was spoken of."""
    spot: Where = d.get(node, "from")
    found = replace(thing_it(d, node), place=spot.place, furniture=spot.furniture, pronoun=False)
    d.thing, d.thing_last = found, True
    return found


# --- people


@meaning("person_name")
def person_name(d: Discourse, node: Node) -> Thing:
    leaf = node.parts["person"]
    assert isinstance(leaf, Leaf)
    name = d.one_of(leaf).name
    d.named.append(name)
    d.person = d.last_named = Thing(Text(name), known=True, person=True)  # "Alice in her office"
    found = replace(described(d, name, node), value=Text(name), known=True, person=True)
    d.person, d.thing_last = found, False
    return found


@meaning("person_unknown")
def person_unknown(d: Discourse, node: Node) -> Thing:
    part = node.parts["stranger"]
    raise unknown_person(d, d.words(part.start, part.end), node)


def unknown_person(d: Discourse, words: str, node: Node) -> NotUnderstood:
    known = nearest(words, d.lexicon.people)
    message = d.language.phrase("unknown_person", name=words)
    span = (node.start, node.end)
    return NotUnderstood(message, known, span if known else (0, 0), gap=span)


@meaning("person_kind")
def person_kind(d: Discourse, node: Node) -> Thing:
    """ "the visitor waving in the lobby", "a nurse", "this gentleman"."""
    kind = str(d.get(node, "kind_of_person", ANYONE))
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
    d.person, d.thing_last = found, False
    return found


def kind_in_plural(d: Discourse, node: Node) -> bool:
    """ "the visitors", not "the visitor"."""
    part = node.parts.get("kind_of_person")
    if not isinstance(part, Leaf):
        return False
    said = " ".join(d.norms(part.start, part.end))
    return singular(said, d.language) != said


def by_furniture(d: Discourse, person: Thing) -> Thing:
    """A person told by the furniture they are at: "woman next to the door"."""
    if person.furniture is None or person.furniture == d.at_furniture:
        return person
    if person.preposition:
        return replace(person, value=sought(d, person), furniture=None)
    at = d.language.phrase("at_furniture", furniture=person.furniture)
    return replace(person, value=Text(f"{person.text} {at}"), furniture=None)


@meaning("person_pronoun")
def person_pronoun(d: Discourse, node: Node) -> Thing:
    """ "him", "her", "them": whose place this is, the person spoken of last, or whoever is here."""
    host = host_here(d, node)
    if host is not None:
        d.called_so(host, node.start, node.end)
        d.named.append(host.text)
        d.person = host
        return host
    if d.person is not None and d.person.group is not None and d.last_named is not None:
        several = d.language.speech.get("things_too", ())
        if not set(d.norms(node.start, node.end)) & set(several):
            return d.last_named  # "him", after "Alice and Bob ... tell Dr Weber"
    everybody = d.person is not None and d.person.every and d.person.group is not None
    if everybody and not d.is_plural(node):
        # "ask every visitor ... and send him away": each in his turn
        raise NotUnderstood(d.language.phrase("one_person"))
    if d.person is not None and not d.may_be(d.person, node.start, node.end):
        # "ask Bob if he is free; if so, tell Alice, if not, tell her ..."
        other = d.one_called(node.start, node.end)
        if other is not None:
            return replace(other, here=d.with_person == other.value)
    if d.person is not None:
        d.called_so(d.person, node.start, node.end)
        met = d.person.here or d.with_person == d.person.value
        elsewhere = d.person.place is not None and not met
        return replace(d.person, here=not elsewhere and (met or not d.person.known))
    owner = owner_of(d)
    if owner is not None:
        d.named.append(owner.value)
        host = Thing(owner, known=True, person=True, here=True)
        d.called_so(host, node.start, node.end)
        return host
    if d.last_named is not None and d.with_person is None and not d.is_plural(node):
        return d.last_named  # somebody named in the other branch
    return Thing(d.with_person or Text(ANYONE), person=True, here=True)


def host_here(d: Discourse, node: Node) -> Thing | None:
    """Whoever's place the robot was sent to, if nobody was spoken of since: "tell Alice that ...
    Then go to Bob's office and ask him ..."."""
    owner = owner_of(d) if d.at is not None and d.place == d.at else None
    before = d.person
    if owner is None or before is None or d.is_plural(node):
        return None
    host = Thing(owner, known=True, person=True, here=True)
    said_to_be_here = before.place == d.at and not before.here
    left = not before.known and d.with_person is None  # a visitor who was left behind
    nearer = before is d.person_on_arrival and not said_to_be_here and before.value != owner
    if not (left or nearer):
        return None
    return host if d.may_be(host, node.start, node.end) else None


@meaning("person_group")
def person_group(d: Discourse, node: Node) -> Thing:
    """ "Alice, Bob and Carol"."""
    from grammar.meanings.finding import together

    d.person = together(listed(d, node))
    d.group = d.person.group
    return d.person


@meaning("person_either")
def person_either(d: Discourse, node: Node) -> list[Thing] | Thing:
    """ "Alice or Bob": one of them; for a condition, both as a group."""
    from grammar.meanings.finding import together

    people = listed(d, node)
    return people if d.taking_apart else together(people)


def known_by_name(d: Discourse, found: Thing, kind: str) -> tuple[Text, ...]:
    """All people of a kind, if the world knows them by name and nothing tells which are meant."""
    here = found.place is not None or d.at is not None
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
        d.group = Items(tuple(name for name in named if name not in left_out))
        return replace(found, known=True, group=d.group)
    if but is not None:
        if found.text != ANYONE:
            raise NotUnderstood(d.language.phrase("but_whom"))
        found = replace(found, but=but.group or Items((but.value,)))
    d.group = Ask("people")
    d.person, d.thing_last = found, False
    return replace(found, group=d.group, every=True)


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
        d.group = Items(named)  # "the two doctors", where the world knows two
        return replace(found, known=True, group=d.group)
    found = replace(found, count=number)
    d.person, d.thing_last = replace(found, here=True, plural=False), False
    return found


@meaning("person_coming")
def person_coming(d: Discourse, node: Node) -> Thing:
    """ "every visitor who comes in": one after the other, without end."""
    kind = str(d.get(node, "kind_of_person", ANYONE))
    found = Thing(Text(kind), person=True, here=True)
    d.person, d.thing_last = found, False
    spot: Where | None = d.get(node, "from")
    return replace(found, coming=True, place=None if spot is None else spot.place)


@meaning("person_first")
def person_first(d: Discourse, node: Node) -> Thing:
    """ "the first visitor you meet": whoever comes first; on guard, each of them."""
    if d.on_duty == "guard" and node.production.fixed.get("whoever"):
        return person_coming(d, node)
    kind = str(d.get(node, "kind_of_person", ANYONE))
    found = replace(by_furniture(d, described(d, kind, node)), person=True, first=True)
    d.person, d.thing_last = replace(found, first=False, place=None, here=True), False
    return found


@meaning("person_group_them")
def person_group_them(d: Discourse, node: Node) -> Thing:
    """ "both of them", "each of them"."""
    if d.group is None:
        found = d.person or Thing(Text(ANYONE), person=True)
        return replace(found, here=True, plural=True, every=True)
    return Thing(Text(ANYONE), person=True, plural=True, known=True, group=d.group)


@meaning("person_me")
def person_me(d: Discourse, node: Node) -> Thing:
    return Thing(Text(ANYONE), person=True, here=True, me=True)


def is_me(person: Thing | None) -> bool:
    return person is not None and person.me
