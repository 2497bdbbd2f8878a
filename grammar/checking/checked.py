"""The check of a draft: what speaks against it, what it made of each word, and what it left
unused."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Final

from grammar.checking.deeds import (
    COMPARES,
    DECIDES,
    NEGATES,
    OTHERWISE,
    REPEATS,
    ROUND,
    UNTIL,
    deeds,
    said_anyhow,
)
from grammar.checking.evidence import Evidence, evidence_of
from grammar.checking.misnamed import Misnamed, misnamed
from grammar.checking.names import gone_twice, idle_names, misplaced, unbound
from grammar.checking.sources import Source, Sources, content_left, sort_of
from grammar.checking.words import Weighty, content, weighty, words_of
from grammar.lexicon import Question
from grammar.naming import place_called
from grammar.plan import Ask, Call, Items, Plan, Text
from grammar.planning.mentions import Mention
from grammar.planning.turn import Turn
from grammar.plausible import implausible
from grammar.refusals import forbidden, harmful, no_thing, not_said, out_of_range
from grammar.repairs import taken_back
from grammar.roles import ANYBODY
from grammar.tidy import nodes
from robot_api.methods import METHODS

MOST_OWN: Final = 2
SHARE_OF_OWN: Final = 0.3
"""So many words of one text, and so much of it, nobody has said: that is too much."""
_BY_THE_WAY: Final = frozenset(
    ("say", "ask", "goto", "find", "wait", "wait_until", "stop", "read_text")
)
"""What a plan may do on its way to what was asked for, beside looking and telling."""
UNASKED: Final = frozenset(
    name for name, method in METHODS.items() if not method.looks_or_tells
) - _BY_THE_WAY | {"answer", "log"}
"""Methods that nobody wants unasked: some word must speak for each."""
GRAVE: Final = frozenset(
    {"call", "hang_up", "set_language", "localize", "drive", "joint", "click", "type_text", "do"}
    | {"scan", "log"}
)
"""Those of them that are an objection; the others are a doubt, since people have many words for
them."""
_AKIN: Final = (
    frozenset({"grab", "give", "put"}),
    frozenset({"guide", "follow"}),
    frozenset({"call", "hang_up"}),
    frozenset({"move", "turn", "drive"}),
    frozenset({"wait_for", "wait", "wait_until"}),
    frozenset({"ask", "touch", "listen", "answer"}),
    frozenset({"show", "say"}),
)
"""Methods that the same words ask for."""
_ANSWERING_IF: Final = frozenset(
    {DECIDES, UNTIL, "ask", "sees", "find", "count", "touch", "wait_for", "listen"}
)
"""Deeds of which any answers an "if" or "whether"."""
_GOING_ROUND: Final = frozenset({ROUND, REPEATS, UNTIL, "people", "places", "wait_for"})
_FEW: Final = 12
"""Of a number up to this one, a round or a list may be what was counted."""
_SURE: Final = 0.5
"""The cost of a mention that is no guess."""
_OPEN: Final = frozenset({"unspoken", "denied"})
"""Doubts with which a plan may only be asked about."""
_NAMES: Final = frozenset({"place", "person", "contact"})


@dataclass(frozen=True)
class Objection:
    """Why a plan is not what was asked for."""

    kind: str
    """ "invented", "unheeded", "unasked", "harmful", "senseless", "refused", "range", "unbound"."""
    about: str
    """The words, or the literal."""
    message: str = ""
    """What a person is told, where it is theirs to know."""
    suggestions: tuple[str, ...] = ()
    """Sentences that may have been meant."""


@dataclass(frozen=True)
class Checked:
    objections: tuple[Objection, ...]
    sources: tuple[Source, ...] = ()
    unused: tuple[str, ...] = ()
    """Words of the sentence that the plan makes nothing of."""
    own: tuple[str, ...] = field(default=())
    """What the robot would say of its own knowledge."""
    doubts: tuple[Objection, ...] = ()
    """What makes it less likely that the plan is right: of the kinds of objections, "hardly asked";
    "unspoken": the plan uses no word, and no word asks for what it does; "denied": a "not" in what
    somebody says of themselves, of which the plan makes nothing."""

    @property
    def clear(self) -> bool:
        """Whether it may be shown without being asked about."""
        return all(each.kind not in _OPEN for each in self.doubts)

    @property
    def sound(self) -> bool:
        return not self.objections


_READ: Final = frozenset({"invented", "unheeded", "unasked", "harmful"})
"""Objections to what words do not ask for. Whoever has read each word by a rule knows that better:
of right programs of the rules, these would drop one in fifty, and hardly a wrong one."""


def check(turn: Turn, plan: Plan, *, exact: bool = False) -> Checked:
    """Check a plan for what somebody has said. It is `exact` if whoever made it understands a
    sentence as a whole or not at all: what would be an objection to the use of its words is then a
    doubt."""
    checked = _Check(turn, plan).checked()
    if not exact:
        return checked
    objections = tuple(each for each in checked.objections if each.kind not in _READ)
    doubts = dict.fromkeys((*checked.objections, *checked.doubts))
    return replace(
        checked,
        objections=objections,
        doubts=tuple(each for each in doubts if each not in objections),
    )


class _Check:
    def __init__(self, turn: Turn, plan: Plan) -> None:
        self.turn = turn
        self.plan = plan
        self.language = turn.language
        self.sources = Sources(turn, plan)
        self.deeds = deeds(plan)
        self.evidence: Evidence = evidence_of(turn.language)
        self.weighty: Weighty = weighty(turn.language)

    def checked(self) -> Checked:
        objections = tuple(self.objections())
        own = dict.fromkeys(each.literal.text for each in self.sources.found if each.own)
        return Checked(
            objections, tuple(self.sources.found), self.unused, tuple(own), tuple(self.doubts())
        )

    def objections(self) -> Iterator[Objection]:
        yield from self.refused()
        yield from (Objection("unbound", name) for name in unbound(self.plan))
        yield from (Objection("senseless", what) for what in misplaced(self.plan))
        yield from (Objection("senseless", name) for name in idle_names(self.plan))
        yield from (Objection("senseless", method) for method in gone_twice(self.plan))
        senseless = implausible(self.plan)
        if senseless is not None:
            yield Objection("senseless", senseless.value, self.language.phrase(senseless.value))
        yield from (Objection("invented", each.text) for each in self.sources.invented)
        yield from self.too_much_of_its_own()
        yield from self.turned_round()
        yield from self.unheeded()
        yield from (Objection("unasked", each) for each in self.unasked() if each in GRAVE)

    def doubts(self) -> Iterator[Objection]:
        """What makes a plan less likely to be right and need not be wrong."""
        yield from (Objection("unasked", method) for method in self.unasked())
        yield from (Objection("hardly asked", method) for method in self.hardly_asked())
        if not self.used and not any(self.speaks(at) for at in self.left):
            yield Objection("unspoken", self.turn.text)
        yield from (Objection("denied", self.norm(at)) for at in self.turning if self.is_own(at))
        for at in self.left:
            asked = self.evidence.asked_for(self.norm(at))
            if asked and not self.deeds.intersection(asked):
                yield Objection("unheeded", self.norm(at))
        for each in self.certain(frozenset({"person", "place", "contact", "kind", "thing"})):
            if each.value != ANYBODY and not self.used & {*range(each.start, each.end)}:
                yield Objection("unheeded", each.words)

    # --- what must not be

    def refused(self) -> Iterator[Objection]:
        phrase = forbidden(self.turn.tokens, self.language)
        if phrase is not None:
            yield Objection("refused", self.turn.text, self.language.phrase(phrase))
        for at, phrase in harmful(self.turn.tokens, self.language, self.turn.reader.names.called):
            if at not in self.used and at in self.orders:
                yield Objection("harmful", self.norm(at), self.language.phrase(phrase))
        lexicon = self.turn.lexicon
        impossible = no_thing(self.plan, lexicon, self.language)
        if impossible is not None:
            message, thing = impossible
            yield Objection("refused", thing, message)
        wrong = misnamed(self.turn, self.plan)
        if wrong is not None:
            yield self.near(wrong)
        hurtful = not_said(self.plan, lexicon, self.language)
        if hurtful is not None:
            yield Objection("refused", "", self.language.phrase(hurtful))
        beyond = out_of_range(self.plan, self.language)
        if beyond is not None:
            yield Objection("range", "", beyond)

    def near(self, wrong: Misnamed) -> Objection:
        """A name that nobody has, with those that may be meant."""
        message = self.language.phrase(wrong.phrase, name=wrong.words)
        names = [place_called(each, self.turn.lexicon, self.language) for each in wrong.near]
        if names:
            choices = self.turn.reader.alternatives(names)
            message = f"{message} {self.language.phrase('did_you_mean', choices=choices)}"
        suggestions = tuple(
            self.turn.reader.with_words(wrong.start, wrong.end, each, noun=True) for each in names
        )
        return Objection("refused", wrong.words, message, suggestions)

    # --- what nobody asked for

    def too_much_of_its_own(self) -> Iterator[Objection]:
        """What is said in words that nobody has said; but for what was left to the robot."""
        if self.sources.left_to_the_robot:
            return
        for each in self.sources.found:
            words = len(words_of(each.literal.text, self.language)) if each.own else 0
            if len(each.own) >= MOST_OWN and len(each.own) > SHARE_OF_OWN * words:
                yield Objection("invented", " ".join(each.own))

    def turned_round(self) -> Iterator[Objection]:
        """A "not" that nobody has said, in words that are said in any case."""
        negations = self.weighty.negations
        heard = {word for words in self.sources.heard.values() for word in words}
        denied = heard & (negations | self.sources.settled)
        if self.turn.earlier or self.sources.left_to_the_robot or denied:
            return
        for text in said_anyhow(self.plan):
            for word in self.language.tokens_of(text):
                if word in negations:
                    yield Objection("invented", word)

    def unasked(self) -> list[str]:
        """Methods that no word speaks for; but a word of which nothing is known may mean one."""
        if self.turn.before is not None:
            return []
        words = [token.norm for _, token in content(self.turn.tokens, self.language)]
        unasked = [
            method
            for method in sorted((self.deeds & UNASKED) - self.asked_word_by_word)
            if not any(
                self.evidence.speaks_for(word, deed) for word in words for deed in _akin(method)
            )
        ]
        named = {at for each in self.turn.mentions for at in range(each.start, each.end)}
        unknown = any(
            at not in named and not self.evidence.knows(self.norm(at)) for at in self.left
        )
        if unasked and unknown and all(method in _akin(unasked[0]) for method in unasked):
            return []
        return unasked

    def hardly_asked(self) -> list[str]:
        """Methods that no word asks for by itself."""
        words = [token.norm for _, token in content(self.turn.tokens, self.language)]
        return [
            method
            for method in sorted((self.deeds & UNASKED) - self.asked_word_by_word)
            if not any(self.evidence.licenses(word, method) for word in words)
        ]

    @cached_property
    def asked_word_by_word(self) -> set[str]:
        """ "answer", if the questions that are answered are among those that the house has answers
        to, and all their words were said."""
        said = {token.norm for token in self.turn.tokens}
        known = {each.question: each for each in self.turn.lexicon.questions}
        asked = [
            known.get(question.value) if isinstance(question, Text) else None
            for step in nodes(self.plan.steps)
            if isinstance(step, Call | Ask) and step.method == "answer"
            for question in (step.arguments.get("question"),)
        ]
        known_all = asked and all(each and self._said(each, said) for each in asked)
        return {"answer"} if known_all else set()

    def _said(self, question: Question, said: set[str]) -> bool:
        for text in (question.question, *question.aliases):
            words = set(self.language.tokens_of(text.rstrip(" ?"))) - self.language.closed
            if words and words <= said:
                return True
        return False

    # --- what was left out

    def unheeded(self) -> Iterator[Objection]:
        yield from self.unheeded_names()
        yield from self.unheeded_numbers()
        yield from self.unheeded_quantities()
        yield from self.unheeded_turns()

    def unheeded_names(self) -> Iterator[Objection]:
        """People and places of the world that were named, and that nothing in the plan is about."""
        known = {each.name for each in (*self.turn.lexicon.people, *self.turn.lexicon.places)}
        for each in self.certain(_NAMES):
            span = {*range(each.start, each.end)}
            if each.value not in known or self.used & span or each.end in self.taken_back:
                continue
            if self.matters(each.start) or self.goes_on(each):
                yield Objection("unheeded", each.words)

    @cached_property
    def taken_back(self) -> frozenset[int]:
        """The tokens at which words begin that take back what stands before them: "no, ..."."""
        return frozenset(
            place for start, _ in taken_back(self.turn.reader) for place in (start, start + 1)
        )

    def unheeded_numbers(self) -> Iterator[Objection]:
        for at, token in enumerate(self.turn.tokens):
            counts = token.kind == "time" or (token.value is not None and token.value != 1)
            if not counts or at in self.used or not self.matters(at):
                continue
            few = token.value is not None and token.value <= _FEW
            if not (few and (self.deeds & _GOING_ROUND or self.lists())):  # "all three wards"
                yield Objection("unheeded", token.norm)

    def unheeded_quantities(self) -> Iterator[Objection]:
        """Lengths, angles, languages and the like that were said, where the plan has one of its own
        choice."""
        found = self.sources.found
        chosen = {sort_of(each.literal) for each in found if each.origin == "default"}
        if UNTIL in self.deeds:
            chosen -= {"seconds"}  # between two looks
        heeded = {sort_of(each.literal) for each in found if each.origin != "default"}
        for each in self.turn.mentions:
            if each.sort in chosen - heeded and each.cost < _SURE and self.is_meant(each):
                yield Objection("unheeded", each.words)

    def is_meant(self, mention: Mention) -> bool:
        """Whether it is a number, or a name, and nothing in the plan comes from it."""
        at = range(mention.start, mention.end)
        number = any(each.sort == "number" and each.start in at for each in self.turn.mentions)
        named = number or mention.sort in ("language", "gesture", "times")
        return named and self.used.isdisjoint(at)

    def matters(self, at: int) -> bool:
        """Whether a word stands in a clause of which the plan makes something: of a remark, nothing
        need be made."""
        start, end = next((s, e) for s, e in self.clauses if s <= at < e)
        return any(place in self.used for place in range(start, end) if place != at)

    def goes_on(self, mention: Mention) -> bool:
        """Whether a clause has no word of its own besides a name, so that it goes on with the one
        before, of which the plan makes something: "go to the kitchen and then to the laundry"."""
        inside = {*range(mention.start, mention.end)}
        words = {at for at, _ in content(self.turn.tokens, self.language)}
        *before, (start, end) = [each for each in self.clauses if each[0] <= mention.start]
        clause = {*range(start, end)}
        joined = self.norm(start) in self.language.words_called("joins")
        if not joined or not inside <= clause or clause & words - inside or "places" in self.deeds:
            return False
        behind = [each for each in before if words.intersection(range(*each))]
        return bool(behind) and not self.used.isdisjoint(range(*behind[-1]))

    def speaks(self, at: int) -> bool:
        """Whether a word speaks for a deed of the plan."""
        return any(self.evidence.speaks_for(self.norm(at), deed) for deed in self.deeds)

    @cached_property
    def orders(self) -> frozenset[int]:
        """The first words of clauses that say something: there stands what shall be done."""
        words = sorted(at for at, _ in content(self.turn.tokens, self.language))
        firsts = (
            next((at for at in words if start <= at < end), -1) for start, end in self.clauses
        )
        return frozenset(firsts)

    @cached_property
    def clauses(self) -> list[tuple[int, int]]:
        """Where clauses begin and end, as far as marks and words that join them tell."""
        joins = self.language.words_called("joins")
        bounds = [0]
        for at, token in enumerate(self.turn.tokens):
            if token.kind == "mark" or (token.norm in joins and at):
                bounds.append(at + (token.kind == "mark"))
        bounds.append(len(self.turn.tokens))
        return [(start, end) for start, end in itertools.pairwise(bounds) if end > start]

    def certain(self, sorts: frozenset[str]) -> Iterator[Mention]:
        """Mentions that are no part of a longer one and no guess."""
        found = [each for each in self.turn.mentions if each.sort in sorts and each.cost < _SURE]
        for each in found:
            span = {*range(each.start, each.end)}
            if not any(span < {*range(other.start, other.end)} for other in found if other != each):
                yield each

    def unheeded_turns(self) -> Iterator[Objection]:
        """Words that turn the sense, but for a "not" in what speakers say of themselves."""
        for at in self.turning:
            if not self.is_own(at):
                yield Objection("unheeded", self.norm(at))

    @cached_property
    def turning(self) -> tuple[int, ...]:
        """Where words stand that turn the sense, where nothing in the plan is so turned."""
        words = self.weighty
        shown: tuple[tuple[frozenset[str], frozenset[str]], ...] = (
            (words.negations, frozenset({NEGATES, OTHERWISE, DECIDES})),
            (words.conditions, _ANSWERING_IF),
            (words.otherwise, frozenset({OTHERWISE, DECIDES})),
            (words.exceptions, frozenset({DECIDES, NEGATES, COMPARES, UNTIL})),
            (words.rounds, _GOING_ROUND),
        )
        return tuple(
            at
            for at, token in enumerate(self.turn.tokens)
            if at not in self.used and self.matters(at)
            for turning, by in shown
            if token.norm in turning and not self.deeds & by
            if turning is not words.rounds or not self.lists()
        )

    def is_own(self, at: int) -> bool:
        """Whether this is a "not" in a clause in which speakers say what they do, can or know."""
        start, end = next((s, e) for s, e in self.clauses if s <= at < e)
        return self.norm(at) in self.weighty.negations and any(
            self.norm(place) in self.weighty.speakers for place in range(start, end)
        )

    def lists(self) -> bool:
        """Whether it deals with several one by one, without a loop."""
        lists = sum(isinstance(each, Items) for each in nodes(self.plan.steps))
        said = [each for each in nodes(self.plan.steps) if isinstance(each, Call | Ask)]
        methods = [each.method for each in said]
        return bool(lists) or any(methods.count(method) > 1 for method in {*methods})

    # --- what became of the words

    @cached_property
    def used(self) -> frozenset[int]:
        """The tokens that a literal came from."""
        return frozenset(at for each in self.sources.found for at in each.tokens)

    @cached_property
    def left(self) -> list[int]:
        """The places of words that neither a literal came from, nor speak for a deed of the
        plan."""
        return [at for at in content_left(self.turn, self.used) if not self.speaks(at)]

    @cached_property
    def unused(self) -> tuple[str, ...]:
        return tuple(self.turn.tokens[at].spelled or self.norm(at) for at in self.left)

    def norm(self, at: int) -> str:
        return self.turn.tokens[at].norm


def _akin(method: str) -> frozenset[str]:
    return next((group for group in _AKIN if method in group), frozenset({method}))
