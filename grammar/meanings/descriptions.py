"""What describes somebody or something: colours, clothes, places, positions, superlatives."""

from __future__ import annotations

from typing import Final

from grammar.chart import Node, what_it_means
from grammar.discourse import ANYONE, Discourse, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.places import (
    home_of,
    unknown_place,
)
from grammar.meanings.registry import meaning
from grammar.plan import Text, Value
from grammar.wordforms import singular


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
    kind = what_it_means(part)
    on_it = words[0] in d.language.speech.get("on_it", ())
    beside = kind == "descriptor_fixed" or (kind == "relation" and not on_it)
    if words[-1] in d.language.speech.get("pointing", ()) and not beside:  # but "behind it"
        found = []  # "the woman there": nothing that tells her from others
    return [*found, *(d.get(node, "rest") or [])]


@meaning("where_pointed")
def where_pointed(d: Discourse, node: Node) -> str:
    """ "in it", "on them": where the robot is by what was said; of nothing spoken of, nowhere."""
    if not (d.scene.place or d.scene.thing or d.scene.at or d.scene.at_furniture or d.scene.person):
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


@meaning("wanted_by")
def wanted_by(d: Discourse, node: Node) -> str:
    """ "the stapler that Clara needs": nothing that can be seen, but whom "her" means then."""
    d.build(node.parts["person_ref"])
    return ""


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
        raise unknown_place(d, words, part)
    return f"{d.language.speech['wearing']} {words}"


@meaning("between")
def between(d: Discourse, node: Node) -> str:
    """ "between the cup and the box"."""
    before = d.scene
    first, second = d.get(node, "first"), d.get(node, "second")
    d.scene = d.scene.with_it_of(before)
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
    before = d.scene
    other: Thing = d.get(node, "other")
    d.scene = d.scene.with_it_of(before)
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
        place, furniture = d.command.at_place, d.scene.at_furniture
    text = " ".join(word for word in (*before, noun, *after) if word)
    return Thing(Text(text), place, furniture, preposition=preposition)
