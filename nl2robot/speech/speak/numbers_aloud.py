"""Numbers in the words of a language, by the rules of Unicode's CLDR."""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping
from typing import Any, Final

LONGEST: Final = 15
"""Digits of a number that is said as one; of a longer one they are read one by one."""
_CODE: Final = 7
"""From so many digits in a row, without anything between them, it is a code and no amount."""


class Numbers:
    """Those of one language; `data` is its part of text_normalisation.yaml."""

    def __init__(self, language: str, data: Mapping[str, Any]) -> None:
        from unicode_rbnf import RbnfEngine

        self._engine: Any = RbnfEngine.for_language(language)
        self._data = data
        signs = re.escape(data["thousand_signs"])
        decimal = re.escape(data["decimal_signs"])
        self.pattern = rf"(?:\d{{1,3}}(?:[{signs}]\d{{3}})+(?!\d)|\d+)(?:[{decimal}]\d+)?"
        """A number as it is written, without its sign."""
        self._thousands = re.compile(rf"(?<=\d)[{signs}](?=\d{{3}}(?!\d))")
        self._parts = re.compile(rf"[{decimal}]")

    @functools.lru_cache(maxsize=1024)  # noqa: B019 - one of each language lives as long as all
    def cardinal(self, number: int, gender: str = "") -> str:
        """ "forty-two"; one of something in its gender: "eine"."""
        names = self._data["numbers"]
        return self._words(number, names.get(gender) or names[""])

    def ordinal(self, number: int, form: str = "") -> str:
        """ "forty-second"; the form is an ending or a gender."""
        names = self._data["ordinals"]
        return self._words(number, names.get(form) or names[""])

    def year(self, number: int) -> str:
        """ "twenty twenty-six", "neunzehnhundertvierundachtzig"."""
        if self._data.get("year_in_full") or not (1100 <= number < 2000 or number >= 2010):
            return self.cardinal(number)
        return self._words(number, "spellout-numbering-year")

    def digits(self, text: str) -> str:
        """One by one: "0 4 4" as "zero four four"."""
        names = self._data["digits"]
        return " ".join(names[int(sign)] for sign in text if sign.isdecimal())

    def value(self, written: str) -> float:
        """What is written."""
        whole, point, behind = self._split(written)
        return float(f"{whole}.{behind}" if point else whole)

    def said(self, written: str, gender: str = "") -> str:
        """A number as it is written: "1,500", "37.5", "007"."""
        whole, point, behind = self._split(written)
        is_code = not point and (whole[:1] == "0" or (whole == written and len(whole) >= _CODE))
        if len(whole) > 1 and (is_code or len(whole) > LONGEST):
            words = self.digits(whole)
        else:
            words = self.cardinal(int(whole), "" if point else gender)
        if not point:
            return words
        zeros = behind[: len(behind) - len(behind.lstrip("0"))]
        if self._data["digits_behind_point"] == "one by one" or len(behind) > LONGEST:
            rest = self.digits(behind)
        else:
            rest = " ".join(filter(None, (self.digits(zeros), self._rest(behind[len(zeros) :]))))
        return f"{words} {self._data['point']} {rest}"

    def _rest(self, digits: str) -> str:
        return self.cardinal(int(digits)) if digits else ""

    def _split(self, written: str) -> tuple[str, str, str]:
        """The digits before and behind the point, as plain digits."""
        plain = "".join(
            str(int(s)) if s.isdecimal() else s for s in self._thousands.sub("", written)
        )
        found = self._parts.search(plain)
        if found is None:
            return plain, "", ""
        return plain[: found.start()], found[0], plain[found.end() :]

    def _words(self, number: int, rules: str) -> str:
        words = str(self._engine.format_number(number, ruleset_names=[rules]).text)
        words = words.replace("\u00ad", "")
        for long, short in self._data.get("shorter", {}).items():
            if words.startswith(long):  # nobody says "one hundred" in German
                words = short + words[len(long) :]
        return words
