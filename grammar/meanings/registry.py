"""Where meanings are entered by the names that rules call them by.

The discourse finds them here without knowing any of the modules that enter them, and has made by
them whatever the rules name in a sentence. They are all here once
`grammar.meanings.all_meanings` is imported.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

from grammar.chart import Node

if TYPE_CHECKING:
    from grammar.discourse import Discourse

Meaning = Callable[["Discourse", Node], Any]

MEANINGS: dict[str, Meaning] = {}

_Function = TypeVar("_Function", bound=Meaning)


def meaning(name: str) -> Callable[[_Function], _Function]:
    """Enter a function as the meaning of this name."""

    def enter(function: _Function) -> _Function:
        if name in MEANINGS:
            raise ValueError(f"two meanings are called {name!r}")
        MEANINGS[name] = function
        return function

    return enter
