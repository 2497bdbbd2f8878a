"""What a program has looked for in vain: why its next step cannot be done.

A program that looks for the blanket and then takes it goes on to the second step without it. The
robot says there that it sees no blanket here; whoever sent it wants to know that there was none
anywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from robot_api.errors import NotFound


class Sought:
    """What one program has looked for, and where that left it."""

    def __init__(self) -> None:
        self._in_vain: set[str] = set()

    def call(self, method: str, arguments: Mapping[str, Any], make: Callable[[], Any]) -> Any:
        """Make a call of the program. Raises `NotFound` with another sentence where it fails for
        want of what was looked for in vain."""
        thing = arguments.get("thing")
        try:
            result = make()
        except NotFound as error:
            missing = next((it for it in (thing, arguments.get("person")) if self.lacks(it)), None)
            if missing is None:
                raise
            sentence = f'The robot could not find "{missing}", so it did not go on.'
            raise NotFound(sentence) from error
        if method == "find" and isinstance(thing, str):
            (self._in_vain.discard if result else self._in_vain.add)(thing)
        return result

    def lacks(self, thing: Any) -> bool:
        return isinstance(thing, str) and thing in self._in_vain
