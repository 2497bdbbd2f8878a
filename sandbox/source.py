"""A program's text, made ready for Monty without moving anything to another line."""

from __future__ import annotations

import ast
import io
import re
import tokenize
import warnings
from collections.abc import Iterator
from itertools import accumulate
from typing import Final

WRAPPERS: Final = {"location": "_robot_location", "clock": "_robot_clock"}
"""Methods whose results are made anew inside the sandbox, each with the function that does it."""

_STRING: Final = re.compile(r"'[^']*'|\"[^\"]*\"")


def unix_newlines(program: str) -> str:
    """The program with every end of a line as Python reads it; a lone carriage return is one."""
    return program.replace("\r\n", "\n").replace("\r", "\n")


def with_values(program: str) -> str:
    """The program with `robot.location()` as `_robot_location(robot.location())`."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)
        wrapped = _wrapped(program, _calls(program, within_strings=True))
        # Where an f-string ends its expressions is guesswork before Python 3.12.
        if wrapped == program or _same(program, wrapped):
            return wrapped
        return _wrapped(program, _calls(program, within_strings=False))


def _wrapped(program: str, calls: Iterator[tuple[int, int, str]]) -> str:
    parts, done = [], 0
    for start, end, method in calls:
        parts += [program[done:start], f"{WRAPPERS[method]}({program[start:end]})"]
        done = end
    return "".join([*parts, program[done:]])


def _calls(text: str, *, within_strings: bool) -> Iterator[tuple[int, int, str]]:
    """Start, end and method of each call in a program or an expression, in their order."""
    line_starts = [0, *accumulate(map(len, io.StringIO(text)))]

    def place(spot: tuple[int, int]) -> int:
        return line_starts[spot[0] - 1] + spot[1]

    tokens = _tokens(text)
    words = [token.string for token in tokens]
    for index, token in enumerate(tokens):
        if token.string == "robot" and words[index - 1 : index] != ["."]:
            match words[index : index + 5]:
                case [_, ".", ("location" | "clock") as method, "(", ")"]:
                    yield place(token.start), place(tokens[index + 4].end), method
        elif token.type == tokenize.STRING and within_strings:
            for offset, expression in _expressions(token.string):
                shift = place(token.start) + offset
                for start, end, inner in _calls(expression, within_strings=True):
                    yield shift + start, shift + end, inner


def _tokens(text: str) -> list[tokenize.TokenInfo]:
    """Without comments and ends of lines; those before the first mistake, if there is one."""
    found = []
    try:
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            if token.type not in (tokenize.COMMENT, tokenize.NL):
                found.append(token)
    except (tokenize.TokenError, SyntaxError, UnicodeDecodeError):
        pass  # the expression of an f-string, with what stands behind its colon
    return found


def _expressions(string: str) -> Iterator[tuple[int, str]]:
    """What stands between the braces of an f-string that is one token, each with where it begins:
    nothing for other strings."""
    prefix = string.partition(string[-1])[0]
    if "f" not in prefix.lower():
        return
    at, depth, start = len(prefix), 0, 0
    while at < len(string):
        if depth == 0 and string[at : at + 2] in ("{{", "}}"):
            at += 1
        elif string[at] == "{":
            depth += 1
            start = at + 1 if depth == 1 else start
        elif string[at] == "}" and depth > 0:
            depth -= 1
            if depth == 0:
                yield start, string[start:at]
        elif depth > 0 and (inner := _STRING.match(string, at)):
            at = inner.end() - 1
        at += 1


class _Unwrap(ast.NodeTransformer):
    """Takes the wrappers off again."""

    def visit_Call(self, node: ast.Call) -> ast.AST:
        if isinstance(node.func, ast.Name) and node.func.id in WRAPPERS.values():
            return self.visit(node.args[0]) if len(node.args) == 1 else node
        self.generic_visit(node)
        return node


def _same(program: str, wrapped: str) -> bool:
    return _shape(ast.parse(program)) == _shape(_Unwrap().visit(ast.parse(wrapped)))


def _shape(tree: ast.AST) -> str:
    return ast.dump(tree, annotate_fields=False)
