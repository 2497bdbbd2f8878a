"""Python's and the type checker's messages as sentences that a nurse understands.

Each says what is wrong and then what to do. Patterns that match nothing leave the message as it
is, after a sentence that says where it comes from.
"""

from __future__ import annotations

import difflib
import re
from collections.abc import Callable, Iterable
from typing import Final

from robot_api.methods import METHODS

UNAVAILABLE: Final = (
    "The sandbox that programs run in does not start on this machine. Install nl2robot anew."
)

_KINDS: Final = {
    "str": "a text",
    "int": "a whole number",
    "float": "a number",
    "bool": "yes or no",
    "None": "nothing",
    "Location": "a location",
    "Clock": "the time",
    "SupportsIndex": "a whole number",
}


def problem(kind: str, message: str) -> str:
    """The sentences for an exception of a program: its class's name and its text."""
    for pattern, said in _RUN_TIME:
        match = re.fullmatch(pattern, f"{kind}: {message}", re.DOTALL)
        if match:
            return said(match) if callable(said) else said
    if not message or message == kind:
        return f"The program ended with {kind}. Look at this line again."
    return f"The program failed: {_sentence(message)}"


def type_problem(code: str, message: str) -> str:
    """The sentences for a finding of the type checker."""
    for pattern, said in _TYPES:
        match = re.fullmatch(pattern, message, re.DOTALL)
        if match:
            return said(match) if callable(said) else said
    return f"This does not fit together: {_sentence(_plain(message))}"


def _sentence(text: str) -> str:
    return text if text.endswith((".", "!", "?")) else f"{text}."


def near(name: str, known: Iterable[str], otherwise: str) -> str:
    """How a sentence about an unknown name goes on."""
    found = difflib.get_close_matches(name[:100], list(known), n=1)
    return f"Did you mean {found[0]}?" if found else otherwise


def _kind(annotation: str) -> str:
    """A type as words: `str | None` is "a text or nothing"."""
    words = []
    for each in annotation.split(" | "):
        literal = re.fullmatch(r"Literal\[(.*)\]", each, re.DOTALL)
        if literal:
            words.append(literal[1])
        elif each.startswith("list["):
            words.append("a list")
        elif each.startswith("bound method"):
            words.append("a method without its ()")
        elif each.startswith("<class "):
            words.append("a type")
        else:
            words.append(_KINDS.get(each, each))
    return " or ".join(words)


def _plain(message: str) -> str:
    return message.replace("`", "")


def _no_method(name: str) -> str:
    return f"The robot has no method {name}. {near(name, METHODS, 'See the list of its methods.')}"


def _undefined(match: re.Match[str]) -> str:
    name = match[1]
    if name in METHODS:
        return f"There is nothing called {name}. Did you mean robot.{name}(...)?"
    return f"There is nothing called {name}. Give it a value first, or correct its name."


def _no_attribute(match: re.Match[str]) -> str:
    kind, name = match[1], match[2]
    if kind == "Robot" and name in METHODS:
        return f"This robot cannot be told to {name} in this way. Leave it out, or write {name}()."
    if kind == "Robot":
        return _no_method(name)
    if kind.startswith("bound method"):
        return "Here a method lacks its (). Write the brackets after its name."
    return f"{_kind(kind).capitalize()} has no {name}. Correct the name after the dot."


def _missing(match: re.Match[str]) -> str:
    return f"robot.{match[2]} needs its {_plain(match[1])}. Write it between the brackets."


def _wrong_argument(match: re.Match[str]) -> str:
    wanted, given = _kind(match[2]), _kind(match[3])
    if match[3] == f"{match[2]} | None":
        return f"{match[1]} wants {wanted} here, and this may be nothing. Put str(...) around it."
    return f"{match[1]} wants {wanted} here, not {given}. Change what stands between the brackets."


def _unsupported(match: re.Match[str]) -> str:
    left, right = _kind(match[2]), _kind(match[3])
    return f"{match[1]} does not work between {left} and {right}. Convert one, as in int(...)."


Said = str | Callable[[re.Match[str]], str]

_RUN_TIME: Final[tuple[tuple[str, Said], ...]] = (
    (r"NameError: name '(\w+)' is not defined.*", _undefined),
    (r"UnboundLocalError: .*'(\w+)'.*", _undefined),
    (r"NameError: There is nothing called (\w+)\.", _undefined),
    (r"AttributeError: '(\w+)' object has no attribute '(\w+)'.*", _no_attribute),
    (
        r"ZeroDivisionError: .*",
        "The program divides by zero. Check the number before dividing by it.",
    ),
    (
        r"IndexError: .*",
        "The program takes an item that the list does not have. Check how long the list is first.",
    ),
    (
        r"KeyError: (.*)",
        lambda match: f"There is no entry for {match[1]}. Check with `in` before looking it up.",
    ),
    (
        r"ValueError: invalid literal for int\(\).*?: (.*)|"
        r"ValueError: could not convert string to float: (.*)",
        lambda match: (
            f"{match[1] or match[2]} is no number. Check what was said before counting with it."
        ),
    ),
    (
        r"RecursionError: .*",
        "The program's functions call each other without end. Let them come to an end.",
    ),
    (
        r"ModuleNotFoundError: No module named '(.*)'",
        lambda match: f"There is no module {match[1]} here. Only re, math and random can be used.",
    ),
    (
        r"NotImplementedError: method call '(\w+)' cannot suspend in this synchronous context",
        lambda match: (
            f"robot.{match[1]} cannot be called from within key=, map or filter. Use a loop."
        ),
    ),
    (r"CheckError: (.*)", lambda match: f"{match[1]}."),
    (
        r"\w+: The monty syntax parser does not yet support (.*)",
        lambda match: f"Programs for a robot cannot use {match[1]}. Write it in a simpler way.",
    ),
)

_CALLEE: Final = r"(?:bound method|function|constructor) `(?:Robot\.)?([\w.]+?)(?:\.__\w+__)?`"

_TYPES: Final[tuple[tuple[str, Said], ...]] = (
    (r"Name `(\w+)` used when not defined", _undefined),
    (r"Object of type `([^`]*)` has no attribute `(\w+)`", _no_attribute),
    (
        r"No arguments? provided for required parameters? (.+) of bound method `Robot\.(\w+)`",
        _missing,
    ),
    (
        rf"Argument to {_CALLEE} is incorrect: Expected `([^`]*)`, found `(.*)`",
        _wrong_argument,
    ),
    (
        r"Unary operator `?([-+~]|not)`? is not supported for object of type `?(.*?)`?",
        lambda match: f"{match[1]} does not work with {_kind(match[2])}. Put a number there.",
    ),
    (
        rf"Too many positional arguments to {_CALLEE}: .*",
        lambda match: f"{match[1]} was given too much. Take something out of the brackets.",
    ),
    (
        rf"Argument `(\w+)` does not match any known parameter of {_CALLEE}",
        lambda match: f"{match[2]} knows no {match[1]}. Leave it out, or correct its name.",
    ),
    (
        rf"No overload of {_CALLEE} matches arguments",
        lambda match: f"{match[1]} cannot be called in this way. See how it is used in its help.",
    ),
    (
        rf"Multiple values provided for parameter `(\w+)` of {_CALLEE}",
        lambda match: f"{match[2]} was given its {match[1]} twice. Leave one out.",
    ),
    (
        r"Operator `([^`]*)` is not supported between objects of type `(.*)` and `(.*)`",
        _unsupported,
    ),
    (
        r"Object of type `(.*)` is not assignable to `Robot`",
        "The name robot belongs to the robot. Choose another name.",
    ),
    (
        r"Object of type `(.*)` is not callable",
        lambda match: f"{_kind(match[1]).capitalize()} cannot be called. Take the () away.",
    ),
    (
        r"Object of type `(.*)` is not iterable",
        lambda match: f"A loop cannot go through {_kind(match[1])}. Give it a list.",
    ),
    (
        r"Cannot resolve imported module `(.*)`",
        lambda match: f"There is no module {match[1]} here. Only re, math and random can be used.",
    ),
)
