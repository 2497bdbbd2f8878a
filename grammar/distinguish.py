"""Which one of several is meant: "the red one", "the one in the lobby", "no, take the red cup"."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Final

from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.pieces import PRONOUNS, leading, words_listed

if TYPE_CHECKING:
    from grammar.edits import Sentence
    from grammar.reader import SentenceReader

MOST_ENDING: Final = 3
"""Letters that an adjective may be longer than another of its forms."""


def with_other_look(before: Sentence, new: SentenceReader, *, instead: bool = False) -> str | None:
    """ "no, the red one": the last thing with another word for how it looks. `instead`: only
    if there is a word for that already."""
    language, lexicon = before.reader.language, before.reader.lexicon
    counted = {word for (word,) in words_listed(language, "counted_words")}
    words = [
        token
        for at, token in enumerate(new.tokens[: new.last_word])
        if at >= new.lead and at not in new.skips and token.kind == "word"
    ]
    with_one = bool(words) and words[-1].norm in counted
    words = words[:-1] if with_one else words
    thing = next((each for each in reversed(before.pieces()) if each.rule == "thing"), None)
    if not words or thing is None or thing.means in PRONOUNS:
        return None
    if not with_one and not all(_is_look(word.norm, language, lexicon) for word in words):
        return None
    look = new.text[words[0].start : words[-1].end]
    first = thing.start
    while first < thing.end and before.reader.is_little(range(first, first + 1)):
        first += 1
    head = first
    while head < thing.end and _is_look(before.tokens[head].norm, language, lexicon):
        head += 1
    if head == thing.end:
        return None
    if first < head:  # there is a look already
        return before.with_words(first, head, look)
    after = head + 1
    while after < thing.end and _is_look(before.tokens[after].norm, language, lexicon):
        after += 1
    if after > head + 1:  # or behind the noun
        return before.with_words(head + 1, after, look)
    if instead:
        return None
    noun = before.reader.words(head, head + 1)
    first_noun = language.speech.get("adjectives_first") or "adjectives_first" not in (
        language.speech
    )
    return before.with_words(head, head + 1, f"{look} {noun}" if first_noun else f"{noun} {look}")


def one_told_apart(before: Sentence, new: SentenceReader) -> SentenceReader | None:
    """ "the one in the lobby": the last thing or kind of person, with what tells it from others."""
    ones = words_listed(new.language, "ones")
    those = (each for each in reversed(before.pieces()) if each.rule in ("thing", "person_ref"))
    thing = next((each for each in those if each.means in ("thing", "person_kind")), None)
    if thing is None:
        return None
    for at in range(new.last_word - 1):
        if (new.tokens[at].norm,) in ones and leading(new, at + 2):
            noun = before.reader.words(thing.start, thing.named_until or thing.end)
            return type(new)(f"{noun} {new.words(at + 1, new.last_word)}", *before.world())
        if not new.is_little(range(at, at + 1)):
            return None
    return None


def thing_alone(before: Sentence, new: SentenceReader) -> SentenceReader | None:
    """The thing of a command that names nothing else, and is another one of what was spoken
    of: "take the red cup"."""
    pieces = [each for each in type(before)(new).pieces() if each.means not in PRONOUNS]
    if len(pieces) != 1 or pieces[0].rule != "thing":
        return None
    words = new.content(pieces[0].start, pieces[0].end)
    like = (each for each in before.pieces() if each.rule == "thing")
    if not any(words & before.reader.content(each.start, each.end) for each in like):
        return None
    return type(new)(new.words(pieces[0].start, pieces[0].end), *before.world())


def _is_look(word: str, language: Language, lexicon: Lexicon) -> bool:
    """Whether a word says how something looks: "red", "rote", "verte"."""
    return any(
        word[:3] == look[:3]
        and abs(len(word) - len(look)) <= MOST_ENDING
        and word.startswith(look[: len(word) - MOST_ENDING])  # "assiette" is not "assis"
        for look in _looks(language, lexicon)
    )


@functools.lru_cache(maxsize=16)
def _looks(language: Language, lexicon: Lexicon) -> frozenset[str]:
    known = {word for name in lexicon.objects for word in name.attributes}
    looks: dict[str, str] = language.speech.get("looks", {})
    told = (look.partition("⟨")[0].split()[-1:] for look in looks.values() if look)
    said = {word for words in told for text in words for word in language.tokens_of(text)}
    listed = language.lists.get("superlative", {}).values()
    said |= {word for ways in listed for way in ways for word in way}
    return frozenset({each for each in said if len(each) > 2} | (known if not looks else set()))
