"""What a review says, as the page shows it: what would happen, and marks on the lines."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal, TypedDict

from grammar.language import load_language
from grammar.naming import naming
from nl2robot.knowledge import Knowledge
from nl2robot.review.review import Review
from nl2robot.run.trouble import told
from nl2robot.words import foreseen

MOST_PLACES: Final = 12


class MarkTold(TypedDict):
    """Something to know of a line."""

    line: int
    weight: Literal["error", "risk", "note"]
    text: str


class Outcome(TypedDict):
    """An outlook for scripts; each fact is a heading with its items."""

    outcome: str
    good: bool
    facts: list[tuple[str, list[str]]]
    marks: list[MarkTold]


@dataclass(frozen=True)
class Mark:
    """Something to think about on a line."""

    line: int
    weight: Literal["error", "risk", "note"]
    text: str


@dataclass(frozen=True)
class Outlook:
    """What would happen, and what to think about."""

    sentence: str
    """How long it would take, how far it would drive, how it would end; empty without a dry run."""
    good: bool
    """Whether it would be done."""
    facts: tuple[tuple[str, tuple[str, ...]], ...]
    """What it would pass, say, ask and show: a heading with its items."""
    marks: tuple[Mark, ...]
    path: tuple[tuple[float, float], ...]

    @property
    def decorations(self) -> list[dict[str, Any]]:
        """The marks for the editor."""
        return [
            {"kind": "line", "line": mark.line, "class": f"line-{mark.weight}"}
            for mark in self.marks
        ]

    def as_told(self, words: Mapping[str, str]) -> dict[str, Any]:
        """The same for scripts, in the texts of the desk."""
        return {
            "outcome": self.sentence or words["cannot"],
            "good": self.good,
            "facts": [[heading, list(items)] for heading, items in self.facts],
            "marks": [
                {
                    "line": mark.line,
                    "weight": mark.weight,
                    "text": f"{words[mark.weight]}, {words['line']} {mark.line}: {mark.text}",
                }
                for mark in self.marks
            ],
        }


def outlook(
    review: Review, words: Mapping[str, str], language: str, knowledge: Knowledge
) -> Outlook:
    """What this review says, in a language."""
    lexicon = knowledge.lexicon(language)
    endless = {(risk.line, "endless-loop") for risk in review.risks if risk.kind == "endless"}
    marks = [
        *(
            Mark(
                found.line,
                "error" if found.severity == "error" else "note",
                told(found.code, found.message, language, lexicon),
            )
            for found in review.findings
            # That it is endless is a risk as well, and said once.
            if (found.line, found.code) not in endless
        ),
        *(Mark(risk.line, "risk", risk.text) for risk in review.risks),
    ]
    marks.sort(key=lambda mark: mark.line)
    dry_run = review.dry_run
    if dry_run is None:
        return Outlook("", review.acceptable, (), tuple(marks), ())
    why = told(dry_run.error, dry_run.message, language, lexicon) if dry_run.message else None
    way = _way(dry_run.places, knowledge, language)
    asks = tuple(dict.fromkeys(dry_run.asks))
    facts = [
        (words["way"], (way,) if way else ()),
        (words["closed"], tuple(map(_called(knowledge, language), dry_run.closed))),
        (words["says"], tuple(text for text in dict.fromkeys(dry_run.says) if text not in asks)),
        (words["asks"], asks),
        (words["answers"], (words["made_up"],) if asks else ()),
        (words["shows"], tuple(dict.fromkeys(dry_run.shows))),
    ]
    return Outlook(
        sentence=" ".join(filter(None, (foreseen(dry_run, language), why))),
        good=dry_run.complete,
        facts=tuple((heading, items) for heading, items in facts if items),
        marks=tuple(marks),
        path=dry_run.path,
    )


def _called(knowledge: Knowledge, language: str) -> Callable[[str], str]:
    """What places are called in a language."""
    return naming(knowledge.lexicon(language), load_language(language)).called


def _way(places: Sequence[str], knowledge: Knowledge, language: str) -> str:
    """The places in order; of a long way, where it begins and where it ends; empty if it stays."""
    if len(places) < 2:
        return ""
    called = _called(knowledge, language)
    if len(places) > MOST_PLACES:
        places = [*places[: MOST_PLACES // 2], "…", *places[-MOST_PLACES // 2 :]]
    return " → ".join(map(called, places))
