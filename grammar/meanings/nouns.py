"""Noun phrases: things and people, and what follows their nouns."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.deliveries import delivered_last
from grammar.meanings.descriptions import described
from grammar.meanings.genders import means_receiver, means_thing
from grammar.meanings.persons import person_kind, person_pronoun, unknown_person
from grammar.meanings.places import (
    only_taken_apart,
    owner_of,
    source_of,
)
from grammar.meanings.registry import meaning
from grammar.meanings.thing_lists import other_of_two
from grammar.plan import Text, Value
from grammar.tokens import Token
from grammar.wordforms import head_word, singular


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
        if known:  # it may only be called otherwise, as "Flasche" is a bottle
            many = words != name and singular(words, d.language) != words
        one = instead_of_one(d, node, one)
        if not known and node.end == head.end and is_strange_name(d, node.start, node.end):
            raise unknown_person(d, d.words(node.start, node.end), node)
    else:
        one, known, many = str(node.production.fixed.get("what", "object")), False, False
        if node.production.fixed.get("such"):
            one = such_as(d, node)
        elif "superlative" in node.parts and d.scene.thing is not None:
            one = d.scene.thing.noun or one  # "the biggest"
    count = d.get(node, "number") if node.production.rule == "thing" else None
    found = replace(
        best_of_those(d, node, described(d, one, node, lies_about=True)),
        known=known,
        plural=many,
        here=bool(node.production.fixed.get("here")),
        count=int(count) if count is not None and count > 1 else None,
        every=bool(node.production.fixed.get("every")),
        noun=head_word(one, d.language),
    )
    d.scene = d.scene.speaking_of(found)
    return found


def best_of_those(d: Discourse, node: Node, found: Thing) -> Thing:
    """ "look at the books on the shelf and bring me the thickest": where those are, too."""
    head = node.parts.get("head")
    named = isinstance(head, Leaf) and d.norms(head.start, head.end)[-1] not in (
        d.language.speech.get("one_words", ())
    )
    those = d.scene.thing
    if named or "superlative" not in node.parts or those is None:
        return found
    if not those.plural and not is_best(d, those):  # "... the heaviest and which is the lightest"
        return found
    if found.place is not None or found.furniture is not None:
        return found
    return replace(
        found, place=those.place, furniture=those.furniture, preposition=those.preposition
    )


def such_as(d: Discourse, node: Node) -> str:
    """What was spoken of last, without its adjectives: "water bottle", after "the green water
    bottle"."""
    adjectives = d.language.lists.get("attribute", {}).keys()
    return " ".join(each for each in spoken_of(d, node).text.split() if each not in adjectives)


def is_best(d: Discourse, thing: Thing) -> bool:
    """Whether a thing is the best of several: "biggest cup"."""
    return not d.language.lists.get("superlative", {}).keys().isdisjoint(thing.text.split())


def is_short_for(d: Discourse, words: str, name: str) -> bool:
    """Whether a name is called by its last words only: "juice" for "orange juice"."""
    return name != words and name.endswith(f" {singular(words, d.language)}")


def is_strange_name(d: Discourse, start: int, end: int) -> bool:
    """Whether words are written as a name is: "Zorro", not at the beginning of the sentence."""
    if start == 0:
        return False
    tokens = d.tokens[start:end]
    if d.language.speech.get("capital_nouns"):
        return len(tokens) == 1 and is_bare_name(d, tokens[0])
    after_stop = d.tokens[start - 1].kind == "mark"
    return not after_stop and all(
        token.kind == "word" and token.capital and token.norm not in d.language.words
        for token in tokens
    )


def is_bare_name(d: Discourse, token: Token) -> bool:
    """Whether a word without an article is a name where all nouns have capitals: a first name, or
    one that ends as few nouns do that stand so ("Zorro", but not "Kaffee" or "Decken")."""
    first_names = d.language.speech.get("given_names", {}).values()
    if any(token.norm in names for names in first_names):
        return True
    data = d.language.speech.get("bare_names", {})
    nouns = tuple(data.get("nouns", ()))
    word = token.spelled or token.norm
    ends_so = word.endswith(tuple(data.get("endings", ())))
    return token.capital and ends_so and word not in d.language.words and not word.endswith(nouns)


def instead_of_one(d: Discourse, node: Node, noun: str) -> str:
    """ "blue one", after a cup was spoken of: "blue cup"."""
    *before, last = noun.split()
    if last not in d.language.speech.get("one_words", ()):
        return noun
    return " ".join((*before, spoken_of(d, node).noun))


def spoken_of(d: Discourse, node: Node) -> Thing:
    """The thing spoken of last. Raises `NotUnderstood` if there is none."""
    if d.scene.thing is None or not d.scene.thing.noun:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("which_other", words=words))
    return d.scene.thing


@meaning("thing_other")
def thing_other(d: Discourse, node: Node) -> Thing:
    """ "the other cup", after one of them: to be found where that was; "another cup"."""
    head = node.parts.get("head")
    noun = singular(d.noun_words(head.start, head.end), d.language) if head is not None else ""
    before = d.scene.thing
    new = node.production.fixed.get("new")
    other = None if new else other_of_two(d, head_word(noun, d.language) if noun else "")
    if other is not None:
        d.scene = d.scene.speaking_of(other)
        return other
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
    d.scene = d.scene.speaking_of(other)
    return other


@meaning("thing_same")
def thing_same(d: Discourse, node: Node) -> Thing:
    """ "the same cup": the one spoken of."""
    return replace(spoken_of(d, node), pronoun=True)


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
    d.scene = d.scene.speaking_of(found)
    return found


@meaning("thing_it")
def thing_it(d: Discourse, node: Node) -> Thing:
    """ "it"; where a language has one word for things and people, whichever it can mean."""
    somebody = d.scene.person is not None or owner_of(d) is not None
    either = node.production.fixed.get("or_whom") and somebody
    if either and (means_receiver(d, node) or not means_thing(d, node)):
        return person_pronoun(d, node)
    if d.scene.thing is not None:
        if d.scene.thing.several and not d.is_plural(node):  # "bring one of them"
            return replace(d.scene.thing, count=None, every=False, pronoun=True)
        return replace(d.scene.thing, pronoun=True)
    if d.scene.holding is not None:
        return Thing(d.scene.holding, pronoun=True)
    of_things = set(d.norms(node.start, node.end)) & set(
        d.language.speech.get("of_things_only", ())
    )
    if d.scene.person is not None and not of_things:  # "where is Victor? look for him"
        return person_pronoun(d, node)
    word = d.words(node.start, node.end)
    raise NotUnderstood(d.language.phrase("what_is_it", word=word), gap=(node.start, node.end))


@meaning("thing_opening")
def thing_opening(d: Discourse, node: Node) -> Thing:
    """ "the key to the supply room": the supply room key, wherever that is."""
    place: Value = d.get(node, "place")
    if not isinstance(place, Text):  # "this room", wherever that is
        word = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("what_is_it", word=word), gap=(node.start, node.end))
    found = Thing(Text(f"{d.called(place.value)} {d.get(node, 'opener')}"))
    d.scene = d.scene.speaking_of(found)
    return found


@meaning("one_of_them")
def one_of_them(d: Discourse, node: Node) -> Thing:
    """ "keiner", "einer": none or one of what was spoken of last, or of all people; but of "the
    folder" there are no several, unless it was brought to the speaker, who is surely there. Words
    for nobody ("keiner") are no others that can only be about things ("keine", "keins")."""
    articles = d.language.speech.get("articles", ())
    said = (
        d.scene.thing.text.split()[-1].lower()
        if d.scene.thing is not None and d.scene.thing.text
        else ""
    )
    named = [at for at in range(1, node.start) if d.words(at, at + 1).lower() == said]
    the_one = bool(named) and d.tokens[named[-1] - 1].norm in articles
    delivery = delivered_last(d)
    to_speaker = delivery is not None and delivery.spot is None and delivery.receiver is None
    no_person = to_speaker or bool(node.production.fixed.get("of_things"))
    if d.scene.thing is not None and d.scene.thing_last and (no_person or not the_one):
        return replace(d.scene.thing, pronoun=True)
    return person_kind(d, node)


@meaning("thing_from")
def thing_from(d: Discourse, node: Node) -> Thing:
    """ "one from the supply room", of what was spoken of."""
    spot: Where = d.get(node, "from")
    found = replace(thing_it(d, node), place=spot.place, furniture=spot.furniture, pronoun=False)
    d.scene = d.scene.speaking_of(found)
    return found
