"""The answers that a question offers: its choices, the numbers of a scale, yes and no."""

from __future__ import annotations

from typing import Final

from grammar.chart import Node
from grammar.discourse import Discourse
from grammar.errors import NotUnderstood
from grammar.names import names_of
from grammar.plan import Ask, Items, Text, Value
from grammar.tokens import COLON, COMMA
from grammar.wordforms import singular

MOST_OPTIONS: Final = 20
MOST_PLACES: Final = 40
"""Places that an answer is looked for among."""


def options_of(d: Discourse, node: Node) -> tuple[str, ...]:
    """The answers that a question offers: its choices, or yes and no."""
    return _with_nouns(d, node, _offered(d, node))


def _with_nouns(d: Discourse, node: Node, options: tuple[str, ...]) -> tuple[str, ...]:
    """Choices with the noun that is said of another one or before them: "the red pen or the blue
    one", "the red or the blue pen", "which pen: the red one or the blue one"."""
    ones = d.language.words_called("one_words")
    words = [option.split() for option in options]
    stands_for = [
        len(each) > 1 and not each[-1].isdigit() and d.language.tokens_of(each[-1])[0] in ones
        for each in words  # "hall 1" is no "red one"
    ]
    named = [
        each[-1] for each, one in zip(words, stands_for, strict=True) if len(each) > 1 and not one
    ]
    asked = node.parts.get("wh")
    noun = asked.parts.get("noun") if isinstance(asked, Node) else None
    if noun is not None:
        named.append(d.words(noun.start, noun.end))
    if len(options) < 2 or not named:
        return options
    completed: list[str] = []
    for each, one in zip(words, stands_for, strict=True):
        if one:
            each = [*each[:-1], named[0]]
        elif len(each) == 1 and len(named) == len(options) - 1 and _is_attribute(d, each[0]):
            each = [*each, named[-1]]
        completed.append(" ".join(each))
    return tuple(completed)


def _is_attribute(d: Discourse, word: str) -> bool:
    """Whether a word says how a thing looks: "red", "small"."""
    tries = names_of(d.language, d.lexicon).tries
    known = (tries[each] for each in ("attribute", "colour") if each in tries)
    branches = [trie.branches.get(word.lower()) for trie in known]
    return any(branch is not None and bool(branch.values) for branch in branches)


def _offered(d: Discourse, node: Node) -> tuple[str, ...]:
    fixed = node.production.fixed
    listed = node.parts.get("options")
    if listed is not None:
        named = split_options(d, listed.start, listed.end, whole=True)
        if len(named) == 1 and d.tokens[listed.start].norm == COMMA:
            # "ask her what she wants, get it and ...": no choice
            said = d.words(listed.start, listed.end)
            raise NotUnderstood(d.language.phrase("not_understood", part=said))
        return named
    numbers = numbers_offered(d, node.start, node.end)
    if numbers:
        return numbers
    if fixed.get("choices") and "rest" in node.parts:
        return split_options(d, node.parts["rest"].start, node.parts["rest"].end)
    joins = set(d.language.speech.get("or", ()))
    rest, tail = node.parts.get("rest"), node.parts.get("tail")
    if rest is not None and tail is not None and d.tokens[tail.start].norm in joins:
        later = split_options(d, max(rest.start, rest.end - 1), tail.end)[1:]
        words = max(len(each.split()) for each in later) if later else 1
        return split_options(d, max(rest.start, rest.end - words), tail.end)
    subject = node.parts.get("subject")
    if subject is not None and joins & set(d.norms(subject.start, subject.end)):
        return split_options(d, subject.start, subject.end)
    if rest is not None and joins & set(d.norms(rest.start, rest.end)):
        start = rest.start
        if not fixed.get("yes_no") and d.tokens[start - 1].norm != COMMA:
            start = _end_of_question(d, start, rest.end)
        offered = split_options(d, start, rest.end)
        if len(offered) > 1:
            return offered  # "ob sie oder Alice Dienst hat" leaves but one
    if fixed.get("yes_no") or (d.answers.asking_each and "each" in fixed):
        return (d.language.phrase("yes"), d.language.phrase("no"))
    return ()


def numbers_offered(d: Discourse, start: int, end: int) -> tuple[str, ...]:
    """ "from one to five": the numbers, if these words are among some."""
    for scale in d.language.speech.get("scales", ()):
        words = tuple(norm for word in scale for norm in d.language.tokens_of(word))
        for at in range(start, end - 3):
            low, high = d.tokens[at + 1].value, d.tokens[at + 3].value
            if (d.tokens[at].norm, d.tokens[at + 2].norm) != words:
                continue
            if low is not None and high is not None and 0 < high - low < MOST_OPTIONS:
                return tuple(str(number) for number in range(int(low), int(high) + 1))
    return ()


def _end_of_question(d: Discourse, start: int, end: int) -> int:
    """Where the choices begin in "to drink, coffee, tea or water"."""
    marks = [at for at in range(start, end) if d.tokens[at].norm in (COMMA, COLON)]
    return marks[0] + 1 if marks else start


def split_options(d: Discourse, start: int, end: int, *, whole: bool = False) -> tuple[str, ...]:
    """ "to go to radiology or to the pharmacy" -> radiology, pharmacy.

    What stands between the joining words is an option, without the little words before it; of the
    first, only as many words at its end as the others have, unless the choices are all that is
    said (`whole`). Places go by their names."""
    joins = (
        set(d.language.speech.get("or", ())) | set(d.language.speech.get("joins", ())) | {",", ":"}
    )
    groups: list[tuple[int, int]] = []
    first = start
    for position in range(start, end + 1):
        if position == end or d.tokens[position].norm in joins:
            if position > first:
                groups.append((first, position))
            first = position + 1
    stripped = [without_little_words(d, *group) for group in groups]
    if not stripped:
        return ()
    stripped[-1] = _without_what_follows(d, stripped)
    longest = max(last - begin for begin, last in stripped[1:]) if stripped[1:] else 1
    options: list[str] = []
    for number, (begin, last) in enumerate(stripped):
        place = place_at_end(d, begin, last) or _numbered(d, options, begin, last)
        if place:
            options.append(d.called(place))
            continue
        if number == 0 and len(stripped) > 1:
            row = by_articles(d, groups) or in_a_row(d, groups[0], longest)
            if row:
                options += row
                continue
            begin = begin if whole else max(begin, last - longest)
            while begin < last - 1 and d.tokens[begin].norm in _words_of(d, "wishes"):
                begin += 1  # "like tea"
            begin, last = without_little_words(d, begin, last)
        options.append(d.words(begin, last).strip(" ()"))
    # "one, two or three boxes": how many of them
    numbers = [d.tokens[begin].value for begin, last in stripped[:-1] if last - begin == 1]
    numbers.append(d.tokens[stripped[-1][0]].value)
    if len(numbers) == len(stripped) > 1 and all(each is not None for each in numbers):
        unit = _time_of_day(d, stripped[-1])
        options = [f"{number:g}{unit}" for number in numbers]  # as digits, to count with
    return tuple(dict.fromkeys(option for option in options if option))


def _time_of_day(d: Discourse, group: tuple[int, int]) -> str:
    """What "4, 5 or 6 PM" says of all of them, though it stands behind the last."""
    clock = set(d.language.speech.get("clock_words", ()))
    start, end = group
    if end - start != 2 or d.tokens[start + 1].norm not in clock:
        return ""
    return f" {d.words(start + 1, end)}"


def by_articles(d: Discourse, groups: list[tuple[int, int]]) -> list[str]:
    """The first choices of "an interview a lecture or a delivery", where no commas part them."""
    articles = _words_of(d, "articles")
    start, end = groups[0]
    begins = [at for at in range(start, end) if d.tokens[at].norm in articles]
    parted = all(d.tokens[at - 1].norm not in d.language.closed for at in begins[1:])
    if len(begins) < 2 or not parted or d.tokens[groups[-1][0]].norm not in articles:
        return []
    ends = [*begins[1:], end]
    return [d.words(at + 1, last) for at, last in zip(begins, ends, strict=True) if at + 1 < last]


def in_a_row(d: Discourse, group: tuple[int, int], longest: int) -> list[str]:
    """The choices of "chocolate caramel or gummy", where no commas part them, as in speech; none
    for "orange juice or water", where the first two words are one."""
    start, end = group
    before = _words_of(d, "articles") | _words_of(d, "wishes")
    while start < end and d.tokens[start].norm in before:  # "like a chocolate"
        start += 1
    words = d.norms(start, end)
    if longest > 1 or len(words) < 2 or set(words) & d.language.closed:
        return []
    alike = all(token.value is not None for token in d.tokens[start:end])
    parts = _words_of(d, "compound_first"), _words_of(d, "compound_last")
    compound = len(words) > 2 or words[0] in parts[0] or words[-1] in parts[1]
    if not _of_one_list(d, start, end) and (compound or not any(parts) or alike):
        return []
    return [d.words(at, at + 1) for at in range(start, end)]


def _words_of(d: Discourse, name: str) -> set[str]:
    return set(d.language.speech.get(name, ()))


def _of_one_list(d: Discourse, start: int, end: int) -> bool:
    """Whether all words are of one kind that the language lists: days, colours."""
    lists = d.language.speech.get("listed_alike", ())
    return any(all(norm in row for norm in d.norms(start, end)) for row in lists)


def without_little_words(d: Discourse, start: int, end: int) -> tuple[int, int]:
    kept = d.language.words_called("negations")  # "not at all"
    while start < end - 1 and d.tokens[start].norm in d.language.closed:
        if d.tokens[start].norm in kept or _of_one_list(d, start, start + 1):
            break  # "Sunday for the picnic"
        start += 1
    if d.language.speech.get("capital_nouns"):  # "den Schlüssel leihen": the verb is no part of it
        nouns = [at for at in range(start, end) if d.tokens[at].capital]
        end = nouns[-1] + 1 if nouns else end
    return start, end


def _without_what_follows(d: Discourse, groups: list[tuple[int, int]]) -> tuple[int, int]:
    """The last choice without what is said of all of them: "pasta or salad for lunch"."""
    ends = d.language.words_called("after_options")
    start, end = groups[-1]
    if len(groups) < 2 or any(ends & set(d.norms(begin + 1, last)) for begin, last in groups[1:-1]):
        return start, end
    for at in range(start + 1, end):
        if d.tokens[at].norm in ends and not place_at_end(d, start, end):
            return start, at
    return start, end


def _numbered(d: Discourse, options: list[str], start: int, end: int) -> str | None:
    """The place that a number stands for after another one: "meeting room 1, 2 or 3"."""
    before = options[-1].split() if options else []
    if end - start != 1 or d.tokens[start].value is None or len(before) < 2:
        return None
    words = " ".join((*before[:-1], d.tokens[start].norm)).lower()
    names = (name for place in d.lexicon.places for name in (place.name, d.called(place.name)))
    return next((each for each in names if each.lower() == words), None)


def places_asked_for(d: Discourse, question: Node) -> Value | None:
    """The places that may answer a question for a room, an office or any place: "which meeting room
    is free"; None for other questions."""
    part = question.parts.get("wh") or question.parts.get("noun")
    if part is None or part.end - part.start < (1 if "noun" in question.parts else 2):
        return None
    words = d.norms(part.start, part.end)
    last = singular(words[-1], d.language)
    any_place = last in d.language.words_called("place_nouns")
    for kind, places in d.lexicon.place_kinds.items():
        said = d.language.tokens_of(kind)
        numbered = any(d.language.tokens_of(each.name)[: len(said)] == said for each in places)
        if any_place and len(words) == len(said) + 1 and not numbered:
            continue  # "which room": no house calls only its meeting rooms so
        if tuple(words[-len(said) :]) == said and len(places) <= MOST_OPTIONS:
            first = d.norms(part.end - len(said) - 1, part.end - len(said))[0]  # "meeting" room
            called = [each for each in places if first in d.language.tokens_of(each.name)]
            return Items(tuple(Text(each.name) for each in called or places))
    if last in d.language.words_called("place_nouns") and len(d.lexicon.places) <= MOST_PLACES:
        return Ask("places")
    return None


def place_at_end(d: Discourse, start: int, end: int) -> str | None:
    """The place whose name the last words are."""
    trie = names_of(d.language, d.lexicon).tries.get("place")
    for begin in range(start, end):
        node = trie
        for token in d.tokens[begin:end]:
            node = node.branches.get(token.norm) if node else None
        if node and node.values:
            return str(node.values[0].name)
    return None


def places_named(d: Discourse, start: int, end: int) -> list[str]:
    """The places that are spoken of by their names among some words."""
    return _named(d, "place", start, end)


def people_named(d: Discourse, start: int, end: int) -> list[str]:
    """The people who are spoken of by their names among some words."""
    return _named(d, "person", start, end)


def _named(d: Discourse, kind: str, start: int, end: int) -> list[str]:
    known: list[str] = []
    for at in range(start, end):
        branch = names_of(d.language, d.lexicon).tries.get(kind)
        for token in d.tokens[at:end]:
            branch = branch.branches.get(token.norm) if branch else None
            if branch and branch.values:
                known.append(branch.values[0].name)
    return known


def names_people(d: Discourse, start: int, end: int) -> bool:
    """Whether some words speak of somebody: "see the visitor now" offers nothing to bring."""
    kinds = names_of(d.language, d.lexicon).tries.get("person_kind")
    if kinds is None:
        return False
    begun = (kinds.branches.get(norm) for norm in d.norms(start, end))
    return any(each is not None and each.values for each in begun)
