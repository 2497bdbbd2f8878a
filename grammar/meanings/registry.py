"""Where meanings are entered by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

from grammar.chart import Node
from grammar.discourse import Discourse

Meaning = Callable[[Discourse, Node], Any]

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
