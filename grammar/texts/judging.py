"""What free text may be: words to speak or to ask, and nothing that the robot was told to do.

A slot for free text takes any words, so that "say good morning and peel an orange" could be read as
six words to speak. A text that goes on over what sounds like an order ("and peel an orange"), asks
for something the robot would have to find out ("who said yes", "the total"), speaks of the robot's
way back ("when you are back") or of how something is done ("in ten minutes", "without shouting") is
doubted: the sentence is then refused with these words. A quotation is never doubted.

The words this goes by are the language's own: `free_text` in its data.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import takewhile
from typing import Final

from grammar.chart import Leaf, Node
from grammar.language import Language
from grammar.phrases import Phrases
from grammar.texts.words import words_for
from grammar.tokens import COLON, COMMA, STOP, Token

SPOKEN: Final = frozenset({"say", "say_that"})
WRITTEN: Final = frozenset({"show"})
"""Meanings whose text is shown: doubted where it names something instead: "the lunch menu"."""
REQUESTED: Final = frozenset({"ask_to"})
MESSAGES: Final = REQUESTED | {"say_that"}
"""Meanings whose text is passed on to somebody."""
TOLD: Final = MESSAGES | {"ask"}
"""Those by which anything is."""
ANSWERS: Final = frozenset({"option_words", "said_so"})
ANSWERED: Final = ANSWERS | {"answered"}
INFINITIVE_WITHIN: Final = 5
"""Words: "de ne pas le lui dire"."""
NOBODY: Final = Phrases(())
QUIET: Final = frozenset({"remark", "remark_where", "remark_name", "refused"})
"""Meanings whose text asks for nothing."""


@dataclass(frozen=True)
class Doubt:
    """Some tokens of a text that may not be meant as text."""

    start: int
    end: int
    phrase: str
    """What the person is told (`Language.phrases`)."""
    quoted: bool
    """Whether quotation marks around the whole text would settle it."""
    text: tuple[int, int]
    """The tokens of the whole text."""


Doubting = Callable[[int, str], Doubt]
"""Doubts a text from a token on, with a phrase."""


def doubtful(
    tree: Node, tokens: tuple[Token, ...], language: Language, people: Phrases = NOBODY
) -> Doubt | None:
    """The first text of a reading that may not be meant as text."""
    judge = Judge(tokens, language, people)
    for node in _told(tree):
        at = judge.asked_on(node)
        if at is not None:
            return Doubt(at, len(tokens), "not_understood", False, (node.start, node.end))
    for node, leaf in _texts(tree):
        doubt = judge.doubt(node, leaf)
        if doubt is not None:
            return doubt
    return None


def _texts(node: Node) -> Iterator[tuple[Node, Leaf]]:
    for part in node.parts.values():
        if isinstance(part, Node):
            if part.means not in QUIET:
                yield from _texts(part)
        elif node.means not in QUIET and (part.slot == "text" or _is_said(node, part)):
            yield node, part


def _is_said(node: Node, part: Leaf) -> bool:
    return part.slot == "remark" and node.means == "say"  # "Bob sagt"


def _told(node: Node) -> Iterator[Node]:
    if node.means in TOLD:
        yield node
    for part in node.parts.values():
        if isinstance(part, Node):
            yield from _told(part)


class Judge:
    """Judges the texts of one sentence."""

    def __init__(
        self, tokens: Sequence[Token], language: Language, people: Phrases = NOBODY
    ) -> None:
        self.tokens = tokens
        self.people = people
        self.language = language
        self.words = words_for(language)
        self.joins = {*language.speech.get("joins", ())}
        self.all_norms = tuple(token.norm for token in tokens)
        self._greetings: dict[int, int] = {}

    def norms(self, start: int, end: int) -> tuple[str, ...]:
        return self.all_norms[start:end]

    def doubt(self, node: Node, leaf: Leaf) -> Doubt | None:
        start, end, words = leaf.start, leaf.end, self.words
        spoken = node.means in SPOKEN
        clause = start > 0 and self.tokens[start - 1].norm in self.words.that

        def doubt(first: int, phrase: str) -> Doubt:
            settled = spoken or node.means in WRITTEN
            if not settled or (not spoken and phrase != "cannot_show"):
                phrase = "not_understood"
            return Doubt(first, end, phrase, settled, (start, end))

        if self.tokens[start].kind == "quote":
            return doubt(start + 1, "said_or_done") if end > start + 1 else None
        hesitations = self.language.words_called("hesitations")
        for at in range(start, end):  # "that the, uh, the doctor is here": nobody says that again
            if self.tokens[at].norm in hesitations:
                return doubt(at, "not_understood")
        if leaf.slot == "remark":
            return doubt(start, "cannot_say") if self.calls_somebody(start, end) else None
        if not spoken and STOP in self.norms(start, end):  # a question ends where its sentence does
            stop = start + self.norms(start, end).index(STOP)
            return doubt(min(stop + 1, end - 1), "not_understood")
        for at in range(start + 1, end - 1):  # "lunch is ready. And everyone in the lobby"
            begun = self.tokens[at].norm == STOP and self.tokens[at + 1].norm in self.joins
            if begun and not self.is_clause(at + 2, end):
                return doubt(at + 1, "said_or_done")
        asked_to = node.means in REQUESTED and self.tokens[start - 1].norm in words.to
        if asked_to and self.tokens[start].norm in self.language.speech.get("articles", ()):
            return doubt(start, "not_understood")  # "tell Bob to the kitchen": no verb
        if node.means in REQUESTED and not self.has_infinitive(start, end):
            return doubt(start, "not_understood")  # "demande-lui d'abord s'il ...": no request
        last = self.tokens[end - 1].norm
        if last in self.joins | self.words.goes_on:
            return doubt(end - 1, "not_understood")  # "..., except"
        for at in range(start + 1, end) if spoken else ():  # "he mustn't eat and to lie down"
            if self.asked_again(at) and not self.asked_before(start, at - 1):
                return doubt(at, "not_understood")
        greeting = self.greeting(start) if spoken else 0
        for at in range(start + 1, end):
            if not self.joined(at, start):
                continue
            if not spoken and self.tokens[at].norm in self.words.conditions:
                return doubt(at - 1, "not_understood")
            if self.open_condition(at, end):
                return doubt(at - 1, "said_or_done")
            if self.order(at, end, strict=greeting > 0):
                if node.means in REQUESTED:
                    if self.about_addressed(at, end):
                        return doubt(at - 1, "said_or_done")
                elif not self.licensed(node, start, at):
                    return doubt(at - 1, "said_or_done")
        for at in range(start, end):
            if self.begins(words.back, at):
                return doubt(at, "said_or_done")
        if node.means == "show":
            for at in range(start + 1, end):
                if self.tokens[at].norm in self.words.screens:
                    return doubt(at, "not_understood")
        if not spoken and node.means not in REQUESTED:
            for at in range(start, end):
                if self.words.how.match(" ".join(self.norms(at, end))):
                    return doubt(at, "not_understood")
        if node.means in ANSWERED:
            for at in range(start, end):  # "if he says it's his chest": he says "my"
                if self.tokens[at].norm in words.reported:
                    return doubt(at, "not_understood")
        if node.means in ANSWERS:
            return self.answer(start, end, doubt, predicate=node.means == "said_so")
        before = self.tokens[start - 1].norm if start > 0 else ""
        announced = before == COLON
        announced |= before == COMMA and node.means == "say_that" and self.states(start, end)
        if (not spoken and node.means not in WRITTEN) or clause or announced:
            return None
        if self.tokens[start].norm in self.words.never_first | self.joins or self.given_to(start):
            return doubt(start, "cannot_say")
        if spoken and self.told_behind(start, end):  # "if he is there, that lunch is ready"
            return doubt(start, "said_or_done")
        if words.unsaid.longest(self.all_norms, start) > words.messages.longest(
            self.all_norms, start
        ):
            return doubt(start, "cannot_say")  # "say rather nothing"
        if node.means == "say" and self.calls_somebody(start, end):
            return doubt(start, "cannot_say")  # "sag Alice sie soll kommen"
        greeted = self.complete_greeting(start) if spoken else 0
        if 0 < greeted < end - start:  # "good morning to everyone who comes": to whom
            return doubt(start + greeted, "said_or_done")
        if node.production.fixed.get("wish"):  # "a nice weekend"
            no_wish = words.not_greeting | words.conditions | words.subordinating
            where = [at for at in range(start, end) if self.tokens[at].norm in no_wish]
            return doubt(where[0], "said_or_done") if where else None
        late = range(start + 1, end) if self.tokens[start].norm in words.not_greeting else ()
        if spoken and any(self.tokens[at].norm in words.that for at in late):
            return doubt(start, "said_or_done")  # "every ten minutes that the soup is ready"
        if self.is_clause(start, end):
            return None
        if spoken and self.asks(start, end):
            return doubt(start, "cannot_say")
        return self.fragment(node, start, end, doubt)

    def told_behind(self, start: int, end: int) -> bool:
        """Whether what is to be told begins behind a comma, and an aside stands before it."""
        return any(
            self.tokens[at - 1].norm == COMMA and self.tokens[at].norm in self.words.told
            for at in range(start + 2, end)
        )

    def has_infinitive(self, start: int, end: int) -> bool:
        """Whether what somebody is asked to do begins with a verb, in a language whose infinitives
        are known by their endings."""
        pattern = self.language.speech.get("infinitive")
        first = self.norms(start, min(end, start + INFINITIVE_WITHIN))
        return pattern is None or any(re.search(pattern, norm) for norm in first)

    def open_condition(self, at: int, end: int) -> bool:
        """Whether a condition begins here of which nothing is said that would then be so: "I am on
        my way, and if it is later than that, that I will come tomorrow"."""
        if self.tokens[at].norm not in self.words.conditions:
            return False
        if self.tokens[at - 1].norm not in self.joins:
            return False
        marks = (place for place in range(at, end) if self.tokens[place].kind == "mark")
        behind = next(marks, end) + 1
        return behind >= end or self.tokens[behind].norm in self.words.that

    def calls_somebody(self, start: int, end: int) -> bool:
        """Whether a text begins with the name of somebody of whom it says nothing, or ends with
        whom it is said to: they are told, and their name is no part of it."""
        words = self.words
        if self.tokens[start].norm in self.language.speech.get("robot_pronouns", ()):
            start += 1  # "sagst du Bob guten Morgen"
        name = self.people.longest(self.all_norms, start)
        behind = start + name
        if name and behind >= end:
            return True
        if name:
            after = self.tokens[behind].norm
            if after == COMMA:
                return bool({*self.norms(behind + 1, behind + 2)} & (words.asking | words.that))
            message = self.begins(words.messages, behind)
            if message or not (after in self.joins or after == "'s" or self.finite(behind)):
                return True
        to = (at for at in range(start + 1, end) if self.tokens[at].norm in self.words.not_greeting)
        named = any(at + 1 + self.people.longest(self.all_norms, at + 1) == end for at in to)
        return named and not self.is_clause(start, end)

    def states(self, start: int, end: int) -> bool:
        """Whether what somebody is told begins with where or when something is so: "in der Küche
        wartet Bob"."""
        words = self.words
        no_statement = words.that | words.subordinating | words.asking
        if self.tokens[start].norm not in words.not_greeting or not words.clauses:
            return False
        within = range(start + 1, end)
        return no_statement.isdisjoint(self.norms(start, end)) and any(
            self.finite(at) and not self.tokens[at].capital for at in within
        )

    def finite(self, at: int) -> bool:
        """Whether a verb of a clause stands here."""
        norm = self.tokens[at].norm
        found = norm in self.words.finite | self.words.verb_forms
        return found or self.words.finite_pattern.search(norm) is not None

    def given_to(self, start: int) -> bool:
        """Whether a pronoun stands here that something is given to, and not the subject of a text:
        "ihr einen Witz", but not "ihr seid toll"."""
        if self.tokens[start].norm not in self.words.datives or start + 1 >= len(self.tokens):
            return False
        after = self.tokens[start + 1].norm
        return after in self.words.definite | self.words.asking or self.greeting(start + 1) > 0

    def fragment(self, node: Node, start: int, end: int, doubt: Doubting) -> Doubt | None:
        """What is to be said and is no sentence: "good morning", "the total", "hello backwards"."""
        words = self.words
        if self.begins(words.exclaimed, start):
            return None
        first = self.tokens[start].norm
        if first in words.definite:
            return doubt(start, "cannot_show" if node.means == "show" else "cannot_say")
        if node.means == "show":
            return None
        for at in range(start + 1, end):
            if self.tokens[at].norm in words.that & words.subordinating:
                return doubt(start, "cannot_say")  # "Emma auf Französisch, dass ..."
        for at in range(start + 2, end):  # "good night, but not in ward b"
            so = self.tokens[at - 1].norm in self.joins and self.tokens[at].norm in words.manners
            if so and self.tokens[at - 2].norm == COMMA:
                return doubt(at - 1, "said_or_done")
        for at in range(start + 1, end):  # "good evening rather than good morning"
            if self.begins(words.instead, at):
                return doubt(at, "said_or_done")
        greeting = self.greeting(start)
        behind = start + greeting
        if self.begins(words.manner_first, start):
            return doubt(start, "said_or_done")  # "laut Achtung"
        if first in words.not_greeting:  # "say in the lobby": where, and not what
            return doubt(start, "said_or_done")
        if greeting and self.wished(start) and not self.complete_greeting(start):
            return None  # "welcome to our hospital"
        if greeting and behind < end and self.tokens[behind].norm in words.not_greeting:
            return doubt(behind, "said_or_done")
        if self.wished(start):
            return None  # "have a nice weekend"
        greeted = {
            at
            for first in range(start + 1, end)
            if self.joined(first, start)
            for at in range(first, first + self.greeting(first))
        }  # "3, 2, 1, happy new year"
        for at in range(start + 2, end):  # "happy new year, in the lounge": where
            if self.tokens[at - 1].norm == COMMA and self.tokens[at].norm in words.not_greeting:
                return doubt(at, "said_or_done")
        for at in range(max(behind, start + 1), end):
            if self.tokens[at].norm in words.manners and at not in greeted:
                return doubt(at, "said_or_done")
        whole = greeting or first in words.verbs or self.begins(words.messages, start)
        if words.clauses and node.means == "say_that" and not whole:
            return doubt(start, "cannot_say")
        return None

    def answer(self, start: int, end: int, doubt: Doubting, *, predicate: bool) -> Doubt | None:
        """An answer that somebody gave: "yes", "coffee"; not "yes and what share that is". Or what
        is true of somebody: "would like some water"."""
        words = self.words
        others = self.joins | words.asking | words.manners
        if self.tokens[start].norm in words.settled and end > start + 1:
            return doubt(start + 1, "not_understood")
        for at in range(start, end if not predicate else start):
            if self.tokens[at].norm in others:
                return doubt(at, "not_understood")
        return None

    def greeting(self, start: int) -> int:
        """How many tokens of a greeting begin here."""
        return self.words.greetings.longest(self.all_norms, start)

    def complete_greeting(self, start: int) -> int:
        """How many tokens of a greeting begin here that is said where what follows says: "good
        night" of "good night in ward b"; 0 if it goes on: "welcome to the ward"."""
        if start not in self._greetings:
            self._greetings[start] = self._complete_greeting(start)
        return self._greetings[start]

    def _complete_greeting(self, start: int) -> int:
        length = self.greeting(start)
        behind = self.norms(start + length, start + length + 1)
        wish = self.words.wishes.longest(self.all_norms, start)
        no_greeting = self.words.not_greeting | self.words.subordinating
        if wish > length or not set(behind) & no_greeting:
            return 0  # but "good night when we are there"
        return length

    # --- orders

    def joined(self, at: int, start: int) -> bool:
        """Whether "and", a comma or the like stands before a token."""
        before = self.tokens[at - 1]
        return at > start and (before.kind == "mark" or before.norm in self.joins)

    def order(self, at: int, end: int, *, strict: bool = False) -> bool:
        """Whether what begins here sounds like an order to the robot; `strict` where no noun is
        to be expected: "goodbye and wave"."""
        words = self.words
        while at < end and self.tokens[at].norm in words.between:
            at += 1
        if at >= end or self.tokens[at].kind != "word" or self.wished(at):
            return False
        verb = self.tokens[at]
        after = self.tokens[at + 1].norm if at + 1 < end else None
        if verb.norm in words.verbs:
            if after in words.finite:
                return False  # "help is on the way"
            noun = verb.norm in words.nouns_too and not strict
            return after in words.objects | words.asking or not noun
        if after not in words.objects or verb.norm in self.language.closed | words.finite:
            return False
        noun = verb.capital and bool(self.language.speech.get("capital_nouns"))
        return not noun and not words.no_order.search(verb.norm)

    def wished(self, at: int) -> bool:
        """Whether a wish begins here, which is spoken and not obeyed."""
        return self.begins(self.words.wishes, at)

    def about_addressed(self, at: int, end: int) -> bool:
        """Whether those who are asked to do something are spoken of as others: "behind them"."""
        return any(token.norm in self.words.addressed for token in self.tokens[at:end])

    def licensed(self, node: Node, start: int, at: int) -> bool:
        """Whether the verb before is of the same form, so that "and wait" goes on with it: "you can
        sit down and wait", "we love you and miss you"."""
        words = self.words
        little = self.language.closed | self.joins
        said = [norm for norm in self.norms(start, at) if norm not in words.between]
        if "aux" in node.parts:
            aux = node.parts["aux"]
            said = [*self.norms(aux.start, aux.end), *said]
        if said and said[0] in words.verbs - words.nouns_too:
            return True
        for number, word in enumerate(said[:-1]):
            following = said[number + 1 :]
            if word in words.modals and not words.modals & set(following):
                main = next(
                    (each for each in following if each.isalpha() and each not in little), None
                )
                if main and main not in words.finite and "be" not in said:
                    return True
            if word in words.to and following[0] in words.verbs:
                return True
        return False

    def asked_on(self, node: Node) -> int | None:
        """Where something goes on behind what is told to somebody that is for them, or may be:
        "ask Rosa to call a taxi and bring her coat", "sie soll warten und dann anrufen"."""
        words, end = self.words, node.end
        at = end
        while at < len(self.tokens) and (
            self.tokens[at].norm == COMMA or self.tokens[at].norm in self.joins | words.between
        ):
            at += 1
        if at >= len(self.tokens):
            return None
        if at == end:
            return None
        rest = self.tokens[at:]
        clause = list(
            takewhile(lambda each: each.kind != "mark" and each.norm not in self.joins, rest)
        )
        said = " ".join(each.norm.capitalize() if each.capital else each.norm for each in clause)
        first = rest[0].norm
        if self.tokens[end].norm == COMMA and words.asked_with.search(said):
            return at
        asked = self.asks_to(at)
        if self.begins(words.own, at + asked):
            return None
        if asked and node.means != "ask" and not self.asked_before(0, node.start):
            return at
        joined = any(each.norm in self.joins for each in self.tokens[end:at])
        if node.means not in REQUESTED or not joined:
            return None
        if words.asked_too is not None:
            return at if first not in words.verbs and words.asked_too.search(said) else None
        if self.tokens[end].norm == COMMA or first not in words.verbs:
            return None
        named = any(each.capital for each in self.tokens[node.parts["text"].start : end])
        of_them = any(each.norm in words.receivers for each in clause)
        return None if of_them and not named else at

    def asks_to(self, at: int) -> bool:
        """Whether something that somebody is asked to do begins here, with the word for that: "to
        call", "de le lui dire"."""
        if self.tokens[at].norm not in self.words.requests or at + 1 >= len(self.tokens):
            return False
        if "infinitive" in self.language.speech:
            return self.has_infinitive(at + 1, len(self.tokens))
        return self.tokens[at + 1].norm in self.words.verbs

    def asked_before(self, start: int, end: int) -> bool:
        """Whether what is asked for has begun before: "je vous prie de dire ... et de revenir"."""
        return not self.words.requests.isdisjoint(self.norms(start, end))

    def asked_again(self, at: int) -> bool:
        """Whether one more thing that somebody is asked to do begins here: "... and to call"."""
        if not 0 < at < len(self.tokens) or self.tokens[at - 1].norm not in self.joins:
            return False
        return self.asks_to(at)

    # --- sentences, questions

    def is_clause(self, start: int, end: int) -> bool:
        """Whether the text has a subject and a verb: "the doctor comes at nine"."""
        words = self.words
        if self.tokens[start].norm in words.asking | words.manners | words.not_greeting:
            return False
        for at in range(start + 1, end):
            norm = self.tokens[at].norm
            if norm in words.subordinating:
                return False
            if norm == "'s":
                after = self.tokens[at + 1].norm if at + 1 < end else ""
                if after in self.language.closed or re.search(r"ing$|ed$|^ready$", after):
                    return True
                continue
            noun = self.tokens[at].capital and bool(self.language.speech.get("capital_nouns"))
            noun = noun or self.begins(words.messages, at)  # "guten Morgen"
            if norm in words.finite or (not noun and words.finite_pattern.search(norm)):
                return True
            before = self.tokens[at - 1]
            after_noun = before.kind == "word" and before.value is None
            after_noun = after_noun and before.norm not in words.objects | self.joins
            if before.norm in words.subjects and norm in words.verb_forms:
                return True
            if after_noun and norm in words.verb_forms - words.nouns_too:
                return True
        return False

    def asks(self, start: int, end: int) -> bool:
        """Whether it begins an indirect question, whose answer the robot would have to find."""
        words = self.words
        if self.tokens[start].norm not in words.asking or self.begins(words.exclaimed, start):
            return False
        mark = self.tokens[end].kind == "mark" if end < len(self.tokens) else False
        direct = start + 1 < end and self.tokens[start + 1].norm in words.finite
        return not (direct and (mark or words.addressing & set(self.norms(start, end))))

    def begins(self, phrases: Phrases, at: int) -> bool:
        return phrases.longest(self.all_norms, at) > 0
