"""Text of any length as a slot of the rules: where it may end, and what that costs.

A text ends rather before what begins like another command, a condition or a piece of news than
behind it, and every word of it costs, so that what a rule understands is never swallowed.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import Final

from grammar.chart import Match
from grammar.language import Language
from grammar.phrases import Phrases
from grammar.roles import ANYBODY
from grammar.slips import command_words
from grammar.texts.judging import Judge
from grammar.tokens import COLON, COMMA, STOP, Token

FREE_WORD: Final = 1.0
"""Cost of a word that only an open slot understands."""
REST_WORD: Final = 0.2
"""Cost of a word of what is read once more by itself."""
SWALLOWED_COMMAND: Final = 40.0
"""Cost of a text that goes on over what begins like another command."""
ASKED_IN_TEXT: Final = 12.0
"""Cost of a text that begins as a question put to the robot does: "who is there"."""
BEHIND_GREETING: Final = 8.0
"""Cost of a text that goes on where a greeting ends: "good night in ward b" is said there."""
ASKED_ON: Final = 6.0
"""Cost of a text that goes on over a second question: "... and how much"."""
RECEIVER_IN_TEXT: Final = 4.0
"""Cost of a text that begins with the one it is told to: "ihr ihre Proben sind fertig"."""
QUOTED: Final = 0.01
"""Cost of a quotation that is read as a text: rather as a quotation."""
NAME_ALONE: Final = 12.0
"""Cost of a text that is no more than the name of whom it is told to: "sag Bob, um vier ..."."""

LONGEST_RECEIVER: Final = 4
"""Words of a name that nobody knows, with what stands before it: "au docteur Ostrowski"."""


class OpenText:
    """The open slots over the tokens of one sentence."""

    def __init__(self, tokens: Sequence[Token], language: Language, judge: Judge) -> None:
        self.tokens = tokens
        self.words = _words_of(language)
        self._language = language
        self.judge = judge
        self._command_words = command_words(language)
        self._infinitive = language.speech.get("infinitive")  # "s'il préfère jouer ou lire"

    def text(self, at: int) -> list[Match]:
        """Free text of any length; it costs more where it goes on over another command."""
        words = self.words
        matches: list[Match] = []
        if self._names_receiver(at):
            return []
        cost = ASKED_IN_TEXT if self.judge.asks(at, len(self.tokens)) else 0.0
        if self.judge.given_to(at) or self._never_first(at):
            cost += RECEIVER_IN_TEXT
        greeted = {at + self.judge.complete_greeting(at)} - {at}
        that = self.judge.words.that
        named = at + self.judge.people.longest(self.judge.all_norms, at)
        reported = self.tokens[at].norm in that or (at > 0 and self.tokens[at - 1].norm in that)
        requests = {token.norm for token in self.tokens[max(at - 1, 0) : at + 1]}
        asked = not requests.isdisjoint(self.judge.words.requests) and not self._in_question(at)
        for position in range(at, len(self.tokens)):
            token = self.tokens[position]
            if position in greeted:
                cost += BEHIND_GREETING
            if position > at and self.judge.joined(position, at):  # "3, 2, 1, happy new year"
                greeted.add(position + self.judge.complete_greeting(position))
            if token.kind == "mark":
                if position == at:
                    return []
                goes_on = self._goes_on(position + 1) and not (
                    asked and self.judge.asked_again(position + 2)
                )
                if goes_on or self._is_aside(at, position + 1):
                    break
                if token.norm == STOP:
                    if reported:
                        break  # what is told ends where its sentence does
                    if position + 1 < len(self.tokens) and self._condition(position + 1):
                        break
                    cost += 4.0
                continue
            if position > at and self._ends[position]:
                break
            if asked and (self.judge.asked_again(position) or self._lasts(position, at)):
                matches = []  # "to wait and to call", "to wait until three": one request
            elif position > at and self._others[position]:
                cost += SWALLOWED_COMMAND
            if position > at + 1 and self._asks_on[position]:
                cost += ASKED_ON
            if token.norm in words.unfinished:
                cost += FREE_WORD
                continue
            if token.norm in words.fillers:  # part of the text only if more text follows
                ends = 0.0 if token.norm in words.spoken_fillers else 0.3
                if self._keeps_filler(at, position):
                    ends, matches = 0.0, [match for match in matches if match[0] != position]
                matches.append((position + 1, cost + ends, None))
                continue
            cost += QUOTED if token.kind == "quote" else FREE_WORD
            alone = NAME_ALONE if position + 1 == named and self._is_told(named) else 0.0
            matches.append((position + 1, cost + alone, None))
            if token.kind == "quote" and position == at:
                break  # what is quoted is the whole text
        return matches

    def _lasts(self, at: int, start: int) -> bool:
        """Whether it is said here until when somebody is to do what they are asked to do."""
        return at > start and self.tokens[at].norm in self.judge.words.until

    @functools.cached_property
    def _ends(self) -> list[bool]:
        """For each token: whether no text goes on over what begins here."""
        return [
            at > 0 and (self._begins_news(at) or self._only_if(at))
            for at in range(len(self.tokens))
        ]

    @functools.cached_property
    def _others(self) -> list[bool]:
        """For each token: whether another command or a condition of its own begins here."""
        return [
            at > 0 and (self._begins_command(at) or self._condition(at))
            for at in range(len(self.tokens))
        ]

    @functools.cached_property
    def _asks_on(self) -> list[bool]:
        """For each token: whether a question that begins another goes on here: "... and how much
        it hurts"."""
        asking = self.judge.words.asking | self.judge.words.that
        return [
            at > 0 and token.norm in asking and self.tokens[at - 1].norm in self.words.joins
            for at, token in enumerate(self.tokens)
        ]

    def _is_told(self, at: int) -> bool:
        """Whether what somebody is told begins here, behind their name."""
        return at < len(self.tokens) and self.tokens[at].norm in (COMMA, COLON)

    def _never_first(self, at: int) -> bool:
        """Whether a pronoun stands here that no statement begins with: "mir dann, wer da ist"."""
        before = self.tokens[at - 1] if at else None
        told = before is not None and before.kind != "mark"
        reported = before is not None and before.norm in self.judge.words.that
        return told and not reported and self.tokens[at].norm in self.judge.words.never_first

    def _names_receiver(self, at: int) -> bool:
        """Whether what begins here belongs to whom something is told, since nobody knows them:
        "tell Doctor Ostrowski that the results are in", "tell Doctor Ostrowski the results are in";
        but not "tell the visitor Zoe is here"."""
        first = self.tokens[at]
        like_a_name = first.norm in self.words.to_whom or self._is_unknown(at) or first.capital
        if at < 1 or not like_a_name or first.norm in self.judge.words.definite:
            return False
        for position in range(at + 1, min(at + LONGEST_RECEIVER + 1, len(self.tokens))):
            token, before = self.tokens[position], self.tokens[position - 1]
            if token.kind != "word" or before.kind != "word":
                break
            if first.norm in self.words.to_whom and self.judge.asks_to(position):
                return True  # "dis à Bob de venir et d'attendre"
            if token.norm in self.judge.words.that and before.norm not in self._language.closed:
                return not self.judge.is_clause(at, position)
        titled = self.tokens[at - 1].norm in self.words.titles
        bare = at < 2 or self.tokens[at - 2].norm not in self.judge.words.definite
        return titled and bare and first.capital and self._is_unknown(at)

    def _is_unknown(self, at: int) -> bool:
        token = self.tokens[at]
        known = token.norm in self._language.words or token.norm in self._language.closed
        return token.kind == "word" and not known

    @functools.cached_property
    def _filler_words(self) -> frozenset[int]:
        """The tokens that belong to whole fillers: "tout" in "tout de suite", not in "tout va"."""
        norms = self.judge.all_norms
        return frozenset(
            at + more
            for at in range(len(norms))
            for length in self.words.whole_fillers.lengths(norms, at)
            for more in range(length)
        )

    def _keeps_filler(self, at: int, position: int) -> bool:
        """Whether a filler is part of the text that it ends: "the new robot", "dinner is ready
        right now", and anything after a colon ("show: back right now")."""
        words = self.words
        norm = self.tokens[position].norm
        if position == at or norm in words.not_kept or position not in self._filler_words:
            return False
        if self.tokens[at - 1].norm == COLON:
            return True
        if norm in words.time_fillers and self.judge.is_clause(at, position):
            return True
        before = {token.norm for token in self.tokens[max(at, position - 2) : position]}
        return norm in words.noun_fillers and not before.isdisjoint(self.judge.words.definite)

    def remark(self, at: int) -> list[Match]:
        """Words up to the end of a clause: no punctuation, and nothing that is to be done."""
        matches: list[Match] = []
        for position in range(at, len(self.tokens)):
            token = self.tokens[position]
            if token.norm in self.words.duties:
                return []
            # Where it begins, its rule has said that no order does.
            other = position > at and self._begins_command(position)
            if token.kind in ("mark", "quote") or other:
                break
            matches.append((position + 1, FREE_WORD * (position + 1 - at), None))
        return matches

    def rest(self, at: int) -> list[Match]:
        """Any words at all, for what is read once more by itself."""
        return [
            (end, REST_WORD * (end - at), None)
            for end in range(at + 1, len(self.tokens) + 1)
            if self.tokens[end - 1].kind != "mark" and self.tokens[at].kind != "mark"
        ]

    # --- what begins at a token

    def _begins_news(self, at: int) -> bool:
        """Whether something is said that is never part of a text: "... and tell me"."""
        before = self.tokens[at - 1].norm
        if before not in (COMMA, STOP, COLON) and before not in self.words.joins:
            return False
        return self.judge.begins(self.words.news, at)

    def _only_if(self, at: int) -> bool:
        """Whether it is said at the end of a clause for which answer it is: "... if not"."""
        lengths = self.words.answer_tails.lengths(self.judge.all_norms, at)
        return any(self._clause_ends(at + length) for length in lengths)

    def _clause_ends(self, at: int) -> bool:
        if at >= len(self.tokens):
            return True
        return self.tokens[at].kind == "mark" or self.tokens[at].norm in self.words.joins

    def _goes_on(self, at: int) -> bool:
        """Whether after a comma or full stop something else is said to be done: ", then"."""
        return at < len(self.tokens) and self.tokens[at].norm in self.words.ends

    def _is_aside(self, begin: int, at: int) -> bool:
        """Whether somebody says where they are behind a question that they have asked: "ask Bob
        whether he is hungry, I'm in the lobby"."""
        if at + 1 >= len(self.tokens):
            return False
        speaks = self.tokens[at].norm in self.words.speakers
        staying = self.tokens[at + 1].norm in self.words.staying
        return speaks and staying and self._in_question(begin)

    def _in_question(self, at: int) -> bool:
        """Whether a question has begun before in the clause here: "whether he wants to ..."."""
        clause = takewhile(lambda token: token.kind != "mark", reversed(self.tokens[:at]))
        asking = self.judge.words.asking | self.words.elided_if
        return any(token.norm in asking for token in clause)

    def _condition(self, at: int) -> bool:
        """Whether a condition of its own begins: "and if so, ...", "Otherwise ..."."""
        if self.tokens[at].norm not in self.words.conditions:
            return False
        before = self.tokens[at - 1]
        return before.norm in self.words.joins or before.kind == "mark"

    def _begins_command(self, at: int) -> bool:
        before = self.tokens[at - 1].norm
        if before not in (COMMA, STOP, COLON) and before not in self.words.joins:
            return False
        norm = self.tokens[at].norm
        if self._infinitive and before in self.words.or_ and re.search(self._infinitive, norm):
            return False
        if norm in self._command_words:
            return not self.judge.wished(at)
        return self.judge.order(at, len(self.tokens))


@dataclass(frozen=True)
class _Words:
    """What the data of a language say about where texts end."""

    joins: frozenset[str]
    or_: frozenset[str]
    ends: frozenset[str]
    """What follows a comma where something else is to be done: "then"."""
    conditions: frozenset[str]
    duties: frozenset[str]
    not_kept: frozenset[str]
    """Fillers that are never part of the text before them."""
    unfinished: frozenset[str]
    """Words that no text ends with."""
    fillers: frozenset[str]
    whole_fillers: Phrases
    spoken_fillers: frozenset[str]
    noun_fillers: frozenset[str]
    time_fillers: frozenset[str]
    to_whom: frozenset[str]
    elided_if: frozenset[str]
    speakers: frozenset[str]
    staying: frozenset[str]
    titles: frozenset[str]
    """Words for people that may stand before a name: "doctor"."""
    news: Phrases
    answer_tails: Phrases


@functools.cache
def _words_of(language: Language) -> _Words:
    def single(name: str) -> frozenset[str]:
        return frozenset(map(str, language.speech.get(name, ())))

    def phrases(name: str) -> Phrases:
        return Phrases(str(entry).split() for entry in language.speech.get(name, ()))

    def within(kind: str, name: str) -> frozenset[str]:
        listed = language.speech.get(kind, {}).get(name, ())
        return frozenset(token for each in listed for token in language.tokens_of(str(each)))

    return _Words(
        joins=single("joins"),
        or_=single("or"),
        ends=single("text_ends"),
        conditions=single("condition_words"),
        duties=single("duties"),
        not_kept=single("joins") | single("text_ends"),
        unfinished=single("unfinished"),
        fillers=frozenset(word for filler in language.fillers for word in filler),
        whole_fillers=Phrases(language.fillers),
        spoken_fillers=single("spoken_fillers"),
        noun_fillers=single("noun_fillers"),
        time_fillers=single("time_fillers"),
        to_whom=within("free_text", "to_whom"),
        elided_if=within("free_text", "elided_if"),
        speakers=within("weighty", "speakers"),
        staying=within("weighty", "staying"),
        titles=frozenset(
            words[0]
            for kind, ways in language.lists.get("person_kind", {}).items()
            for words in ways
            if len(words) == 1 and kind != ANYBODY
        ),
        news=phrases("news_begins"),
        answer_tails=phrases("answer_tails"),
    )
