"""A sentence as a row of tokens: lower case, contractions opened, numbers and times recognised.

Every token keeps where it stood, so that free text ("say ...") is taken from the original, in its
own spelling. Names of the world and words of the rules go through the same function, so that both
sides always agree: "Alice's office" is `alice 's office`, "room twelve" is `room 12`.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Final

COMMA: Final = ","
STOP: Final = "."
COLON: Final = ":"


@dataclass(frozen=True, slots=True)
class Token:
    norm: str
    """What rules match: the word in lower case, digits for a number word, "," "." ":" for
    punctuation."""
    start: int
    end: int
    kind: str = "word"
    """word, verb (`grammar.slips`), number, time, quote, url, selector, mark (punctuation),
    symbol (anything else)."""
    value: float | None = None
    """Of a number."""
    inner: str = ""
    """Of a quote: what stands between the quotation marks."""
    spelled: str = ""
    """The word in lower case as it was written, where `norm` leaves out its accents."""
    capital: bool = False
    """Whether it was written with a capital letter."""


@dataclass(frozen=True)
class Spelling:
    """What a language says about single words; data of its `language.yaml`."""

    contractions: Mapping[str, str] = field(default_factory=dict)
    """"what's" -> "what is"; words without an apostrophe too ("dont")."""
    endings: Mapping[str, str] = field(default_factory=dict)
    """"'ll" -> "will", for any word not among the contractions."""
    abbreviations: frozenset[str] = frozenset()
    """"dr", "mrs": a full stop after them ends nothing."""
    numbers: Mapping[str, float] = field(default_factory=dict)
    """"twelve" -> 12: number words that are one word."""
    symbols: Mapping[str, str] = field(default_factory=dict)
    """"&" -> "and", "%" -> "percent"."""
    letters: Mapping[str, str] = field(default_factory=dict)
    """"ö" -> "oe": letters that are written in two ways."""
    hours: frozenset[str] = frozenset()
    """"uhr": after it "10.30" is a time of day."""
    accents_optional: bool = False
    """Whether "repete" is read as "répète": words match without their accents."""


_PATTERN = re.compile(
    r"""
      (?P<space>[\s_*]+ | (?<=\w)[-‐‑](?=[^\W\d_]))
    | (?P<url>(?:https?://|www\.)[^\s,;"'<>]*[^\s,;"'<>.?!]
        | (?<![\w.@])(?:[a-zA-Z0-9][a-zA-Z0-9-]*\.)+
          (?:org|com|net|edu|gov|info|io|eu|ch|de|fr|example)
          (?:/[^\s,;"'<>]*[^\s,;"'<>.?!]|(?![\w.-])))
    | (?P<quote>"[^"]*" | “[^”“]*[”“"] | „[^“”"]*[“”"] | «[^»]*»
        | (?<!\w)['‘][^'‘’]*(?:\w['’]\w[^'‘’]*)*['’](?!\w))
    | (?P<selector>(?<!\S)[\#.][A-Za-z][\w-]*)
    | (?P<time>\d{1,2}:\d{2}(?!\d))
    | (?P<number>(?:(?<![\w.)])[-−])?(?:\d{1,3}(?:,\d{3})+(?!\d)|\d+(?:[.,]\d+)?))
    | (?P<word>[^\W\d_]+(?:['’`][^\W\d_]+|(?<=\w\w\w),(?:s|t|ll|re|ve)\b)*['’]?)
    | (?P<pause>\.\.+|…|(?<!\w)\(|(?<=\s)\)|\)(?=\s)|(?<=\s)[-–—]+(?=\s)|—|–)
    | (?P<mark>[.,;:!?]+)
    | (?P<symbol>.)
    """,
    re.VERBOSE,
)


def tokenise(text: str, spelling: Spelling) -> tuple[Token, ...]:
    """The tokens of a text."""
    tokens = _tokens(text, spelling)
    while tokens and tokens[0].kind == "mark":
        tokens.pop(0)
    return tuple(tokens)


def words_of(text: str, spelling: Spelling) -> tuple[str, ...]:
    """The normal forms of a name or of the words of a rule."""
    if text.isalpha() and text.islower() and text not in spelling.contractions:
        return (_word(text, 0, len(text), spelling).norm,)
    return tuple(token.norm for token in _tokens(text, spelling))


def words_of_template(text: str, spelling: Spelling) -> tuple[str, ...]:
    """The normal forms of a word of a template, in which "'s" may stand alone."""
    return (text,) if text in spelling.endings.values() else words_of(text, spelling)


def plain(text: str) -> str:
    """Lower case, with composed characters and straight apostrophes."""
    return unicodedata.normalize("NFC", text).lower().replace("’", "'").replace("`", "'")


def without_quotations(text: str) -> str:
    """The words of whoever speaks, without those that they only quote."""
    return "".join(
        " " if match.lastgroup == "quote" else match.group() for match in _PATTERN.finditer(text)
    )


def without_accents(word: str) -> str:
    """ "élève" -> "eleve", "cœur" -> "coeur"."""
    apart = unicodedata.normalize("NFD", word.replace("œ", "oe").replace("æ", "ae"))
    return "".join(letter for letter in apart if not unicodedata.combining(letter))


def _tokens(text: str, spelling: Spelling) -> list[Token]:
    tokens: list[Token] = []
    for match in _PATTERN.finditer(text):
        kind, raw, start, end = match.lastgroup, match.group(), match.start(), match.end()
        if kind == "space":
            continue
        if kind == "word":
            if tokens and plain(raw) in spelling.hours:
                tokens[-1] = _as_time(text, tokens[-1])
            _add_word(tokens, raw, start, spelling)
        elif kind == "number":
            tokens.append(_number(raw, start, end))
        elif kind == "mark":
            if raw[0] == STOP and tokens and tokens[-1].norm in spelling.abbreviations:
                continue
            _add_mark(tokens, _mark(raw), start, end)
        elif kind == "pause":
            _add_mark(tokens, COMMA, start, end)
        elif kind == "quote":
            inner = raw[1:-1].strip()
            tokens.append(Token('"', start, end, "quote", inner=inner))
        elif kind == "symbol":
            word = spelling.symbols.get(raw)
            tokens.append(Token(word or raw, start, end, "word" if word else "symbol"))
        else:
            tokens.append(Token(raw.lower(), start, end, kind or "symbol"))
    return tokens


def _add_word(tokens: list[Token], raw: str, start: int, spelling: Spelling) -> None:
    word = plain(raw).replace(",", "'")  # "what,s": the key beside it
    if word.endswith("'"):  # "the nurses' room": the apostrophe says nothing here
        word, raw = word[:-1], raw[:-1]
    opened = spelling.contractions.get(word)
    end = start + len(raw)
    if opened is not None:
        tokens.extend(_word(part, start, end, spelling) for part in opened.split())
        return
    if "'" in word:
        for ending, meaning in spelling.endings.items():
            if word.endswith(ending) and len(word) > len(ending):
                cut = end - len(ending)
                _add_word(tokens, raw[: -len(ending)], start, spelling)
                tokens.extend(Token(part, cut, end) for part in meaning.split())
                return
        cut = word.index("'") + 1
        if word[cut:] in spelling.contractions:  # "qu'aujourd'hui"
            tokens.append(_word(word[: cut - 1], start, start + cut - 1, spelling))
            _add_word(tokens, raw[cut:], start + cut, spelling)
            return
        for piece in re.finditer(r"[^'’`]+", raw):
            tokens.append(
                _word(plain(piece.group()), start + piece.start(), start + piece.end(), spelling)
            )
        return
    tokens.append(_word(word, start, end, spelling, raw[:1].isupper()))


def _word(word: str, start: int, end: int, spelling: Spelling, capital: bool = False) -> Token:
    value = spelling.numbers.get(word)
    if value is None and not word.isascii():
        norm = word
        for letter, letters in spelling.letters.items():
            norm = norm.replace(letter, letters)
        if spelling.accents_optional:
            norm = without_accents(norm)
        return Token(norm, start, end, spelled=word, capital=capital)
    if value is None:
        return Token(word, start, end, capital=capital)
    return Token(f"{value:g}", start, end, value=value)


def _as_time(text: str, token: Token) -> Token:
    """ "10.30" and "8.05", where what follows says that it is a time."""
    written = re.fullmatch(r"(\d{1,2})\.(\d{2})", text[token.start : token.end])
    if written is None:
        return token
    return Token(f"{written[1]}:{written[2]}", token.start, token.end, "time")


def _number(raw: str, start: int, end: int) -> Token:
    digits = raw.replace("−", "-")
    digits = digits.replace(",", "") if re.search(r",\d{3}$", digits) else digits.replace(",", ".")
    return Token(digits, start, end, "number", value=float(digits))


def _mark(raw: str) -> str:
    """Full stops, semicolons, question and exclamation marks all end something."""
    if any(character in ".;!?" for character in raw):
        return STOP
    return COLON if COLON in raw else COMMA


def _add_mark(tokens: list[Token], norm: str, start: int, end: int) -> None:
    """Of marks side by side, the strongest counts."""
    if tokens and tokens[-1].kind == "mark":
        if norm == STOP and tokens[-1].norm != STOP:
            tokens[-1] = Token(norm, tokens[-1].start, end, "mark")
        return
    tokens.append(Token(norm, start, end, "mark"))
