"""What the slots of the rules match: names of the world, numbers, free text, any noun.

A slot finds all its matches that begin at a token, with their costs. Names come from the lexicon
and from the lists of the language; they are found along a trie, misspelt ones too.
"""

from __future__ import annotations

import functools
import math
import re
from collections.abc import Iterable, Mapping
from typing import Any, Final

from grammar.chart import CORRECTION, Corrected, Match, Slot
from grammar.names import Names, Trie
from grammar.numerals import Numerals
from grammar.phrases import Phrases
from grammar.slips import command_words, plain_forms
from grammar.texts.judging import Judge
from grammar.texts.open_slots import FREE_WORD, OpenText
from grammar.tokens import COMMA, Token
from grammar.wordforms import singular

WHERE_TO: Final = 2.5
"""Cost of reading words that tell where something goes as where it is."""
UNKNOWN_NAME: Final = 30.0
"""Cost of reading words as the name of something that is not known."""
SPACED: Final = 0.5
"""Cost of a name that is written with a space too many or too few."""
SHORTEST_JOINED_NAME: Final = 6
MISSPELT_NOUN: Final = 3.5
"""Cost of taking for a noun what is nearly a known word: "bigest"."""
LONGEST_NOUN: Final = 5
LONGEST_UNKNOWN: Final = 6
LONGEST_STRANGER: Final = 2


class Slots:
    """The slots over the tokens of one sentence."""

    def __init__(
        self,
        names: Names,
        tokens: tuple[Token, ...],
        corrections: Mapping[int, tuple[str, ...]],
    ) -> None:
        self.names = names
        self.language = names.language
        self.tokens = tokens
        self.corrections = corrections
        self._command_words = command_words(self.language)
        self._judge = Judge(tokens, self.language, names.people)
        self._first: dict[int, tuple[str, ...]] = {}
        self._open_text = OpenText(tokens, self.language, self._judge)
        self._numerals = Numerals(tokens, self.language)
        self._adverb = re.compile(self.language.speech.get("adverbs", r"(?!)")).search
        self._possessive = str(self.language.speech.get("possessive", "")).strip()
        self._no_nouns = self.language.words_called("no_nouns")
        self._measures = self.language.words_called("measures")
        self._behind_nouns = frozenset(self.language.speech.get("behind_nouns", ()))
        self._no_heads = frozenset(self.language.speech.get("no_heads", ()))
        self._noun_joins = frozenset(self.language.speech.get("noun_joins", ()))
        clause = self.language.speech.get("clause", {})
        no_verbs = ("pronouns", "determiners", "prepositions", "and", "subordinating", "reflexive")
        fillers = {filler[0] for filler in self.language.fillers if len(filler) == 1}
        ends = self.language.speech.get("text_ends", ())
        joins = self.language.speech.get("joins", ())
        self._no_verbs = fillers.union(ends, joins, *(clause.get(each, ()) for each in no_verbs))

    def matches(self, slot: str, at: int) -> list[Match]:
        """All matches of a slot, named in braces, that begin at a token."""
        if slot in self._open:
            return self._open[slot](at)
        trie = self.names.tries.get(slot[1:-1])
        return self._name(trie, at) if trie is not None else []

    def starting(self, at: int) -> Iterable[str]:
        """The slots that may have matches at a token, in braces. Most slots are lists of names,
        and few names begin with a word: the others need not be tried."""
        beginning = self.names.beginning
        listed = {slot for word in self._first_words(at) for slot in beginning.get(word, ())}
        return (*self._open, *("{" + slot + "}" for slot in listed))

    @functools.cached_property
    def _open(self) -> dict[str, Slot]:
        """The slots that are no lists of names."""
        return {
            "{number}": self._number,
            "{count}": self._count,
            "{clock}": functools.partial(self._kind, "time"),
            "{url}": functools.partial(self._kind, "url"),
            "{selector}": functools.partial(self._kind, "selector"),
            "{quote}": self._quote,
            "{text}": self._text,
            "{rest}": self._open_text.rest,
            "{noun}": self._noun,
            "{word}": self._word,
            "{verb}": self._verb,
            "{zu_infinitive}": self._zu_infinitive,
            "{infinitive}": self._infinitive,
            "{located}": functools.partial(self._preposition, "located"),
            "{towards}": functools.partial(self._preposition, "towards"),
            "{remark}": self._open_text.remark,
            "{unknown}": self._unknown,
            "{stranger}": self._stranger,
        }

    # --- names

    @functools.cached_property
    def _inside_names(self) -> frozenset[int]:
        """The tokens in the middle of the name of a person or a place: nobody who speaks of
        Professor Lee tells a professor words that begin with "Lee"."""
        return frozenset(
            position
            for slot in ("person", "place")
            if slot in self.names.tries
            for at in range(len(self.tokens))
            for end, cost, _ in self._name(self.names.tries[slot], at)
            if not cost
            for position in range(at + 1, end)
        )

    def _name(self, trie: Trie, at: int) -> list[Match]:
        matches: list[Match] = []
        self._walk(trie, at, 0.0, (), matches)
        return matches

    def _first_words(self, at: int) -> tuple[str, ...]:
        """The words that a name which stands at a token may begin with; the same for all tries."""
        known = self._first.get(at)
        if known is None:
            known = ()
            if at < len(self.tokens):
                word = self.tokens[at].norm
                joined = [word + self.tokens[at + 1].norm] if at + 1 < len(self.tokens) else []
                cuts = [word[:cut] for cut in self._cuts(word)]
                known = (word, *joined, *cuts, *self.corrections.get(at, ()))
            self._first[at] = known
        return known

    def _walk(
        self,
        trie: Trie,
        at: int,
        cost: float,
        corrected: tuple[tuple[int, str], ...],
        matches: list[Match],
    ) -> None:
        if trie.values:
            value: Any = trie.values
            matches.append((at, cost, Corrected(value, corrected) if corrected else value))
        if at >= len(self.tokens):
            return
        branch = trie.branches.get(self.tokens[at].norm)
        if branch:
            self._walk(branch, at + 1, cost, corrected, matches)
        for end, joined in self._spaced(trie, at):
            self._walk(joined, end, cost + SPACED, corrected, matches)
        for end, named in self._numbered(trie, at):
            self._walk(named, end, cost, corrected, matches)
        for other in self.corrections.get(at, ()):
            branch = trie.branches.get(other)
            if branch:
                self._walk(branch, at + 1, cost + CORRECTION, (*corrected, (at, other)), matches)

    def _spaced(self, trie: Trie, at: int) -> Iterable[tuple[int, Trie]]:
        """ "livingroom" for "living room" and "bed room" for "bedroom", with where each ends."""
        word = self.tokens[at].norm
        if at + 1 < len(self.tokens) and self.tokens[at + 1].kind == "word":
            joined = trie.branches.get(word + self.tokens[at + 1].norm)
            if joined is not None and word.isalpha():
                yield at + 2, joined
        for cut in self._cuts(word):
            first = trie.branches.get(word[:cut])
            second = first.branches.get(word[cut:]) if first is not None else None
            if second is not None:
                yield at + 1, second

    def _numbered(self, trie: Trie, at: int) -> Iterable[tuple[int, Trie]]:
        """ "room two hundred and five" and "room two oh five" for "room 205", with where the number
        ends."""
        if not any(key.isdigit() for key in trie.branches):
            return
        as_one = ((end, f"{value:g}") for end, cost, value in self._number(at) if not cost)
        for end, digits in dict.fromkeys((*as_one, *self._numerals.read_out(at))):
            branch = trie.branches.get(digits)
            if branch is not None and (end > at + 1 or digits != self.tokens[at].norm):
                yield end, branch

    def _cuts(self, word: str) -> range:
        """Where an unknown word may lack a space."""
        long = len(word) >= SHORTEST_JOINED_NAME and word not in self.language.words
        return range(2, len(word) - 1) if long else range(0)

    # --- numbers

    def _number(self, at: int) -> list[Match]:
        return self._numerals.starting(at)

    def _count(self, at: int) -> list[Match]:
        """A whole number from 1 on."""
        return [
            (end, cost, int(value))
            for end, cost, value in self._number(at)
            if 1 <= value < math.inf
            and value == int(value)
            and not (cost and end == at + 1)
            and not self._is_measure(end)
        ]

    def _is_measure(self, at: int) -> bool:
        return at < len(self.tokens) and self.tokens[at].norm in self._measures

    def _measured(self, at: int) -> bool:
        """Whether a number stands here that tells how big something is: "a twelve ounce coffee"."""
        goes_on = at and any(end > at for end, _, _ in self._number(at - 1))  # "twenty-five"
        return not goes_on and self._is_measure(at + 1)

    # --- single tokens

    def _kind(self, kind: str, at: int) -> list[Match]:
        if at < len(self.tokens) and self.tokens[at].kind == kind:
            return [(at + 1, 0.0, self.tokens[at].norm)]
        return []

    def _quote(self, at: int) -> list[Match]:
        if at < len(self.tokens) and self.tokens[at].kind == "quote" and self.tokens[at].inner:
            return [(at + 1, 0.0, self.tokens[at].inner)]
        return []

    def _word(self, at: int) -> list[Match]:
        """One word that is no article and no pronoun: a verb."""
        if at < len(self.tokens) and self.tokens[at].kind == "word":
            words = self._judge.words
            if self.tokens[at].norm in words.objects | words.adverbs or self._named("person", at):
                return []
            after = self.tokens[at + 1].norm if at + 1 < len(self.tokens) else ""
            if after in self._behind_nouns:
                return []  # "which of the three wards has ...": no verb
            return [(at + 1, FREE_WORD, self.tokens[at].norm)]
        return []

    def _verb(self, at: int) -> list[Match]:
        """A word that may be the verb at the end of a clause."""
        if at >= len(self.tokens) or self.tokens[at].capital:
            return []
        return [] if self.tokens[at].norm in self._no_verbs else self._word(at)

    def _infinitive(self, at: int) -> list[Match]:
        """A verb at the end of a clause that is no order by its form: "holen", not "hol"."""
        ending = self.language.speech["infinitive_form"]
        return self._verb(at) if re.search(ending, "".join(self._judge.norms(at, at + 1))) else []

    def _zu_infinitive(self, at: int) -> list[Match]:
        """A verb with "zu" inside: "anzurufen"; its value is the verb without it."""
        particles = self.language.speech.get("clause", {}).get("particles", ())
        token = self.tokens[at] if at < len(self.tokens) else None
        word = (token.spelled or token.norm) if token is not None else ""
        for particle in particles:
            if word.startswith(f"{particle}zu") and word.endswith("n"):
                rest = word[len(particle) + 2 :]
                return [(at + 1, FREE_WORD, particle + rest)] if len(rest) > 2 else []
        return []

    def _preposition(self, kind: str, at: int) -> list[Match]:
        """A preposition that tells where something is, or where to, in a language that shows by
        what follows it which: "in der Küche", "in die Küche"."""
        data = self.language.speech.get(kind, {})
        if at >= len(self.tokens) or self.tokens[at].norm not in data.get("words", ()):
            return []
        after = self.tokens[at + 1].norm if at + 1 < len(self.tokens) else ""
        own = data.get("not_before_by_word", {}).get(self.tokens[at].norm, ())
        unlike = after in data["not_before"] or after in own
        return [(at + 1, WHERE_TO if unlike else 0.0, None)]

    # --- open slots

    def _text(self, at: int) -> list[Match]:
        if at in self._inside_names:
            return []
        end = min((join for join in self._others_too if join > at), default=len(self.tokens))
        return [match for match in self._open_text.text(at) if match[0] <= end]

    @functools.cached_property
    def _others_too(self) -> frozenset[int]:
        """Where it is said behind a text of whom the same holds: "... and Bob as well"."""
        too = Phrases(self.language.tokens_of(each) for each in self.language.speech["too"])
        norms = self._judge.all_norms
        joins = self._judge.joins
        found = set()
        for at in range(1, len(self.tokens)):
            if norms[at - 1] not in joins and norms[at - 1] != COMMA:
                continue
            led = too.longest(norms, at)
            to = at + led < len(norms) and norms[at + led] in self._open_text.words.to_whom
            for end in self._somebody(at + led + to):
                last = end + too.longest(norms, end)
                ends = last >= len(self.tokens) or self.tokens[last].kind == "mark"
                if ends and (led or last > end):
                    comma = at > 1 and norms[at - 1] != COMMA and norms[at - 2] == COMMA
                    found.add(at - 2 if comma else at - 1)
        return frozenset(found)

    def _somebody(self, at: int) -> set[int]:
        """Where the name of a person may end that begins here, also of one that nobody knows."""
        ends = set(self._named("person", at))
        at += at < len(self.tokens) and self.tokens[at].norm in self._open_text.words.titles
        if at < len(self.tokens) and self.tokens[at].capital:
            ends |= {end for end, *_ in self._stranger(at)}
        return ends

    def _noun(self, at: int) -> list[Match]:
        """Any noun with its adjectives: words that are no function words."""
        matches: list[Match] = []
        doubt = 0.0
        for position in range(at, min(at + LONGEST_NOUN, len(self.tokens))):
            token = self.tokens[position]
            if token.norm in self._noun_joins and matches:
                continue  # "glass of water"
            closed = token.norm in self.language.closed and not self._noun_after_all(at, position)
            if token.value is not None and position == at:
                if not self._measured(at):
                    break  # a number is no noun
                continue
            if token.kind not in ("word", "quote") or closed:
                break
            if self._noun_over(at, position) or self._adverb(token.norm):
                break
            if position > at and self._named("person", position):
                break
            if position == at and (token.norm in self._no_nouns or self._is_doing(at)):
                break
            before = doubt
            doubt += MISSPELT_NOUN if position in self.corrections else 0.0
            if token.norm in self._no_heads and not self._is_definite(at, position):
                continue  # "move left", "move a little"; but "the left cup", "on the left"
            if self._is_look(position):
                continue  # "der blaue oder der rote Hefter": no noun ends with an adjective
            length = position + 1 - at
            several = singular(token.norm, self.language) in self.language.words  # "snacks"
            matches.append(
                (position + 1, FREE_WORD * length + (before if several else doubt), None)
            )
        named = {end for slot in ("person", "place") for end in self._named(slot, at)}
        return [match for match in matches if match[0] not in named]  # a name is no thing

    def _is_doing(self, at: int) -> bool:
        """Whether this is what somebody does, and no noun: "are getting on my nerves"."""
        word, before = self.tokens[at].norm, self.tokens[at - 1].norm if at else ""
        ending = str(self.language.speech.get("gerunds", {}).get("ending", "-"))
        followed = at + 1 < len(self.tokens) and self.tokens[at + 1].norm in self.language.closed
        doing = word.endswith(ending) and any(
            self._only_orders(base) for base in plain_forms(word[: -len(ending)])
        )
        return doing and followed and before in self.language.speech.get("being", ())

    def _noun_after_all(self, at: int, position: int) -> bool:
        """Whether a function word is the noun of the same spelling: "the can of soup", but not "the
        robot can see" and "the cup can you bring"."""
        not_before = self.language.speech.get("closed_nouns", {}).get(self.tokens[position].norm)
        if not_before is None or not position:
            return False
        after = self.tokens[position + 1] if position + 1 < len(self.tokens) else None
        ends = after is None or after.kind == "mark" or after.norm in self.language.closed
        introduced = position > at or self.tokens[position - 1].norm in self._judge.words.definite
        return introduced and ends and (after is None or after.norm not in not_before)

    def _is_definite(self, at: int, position: int) -> bool:
        """Whether a noun that begins at a token and ends with this one has "the" before it."""
        before = at - 1 if position == at else position - 1
        return before >= 0 and self.tokens[before].norm in self._judge.words.definite

    def _is_look(self, position: int) -> bool:
        """Whether a small letter shows that this is no noun but a word for how things look."""
        token = self.tokens[position]
        trie = self.names.tries.get("attribute")
        written = self.language.speech.get("capital_nouns") and not token.capital
        branch = trie.branches.get(token.norm) if trie is not None and written else None
        return branch is not None and bool(branch.values)

    def _only_orders(self, norm: str) -> bool:
        """Whether a command can begin with the word, and it is no noun besides."""
        return norm in self._command_words and norm not in self._judge.words.nouns_too

    def _noun_over(self, at: int, position: int) -> bool:
        """Whether a small letter shows that the noun before is at an end: "Tasse leer"; or, where
        nouns begin with their heads, an order: "la salle d'attente préviens"."""
        norm = self.tokens[position].norm
        head_first = self.language.speech.get("head_first")
        if position > at and head_first and self._only_orders(norm):
            return True
        if position == at or not self.language.speech.get("capital_nouns"):
            return False
        before, here = self.tokens[position - 1], self.tokens[position]
        return before.capital and not here.capital

    def _named(self, slot: str, at: int) -> list[int]:
        """Where names of this slot end that begin here, spelled right."""
        trie = self.names.tries.get(slot)
        return [end for end, cost, _ in self._name(trie, at) if not cost] if trie else []

    def _unknown(self, at: int) -> list[Match]:
        """The name of something nobody knows, so that it can be said which."""
        matches: list[Match] = []
        number_ends = at
        for position in range(at, min(at + LONGEST_UNKNOWN, len(self.tokens))):
            token = self.tokens[position]
            if token.norm == self._possessive and matches:
                continue  # "Mrs Miller's room"
            if matches:  # "chambre cent un", "room two hundred and five"
                said = (end for end, cost, _ in self._number(position) if not cost)
                number_ends = max(number_ends, *said, position)
            if position >= number_ends and (
                token.kind == "mark" or token.norm in self.language.closed
            ):
                break
            matches.append((position + 1, UNKNOWN_NAME + FREE_WORD * (position + 1 - at), None))
        return matches

    def _stranger(self, at: int) -> list[Match]:
        """The name of somebody nobody knows: words that no rule and no name has."""
        matches: list[Match] = []
        known = (self.language.words, self.names.words, self.language.closed)
        for position in range(at, min(at + LONGEST_STRANGER, len(self.tokens))):
            token = self.tokens[position]
            if token.kind != "word" or any(token.norm in words for words in known):
                break
            # Written like a name, it is rather somebody than a place.
            cost = UNKNOWN_NAME + FREE_WORD * (position + 1 - at - token.capital)
            matches.append((position + 1, cost, None))
        return matches
