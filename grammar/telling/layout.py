"""Steps in words put together: sentences for reading at a stretch, lines for a list."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

from grammar import plan as p
from grammar.speech import Speech, fill


@dataclass(frozen=True)
class Told:
    """A step in words: something to do, or a clause ("three times") over other steps."""

    text: str
    steps: tuple[Told, ...] = ()
    is_clause: bool = False
    continues: bool = False
    """Whether it belongs to the one before it ("otherwise")."""
    step: p.Step | None = field(default=None, compare=False)
    """The step that it tells of."""


def sentences(told: Sequence[Told], words: Speech) -> str:
    """Steps as sentences: simple ones that follow each other in one, every clause in its own."""
    written: list[str] = []
    simple: list[str] = []

    def finish() -> None:
        if simple:
            pattern = words.sentences["next" if written else "first"]
            written.append(fill(pattern, {"steps": _joined(simple, words)}))
            simple.clear()

    for each in told:
        if not each.is_clause:
            simple.append(each.text)
            continue
        finish()
        each = _merged(each, words)
        kind = "other_clause" if each.continues else "next_clause" if written else "first_clause"
        steps = _inner(each.steps, words)
        if any(inner.is_clause for inner in each.steps):
            steps = fill(words.sentences["nested"], {"steps": steps})
        written.append(fill(words.sentences[kind], {"clause": each.text, "steps": steps}))
    finish()
    if not written:
        return _capital(fill(words.sentences["first"], {"steps": words.sentences["nothing"]}))
    # What is quoted at the end may have brought its own full stop.
    closing = words.values["quoted"][-1]
    ended = re.compile(rf"(?<=[.!]{re.escape(closing)})\.$")
    return " ".join(_capital(ended.sub("", sentence)) for sentence in written)


def listed(told: Iterable[Told], words: Speech, depth: int = 0) -> list[tuple[int, str]]:
    lines: list[tuple[int, str]] = []
    for each in told:
        if each.is_clause:
            lines.append((depth, f"{each.text}:"))
            lines += listed(each.steps, words, depth + 1) or [
                (depth + 1, words.sentences["nothing"])
            ]
        else:
            lines.append((depth, each.text))
    return lines


def _inner(told: Sequence[Told], words: Speech) -> str:
    """The steps under a clause, within its sentence."""
    if not told:
        return words.sentences["nothing"]
    if not any(each.is_clause for each in told):
        return _joined([each.text for each in told], words)
    parts: list[str] = []
    for each in told:
        if not each.is_clause:
            parts.append(each.text)
            continue
        each = _merged(each, words)
        pattern = words.joining["single" if len(each.steps) < 2 else "several"]
        if any(inner.is_clause for inner in each.steps):
            pattern = words.joining["several"]
        parts.append(fill(pattern, {"clause": each.text, "steps": _inner(each.steps, words)}))
    return words.joining["semicolon"].join(parts)


def _merged(told: Told, words: Speech) -> Told:
    """A clause over nothing but another clause as one: "for each of the offices, if ..."."""
    while len(told.steps) == 1 and told.steps[0].is_clause:
        inner = told.steps[0]
        text = fill(words.joining["clauses"], {"outer": told.text, "inner": inner.text})
        told = replace(told, text=text, steps=inner.steps)
    return told


def _joined(texts: Sequence[str], words: Speech) -> str:
    if len(texts) == 1:
        return texts[0]
    last = words.joining["two" if len(texts) == 2 else "last"]
    return words.joining["comma"].join(texts[:-1]) + last + texts[-1]


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
