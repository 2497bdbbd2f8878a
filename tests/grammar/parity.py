"""What one language can mean and another cannot, from their compiled rules.

    python -m tests.grammar.parity        rewrites `parity.yaml` after the rules have changed

A role is what a rule or slot of a template is bound to, or a fixed value (`with:`) that stands for
no words of the language. Gaps that were closed leave the list; new ones come under "not yet", where
they wait for the words or for a reason.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import yaml

from grammar.language import languages, load_language
from grammar.network import Production, parts_of
from grammar.templates import Template

FIRST: Final = "en"
"""The language that the others are measured by."""
NOT_YET: Final = "not yet"
ALLOWED: Final = Path(__file__).with_name("parity.yaml")
WORDINGS: Final = frozenset(
    {
        *("form", "each", "past", "third", "unit", "add", "minute", "more", "number", "value"),
        *("phrase", "label"),
    }
)
"""Values that are words of a language, or measures that only some people use."""


def gaps(language: str) -> set[str]:
    """The meanings, and the roles of meanings ("ask.scale"), that a language has no words for."""
    ours, theirs = _roles(FIRST), _roles(language)
    lacking = ours.keys() - theirs.keys()
    return lacking | {
        f"{meaning}.{role}"
        for meaning, roles in ours.items()
        if meaning not in lacking
        for role in roles - theirs[meaning]
    }


def allowed(language: str) -> dict[str, list[str]]:
    """The gaps that are known, by the reason for them."""
    listed: dict[str, dict[str, list[str]]] = yaml.safe_load(ALLOWED.read_text(encoding="utf-8"))
    return listed.get(language, {})


def _roles(language: str) -> dict[str, set[str]]:
    rules = load_language(language).rules
    found: dict[str, set[str]] = {}
    for name in _reached(rules):
        for entry in rules[name]:
            if entry.means:
                roles = found.setdefault(entry.means, set())
                roles.update(*(_bound(each, rules, frozenset()) for each in entry.templates))
                roles.update(
                    f"{role}={value}" for role, value in entry.fixed.items() if role not in WORDINGS
                )
    return found


def _reached(rules: Mapping[str, tuple[Production, ...]]) -> list[str]:
    """The rules that a sentence or what is said of one can lead to."""
    found = [each for each in ("utterance", "edit", "standing_order") if each in rules]
    for name in found:
        for entry in rules[name]:
            for template in entry.templates:
                new = (part.name for part in parts_of(template) if part.is_rule)
                found += [each for each in dict.fromkeys(new) if each not in found]
    return found


def _bound(
    template: Template, rules: Mapping[str, tuple[Production, ...]], inside: frozenset[str]
) -> set[str]:
    """What the parts of a template are bound to; a rule without a meaning passes its own on."""
    found: set[str] = set()
    for part in parts_of(template):
        if not part.is_rule or part.binding or any(each.means for each in rules[part.name]):
            found.add(part.binding or part.name)
        elif part.name not in inside:
            for entry in rules[part.name]:
                for each in entry.templates:
                    found |= _bound(each, rules, inside | {part.name})
    return found


def _rewrite() -> None:
    listed: dict[str, dict[str, list[str]]] = {}
    for language in languages():
        if language == FIRST:
            continue
        open_ = gaps(language)
        kept = {
            reason: sorted(open_.intersection(names))
            for reason, names in allowed(language).items()
            if reason != NOT_YET
        }
        known = {name for names in kept.values() for name in names}
        kept[NOT_YET] = sorted(open_ - known)
        listed[language] = {reason: names for reason, names in kept.items() if names}
    comment = ALLOWED.read_text(encoding="utf-8").split("\n\n")[0]
    data = yaml.safe_dump(listed, allow_unicode=True, sort_keys=False, width=100)
    ALLOWED.write_text(f"{comment}\n\n{data}", encoding="utf-8")


if __name__ == "__main__":
    _rewrite()
