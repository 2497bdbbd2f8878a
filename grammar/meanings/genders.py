"""What a pronoun stands for by its gender, in languages whose nouns have one."""

from __future__ import annotations

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Thing
from grammar.meanings.persons import is_me
from grammar.naming import some, the
from grammar.wordforms import singular


def means_thing(d: Discourse, part: Leaf | Node) -> bool:
    """Whether a pronoun that may stand for things and for people stands for the thing that was
    spoken of: by its gender ("la": not Bob), else if that was spoken of last."""
    if isinstance(part, Node) and part.means == "person_first":  # "the first one you find"
        return (
            d.scene.thing is not None and d.scene.thing_last and "kind_of_person" not in part.parts
        )
    word = pronoun_of(d, part)
    if d.scene.thing is None or word not in d.language.speech.get("things_too", ()):
        return False
    gender = d.language.speech.get("object_genders", {}).get(word)
    if gender is None or d.scene.person is None:
        return d.scene.thing_last and not only_people(d, part)
    thing = gender_of_thing(d, d.scene.thing) in (None, gender)
    return d.scene.thing_last if thing == d.may_have(d.scene.person, gender) else thing


def pronoun_of(d: Discourse, part: Leaf | Node) -> str:
    """The last word of a noun phrase that is no mere politeness: "them" of "them please"."""
    words = d.norms(part.start, part.end)
    return next((word for word in reversed(words) if (word,) not in d.language.fillers), words[-1])


def only_people(d: Discourse, part: Leaf | Node) -> bool:
    """Whether a pronoun in the plural stands for somebody, and not for the one thing that was
    spoken of last: "bring the visitor a coffee, then take them to the lounge"."""
    if (
        d.scene.thing is None
        or d.scene.person is None
        or not isinstance(part, Node)
        or not d.is_plural(part)
    ):
        return False
    one = not (d.scene.thing.plural or d.scene.thing.several) and d.scene.thing.group is None
    return (
        one
        and singular(d.scene.thing.text, d.language) == d.scene.thing.text
        and not is_me(d.scene.person)
    )


def means_receiver(d: Discourse, part: Leaf | Node) -> bool:
    """Whether a pronoun may stand for who is to get a thing: "bring the book to Bob; if you do not
    find him"."""
    gender = d.language.speech.get("object_genders", {}).get(pronoun_of(d, part))
    to = d.deliveries.last.person if d.deliveries.last is not None else None
    if to is None or d.scene.person is None or to.value != d.scene.person.value:
        return False
    return gender is not None and d.may_have(d.scene.person, gender)


def gender_of_thing(d: Discourse, thing: Thing) -> str | None:
    """By the article of its noun, in languages that have such."""
    genders: dict[str, str] = d.language.speech.get("articles_genders", {})
    noun = d.called(thing.text)
    forms = (each(noun, d.language).partition(" ")[0] for each in (some, the)) if genders else ()
    return next((genders[article] for article in forms if article in genders), None)
