"""A language model as a planner: it knows how people talk, and writes what the rules do not
know."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Final

import msgspec

from grammar.naming import naming, place_called
from grammar.normal import normal
from grammar.planning.by_the_clock import by_the_clock
from grammar.planning.heeding import heeded
from grammar.planning.model.expansion import expanded
from grammar.planning.model.expressions import CALLS
from grammar.planning.model.prompt import request, vocabulary
from grammar.planning.model.recogniser import CLARIFY, REFUSE
from grammar.planning.model.request import Interrupted as WritingInterrupted
from grammar.planning.model.request import TooLate, Unavailable, Writer, Written
from grammar.planning.model.turns import Turns
from grammar.planning.planner import (
    Answer,
    Draft,
    Drafts,
    Interrupted,
    Question,
    Refusal,
    Watch,
)
from grammar.planning.turn import Turn
from grammar.program_parser import NotAPlan
from grammar.understanding import Context

NAME: Final = "model"
MOST_DRAFTS: Final = 4
ENOUGH: Final = 6.0
"""Seconds in which others than the first may be written."""
LONGEST: Final = 600
"""Characters of a sentence; more would take a model too long."""
_WAY_OUT: Final = re.compile(rf'({REFUSE}|{CLARIFY})\("([^"]*)"(?:, "([^"]*)")?\)')


class ModelPlanner:
    """Has a `Writer` write programs, and makes plans of them."""

    name = NAME

    def __init__(
        self, writer: Writer, will_do: Callable[[Turn, Draft], bool] | None = None
    ) -> None:
        """`will_do` says of a first draft that no others are needed to know what is meant; without
        it, there are always several."""
        self._writer = writer
        self._will_do = will_do
        self._turns = Turns()

    def plan(self, turn: Turn, watch: Watch) -> Answer:
        if len(turn.text) > LONGEST:
            return Refusal(turn.language.phrase("too_long"))
        watch.thinking()
        try:
            with self._turns.taken(watch), watch.cancelling(self._writer.cancel):
                written = self._written(turn, watch)
        except WritingInterrupted as error:
            raise Interrupted from error
        except Unavailable as error:
            return Refusal(str(error), absent=True)
        except TooLate:
            return Refusal(turn.language.phrase("too_late"), absent=True)
        return self._answer(turn, written)

    def _written(self, turn: Turn, watch: Watch) -> list[Written]:
        """One program, if that will do; else several."""

        def grown(text: str) -> None:
            self._grown(text, watch)

        several = request(turn, turn.context.written, MOST_DRAFTS)
        if self._will_do is not None:
            written = self._writer.write(msgspec.structs.replace(several, most=1), grown)
            if not written or _WAY_OUT.match(written[0].text):
                return written
            draft = _draft(turn, written[0], 1.0)
            if draft is not None and self._will_do(turn, draft):
                return written
            several = msgspec.structs.replace(several, seconds=ENOUGH)
        return self._writer.write(several, grown)

    def _grown(self, text: str, watch: Watch) -> None:
        """What was written so far."""
        if watch.cancelled:  # a cancellation that came before the writer had begun was lost on it
            self._writer.cancel()
        else:
            watch.writing(_shown(text))

    def _answer(self, turn: Turn, written: list[Written]) -> Answer:
        """The plans of what was written; the way out if that is what was written first."""
        shares = _shares([each.score for each in written])
        drafts = []
        for number, (each, share) in enumerate(zip(written, shares, strict=True)):
            out = _WAY_OUT.match(each.text)
            if out is not None and number == 0:
                return _way_out(turn, *out.groups())
            if out is not None:
                continue
            draft = _draft(turn, each, share)
            if draft is not None:
                drafts.append(draft)
        if not drafts:
            return Refusal(turn.language.phrase("not_understood_at_all"))
        return Drafts(tuple(drafts))


def _shares(scores: list[float]) -> list[float]:
    """How likely each is among all, by the logarithms of their probabilities."""
    best = max((score for score in scores if math.isfinite(score)), default=0.0)
    weights = [math.exp(score - best) if score <= best else 0.0 for score in scores]
    return [weight / (sum(weights) or 1.0) for weight in weights]


def _draft(turn: Turn, written: Written, share: float) -> Draft | None:
    people = vocabulary(turn).people
    try:
        plan = normal(expanded(written.text, people, turn.lexicon, turn.language))
        plan = normal(by_the_clock(plan, whiles=True))
        plan = heeded(turn, plan)
    except NotAPlan:
        return None
    context = Context(
        plan=plan, text=turn.text, before=turn.context.referents(), written=written.text
    )
    return Draft(plan, NAME, share, context, score=written.score, surest=written.surest)


_OF_SEVERAL: Final = ("which", "where")
"""Questions which of several is meant."""
MOST_CHOICES: Final = 4
_SAME: Final = {
    (REFUSE, "dangerous"): "no_harm",
    (REFUSE, "medical"): "no_medicine",
    (REFUSE, "no order"): "asks_nothing",
}
"""Reasons for which the language has words anyhow."""


def _way_out(turn: Turn, way: str, reason: str, words: str | None) -> Answer:
    """A refusal or a question back, in the words of the language."""
    phrase = _SAME.get((way, reason), f"{way}_{reason}")
    if words and f"{phrase}_of" in turn.language.phrases:
        phrase = f"{phrase}_of"
    if phrase not in turn.language.phrases:  # a reason that nobody knows
        return Refusal(turn.language.phrase("not_understood_at_all"), context=turn.context)
    message = turn.language.phrase(phrase, part=words or "")
    if way == CLARIFY and reason in _OF_SEVERAL and words:
        return _which(turn, words, message)
    if way == CLARIFY:
        return Question(message, context=turn.context)
    return Refusal(message, final=reason in ("dangerous", "medical"), context=turn.context)


def _which(turn: Turn, words: str, message: str) -> Answer:
    """The question which of those is meant that go by these words; if there are none, it is
    something that nobody knows here."""
    said = set(turn.language.tokens_of(words))
    if said.isdisjoint(turn.reader.names.called):
        unknown = turn.language.phrase("refuse_unknown_of", part=words)
        return Refusal(unknown, context=turn.context)
    lexicon = turn.lexicon
    names = (*lexicon.places, *lexicon.people, *lexicon.objects, *lexicon.furniture)
    choices = {
        each.name: naming(lexicon, turn.language).called(each.name)
        for each in names
        if any(said <= set(turn.language.tokens_of(text)) for text in (each.name, *each.aliases))
    }
    if not 2 <= len(choices) <= MOST_CHOICES or words in choices.values():
        return Question(message, context=turn.context)
    told = turn.reader.alternatives([*choices.values()])
    return Question(
        turn.language.phrase("which_one", what=words, choices=told),
        tuple(_with_name(turn, words, name) for name in choices if words in turn.text),
        context=turn.context,
    )


def _with_name(turn: Turn, words: str, name: str) -> str:
    """The sentence with a name in the place of these words: a place brings its own article."""
    articles = "|".join(map(re.escape, turn.language.speech.get("articles", ())))
    article = (
        re.search(rf"\b(?:{articles})\s+(?={re.escape(words)})", turn.text) if articles else None
    )
    is_place = any(each.name == name for each in turn.lexicon.places)
    if article is None or not is_place:
        return turn.text.replace(words, naming(turn.lexicon, turn.language).called(name), 1)
    called = place_called(name, turn.lexicon, turn.language)
    return turn.text[: article.start()] + called + turn.text[article.end() + len(words) :]


_QUOTED: Final = re.compile(r'("(?:[^"\\]|\\.)*"?)')
_CALLED: Final = re.compile(rf"(?<![\w.])({'|'.join(sorted(CALLS))})(?=\()")


def _shown(text: str) -> str:
    """What was written so far, as people see programs."""
    parts = _QUOTED.split(text)  # every other part is quoted
    return "".join(
        part if number % 2 else _CALLED.sub(r"robot.\1", part) for number, part in enumerate(parts)
    )
