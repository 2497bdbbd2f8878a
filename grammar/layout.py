"""Python source laid out the way `ruff format` does: one line if it fits, else broken at the
outermost brackets.

Only what programs for a robot are made of: names, strings, calls, lists, comparisons. Strings that
are too long even for a line of their own are cut at spaces into several that Python joins again.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, assert_never

WIDTH: Final = 100
INDENT: Final = 4


@dataclass(frozen=True)
class Atom:
    """A piece of source that is never broken."""

    text: str


@dataclass(frozen=True)
class String:
    """A string of parts (text, False) and, for f-strings, (expression, True)."""

    parts: tuple[tuple[str, bool], ...]


@dataclass(frozen=True)
class Call:
    head: str
    arguments: tuple[Document, ...]


@dataclass(frozen=True)
class Brackets:
    """Items between brackets, separated by commas; `trailing_comma` when broken."""

    opening: str
    items: tuple[Document, ...]
    closing: str
    trailing_comma: bool = True


@dataclass(frozen=True)
class Prefix:
    """A document with something straight before or after it: `not `, `options=`, `.lower()`."""

    before: str
    inner: Document
    after: str = ""


@dataclass(frozen=True)
class Operators:
    """Operands with the same operator between them."""

    operator: str
    operands: tuple[Document, ...]


@dataclass(frozen=True)
class Compare:
    left: Document
    operator: str
    right: Document


Document = Atom | String | Call | Brackets | Prefix | Operators | Compare


def lay_out(head: str, document: Document, tail: str, depth: int) -> list[str]:
    """The lines of a statement `head document tail`, indented `depth` times."""
    indent = depth * INDENT
    line = head + flat(document) + tail
    lines = [line] if indent + len(line) <= WIDTH else _broken(head, document, tail, indent)
    return [" " * indent + line for line in lines]


def flat(document: Document) -> str:
    """The document on one line."""
    match document:
        case Atom():
            return document.text
        case String():
            return _string(document.parts)
        case Call():
            return f"{document.head}({', '.join(map(flat, document.arguments))})"
        case Brackets():
            return document.opening + ", ".join(map(flat, document.items)) + document.closing
        case Prefix():
            return document.before + flat(document.inner) + document.after
        case Operators():
            return f" {document.operator} ".join(map(flat, document.operands))
        case Compare():
            return f"{flat(document.left)} {document.operator} {flat(document.right)}"
        case _:
            assert_never(document)


def enclosed(document: Document) -> Document:
    """The document in brackets where it would fall apart next to something else, such as `.lower()`
    or an operator."""
    match document:
        case Operators() | Compare():
            pass
        case Prefix(before=before) if before:
            pass
        case Atom(text=text) if text[:1].isdigit() or text[:1] == "-":
            pass
        case _:
            return document
    return Brackets("(", (document,), ")", trailing_comma=False)


def quote(text: str) -> str:
    """The text as a string literal on one line, with whatever could do harm or hide escaped."""
    return _string(((text, False),))


# --- breaking ------------------------------------------------------------------------------------


def _broken(head: str, document: Document, tail: str, indent: int) -> list[str]:
    """The lines of a statement that is too long for one; relative to its indentation."""
    match document:
        case Atom():
            return [head + document.text + tail]
        case Call(arguments=()):
            return [head + flat(document) + tail]
        case Call():
            inner = _arguments(document.arguments, indent + INDENT)
            return [f"{head}{document.head}(", *_indented(inner), f"){tail}"]
        case Brackets(items=()):
            return [head + flat(document) + tail]
        case Brackets():
            inner = _items(document.items, indent + INDENT, document.trailing_comma)
            return [head + document.opening, *_indented(inner), document.closing + tail]
        case Prefix():
            return _broken(head + document.before, document.inner, document.after + tail, indent)
        case String() | Operators() | Compare():
            lines = _broken_at_brackets(head, document, tail, indent)
            if lines and all(indent + len(line) <= WIDTH for line in lines):
                return lines
            inner = _within(document, "", indent + INDENT)
            return [f"{head}(", *_indented(inner), f"){tail}"]
        case _:
            assert_never(document)


def _broken_at_brackets(head: str, document: Document, tail: str, indent: int) -> list[str] | None:
    """The lines if one operator's sides are broken at their brackets: the right one if what is
    before its bracket fits on the line, else the left one; None if there are no such brackets."""
    match document:
        case Operators(operator, (left, right)) | Compare(left, operator, right):
            start = f"{head}{flat(left)} {operator} "
            lines = _broken_at_brackets(start, right, tail, indent)
            if lines and indent + len(lines[0]) <= WIDTH:
                return lines
            if not isinstance(left, Call | Brackets) or "." in flat(left).partition("(")[0]:
                return lines
            first = _broken_at_brackets(head, left, "", indent)
            if first is None:
                return lines
            *first, last = first
            line = f"{last} {operator} {flat(right)}{tail}"
            if indent + len(line) <= WIDTH:
                return [*first, line]
            rest = _broken_at_brackets(f"{last} {operator} ", right, tail, indent)
            return [*first, *rest] if rest else None
        case Call(arguments=(_, *_)) | Brackets(items=(_, *_)):
            return _broken(head, document, tail, indent)
        case Prefix(after=""):
            return _broken_at_brackets(head + document.before, document.inner, tail, indent)
        case _:
            return None


def _arguments(arguments: Sequence[Document], indent: int) -> list[str]:
    """Arguments of a call: all on one line if they fit there, else a line or more for each."""
    line = ", ".join(map(flat, arguments))
    if indent + len(line) <= WIDTH:
        return [line]
    return _items(arguments, indent, trailing_comma=len(arguments) > 1)


def _items(items: Sequence[Document], indent: int, trailing_comma: bool) -> list[str]:
    lines: list[str] = []
    for item in items:
        lines += _within(item, "," if trailing_comma else "", indent)
    return lines


def _within(document: Document, tail: str, indent: int, before: int = 0) -> list[str]:
    """The lines of a document that stands between brackets, on lines of its own; `before` columns
    of the first are taken."""
    line = flat(document) + tail
    if indent + before + len(line) <= WIDTH:
        return [line]
    match document:
        case String():
            lines = list(_chunks(document, WIDTH - indent - len(tail), before))
        case Operators():
            lines = _within(document.operands[0], "", indent)
            for operand in document.operands[1:]:
                first, *rest = _within(operand, "", indent, len(document.operator) + 1)
                lines += [f"{document.operator} {first}", *rest]
        case Compare():
            lines = _within(document.left, "", indent)
            first, *rest = _within(document.right, "", indent, len(document.operator) + 1)
            if len(lines) > 1 and isinstance(document.left, String):
                lines[-1] += f" {document.operator} {first}"
            else:
                lines.append(f"{document.operator} {first}")
            lines += rest
        case Prefix(inner=String() as inner):
            width = WIDTH - indent - len(tail) - len(document.after)
            lines = list(_chunks(inner, width, before + len(document.before)))
            lines[0] = document.before + lines[0]
            lines[-1] += document.after
        case _:
            return _broken("", document, tail, indent)
    lines[-1] += tail
    return lines


def _indented(lines: Sequence[str]) -> list[str]:
    return [" " * INDENT + line for line in lines]


# --- strings -------------------------------------------------------------------------------------

_ESCAPES: Final = {"\\": "\\\\", "\n": "\\n", "\r": "\\r", "\t": "\\t"}


def _escaped(text: str, mark: str, braces: bool) -> str:
    """The text as it stands between quotation marks. What is not printable is written as a number,
    so that no text can end the string, change the reading direction or hide something."""
    pieces: list[str] = []
    for character in text:
        if character == mark:
            pieces.append("\\" + mark)
        elif character in _ESCAPES:
            pieces.append(_ESCAPES[character])
        elif braces and character in "{}":
            pieces.append(character * 2)
        elif character.isprintable():
            pieces.append(character)
        else:
            code = ord(character)
            if code < 0x100:
                pieces.append(f"\\x{code:02x}")
            elif code < 0x10000:
                pieces.append(f"\\u{code:04x}")
            else:
                pieces.append(f"\\U{code:08x}")
    return "".join(pieces)


def _string(parts: Sequence[tuple[str, bool]]) -> str:
    fixed = "".join(text for text, expression in parts if not expression)
    formatted = any(expression for _, expression in parts)
    mark = "'" if fixed.count('"') > fixed.count("'") else '"'
    other = '"' if mark == "'" else "'"
    inner = "".join(
        # Before Python 3.12 the marks around the whole cannot stand within its braces.
        "{" + text.replace(mark, other) + "}" if expression else _escaped(text, mark, formatted)
        for text, expression in parts
    )
    return f"{'f' if formatted else ''}{mark}{inner}{mark}"


def _chunks(string: String, width: int, before: int = 0) -> Iterator[str]:
    """String literals that together are the string, none wider than `width` if that can be;
    `before` columns of the first are taken."""
    line: list[tuple[str, bool]] = []
    for piece in _pieces(string, width - before):
        if line and before + len(_string([*line, piece])) > width:
            yield _string(line)
            line, before = [], 0
        line.append(piece)
    yield _string(line)


def _pieces(string: String, width: int) -> Iterator[tuple[str, bool]]:
    """The expressions, and the texts word by word (each with the space after it); words too long
    for a line in pieces."""
    longest = max(1, (width - 3) // 10)  # an escaped character can take ten columns
    for text, expression in string.parts:
        if expression:
            yield text, True
            continue
        for word in _words(text):
            if len(_string([(word, False)])) + 1 <= width:
                yield word, False
            else:
                for start in range(0, len(word), longest):
                    yield word[start : start + longest], False


def _words(text: str) -> Iterator[str]:
    start = 0
    for place, character in enumerate(text):
        if character == " " and text[place + 1 : place + 2] not in ("", " "):
            yield text[start : place + 1]
            start = place + 1
    yield text[start:]
