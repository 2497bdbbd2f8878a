"""Names in programs: what people call things, as Python identifiers."""

from __future__ import annotations

import builtins
import keyword
import re
import unicodedata
from typing import Final

_TAKEN: Final = frozenset(
    {
        *keyword.kwlist,
        *keyword.softkwlist,
        *dir(builtins),
        "robot",
        "random",
        "percent",
        "minutes_since",
        "weekday_called",
        "re",
        "math",
    }
)

LONGEST: Final = 30


def identifier(text: str) -> str:
    """The text as an identifier in plain letters: "Größe der Übung" becomes `grosse_der_ubung`."""
    plain = unicodedata.normalize("NFKD", text.replace("ß", "ss"))
    plain = plain.encode("ascii", "ignore").decode().lower()
    word = re.sub(r"[^a-z0-9]+", "_", plain)[:LONGEST].strip("_")
    if not word:
        return "value"
    if word[0].isdigit():
        word = f"value_{word}"
    return f"{word}_" if word in _TAKEN else word


class Identifiers:
    """Gives every name of a plan its own identifier, the same whenever it is asked for."""

    def __init__(self) -> None:
        self._given: dict[str, str] = {}
        self._used: set[str] = set()

    def of(self, name: str) -> str:
        if name not in self._given:
            self._given[name] = self.fresh(name)
        return self._given[name]

    def fresh(self, wish: str) -> str:
        """An identifier like the wish that nothing else has."""
        chosen = self.spare(wish)
        self._used.add(chosen)
        return chosen

    def spare(self, wish: str) -> str:
        """The same without taking it: for a variable whose life is one expression."""
        base = chosen = identifier(wish)
        number = 2
        while chosen in self._used:
            chosen = f"{base.rstrip('_')}_{number}"
            number += 1
        return chosen
