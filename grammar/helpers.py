"""Small functions that stand at the top of the programs that need them.

They are written in plain Python, so that a program can be read to its end without knowing anything
but the robot.
"""

from __future__ import annotations

import ast
import functools
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Final

from grammar.language import languages, speech
from grammar.layout import Prefix, String, lay_out
from grammar.speech import NumberWords


@dataclass(frozen=True)
class Helper:
    lines: tuple[str, ...]
    needs: tuple[str, ...] = ()
    """The helpers and modules that it uses itself."""


_WORDS: Final = "    ..."
"""Stands for the language's part: the names of its numbers, and how to look at a text."""

_HELPERS: Final = {
    "percent": Helper(
        (
            "def percent(part, whole):",
            "    return round(100 * part / whole) if whole else 0",
        )
    ),
    "number_in": Helper(
        (
            "def number_in(text, otherwise=0):",
            _WORDS,
            "    values = {",
            "        name: at if at < 20 else 10 * at - 180",
            "        for at, alike in enumerate(names)",
            '        for name in alike.split("/")',
            "    }",
            "    found = -1",
            r'    for word in re.findall(r"[0-9]+(?:[.,][0-9]+)?|[^\W\d_]+", said):',
            "        if word[0].isdigit():",
            '            number = float(word.replace(",", "."))',
            "        else:",
            "            number = values.get(word, -1)",
            "        if found < 0:",
            "            found = number",
            "        elif word not in values or max(found, number) % "
            "(20 if min(found, number) > 9 else 10):",
            "            break",
            "        else:",
            "            found += number",
            "    if found < 0:",
            "        return otherwise",
            "    return int(found) if found == int(found) else found",
        ),
        needs=("re",),
    ),
    "numbers_in": Helper(
        (
            "def numbers_in(answers):",
            "    numbers = [number_in(answer, None) for answer in answers]",
            "    return [number for number in numbers if number is not None]",
        ),
        needs=("number_in",),
    ),
    "sum_of": Helper(
        (
            "def sum_of(answers):",
            "    return sum(numbers_in(answers))",
        ),
        needs=("numbers_in",),
    ),
    "average_of": Helper(
        (
            "def average_of(answers):",
            "    numbers = numbers_in(answers)",
            "    return round(sum(numbers) / len(numbers), 1) if numbers else 0",
        ),
        needs=("numbers_in",),
    ),
    "highest_of": Helper(
        (
            "def highest_of(answers):",
            "    return max(numbers_in(answers), default=0)",
        ),
        needs=("numbers_in",),
    ),
    "lowest_of": Helper(
        (
            "def lowest_of(answers):",
            "    return min(numbers_in(answers), default=0)",
        ),
        needs=("numbers_in",),
    ),
    "key_of_max": Helper(
        (
            "def key_of_max(record):",
            "    highest = max(record.values(), default=0)",
            "    keys = [key for key, value in record.items() if value == highest]",
            '    return keys[0] if keys else ""',
        )
    ),
    "key_of_min": Helper(
        (
            "def key_of_min(record):",
            "    lowest = min(record.values(), default=0)",
            "    keys = [key for key, value in record.items() if value == lowest]",
            '    return keys[0] if keys else ""',
        )
    ),
    "minutes_since": Helper(
        (
            "def minutes_since(begin):",
            "    times = (begin, robot.clock().time)",
            "    then, now = [60 * int(time[:2]) + int(time[3:]) for time in times]",
            "    return (now - then) % (24 * 60)",
        )
    ),
    "has_come": Helper(
        (
            "def has_come(time, since):",
            "    now = robot.clock()",
            "    if now.date == since.date:",
            "        return since.time < time <= now.time",
            "    return since.time < time or now.time >= time",
        )
    ),
    "weekday_called": Helper(
        (
            "def weekday_called(names):",
            '    days = ["Monday", "Tuesday", "Wednesday", "Thursday", "Friday", "Saturday", '
            '"Sunday"]',
            "    return names[days.index(robot.clock().weekday)]",
        )
    ),
}

HELPERS: Final = frozenset(_HELPERS)
"""Their names."""


def needed(used: Iterable[str]) -> tuple[set[str], list[str]]:
    """The modules and the helpers that what is used needs in all, helpers in the order in which
    one may need another."""
    all_of_it: set[str] = set()
    left = list(used)
    while left:
        name = left.pop()
        all_of_it.add(name)
        left += _HELPERS[name].needs if name in _HELPERS else ()
    return all_of_it - HELPERS, [name for name in _HELPERS if name in all_of_it]


def source(name: str, language: str) -> list[str]:
    """The lines of a helper, as written for plans in this language. Raises `LookupError` if there
    are no words for it."""
    lines: list[str] = []
    for line in _HELPERS[name].lines:
        lines += _words(speech(language).numbers) if line == _WORDS else [line]
    return lines


def _words(numbers: NumberWords) -> list[str]:
    names = String(((" ".join(numbers.names), False),))
    lines = lay_out("names = ", Prefix("", names, ".split()"), "", depth=1)
    lines.append("    said = str(text).lower()")
    return lines + [f'    said = said.replace("{old}", "{new}")' for old, new in numbers.rewritten]


def is_helper(function: ast.FunctionDef) -> bool:
    """Whether it is one of these functions, in the words of any language."""
    return ast.unparse(function) in _written()


@functools.cache
def _written() -> frozenset[str]:
    return frozenset(
        ast.unparse(ast.parse("\n".join(source(name, language))))
        for name in HELPERS
        for language in languages()
    )
