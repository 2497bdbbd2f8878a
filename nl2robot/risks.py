"""What a person should think about before approving a program, marked on its lines.

A risk stands in nobody's way: what this robot cannot do is an error of `nl2robot.policy`.
"""

from __future__ import annotations

from typing import Literal

import msgspec

Kind = Literal["leaves", "zone", "speed", "volume", "person", "long", "endless"]


class Risk(msgspec.Struct, frozen=True):
    """Something to think about, and where it is in the program."""

    line: int
    kind: Kind
    text: str
    """In the language of the review."""
