"""One thing that somebody says in a conversation: what every planner is given."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.planning.mentions import Mention, mentions
from grammar.reader import SentenceReader
from grammar.tokens import Token
from grammar.understanding import Context


@dataclass(frozen=True)
class Turn:
    text: str
    lexicon: Lexicon
    language: Language
    context: Context = field(default_factory=Context)
    """What was said and planned before."""

    def __reduce__(self) -> tuple[type[Turn], tuple[str, Lexicon, Language, Context]]:
        """What was found out about it can be found out again."""
        return Turn, (self.text, self.lexicon, self.language, self.context)

    @cached_property
    def reader(self) -> SentenceReader:
        return SentenceReader(self.text, self.lexicon, self.language, self.context)

    @property
    def tokens(self) -> tuple[Token, ...]:
        return self.reader.tokens

    @cached_property
    def mentions(self) -> tuple[Mention, ...]:
        """What is spoken of, by the names and noun phrases of the language."""
        return mentions(self.reader)

    @cached_property
    def before(self) -> Turn | None:
        """What was said before, if this may go on with it."""
        if self.context.plan is None or not self.context.text:
            return None
        return Turn(self.context.text, self.lexicon, self.language)

    @cached_property
    def called(self) -> tuple[Turn, ...]:
        """The sentences of routines that are called by their names."""
        return tuple(
            Turn(routine.sentence, replace(self.lexicon, routines=()), self.language)
            for at in range(len(self.tokens))
            for _, _, routines in self.reader.slots.matches("{routine}", at)
            for routine in routines
            if routine.sentence  # a program has no words
        )

    @property
    def earlier(self) -> tuple[Turn, ...]:
        """What was said at other times and counts here."""
        return (*((self.before,) if self.before else ()), *self.called)

    @cached_property
    def spoken_of(self) -> tuple[Mention, ...]:
        """The mentions of this turn, and of what counts besides."""
        return (*self.mentions, *(each for turn in self.earlier for each in turn.mentions))
