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
RARE: Final = 0.5
"""What a form costs that is seldom meant as an order."""
AFTER: Final = ">>"
"""Before what stands behind the end of a clause."""

_MARKED: Final = re.compile(r"~(\w+)")
_WITHOUT: Final = re.compile(r"\s*<VERB_off>")


def forms(verbs: Mapping[str, Sequence[str]], conjugation: Mapping[str, Any]) -> dict[str, Any]:
    """The rules that a language's verbs stand for, with their words."""
    rules: dict[str, Any] = {}
    for name, infinitives in verbs.items():
        found: dict[str, dict[str, float]] = {}
        for infinitive in infinitives:
            particle, _, base = infinitive.rpartition(PARTS)
            made = _conjugated(base, conjugation) | {"particle": particle}
            begins = {
                pattern.format(**made): cost
                for key, cost in (("first_rarely", RARE), ("first", NEXT_TO_NOTHING))
                for pattern in conjugation.get(key, ())
            }
            ends = conjugation["last_parted" if particle else "last"]
            words = {
                "1": begins,
                "parting" if particle else "whole": begins,
                "2": dict.fromkeys((each.format(**made) for each in ends), NEXT_TO_NOTHING),
                "off": {particle: NEXT_TO_NOTHING} if particle else {},
                "done": {
                    each.format(**made): NEXT_TO_NOTHING for each in conjugation.get("done", ())
                },
            }
            for form, costs in words.items():
                kept = found.setdefault(form, {})
                for word, cost in costs.items():
                    kept[word] = min(cost, kept.get(word, cost))
        if not ("parting" in found and "whole" in found):
            found = {
                form: words for form, words in found.items() if form in ("1", "2", "off", "done")
            }
        rules |= {f"{name}_{form}": _rule(words) for form, words in found.items() if words}
    return rules


def _rule(costs: Mapping[str, float]) -> list[dict[str, Any]]:
    """A rule of its own for some words, with next to no cost: one without any would be copied into
    each template that has the verb."""
    by_cost: dict[float, list[str]] = {}
    for word, cost in costs.items():
        by_cost.setdefault(cost, []).append(word)
    return [{"say": f"({'|'.join(words)})", "cost": cost} for cost, words in by_cost.items()]


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
