"""What goes to and fro between a program and the language model's own process: one per line."""

from __future__ import annotations

import msgspec

from grammar.planning.model.request import Request, Written


class Write(msgspec.Struct, frozen=True, tag="write"):
    """Write a program; with no words of a person, only get ready to."""

    id: int
    request: Request


class Cancel(msgspec.Struct, frozen=True, tag="cancel"):
    id: int


Order = Write | Cancel


class Ready(msgspec.Struct, frozen=True, tag="ready"):
    """The model is loaded."""


class Growing(msgspec.Struct, frozen=True, tag="growing"):
    """The first program as far as it is written."""

    id: int
    text: str


class Done(msgspec.Struct, frozen=True, tag="done"):
    id: int
    written: tuple[Written, ...]


class Failed(msgspec.Struct, frozen=True, tag="failed"):
    id: int
    cancelled: bool = False
    late: bool = False
    """Whether the time was over before there was a program."""


Report = Ready | Growing | Done | Failed

# Learned before there are threads: two that met one first would crash msgspec (0.22).
msgspec.json.Decoder(Report)
msgspec.json.Decoder(Order)
