"""What is written, in the words in which it is spoken: the text normalisation of text to speech.

    as_spoken("Dr. Kim is in room 101 at 1:15.", "en")
    -> "Doctor Kim is in room one oh one at quarter past one."

Whatever the robot says goes through here before a voice has it, its own or the server's, so that
all voices say a time or a dose alike; page and log show what is written. The rules are those below,
the words are data (`text_normalisation.yaml`), numbers are CLDR's. Text without figures, signs and
abbreviations stays as it is, and what was made ready once is not changed by a second time.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable, Mapping
from typing import Any, Final

from grammar.language import speech
from nl2robot.paths import PACKAGED
from nl2robot.speech.speak.numbers_aloud import Numbers

DATA: Final = PACKAGED / "text_normalisation.yaml"
LONGEST_WORD: Final = 12
"""Letters of a word before a number that may say what the number is of."""
_MOST_ROUNDS: Final = 5
_LEAST_PHONE: Final = 7
"""Digits of a telephone number."""

Handler = Callable[[re.Match[str]], str | None]
"""The words for what matched, or None: it is something else."""

_SPACE: Final = r"[ \u00a0\u202f]?"
_NOT_IN_WORD: Final = r"(?<![\w.,@])"
_RANGE: Final = rf"{_SPACE}[-–—]{_SPACE}(?=\d)"
_EMAIL: Final = r"[\w.+-]*\w@[\w-]+(?:\.[\w-]+)*\.[A-Za-z]{2,}"
_URL: Final = (
    r"(?:https?://|www\.)[^\s<>\"'()]*[\w/]"
    r"|\b[a-z0-9-]+(?:\.[a-z0-9-]+)*\.(?:com|org|net|edu|gov|info|eu|ch|de|fr|at|uk)\b(?:/[\w./-]*\w)?"
)
_PHONE: Final = (
    r"(?<![\w.,-])(?:(?:\+|00)\d(?:[ ()/.-]{0,2}\d)+|0\d{1,4}(?:[ /.-]\d{2,4}){2,}"
    r"|0\d{1,4}[/-]\d{4,}|\(?\d{3}\)?[ -]\d{3}-\d{4}|\d{3}-\d{4})(?![\w-])"
)


@functools.cache
def _data() -> Mapping[str, Any]:
    import yaml

    read: dict[str, Any] = yaml.safe_load(DATA.read_text(encoding="utf-8"))
    return read


def as_spoken(text: str, language: str) -> str:
    """The text as a voice is to be given it; as it is in a language without rules."""
    if language not in _data():
        return text
    for _ in range(_MOST_ROUNDS):  # signs that stood beside a figure may stand beside a word now
        before, text = text, _normaliser(language).spoken(text)
        if text == before:
            break
    return text


@functools.cache
def _normaliser(language: str) -> _Normaliser:
    return _Normaliser(language, _data()[language])


class _Normaliser:
    """The rules of one language. At each place the first that fits is taken, so they stand in
    order: a date before a phone number before a number."""

    def __init__(self, language: str, data: Mapping[str, Any]) -> None:
        self.language = language
        self.data = data
        self.numbers = Numbers(language, data)
        number = self.numbers.pattern
        units = _any_of(data["units"])
        money = _any_of(data["money"])
        months = _any_of(data["months"])
        hours = _any_of(data["clock"]["hour_words"])
        signs = _any_of(data["number_signs"])
        days = _any_of(data["weekdays"])
        named = _any_of(data["before_name"])
        short = _any_of(data["abbreviations"])
        ordinal = data.get("ordinal_sign", r"(?!)")
        clock = r"(?P<hour>[01]?\d|2[0-4]):(?P<minute>[0-5]\d)(?::(?P<second>[0-5]\d))?(?!\d)"
        part = rf"(?:{_SPACE}(?P<part>[ap])\.?m\b\.?)"
        rules: list[tuple[str, Handler]] = [
            (_EMAIL, self._address),
            (_URL, self._address),
            (rf"{_NOT_IN_WORD}(?P<written>{_any_of(data['halves'])})(?![\w/])", self._half),
            (
                rf"{_NOT_IN_WORD}(?P<year>\d{{4}})-(?P<month>\d{{2}})-(?P<day>\d{{2}})(?![\w-])",
                self._date,
            ),
            (
                rf"{_NOT_IN_WORD}(?P<day>\d{{1,2}})\. ?(?P<month>\d{{1,2}})\."
                r"(?: ?(?P<year>\d{4}|\d{2})(?![\w:.,]\d|\w))?(?!\d)",
                self._date,
            ),
            (
                rf"{_NOT_IN_WORD}(?P<one>\d{{1,2}})/(?P<two>\d{{1,2}})(?:/(?P<year>\d{{4}}|\d\d))?"
                r"(?![\w/])",
                self._slashed_date,
            ),
            (
                rf"{_NOT_IN_WORD}(?P<day>\d{{1,2}})(?:\.|{ordinal})? (?P<name>{months})\b"
                r"(?:,? (?P<year>\d{4})\b)?",
                self._date,
            ),
            (
                rf"\b(?P<name>{months}) (?P<day>\d{{1,2}})(?:{ordinal})?\b(?![.,:]?\d|\.\d)"
                r"(?:,? (?P<year>\d{4})\b)?",
                self._date,
            ),
            (
                rf"{_NOT_IN_WORD}{clock}{part}?(?:{_SPACE}(?:{hours})\b)?(?P<to>{_RANGE})?",
                self._time,
            ),
            (rf"{_NOT_IN_WORD}(?P<hour>1?\d){part}(?P<to>{_RANGE})?", self._time),
            (_PHONE, self._phone),
            *self._hour_rules(hours),
            (rf"{_NOT_IN_WORD}\d+(?:\.\d+){{2,}}(?!\w)", self._version),
            (rf"(?<!\w)(?:{signs})(?:{_SPACE}(?=\d))", self._number_sign),
            (
                rf"\b(?P<first>(?i:{days}))\.?{_SPACE}[-–]{_SPACE}(?P<last>(?i:{days}))\b\.?",
                self._weekdays,
            ),
            (
                rf"{_NOT_IN_WORD}(?P<minus>[-−])?(?:{money}){_SPACE}(?P<number>{number})",
                self._money_first,
            ),
            (
                rf"(?P<minus>(?<![\w)])[-−])?(?<![\w.,])(?P<number>{number})(?:{_SPACE}|-)"
                rf"(?P<unit>{units})(?![\w²³])",
                self._measure,
            ),
            (rf"(?<![\w.,])(?P<number>\d+){ordinal}(?!\w)", self._ordinal),
            (r"(?<![\w.,])(?P<number>\d{1,3})\.(?= [^\W\d_])", self._dotted_ordinal),
            (rf"(?<![\w.,])(?P<number>{number}){_SPACE}[x×](?!\w)", self._times),
            (r"(?<=[^\W\d_])-(?=\d)", lambda match: " "),
            (rf"(?<![\w.,/])(?P<one>{number})/(?P<two>{number})(?![\w/])", self._fraction),
            (rf"(?<![\w.,])(?P<number>{number}){_RANGE}", self._range),
            (rf"(?P<minus>(?<![\w)])[-−])?(?P<number>{number})", self._plain),
            (rf"(?<!\w)(?:{named})(?= ?[^\W\d_a-zà-ÿ])", self._title),
            (rf"(?<!\w)(?:{short})(?!\w)", self._abbreviation),
            (rf"(?<=\w){_SPACE}/{_SPACE}(?=[-−]?\w)", self._slash),
            (rf"{_SPACE}[&+=×~≈]{_SPACE}", self._sign),
        ]
        self.rules = [(re.compile(pattern), handler) for pattern, handler in rules]
        anywhere = "|".join(f"(?:{re.sub(r'[(][?]P<[a-z]+>', '(?:', each)})" for each, _ in rules)
        self.anywhere = re.compile(anywhere)

    def spoken(self, text: str) -> str:
        told: list[str] = []
        at = 0
        while found := self.anywhere.search(text, at):
            start = found.start()
            told.append(text[at:start])
            matched = ((rule.match(text, start), handler) for rule, handler in self.rules)
            fitting = ((match, handler(match)) for match, handler in matched if match)
            match, words = next(
                ((m, words) for m, words in fitting if words is not None), (None, "")
            )
            if match is None:
                told.append(text[start : start + 1])
                at = start + 1
                continue
            at = match.end()
            before = text[start - 1 : start]
            told.append(" " if before and (before.isalnum() and words[:1].isalnum()) else "")
            told.append(words)
            if words.endswith(".") and text.startswith(".", at):
                at += 1  # "at 13:00." ends with "p.m.", and once
            told.append(" " if words[-1:].isalnum() and text[at : at + 1].isalnum() else "")
        return "".join((*told, text[at:]))

    # --- addresses --------------------------------------------------------------------------------

    def _address(self, match: re.Match[str]) -> str:
        """An e-mail address or a page: its signs by name, its figures one by one."""
        written = re.sub(r"^https?://", "", match[0])
        signs = {"@": "at", ".": "dot", "-": "dash", "_": "underscore", "/": "slash", "+": "plus"}
        told = []
        for part in re.findall(r"\d+|[^\W\d_]+|.", written):
            if part in signs:
                told.append(self.data[signs[part]])
            elif part.isdecimal():
                told.append(self.numbers.digits(part))
            elif part == "www" or (len(part) == 2 and written.endswith(f".{part}")):
                told.append(" ".join(part.upper()))
            elif part.isalnum():
                told.append(part)
        return " ".join(told)

    def _phone(self, match: re.Match[str]) -> str | None:
        """Its figures one by one, its groups with a breath between."""
        if sum(map(str.isdecimal, match[0])) < _LEAST_PHONE:
            return None
        plus = [self.data["plus"]] if match[0].startswith("+") else []
        groups = [self.numbers.digits(group) for group in re.findall(r"\d+", match[0])]
        return " ".join((*plus, ", ".join(groups)))

    # --- dates and times --------------------------------------------------------------------------

    def _date(self, match: re.Match[str]) -> str | None:
        parts = match.groupdict()
        name = parts.get("name")
        month = self.data["months"].index(name) + 1 if name else int(parts["month"])
        first = name is None or match[0].startswith(name)
        return self._day(match, int(parts["day"]), month, parts.get("year"), month_first=first)

    def _slashed_date(self, match: re.Match[str]) -> str | None:
        """A date if it can be one in the order of the language, or in the other only: "5/6" is none
        without a year."""
        one, two = int(match["one"]), int(match["two"])
        month, day = (one, two) if self.data.get("month_first") else (two, one)
        if month > 12:
            month, day = day, month
        if not match["year"] and max(one, two) <= 12:
            return None
        return self._day(match, day, month, match["year"], month_first=True)

    def _day(
        self, match: re.Match[str], day: int, month: int, year: str | None, *, month_first: bool
    ) -> str | None:
        if not (1 <= month <= 12 and 1 <= day <= 31):
            return None
        before = match.string[: match.start()]
        data = self.data
        if data.get("first_day_only") and day > 1:
            said = self.numbers.cardinal(day)
        else:
            said = self.numbers.ordinal(day, self._ending(before, "r"))
        template = data["date"]
        if not month_first and "date_day_first" in data:
            template = data["date_day_first"]
            if before.lower().endswith(f"{data['the']} "):
                template = template.removeprefix(f"{data['the']} ")
        told = str(template).format(day=said, month=data["months"][month - 1])
        if year:
            full = int(year) if len(year) == 4 else 2000 + int(year)
            told += str(data["year"]).format(year=self.numbers.year(full))
        return told + self._end_of_sentence(match)

    def _ending(self, before: str, bare: str) -> str:
        """The ending that the word before it gives a German ordinal; `bare` without one."""
        if "ordinal_after" not in self.data:
            return ""
        words = before.lower().split()
        last = words[-1] if words and not before[-1:].isalnum() else ""
        behind_preposition = len(words) > 1 and words[-2] in self.data["ordinal_after_der"]
        if last == "der" and behind_preposition:
            return "n"
        found = [form for form, after in self.data["ordinal_after"].items() if last in after]
        return found[0] if found else bare

    def _time(self, match: re.Match[str]) -> str:
        parts = match.groupdict()
        hour, minute = int(parts["hour"]), int(parts.get("minute") or 0)
        told = self._clock(hour, minute, parts.get("part"))
        if parts.get("second"):
            seconds = self.numbers.cardinal(int(parts["second"]), "f")
            told = str(self.data["clock"]["seconds"]).format(time=told, seconds=seconds)
        if parts.get("to"):
            return f"{told} {self.data['to']} "
        ends = match[0].rstrip().endswith(".") and not told.endswith(".")
        return told + (self._end_of_sentence(match) if ends else "")

    def _clock(self, hour: int, minute: int, part: str | None) -> str:
        clock = self.data["clock"]
        special = clock["at_hours"].get(f"{hour}:{minute:02}")
        if special and not part:
            return str(special)
        on_the_clock = self.data["clock"].get("twelve_hours", False)
        gender = clock.get("hour_gender", "")
        if on_the_clock:
            if part is None and (hour >= 13 or hour == 0):
                part = "p" if hour >= 12 and hour < 24 else "a"
            shown, following = (hour - 1) % 12 + 1, hour % 12 + 1
        else:
            shown, following = hour, hour + 1
        words = str(clock["at_hours"].get(str(hour)) or self.numbers.cardinal(shown, gender))
        minutes = self.numbers.cardinal(minute, clock.get("minute_gender", ""))
        if part is not None and on_the_clock:
            few = clock["few"] if 0 < minute < 10 else clock["minutes"]
            told = few.format(hour=words, minutes=minutes) if minute else words
            return f"{told} {clock['am' if part == 'a' else 'pm']}"
        name = "full" if minute == 0 else "minutes"
        name = {15: "quarter", 30: "half", 45: "three_quarters"}.get(minute, name)
        if name not in clock:
            name = "minutes"
        if name == "minutes" and minute < 10 and "few" in clock:
            name = "few"
        if hour == 1 and f"{name}_one" in clock:
            name = f"{name}_one"
        if str(hour) in clock["at_hours"]:  # "midi", "midi trente"
            return f"{words} {minutes}" if minute else words
        return str(clock[name]).format(
            hour=words, minutes=minutes, next=self.numbers.cardinal(following, gender)
        )

    def _hour_rules(self, hours: str) -> list[tuple[str, Handler]]:
        """ "14 Uhr", "14.30 Uhr", "14h30", "de 9 h à 17 h": where hours have a word."""
        if not self.data["clock"]["hour_words"]:
            return []
        hour = r"(?P<hour>[01]?\d|2[0-4])"
        rules: list[tuple[str, Handler]] = [
            (
                rf"{_NOT_IN_WORD}{hour}[.](?P<minute>[0-5]\d){_SPACE}(?:{hours})\b",
                self._time,
            )
        ]
        if "h" in self.data["clock"]["hour_words"]:
            minute = r"(?P<minute>[0-5]\d)"
            rules.append(
                (
                    rf"{_NOT_IN_WORD}{hour}{_SPACE}h{_SPACE}{minute}(?!\d)(?P<to>{_RANGE})?",
                    self._time,
                )
            )
        rules.append((rf"{_NOT_IN_WORD}{hour}{_SPACE}(?:{hours})\b(?P<to>{_RANGE})?", self._time))
        return rules

    def _weekdays(self, match: re.Match[str]) -> str:
        days = {short.lower(): day for short, day in self.data["weekdays"].items()}
        first, last = days[match["first"].lower()], days[match["last"].lower()]
        return f"{first} {self.data['to']} {last}{self._end_of_sentence(match)}"

    # --- amounts ----------------------------------------------------------------------------------

    def _measure(self, match: re.Match[str]) -> str | None:
        unit = match["unit"]
        if unit in self.data["money"]:
            return self._signed(match, self._money(match["number"], unit))
        one, many, *gender = self.data["units"][unit]
        value = self.numbers.value(match["number"])
        words = self.numbers.said(match["number"], *gender)
        told = f"{words} {self._counted(one, many, value)}"
        return self._signed(match, told) + (self._end_of_sentence(match))

    def _counted(self, one: str, many: str, value: float) -> str:
        below = self.data.get("singular_below")
        singular = value == 1 if below is None else abs(value) < below
        return one if singular else many

    def _money_first(self, match: re.Match[str]) -> str:
        unit = next(each for each in self.data["money"] if each in match[0])
        return self._signed(match, self._money(match["number"], unit))

    def _money(self, number: str, unit: str) -> str:
        one, many, *gender = self.data["units"][unit]
        cents = re.search(rf"[{re.escape(self.data['decimal_signs'])}](\d\d)$", number)
        whole = number[: cents.start()] if cents else number
        name = self._counted(one, many, self.numbers.value(whole))
        told = f"{self.numbers.said(whole, *gender)} {name}"
        if cents and int(cents[1]):
            return f"{told} {self.numbers.cardinal(int(cents[1]))}"
        return told

    def _signed(self, match: re.Match[str], told: str) -> str:
        return f"{self.data['minus']} {told}" if match["minus"] else told

    def _range(self, match: re.Match[str]) -> str:
        return f"{self.numbers.said(match['number'])} {self.data['to']} "

    def _times(self, match: re.Match[str]) -> str:
        return f"{self.numbers.said(match['number'])} {self.data['times']}"

    def _fraction(self, match: re.Match[str]) -> str:
        one, two = self.numbers.said(match["one"]), self.numbers.said(match["two"])
        return f"{one} {self.data['over']} {two}"

    def _half(self, match: re.Match[str]) -> str:
        return str(self.data["halves"][match["written"]])

    def _version(self, match: re.Match[str]) -> str | None:
        if re.fullmatch(self.numbers.pattern, match[0]):  # "1.500.000"
            return None
        parts = [self.numbers.said(part) for part in match[0].split(".")]
        return f" {self.data['dot']} ".join(parts)

    def _number_sign(self, match: re.Match[str]) -> str:
        word = str(self.data["number"])
        return f"{word[:1].upper()}{word[1:]} " if match[0][0].isupper() else f"{word} "

    def _ordinal(self, match: re.Match[str]) -> str:
        sign = match[0][len(match["number"]) :]
        form = "f" if sign in self.data.get("feminine_ordinal_signs", ()) else ""
        told = self.numbers.ordinal(int(match["number"]), form)
        return f"{told}s" if "feminine_ordinal_signs" in self.data and sign[-1:] == "s" else told

    def _dotted_ordinal(self, match: re.Match[str]) -> str | None:
        """ "im 3. Stock": where a word beside it asks for one; else a sentence ends."""
        if "ordinal_after" not in self.data:
            return None
        before, behind = match.string[: match.start()], match.string[match.end() :].split()
        noun = behind[0].strip(".,;:!?") if behind else ""
        bare = self.data["ordinal_nouns"].get(noun)
        ending = self._ending(before, bare if bare is not None else "?")
        return None if ending == "?" else self.numbers.ordinal(int(match["number"]), ending)

    def _plain(self, match: re.Match[str]) -> str:
        written = match["number"]
        before = match.string[: match.start()].rstrip(" .:")
        word = re.search(rf"[^\W\d_]{{1,{LONGEST_WORD}}}$", before)
        label = word[0] if word else ""
        if label in self.data["by_digit"] or label.lower() in self.data["by_digit"]:
            return self._signed(match, self.numbers.digits(written))
        if label.lower() in self.data["read_out"] and re.fullmatch(r"[1-9]\d{2,3}", written):
            return self._read_out(written)
        if re.fullmatch(r"(?:19|20)\d\d", written) and not match["minus"]:
            return self.numbers.year(int(written))
        return self._signed(match, self.numbers.said(written, self._gender(match)))

    def _gender(self, match: re.Match[str]) -> str:
        """That of the word behind a number that ends in one: "eine Tasse", "vingt-et-une"."""
        if "noun" not in self.data or not re.search(r"(?:^|[02-9])1$", match["number"]):
            return ""
        behind = re.match(rf" ({self.data['noun']}[^\W\d_]*)", match.string[match.end() :])
        if behind is None:
            return ""
        noun = behind[1]
        known = {one: gender for one, _, *gender in self.data["units"].values()}
        for each in (noun, noun.removesuffix("s")):
            if each in known:
                return str(*known[each])
            if self._is_feminine(each):
                return "f"
        return "m"

    def _is_feminine(self, noun: str) -> bool:
        """As the grammar's nouns have it, else by how the word ends."""
        article = speech(self.language).nouns.indefinite(noun).partition(" ")[0]
        if article in ("eine", "une"):
            return True
        return re.search(self.data["feminine"], noun) is not None

    def _read_out(self, written: str) -> str:
        """The number of a room, as people say it: "one oh one", "twelve fourteen"."""
        first, last = written[:-2], written[-2:]
        if last == "00":
            return self.numbers.said(written)
        told = self.numbers.cardinal(int(first))
        behind = self.numbers.cardinal(int(last))
        return f"{told} oh {behind}" if last[0] == "0" else f"{told} {behind}"

    # --- words and signs --------------------------------------------------------------------------

    def _title(self, match: re.Match[str]) -> str:
        return f"{self.data['before_name'][match[0]]}{self._blank(match)}"

    def _abbreviation(self, match: re.Match[str]) -> str | None:
        words = str(self.data["abbreviations"][match[0]])
        return f"{words}{self._end_of_sentence(match)}{self._blank(match)}"

    def _blank(self, match: re.Match[str]) -> str:
        return " " if match.string[match.end() : match.end() + 1].isalnum() else ""

    def _end_of_sentence(self, match: re.Match[str]) -> str:
        """The full stop that an abbreviation at the end of a sentence stands for, too."""
        behind = match.string[match.end() :].lstrip(" ")
        may_end = match[0] in self.data["ends_sentences"]
        ends = not behind or behind[0] in '\n"”»“' or (may_end and behind[0].isupper())
        return "." if ends and match[0].endswith(".") else ""

    def _slash(self, match: re.Match[str]) -> str:
        word = str(self.data["or"])
        around = (
            match.string[: match.start()].split()[-1:] + match.string[match.end() :].split()[:1]
        )
        return " " if word in (each.lower() for each in around) else f" {word} "

    def _sign(self, match: re.Match[str]) -> str | None:
        sign = match[0].strip()
        before = match.string[: match.start()].rstrip()[-1:]
        behind = match.string[match.end() :].lstrip()[:1]
        names = {"&": "and", "+": "plus", "=": "equals", "×": "times", "~": "about", "≈": "about"}
        if sign in "+=×&" and not (before.isalnum() and behind.isalnum()):
            return (
                None if sign != "+" or not behind.isdecimal() else f" {self.data['plus']} ".lstrip()
            )
        if sign in "~≈" and not behind.isdecimal():
            return None
        return f"{' ' if before else ''}{self.data[names[sign]]} "


def _any_of(words: Mapping[str, Any] | list[str]) -> str:
    """Any of these, the longest first; nothing at all where there are none."""
    return "|".join(re.escape(word) for word in sorted(words, key=len, reverse=True)) or r"(?!)"
