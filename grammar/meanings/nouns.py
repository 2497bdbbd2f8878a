"""Noun phrases: things, people, places, quantities and times."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Final

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, START, Discourse, NotUnderstood, Thing, Where, as_value
from grammar.lexicon import Name
from grammar.meanings.registry import meaning
from grammar.plan import Ask, Call, Items, Number, Recall, Remember, Text, Value
from grammar.wordforms import head_word, singular

LIKE_ENOUGH: Final = 55
"""Percent that two names have to be alike for one to be offered in the place of the other."""

LAST_HOUR_MEANT_PM: Final = 6
"""Up to "six o'clock" is in the afternoon where nothing else is said."""

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
    if isinstance(d.place, Text) and any(each.name == d.place.value for each in places):
        return d.place  # "go to the bathroom and count the people in the room"
    if len(places) > 1:
        raise d.which(node.start, node.end, tuple(place.name for place in places))
    d.place = Text(places[0].name)
    return d.place


@meaning("each_place")
def each_place(d: Discourse, node: Node) -> Value:
    """ "every office": the places, for a loop (`grammar.meanings.quantifiers`)."""
    only_taken_apart(d, node)
    if "place" in node.parts:
        return Items((d.get(node, "place"), *d.get(node, "place_list")))
    return kind_places(d, d.get(node, "places"))


def only_taken_apart(d: Discourse, node: Node) -> None:
    """Refuse a phrase that speaks of several where nothing makes a loop of it."""
    if not d.taking_apart:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("one_of_several", words=words))


@meaning("all_places")
def all_places(d: Discourse, node: Node) -> Value:
    """ "every office but Bob's", "the other labs", "the first two wards"."""
    kind: str | None = d.get(node, "kind") or d.get(node, "kinds")
    fixed = node.production.fixed
    but: list[Value | None] = [d.get(node, "but"), *(d.get(node, "place_list") or [])]
    number = d.get(node, "number")
    if but == [None] and number is None and not fixed.get("other"):
        return kind_places(d, kind)
    if fixed.get("other"):
        but = [d.place, *(d.get(node, "place_list") or [])]
    known = d.lexicon.place_kinds[kind] if kind else d.lexicon.places
    names = [Text(each.name) for each in known if Text(each.name) not in but]
    lost = [each for each in but if each is not None and not isinstance(each, Text)]
    if lost or (fixed.get("other") and (d.place is None or len(names) == len(known))):
        raise NotUnderstood(d.language.phrase("which_places"))
    if number is not None and int(number) != len(names):
        if not fixed.get("from_first") or int(number) > len(names):
            raise NotUnderstood(d.language.phrase("which_places"))
        names = names[: int(number)] if fixed["from_first"] > 0 else names[-int(number) :]
    return Items(tuple(names))


@meaning("place_own")
def place_own(d: Discourse, node: Node) -> Value:
    """ "his office", after Bob: Bob's office; of nobody by name, the only office there is."""
    kind = d.get(node, "kind")
    mark = d.language.speech["possessive"]
    said: Thing | None = d.get(node, "owner")
    who = d.person if said is None else said
    if who is not None and isinstance(who.group, Items):  # for each of them anew
        who = replace(who, value=who.group.items[-1])
    owner = who.text.lower() if who is not None and who.known else None
    places = d.lexicon.place_kinds[kind]
    own = [each for each in places if owner and each.name.lower().startswith(owner + mark)]
    if owner and not own:
        words = f"{who.text if who else ''}{mark}{kind}"
        raise NotUnderstood(
            d.language.phrase("unknown_place", name=words),
            tuple(each.name for each in places[:3]),
            (node.start, node.end),
        )
    if len(own or places) > 1:
        raise d.which(node.start, node.end, tuple(each.name for each in own or places))
    d.place = Text((own or places)[0].name)
    return d.place


@meaning("place_there")
def place_there(d: Discourse, node: Node) -> Value:
    if d.place is None:
        raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))
    if d.delivered is not None and d.place == Recall(START):
        d.place = before_fetching(d, node)
    return d.place


def before_fetching(d: Discourse, node: Node) -> Value:
    """ "If there is none in the lab, get one from the store and bring it there": to where it was
    looked for in vain, or where the robot was sent, not to whoever speaks."""
    if d.missing is not None and d.missing.place is not None:
        return d.missing.place
    sent = [
        step.arguments["place"]
        for step in d.done
        if isinstance(step, Call) and step.method == "goto" and "place" in step.arguments
    ]
    places = [place for place in sent if place not in (d.at_pick_up, Recall(START))]
    if not places:
        raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))
    return places[-1]


@meaning("place_here")
def place_here(d: Discourse, node: Node) -> Value:
    """ "here" is where the speaker is, wherever the robot has gone meanwhile."""
    return d.start()


@meaning("place_start")
def place_start(d: Discourse, node: Node) -> Value:
    return d.start()


@meaning("place_unknown")
def place_unknown(d: Discourse, node: Node) -> Value:
    raise unknown_place(d, d.words(node.parts["unknown"].start, node.parts["unknown"].end), node)


def unknown_place(d: Discourse, words: str, node: Node) -> NotUnderstood:
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


@meaning("place_found")
def place_found(d: Discourse, node: Node) -> Value:
    """ "where you found it"."""
    place = d.thing.place or source_of(d, d.thing) if d.thing is not None else None
    if place is None:
        raise NotUnderstood(d.language.phrase("where_is_there"))
    d.place = place
    return place


@meaning("place_of_owner")
def place_of_owner(d: Discourse, node: Node) -> Value:
    """ "Alice's": the one place that is called after her."""
    leaf = node.parts["person"]
    assert isinstance(leaf, Leaf)
    return place_called_after(d, d.one_of(leaf).name, node)


def place_called_after(d: Discourse, owner: str, node: Node) -> Value:
    mark = d.language.speech["possessive"]
    own = [
        each.name for each in d.lexicon.places if each.name.lower().startswith(owner.lower() + mark)
    ]
    if not own:
        raise unknown_place(d, d.words(node.start, node.end), node)
    if len(own) > 1:
        raise d.which(node.start, node.end, tuple(own))
    d.place = Text(own[0])
    return d.place


@meaning("place_any")
def place_any(d: Discourse, node: Node) -> Value:
    """ "any office": whichever; the only one if there is no other."""
    only_taken_apart(d, node)
    places = d.lexicon.place_kinds[d.get(node, "kind")]
    if len(places) == 1:
        return Text(places[0].name)
    return kind_places(d, d.get(node, "kind"))


@meaning("place_either")
def place_either(d: Discourse, node: Node) -> list[Value]:
    """ "the lobby or the kitchen"."""
    only_taken_apart(d, node)
    return [d.get(node, "first"), d.get(node, "second")]


@meaning("place_other")
def place_other(d: Discourse, node: Node) -> Value:
    """ "the other office": of two, the one that was not spoken of; else the question which."""
    places = d.lexicon.place_kinds[d.get(node, "kind")]
    others = [each.name for each in places if Text(each.name) != d.place]
    if len(others) == 1:
        d.place = Text(others[0])
        return d.place
    raise d.which(node.start, node.end, tuple(others))


@meaning("place_where")
def place_where(d: Discourse, node: Node) -> Thing:
    """ "where Bob is", "a room with a printer": wherever that is found."""
    only_taken_apart(d, node)
    found: Thing = d.get(node, "thing") or d.get(node, "person_ref")
    return found


@meaning("where_owned")
def where_owned(d: Discourse, node: Node) -> Where:
    """ "Bob's desk", "his desk": the desk in Bob's office."""
    if "person" in node.parts:
        return Where(place_of_owner(d, node), d.get(node, "furniture"))
    owner = d.person.value if d.person is not None and d.person.known else owner_of(d)
    if not isinstance(owner, Text):
        word = d.words(node.start, node.start + 1)
        raise NotUnderstood(d.language.phrase("what_is_it", word=word), gap=(node.start, node.end))
    return Where(place_called_after(d, owner.value, node), d.get(node, "furniture"))


def nearest(words: str, names: tuple[Name, ...]) -> tuple[str, ...]:
    """The names most like some words, the best first."""
    from rapidfuzz import fuzz, process

    choices = {text: name.name for name in names for text in (name.name, *name.aliases)}
    found = process.extract(
        words.lower(), list(choices), scorer=fuzz.ratio, limit=6, score_cutoff=LIKE_ENOUGH
    )
    return tuple(dict.fromkeys(choices[text] for text, _, _ in found))[:3]


@meaning("where")
def where(d: Discourse, node: Node) -> Where:
    furniture = d.get(node, "furniture")
    place = d.get(node, "place_at") or d.get(node, "place")
    if place is None and "beside" in node.parts:  # "the sofa by the window"
        place = home_of(d, d.get(node, "beside"))
    if place is None and furniture:
        place = home_of(d, furniture)
    return Where(place, furniture)


@meaning("where_it")
def where_it(d: Discourse, node: Node) -> Where:
    """ "go to the shelf and put the cup on it"."""
    if d.at is None and d.at_furniture is None:
        raise NotUnderstood(d.language.phrase("where_is_there"))
    return Where(d.at, d.at_furniture)


@meaning("where_is")
def where_is(d: Discourse, node: Node) -> Where:
    """A preposition and a spot: "on the table"."""
    spot: Where = d.get(node, "spot")
    words = " ".join(d.norms(node.start, node.parts["spot"].start))
    return replace(spot, preposition=d.language.speech.get("stands", {}).get(words, ""))


def home_of(d: Discourse, furniture: str) -> Value | None:
    """The place a piece of furniture stands in: where the robot is, or where the world says."""
    homes = {each.inside for each in d.lexicon.furniture if each.name == furniture and each.inside}
    if isinstance(d.at, Text) and d.at.value in homes:
        return d.at
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
    d.place = home
    return home


@meaning("place_tail")
def place_tail(d: Discourse, node: Node) -> Value:
    """ "b" in "ward a, b and c": a place of the same kind as the one before."""
    leaf = node.parts["place_tail"]
    assert isinstance(leaf, Leaf)
    before = d.place.value if isinstance(d.place, Text) else ""
    kind = next((place.kind for place in d.lexicon.places if place.name == before), None)
    alike = [name.name for name in leaf.value if name.kind == kind and name.name != before]
    if len(alike) != 1:
        raise NotUnderstood(
            d.language.phrase("unknown_place", name=d.words(node.start, node.end)),
            tuple(name.name for name in leaf.value),
            (node.start, node.end),
        )
    d.place = Text(alike[0])
    return d.place


# --- what follows a noun


@meaning("mods")
def mods(d: Discourse, node: Node) -> list[Where | str]:
    """All that follows a noun: where it is, and what tells it from others."""
    part = node.parts["first"]
    says_nothing = isinstance(part, Node) and not part.parts and part.production.means is None
    first = None if says_nothing else d.build(part)  # "the bottle you can find"
    found = [first] if isinstance(first, Where) or (isinstance(first, str) and first) else []
    words = d.norms(node.parts["first"].start, node.parts["first"].end)
    if words[-1] in d.language.speech.get("pointing", ()):
        found = []  # "the woman there": nothing that tells her from others
    return [*found, *(d.get(node, "rest") or [])]


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


@meaning("relation")
def relation(d: Discourse, node: Node) -> Where | str:
    """ "behind the cup": a descriptor; with its place if the other thing has one."""
    remembered, last = d.thing, d.thing_last
    other: Thing = d.get(node, "other")
    d.thing, d.thing_last = remembered, last
    words = f"{node.production.fixed['relation']} {other.text}"
    if other.place is not None or other.furniture is not None:
        return Where(other.place, other.furniture, words)
    return words


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


def sought(d: Discourse, thing: Thing) -> Value:
    """The thing as the robot is to look for it: "cup on the table"."""
    if thing.count is not None and not thing.person and isinstance(thing.value, Text):
        thing = replace(thing, value=Text(f"{thing.count} {thing.text}"), count=None)
    named = thing.person and thing.known  # somebody by name is told by nothing else
    if thing.furniture and thing.preposition and isinstance(thing.value, Text) and not named:
        near = d.language.phrase("the", noun=thing.furniture)
        return Text(f"{thing.value.value} {thing.preposition} {near}")
    if thing.furniture and isinstance(thing.value, Text) and not thing.person:
        on = d.language.phrase("on_furniture", furniture=thing.furniture)
        return Text(f"{thing.value.value} {on}")
    nowhere = thing.place is None or (thing.furniture and home_of(d, thing.furniture) is None)
    if thing.furniture and isinstance(thing.value, Text) and not thing.known and nowhere:
        return Text(
            f"{thing.value.value} {d.language.phrase('at_furniture', furniture=thing.furniture)}"
        )
    return thing.value


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


@meaning("thing_same")
def thing_same(d: Discourse, node: Node) -> Thing:
    """ "the same cup": the one spoken of."""
    return replace(spoken_of(d, node), pronoun=True)


@meaning("things")
def things(d: Discourse, node: Node) -> list[Thing]:
    """ "the cup and the book"."""
    only_taken_apart(d, node)
    return listed(d, node)


@meaning("thing_either")
def thing_either(d: Discourse, node: Node) -> list[Thing]:
    """ "the red cup, or if there is none the blue one"."""
    only_taken_apart(d, node)
    first: Thing = d.get(node, "first")
    rest = node.parts["rest"]
    assert isinstance(rest, Node)
    return [first, *(d.build(rest) if rest.means == "thing_either" else [d.build(rest)])]


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
    if person.place is not None:
        return person
    at = d.language.phrase("at_furniture", furniture=person.furniture)
    return replace(person, value=Text(f"{person.text} {at}"), furniture=None)


@meaning("person_pronoun")
def person_pronoun(d: Discourse, node: Node) -> Thing:
    """ "him", "her", "them": the person spoken of last, else whoever is here."""
    if d.person is not None and d.person.group is not None and d.last_named is not None:
        several = d.language.speech.get("things_too", ())
        if not set(d.norms(node.start, node.end)) & set(several):
            return d.last_named  # "him", after "Alice and Bob ... tell Dr Weber"
    if d.person is not None:
        met = d.person.here or d.with_person == d.person.value
        elsewhere = d.person.place is not None and not met
        return replace(d.person, here=not elsewhere and (met or not d.person.known))
    owner = owner_of(d)
    if owner is not None:
        return Thing(owner, known=True, person=True, here=True)
    return Thing(d.with_person or Text(ANYONE), person=True, here=True)


def owner_of(d: Discourse) -> Text | None:
    """Whose place was spoken of last: Bob, after "Bob's office"."""
    if isinstance(d.place, Text):
        mark = d.language.speech["possessive"]
        for person in d.lexicon.people:
            if d.place.value.lower().startswith(person.name.lower() + mark):
                return Text(person.name)
    return None


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
    found = replace(found, count=int(d.get(node, "count")))
    d.person, d.thing_last = replace(found, here=True, plural=False), False
    return found


@meaning("person_coming")
def person_coming(d: Discourse, node: Node) -> Thing:
    """ "every visitor who comes in": one after the other, without end."""
    kind = str(d.get(node, "kind_of_person", ANYONE))
    found = Thing(Text(kind), person=True, here=True)
    d.person, d.thing_last = found, False
    return replace(found, coming=True)


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
    if half is None and not given and 1 <= hours <= LAST_HOUR_MEANT_PM:
        hours += 12  # "at three": nobody has visitors at night
        d.assumptions.append("pm")
    if not (0 <= hours < 24 and 0 <= minutes < 60):
        raise NotUnderstood(d.language.phrase("no_such_time", time=d.words(node.start, node.end)))
    return f"{hours:02}:{minutes:02}"


def kind_places(d: Discourse, kind: str | Value | None) -> Value:
    """All places of a kind, asked of the robot; those that a noun phrase speaks of as they are."""
    if kind is None or isinstance(kind, str):
        return Ask("places", {"kind": Text(kind)} if kind else {})
    return kind


def number_value(value: Any) -> Number:
    result = as_value(value)
    assert isinstance(result, Number)
    return result


@meaning("words")
def words(d: Discourse, node: Node) -> str:
    """The words themselves."""
    return d.words(node.start, node.end)


@meaning("fixed")
def fixed(d: Discourse, node: Node) -> Any:
    """A value that the rule states itself."""
    return node.production.fixed["value"]
