"""Word order of languages whose verbs stand last in a reported clause and second in a direct one.

    "dass das Essen um zwölf ankommt" -> "Das Essen kommt um zwölf an"

The words that tell where the first part of a clause ends, and which particles part from their verb,
are data of the language: `speech: {clause: ...}`. A language without them keeps its order.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

from grammar.discourse import Discourse
from grammar.errors import NotUnderstood
from grammar.names import names_of
from grammar.texts.words import words_for
from grammar.tokens import COLON, COMMA

SHORTEST_VERB: Final = 4
"""Letters that are left of a verb when its particle is taken off."""


@dataclass(frozen=True)
class Group:
    """A written word, of one token or, as in "zur", of several."""

    spelled: str
    norms: tuple[str, ...]
    at: int
    """Its first token."""
    number: bool

    @property
    def norm(self) -> str:
        return self.norms[0]

    @property
    def capital(self) -> bool:
        return self.spelled[:1].isupper()


def direct_clause(
    d: Discourse, start: int, end: int, instead: Mapping[int, str] | None = None
) -> str:
    """The words of a reported clause, in the order of a direct one; `instead` has what some of its
    tokens are written as. Behind a mere comma or colon it is a direct one already: "sag ihr, ihre
    Tochter wartet unten"."""
    rules = d.language.speech.get("clause")
    if rules is None:
        return d.words(start, end)
    clauses: list[list[Group]] = [[]]
    joints: list[str] = []
    groups = _groups(d, start, end)
    if instead:
        groups = [replace(group, spelled=instead.get(group.at, group.spelled)) for group in groups]
    if is_direct(d, start):
        return _written([group.spelled for group in groups])
    for position, group in enumerate(groups):
        ended = bool(clauses[-1]) and _is_verb(rules, d, clauses[-1][-1], clauses[-1][0])
        behind = groups[position + 1 :]
        if group.norm == COMMA and behind and _stays(rules, d, behind):
            if not ended:  # "dass er, wenn er kommt, bleiben soll"
                words = d.words(start, end)
                raise NotUnderstood(d.language.phrase("not_understood", part=words))
            rest = _written([group.spelled for group in behind])
            return _joined(rules, d, clauses, joints) + f", {rest}"
        if ended and group.norm in (COMMA, *d.language.speech["joins"]):
            joints.append(", " if group.norm == COMMA else f" {group.spelled} ")
            clauses.append([])
        else:
            clauses[-1].append(group)
    return _joined(rules, d, clauses, joints)


def _is_verb(rules: Any, d: Discourse, group: Group, subject: Group) -> bool:
    """Whether a word is the verb of a clause with this subject, as far as its form tells."""
    said = words_for(d.language).finite_pattern.search(group.norm) is not None
    said |= subject.norm in rules["first_person"] and group.norm.endswith("e")
    said |= group.norm in d.language.speech["base_forms"]
    return group.norm in rules["finite"] or (said and not group.capital)


def _stays(rules: Any, d: Discourse, groups: Sequence[Group]) -> bool:
    """Whether what stands behind a comma is said as it is: "weil ...", "um ... zu ...", "den ich
    kenne"; but not "die Suppe kalt ist"."""
    first, *others = groups
    if first.norm in rules["subordinating"] or first.norm in rules["prepositions"]:
        return True
    relative = first.norm in rules["relative"] and bool(others)
    capital = [d.tokens[each.at].capital for each in others[:2]]
    noun = relative and (capital[0] and not _named(d, groups, 1))
    adjective = relative and others[0].norm.endswith(("e", "en"))
    return relative and not noun and not (adjective and capital[1:] == [True])


def is_direct(d: Discourse, start: int) -> bool:
    """Whether a clause that begins here is one to be said as it is: its verb stands second."""
    return start > 0 and d.tokens[start - 1].norm in (COMMA, COLON)


def _joined(
    rules: Any, d: Discourse, clauses: Sequence[Sequence[Group]], joints: Sequence[str]
) -> str:
    text = _verb_second(rules, d, clauses[0])
    for joint, clause in zip(joints, clauses[1:], strict=True):
        at = int(bool(clause) and clause[0].norm in rules.get("adverbs", ()))
        begins = clause[at : at + 1]  # "und heute nicht komme" has no subject of its own
        own = begins and (begins[0].capital or _begins_noun(rules, begins[0]))
        told = _verb_second(rules, d, clause) if own else _verb_first(rules, clause)
        text += joint + told
    return text


def asked_of_you(d: Discourse, clause: str) -> str:
    """A clause that ends with an infinitive, as it is asked of somebody: "in die Küche kommen" ->
    "kommen Sie in die Küche". Unchanged in languages without `imperative` in their data, and where
    there are several verbs."""
    rules = d.language.speech.get("imperative")
    words = clause.split()
    if rules is None or not words or set(words) & set(rules["joins"]):
        return clause
    verb, particle = parted(d, words[-1])
    verb = rules["irregular"].get(verb, verb)
    return _written([verb, rules["you"], *words[:-1], *([particle] if particle else [])])


def parted(d: Discourse, verb: str) -> tuple[str, str]:
    """A verb without its particle, and the particle: "mitkommt" -> "kommt", "mit"."""
    rules = d.language.speech.get("clause")
    return _parted(rules, verb) if rules else (verb, "")


def _groups(d: Discourse, start: int, end: int) -> list[Group]:
    groups: list[Group] = []
    position = start
    while position < end:
        first = d.tokens[position]
        last = position + 1
        while last < end and d.tokens[last].start < first.end:
            last += 1
        groups.append(
            Group(
                d.text[first.start : d.tokens[last - 1].end],
                tuple(token.norm for token in d.tokens[position:last]),
                position,
                first.value is not None,
            )
        )
        position = last
    return groups


def _verb_second(rules: Any, d: Discourse, groups: Sequence[Group]) -> str:
    words = [group.spelled for group in groups]
    if len(groups) < 2:
        return _written(words)
    if groups[-1].norm in rules["particles"]:
        return _written(words)  # "die Besprechung fällt aus": the verb stands second already
    moved: list[Group] = []
    if groups[0].norm in rules["reflexive"]:  # "sich der Arzt verspätet"
        moved, groups = [groups[0]], groups[1:]
        words = [group.spelled for group in groups]
    first = min(_first_part(rules, d, groups), len(groups) - 1)
    last = _verb_at(rules, groups, first)
    second, ends = (groups[at].norm in rules["finite"] for at in (first, last))
    if second and first < last and not ends:  # but not in "sie kommen soll"
        return _written(words)  # the verb stands second already
    verb, particle = _parted(rules, words[last])
    reflexive = [group.spelled for group in moved]
    rest = [*reflexive, *words[first:last], *([particle] if particle else [])]
    return _written([*words[:first], verb, *rest, *words[last + 1 :]])


def _verb_at(rules: Any, groups: Sequence[Group], first: int) -> int:
    """Where the verb of a reported clause stands: last, but for what is said after all else: "dass
    das Essen fertig ist in der Küche"."""
    last = len(groups) - 1
    if not groups[last].capital:
        return last
    verbs = [at for at in range(first, last) if groups[at].norm in rules["finite"]]
    return verbs[-1] if verbs else last


def _verb_first(rules: Any, groups: Sequence[Group]) -> str:
    if not groups:
        return ""
    words = [group.spelled for group in groups]
    verb, particle = _parted(rules, words[-1])
    return _written([verb, *words[:-1], *([particle] if particle else [])])


def _first_part(rules: Any, d: Discourse, groups: Sequence[Group]) -> int:
    """How many words the first part of a clause has: its subject, or what stands before that."""
    at = 0
    if groups[0].norm in rules.get("comparing", ()):  # "mehr als zehn Leute sind da"
        nouns = [number for number, group in enumerate(groups[:-1]) if number and group.capital]
        return _noun_end(rules, groups, nouns[0]) if nouns else 1
    if groups[0].norm in rules["prepositions"]:
        at = 1
        if at >= len(groups):
            return at
        if groups[at].number and at + 1 < len(groups) and _begins_noun(rules, groups[at + 1]):
            return at + 1  # "um drei beginnt die Visite"
        if groups[at].number and groups[0].norm in rules.get("clock", ()):
            hours = at + 1 < len(groups) and groups[at + 1].norm in rules["clock"]
            return at + 1 + hours  # "um zwölf Uhr ist Probealarm"
    named = _named(d, groups, at)
    if named and _owns(d, groups, named):  # "Bobs Termin ist um drei"
        return _noun_end(rules, groups, named)
    if named:
        return _noun_end(rules, groups, named - 1)
    group = groups[at]
    following = groups[at + 1] if at + 1 < len(groups) else None
    opens = group.norm in rules["determiners"] or group.number or len(group.norms) > 1
    if group.norm in rules["pronouns"] and (
        group.norm not in rules["determiners"]
        or following is None
        or not (following.capital or following.spelled.isalpha())
        or _begins_noun(rules, following)
        or following.norm in d.language.closed
    ):
        return at + 1
    if opens or (at == 1 and not group.capital):
        at += bool(opens and len(group.norms) == 1)
        nouns = [number for number in range(at, len(groups) - 1) if groups[number].capital]
        if nouns and nouns[0] - at < 3:
            at = nouns[0]
        else:
            return min(at + 1, len(groups))
    return _noun_end(rules, groups, at)


def _noun_end(rules: Any, groups: Sequence[Group], at: int) -> int:
    """Where a noun ends that begins here: "Frau Doktor Weber", "Zimmer 12", "Alice und Bob"."""
    titled = groups[at].norm in rules["titles"]
    at += 1
    while at < len(groups) - 1 and (
        (groups[at].number and not groups[at + 1].capital) or (titled and groups[at].capital)
    ):  # "Zimmer 12", but not "die Sprechstunde zwanzig Minuten später"
        at += 1
    if (
        at + 2 < len(groups)
        and groups[at].norm in rules["and"]
        and (groups[at + 1].capital or _begins_noun(rules, groups[at + 1]))
    ):
        at += 1
        if _begins_noun(rules, groups[at]) and at + 1 < len(groups) - 1:
            at += 1
        return _noun_end(rules, groups, at)
    return at


def _begins_noun(rules: Any, group: Group) -> bool:
    return group.norm in rules["determiners"] or group.norm in rules["pronouns"]


def _owns(d: Discourse, groups: Sequence[Group], end: int) -> bool:
    """Whether the name before this position is a genitive: "Bobs", before what is his."""
    mark = tuple(d.language.speech.get("bare_possessive", ()))
    genitive = bool(mark) and groups[end - 1].spelled.endswith(mark)
    owned = groups[end] if end < len(groups) - 1 else None
    return genitive and owned is not None and owned.capital and not _named(d, groups, end)


def _named(d: Discourse, groups: Sequence[Group], at: int) -> int:
    """How many words there are up to the end of a name of the world that begins here; 0 if none."""
    tries = names_of(d.language, d.lexicon).tries
    longest = 0
    for slot in ("person", "place"):
        node = tries.get(slot)
        for position in range(at, len(groups) - 1):
            for norm in groups[position].norms:
                node = node.branches.get(norm) if node else None
            if node and node.values:
                longest = max(longest, position + 1)
    return longest


def _parted(rules: Any, verb: str) -> tuple[str, str]:
    low = verb.lower()
    if low in rules["inseparable"] or low in rules["finite"]:
        return verb, ""
    for particle in sorted(rules["particles"], key=len, reverse=True):
        if low.startswith(particle) and len(low) - len(particle) >= SHORTEST_VERB:
            return verb[len(particle) :], particle
    return verb, ""


def _written(words: Sequence[str]) -> str:
    return " ".join(words).replace(" ,", ",")
