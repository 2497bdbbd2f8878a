"""Whether an explanation says what a program does: each robot call must have its counterpart."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Final

from grammar.language import speech
from grammar.speech import Words

SPOKEN = {"say", "show"}
"""What they are given stands in the explanation word by word."""
STEM = 5
"""Letters of a noun that stay as they are in all its forms."""
PAUSE = "robot.wait(1)"
"""What keeps a loop from running hot is nothing that anybody asked for."""
_GAP = re.compile(r"\{\w+(?:!\w+)?\}|⟨\w+⟩ ?|\w*⟨[^⟩]*⟩\w*")
_LITTLE = re.compile(r"(?:^| )\w{1,2}$")
"""A word that may run together with what follows: "à le" is "au"."""
_INFLECTED = re.compile(r"⟨[^⟩]*⟩")


NOBODY: Final = {"de": "niemand"}
"""How "no person" is told: "wenn ich niemanden sehe"."""


def untold(
    program: str, explanation: str, language: str, called: Callable[[str], str] = str
) -> list[str]:
    """The robot calls of a program, and the texts in them, that its explanation leaves out;
    `called` as for `explain`."""
    own = [each for each in ast.parse(program).body if not isinstance(each, ast.FunctionDef)]
    calls = [
        node
        for step in own  # helpers are told by what they give
        for node in ast.walk(step)
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Attribute)
        and isinstance(node.func.value, ast.Name)
        and node.func.value.id == "robot"
    ]
    missing: list[str] = []
    counted = Counter(
        call.func.attr
        for call in calls
        if isinstance(call.func, ast.Attribute) and ast.unparse(call) != PAUSE
    )
    for method, times in counted.items():
        told = _times_told(method, explanation, language)
        if told < times:
            missing.append(f"robot.{method} ({told} of {times})")
    said = _plain(explanation)
    many = speech(language).nouns.many
    for call in calls:
        spoken = isinstance(call.func, ast.Attribute) and call.func.attr in SPOKEN
        for text in _texts(call):
            name = called(text)
            stems = {each[:STEM] for each in _plain(name).split() if len(each) >= STEM}
            tongue = speech(language).languages.get(text)  # "de" is told as "German"
            ways = (text,) if spoken else (text, name, many(name), *stems)
            ways = ways if tongue is None else (*ways, tongue)
            ways = (*ways, NOBODY[language]) if text == "person" and language in NOBODY else ways
            if not any(_plain(way) in said for way in ways):
                missing.append(text)
    return missing


def _times_told(method: str, explanation: str, language: str) -> int:
    words = speech(language).methods[method]
    spans: set[int] = set()
    for pattern in _patterns(words):
        pieces = [_LITTLE.sub("", _plain(piece)) for piece in _GAP.split(pattern)]
        skeleton = ".*?".join(_either(piece) for piece in pieces if piece)
        if skeleton:
            found = re.finditer(rf"\b(?={skeleton})", _plain(explanation))
            spans |= {each.start() for each in found}
    return len(spans)


def _either(piece: str) -> str:
    """A piece of a pattern, or one of the two prepositions that it leaves open: "sur ou dans"."""
    return re.sub(r"(\w+)\\ ou\\ (\w+)", r"(?:\1\\ ou\\ \2|\1|\2)", re.escape(piece))


def _patterns(words: Words) -> Iterator[str]:
    for group in (words.do, words.value, words.negative, words.holds, words.fails):
        yield from group
    for denied in (*words.negative, *words.fails):
        yield denied.replace(" pas ", " ")  # "je ne trouve personne"
    yield from words.fields.values()
    for operators in words.compared.values():
        yield from operators.values()


def _texts(call: ast.Call) -> Iterator[str]:
    """What is said, shown or asked, without what is put in when it runs."""
    for argument in [*call.args, *(each.value for each in call.keywords)]:
        match argument:
            case ast.Constant(value=str(text)):
                yield text
            case ast.JoinedStr(values=parts):
                yield from (str(part.value) for part in parts if isinstance(part, ast.Constant))


def _plain(text: str) -> str:
    """The text as it is compared: without capitals, marks and double spaces."""
    return " ".join(re.sub(r"[^\w\s]|_", " ", _INFLECTED.sub("", text).casefold()).split())
