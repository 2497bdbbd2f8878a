"""Which of the options an answer means (`match_answer`), and which of the questions that are
prepared for somebody asks (`match_question`), without guessing.

People answer "to the radiology, please", "the second one", "yeah, sure", "zwo". The answer is
folded to words, its numbers to digits, and then read in turn as

1. the option word for word,
2. a yes or a no, for options that are one,
3. words of which the option is part, or that are part of the option, with slips and inflections,
4. the position of the option, for a bare number or ordinal.

The first reading that fits decides; if two options fit it equally well, there is no answer.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from robot_api.capabilities.languages import (
    Language,
    Words,
    fold,
    known_languages,
    language_data,
)

_ALIKE = 82.0
"""From this similarity on, of 100, two words count as the same word in another form."""
_MARGIN = 5.0
"""By so much the best option must fit better than the next."""
_SAME_QUESTION = 75.0
"""From this share of words in common on, in percent, two questions are the same."""
_ORDINAL = "#"
"""Marks an ordinal among the words: "second" is "#2"."""


def match_answer(heard: str, options: Sequence[str], language: str = "en") -> str | None:
    """The option that the words heard mean, exactly as it is written; None if none or several do.

    >>> match_answer("to the radiology please", ["radiology", "pharmacy"])
    'radiology'
    >>> match_answer("the second one", ["radiology", "pharmacy"])
    'pharmacy'
    >>> match_answer("radiology or pharmacy", ["radiology", "pharmacy"])
    """
    if heard in options:
        return heard
    words = language_data(language)
    answer = _canonical(fold(heard), words)
    if not answer:
        return None
    readings = [_Option(text, _option_words(text, words), words) for text in options]
    for fitting in _in_turn(answer, fold(heard), readings, words):
        texts = {option.text for option in fitting}
        if texts:
            return texts.pop() if len(texts) == 1 else None
    return None


def match_question(
    heard: str, questions: Sequence[Sequence[str]], language: str = "en"
) -> int | None:
    """Which of the prepared questions, each given by the ways of asking it, somebody asks: its
    position, or None if none or several fit.

    >>> match_question("where's the toilet?", [["When is lunch?"], ["Where is the toilet?"]])
    1
    """
    words = language_data(language)
    dull = words.fillers | words.question_fillers
    asked = _said(heard, dull)
    scores = [
        max((_overlap(asked, _said(way, dull)) for way in ways), default=0.0) for ways in questions
    ]
    best = max(scores, default=0.0)
    fitting = [at for at, score in enumerate(scores) if score > best - _MARGIN]
    return fitting[0] if best >= _SAME_QUESTION and len(fitting) == 1 else None


class _Option:
    """An option, taken apart once."""

    def __init__(self, text: str, words: Words, language: Language) -> None:
        self.text = text
        self.words = words
        self.content = _content(words, language)
        self.polarity = _option_polarity(text)


def _in_turn(
    answer: Words, spoken: Words, options: Sequence[_Option], language: Language
) -> Iterator[Collection[_Option]]:
    """The options that fit each reading of the answer, the surest reading first."""
    yield [option for option in options if option.words == answer]
    yield [option for option in options if set(option.content) == set(_content(answer, language))]

    polarity = _answer_polarity(spoken, language)
    polar = [option for option in options if polarity is not None and option.polarity is polarity]
    # "Yes" and "no" inside an answer mean an agreement, not the option that is spelled so.
    others = [option for option in options if option.polarity is None]
    mentioned = _mentioned(answer, others)
    if _negated(spoken, mentioned, language):
        mentioned = []
    yield [*polar, *mentioned]

    if not _has(spoken, language.negations):
        yield _abbreviated(answer, others, language)
        yield _run_together(answer, others, language)
        yield _at_position(answer, others, options, language)


# --- words ---------------------------------------------------------------------------------------


def _canonical(words: Words, language: Language) -> Words:
    """The words with numbers as digits and ordinals marked: ("the", "#2")."""
    table: dict[Words, str] = {words: str(number) for words, number in language.numbers.items()}
    table |= {words: f"{_ORDINAL}{number}" for words, number in language.ordinals.items()}
    table |= dict.fromkeys(language.last, f"{_ORDINAL}last")
    longest = max(map(len, table), default=0)
    canonical: list[str] = []
    at = 0
    while at < len(words):
        for length in range(min(longest, len(words) - at), 0, -1):
            found = table.get(words[at : at + length])
            if found:
                # "the second one" counts one thing, not two.
                if not (found == "1" and canonical and canonical[-1].startswith(_ORDINAL)):
                    canonical.append(found)
                at += length
                break
        else:
            canonical.append(words[at])
            at += 1
    return tuple(canonical)


def _option_words(text: str, language: Language) -> Words:
    """Options are often written in English though the robot speaks another language."""
    return _canonical(_canonical(fold(text), language), language_data("en"))


def _telling(words: Words, language: Language) -> Words:
    """The words that say something."""
    return tuple(word for word in words if word not in language.fillers)


def _content(words: Words, language: Language) -> Words:
    """The words that say something; all of them if none does."""
    return _telling(words, language) or words


def _said(text: str, dull: Collection[str]) -> Words:
    words = fold(text)
    return tuple(word for word in words if word not in dull) or words


def _overlap(one: Words, other: Words) -> float:
    """What share of the words of both, in percent, the two have in common."""
    if not one or not other:
        return 0.0
    common = sum(_best_alike(word, other) >= _ALIKE for word in one)
    common += sum(_best_alike(word, one) >= _ALIKE for word in other)
    return 100 * common / (len(one) + len(other))


def _has(words: Words, phrases: Collection[Words]) -> bool:
    return any(
        words[at : at + len(phrase)] == phrase
        for phrase in phrases
        for at in range(len(words) - len(phrase) + 1)
    )


# --- yes and no ----------------------------------------------------------------------------------


def _option_polarity(text: str) -> bool | None:
    """True for an option that is a yes ("yes", "Ja, bitte", "Yes, I have pain"), False for a no."""
    words = fold(text)
    for code in known_languages():
        language = language_data(code)
        for says, phrases in ((True, language.plain_yes), (False, language.plain_no)):
            if any(words[: len(phrase)] == phrase for phrase in phrases):
                return says
    return None


def _answer_polarity(words: Words, language: Language) -> bool | None:
    """True for an answer that agrees, False for one that refuses, None for neither or both."""
    # A phrase in two lists counts for the last of these.
    kinds: Mapping[str, Collection[Words]] = {
        "not": language.negations,
        "no": language.plain_no | language.refusing,
        "yes": language.plain_yes | language.agreeing,
        "unsure": language.unsure,
    }
    phrases = {phrase: kind for kind, those in kinds.items() for phrase in those}
    longest = max(map(len, phrases), default=0)
    found: set[str] = set()
    at = 0
    while at < len(words):
        for length in range(min(longest, len(words) - at), 0, -1):
            kind = phrases.get(words[at : at + length])
            if kind:
                found.add(kind)
                at += length
                break
        else:
            at += 1
    if found == {"yes"}:
        return True
    if "no" in found and found <= {"no", "not"}:
        return False
    return None


def _negated(spoken: Words, mentioned: Collection[_Option], language: Language) -> bool:
    """ "Not the pharmacy" says where not to go; "no smoking" is an option of that name."""
    return any(not _has(fold(option.text), language.negations) for option in mentioned) and _has(
        spoken, language.negations
    )


# --- content -------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Claim:
    """The words of the answer that an option takes for itself, and how alike they are."""

    option: _Option
    words: frozenset[int]
    likeness: float


def _mentioned(answer: Words, options: Sequence[_Option]) -> Collection[_Option]:
    """The options all of whose words the answer has."""
    claims = [claim for option in options if (claim := _claim(option, answer))]
    return [mine.option for mine in claims if not any(_prevails(other, mine) for other in claims)]


def _claim(option: _Option, answer: Words) -> _Claim | None:
    if not option.content:
        return None
    taken: set[int] = set()
    likeness = 0.0
    for word in option.content:
        free = [at for at in range(len(answer)) if at not in taken]
        if not free:
            return None
        best = max(free, key=lambda at: _alike(word, answer[at]))
        alike = _alike(word, answer[best])
        if alike < _ALIKE:
            return None
        taken.add(best)
        likeness += alike
    return _Claim(option, frozenset(taken), likeness / len(option.content))


def _prevails(one: _Claim, other: _Claim) -> bool:
    """ "Coffee with milk" prevails over "coffee", and the right spelling over a similar one."""
    if one.words > other.words:
        return True
    return one.words == other.words and one.likeness >= other.likeness + _MARGIN


def _abbreviated(
    answer: Words, options: Sequence[_Option], language: Language
) -> Collection[_Option]:
    """The options that have all that the answer says: "intensive care" for the whole unit."""
    said = _telling(answer, language)
    scores = [(option, [_best_alike(word, option.content) for word in said]) for option in options]
    return _best(
        (option, sum(likeness) / len(likeness))
        for option, likeness in scores
        if likeness and min(likeness) >= _ALIKE
    )


def _run_together(
    answer: Words, options: Sequence[_Option], language: Language
) -> Collection[_Option]:
    """The options that sound alike however the words are parted: "radio logy", "1 0 2"."""
    said = "".join(_content(answer, language))
    return _best(
        (option, likeness)
        for option in options
        if (likeness := _alike("".join(option.content), said)) >= _ALIKE
    )


def _best(scores: Iterator[tuple[_Option, float]]) -> Collection[_Option]:
    ranked = list(scores)
    top = max((score for _, score in ranked), default=0.0)
    return [option for option, score in ranked if score > top - _MARGIN]


def _best_alike(word: str, words: Words) -> float:
    return max((_alike(word, other) for other in words), default=0.0)


def _alike(one: str, other: str) -> float:
    """How alike two words are, 0 to 100. Numbers, short words and words that begin differently
    ("happy", "unhappy") are alike only if they are equal."""
    if one == other:
        return 100.0
    if min(len(one), len(other)) < 4 or one[0] != other[0] or _has_digit(one + other):
        return 0.0
    from rapidfuzz import fuzz

    likeness = fuzz.ratio(one, other)
    shared = next(
        (at for at, (a, b) in enumerate(zip(one, other, strict=False)) if a != b),
        min(len(one), len(other)),
    )
    shorter, longer = sorted((len(one), len(other)))
    inflected = shared >= 0.65 * longer  # "pharmacy", "pharmacies"
    compound = shared == shorter  # "Röntgen", "Röntgenabteilung"
    return max(likeness, _ALIKE) if shared >= 5 and (inflected or compound) else likeness


def _has_digit(word: str) -> bool:
    return any(c.isdigit() for c in word)


# --- position ------------------------------------------------------------------------------------


def _at_position(
    answer: Words, fitting: Sequence[_Option], options: Sequence[_Option], language: Language
) -> Collection[_Option]:
    """The option in the place of a bare "two", "number two" or "the second"."""
    said = [word for word in _telling(answer, language) if word not in language.position]
    if len(said) != 1:
        return []
    number = said[0].removeprefix(_ORDINAL)
    is_ordinal = said[0].startswith(_ORDINAL)
    numbered = any(_has_digit(word) for option in options for word in option.words)
    if numbered and not is_ordinal:
        return []
    if number == "last":
        return options[-1:]
    if not number.isdecimal() or not 1 <= int(number) <= len(options):
        return []
    # Among options that are numbers themselves, "the second" may mean the 2 or the one in place 2.
    return {options[int(number) - 1], *(o for o in fitting if o.content == (number,))}
