"""The template language that the rules of a language are written in.

It is the syntax of Home Assistant's sentence templates, so that a person who has written one can
write the other:

    drive [over] to {place}        a word, words that may be left out, a slot
    (bring|fetch) <thing> [to me]  one of several, another rule
    meter[s], want(s|ed)           endings: no space before the bracket
    {number:metres} <place:to>     a slot or rule whose value goes by another name

`parse_template` turns one into `Sequence`, `Choice`, `Word` and `Part`; `grammar.network` makes a
network of all of them.
"""

from __future__ import annotations

import functools
import itertools
import re
from dataclasses import dataclass


class TemplateError(ValueError):
    """A template that cannot be read; the message says where."""


@dataclass(frozen=True)
class Word:
    text: str


@dataclass(frozen=True)
class Part:
    """A reference: `<rule>` to another rule, `{slot}` to something matched by code or a list."""

    name: str
    binding: str | None
    is_rule: bool


@dataclass(frozen=True)
class Sequence:
    parts: tuple[Template, ...]


@dataclass(frozen=True)
class Choice:
    """One of the alternatives; an empty `Sequence` among them means it may be left out."""

    alternatives: tuple[Template, ...]


Template = Word | Part | Sequence | Choice

NOTHING = Sequence(())

_LEXEME = re.compile(r"\s+|[()\[\]|]|<[^<>]+>|\{[^{}]+\}|[^\s()\[\]|<>{}]+")


@functools.cache
def parse_template(source: str) -> Template:
    """The template of such a text. Raises `TemplateError`."""
    lexemes = _LEXEME.findall(source)
    if "".join(lexemes) != source:
        raise TemplateError(f"cannot read the template {source!r}")
    result, rest = _alternatives(lexemes, 0, source)
    if rest != len(lexemes):
        raise TemplateError(f"an unexpected {lexemes[rest]!r} in the template {source!r}")
    return result


def _alternatives(lexemes: list[str], at: int, source: str) -> tuple[Template, int]:
    alternatives: list[Template] = []
    while True:
        sequence, at = _sequence(lexemes, at, source)
        alternatives.append(sequence)
        if at < len(lexemes) and lexemes[at] == "|":
            at += 1
            continue
        return (alternatives[0] if len(alternatives) == 1 else Choice(tuple(alternatives))), at


def _sequence(lexemes: list[str], at: int, source: str) -> tuple[Template, int]:
    parts: list[Template] = []
    glued: list[Template] = []  # what stands together without a space

    def close() -> None:
        if glued:
            parts.append(glued[0] if len(glued) == 1 else _glue(glued, source))
            glued.clear()

    while at < len(lexemes):
        lexeme = lexemes[at]
        if lexeme in ("|", ")", "]"):
            break
        if lexeme.isspace():
            close()
            at += 1
        elif lexeme in ("(", "["):
            inner, at = _alternatives(lexemes, at + 1, source)
            closing = ")" if lexeme == "(" else "]"
            if at >= len(lexemes) or lexemes[at] != closing:
                raise TemplateError(f"a {lexeme!r} that is not closed in the template {source!r}")
            at += 1
            glued.append(inner if lexeme == "(" else Choice((NOTHING, inner)))
        elif lexeme[0] in "<{":
            name, _, binding = lexeme[1:-1].partition(":")
            glued.append(Part(name.strip(), binding.strip() or None, lexeme[0] == "<"))
            at += 1
        else:
            glued.append(Word(lexeme))
            at += 1
    close()
    return (parts[0] if len(parts) == 1 else Sequence(tuple(parts))), at


def _glue(pieces: list[Template], source: str) -> Template:
    """`want[s]` -> want | wants. Only words may be glued; groups that stand side by side without
    a space, such as `(a|b)[c]`, are glued too."""
    spellings = [_spellings(piece, source) for piece in pieces]
    return Choice(tuple(Word("".join(parts)) for parts in itertools.product(*spellings)))


def _spellings(piece: Template, source: str) -> list[str]:
    match piece:
        case Word(text):
            return [text]
        case Sequence(()):
            return [""]
        case Choice(alternatives):
            return [text for each in alternatives for text in _spellings(each, source)]
        case _:
            raise TemplateError(f"only endings can follow without a space in {source!r}")
