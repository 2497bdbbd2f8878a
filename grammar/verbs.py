"""Verbs of a language whose commands put them first or last, and that may part in two.

    verbs: {fetch: holen, ab|holen}     "hol die Tasse", "hol die Tasse ab", "die Tasse abholen"
    say: "~fetch <thing>"

What follows ">>" stands after a verb that ends its clause: "say: ~report <person> >> , <news>" is
"sag mir, wie spät es ist" and "mir zu sagen, wie spät es ist".

`forms` makes the rules `<fetch_1>` (as a command begins), `<fetch_off>` (what a verb that parts
leaves at the end), `<fetch_2>` (as a clause ends) and `<fetch_done>` (its participle); `ordered`
makes the templates with them. Both follow patterns in the language's data, so that another language
may order its clauses otherwise.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

PARTS: Final = "|"
"""Between the particle of a verb that may part and the rest of it."""
NEXT_TO_NOTHING: Final = 0.001
AFTER: Final = ">>"
"""Before what stands behind the end of a clause."""

_MARKED: Final = re.compile(r"~(\w+)")
_WITHOUT: Final = re.compile(r"\s*<VERB_off>")


def forms(verbs: Mapping[str, Sequence[str]], conjugation: Mapping[str, Any]) -> dict[str, Any]:
    """The rules that a language's verbs stand for, with their words."""
    rules: dict[str, Any] = {}
    for name, infinitives in verbs.items():
        first: dict[str, None] = {}
        whole: dict[str, None] = {}
        parting: dict[str, None] = {}
        last: dict[str, None] = {}
        particles: dict[str, None] = {}
        done: dict[str, None] = {}
        for infinitive in infinitives:
            particle, _, base = infinitive.rpartition(PARTS)
            if particle:
                particles[particle] = None
            made = _conjugated(base, conjugation)
            patterns = conjugation["last_parted" if particle else "last"]
            begins = dict.fromkeys(pattern.format(**made) for pattern in conjugation["first"])
            first |= begins
            if particle:
                parting |= begins
            else:
                whole |= begins
            last |= dict.fromkeys(pattern.format(particle=particle, **made) for pattern in patterns)
            ends = conjugation.get("done", ())
            done |= dict.fromkeys(pattern.format(particle=particle, **made) for pattern in ends)
        rules[f"{name}_1"] = _rule(first)
        rules[f"{name}_2"] = _rule(last)
        if done:
            rules[f"{name}_done"] = _rule(done)
        if particles:
            rules[f"{name}_off"] = _rule(particles)
        if whole and parting:
            rules[f"{name}_whole"] = _rule(whole)
            rules[f"{name}_parting"] = _rule(parting)
    return rules


def _rule(words: Mapping[str, None]) -> dict[str, Any]:
    """A rule of its own for some words, with next to no cost: one without any would be copied into
    each template that has the verb."""
    return {"say": f"({'|'.join(words)})", "cost": NEXT_TO_NOTHING}


def _conjugated(infinitive: str, conjugation: Mapping[str, Any]) -> dict[str, str]:
    """The forms that the patterns name: `infinitive`, `stem`, and those the endings give."""
    made = {"infinitive": infinitive}
    participle = conjugation.get("participles", {}).get(infinitive)
    changed = conjugation.get("irregular", {}).get(infinitive)
    for name, endings in conjugation["forms"].items():
        start = changed if changed and name in conjugation["changing"] else infinitive
        if changed and name in conjugation["changing"]:
            start = changed + conjugation["infinitive"]
        made[name] = next(
            re.sub(ending, instead, start)
            for ending, instead in endings
            if re.search(ending, start)
        )
    if participle is not None:
        made["participle"] = participle
    return made


def ordered(say: str, orders: Sequence[str], rules: Mapping[str, Any]) -> Iterator[str]:
    """The templates that one with a verb marked by ~ stands for; any other stands for itself. A
    verb that parts leaves its particle at the end: "fahr zurück" is not "fahr"."""
    marked = _MARKED.search(say)
    if marked is None:
        yield say
        return
    before, after, name = say[: marked.start()], say[marked.end() :], marked.group(1)
    inside, _, behind = after.partition(AFTER)
    for order in orders:
        if f"{name}_parting" in rules and "<VERB_off>" in order:
            parted = order.replace("VERB_1", "VERB_parting")
            ways = [_WITHOUT.sub("", order.replace("VERB_1", "VERB_whole")), parted]
        else:
            ways = [order if f"{name}_off" in rules else _WITHOUT.sub("", order)]
        for way in ways:
            clause = way.replace("VERB", name).replace("REST", inside.strip())
            yield f"{before}{clause} {behind.strip()}".rstrip()
