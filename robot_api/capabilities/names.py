"""Names that people get nearly right: which was meant, and how to say that there is no such."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from robot_api.capabilities.languages import fold
from robot_api.errors import UnknownPerson, UnknownPlace

_NEAR = 70.0
"""From this similarity on, of 100, a name is offered as the one that may have been meant."""


def one_of(wanted: str, known: Iterable[str]) -> str | None:
    """The name that is meant, whatever its case, accents and punctuation; None if none is."""
    key = fold(wanted)
    return next((name for name in known if fold(name) == key), None)


def nearest(wanted: str, known: Iterable[str]) -> str | None:
    """The name most like the wanted one, if any is like it."""
    from rapidfuzz import fuzz, process

    found = process.extractOne(
        " ".join(fold(wanted)),
        {name: " ".join(fold(name)) for name in known},
        scorer=fuzz.WRatio,
        score_cutoff=_NEAR,
    )
    return found[2] if found else None


def listed(names: Sequence[str], none: str = "nothing") -> str:
    """ "a, b and c"."""
    if len(names) < 2:
        return names[0] if names else none
    return f"{', '.join(names[:-1])} and {names[-1]}"


def unknown_place(wanted: str, known: Mapping[str, str]) -> UnknownPlace:
    """The error for a place that nobody knows; `known` gives for each name and alias the place."""
    near = nearest(wanted, known)
    return UnknownPlace(
        f"I know no place called '{wanted}'. "
        + (
            f"Did you mean {with_article(known[near])}?"
            if near
            else "Name one of the known places."
        )
    )


def unknown_contact(wanted: str, known: Mapping[str, str]) -> UnknownPerson:
    """The error for somebody who is not in the list of contacts."""
    if not known:
        return UnknownPerson(
            f"I cannot call '{wanted}', because my list of contacts is empty. "
            "Add contacts to it first."
        )
    near = nearest(wanted, known)
    names = tuple(dict.fromkeys(known.values()))
    return UnknownPerson(
        f"There is no '{wanted}' among my contacts. "
        + (f"Did you mean {known[near]}?" if near else f"I can call {listed(names[:5])}.")
    )


def with_article(place: str) -> str:
    """ "the pharmacy", but "Alice's office" and "room 12"."""
    words = place.split()
    possessive = "'s" in place or "’s" in place
    numbered = any(c.isdigit() for c in place)
    named = bool(words) and words[0][0].isupper()
    return place if possessive or numbered or named else f"the {place}"
