"""Whether every word of a sentence had a say in its plan: nothing is left out in silence.

Words that stand in a rule are the rule's own affair. What this looks at are the words that come
from the speaker: names, nouns, free text. A meaning that loses one is a mistake; the sentence is
then refused, with the word, rather than obeyed in part.
"""

from __future__ import annotations

import functools
import itertools
import math
import unicodedata
from collections.abc import Iterator, Set
from typing import Final

from grammar.chart import Leaf, Node
from grammar.discourse import Steps
from grammar.language import Language
from grammar.lexicon import Lexicon, Name, Question
from grammar.plan import Ask, Call, Number, Plan, Text
from grammar.texts.words import weighty_words
from grammar.tidy import nodes
from grammar.tokens import Token

NAMES: Final = frozenset({"noun", "object", "person", "stranger", "place", "furniture"})
TEXTS: Final = frozenset({"text", "remark", "word", "verb", "quote"})
OVER_AND_OVER: Final = 3
FREE: Final = frozenset({"text"})
NO_PART: Final = frozenset(
    {"corrected", "place_corrected", "statement", "refused"}
    | {"remark", "remark_name", "remark_where"}  # kept word for word as background
)
"""Meanings whose words need not be in the plan: taken back, or said for what follows."""
LEFT_OUT: Final = "but"
"""What an exception is bound to: it shows in what the plan does not do."""
SPEAKING: Final = frozenset({"say", "ask", "answer"})
ALIKE: Final = 0.5
"""The part of a word that its form in the plan begins with, too: "cookies" and "cooky"."""
SHORTEST: Final = 3
"""Letters of that part at least."""


def said_over_and_over(tree: Node, tokens: tuple[Token, ...], language: Language) -> list[str]:
    """The words that stand three times or more in a row where nobody is to say it: "lobby lobby
    lobby" is noise."""
    named = {at for leaf in _leaves(tree, NAMES) for at in range(leaf.start, leaf.end)}
    spoken = {at for leaf in _leaves(tree, TEXTS) for at in range(leaf.start, leaf.end)}
    rows = itertools.groupby(range(len(tokens)), lambda at: tokens[at].norm)
    return [
        tokens[row[0]].norm
        for row in (list(each) for _, each in rows)
        if len(row) >= OVER_AND_OVER
        and tokens[row[0]].kind == "word"
        and (tokens[row[0]].norm,) not in language.fillers
        and spoken.isdisjoint(row)
        and named.intersection(row)
    ]


def left_out(
    tree: Node,
    tokens: tuple[Token, ...],
    plan: Plan,
    language: Language,
    lexicon: Lexicon,
    resolved: Set[int] = frozenset(),
    slots: frozenset[str] = NAMES,
) -> list[str]:
    """The words in these slots that the plan knows nothing of, but for those that stand for what is
    only known when the program runs (`resolved`)."""
    known = {_plain(word) for text in _texts(plan) for word in language.tokens_of(text)}
    silent = language.closed | {word for filler in language.fillers for word in filler}
    silent |= set(language.speech.get("one_words", ()))
    base_forms = language.speech.get("base_forms", {})
    # Who is sent to a piece of furniture is sent to where it stands.
    homes = {each.name: each.inside for each in lexicon.furniture if each.inside}
    missing = said_over_and_over(tree, tokens, language)
    for leaf in _leaves(tree, slots):
        if isinstance(leaf.value, tuple):
            names = [_name_of(value) for value in leaf.value]
            names += [homes[name] for name in names if name in homes]
            words = {_plain(word) for name in names for word in language.tokens_of(name)}
            words |= {_plain(token.norm) for token in tokens[leaf.start : leaf.end]}
            if not _alike(words, known):
                missing.append(names[0])
            continue
        for at, token in enumerate(tokens[leaf.start : leaf.end], leaf.start):
            if at in resolved:
                continue
            if token.kind != "word" or token.norm in silent:
                continue
            forms = {_plain(token.norm), _plain(str(base_forms.get(token.norm, token.norm)))}
            forms.add(_without_marks(token.norm, language))
            if not _alike(forms, known):
                missing.append(token.norm)
    return missing


def unspoken(
    tree: Node,
    tokens: tuple[Token, ...],
    plan: Plan,
    language: Language,
    resolved: Set[int] = frozenset(),
) -> list[str]:
    """The words of free text that the plan leaves out: "no" of "choose between no tea and coffee".
    `resolved` are those that stand for what is only known when the program runs.
    Verbs may change their form on the way; what turns the sense of a text may not be lost."""
    known = {word for text in _texts(plan) for word in language.tokens_of(text)}
    plain = {_plain(word) for word in known}
    parts = [word for word in known if len(word) > SHORTEST]
    weighty = weighty_words(language)
    silent = language.closed | {word for filler in language.fillers for word in filler}
    turned = language.speech.get("base_forms", {})  # "elle doit" told to her: "vous devez"
    return [
        token.norm
        for leaf in _leaves(tree, FREE)
        for at, token in enumerate(tokens[leaf.start : leaf.end], leaf.start)
        if token.kind == "word"
        and at not in resolved
        and token.norm not in known
        and not known.issuperset(
            language.tokens_of(str(turned.get(token.spelled or token.norm, "?")))
        )
        and (
            token.norm in weighty
            or not (
                token.norm in silent
                or _alike({_plain(token.norm)}, plain)
                or any(part in token.norm for part in parts)  # "ankommt": "kommt ... an"
            )
        )
    ]


def no_nouns(
    plan: Plan, tokens: tuple[Token, ...], language: Language, known: Set[str]
) -> list[str]:
    """The words that things are called by in a plan and that are no nouns: a negation, or what is
    written small in a text that writes nouns with capitals."""
    negations = language.speech.get("weighty", {}).get("negations", ())
    capitals = language.speech.get("capital_nouns") and any(each.capital for each in tokens[1:])
    said = {token.norm: token for token in tokens if token.kind == "word"}
    found: list[str] = []
    for step in nodes(plan.steps):
        thing = step.arguments.get("thing") if isinstance(step, Call | Ask) else None
        words = language.tokens_of(thing.value) if isinstance(thing, Text) else ()
        head = said.get(words[-1]) if words else None
        if words and words[0] in negations:
            found.append(words[0])
        elif head is not None and capitals and not head.capital and head.norm not in known:
            found.append(head.spelled or head.norm)
    return found


def unheeded(tree: Node, tokens: tuple[Token, ...], language: Language) -> list[str]:
    """Words for how something is to be done that change nothing ("quickly"), as they were said:
    no name and no text has them."""
    found: dict[int, int] = {}
    for way in language.speech.get("unheeded", ()):
        for at, length in _said(way, tree, tokens, language):
            found[at] = max(length, found.get(at, 0))
    spelled = [token.spelled or token.norm for token in tokens]
    return [" ".join(spelled[at : at + length]) for at, length in sorted(found.items())]


def in_manner(
    steps: Steps,
    tree: Node,
    tokens: tuple[Token, ...],
    language: Language,
    resolved: Set[int] = frozenset(),
) -> tuple[Steps, list[str]]:
    """The steps with the volume set before them if something is to be said "quietly", and these
    words where nothing is said, or its volume is set anyway."""
    volumes: dict[str, int] = language.speech.get("volumes", {})
    said = [
        way
        for way in volumes
        if any(at not in resolved for at, _ in _said(way, tree, tokens, language))
    ]
    if not said:
        return steps, []
    methods = {each.method for each in nodes(tuple(steps)) if isinstance(each, Call | Ask)}
    if "set_volume" in methods or not methods & SPEAKING:
        return steps, [] if "set_volume" in methods else said
    return [Call("set_volume", {"percent": Number(volumes[said[0]])}), *steps], []


def _said(
    way: str, tree: Node, tokens: tuple[Token, ...], language: Language
) -> Iterator[tuple[int, int]]:
    """Where some words stand, and how many they are, but for those in names and texts."""
    taken = {at for leaf in _leaves(tree, NAMES | TEXTS) for at in range(leaf.start, leaf.end)}
    sought = language.tokens_of(way)
    words = tuple(token.norm for token in tokens)
    for at in range(len(words) - len(sought) + 1):
        if words[at : at + len(sought)] == sought and at not in taken:
            yield at, len(sought)


@functools.lru_cache(maxsize=4096)
def _plain(word: str) -> str:
    """A word without accents and capitals."""
    letters = unicodedata.normalize("NFD", word)
    return "".join(each for each in letters if not unicodedata.combining(each)).lower()


def _without_marks(word: str, language: Language) -> str:
    """A word as if it had no marks on its letters: "glaeser" are of one kind with "Glas"."""
    for letter, written in language.spelling.letters.items():
        word = word.replace(written, _plain(letter))
    return word


def _alike(words: Set[str], known: Set[str]) -> bool:
    """Whether one of some words, or a form of it, is among those known."""
    return not words.isdisjoint(known) or any(
        same_word(one, other) for one in words for other in known
    )


def same_word(one: str, other: str) -> bool:
    """Whether two words may be forms of one: they begin alike."""
    least = max(SHORTEST, math.ceil(ALIKE * max(len(one), len(other))))
    return one[:least] == other[:least] and min(len(one), len(other)) >= least


def _name_of(value: object) -> str:
    if isinstance(value, Name):
        return value.name
    return value.question if isinstance(value, Question) else str(value)


def _leaves(tree: Node, slots: frozenset[str]) -> Iterator[Leaf]:
    for name, part in tree.parts.items():
        if name == LEFT_OUT:
            continue  # "every office but Bob's"
        if isinstance(part, Leaf):
            if part.slot in slots:
                yield part
        elif not NO_PART & {part.production.means, part.production.rule}:
            yield from _leaves(part, slots)


def _texts(value: Plan) -> Iterator[str]:
    """All texts in a plan, and its methods; its variables are no words of the speaker's."""
    yield from value.background
    for node in nodes(value.steps):
        if isinstance(node, Text):
            yield node.value
        elif isinstance(node, Call | Ask):
            yield node.method
