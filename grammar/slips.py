"""Slips of the keyboard, and verbs in a form that another word gives them, put right before a
sentence is parsed.

"gothe" and "tothe" are two words; after "would you mind" and in "keep greeting visitors" a command
stands in its -ing form, so that the rules need to name a verb only once. What tokens mean changes,
never where they stand: free text is still taken from the original.
"""

from __future__ import annotations

import functools
import itertools
import operator
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import replace
from typing import Final

from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.names import names_of
from grammar.refusals import signs
from grammar.texts.words import words_for
from grammar.tokens import Token, tokenise
from grammar.wordforms import singular

SHORTEST_JOINED: Final = 4
"""Letters of two words that a space is missing between."""
LONG_ENOUGH: Final = 5
"""Letters of a word that others may be run into: "laccueil", but "lait" is milk."""
VOWELS: Final = frozenset("aeiouy")
"""What a word may begin with that another is elided before."""
SHORTEST_SWAPPED: Final = 3
"""Letters of a function word that may have two of them swapped: "teh"."""
SHORTEST_CORRECTED: Final = 4
"""Letters of a word that may be misspelt."""
LONGEST_CORRECTED: Final = 100
"""Letters of a word that may be a slip: of longer ones there are too many ways to read them."""


def swapped_back(text: str, language: Language, known: Collection[str]) -> tuple[str, int]:
    """A text without the words that are a known one with two letters swapped, and how many there
    were: "taht her pateint is waiting". No word gets longer, so that everything stays where it is;
    what is to be spoken is put right, too. Only where the language lists what is no slip."""
    if "no_swaps" not in language.speech:
        return text, 0
    real = frozenset(language.speech["no_swaps"])
    slips = 0
    for token in tokenise(text, language.spelling):
        word = text[token.start : token.end]
        if token.kind != "word" or not word.islower():
            continue
        if not SHORTEST_SWAPPED <= len(word) <= LONGEST_CORRECTED:
            continue
        if (
            not real.isdisjoint((word, singular(word, language)))
            or token.value is not None
            or is_known(word, language, known)
        ):
            continue
        meant = {
            each
            for each in swaps(word)
            if is_known(each, language, language.closed if len(word) == SHORTEST_SWAPPED else known)
        }
        longer = any(_letter_left_out(word, each) for each in language.closed)  # "evry"
        if len(meant) == 1 and not longer:
            text = f"{text[: token.start]}{meant.pop()}{text[token.end :]}"
            slips += 1
    return text, slips


def _letter_left_out(word: str, whole: str) -> bool:
    """Whether it is another word without one of its letters, but for the first."""
    return len(whole) == len(word) + 1 and any(
        whole[:at] + whole[at + 1 :] == word for at in range(1, len(whole))
    )


def swaps(word: str) -> set[str]:
    """A word with each two neighbouring letters swapped."""
    return {word[:at] + word[at + 1] + word[at] + word[at + 2 :] for at in range(len(word) - 1)} - {
        word
    }


def is_known(word: str, language: Language, known: Collection[str]) -> bool:
    return word in known or word in signs(language) or singular(word, language) in known


def mended(
    tokens: tuple[Token, ...],
    language: Language,
    known: Collection[str],
    verbs: Collection[str],
) -> tuple[Token, ...]:
    """The tokens with joined words parted and verbs in the form that commands begin with."""
    parted = [
        part
        for token in _apart(tokens, language)
        for part in _parted(token, language, known, verbs)
    ]
    return tuple(_in_plain_form(_opened(parted, language), language, verbs))


def _opened(tokens: list[Token], language: Language) -> list[Token]:
    """ "Bob's in the lab" as "Bob is in the lab", by the words that nothing that he owns begins
    with."""
    data = language.speech.get("possessive_or_verb")
    if data is None:
        return tokens
    mark = str(language.speech.get("possessive", "")).strip()
    opened = []
    for at, token in enumerate(tokens):
        follow = [each.norm for each in tokens[at + 1 : at + 3]]
        if follow[:1] and follow[0] in data["between"]:  # "Bob's waiting in the lab"
            follow.pop(0)
        is_verb = token.norm == mark and follow[:1] and follow[0] in data["before"]
        opened.append(replace(token, norm=str(data["verb"])) if is_verb else token)
    return opened


def _apart(tokens: tuple[Token, ...], language: Language) -> Iterator[Token]:
    """ "its in the kitchen" with "it is": words typed without the mark that parts them, where what
    follows tells that they are two."""
    run_together = language.speech.get("run_together", {})
    for token, after in itertools.zip_longest(tokens, tokens[1:]):
        two = run_together.get(token.norm)
        if two is None or after is None or after.norm not in two["before"]:
            yield token
        else:
            yield from (replace(token, norm=str(word)) for word in two["words"])


def _parted(
    token: Token, language: Language, known: Collection[str], verbs: Collection[str]
) -> list[Token]:
    """ "andtell", "tothe" and "givethem" as two words: a little word before any other, and one that
    stands behind others, behind a preposition or a verb. Many a noun only looks so: "carton",
    "invoice"."""
    word = token.norm
    if token.kind != "word" or word in known or len(word) > LONGEST_CORRECTED:
        return [token]
    for cut in (len(each) for each in language.speech.get("elided", ()) if word.startswith(each)):
        rest = word[cut:]
        if rest[:1] in VOWELS and len(rest) >= LONG_ENOUGH and rest in known:  # "laccueil"
            return _cut(token, cut)
    if token.capital or len(word) < SHORTEST_JOINED:
        return [token]
    joined = language.speech.get("joined", {"before": (), "behind": (), "prepositions": ()})
    for cut in range(2, len(word) - 1):
        first, second = word[:cut], word[cut:]
        behind = first in joined["prepositions"] or first in verbs
        if first in joined["before"] and second in known:
            return _cut(token, cut)
        if second in joined["behind"] and behind:
            return _cut(token, cut)
    return [token]


def _cut(token: Token, cut: int) -> list[Token]:
    """A token as two, the second of which begins after so many letters."""
    middle = token.start + cut
    return [
        replace(token, norm=token.norm[:cut], end=middle),
        replace(token, norm=token.norm[cut:], start=middle),
    ]


def _in_plain_form(
    tokens: list[Token], language: Language, verbs: Collection[str]
) -> Iterator[Token]:
    """ "keep greeting them and asking" as "keep greet them and ask": after which words, and with
    which ending, the language's data say. Only what is then a word that a command can begin with is
    taken for a verb."""
    data = language.speech.get("gerunds", {"after": (), "joins": (), "ending": "-"})
    joins, ending = set(data["joins"]), str(data["ending"])
    after = {tuple(str(words).split()) for words in data["after"]}  # "on", "feel like"
    rooms = data.get("rooms", ())  # "go to meeting room" is about no meeting of a room
    counted = data.get("counted", ())  # "the number of waving people" are those who wave
    earlier = False
    for at, token in enumerate(tokens):
        last_two = tuple(each.norm for each in tokens[max(0, at - 2) : at])
        before = last_two[-1] if last_two else ""
        named = at + 1 < len(tokens) and tokens[at + 1].norm in rooms
        number = at > 1 and tokens[at - 2].norm in counted
        asked_for = last_two[-1:] in after or last_two in after
        called_for = (asked_for and not number) or (earlier and before in joins)
        verb = None
        if token.norm.endswith(ending) and called_for and not named:
            verb = next(
                (base for base in plain_forms(token.norm[: -len(ending)]) if base in verbs), None
            )
        earlier = earlier or verb is not None
        yield token if verb is None else replace(token, norm=verb, kind="verb")


def perfects(
    tokens: tuple[Token, ...], language: Language, verbs: Collection[str]
) -> Iterator[tuple[int, tuple[str, ...]]]:
    """The participles of verbs that a command can begin with, and these verbs: "when you have
    greeted him" speaks of greeting him. Unlike a gerund it may also be a word of a rule."""
    data = language.speech.get("perfects")
    if data is None:
        return
    past = language.speech.get("past_forms", {})
    called_for = False
    for at, token in enumerate(tokens):
        if called_for and token.norm in data["between"]:
            continue
        if called_for:
            irregular = (data["forms"].get(token.norm), past.get(token.norm))
            stems = (token.norm.removesuffix(each) for each in data["endings"])
            regular = (base for stem in stems if stem != token.norm for base in plain_forms(stem))
            bases = irregular if any(irregular) else regular
            found = tuple(dict.fromkeys(base for base in bases if base in verbs))
            if found:
                yield at, found
        called_for = token.norm in data["after"]


def plain_forms(stem: str) -> Iterator[str]:
    """What a verb may be without its ending: "greet", "giv" -> "give", "runn" -> "run"."""
    yield stem
    yield f"{stem}e"
    if len(stem) > 2 and stem[-1] == stem[-2]:
        yield stem[:-1]


@functools.cache
def fillers_by_first(language: Language) -> dict[str, list[tuple[str, ...]]]:
    fillers: dict[str, list[tuple[str, ...]]] = {}
    for filler in language.fillers:
        fillers.setdefault(filler[0], []).append(filler)
    return fillers


def spellings(
    tokens: tuple[Token, ...], language: Language, lexicon: Lexicon
) -> dict[int, tuple[str, ...]]:
    """What words may be misspellings of: unknown ones of a word that is one small slip away, and
    little ones of each other where the language says so ("form" for "from")."""
    known = (
        language.words,
        names_of(language, lexicon).words,
        language.closed,
        signs(language),
        language.speech.get("weighty", {}).get("negations", ()),  # "weder" is no "wieder"
        words_for(language).verbs,  # what the robot cannot do is no slip
        listed_nouns(language),
    )
    capital_nouns = bool(language.speech.get("capital_nouns"))
    confused = language.speech.get("confused", {})
    found: dict[int, tuple[str, ...]] = {}
    for at, token in enumerate(tokens):
        if token.kind != "word":
            continue
        if token.norm in confused:
            found[at] = tuple(confused[token.norm])
        elif not any(token.norm in words for words in known):
            short = len(token.norm) < SHORTEST_CORRECTED
            near = (
                misspelt_little(token.norm, language, lexicon)
                if short
                else misspelt(token.norm, language, lexicon)
                or misspelt_beside(tokens, at, language, lexicon)
            )
            if capital_nouns and token.capital and at and tokens[at - 1].kind != "mark":
                nouns = no_slips_of_nouns(language)  # "Milch"
                near = tuple(each for each in near if each not in nouns)
            if near:
                found[at] = near
    return found


@functools.cache
def command_words(language: Language) -> frozenset[str]:
    """The words that a command can begin with."""
    network = language.network
    words: set[str] = set()

    def visit(rule: int, seen: set[int]) -> None:
        if rule in seen or network.starts[rule] < 0:
            return
        seen.add(rule)
        state = network.states[network.starts[rule]]
        words.update(state.words)
        for callee, _, _ in state.calls:
            visit(callee, seen)

    for rule in ("command", "summary"):
        if rule in language.rules:
            visit(network.rule(rule), set())
    others = language.speech.get("not_command_words", ())
    return frozenset(words).difference(*map(language.tokens_of, others))


@functools.cache
def no_slips_of_nouns(language: Language) -> frozenset[str]:
    """Words that a noun cannot be a slip of: "die Leiter" is no "leider", and no "leite"."""
    looks = (words for each in ("attribute", "superlative") for words in _listed(language, each))
    said_anywhere = (word for words in (*language.fillers, *looks) for word in words)
    return language.closed | command_words(language) | frozenset(said_anywhere)


def _listed(language: Language, name: str) -> Iterator[tuple[str, ...]]:
    for words in language.lists.get(name, {}).values():
        yield from words


@functools.cache
def listed_nouns(language: Language) -> frozenset[str]:
    """The nouns whose plurals a language lists."""
    nouns = language.plurals.get("irregular", {})
    return frozenset(norm for each in nouns for norm in language.tokens_of(each))


@functools.lru_cache(maxsize=2048)
def misspelt_little(word: str, language: Language, lexicon: Lexicon) -> tuple[str, ...]:
    """Function words that a short one is with two letters swapped ("yuo"), or of three letters
    those, or words of names, with one left out ("frm", "rom")."""
    near = [each for each in sorted(language.closed) if each in swaps(word)]
    if len(word) == SHORTEST_CORRECTED - 1:
        near += [
            each
            for each in sorted(language.closed | names_of(language, lexicon).words)
            if _letter_left_out(word, each)
        ]
    return tuple(near[:3])


def misspelt_beside(
    tokens: tuple[Token, ...], at: int, language: Language, lexicon: Lexicon
) -> tuple[str, ...]:
    """Words with one letter that is another one here, which stand beside one of its neighbours in
    a name: "living toom"."""
    word = tokens[at].norm
    beside = _pairs(language, lexicon)
    before = tokens[at - 1].norm if at else ""
    after = tokens[at + 1].norm if at + 1 < len(tokens) else ""
    named = {second for first, second in beside if first == before}
    named |= {first for first, second in beside if second == after}
    return tuple(
        each
        for each in sorted(named)
        if len(each) == len(word) and sum(map(operator.ne, each, word)) == 1
    )


@functools.lru_cache(maxsize=16)
def _pairs(language: Language, lexicon: Lexicon) -> frozenset[tuple[str, str]]:
    """Words that stand one after the other in a name."""
    named = map(language.tokens_of, names_of(language, lexicon).spelled)
    return frozenset(pair for words in named for pair in itertools.pairwise(words))


@functools.lru_cache(maxsize=2048)
def misspelt(word: str, language: Language, lexicon: Lexicon) -> tuple[str, ...]:
    """Known words that are one small slip away: a letter left out, doubled, added or swapped with
    its neighbour; in longer words also one wrong letter, in long ones two slips."""
    from rapidfuzz.distance import OSA
    from rapidfuzz.process import extract

    known = sorted(
        each
        for each in language.words | names_of(language, lexicon).words
        if len(each) >= SHORTEST_CORRECTED and each[0] == word[0]
    )
    most = 2 if len(word) >= 8 else 1
    found = extract(word, known, scorer=OSA.distance, score_cutoff=most, limit=4)
    near: list[str] = []
    for other, distance, _ in found:
        if found and distance > found[0][1]:
            break
        wrong = (Counter(word) - Counter(other)).total() if len(other) == len(word) else 0
        if wrong > (0 if len(word) < 6 else 1):  # a ballroom is no bathroom
            continue
        near.append(other)
    return tuple(near[:3])
