"""What makes a program look other than it is: signs that reorder or hide its text, names in letters
that only look like others, and robot calls where nobody looks for one.

Whoever approves a program approves what they see. So what can be seen must be what is run.
"""

from __future__ import annotations

import ast
import io
import tokenize
import unicodedata
from collections.abc import Callable, Iterator
from typing import Final

JOINERS: Final = "\N{ZERO WIDTH JOINER}\N{ZERO WIDTH NON-JOINER}\N{SOFT HYPHEN}"
"""Signs of no width that writing needs: within an emoji, a Persian word, a long German one."""
_HIDDEN: Final = frozenset({"Cf", "Cc"})
"""Categories of Unicode: signs that format, or control, what stands around them."""
_CODE: Final = "disguised"
_NOT_PYTHON: Final = (tokenize.TokenError, SyntaxError, UnicodeDecodeError)
"""What the tokeniser says of a text that is no program; the last since Python 3.14, of a carriage
return before a letter of more than one byte."""

Found = Iterator[tuple[int, int, str, str]]
"""Line and column, from 1; a code; a sentence."""


def hidden_signs(program: str) -> Found:
    """Signs that nobody sees, and that may show the text around them in another order."""
    for number, line in enumerate(program.split("\n"), 1):
        for column, sign in enumerate(line, 1):
            if sign == "\t" or sign in JOINERS or unicodedata.category(sign) not in _HIDDEN:
                continue
            name = unicodedata.name(sign, f"number {ord(sign)}").lower()
            message = f"Here stands a sign that cannot be seen ({name}). Take it out."
            yield number, column, _CODE, message


def strange_letters(program: str) -> Found:
    """Names in the letters of other alphabets: some look just like ours, and are none."""
    try:
        tokens = list(tokenize.generate_tokens(io.StringIO(program).readline))
    except _NOT_PYTHON:
        return  # in which case it is no program
    for token in tokens:
        if token.type != tokenize.NAME or token.string.isascii():
            continue
        strange = next((each for each in token.string if not _is_latin(each)), None)
        if strange is not None:
            line, column = token.start
            name = unicodedata.name(strange, f"number {ord(strange)}").lower()
            message = (
                f'The name "{token.string}" has a letter of another alphabet ({name}), which may'
                " look like one of ours. Type it anew."
            )
            yield line, column + 1, _CODE, message


def _is_latin(sign: str) -> bool:
    return (
        sign.isascii()
        or unicodedata.name(sign, "").startswith("LATIN ")
        or (unicodedata.combining(sign) > 0)
    )


def at_definition(node: ast.AST, calls: Callable[[ast.AST], bool]) -> Iterator[tuple[ast.AST, str]]:
    """Robot calls among the defaults of a function, and in what says of which type something is:
    they are made where it is defined, which reads as if nothing were done there."""
    if not isinstance(node, ast.FunctionDef | ast.Lambda):
        return
    given = node.args
    every = [*given.posonlyargs, *given.args, *given.kwonlyargs]
    every += [each for each in (given.vararg, given.kwarg) if each is not None]
    types = [each.annotation for each in every]
    types += [node.returns] if isinstance(node, ast.FunctionDef) else []
    for each in (*given.defaults, *given.kw_defaults, *types):
        if each is not None and calls(each):
            message = (
                "A robot call here would be made where the function is defined, not where it is"
                " called. Write it into the function."
            )
            yield each, message


def without_comments(program: str) -> str:
    """The program without its comments, all else in its place: some keep the type checker quiet,
    and nobody is to be told less for that."""
    try:
        tokens = list(tokenize.generate_tokens(io.StringIO(program).readline))
    except _NOT_PYTHON:
        return program
    lines = program.split("\n")
    for token in tokens:
        if token.type == tokenize.COMMENT:
            line, column = token.start
            kept = lines[line - 1]
            lines[line - 1] = kept[:column] + kept[column + len(token.string) :]
    return "\n".join(lines)
