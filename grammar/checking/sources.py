"""Where each literal of a plan came from: a word of the sentence, a name of the world, a default.

What came from nowhere was invented, and a plan with it is refused; but for words in which the
robot says what it has found out, and for what the order leaves to it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Final
from typing import Literal as OneOf

from grammar.checking.evidence import evidence_of
from grammar.checking.literals import COMPARED, COUNTED, Literal, literals
from grammar.checking.words import alike, content, forms, idle, words_of, words_of_phrases
from grammar.lexicon import kind_of, series_of
from grammar.plan import Plan
from grammar.planning.mentions import Mention, written
from grammar.planning.turn import Turn
from grammar.roles import ANYBODY, CHOICE, FREE, NUMBERS, OPTIONS, QUANTITIES, SORTS, role
from robot_api.methods import METHODS

Origin = OneOf["name", "words", "number", "before", "default", "answer", "own"]

_SORTS: Final = {**SORTS, **QUANTITIES}
_LEFT_TO_THE_ROBOT: Final = frozenset(
    {"gestures", "emotions", "joints", "skills", "languages", "kinds", "percents", CHOICE}
)
"""Roles whose literal may be one that nobody said: how to look "grumpy", how loud "quietly" is."""
_DEGREES: Final = frozenset({0.0, 45.0, 90.0, 180.0, 360.0})
_SMALL: Final = frozenset({0.0, 1.0, 2.0, 60.0, 100.0})
"""Numbers that a program may need besides: to start with, to count by, minutes of an hour."""
_BY_NUMBERS: Final = frozenset(
    method.name
    for method in METHODS.values()
    for form in method.forms
    for each in form
    if role(method, each) == "numbers"
)
"""Methods that take speeds or coordinates: how fast, how long and where to, somebody must say."""
_LONGEST_PAUSE: Final = 60.0
"""Seconds between two looks that nobody has to say."""


@dataclass(frozen=True)
class Source:
    literal: Literal
    origin: Origin
    tokens: frozenset[int] = frozenset()
    """The tokens of the sentence that it came from."""
    own: tuple[str, ...] = ()
    """Of words that are said: those that nobody has said, and no robot says of itself."""


class Sources:
    """The sources of the literals of one plan."""

    def __init__(self, turn: Turn, plan: Plan) -> None:
        self.turn = turn
        self.plan = plan
        self.language = turn.language
        self.found: list[Source] = []
        self.invented: list[Literal] = []
        for literal in literals(plan):
            source = self.of(literal)
            if source is None:
                self.invented.append(literal)
            else:
                self.found.append(source)

    @cached_property
    def heard(self) -> dict[int, set[str]]:
        """The forms of each token; of a quotation, its words."""
        return {
            at: forms(token, self.language) | words_of(token.inner, self.language)
            for at, token in enumerate(self.turn.tokens)
        }

    @cached_property
    def heard_before(self) -> set[str]:
        """The words of what was said and planned before."""
        planned = self.turn.context.plan
        texts = [each.text for each in literals(planned)] if planned else []
        texts += [turn.text for turn in self.turn.earlier]
        return {word for text in texts for word in words_of(text, self.language)}

    @cached_property
    def in_another_language(self) -> bool:
        """Whether something is to be said in a language that is not that of the sentence."""
        return any(each.sort == "language" for each in self.turn.spoken_of)

    @cached_property
    def left_to_the_robot(self) -> bool:
        """Whether a word leaves to the robot what it says: "tell me a joke"."""
        return any(
            token.norm == word or (word.endswith("*") and token.norm.startswith(word[:-1]))
            for token in self.turn.tokens
            for word in map(str, self.language.speech.get("left_to_the_robot", ()))
        )

    @cached_property
    def before(self) -> frozenset[str]:
        """The literals of the plan before, which may be spoken of again, and what the conversation
        is about."""
        context = self.turn.context
        known = [each.text for each in literals(context.plan)] if context.plan else []
        known += [context.origin or ""]
        for part in (context.place, context.source, context.thing, context.person):
            value = getattr(part, "value", None)
            known.append(value if isinstance(value, str) else getattr(value, "value", ""))
        return frozenset(str(each).lower() for each in known if each)

    # --- one literal

    def is_from_before(self, literal: Literal) -> bool:
        """Whether it was planned before, or said at another time that counts here."""
        text = literal.text.lower()
        if text in self.before:
            return True
        said = [each.value.lower() for turn in self.turn.earlier for each in turn.mentions]
        words = words_of(literal.text, self.language)
        return text in said or bool(words and words <= self.heard_before)

    def of(self, literal: Literal) -> Source | None:
        if literal.value and self.is_from_before(literal):
            return Source(literal, "before", self.mentioned(literal))
        if isinstance(literal.value, float):
            return self.number(literal, literal.value)
        if literal.role in (FREE, OPTIONS):
            return self.spoken(literal)
        if literal.role == COMPARED:
            return self.compared(literal)
        return self.name(literal)

    def name(self, literal: Literal) -> Source | None:
        tokens = self.mentioned(literal)
        if tokens:
            return Source(literal, "name", tokens)
        if literal.role == "places":
            figures = frozenset(at for word in literal.text.split() for at in self.figure(word))
            spoken = self.owners(literal.text) or self.of_a_kind(literal.text) or figures
            return Source(literal, "name", spoken | figures) if spoken else None
        if literal.role in ("people", "things") and literal.text == ANYBODY:
            return Source(literal, "default")
        words = self.words(literal.text)
        if words is not None:
            return Source(literal, "words", words)
        return Source(literal, "default") if literal.role in _LEFT_TO_THE_ROBOT else None

    def mentioned(self, literal: Literal) -> frozenset[int]:
        """The tokens of what is called so; a thing may be a person, and the other way round."""
        sorts = {_SORTS.get(literal.role)}
        if sorts & {"thing", "person"}:
            sorts |= {"thing", "person"}
        if literal.role in (COMPARED, FREE, OPTIONS):
            sorts |= {"place", "person", "thing", "time", "kind"}
        found = [
            each
            for each in self.turn.mentions
            if each.sort in sorts and each.value.lower() == literal.text.lower()
        ]
        return _tokens_of(found)

    def owners(self, place: str) -> frozenset[int]:
        """The tokens of people after whom a place is called."""
        known = next((p for p in self.turn.lexicon.places if p.name == place), None)
        called = " ".join((known.name, *known.aliases)).lower() if known else ""
        names = {each.name: (each.name, *each.aliases) for each in self.turn.lexicon.people}
        return _tokens_of(
            each
            for each in self.turn.mentions
            if each.sort == "person"
            and each.value != ANYBODY
            and any(name.lower() in called for name in names.get(each.value, (each.value,)))
        )

    def of_a_kind(self, place: str) -> frozenset[int]:
        """The tokens of a kind, or a series, of which a place is one: "the meeting rooms"."""
        known = next((p for p in self.turn.lexicon.places if p.name == place), None)
        if known is None:
            return frozenset()
        kinds = {kind_of(known)} | {series_of(each) for each in (known.name, *known.aliases)}
        return _tokens_of(each for each in self.kinds_spoken_of if each.value in kinds)

    @cached_property
    def kinds_spoken_of(self) -> tuple[Mention, ...]:
        """Kinds of places, but for those that are only a part of a name: "waiting room"."""
        names = [
            (turn, each.start, each.end)
            for turn in (self.turn, *self.turn.earlier)
            for each in turn.mentions
            if each.sort == "place" and each.cost < 0.5
        ]
        return tuple(
            each
            for turn in (self.turn, *self.turn.earlier)
            for each in turn.mentions
            if each.sort == "kind"
            and not any(
                turn is other
                and start <= each.start
                and each.end <= end
                and end - start > each.end - each.start
                for other, start, end in names
            )
        )

    def words(self, text: str) -> frozenset[int] | None:
        """The tokens in which the words of a text were said; None if one was not."""
        tokens: set[int] = set()
        for word in words_of(text, self.language):
            at = self.said(word)
            if not at and word not in idle(self.language):
                return None
            tokens |= at
        return frozenset(tokens)

    def said(self, word: str) -> set[int]:
        """Where a word was said, in this form or another, or by another name."""
        found = {at for at, heard in self.heard.items() if alike({word}, heard)}
        if found:
            return found
        return {
            at
            for each in self.turn.mentions
            if word in words_of(each.value, self.language)
            for at in range(each.start, each.end)
        }

    # --- numbers

    def number(self, literal: Literal, value: float) -> Source | None:
        sort = _SORTS.get(literal.role) if literal.role in NUMBERS else None
        tokens = self.quantity(sort, abs(value))
        if tokens:
            return Source(literal, "number", tokens)
        match literal.role:
            case "seconds" | "numbers" if literal.method in _BY_NUMBERS:
                return Source(literal, "default") if value == 0 else None
            case "seconds" if value <= _LONGEST_PAUSE:
                return Source(literal, "default")
            case "degrees" if abs(value) in _DEGREES:
                return Source(literal, "default")
            case "metres" if abs(value) in (0.5, 1.0):
                return Source(literal, "default")
            case "percents":
                return Source(literal, "default")
            case "numbers" | "compared" | "free" if value in _SMALL or value == -1:
                return Source(literal, "default")
            case "compared" if not any(each.value for each in self.turn.tokens):
                return Source(literal, "default")  # "if your battery is low"
            case "counted" | "compared":
                return self.several(literal, value)
            case _:
                return None

    def quantity(self, sort: str | None, value: float) -> frozenset[int]:
        """The tokens of a quantity, in any unit if none is asked for."""
        text = written(value)
        units = {sort} if sort else {"number", "times", "percent", "metres", "degrees"}
        found = [each for each in self.turn.mentions if each.sort in units and each.value == text]
        if sort is None:
            found += [
                each
                for each in self.turn.mentions
                if each.sort == "seconds" and written(float(each.value) / 60) == text
            ]
        surest = min((each.cost for each in found), default=0.0)
        return _tokens_of(each for each in found if each.cost <= surest)

    def several(self, literal: Literal, value: float) -> Source | None:
        """Times that are as many as things or people are spoken of."""
        named = {
            each.value
            for each in self.turn.spoken_of
            if each.sort in ("person", "thing", "place") and each.value != ANYBODY
        }
        if any(each.sort == "times" and each.cost == 0.0 for each in self.turn.mentions):
            return None
        return Source(literal, "default") if value <= len(named) else None

    # --- words

    def compared(self, literal: Literal) -> Source | None:
        """What a value is compared with, or goes round: a name, a time, an answer."""
        if not literal.text or literal.text.lower() in self._options:
            return Source(literal, "answer", self.mentioned(literal))
        tokens = self.mentioned(literal) or self.time(literal.text) or self.of_a_kind(literal.text)
        if tokens:
            return Source(literal, "name", tokens)
        if literal.text.capitalize() in _DAYS:
            return Source(literal, "default")
        words = self.words(literal.text)
        return Source(literal, "words", words) if words is not None else None

    @cached_property
    def _options(self) -> frozenset[str]:
        offered = (each for each in literals(self.plan) if each.role == OPTIONS)
        return frozenset(each.text.lower() for each in offered) | self.settled

    @cached_property
    def settled(self) -> frozenset[str]:
        """Answers that are always possible: "yes", "no"."""
        data = self.language.speech.get("free_text", {})
        return frozenset(str(each).lower() for each in data.get("settled", ()))

    def time(self, text: str) -> frozenset[int]:
        """The tokens of a time of day, in either half of the day."""
        hour, colon, minute = text.partition(":")
        if not colon or not (hour.isdecimal() and minute.isdecimal()):
            return frozenset()
        other = f"{(int(hour) + 12) % 24:02d}:{minute}"
        return _tokens_of(
            each
            for each in self.turn.mentions
            if each.sort == "time" and each.value in (text, other)
        )

    def spoken(self, literal: Literal) -> Source | None:
        """What is said, asked or shown: in words that were said, and such as any robot says."""
        tokens: set[int] = set()
        own: list[str] = []
        for word in sorted(words_of(literal.text, self.language)):
            at = self.said(word) | self.figure(word)
            tokens |= at
            if not (at or self.is_common(word) or alike({word}, self.heard_before)):
                own.append(word)
        if self.in_another_language:
            own = []
        return Source(literal, "own" if own else "words", frozenset(tokens), tuple(own))

    def is_common(self, word: str) -> bool:
        """Whether a robot says such a word of itself: "could", "nobody", "yes"."""
        common = word in idle(self.language) or word in self.settled or len(word) < 2
        return common or word in self._reported or word in words_of_phrases(self.language)

    @cached_property
    def _reported(self) -> frozenset[str]:
        return frozenset(evidence_of(self.language).reported)

    def figure(self, word: str) -> set[int]:
        """The tokens of a number that is written in figures: "85" of "eighty-five"."""
        if not word.replace(".", "").replace(":", "").isdigit():
            return set()
        return {
            at
            for each in self.turn.mentions
            if each.value == word or (each.sort == "time" and word in each.value)
            for at in range(each.start, each.end)
        }


def sort_of(literal: Literal) -> str | None:
    """What sort of mention a literal is that nobody needs to say."""
    if literal.role == COUNTED:
        return "times"
    return _SORTS.get(literal.role) if literal.role in NUMBERS | _LEFT_TO_THE_ROBOT else None


def _tokens_of(found: Iterable[Mention]) -> frozenset[int]:
    return frozenset(at for each in found for at in range(each.start, each.end))


_DAYS: Final = frozenset(
    {"Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", "Sunday"}
)


def content_left(turn: Turn, used: frozenset[int]) -> Iterator[int]:
    """The places of words with a sense of their own that nothing has used."""
    return (at for at, _ in content(turn.tokens, turn.language) if at not in used)


__all__ = ["COUNTED", "Source", "Sources"]
