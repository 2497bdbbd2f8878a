"""Who was reminded last, and of what: noted where the words are made that are said to them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from grammar.chart import Node
from grammar.discourse import Discourse, Thing

Of = Literal["deed", "thing", "fact"]
"""To drink; of the pills; that the physio comes at four."""


@dataclass(frozen=True)
class Reminded:
    person: Thing | None
    of: Of


def note_reminder(d: Discourse, node: Node, person: Thing | None, of: Of) -> None:
    """Note it, if the verb of a command says that it reminds somebody."""
    verbs = set(d.language.speech.get("reminding", ()))
    text = node.parts.get("text")
    inside: range | tuple[int, ...] = range(text.start, text.end) if text is not None else ()
    said = {d.tokens[at].norm for at in range(node.start, node.end) if at not in inside}
    d.answers = replace(d.answers, reminded=Reminded(person, of) if verbs & said else None)
