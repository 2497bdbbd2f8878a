"""What the parameters of robot methods take: a place, a person, a length of time, words that are
said.

Derived from the method table by the names of its parameters; whoever has to know which literals
may stand where asks here.
"""

from __future__ import annotations

from typing import Final

from robot_api.methods import Method, Parameter

CHOICE: Final = "choice"
"""One of the few names that the table lists for it."""
FREE: Final = "free"
"""A text that people hear or read."""
OPTIONS: Final = "options"
"""The answers that a question offers."""
ANYBODY: Final = "person"
"""Whom programs call anybody."""
SORTS: Final = {
    "places": "place",
    "kinds": "kind",
    "people": "person",
    "things": "thing",
    "furniture": "furniture",
    "contacts": "contact",
    "gestures": "gesture",
    "emotions": "emotion",
    "joints": "joint",
    "skills": "skill",
    "languages": "language",
    "times": "time",
    "urls": "url",
    "selectors": "selector",
}
"""What names of a sort are called where they are mentioned (`grammar.planning.mentions`)."""
QUANTITIES: Final = {
    "seconds": "seconds",
    "metres": "metres",
    "degrees": "degrees",
    "percents": "percent",
}
"""The same for numbers with a unit."""
NUMBERS: Final = frozenset({"numbers", "seconds", "metres", "degrees", "percents"})

_ROLES: Final = {
    "place": "places",
    "to": "places",
    "kind": "kinds",
    "person": "people",
    "thing": "things",
    "where": "furniture",
    "contact": "contacts",
    "skill": "skills",
    "language": "languages",
    "code": "languages",
    "url": "urls",
    "selector": "selectors",
    "options": OPTIONS,
    "seconds": "seconds",
    "timeout": "seconds",
    "metres": "metres",
    "degrees": "degrees",
    "percent": "percents",
}
_NAMES: Final = {"emotion": "emotions", "gesture": "gestures", "joint": "joints"}
"""What `name` is of each method that has one."""


def role(method: Method, parameter: Parameter) -> str:
    """What a parameter takes: a sort of names, a sort of numbers, `CHOICE`, `FREE`, `OPTIONS`."""
    if parameter.kind.choices:
        return CHOICE
    known = _NAMES.get(method.name) if parameter.name == "name" else _ROLES.get(parameter.name)
    if known is not None:
        return known
    return FREE if "str" in parameter.kind.annotation else "numbers"
