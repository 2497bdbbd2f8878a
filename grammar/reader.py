"""Reads one sentence, by the rules of its language.

    tokens -> the cheapest reading of all words -> its meaning: a plan

A sentence is understood as a whole or not at all: every word is covered by a rule, by a slot, or is
one of the words that say nothing. What is not understood is named, with the nearest phrases that
would be.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import msgspec

import grammar.meanings.all_meanings  # noqa: F401 (what the rules name is entered there)
from grammar.chart import Chart, Node, TooMuch
from grammar.company import in_company
from grammar.coverage import in_manner, left_out, no_nouns, unheeded, unspoken
from grammar.discourse import Discourse
from grammar.errors import Ambiguous, NotUnderstood
from grammar.language import Language, speech
from grammar.lexicon import Lexicon
from grammar.meanings.offers import with_offers_kept
from grammar.memory import Command, Deliveries, People, Scene
from grammar.names import Names
from grammar.naming import joined_up, naming, place_called
from grammar.number_options import with_numbers
from grammar.plan import Ask, Call, Plan, Text, Value
from grammar.planning.by_the_clock import by_the_clock
from grammar.plausible import implausible
from grammar.prepared import prepared
from grammar.refusals import (
    forbidden,
    is_half,
    misturned,
    no_thing,
    not_said,
    out_of_range,
    strange,
    why_not,
)
from grammar.reminders.reminding import reminding
from grammar.report_after_loop import told_when_all_are_asked
from grammar.requests import Request
from grammar.samples import nearest_phrases
from grammar.slots import Slots
from grammar.texts.judging import Doubt, doubtful
from grammar.texts.words import words_for
from grammar.tidy import Unbound, charging_last, is_one_of_each, returning, scoped, without_unused
from grammar.tokens import COMMA, Token
from grammar.trace import read
from grammar.traversal import nodes
from grammar.understanding import Clarification, Context, Understanding, rejected

_log: Final = logging.getLogger(__name__)


MOST_SUGGESTIONS: Final = 3


EMERGENCY: Final = "emergency"
"""The answer that matters more than why a sentence is refused."""


class SentenceReader:
    """Reads one sentence."""

    def __init__(self, text: str, lexicon: Lexicon, language: Language, context: Context) -> None:
        self.lexicon = lexicon
        self.language = language
        self.context = context
        self._prepared = prepared(text, lexicon, language)
        self.names: Names = self._prepared.names
        self.text, self.slips = self._prepared.text, self._prepared.slips
        self.tokens = self._prepared.tokens
        self.corrections, self.skips = self._prepared.corrections, self._prepared.skips

    def understand(self) -> Understanding:
        if not self.tokens:
            return rejected(self.text, self.language.phrase("empty"), self.context)
        understood = self._understood()
        if understood.status == "rejected":
            why = why_not(self.tokens, self.language, self.names.called)
            if why == EMERGENCY:
                return rejected(self.text, self.language.phrase(why), self.context)
        return understood

    def _understood(self) -> Understanding:
        no = forbidden(self.tokens, self.language)
        if no is not None:
            return rejected(self.text, self.language.phrase(no), self.context)
        chart = self.chart()
        try:
            tree = chart.best("utterance")
        except (TooMuch, RecursionError):
            return rejected(self.text, self.language.phrase("too_complicated"), self.context)
        if tree is None:
            return self._not_understood(chart)
        understood = self._meant(tree, chart)
        return replace(understood, parts=read(tree, self.tokens, self.text))

    def _meant(self, tree: Node, chart: Chart) -> Understanding:
        """What a reading means."""
        discourse = Discourse(
            self.language,
            self.lexicon,
            self.tokens,
            self.text,
            scene=Scene(
                thing=self.context.thing, person=self.context.person, place=self.context.place
            ),
            people=People(named=tuple(self._named_before())),
            deliveries=Deliveries(source=self.context.source),
            command=Command(origin=self.context.origin),
        )
        if "request" in tree.parts:
            asked: Request = discourse.build(tree.parts["request"])
            return Understanding(
                self.text,
                "ok",
                confidence=self._confidence(tree, discourse),
                request=asked,
                context=self.context,
            )
        try:
            steps = with_offers_kept(discourse, discourse.build(tree.parts["steps"]))
            if discourse.deliveries.collected is not None:
                raise NotUnderstood(self.language.phrase("one_thing"))
        except NotUnderstood as reason:
            return self._refused(reason)
        except Ambiguous as which:
            return self._ask_back(which)
        except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
            # A meaning that stumbles is a mistake of ours; the person gets an answer all the same.
            _log.exception("Nothing could be made of %r", self.text)
            return rejected(self.text, self.language.phrase("too_complicated"), self.context)
        if not steps:
            return self._asking_nothing(chart)
        steps, unused = in_manner(
            steps, tree, self.tokens, self.language, discourse.command.resolved
        )
        unused += unheeded(tree, self.tokens, self.language)
        try:
            plan = scoped(
                Plan(
                    (*discourse.prologue(), *steps),
                    self.language.code,
                    (*discourse.background, *unused),
                )
            )
        except Unbound:
            return rejected(self.text, self.language.phrase("too_complicated"), self.context)
        plan = told_when_all_are_asked(plan, discourse)
        if not is_one_of_each(plan):
            return rejected(self.text, self.language.phrase("too_complicated"), self.context)
        doubt = doubtful(tree, self.tokens, self.language, self.names.people)
        if doubt is not None:
            return self._doubted(doubt)
        plan = without_unused(plan)  # what came to nothing is lost, too
        plan = by_the_clock(charging_last(returning(with_numbers(in_company(plan)))))
        plan = reminding(plan, discourse)
        resolved = discourse.command.resolved
        lost = left_out(tree, self.tokens, plan, self.language, self.lexicon, resolved)
        lost += unspoken(tree, self.tokens, plan, self.language, resolved)
        lost += no_nouns(plan, self.tokens, self.language, self.names.words)
        if lost:
            words = " ".join(lost)
            message = self.language.phrase("not_understood", part=words)
            return replace(rejected(self.text, message, self.context), unclear=words)
        impossible = no_thing(plan, self.lexicon, self.language)
        if impossible is not None:
            message, thing = impossible
            return replace(rejected(self.text, message, self.context), unclear=thing)
        wrong = misturned(plan, self.language, self.text)
        if wrong is not None:
            message = self.language.phrase("not_understood", part=wrong)
            return replace(rejected(self.text, message, self.context), unclear=wrong)
        hurtful = not_said(plan, self.lexicon, self.language)
        if hurtful is not None:
            return rejected(self.text, self.language.phrase(hurtful), self.context)
        beyond = out_of_range(plan, self.language)
        if beyond is not None:
            return rejected(self.text, beyond, self.context)
        senseless = implausible(plan)
        if senseless is not None:
            message = self.language.phrase(senseless.value)
            return rejected(self.text, message, self.context)
        plan = _without_heeded(plan, discourse)
        return Understanding(
            self.text,
            "ok",
            plan,
            self._confidence(tree, discourse),
            context=Context(
                plan,
                self.text,
                thing=discourse.scene.thing,
                person=discourse.scene.person,
                place=discourse.scene.place if isinstance(discourse.scene.place, Text) else None,
                source=_source(discourse),
                before=self.context.referents(),
            ),
        )

    def _named_before(self) -> list[str]:
        """Who was spoken of by name in the command before: "him" is whoever of them is a man."""
        people = {each.name for each in self.lexicon.people}
        plan = self.context.plan
        said = nodes(plan.steps) if plan is not None else ()
        names = (each.value for each in said if isinstance(each, Text) and each.value in people)
        return list(dict.fromkeys(names))

    def _confidence(self, tree: Node, discourse: Discourse) -> float:
        doubts = 0.15 * (len(tree.corrections) + self.slips) + 0.1 * len(discourse.assumptions)
        return round(max(0.1, 1.0 - doubts), 2)

    def is_little(self, positions: range) -> bool:
        """Whether these tokens are function words, such as "to"."""
        return all(
            position >= 0 and self.tokens[position].norm in self.language.closed
            for position in positions
        )

    def content(self, start: int, end: int) -> set[str]:
        """The words among these tokens that are no function words."""
        return {
            token.norm
            for at, token in enumerate(self.tokens[start:end], start)
            if token.kind != "mark"
            and token.norm not in self.language.closed
            and (at not in self.skips)
        }

    @property
    def lead(self) -> int:
        """How many function words it begins with."""
        count = 0
        while count < len(self.tokens) and self.is_little(range(count, count + 1)):
            count += 1
        return count

    def opened(self, first: int) -> str:
        """What of a contraction stands before a token that is a part of it: "zu" of "zur"."""
        if first >= len(self.tokens):
            return ""
        begin = self.tokens[first].start
        return " ".join(token.norm for token in self.tokens[:first] if token.start == begin)

    def with_words(self, first: int, last: int, words: str, *, noun: bool = False) -> str:
        """The sentence with other words in the place of some tokens; a noun gets the case that the
        word before it asks for."""
        opened = self.opened(first)
        if noun and first:
            mark = self.language.speech.get("cases", {}).get(self.tokens[first - 1].norm, "")
            words = joined_up(f"{opened} {mark}{words}".strip(), self.language)
        elif opened:
            words = f"{opened} {words}"
        return (
            self.text[: self.tokens[first].start] + words + self.text[self.tokens[last - 1].end :]
        )

    @property
    def reads(self) -> bool:
        """Whether rules can make something of all its words, whatever it would mean."""
        try:
            return self.chart().best("utterance") is not None
        except (TooMuch, RecursionError):
            return False

    @property
    def refuses_with_reason(self) -> bool:
        """Whether it is known why nothing comes of it: a command that was read as one, or that is
        none of the robot's business."""
        why = why_not(self.tokens, self.language, self.names.called)
        no = forbidden(self.tokens, self.language)
        return self.reads or no is not None or why != "not_understood_at_all"

    @property
    def slots(self) -> Slots:
        return self._prepared.slots

    def chart(self) -> Chart:
        return self._prepared.chart

    @property
    def last_word(self) -> int:
        """How many tokens there are without the punctuation at the end."""
        count = len(self.tokens)
        while count and self.tokens[count - 1].kind == "mark":
            count -= 1
        return count

    # --- after parsing

    def _refused(self, reason: NotUnderstood) -> Understanding:
        message = reason.message
        suggestions: list[str] = []
        if reason.span != (0, 0) and not reason.nearest:
            message = f"{message} {self.language.phrase('ask_for_names')}"
        if reason.nearest:
            names = [place_called(name, self.lexicon, self.language) for name in reason.nearest]
            choices = self.language.phrase("did_you_mean", choices=self.alternatives(names))
            message = f"{message} {choices}"
            first, last = reason.span
            articles = self.language.speech.get("articles", ())
            if first and self.tokens[first - 1].norm in articles:  # a name brings its own
                first -= 1
            suggestions = [self.with_words(first, last, name, noun=True) for name in names]
        return Understanding(
            self.text,
            "rejected",
            message=message,
            suggestions=suggestions,
            unclear=self.words(*(reason.span if reason.span != (0, 0) else reason.gap)),
            context=replace(self.context, question=self._open(reason)),
        )

    def _open(self, reason: NotUnderstood) -> Clarification | None:
        """What an answer to a refusal may still complete: "the lobby", after an unknown place."""
        first, last = reason.span if reason.span != (0, 0) else reason.gap
        if first >= last:
            return None
        names = (place_called(name, self.lexicon, self.language) for name in reason.nearest)
        before = self.opened(first)
        return Clarification(
            self.text,
            self.tokens[first].start,
            self.tokens[last - 1].end,
            tuple(names),
            f"{before} " if before else "",
            reason.message,
            asked=False,
        )

    def _doubted(self, doubt: Doubt) -> Understanding:
        """Words that may be meant to be said, or may not: quotation marks would tell."""
        part = self.words(doubt.start, doubt.end)
        quoted = ""
        first, last = doubt.text
        if doubt.quoted and '"' not in self.text:
            if first > 0 and self.tokens[first - 1].norm in words_for(self.language).that:
                first -= 1
            said = self.words(*doubt.text)
            quoted = self.with_words(first, last, f'"{said}"')
        return Understanding(
            self.text,
            "rejected",
            message=self.language.phrase(doubt.phrase, part=part),
            unclear=part,
            quoted=quoted,
            context=self.context,
        )

    def alternatives(self, names: Sequence[str]) -> str:
        """ "ward a, ward b or ward c"."""
        if len(names) < 2:
            return "".join(names)
        return f"{', '.join(names[:-1])} {self.language.phrase('or')} {names[-1]}"

    def _ask_back(self, which: Ambiguous) -> Understanding:
        whole = self._longer_name(which)
        if whole is not None:
            message = self.language.phrase("unknown_place", name=self.words(*whole))
            return self._refused(NotUnderstood(message, span=whole))
        end = self.tokens[which.end - 1].end
        start = self.tokens[which.start].start if which.start < which.end else end
        before = self.opened(which.start)
        question = Clarification(
            self.text,
            start,
            end,
            which.choices,
            f"{before} " if before else "",
            which.question,
        )
        return Understanding(
            self.text,
            "clarify",
            message=which.question,
            suggestions=[
                joined_up(question.completed(choice), self.language)
                for choice in which.choices[:MOST_SUGGESTIONS]
            ],
            unclear=self.text[start:end],
            context=replace(self.context, question=question),
        )

    def _longer_name(self, which: Ambiguous) -> tuple[int, int] | None:
        """The tokens of the name that the unclear words are only a part of, of a place that nobody
        knows here: "the meeting [room]", "[room] 101"."""
        called = naming(self.lexicon, self.language).called
        places = {called(each.name) for each in self.lexicon.places}
        if which.start >= which.end or not places.issuperset(which.choices):
            return None
        people = {
            word for each in self.lexicon.people for word in self.language.tokens_of(each.name)
        }
        known = (self.language.words, self.language.closed, people)
        first, last = which.start, which.end
        while first and self.tokens[first - 1].kind == "word":
            if any(self.tokens[first - 1].norm in words for words in known):
                break
            first -= 1
        if last < self.last_word and self.tokens[last].kind == "number":
            # "room 101 that ..."; "the room 3 times" is said of the room.
            behind = self.tokens[last + 1 : last + 2]
            if all(each.kind == "mark" or each.norm in self.language.closed for each in behind):
                last += 1
        return (first, last) if (first, last) != (which.start, which.end) else None

    def _not_understood(self, chart: Chart) -> Understanding:
        """Name the first words that no reading could use."""
        begun = self._begun(chart)
        part = self._ununderstood_part(begun)
        message = self._why_not(part)
        unclear = part or self.text
        # Who was told why not needs no other sentence with a word of theirs in it.
        mine = part or message == self.language.phrase("not_understood_at_all")
        suggestions = (
            nearest_phrases(unclear, self.text, self.lexicon, self.language) if mine else []
        )
        if suggestions:
            quoted = speech(self.language.code).values["quoted"]
            examples = self.alternatives([quoted.format(text=each) for each in suggestions])
            message = f"{message} {self.language.phrase('try_this', examples=examples)}"
        return Understanding(
            self.text,
            "rejected",
            message=message,
            suggestions=suggestions,
            parts=read(begun, self.tokens, self.text) if begun and part else [],
            unclear=part or self.text.strip(),
            context=self.context,
        )

    def _asking_nothing(self, chart: Chart) -> Understanding:
        """Nothing but remarks: all of it was read, and there is nothing to do."""
        answer = self._not_understood(chart)
        if answer.message == self.language.phrase("not_understood_at_all"):
            return replace(answer, message=self.language.phrase("asks_nothing"))
        return answer

    def _why_not(self, part: str) -> str:
        """Which part was not understood; of a sentence that is none of its business, why."""
        if part:
            return self.language.phrase("not_understood", part=part)
        phrase = why_not(self.tokens, self.language, self.names.called)
        if phrase == "not_understood_at_all" and is_half(
            self.tokens, self.language, self.names.called
        ):
            return self.language.phrase("unfinished", part=self.text.strip(" .!?"))
        words = strange(self.tokens, lambda token: not self._is_unknown(token))
        if phrase == "not_understood_at_all" and words is not None:
            return self.language.phrase("unknown_word", part=self.words(*words))
        return self.language.phrase(phrase)

    def _begun(self, chart: Chart) -> Node | None:
        """The longest beginning that is a sentence in itself."""
        try:
            return chart.longest("utterance", 0)
        except TooMuch:
            return None

    def _ununderstood_part(self, begun: Node | None) -> str:
        first = begun.end if begun is not None else 0
        while first < len(self.tokens) and self.tokens[first].kind == "mark":
            first += 1
        if first == 0 or first >= len(self.tokens):
            return ""
        # An unknown verb may have passed for a part of the noun before it: "the cup and lick | it".
        joins = {COMMA, *self.language.speech.get("joins", ())}
        start = first
        while start and self._is_unknown(self.tokens[start - 1]):
            start -= 1
        if start and self.tokens[start - 1].norm in joins:
            first = start
        last = first
        while last < len(self.tokens) and self.tokens[last].kind != "mark":
            last += 1
        return self.text[self.tokens[first].start : self.tokens[last - 1].end]

    def _is_unknown(self, token: Token) -> bool:
        known = (self.language.words, self.language.closed, self.names.words)
        return token.kind == "word" and not any(token.norm in words for words in known)

    def words(self, start: int, end: int) -> str:
        return self.text[self.tokens[start].start : self.tokens[end - 1].end] if end > start else ""


def _source(discourse: Discourse) -> Value | None:
    """Where the thing spoken of was taken from, as far as that is a place by name."""
    thing = discourse.scene.thing
    places = (
        thing.place if thing else None,
        discourse.scene.at_pick_up,
        discourse.deliveries.source,
    )
    return next((place for place in places if isinstance(place, Text)), None)


def _without_heeded(plan: Plan, discourse: Discourse) -> Plan:
    """The plan without those remarks that it heeds: it looks where somebody was said to be."""
    known = {
        node.arguments.get("place")
        for node in nodes(plan.steps)
        if isinstance(node, Call | Ask) and node.method in ("find", "goto")
    }
    heeded = {said for said, place in discourse.whereabouts if place in known}
    background = tuple(each for each in plan.background if each not in heeded)
    return msgspec.structs.replace(plan, background=background)
