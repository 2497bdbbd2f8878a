"""Values and conditions of the dialect, read letter by letter, as far as they are written."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import cached_property
from typing import Final

from grammar.planning.model.letters import LONGEST_TEXT, Dead, Letters, Unfinished, is_plain
from grammar.planning.model.types import (
    NOTHING,
    NUMBER,
    PERSON,
    PLACE,
    TEXT,
    TRUTH,
    Kind,
    Type,
    result_of,
)
from grammar.planning.model.vocabulary import Vocabulary, form
from grammar.roles import CHOICE, FREE, NUMBERS, OPTIONS, role
from robot_api.methods import METHODS, Parameter

LONGEST_OPTION: Final = 60
DAYS: Final = ("Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", "Sunday")
NOT_OFFERED: Final = frozenset({"stop", "log"})
"""Methods that no model is asked for."""
CALLS: Final = tuple(name for name in METHODS if name not in NOT_OFFERED)
TELLING: Final = tuple(name for name in CALLS if result_of(name) != NOTHING)
"""Those of the others that tell something."""
SEEING: Final = frozenset({"sees", "count", "find", "describe", "wait_for"})
"""Methods whose thing may be a person."""
FUNCTIONS: Final = (
    *("len", "sum", "max", "min", "round", "sorted"),
    *("number_in", "percent", "minutes_since", "random_choice", "weekday"),
)
KEYWORDS: Final = frozenset({*keyword.kwlist, "robot", "random", "range", "weekday_called"})
"""Names that are no names, or that a program needs for something else."""
INNERMOST: Final = 8
"""How many brackets may stand in one another."""
_DIGITS: Final = re.compile(r"-?[0-9.]*")
_WORDS: Final = re.compile(r"\w+")
_PARTS: Final = re.compile(r"[^\0 ]+")
_ORDERS: Final = (" <= ", " >= ", " < ", " > ")
_EQUAL: Final = (" == ", " != ")
_WITHIN: Final = (" not in ", " in ")


def _compared_with(left: Type) -> tuple[str, ...]:
    """How a value can be compared."""
    if left.kind is Kind.NUMBER:
        return *_ORDERS, *_EQUAL
    if left.is_text:
        return *_ORDERS, *_EQUAL, *_WITHIN
    return _EQUAL if left.kind in (Kind.LOCATION, Kind.TRUTH) else ()


def fixed(text: str) -> Type:
    """The type of a text that the program says; of none, anything may become."""
    return replace(TEXT, written=frozenset({text} - {""}))


def _is_of(text: str, known: Iterable[str]) -> bool:
    """Whether a text consists of words of those that are known, the last of which may only be
    begun; "\\0" stands for any."""
    words = [word.lower() for each in known for word in _WORDS.findall(each)]
    *whole, last = [word.lower() for word in _PARTS.findall(text)] or [""]
    if not text.endswith(last):
        whole, last = [*whole, last], ""
    return all(word in words for word in whole) and any(word.startswith(last) for word in words)


def _added_to(left: Type) -> tuple[str, ...]:
    """What can be done to a value, but for products."""
    if left.kind is Kind.NUMBER:
        return " + ", " - "
    return (" + ",) if left.is_text or left.kind is Kind.LIST else ()


class Reader(Letters):
    """Reads a line from a place on, where some names are known."""

    def __init__(self, line: str, at: int, names: dict[str, Type], words: Vocabulary) -> None:
        super().__init__(line, at)
        self.names = names
        self.words = words
        self.used: set[str] = set()
        """Names whose values were used."""
        self.deep = 0
        """In how many brackets this stands."""

    @cached_property
    def numbers(self) -> tuple[str, ...]:
        """Those that may stand where nothing says what is counted."""
        words = self.words
        return (*words.numbers, *words.minutes, *words.percents, "1", "-1", "2", "60", "100")

    @contextmanager
    def bracket(self) -> Iterator[None]:
        """While this lasts, what is read stands in one more."""
        if self.deep >= INNERMOST:
            raise Dead
        self.deep += 1
        try:
            yield
        finally:
            self.deep -= 1

    # --- conditions

    def condition(self) -> None:
        self.conjunction()
        while self.maybe(" or "):
            self.conjunction()

    def conjunction(self) -> None:
        self.negation()
        while self.maybe(" and "):
            self.negation()

    def negation(self) -> None:
        if self.starts("not "):
            self.at += len("not ")
            if self.starts("not "):
                raise Dead
            self.negation()
        elif self.next() == "(":
            self.at += 1
            with self.bracket():
                self.condition()
            self.expect(")")
        else:
            self.comparison()

    def comparison(self) -> Type:
        """A value, alone or compared with another; alone it must be able to be true or not."""
        left = self.value()
        operator = self.maybe(*_compared_with(left))
        if not operator:
            if left.kind in (Kind.PLACE, Kind.PERSON, Kind.LOCATION, Kind.NOTHING):
                raise Dead
            return left
        if operator in _WITHIN:
            self.container(left)
        else:
            self.compared(left, ordered=operator in _ORDERS)
        return TRUTH

    def container(self, left: Type) -> None:
        if not left.is_text:
            raise Dead
        if self.next() == "[":
            self.listed(left)
            return
        right = self.value()
        if right.kind not in (Kind.LIST, Kind.RECORD) and not right.is_text:
            raise Dead

    def compared(self, left: Type, *, ordered: bool) -> None:
        if left.kind is Kind.NUMBER:
            if self.value().kind is not Kind.NUMBER:
                raise Dead
        elif left.is_text or left.kind is Kind.LOCATION:
            if self.next() in "\"'":
                self.expected(left)
            elif not (self.value().is_text or left.kind is Kind.LOCATION) or (
                ordered and not left.options
            ):
                raise Dead
        elif left.kind is Kind.TRUTH and not ordered:
            self.choose(("True", "False"))
        else:
            raise Dead

    def expected(self, left: Type) -> None:
        """A fixed text that a value is compared with: one that it can be."""
        if left.options:
            self.literal(left.options)
        elif left.kind in (Kind.PLACE, Kind.LOCATION):
            self.literal(self.words.places)
        elif left.kind is Kind.PERSON:
            self.literal(self.words.people)
        else:
            self.text(LONGEST_OPTION)

    # --- values

    def value(self) -> Type:
        left = self.product()
        while operator := self.maybe(*_added_to(left)):
            right = self.product()
            left = self.combined(left, operator, right)
        return left

    def product(self) -> Type:
        left = self.atom()
        while left.kind is Kind.NUMBER and (operator := self.maybe(" * ", " / ", " // ", " % ")):
            left = self.combined(left, operator, self.atom())
        return left

    def combined(self, left: Type, operator: str, right: Type) -> Type:
        if left.kind is right.kind is Kind.NUMBER:
            return NUMBER
        if operator == " + " and left.is_text and right.is_text:
            return replace(TEXT, made=True)
        if operator == " + " and left.kind is right.kind is Kind.LIST:
            return left.joined(right) or NOTHING
        raise Dead

    def atom(self) -> Type:
        letter = self.next()
        if letter == self.quote:
            return fixed(self.text())
        if letter == "[":
            return self.listed()
        if letter == "{":
            self.expect("{}")
            return Type(Kind.RECORD)
        if letter == "(":
            self.at += 1
            with self.bracket():
                inner = self.value()
            self.expect(")")
            return inner
        if letter.isdigit() or letter == "-":
            self.number(self.numbers)
            return NUMBER
        if self.quote == '"' and self.starts('f"'):
            self.filled_text()
            return replace(TEXT, made=True)
        return self.named()

    def number(
        self, known: Sequence[str], low: float | None = None, high: float | None = None
    ) -> None:
        match = _DIGITS.match(self.line, self.at)
        written = match.group() if match else ""
        if self.at + len(written) == len(self.line):
            if not any(each.startswith(written) for each in known):
                raise Dead
            raise Unfinished
        if written not in known:
            raise Dead
        value = float(written)
        if (low is not None and value < low) or (high is not None and value > high):
            raise Dead
        self.at += len(written)

    def filled_text(self, known: Iterable[str] | None = None) -> None:
        """A text with values in braces; between them only words of those that are `known`, if that
        is said, and at least one value."""
        self.expect('f"')
        start, filled, said = self.at, False, ""
        while (letter := self.next()) != '"':
            if letter == "}" or not is_plain(letter) or self.at - start >= LONGEST_TEXT:
                raise Dead
            self.at += 1
            if letter == "{":
                self.filling()
                filled = True
            said += "\0" if letter == "{" else letter
            if known is not None and not _is_of(said, known):
                raise Dead
        if known is not None and not (filled and _is_of(f"{said} ", known)):
            raise Dead
        self.at += 1

    def filling(self) -> None:
        """A value in braces, behind the first of them."""
        if self.next() == "{":
            raise Dead  # two are one that is spoken
        self.quote = "'"
        with self.bracket():
            if self.value().kind is Kind.NOTHING:
                raise Dead
        self.quote = '"'
        self.expect("}")

    def named(self) -> Type:
        """What begins with a name: a value that is known, or a call."""
        word = self.word((*self.names, *TELLING, *FUNCTIONS, "True", "False"))
        if word in ("True", "False"):
            return TRUTH
        if word in self.names and not self.is_called(word):
            self.used.add(word)
            return self.part(self.names[word])
        if word in FUNCTIONS:
            return self.function(word)
        if word == "clock":
            return self.clock()
        found = self.call(word)
        return self.part(found)

    def is_called(self, word: str) -> bool:
        """Whether a bracket follows: a name may be that of a method, which never stands without."""
        return word in CALLS and self.next() == "("

    def part(self, of: Type) -> Type:
        """What is taken of a value: an entry, its letters in lower case."""
        while True:
            if of.kind in (Kind.LIST, Kind.RECORD) and self.maybe("["):
                of = self.entry(of)
            elif of.is_text and self.maybe(".lower()"):
                of = replace(of, written=frozenset(map(str.lower, of.written)))
            elif of.kind is Kind.RECORD and self.maybe(".values()"):
                of = Type(Kind.LIST, of=of.of)
            elif of.kind is Kind.LIST and self.maybe(".count("):
                self.expected(of.of or TEXT)
                self.expect(")")
                of = NUMBER
            else:
                return of

    def entry(self, of: Type) -> Type:
        if of.kind is Kind.RECORD:
            if not self.value().is_text:
                raise Dead
        else:
            self.choose(("0", "-1"))
        self.expect("]")
        return of.of or TEXT

    def clock(self) -> Type:
        self.expect("()")
        field = self.choose((".time", ".weekday", ".date"))
        if field == ".time":
            return Type(Kind.TEXT, self.words.times or ("00:00",))
        return Type(Kind.TEXT, DAYS) if field == ".weekday" else TEXT

    def function(self, name: str) -> Type:
        self.expect("(")
        if name == "weekday":
            self.expect(")")
            return Type(Kind.TEXT, DAYS)
        with self.bracket():
            given = self.value()
        match name:
            case "len" if given.kind in (Kind.LIST, Kind.RECORD):
                found = NUMBER
            case "number_in" if given.is_text:
                found = NUMBER
            case "sum" if given.kind is Kind.LIST and given.of == NUMBER:
                found = NUMBER
            case "round" if given.kind is Kind.NUMBER:
                found = NUMBER
            case "minutes_since" if given.is_text:
                found = NUMBER
            case "random_choice" if given.kind is Kind.LIST:
                found = given.of or TEXT
            case "percent" if given.kind is Kind.NUMBER:
                self.another_number()
                found = NUMBER
            case "sorted" if given.kind is Kind.LIST:
                found = given
            case "max" | "min" if given.kind is Kind.RECORD:
                found = self.best(given)
            case "max" | "min" if given.kind is Kind.LIST and given.of in (None, NUMBER):
                found = NUMBER
            case "max" | "min" if given.kind is Kind.NUMBER:
                self.another_number()
                found = NUMBER
            case _:
                raise Dead
        self.expect(")")
        return found

    def another_number(self) -> None:
        self.expect(", ")
        if self.value().kind is not Kind.NUMBER:
            raise Dead

    def best(self, record: Type) -> Type:
        """Which key of a record has the highest value: `max(votes, key=votes.get)`."""
        before = self.line[: self.at]
        name = before[before.rindex("(") + 1 :]
        if name not in self.names:
            raise Dead
        self.expect(f", key={name}.get")
        return record.keys or TEXT

    # --- lists

    def listed(self, of: Type | None = None) -> Type:
        """A list of texts or numbers; of what can be compared with a value, if one is given."""
        self.expect("[")
        if self.maybe("]"):
            return Type(Kind.LIST)
        items: list[str] = []
        others: Type | None = None
        while True:
            if self.next() == self.quote:
                start = self.at
                if of is not None:
                    self.expected(of)
                else:
                    self.literal(self.items())
                items.append(self.line[start + 1 : self.at - 1])
            else:
                others = self.together(others, self.item())
            if self.choose((", ", "]")) == "]":
                break
        if items:
            others = self.together(others, self.sort_of(items))
        return Type(Kind.LIST, of=others)

    def item(self) -> Type:
        """What stands in a list and is no fixed text."""
        if self.next().isdigit():
            self.number(self.numbers)
            return NUMBER
        found = self.named()
        if found.kind in (Kind.NOTHING, Kind.LIST, Kind.RECORD, Kind.TRUTH):
            raise Dead
        return found

    def together(self, known: Type | None, new: Type) -> Type:
        """What stands together in a list."""
        joined = new if known is None else known.joined(new)
        if joined is None:
            raise Dead
        return joined

    def items(self) -> tuple[str, ...]:
        words = self.words
        known = (*words.places, *words.people, *words.things, *words.kinds, *words.phrases)
        return tuple(dict.fromkeys(known))

    def sort_of(self, items: Sequence[str]) -> Type:
        kind = Kind.TEXT
        if items and all(each in self.words.places for each in items):
            kind = Kind.PLACE
        elif items and all(each in self.words.people for each in items):
            kind = Kind.PERSON
        return Type(kind, tuple(items), written=frozenset(items))

    def options(self) -> Type:
        """The answers that a question offers, or the list that holds them."""
        if self.next() != "[":
            known = self.value()
            if known.kind is not Kind.LIST:
                raise Dead
            return known.of or TEXT
        self.at += 1
        offered: list[str] = []
        while True:
            offered.append(self.text(LONGEST_OPTION))
            if not offered[-1].strip() or offered.count(offered[-1]) > 1:
                raise Dead
            if self.choose((", ", "]")) == "]":
                break
        if len(offered) < 2:
            raise Dead  # no choice
        return self.sort_of(offered)

    # --- calls

    def call(self, method: str) -> Type:
        """The brackets behind a robot method's name; gives what it returns."""
        parameters = form(method)
        self.expect("(")
        if method == "goto" and (self.next().isdigit() or self.next() == "-"):
            return self.point()
        given: set[str] = set()
        result = result_of(method)
        by_name = False
        while True:
            left = [each for each in parameters if each.name not in given]
            needed = [each for each in left if each.required]
            if not needed and self.next() == ")":
                break
            if not left:
                raise Dead
            parameter = self.named_parameter(left)
            by_name = by_name or parameter is not None
            if parameter is None:
                if by_name:
                    raise Dead
                parameter = left[0]
            given.add(parameter.name)
            type_ = self.argument(method, parameter)
            if parameter.name == "options":
                result = type_
            left = [each for each in parameters if each.name not in given]
            ends = (")",) * (not any(each.required for each in left)) + (", ",) * bool(left)
            if self.choose(ends) == ")":
                return result
        self.expect(")")
        return result

    def named_parameter(self, left: Sequence[Parameter]) -> Parameter | None:
        """The parameter that is given by its name here, if one is."""
        for parameter in left:
            lead = f"{parameter.name}="
            if self.rest.startswith(lead) and not self.rest.startswith(f"{lead}="):
                self.at += len(lead)
                return parameter
            if self.rest and lead.startswith(self.rest):
                raise Unfinished
        return None

    def point(self) -> Type:
        self.number(self.numbers)
        self.expect(", ")
        self.number(self.numbers)
        if self.maybe(", "):
            self.number(self.numbers)
        self.expect(")")
        return NOTHING

    def argument(self, method: str, parameter: Parameter) -> Type:
        what = role(METHODS[method], parameter)
        if what == OPTIONS:
            return self.options()
        if what == FREE:
            given = self.value()
            if given.kind is Kind.NOTHING:
                raise Dead
            return given
        known: tuple[str, ...] = (
            parameter.kind.choices if what == CHOICE else getattr(self.words, what)
        )
        if what in NUMBERS:
            return self.numeric(parameter, known)
        if method in SEEING:
            known = (*known, *self.words.people)
        if what in ("things", "people"):
            known = (*known, *self.words.things, *self.words.phrases)
        if not (known or self.names or what in ("places", "people", "things")):
            raise Dead  # nothing that could be found out has such a name
        if self.next() == self.quote:
            if not known:
                raise Dead
            self.literal(known)
            return TEXT
        if what == "things" and self.quote == '"' and self.starts('f"'):
            self.filled_text((self.words.said, *known))
            return TEXT
        if not self.next().isalpha():  # no number, and no list, ever becomes a name
            raise Dead
        given = self.value()
        fits = given.is_text or (what == "places" and given.kind is Kind.LOCATION)
        fits = fits and given.named(known)
        strange = {"places": PERSON.kind, "people": PLACE.kind}.get(what)
        if not fits or given.kind is strange:
            raise Dead
        return given

    def numeric(self, parameter: Parameter, known: Sequence[str]) -> Type:
        schema = parameter.kind.schema
        schema = next(iter(schema.get("anyOf", ())), schema)
        if self.next().isdigit() or self.next() == "-":
            start = self.at
            self.number(known, schema.get("minimum"), schema.get("maximum"))
            if self.rest[:1] in (")", ","):
                return NUMBER
            self.at = start
        if self.value().kind is not Kind.NUMBER:
            raise Dead
        return NUMBER
